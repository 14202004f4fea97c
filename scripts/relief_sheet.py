#!/usr/bin/env python3
"""The README's first picture: bump mapping alone, the paper's order 0, kage's --relief, the truth; with their costs.

    scripts/venv python -m scripts.relief_sheet -o out/relief.png

The scene is figure 5's with its lamp lowered, so that bumps shadow each other. Each cost is in times that of bump
mapping alone: 960 x 540 pixels, one thread, the median of ROUNDS rounds, in each of which all four are timed in turn.
"""

from __future__ import annotations

import argparse
import re
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import matplotlib

from scripts.contact_sheet import Box, Cell, SheetError, make_sheet, read_srgb

TOP = Path(__file__).resolve().parent.parent
SCENE = ("scenes/cube.yaml", "--set", "lights.lamp.at=[-4.4, 2.4, -2.6]")
SHOWN: dict[str, Sequence[str]] = {
    "bump mapping alone": ("--shadow", "none"),
    "the paper, order 0": ("--shadow", "0"),
    "kage --relief": ("--relief",),
    "the truth: displaced": ("--surface", "displaced"),
}
TITLE = "The same bumps: shaded only, with the shadow of the paper, as kage sees them, and truly displaced"
SIZE, TIMED_SIZE = "480x360", "960x540"
CROP: Box = (270, 35, 390, 125)
ROUNDS = 7


def render(kage: Path, options: Sequence[str], png: Path, *more: str) -> str:
    """What kage prints."""
    command: list[str | Path] = [kage, "render", *SCENE, *options, "-o", png, "--quiet", *more]
    done = subprocess.run(command, cwd=TOP, check=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return done.stdout


def time_ns(kage: Path, options: Sequence[str], png: Path) -> float:
    """Of a sample."""
    text = render(kage, options, png, "--size", TIMED_SIZE, "--threads", "1", "--stats")
    found = re.search(r"^ *render .*?([0-9.]+) ns a (?:sample|pixel)", text, re.MULTILINE)
    if not found:
        raise SheetError(f"kage --stats: no time of the render in {text[:200]!r}")
    return float(found[1])


def costs(kage: Path, folder: Path) -> list[float]:
    """In times the first one's, as medians of the rounds' own ratios."""
    rounds = [[time_ns(kage, options, folder / "timed.png") for options in SHOWN.values()] for _ in range(ROUNDS)]
    return [statistics.median(times[i] / times[0] for times in rounds) for i in range(len(SHOWN))]


def cells(kage: Path) -> list[Cell]:
    with tempfile.TemporaryDirectory() as name:
        folder, found = Path(name), []
        for (text, options), cost in zip(SHOWN.items(), costs(kage, folder), strict=True):
            png = folder / "shown.png"
            render(kage, options, png, "--size", SIZE, "--aa", "3")
            found.append(Cell(read_srgb(png), f"{text} ({cost:.{1 if cost < 9.95 else 0}f}×)"))
        return found


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="relief_sheet", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("-o", "--output", type=Path, required=True, help="the sheet, a PNG")
    parser.add_argument("--kage", type=Path, default=TOP / "build" / "float" / "kage", metavar="FILE",
                        help="the program (build/float/kage)")
    options = parser.parse_args(arguments)
    matplotlib.rcdefaults()  # not the user's own style
    try:
        make_sheet(cells(options.kage.resolve()), TITLE, len(SHOWN), CROP).save(options.output)
    except subprocess.CalledProcessError as error:
        print(f"relief_sheet: kage: {error.stdout.strip()}", file=sys.stderr)
        return 1
    except (SheetError, OSError) as error:
        print(f"relief_sheet: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
