"""Do orders 1 and 2 beat order 0 if the derivatives are taken over a width as large as the shift?

    scripts/venv python -m bench.widths [--size WxH] [--kage FILE] [SCENE ...]

kage takes the derivatives of sampled heights over one sample to either side. On steep terrain the shift is many samples
long, and such a derivative says little about the height at its end. This script forms the orders anew, in numpy, from
kage's layers and from the heights, with derivatives of a coarser level of a pyramid. A level's samples are the means of
1 x 1, 2 x 2, 4 x 4, ... heights, and its derivatives are central differences of these, over one of them to either
side. Between samples all are interpolated bilinearly. `shift` is the width that is chosen at each pixel: as large as
order 0's shift there, interpolated between levels. `shift/2` and `shift*2` are half and twice as large.

The table gives the wrong pixels of the cast shadow against `--shadow exact`, in % of the true shadow's. P itself is
either looked up at the pixel's place, as in kage, or averaged over the same width. Width 1 is kage's own: the script
fails if its shadow is not kage's.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench import package, programs
from bench.programs import KAGE, TOP, Size
from reference import references

LEVELS = 8  # widths of 1 to 128 samples
WIDTHS = tuple(2**k for k in range(LEVELS))
SHIFTS = {"shift/2": 0.5, "shift": 1.0, "shift*2": 2.0}
ORDERS = (0, 1, 2)
OTHERS = ("iter:2", "iter:4", "march:4")  # kage's own, to compare with
CLOSE = 2e-6  # scene units: kage's heights are floats
FEW = 1e-4  # of the pixels: kage rounds to float, this script to double

Layers = dict[str, np.ndarray]


class WidthsError(Exception):
    """What does not agree with kage."""


@dataclass(frozen=True)
class Scene:
    """What the script must know of a scene's file: a plane with a map of heights, and an object above it."""

    name: str
    eye: tuple[float, float, float]
    origin: tuple[float, float, float]  # Q = origin + u Qu + w Qw
    Qu: tuple[float, float, float]
    Qw: tuple[float, float, float]
    light: tuple[float, float, float]
    size: tuple[float, float]  # of the map, in (u,w)
    corners: bool  # n samples span n - 1 cells and the map is clamped; otherwise n cells, and it repeats
    caster: tuple[tuple[float, ...], ...]  # a sphere: centre and (radius,); a box: two corners

    def heights(self) -> np.ndarray:
        """P at the samples: rows by w, columns by u."""
        data = TOP / "scenes" / "data"
        if self.name == "terrain":
            return 0.001 * (references.read_exr(data / "jacksboro.exr")["elevation"].astype(float) - 531)
        from PIL import Image

        with Image.open(data / "bumps.png") as image:
            return 0.22 * (np.array(image, dtype=float) / 65535 - 0.417)


SCENES = {scene.name: scene for scene in (
    Scene("terrain", (0, 7.5, -9), (-6, 0, 6.38), (12, 0, 0), (0, 0, -12.76), (-60, 55, -8), (1, 1), True,
          ((-0.8, 1.9, -0.9), (0.8,))),
    Scene("cube", (0.2, 4.3, -5.6), (-6, 0, -6), (0, 0, 1), (1, 0, 0), (-4.4, 5.8, -2.6), (12, 12), False,
          ((-0.6, 0.55, -0.6), (0.6, 1.75, 0.6))),
)}


# Heights and their derivatives ------------------------------------------------------------------------

@dataclass(frozen=True)
class Bump:
    """P and its partials at each pixel, by (u,w)."""

    P: np.ndarray
    Pu: np.ndarray
    Pw: np.ndarray
    Puu: np.ndarray
    Pww: np.ndarray


