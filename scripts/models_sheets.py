"""Make docs/models.png and docs/smooth.png, and print the table of docs/models.md: how far pictures with a map of 8
bits are off from those with 16.

    scripts/venv python -m scripts.models_sheets [--kage build/float/kage]
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenEXR

TOP = Path(__file__).resolve().parent.parent
MODELS = TOP / "scenes/models"
MAP, SMOOTH = "objects.ground.bump.map.file", "objects.ground.bump.smooth"

DUNE = """camera: {from: [0, 1.6, -3.6], at: [0, 0.1, 0], fov: 40}
image: {size: [640, 400], background: [0.3, 0.4, 0.55]}
render: {shadow: auto, shade: shifted, bump_shadow: march:24}
lights: {sun: {at: [-20, 6, 10], parallel: {to: [0, 0, 0]}}}
materials:
  sand: {color: [0.85, 0.7, 0.5], diffuse: 0.9}
  pole: {color: [0.8, 0.2, 0.15], diffuse: 0.8}
objects:
  ground:
    rectangle: {origin: [-2, 0, 2], u: [4, 0, 0], w: [0, 0, -4]}
    material: sand
    bump: {map: {file: sand-8.png}, scale: 0.35, zero: 0.5, sign: up}
  pole: {cylinder: {from: [-0.7, -0.2, 0.3], to: [-0.7, 0.6, 0.3], radius: 0.04}, material: pole}
"""


def color(path: Path) -> np.ndarray:
    with OpenEXR.File(str(path), separate_channels=True) as f:
        return np.stack([np.asarray(f.channels()[c].pixels, float) for c in "RGB"], axis=-1)


def sheet(to: str, title: str, columns: int, cells: list[str]) -> None:
    command = [sys.executable, str(TOP / "scripts/contact_sheet.py"), "-o", str(TOP / "docs" / to)]
    subprocess.run([*command, "--columns", str(columns), "--title", title, *cells], check=True)


def corner(run: Callable[..., None], folder: Path) -> None:
    scene = folder / "corner.yaml"
    run("import", MODELS / "corner.glb", "-o", scene, "--bump", f"Floor={MODELS / 'sand-16.png'},scale=0.25")
    for name, *options in (("none", "--shadow", "none"), ("kage", "--relief"), ("truth", "--surface", "displaced")):
        run("render", scene, "--quiet", "-o", folder / f"{name}.png", *options)
    sheet("models.png", "A model with a height map on its floor", 3,
          [f"{folder}/none.png=bump mapping only: shadows as on a flat floor",
           f"{folder}/kage.png=kage --relief: they follow the sand", f"{folder}/truth.png=true displacement"])


def dune(run: Callable[..., None], folder: Path) -> None:
    scene = folder / "dune.yaml"
    scene.write_text(DUNE)
    changes = {"16": f"{MAP}={MODELS / 'sand-16.png'}"} | {str(k): f"{SMOOTH}={k}" for k in range(5)}
    for name, change in changes.items():
        more = ["--set", f"{MAP}={MODELS / 'sand-8.png'}", "--set", change]
        run("render", scene, "--quiet", "-o", folder / f"{name}.png", "-o", folder / f"{name}.exr", *more)
    sheet("smooth.png", "A dune 0.35 high, its map and the bits of a sample", 3,
          [f"{folder}/16.png=16 bits", f"{folder}/0.png=8 bits", f"{folder}/2.png=8 bits, smooth: 2"])
    truth = color(folder / "16.exr")
    off = {k: float(np.abs(color(folder / f"{k}.exr") - truth).mean()) for k in range(5)}
    print("| `smooth` |", *(f"{k} |" for k in off))
    print("| off |", *(f"{x:.5f} |" for x in off.values()))


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--kage", type=Path, default=TOP / "build/float/kage")
    kage = p.parse_args().kage.resolve()

    def run(*arguments: str | Path) -> None:
        subprocess.run([kage, *arguments], check=True)

    with tempfile.TemporaryDirectory() as folder:
        corner(run, Path(folder))
        dune(run, Path(folder))


if __name__ == "__main__":
    main()
