
/* ---- camera: as src/scene/camera.c: left-handed, x to the right, y up, z away ---- */

const add = (a, b, k = 1) => a.map((x, i) => x + k * b[i]);
const times = (a, k) => a.map((x) => x * k);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => times(a, 1 / Math.sqrt(dot(a, a)));
const DEGREE = Math.PI / 180;

/* How far up a turned direction may be: not below a flat ground, and never straight up. */
const lowest = (scene) => (scene.ground.kind === "sphere" ? -80 : 6);
const HIGHEST = 86;

/* `from` turned about `at` by degrees, up within bounds, at `far` times its distance. */
function turned(from, at, [around, up], far, low) {
  const d = add(from, at, -1), length = Math.sqrt(dot(d, d));
  if (around === 0 && up === 0 && far === 1) return from; /* the scene's own, to the last digit */
  const az = Math.atan2(d[0], -d[2]) + around * DEGREE;
  const el = clamp(Math.asin(d[1] / length) / DEGREE + up, low, HIGHEST) * DEGREE;
  const way = [Math.sin(az) * Math.cos(el), Math.sin(el), -Math.cos(az) * Math.cos(el)];
  return add(at, times(way, length * far));
}

const eyeOf = (s, scene) => turned(scene.camera.from, scene.camera.at, s.eye, s.eye[2], lowest(scene));
const lightOf = (s, scene) => turned(scene.light.at, scene.camera.at, s.light, 1, lowest(scene));

/* Of how far up the eye or the light may still be turned, so that the state does not run on beyond the bounds. */
function clampUp(from, at, up, low) {
  const d = add(from, at, -1), own = Math.asin(d[1] / Math.sqrt(dot(d, d))) / DEGREE;
  return clamp(up, low - own, HIGHEST - own);
}

function cameraOf(s, scene, aspect) {
  const from = eyeOf(s, scene), forward = add(scene.camera.at, from, -1), right = unit(cross([0, 1, 0], forward));
  const half = Math.tan(scene.camera.fov * DEGREE / 2);
  return { eye_from: from, eye_forward: unit(forward), eye_right: times(right, half),
    eye_up: times(unit(cross(forward, right)), half / aspect) };
}