def level(heights: np.ndarray, width: int, repeat: bool) -> np.ndarray:
    """Means of width x width heights, and their central differences by samples: rows x columns x 5, as in Bump."""
    rows, columns = heights.shape
    whole = np.pad(heights, ((0, -rows % width), (0, -columns % width)), mode="edge")
    mean = whole.reshape(whole.shape[0] // width, width, whole.shape[1] // width, width).mean(axis=(1, 3))
    p = np.pad(mean, 1, mode="wrap" if repeat else "edge")
    here, left, right, above, below = p[1:-1, 1:-1], p[1:-1, :-2], p[1:-1, 2:], p[:-2, 1:-1], p[2:, 1:-1]
    return np.stack([here, (right - left) / (2 * width), (below - above) / (2 * width),
                     (right - 2 * here + left) / width**2, (below - 2 * here + above) / width**2], axis=-1)


class Pyramid:
    """The levels, and look-ups at places x, y: columns and rows of the finest."""

    def __init__(self, heights: np.ndarray, repeat: bool) -> None:
        self.repeat = repeat
        self.levels = [level(heights, width, repeat) for width in WIDTHS]

    def bilinear(self, k: int, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        table, width = self.levels[k], WIDTHS[k]
        rows, columns = table.shape[:2]
        x, y = (x + 0.5) / width - 0.5, (y + 0.5) / width - 0.5
        if not self.repeat:
            x, y = np.clip(x, 0, columns - 1), np.clip(y, 0, rows - 1)
        i, j = np.floor(x).astype(int), np.floor(y).astype(int)
        a, b = (x - i)[:, None], (y - j)[:, None]
        # past a clamped end the weight is 0, so any sample will do there
        i0, i1, j0, j1 = i % columns, (i + 1) % columns, j % rows, (j + 1) % rows
        found: np.ndarray = (table[j0, i0] * (1 - a) + table[j0, i1] * a) * (1 - b) + \
                            (table[j1, i0] * (1 - a) + table[j1, i1] * a) * b
        return found

    def trilinear(self, width: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Between the levels next to a width; linear in its logarithm, as mip maps are."""
        place = np.clip(np.log2(np.maximum(width, 1)), 0, LEVELS - 1)
        found = np.zeros((*x.shape, 5))
        for k in range(LEVELS):
            weight = np.maximum(0, 1 - np.abs(place - k))
            some = weight > 0
            found[some] += weight[some, None] * self.bilinear(k, x[some], y[some])
        return found


# The method -------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Rays:
    """The viewing rays r + s t that meet the receiver, each at t = 1, in the picture's order."""

    Q: np.ndarray
    s: np.ndarray
    sn: np.ndarray  # s.n/|n|
    a: np.ndarray  # du/dt and dw/dt
    b: np.ndarray
    x: np.ndarray  # the place among the samples
    y: np.ndarray
    per_u: float  # samples
    per_w: float

    def bump(self, found: np.ndarray) -> Bump:
        """Derivatives by (u,w) from those by samples."""
        u, w = self.per_u, self.per_w
        return Bump(*np.moveaxis(found * np.array([1, u, w, u * u, w * w]), -1, 0))


def rays_of(scene: Scene, u: np.ndarray, w: np.ndarray, heights: np.ndarray) -> Rays:
    along_u, along_w = np.array(scene.Qu, dtype=float), np.array(scene.Qw, dtype=float)
    n = np.cross(along_u, along_w)
    place = np.array(scene.origin) + u[:, None] * along_u + w[:, None] * along_w
    s, n2 = place - np.array(scene.eye), float(n @ n)
    less, half = (1, 0.0) if scene.corners else (0, 0.5)
    per_u, per_w = (heights.shape[1] - less) / scene.size[0], (heights.shape[0] - less) / scene.size[1]
    return Rays(place, s, s @ n / np.sqrt(n2), s @ np.cross(along_w, n) / n2, s @ np.cross(n, along_u) / n2,
                u * per_u - half, w * per_w - half, per_u, per_w)


def shift(order: int, rays: Rays, p: Bump, lowest: float, highest: float) -> tuple[np.ndarray, np.ndarray]:
    """tau of a paper's order with kage's guard, and the order really used; every ray comes from the front."""
    front, back = highest / rays.sn, lowest / rays.sn
    slope = p.Pu * rays.a + p.Pw * rays.b - rays.sn
    tau, used = p.P / rays.sn, np.zeros(rays.sn.shape, dtype=int)
    half = 0.5 * (p.Puu * rays.a**2 + p.Pww * rays.b**2)
    with np.errstate(divide="ignore", invalid="ignore"):
        roots = (-p.P / slope, -2 * p.P / (slope + np.sqrt(slope**2 - 4 * half * p.P)))
    for k, root in enumerate(roots[:order], start=1):
        good = (slope > 0) & (root >= front) & (root <= back)  # NaN is not
        tau, used = np.where(good, root, tau), np.where(good, k, used)
    return tau, used


def in_shadow(scene: Scene, start: np.ndarray) -> np.ndarray:
    """Whether the caster is between the place and the light."""
    d = np.array(scene.light) - start
    one, two = (np.array(x) for x in scene.caster)
    if len(two) == 1:
        away = start - one
        a, b, c = (d * d).sum(-1), (away * d).sum(-1), (away * away).sum(-1) - two[0] ** 2
        root = np.sqrt(np.maximum(b * b - a * c, 0))
        first, last = (-b - root) / a, (-b + root) / a
    else:
        t, u = (one - start) / d, (two - start) / d
        first, last = np.minimum(t, u).max(axis=-1), np.maximum(t, u).min(axis=-1)
    hit: np.ndarray = (first < last) & (last > 0) & (first < 1)
    return hit


# The table --------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Row:
    """Of one width: % of wrong pixels by order with P at the place, then with P averaged; % that fell back."""

    width: str
    own: tuple[float, ...]
    averaged: tuple[float, ...]
    fell_back: tuple[float, ...]


def render(kage: Path, scene: Scene, size: Size, method: str) -> Layers:
    file, options = f"scenes/{scene.name}.yaml", ("--shadow", method, "--no-self-shadow", *programs.size_options(size))
    made = package.render(kage, file, options)
    if made is not None:
        return made
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.exr"
        programs.run([kage, "render", file, *options, "-o", path, "--quiet"])
        return references.read_exr(path)


class Picture:
    """A scene in kage's layers, with the true shadow."""

    def __init__(self, kage: Path, scene: Scene, size: Size) -> None:
        self.kage, self.scene, self.size = kage, scene, size
        layers = render(kage, scene, size, "exact")
        self.receiver = layers["order"] >= 0
        self.truth = self.dark(layers)
        if not self.truth.any():
            raise WidthsError(f"{scene.name}: there is no shadow in the picture")
        heights = scene.heights()
        self.lowest, self.highest = float(heights.min()), float(heights.max())
        self.rays = rays_of(scene, layers["uw.u"][self.receiver].astype(float),
                            layers["uw.w"][self.receiver].astype(float), heights)
        self.pyramid = Pyramid(heights, not scene.corners)
        self.finest = self.pyramid.bilinear(0, self.rays.x, self.rays.y)
        if not np.allclose(self.finest[:, 0], layers["height"][self.receiver], rtol=0, atol=CLOSE):
            raise WidthsError(f"{scene.name}: the heights are not those of kage's layer `height`")

    def dark(self, layers: Layers) -> np.ndarray:
        """Of the receiver's pixels, in a row."""
        light = next(name for name in layers if name.startswith("visibility."))
        dark: np.ndarray = layers[light][self.receiver] == 0
        return dark

    def shadow(self, order: int, found: np.ndarray) -> tuple[np.ndarray, float]:
        """Of the receiver's pixels, and how many % of these fell back."""
        tau, used = shift(order, self.rays, self.rays.bump(found), self.lowest, self.highest)
        return in_shadow(self.scene, self.rays.Q + self.rays.s * tau[:, None]), 100 * float((used < order).mean())

    def wrong(self, dark: np.ndarray) -> float:
        return 100 * float((dark != self.truth).sum()) / float(self.truth.sum())

    def check(self) -> None:
        """Width 1 is kage's own."""
        for order in ORDERS:
            kages = self.dark(render(self.kage, self.scene, self.size, str(order)))
            differ = int((self.shadow(order, self.finest)[0] != kages).sum())
            if differ > FEW * len(kages):
                raise WidthsError(f"{self.scene.name}: order {order} at width 1 differs from kage in {differ} pixels")

    def lengths(self) -> np.ndarray:
        """Of order 0's shift at each pixel, in samples."""
        rays = self.rays
        found: np.ndarray = np.hypot(rays.a * rays.per_u, rays.b * rays.per_w) * np.abs(self.finest[:, 0] / rays.sn)
        return found

    def look_ups(self) -> Iterator[tuple[str, np.ndarray]]:
        """P and its derivatives at each width."""
        rays, length = self.rays, self.lengths()
        yield from ((str(width), self.pyramid.bilinear(k, rays.x, rays.y)) for k, width in enumerate(WIDTHS))
        yield from ((name, self.pyramid.trilinear(c * length, rays.x, rays.y)) for name, c in SHIFTS.items())

    def rows(self) -> Iterator[Row]:
        for width, averaged in self.look_ups():
            own = np.concatenate([self.finest[:, :1], averaged[:, 1:]], axis=-1)
            kept = [self.shadow(order, own) for order in ORDERS]
            yield Row(width, tuple(self.wrong(dark) for dark, _ in kept),
                      tuple(self.wrong(self.shadow(order, averaged)[0]) for order in ORDERS),
                      tuple(fell for _, fell in kept))

    def others(self) -> dict[str, float]:
        return {method: self.wrong(self.dark(render(self.kage, self.scene, self.size, method))) for method in OTHERS}


def table(rows: Sequence[Row]) -> str:
    """In Markdown."""
    heads = [*(f"order {k}" for k in ORDERS), *(f"order {k}, P averaged" for k in ORDERS),
             *(f"order {k} fell back" for k in ORDERS[1:])]
    lines = [["width", *heads], ["---", *(["---:"] * len(heads))]]
    for row in rows:
        figures = (*row.own, *row.averaged, *row.fell_back[1:])
        lines.append([row.width, *(f"{figure:.2f}" for figure in figures)])
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(prog="python -m bench.widths", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"{', '.join(SCENES)} (all)")
    parser.add_argument("--size", default="640x480", metavar="WxH", help="of the picture (640x480)")
    parser.add_argument("--kage", type=Path, default=KAGE, metavar="FILE", help="the program (build/float/kage)")
    options = parser.parse_args(arguments)
    width, height = (int(x) for x in options.size.split("x"))
    for name in options.scenes or SCENES:
        picture = Picture(options.kage.resolve(), SCENES[name], (width, height))
        picture.check()
        others = ", ".join(f"{method} {wrong:.2f}" for method, wrong in picture.others().items())
        typical = float(np.median(picture.lengths()[picture.truth]))
        print(f"{name}, {options.size}: wrong pixels in % of the true shadow's {int(picture.truth.sum())}; the shift's "
              f"median there {typical:.1f} samples; kage's {others}\n\n{table(list(picture.rows()))}\n")


if __name__ == "__main__":
    main()
