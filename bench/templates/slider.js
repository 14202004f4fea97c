"use strict";
// A border between two pictures that lie over each other in `stage`. It follows the mouse, a finger, and the range
// `split`, which takes keys. `names` gives what is left and right of it, for those who don't see it; `drags` says
// whether a pointer moves the border now. Returns a function that moves it to a percentage.
function slider(stage, split, names, drags) {
  function move(percent) {
    split.value = percent;
    stage.style.setProperty("--split", `${split.value}%`);
    const [left, right] = names();
    split.setAttribute("aria-valuetext", `${split.value} % ${left}, ${100 - split.value} % ${right}`);
  }

  function drag(event) {
    const box = stage.getBoundingClientRect();
    move(100 * (event.clientX - box.left) / box.width);
  }

  split.addEventListener("input", () => move(split.value));
  stage.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || !drags(event)) return;
    stage.setPointerCapture(event.pointerId);
    drag(event);
  });
  stage.addEventListener("pointermove", (event) => {
    if (stage.hasPointerCapture(event.pointerId)) drag(event);
  });
  return move;
}
