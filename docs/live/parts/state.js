
/* ---- state: what the picture depends on, and the address bar's copy of it ---- */

/* eye: turned around, up, and its distance over the scene's; light: turned around and up. In degrees. */
const START = { scene: "cube", left: "none", right: "0", line: SCENES.cube.line, shade: false, own: false, height: 1,
  march: 8, steps: 24, eye: [0, 0, 1], light: [0, 0] };
const startOf = (scene) => ({ ...structuredClone(START), scene, line: SCENES[scene].line });
const state = startOf("cube");

const NUMBERS = { line: [0, 1], height: [0, 2], march: [1, 64], steps: [1, 64] };
const PAIRS = { eye: [[-180, 180], [-180, 180], [0.4, 2.5]], light: [[-180, 180], [-180, 180]] };

/* Take what of a text like "scene=cube&left=none" has a meaning; the rest is as at the start. */
function stateOf(text) {
  const given = new URLSearchParams(text), scene = given.get("scene");
  const s = startOf(Object.hasOwn(SCENES, scene) ? scene : START.scene);
  for (const side of ["left", "right"]) if (Object.hasOwn(METHODS, given.get(side))) s[side] = given.get(side);
  for (const key of ["shade", "own"]) s[key] = given.get(key) === "1";
  for (const [key, [lo, hi]] of Object.entries(NUMBERS)) {
    const x = parseFloat(given.get(key));
    if (Number.isFinite(x)) s[key] = clamp(lo === 1 ? Math.round(x) : x, lo, hi);
  }
  for (const [key, limits] of Object.entries(PAIRS)) {
    const x = (given.get(key) ?? "").split(",").map(parseFloat);
    if (x.length === limits.length && x.every(Number.isFinite)) s[key] = x.map((v, i) => clamp(v, ...limits[i]));
  }
  return s;
}

function textOf(s) {
  const short = (x) => String(Math.round(x * 1000) / 1000), words = new URLSearchParams(), first = startOf(s.scene);
  for (const key of Object.keys(START)) {
    const x = s[key], text = Array.isArray(x) ? x.map(short).join() : x === true ? "1" : x === false ? "0" :
      typeof x === "number" ? short(x) : x;
    if (key === "scene" ? x !== START.scene : String(x) !== String(first[key])) words.set(key, text);
  }
  return words.toString().replaceAll("%2C", ",");
}

let addressTimer = 0;

/* Not at each movement: browsers allow about a hundred in half a minute. */
function noteAddress() {
  clearTimeout(addressTimer);
  addressTimer = setTimeout(() => {
    const text = textOf(state);
    if (location.hash.slice(1) !== text)
      history.replaceState(null, "", text ? "#" + text : location.pathname + location.search);
  }, 250);
}
