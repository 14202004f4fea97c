
/* ---- frames: only where something has changed ---- */

const MOST_PIXELS = 2.4e6, SLOW = 28, QUICK = 12, REFINED = 60, STILL = 220; /* milliseconds */
const plain = (x) => x.toFixed(x < 10 ? 1 : 0);
let asked = false, busy = false, dirty = false, coarse = 1, refineTimer = 0, count = 0;

/* The canvas in device pixels, at most MOST_PIXELS. */
function fullSize() {
  const ratio = Math.min(devicePixelRatio || 1, 2), width = canvas.clientWidth * ratio, height = width * 3 / 4;
  const k = Math.min(1, Math.sqrt(MOST_PIXELS / (width * height)));
  return [Math.max(Math.round(width * k), 16), Math.max(Math.round(height * k), 12)];
}

function request() {
  dirty = true;
  if (asked || busy || !gl || gl.isContextLost() || canvas.hidden) return;
  asked = true;
  requestAnimationFrame(frame);
}

function frame() {
  asked = false;
  if (!gl || gl.isContextLost()) return;
  dirty = false;
  clearTimeout(refineTimer);
  tryFrame(performance.now() - moving < STILL ? coarse : 1, 1);
}

/* A method's program is made when it is first drawn: some card may refuse it. */
function tryFrame(share, side) {
  try {
    drawFrame(share, side);
  } catch (error) {
    failed(notWorking(error));
  }
}

const notWorking = (error) =>
  `The live picture does not work here (${error.message}). This one was made by kage itself.`;

function drawFrame(share, side) {
  const [width, height] = fullSize().map((n) => Math.max(Math.round(n * share), 8)), start = performance.now();
  busy = !isReady(state, width);
  if (busy) { /* the old picture stays meanwhile */
    setTimeout(() => { busy = false; request(); }, 15);
    return;
  }
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  busy = true;
  drawPicture(state, width, height, side);
  const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
  gl.flush();
  const poll = () => {
    if (gl.isContextLost()) { busy = false; return; }
    if (gl.clientWaitSync(fence, 0, 0) === gl.TIMEOUT_EXPIRED) { setTimeout(poll, 1); return; }
    gl.deleteSync(fence);
    frameDone(performance.now() - start, share, side, `${width} × ${height}`);
  };
  setTimeout(poll, 0);
}

/* The picture is coarser while it moves if it is slow. Once it stands it is drawn whole, then with 2 x 2 samples. */
function frameDone(ms, share, side, size) {
  busy = false;
  introduce(ms);
  const whole = ms / (share * share * side * side);
  count++;
  still.hidden = true;
  if (side === 1) {
    const rate = 1000 / Math.max(ms, 1);
    $("readout").textContent = `${plain(ms)} ms a frame, ${plain(rate)} a second; ${size}`;
    coarse = clamp(Math.sqrt((ms > SLOW || coarse < 1 ? (SLOW + QUICK) / 2 : whole) / whole), 0.25, 1);
  }
  if (dirty) { request(); return; }
  const left = Math.max(STILL - (performance.now() - moving), 0) + 30;
  if (swaying) return;
  if (share < 1) refineTimer = setTimeout(request, left);
  else if (side === 1 && whole < REFINED) refineTimer = setTimeout(() => !asked && !busy && gl && tryFrame(1, 2), left);
}

/* ---- what moves by itself: the line, once at the start, and the light, if it is asked to ---- */

let swaying = null;

/* Changes of the state by the time in seconds, until there are none or stopSway. `pressed`: by the button. */
function startSway(changes, after, pressed) {
  const start = performance.now(), self = { after };
  swaying = self;
  $("play").setAttribute("aria-pressed", String(pressed));
  const step = (now) => {
    if (swaying !== self) return;
    const to = changes(Math.max(now - start, 0) / 1000);
    if (!to) { stopSway(); return; }
    move();
    Object.assign(state, to);
    show();
    request();
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}

function stopSway() {
  if (!swaying) return;
  Object.assign(state, swaying.after);
  swaying = null;
  $("play").setAttribute("aria-pressed", "false");
  show();
  request();
}

function swayLight() {
  const [around, up] = state.light;
  startSway((t) => ({ light: [around + 24 * Math.sin(t * Math.PI / 2), up] }), { light: [around, up] }, true);
}

/* From the right over the shadow to the middle. */
function sweepLine() {
  const { line } = START;
  const at = (t) => line + 0.4 * Math.cos(t / 3 * 2.5 * Math.PI) * (1 - t / 3);
  startSway((t) => (t < 3 ? { line: at(t) } : null), { line }, false);
}

/* The line moves after the first picture, and not on where that is slow. */
function introduce(ms) {
  if (count === 0 && !location.hash && !reducedMotion.matches) sweepLine();
  else if (count > 3 && ms > SLOW * 4 && swaying && $("play").getAttribute("aria-pressed") === "false") stopSway();
}

/* ---- start, and where WebGL is missing or lost ---- */

function notice(text) {
  $("notice").textContent = text;
  $("notice").hidden = !text;
}

function showLive(live) {
  for (const element of [canvas, divider, $("chip-left"), $("chip-right")]) element.hidden = !live;
  if (!live) still.hidden = false;
}

function failed(text) {
  gl = null;
  stopSway();
  showLive(false);
  $("readout").textContent = "";
  notice(text);
}

canvas.addEventListener("webglcontextlost", (event) => {
  event.preventDefault();
  busy = asked = false;
  showLive(false);
  notice("The graphics card was lost. This picture was made by kage; the live one returns when the card does.");
});
canvas.addEventListener("webglcontextrestored", () => {
  startGl();
  showLive(true);
  notice("");
  request();
});

async function start() {
  Object.assign(state, stateOf(location.hash.slice(1)));
  startControls();
  show();
  startPointer();
  if (!startGl()) {
    failed("This browser has no WebGL 2, which the live picture needs. This one was made by kage itself.");
    return;
  }
  try { /* older browsers have WebGL 2, but cannot inflate */
    for (const name of Object.keys(maps)) samplesOf[name] = await readMap(name);
  } catch (error) {
    failed(notWorking(error));
    return;
  }
  showLive(true);
  tryFrame(1, 1);
  new ResizeObserver(request).observe(canvas);
}

/* For tests, and for the console: the state, and the pixels of one method, from the top left. */
globalThis.live = {
  state, set,
  pixels(width, height, method, side = 1) {
    const target = gl.createFramebuffer(), color = gl.createRenderbuffer(), out = new Uint8Array(width * height * 4);
    gl.bindRenderbuffer(gl.RENDERBUFFER, color);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA8, width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, color);
    drawPicture({ ...state, left: method, line: 1 }, width, height, side);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.deleteFramebuffer(target);
    gl.deleteRenderbuffer(color);
    return out;
  },
  uniforms: (width, height) => uniformsOf(state, width, height, 1),
  get frame() { return { count, busy: busy || asked, moves: swaying !== null, width: canvas.width, coarse }; },
};
start();
})();
