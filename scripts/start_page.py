"""out/index.html: what `make render`, `make bench` and `make speed` have made, and only what is there.

    scripts/venv python -m scripts.start_page [FOLDER]
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from scripts import page_of

TOP = Path(__file__).resolve().parent.parent


@dataclass(frozen=True)
class Entry:
    """A page or picture that may have been made."""

    path: str  # from the folder
    title: str
    about: str
    picture: str = ""  # shown with it, where it is there
    whole: bool = False  # all of the picture, not cut to fit


PAGES = (
    Entry("gallery/index.html", "Gallery", "Scenes by bump mapping only and by their best method, under a slider.",
          "gallery/wall.png"),
    Entry("bench/index.html", "Benchmark report",
          "What each method costs, and how wrong it is; the paper's claims, judged.", "../docs/cost-error.svg", True),
    Entry("speed/index.html", "Speed report", "What kage demands of its own speed, beside other programs."),
    Entry("figures.png", "The paper's figures", "Figures 4 to 8, by kage.", "figures.png", True),
    Entry("relief.png", "kage --relief",
          "The same bumps: shaded only, with the shadow of the paper, as kage sees them, and truly displaced.",
          "relief.png", True),
)
LIVE = Entry("../docs/live/index.html", "Live",
             "Three scenes in your browser: turn the eye, move the light, change the bumps.", "figure8.png")


def there(folder: Path) -> list[Entry]:
    """What is there; a missing picture is left out of its entry."""
    found = [entry for entry in PAGES if (folder / entry.path).exists()]
    if (folder / LIVE.path).exists():
        found.append(LIVE)
    return [entry if not entry.picture or (folder / entry.picture).exists() else
            Entry(entry.path, entry.title, entry.about) for entry in found]


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="start_page", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", nargs="?", type=Path, default=TOP / "out", metavar="FOLDER", help="(out)")
    folder = parser.parse_args(arguments).folder
    try:
        page_of.write("start.html", folder / "index.html", entries=there(folder))
    except OSError as error:
        print(f"start_page: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
