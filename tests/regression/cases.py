"""The pictures that must stay as they are: the cases, how they are compared, and the page that shows old and new.

A case is a scene and a method: each of scenes/ by every method at 128x96, and those of this folder, which show what the
others have not (lights, colours, mirrors, glass, surfaces by their points), as they say themselves at 80x60. Its
picture is kept beside this file as an EXR with R, G, B and tau in half floats, some 50 and 15 kB each.

Tolerance: kage's bytes are the same on every processor, with any compiler and any number of threads, so on unchanged
code nothing differs at all. A change may round sums differently in float's last bits, which can turn the rounding to
half: two values that are neighbours among half floats are the same. No pixel is excepted: a shadow that moves by one
pixel is a change that somebody must look at, and accept.
"""

from __future__ import annotations

import html
import os
import shlex
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from bench import images
from reference import references
from tests.conftest import PROGRAM, TOP

HERE = Path(__file__).resolve().parent
OUT = TOP / "out" / "regression"
SIZES = {"scenes": "128x96", "tests/regression": "80x60"}
CHANNELS = ("R", "G", "B", "tau")
AMPLIFY = 8  # of differences, so that 1/255 can be seen

METHODS: dict[str, tuple[str, ...]] = {
    **{method: ("--shadow", method) for method in ("none", "0", "1", "2", "2+", "iter:4", "march:4", "exact")},
    "1-bare": ("--shadow", "1", "--no-guard"),
    "2-bare": ("--shadow", "2", "--no-guard"),
    "displaced": ("--surface", "displaced"),
    "displaced-cast": ("--surface", "displaced", "--no-self-shadow"),
    "auto": ("--shadow", "auto"),
    "relief": ("--relief",),
    "horizon": ("--shadow", "2", "--shade", "shifted", "--bump-shadow", "horizon"),
    "own-exact": ("--shadow", "march:4", "--bump-shadow", "exact"),
    "own": (),  # as the scene says
}

Layers = dict[str, np.ndarray]


@dataclass(frozen=True)
class Case:
    scene: str
    method: str
    folder: str = "scenes"

    @property
    def name(self) -> str:
        return f"{self.scene}-{self.method.replace(':', '')}"

    def command(self, output: Path) -> list[str]:
        """From the project's top folder."""
        return [os.path.relpath(PROGRAM, TOP), "render", f"{self.folder}/{self.scene}.yaml", *METHODS[self.method],
                "--size",
                SIZES[self.folder], "--quiet", "-o", os.path.relpath(output, TOP)]


CASES = (*(Case(scene.stem, method) for scene in sorted((TOP / "scenes").glob("*.yaml")) for method in METHODS
           if method != "own"),
         *(Case(scene.stem, "own", "tests/regression") for scene in sorted(HERE.glob("*.yaml"))))


def render(case: Case, folder: Path) -> Layers:
    path = folder / f"{case.name}.exr"
    subprocess.run(case.command(path), cwd=TOP, check=True, timeout=300)
    layers = references.read_exr(path)
    return {name: layers[name].astype(np.float16) for name in CHANNELS}


def rank(half: np.ndarray) -> np.ndarray:
    """Half floats as whole numbers in the same order, neighbours next to each other, -0 and 0 the same."""
    bits = half.view(np.int16).astype(np.int32)
    return np.where(bits < 0, -(bits & 0x7FFF), bits)


def differs(old: Layers, new: Layers) -> np.ndarray:
    """Where any channel is beyond the tolerance."""
    if any(old[name].shape != new[name].shape for name in CHANNELS):
        return np.ones(new["R"].shape, dtype=bool)
    return np.any([np.abs(rank(old[name]) - rank(new[name])) > 1 for name in CHANNELS], axis=0)


# Showing --------------------------------------------------------------------------------------------


def levels(linear: np.ndarray) -> np.ndarray:
    """8-bit sRGB."""
    return np.rint(255 * images.srgb(linear)).astype(np.uint8)


