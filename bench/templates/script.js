(() => {
  document.documentElement.classList.add("has-script");
  const all = [...document.querySelectorAll("#sheets figure, #whole figure")];

  // Below each wrong picture a grey copy of its own picture.
  for (const wrong of document.querySelectorAll("#sheets .wrong, #whole .wrong")) {
    const base = wrong.parentElement.querySelector(".picture").cloneNode();
    base.className = "base";
    base.alt = "";
    wrong.prepend(base);
  }

  const template = document.getElementById("comparison");
  if (template) {
    template.replaceWith(template.content.cloneNode(true));
    compare(document.querySelector(".comparison"));
  }

  // Details are open on paper.
  addEventListener("beforeprint", () => {
    for (const details of document.querySelectorAll("details:not([open])")) {
      details.dataset.closed = "";
      details.open = true;
    }
  });
  addEventListener("afterprint", () => {
    for (const details of document.querySelectorAll("details[data-closed]")) {
      delete details.dataset.closed;
      details.open = false;
    }
  });

  function compare(form) {
    const { scene, left, right, zoom, wrong, split } = form.elements;
    const view = form.querySelector(".window");
    const stage = form.querySelector(".stage");
    const figures = () => all.filter((figure) => figure.dataset.scene === scene.value);

    function fill(select, preferred) {
      const names = figures().map((figure) => figure.dataset.name);
      const kept = [select.value, ...preferred].find((name) => names.includes(name));
      select.replaceChildren(...names.map((name) => new Option(name, name)));
      if (kept) select.value = kept;
    }

    function show(side, name) {
      const figure = figures().find((one) => one.dataset.name === name);
      const images = [...figure.querySelectorAll(".picture, .over")].map((image) => image.cloneNode());
      for (const image of images) image.draggable = false;
      form.querySelector(`.side.${side}`).replaceChildren(...images);
      form.querySelector(`[data-name=${side}]`).textContent = name;
      form.querySelector(`[data-caption=${side}]`).textContent = figure.dataset.caption;
      if (side === "left") form.style.setProperty("--aspect", `${images[0].getAttribute("width")} / ${images[0].getAttribute("height")}`);
    }

    function update() {
      show("left", left.value);
      show("right", right.value);
      stage.classList.toggle("marking", wrong.checked);
      form.classList.toggle("shows-wrong", wrong.checked);
      move(split.value);
    }

    function choose_scene() {
      fill(left, ["bump only"]);
      fill(right, ["order 0", "exact"]);
      update();
    }

    // In a larger picture fingers move the picture, and the border is moved below it.
    const move = slider(stage, split, () => [left.value, right.value],
      (event) => event.pointerType !== "touch" || zoom.value === "1");

    function choose_zoom() {
      const [x, y] = [view.scrollLeft + view.clientWidth / 2, view.scrollTop + view.clientHeight / 2];
      const before = stage.clientWidth;
      stage.style.setProperty("--zoom", zoom.value);
      view.classList.toggle("zoomed", zoom.value > 1);
      const times = stage.clientWidth / before;  // the middle stays in the middle
      view.scrollTo(x * times - view.clientWidth / 2, y * times - view.clientHeight / 2);
    }

    scene.addEventListener("change", choose_scene);
    for (const control of [left, right, wrong]) control.addEventListener("change", update);
    zoom.addEventListener("change", choose_zoom);
    form.addEventListener("submit", (event) => event.preventDefault());

    for (const button of document.querySelectorAll("[data-show]")) {
      button.addEventListener("click", () => {
        const { dataset } = button.closest("figure");
        scene.value = dataset.scene;
        choose_scene();
        right.value = dataset.name;
        update();
        form.scrollIntoView({ block: "start" });
        split.focus({ preventScroll: true });
      });
    }
    choose_scene();
  }
})();
