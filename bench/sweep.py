"""When to use which method: wrong shadow pixels over slopes, angles and frequencies; the error over the amplitude.

The scenes are `waves` (a function) and `cube` (samples), with a cube over a plane. The light moves up and down around
the cube, and the eye around the middle of the shadow. The truth is kage's `exact`.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench import programs, quality
from bench.plan import Bench, Facts
from bench.programs import Size
from bench.runner import Job, Stage
from bench.store import Inputs, Value

CODE = programs.file_digest(Path(__file__))
LEAST_SHADOW = 200  # pixels; a share of fewer says little

CENTRE = {"waves": 1.05, "cube": 1.15}  # height of the cube's middle
SCALE = {"waves": 0.03, "cube": 0.22}  # of the bumps, in the scene's file
LIGHT_FROM, EYE_FROM = 211.0, 278.0  # compass of the light and of the eye, degrees from +x towards +z
LIGHT_DISTANCE, EYE_DISTANCE = 7.5, 6.5
SIZE = (320, 240)


@dataclass(frozen=True)
class Place:
    """Where in a sweep. Angles are in degrees above the ground. `slope`: 95 % of the slopes in the view are below."""

    slope: float = 0.35
    view: float = 40
    light: float = 45
    frequency: float = 1.0
    width: int = SIZE[0]

    @property
    def size(self) -> Size:
        return self.width, self.width * SIZE[1] // SIZE[0]


def direction(compass: float, above: float) -> np.ndarray:
    a, b = math.radians(compass), math.radians(above)
    return np.array([math.cos(b) * math.cos(a), math.sin(b), math.cos(b) * math.sin(a)])


def vector(v: np.ndarray) -> str:
    return "[" + ", ".join(f"{x:.6f}" for x in v) + "]"


def changes(scene: Facts, place: Place) -> dict[str, object]:
    """What to set in the scene's file for a place in a sweep."""
    height, f = CENTRE[scene.name], place.frequency
    light = np.array([0, height, 0]) + LIGHT_DISTANCE * direction(LIGHT_FROM, place.light)
    shadow = -light * height / (light[1] - height)  # of the cube's middle on the ground
    target = np.array([shadow[0], 0, shadow[2]]) * min(1, 3 / np.hypot(shadow[0], shadow[2]))
    eye = target + EYE_DISTANCE * direction(EYE_FROM, place.view)
    bump = f"objects.{scene.receiver}.bump"
    sets: dict[str, object] = {
        f"lights.{scene.light}.at": vector(light),
        "camera.from": vector(eye), "camera.at": vector(target), "camera.fov": 42,
        f"{bump}.scale": f"{SCALE[scene.name] * place.slope / scene.slope_95 / f:.8g}",
    }
    if f != 1 and scene.name == "waves":
        sets[f"{bump}.function"] = f"sin({6 * f:g}*w)*cos({5.4 * f:g}*u) + 0.5*sin({10.2 * f:g}*w + {6.6 * f:g}*u)"
    if f != 1 and scene.name == "cube":
        sets[f"{bump}.size"] = f"[{12 / f:g}, {12 / f:g}]"
    return sets


def render(bench: Bench, scene: Facts, sets: dict[str, object], size: Size, method: str, layers: str) -> quality.Layers:
    options = (*programs.method_options(method), *programs.set_options(sets))
    return quality.render(bench, scene, size, options, layers)


# Wrong pixels over two axes -----------------------------------------------------------------------

AXES = {
    "slope": "slope of the bumps (95 % are below)",
    "view": "eye above the ground, degrees",
    "light": "light above the ground, degrees",
    "frequency": "frequency of the bumps (1: as in the scene), at the same slope",
    "width": "width of the picture, pixels",
}
TITLES = {
    "slope-view": "Slope of the bumps, and height of the eye",
    "slope-light": "Slope of the bumps, and height of the light",
    "frequency-width": "Frequency of the bumps, and size of the pixels",
}


@dataclass(frozen=True)
class Sweep:
    """Places in a scene: each x with each y."""

    scene: str
    x: str
    y: str
    xs: tuple[float, ...]
    ys: tuple[float, ...]

    @property
    def id(self) -> str:
        return f"{self.x}-{self.y}"

    def place(self, i: int, j: int) -> Place:
        return Place(**{self.x: self.xs[i], self.y: self.ys[j]})  # type: ignore[arg-type]

    def about(self) -> str:
        p = Place()
        fixed = {"slope": f"slope {p.slope:g}", "view": f"eye {p.view:g} degrees above the ground",
                 "light": f"light {p.light:g} degrees above it", "width": f"{p.size[0]} x {p.size[1]} pixels"}
        return ", ".join(text for name, text in fixed.items() if name not in (self.x, self.y))