def difference(old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Amplified, around grey: brighter where the new picture is."""
    if old.shape != new.shape:
        return np.full(new.shape, 0.5)
    return 0.5 + AMPLIFY * (new.astype(np.float64) - old)


def write_pictures(name: str, old: np.ndarray, new: np.ndarray) -> None:
    """Linear pictures as OUT/NAME-old.png, -new.png and -difference.png."""
    OUT.mkdir(parents=True, exist_ok=True)
    Image.fromarray(levels(old)).save(OUT / f"{name}-old.png")
    Image.fromarray(levels(new)).save(OUT / f"{name}-new.png")
    grey = np.rint(255 * np.clip(difference(old, new), 0, 1)).astype(np.uint8)
    Image.fromarray(grey).save(OUT / f"{name}-difference.png")


def as_grey(tau: np.ndarray, low: float, high: float) -> np.ndarray:
    return np.repeat(((tau.astype(np.float64) - low) / max(high - low, 1e-9))[..., None], 3, axis=2)


def write_tau(name: str, old: np.ndarray, new: np.ndarray) -> None:
    """Both by one scale."""
    low, high = float(min(old.min(), new.min())), float(max(old.max(), new.max()))
    write_pictures(name, as_grey(old, low, high), as_grey(new, low, high))


def nothing_like(layers: Layers) -> Layers:
    """What a case that is new is compared with."""
    return {name: np.zeros_like(plane) for name, plane in layers.items()}


@dataclass(frozen=True)
class Change:
    case: Case
    what: str  # one line
    old: Layers
    new: Layers

    def show(self) -> list[str]:
        """Write the pictures; the names to show them by."""
        write_pictures(self.case.name, references.stack(self.old), references.stack(self.new))
        names = [self.case.name]
        if not np.array_equal(self.old["tau"], self.new["tau"]):
            names.append(f"{self.case.name}-tau")
            write_tau(names[-1], self.old["tau"], self.new["tau"])
        return names


def compare(case: Case, new: Layers) -> Change | None:
    """What changed against the picture that is kept; None where it is the same."""
    path = HERE / f"{case.name}.exr"
    if not path.exists():
        return Change(case, "new, no picture is kept of it", nothing_like(new), new)
    old = references.read_exr(path)
    bad = differs(old, new)
    if not bad.any():
        return None
    y, x = np.argwhere(bad)[0]
    return Change(case, f"{int(bad.sum())} of {bad.size} pixels differ, first at {x},{y}", old, new)


def keep(change: Change) -> None:
    aside = HERE / f".{change.case.name}.exr"  # with its suffix, by which OpenEXR knows the format
    references.write_exr(aside, change.new)
    aside.replace(HERE / f"{change.case.name}.exr")


PAGE = """<!DOCTYPE html>
<html lang="en"><meta charset="utf-8"><title>kage: changed pictures</title>
<style>
body {{ font: 15px sans-serif; margin: 2em; background: #fff; color: #222 }}
img {{ width: 400px; image-rendering: pixelated; display: block }}
td, th {{ padding: 4px 8px; text-align: left }}
code {{ background: #eee; padding: 2px 4px }}
</style>
<h1>{count} of {all} pictures changed</h1>
<p>Differences are {amplify} times as strong, around grey: brighter where the new picture is. Where &tau; has changed
it is shown as well, from black for the lowest to white for the highest of both.
<code>make accept</code> keeps the new ones.</p>
{sections}
</html>
"""


def section(change: Change) -> str:
    rows = "".join("<tr>" + "".join(f'<td><img src="{name}-{kind}.png" alt="{kind}">' for kind in
                                    ("old", "new", "difference")) for name in change.show())
    command = html.escape(shlex.join(change.case.command(OUT / f"{change.case.name}.exr")))
    return (f"<h2>{change.case.name}</h2><p>{html.escape(change.what)}<p><code>{command}</code>"
            f"<table><tr><th>old<th>new<th>difference{rows}</table>")


def write_page(changes: list[Change]) -> Path:
    OUT.mkdir(parents=True, exist_ok=True)
    path = OUT / "index.html"
    path.write_text(PAGE.format(count=len(changes), all=len(CASES), amplify=AMPLIFY,
                                sections="\n".join(section(change) for change in changes)))
    return path
