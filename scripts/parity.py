"""The table of docs/povray.md: how well kage and POV-Ray agree, over the same scenes as the test of parity.

    scripts/venv python -m scripts.parity            print it, and the scenes with the largest differences
    scripts/venv python -m scripts.parity --write    put it into docs/povray.md

The environment variable KAGE names the program, by default build/float/kage.

status: 0 all scenes agree as well as they must, 1 a scene is below its least share
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from pathlib import Path

from tests.support import parity

TOP = Path(__file__).resolve().parent.parent
PAGE = TOP / "docs" / "povray.md"
Results = dict[parity.Scene, parity.Found]


def percent(share: float) -> str:
    """Cut, not rounded: 100 means all pixels."""
    return f"{int(1e4 * share + 1e-6) / 100:g}"


def cell(results: Results, row: str, column: str) -> str:
    """The least share, and the number of scenes."""
    shares = [found.share for scene, found in results.items() if (scene.row, scene.column) == (row, column)]
    return f"{percent(min(shares))} ({len(shares)})" if shares else ""


def table(results: Results) -> str:
    lines = [f"| | {' | '.join(parity.COLUMNS)} | mean difference |", "|---|" + "---:|" * (len(parity.COLUMNS) + 1)]
    for row in parity.ROWS:
        mean = max(found.mean for scene, found in results.items() if scene.row == row) / parity.STEP
        lines.append(f"| {row} | {' | '.join(cell(results, row, column) for column in parity.COLUMNS)} | {mean:.2f} |")
    whole = sum(found.share == 1 for found in results.values())
    return "\n".join([*lines, "", f"{len(results)} scenes, {whole} of them alike on every pixel."])


def worst(results: Results) -> str:
    """The largest differences."""
    last = sorted(results.items(), key=lambda item: item[1].share)[:12]
    return "\n".join(f"{percent(found.share):>6} %  mean {found.mean / parity.STEP:.2f}/255  worst {found.worst:.3f}  "
                     f"{scene}" for scene, found in last)


def main() -> int:
    arguments = argparse.ArgumentParser(description="How well kage and POV-Ray agree.")
    arguments.add_argument("--write", action="store_true", help="put the table into docs/povray.md")
    said = arguments.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        results = {scene: found.result() for scene, found in parity.compare_all(Path(folder), parity.SCENES).items()}
    text = table(results)
    print(f"{text}\n\n{worst(results)}")
    if said.write:
        page = PAGE.read_text()
        PAGE.write_text(re.sub(r"(<!-- parity -->\n).*?(<!-- /parity -->)", lambda m: f"{m[1]}{text}\n{m[2]}", page,
                               flags=re.DOTALL))
    low = [str(scene) for scene, found in results.items() if found.share < scene.least]
    if low:
        print(f"parity.py: below what they must have: {'; '.join(low)}", file=sys.stderr)
    return 1 if low else 0


if __name__ == "__main__":
    sys.exit(main())