def sweeps(bench: Bench) -> list[Sweep]:
    level = bench.level
    plan = (("slope", "view", level.slopes, level.angles), ("slope", "light", level.slopes, level.angles),
            ("frequency", "width", level.frequencies, level.widths))
    return [Sweep(scene, x, y, tuple(xs), tuple(ys)) for scene in level.sweep_scenes if scene in bench.scenes
            for x, y, xs, ys in plan if xs]


def methods(bench: Bench) -> tuple[str, ...]:
    return tuple(m for m in bench.level.methods if m not in ("exact", "displaced"))


def measure_cell(bench: Bench, scene: Facts, place: Place) -> Value:
    """Wrong pixels of each method, and pixels of the shadow. The plane faces the light, so all its pixels count."""
    layers = "visibility,order"
    sets = changes(scene, place)
    exact = render(bench, scene, sets, place.size, "exact", layers)
    seen, truth = exact["order"] >= 0, quality.in_shadow(exact, scene)
    wrong = {}
    for method in methods(bench):
        got = render(bench, scene, sets, place.size, method, layers)
        wrong[method] = int((seen & (quality.in_shadow(got, scene) != truth)).sum())
    return {"shadow": int((seen & truth).sum()), "wrong": wrong}


# The error's slope in the amplitude ---------------------------------------------------------------

AMPLITUDES = tuple(0.35 * 2 ** (-k / 2) for k in range(8))  # as the slope that 95 % are below
SLOPE_METHODS = ("0", "1", "2", "2+", "iter:2")
THEORY: dict[str, dict[str, float]] = {
    "waves": {"0": 2, "1": 3, "2": 3, "2+": 4, "iter:2": 3},
    "sphere": {"0": 2, "1": 2, "2": 2, "2+": 3, "iter:2": 2},
}
# A smooth function in place of the map.
ON_SPHERE = "{function: '0.04*sin(9*u)*sin(8*w) + 0.02*sin(5*u + 6*w)', scale: 1}"
ON_SPHERE_SLOPE = 0.30  # 95 % below, by `kage check`


def amplitude_sets(scene: Facts, slope: float) -> dict[str, object]:
    bump = f"objects.{scene.receiver}.bump"
    if scene.name == "waves":
        return {f"{bump}.scale": f"{SCALE['waves'] * slope / scene.slope_95:.8g}"}
    return {bump: ON_SPHERE, f"{bump}.scale": f"{slope / ON_SPHERE_SLOPE:.8g}"}


def measure_amplitude(bench: Bench, scene: Facts, slope: float) -> Value:
    """The median error of tau, in scene units."""
    sets = amplitude_sets(scene, slope)
    exact = render(bench, scene, sets, SIZE, "exact", "tau,order")
    found = exact["order"] == quality.ORDER_CODES["exact"]
    error = {}
    for method in SLOPE_METHODS:
        got = render(bench, scene, sets, SIZE, method, "tau,order")
        error[method] = float(f"{np.median(np.abs(got['tau'] - exact['tau'])[found]):.6g}")
    return {"error": error}


# Jobs ---------------------------------------------------------------------------------------------


def inputs(bench: Bench, scene: Facts, **more: object) -> Inputs:
    return {"kage": bench.kage_digest, "scene": scene.digest, "code": CODE, **more}


def cell_job(bench: Bench, sweep: Sweep, i: int, j: int) -> Job:
    scene, place = bench.scenes[sweep.scene], sweep.place(i, j)
    seconds = 0.4 * (place.width / SIZE[0]) ** 2 + 0.2
    return Job(f"sweep {sweep.scene} {sweep.id} {sweep.xs[i]:g} {sweep.ys[j]:g}",
               inputs(bench, scene, methods=list(methods(bench))),
               functools.partial(measure_cell, bench, scene, place), Stage.MEASURES, seconds)


def amplitude_job(bench: Bench, scene: Facts, slope: float) -> Job:
    return Job(f"amplitude {scene.name} {slope:.4f}", inputs(bench, scene),
               functools.partial(measure_amplitude, bench, scene, slope), Stage.MEASURES, 0.5)


def sloped(bench: Bench) -> list[Facts]:
    return [scene for name, scene in bench.scenes.items() if name in THEORY]


def jobs(bench: Bench) -> list[Job]:
    cells = [cell_job(bench, sweep, i, j)
             for sweep in sweeps(bench) for j in range(len(sweep.ys)) for i in range(len(sweep.xs))]
    return cells + [amplitude_job(bench, scene, slope) for scene in sloped(bench) for slope in AMPLITUDES]


def by_cost(costs: dict[str, float], names: Sequence[str]) -> list[str]:
    """The names, the cheapest first; those whose cost is not known come last."""
    return sorted(names, key=lambda name: costs.get(name, math.inf))
