/* kage's page: state, camera, maps, drawing, code, controls. One function, so that nothing is global but `live`. */
(() => {
"use strict";

const $ = (id) => document.getElementById(id);
const { scenes, maps } = JSON.parse($("scenes").textContent);
const still = $("still"), canvas = $("canvas"), divider = $("divider");
const reducedMotion = matchMedia("(prefers-reduced-motion: reduce)");
const clamp = (x, lo, hi) => Math.min(Math.max(x, lo), hi);

/* `line`: where it begins, over the shadow. */
const SCENES = {
  cube: { name: "Cube", line: 0.5, story: "Figures 4 to 7 of the paper: a cube over a bumpy ground." },
  sphere: { name: "Sphere", line: 0.42, story: "Figure 8: the shadow of a box on a bumpy sphere." },
  terrain: {
    name: "Terrain", line: 0.64,
    story: "Measured heights under a low sun, as in section 4.3 of the paper, with a balloon over them.",
  },
};

/* By the names of `kage --shadow`. Of bumpshadow.glsl `formula` is shown first and
 * `around` last; `on` are the lines to point at, `branch` that of tau_find. */
const METHODS = {
  none: {
    name: "bump only", long: "bump only",
    story: "The shadow ray starts at the smooth hit, as in every renderer with bump mapping. The shadow’s edge does "
      + "not know of the bumps: the object seems to float.",
    formula: [], around: [], branch: "    return 0.0;", on: [],
  },
  0: {
    name: "0", long: "order 0",
    story: "The viewing ray is cut with a plane at the height P of this pixel. One division; the edge follows the "
      + "bumps.",
    formula: ["bs_tau0"], around: ["bs_shift_of"], branch: "bs_shift_of(0,",
    on: ["return P / v.sn;", "s.tau = bs_tau0"],
  },
  1: {
    name: "1", long: "order 1",
    story: "The viewing ray is cut with the tangent plane of the rough surface: the slope of P counts, too.",
    formula: ["bs_tau1", "bs_slope"], around: ["bs_shift_of"], branch: "bs_shift_of(1,",
    on: ["return -p.P / bs_slope", "return p.Pu * v.a", "float tau = bs_tau1", "s.tau = good ? tau"],
  },
  2: {
    name: "2", long: "order 2",
    story: "A quadric, by the second differences along u and w. The best of the paper where slopes are small; on the "
      + "steep terrain order 0 is better.",
    formula: ["bs_tau2", "bs_quadratic", "bs_discriminant"], around: ["bs_shift_of"], branch: "bs_shift_of(2,",
    on: ["return -2.0 * P", "return 0.5 * (p.Puu", "tau = bs_tau2", "s.tau = good ? tau"],
  },
  "2+": {
    name: "2+", long: "order 2+",
    story: "kage’s: order 2 with the cross term of P and the curvature of the smooth surface.",
    formula: ["bs_tau2", "bs_quadratic_plus", "bs_curvature"], around: ["bs_shift_of"], branch: "bs_shift_of(3,",
    on: ["return -2.0 * P", "bs_quadratic(v, p) + p.Puw", "dot(Quu, n)", "tau = bs_tau2",
      "s.tau = good ? tau"],
  },
  march: {
    name: "march", long: "march",
    story: "kage’s: a few equal steps between the lowest and the highest P, to the first place below the rough "
      + "surface, and one secant step back. Also good on the steep terrain.",
    formula: ["bs_gap", "bs_march_step"], around: ["bs_march_tau", "bs_march_start"], branch: "m = bs_march_step",
    on: ["return tau * v.sn", "secant = m.tau", "m.tau = hit ?"],
  },
  displaced: {
    name: "displaced", long: "true displacement",
    story: "The rough surface itself, met by steps of half a sample each: what the others approximate, at dozens of "
      + "look-ups a pixel. It has its own silhouette, and its bumps hide and shadow each other.",
    formula: [], around: [], branch: "", on: [],
  },
};
const DEFINES = { none: "NONE", 0: "ORDER_0", 1: "ORDER_1", 2: "ORDER_2", "2+": "ORDER_2_PLUS", march: "MARCH",
  displaced: "DISPLACED" };
const ORDER = ["none", "0", "1", "2", "2+", "march", "displaced"]; /* objects put numbers first */
const KEYS = { n: "none", 0: "0", 1: "1", 2: "2", 3: "2+", m: "march", d: "displaced" };
