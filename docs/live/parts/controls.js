
/* ---- controls ---- */

let codeSide = "right";

/* A group of radio buttons: what has changed goes to `chosen`. */
function choice(id, options, chosen) {
  for (const [value, name, title] of options) {
    const [label, input, span] = ["label", "input", "span"].map((kind) => document.createElement(kind));
    Object.assign(input, { type: "radio", name: id, value });
    span.textContent = name;
    if (title) label.title = title;
    input.addEventListener("change", () => chosen(value));
    label.append(input, span);
    $(id).append(label);
  }
}

function check(id, value) {
  for (const input of $(id).querySelectorAll("input")) input.checked = input.value === String(value);
}

function set(changes) {
  Object.assign(state, changes);
  show();
  noteAddress();
  request();
}

const nameOf = (side) => {
  const method = state[side], { long } = METHODS[method];
  return method === "march" ? `${long}, ${state.march} steps` : long;
};

/* What happens, in words, by what is on either side. */
function storyOf() {
  const out = [SCENES[state.scene].story];
  for (const side of ["left", "right"]) {
    const there = side === "left" ? state.line > 0 : state.line < 1;
    if (there) out.push([`${side === "left" ? "Left" : "Right"}, ${nameOf(side)}. `, METHODS[state[side]].story]);
  }
  return out.map((x) => {
    const p = document.createElement("p");
    if (Array.isArray(x)) {
      const b = document.createElement("b");
      b.textContent = x[0];
      p.append(b, x[1]);
    } else p.textContent = x;
    return p;
  });
}

let shownStory = "";

/* All that the state decides, but the picture. */
function show() {
  const percent = Math.round(state.line * 100);
  for (const id of ["scene", "left", "right"]) check(id, state[id]);
  check("which", codeSide);
  for (const id of ["shade", "own"]) $(id).checked = state[id];
  for (const id of ["height", "march", "steps"]) $(id).value = state[id];
  $("height-text").textContent = `${Math.round(state.height * 100)} %`;
  $("march-text").textContent = state.march;
  $("steps-text").textContent = state.steps;
  $("march-label").hidden = state.left !== "march" && state.right !== "march";
  $("steps-label").hidden = !state.own;
  divider.style.left = `${state.line * 100}%`;
  divider.setAttribute("aria-valuenow", percent);
  divider.setAttribute("aria-valuetext", `${percent} %: left ${nameOf("left")}, right ${nameOf("right")}`);
  $("chip-left").textContent = nameOf("left");
  $("chip-right").textContent = nameOf("right");
  for (const [side, share] of [["left", state.line], ["right", 1 - state.line]])
    Object.assign($("chip-" + side).style, { maxWidth: `calc(${share * 100}% - 1rem)`, opacity: share > 0.1 ? 1 : 0 });
  for (const side of ["left", "right"])
    $("which").querySelector(`[value=${side}] + span`).textContent = `${side}: ${METHODS[state[side]].name}`;
  const key = [state.scene, nameOf("left"), nameOf("right"), state.line > 0, state.line < 1].join();
  if (key !== shownStory) $("story").replaceChildren(...storyOf());
  shownStory = key;
  showCode(codeSide);
}

function setMethod(side, method) {
  codeSide = side;
  set({ [side]: method });
}

function startControls() {
  choice("scene", Object.keys(SCENES).map((id) => [id, SCENES[id].name]),
    (scene) => {
    const { line, eye, light } = startOf(scene);
    stopSway();
    set({ scene, line, eye, light });
  });
  for (const side of ["left", "right"])
    choice(side, ORDER.map((id) => [id, METHODS[id].name, METHODS[id].long]), (method) => setMethod(side, method));
  choice("drag", [["eye", "the eye"], ["light", "the light"]], (what) => { dragMoves = what; });
  choice("which", [["left", "left"], ["right", "right"]], (side) => { codeSide = side; show(); });
  check("drag", "eye");
  for (const id of ["height", "march", "steps"])
    $(id).addEventListener("input", () => { move(); set({ [id]: Number($(id).value) }); });
  for (const id of ["shade", "own"]) $(id).addEventListener("change", () => set({ [id]: $(id).checked }));
  $("reset").addEventListener("click", () => { stopSway(); set(startOf(state.scene)); });
  const sways = () => $("play").getAttribute("aria-pressed") === "true";
  $("play").addEventListener("click", () => (sways() ? stopSway() : swayLight()));
  $("controls").addEventListener("submit", (event) => event.preventDefault());
  addEventListener("hashchange", () => { stopSway(); set(stateOf(location.hash.slice(1))); });
  $("hint").textContent = matchMedia("(pointer: coarse)").matches
    ? "One finger turns the eye, two move the light."
    : "Drag turns the eye, Shift-drag moves the light. Keys there: arrows, + −, and n 0 1 2 3 m d for the method right "
      + "of the line.";
}
