
/* ---- mouse, touch and keys on the picture ---- */

let dragMoves = "eye", moving = 0;
const pointers = new Map();

/* For a moment pictures may be coarse, so that they follow the hand. */
function move() { moving = performance.now(); }

function turn(what, dx, dy) {
  const scene = scenes[state.scene], low = lowest(scene), { at, from } = scene.camera;
  const wrap = (x) => (x + 540) % 360 - 180;
  move();
  if (what === "light") {
    const [a, b] = state.light;
    set({ light: [wrap(a + dx), clampUp(scene.light.at, at, b - dy, low)] });
  } else {
    const [a, b, far] = state.eye;
    set({ eye: [wrap(a - dx), clampUp(from, at, b + dy, low), far] });
  }
}

function zoom(factor) {
  const [a, b, far] = state.eye;
  move();
  set({ eye: [a, b, clamp(far * factor, 0.4, 2.5)] });
}

const other = (what) => (what === "eye" ? "light" : "eye");

/* One finger or the mouse moves one thing; two fingers the light, and the distance by their own. */
function pointerMove(event) {
  const before = pointers.get(event.pointerId);
  if (!before) return;
  const dx = event.clientX - before.x, dy = event.clientY - before.y, k = 140 / canvas.clientWidth;
  const gap = () => { const [a, b] = [...pointers.values()]; return Math.hypot(a.x - b.x, a.y - b.y); };
  const wide = pointers.size === 2 ? gap() : 0;
  pointers.set(event.pointerId, { ...before, x: event.clientX, y: event.clientY });
  if (pointers.size === 2) {
    turn("light", dx * k / 2, dy * k / 2);
    if (wide > 20 && gap() > 20) zoom(wide / gap());
  } else if (pointers.size === 1)
    turn(event.shiftKey || before.button === 2 ? other(dragMoves) : dragMoves, dx * k, dy * k);
}

function canvasKey(event) {
  const arrows = { ArrowLeft: [-3, 0], ArrowRight: [3, 0], ArrowUp: [0, -3], ArrowDown: [0, 3] }, key = event.key;
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (key in arrows) turn(event.shiftKey ? "light" : "eye", ...arrows[key]);
  else if (key === "+" || key === "=") zoom(1 / 1.1);
  else if (key === "-") zoom(1.1);
  else if (key in KEYS) setMethod("right", KEYS[key]);
  else if (key === "s") set({ shade: !state.shade });
  else if (key === "b") set({ own: !state.own });
  else if (key === "r") $("reset").click();
  else return;
  event.preventDefault();
  if (key !== "r") stopSway();
}

function startPointer() {
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY, button: event.button });
    stopSway();
  });
  canvas.addEventListener("pointermove", pointerMove);
  for (const end of ["pointerup", "pointercancel"])
    canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas) return; /* else the page scrolls */
    event.preventDefault();
    zoom(Math.exp(clamp(event.deltaY, -100, 100) / 600));
  }, { passive: false });
  canvas.addEventListener("keydown", canvasKey);
  startDivider();
}

/* ---- the line ---- */

function startDivider() {
  const drag = (event) => {
    const box = canvas.getBoundingClientRect();
    move();
    set({ line: clamp((event.clientX - box.left) / box.width, 0, 1) });
  };
  divider.addEventListener("pointerdown", (event) => {
    divider.setPointerCapture(event.pointerId);
    stopSway();
  });
  divider.addEventListener("pointermove", (event) => divider.hasPointerCapture(event.pointerId) && drag(event));
  divider.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: -0.01, ArrowDown: -0.01, ArrowRight: 0.01, ArrowUp: 0.01, PageDown: -0.1, PageUp: 0.1,
      Home: -1, End: 1 };
    if (!(event.key in steps)) return;
    event.preventDefault();
    stopSway();
    set({ line: clamp(Math.round((state.line + steps[event.key]) * 1000) / 1000, 0, 1) });
  });
}
