"""The gallery's page: each scene of scenes/gallery by bump mapping only and by its best method, under a slider.

    scripts/venv python -m scripts.gallery -o out/gallery/index.html scenes/gallery/*.yaml

Scene NAME has its pictures NAME-none.png and NAME.png beside the page (`make render` makes them). The text about a
scene is the comment at the start of its file; its best method is the `shadow` in it. Its cost is measured here: ROUNDS
rounds, in each of which both are rendered in turn. Nothing else should run meanwhile.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from bench import claims, programs
from bench.data import BUMP_ONLY
from scripts import page_of

BUMP = ("--shadow", "none", "--shade", "smooth", "--bump-shadow", "none")
ROUNDS, TIMED_SIZE = 3, "320x240"


class GalleryError(Exception):
    """What a scene lacks, in one line."""


@dataclass(frozen=True)
class Scene:
    """What the page shows of a scene."""

    name: str
    path: str  # from the top of the project
    about: str
    method: str
    size: tuple[int, int]
    text: str
    cost: str  # a sentence


def time_ns(kage: Path, scene: Path, options: Sequence[str], png: Path) -> float:
    """Of a sample."""
    told = programs.run([kage, "render", scene.resolve(), *options, "--size", TIMED_SIZE, "--threads", "1", "--stats",
                         "--quiet", "-o", png])
    return programs.parse_kage(told)["render"]


def cost_of(kage: Path, scene: Path) -> str:
    """All ratios of the rounds: a few runs have no better interval."""
    with tempfile.TemporaryDirectory() as folder:
        png = Path(folder) / "timed.png"
        rounds = [[time_ns(kage, scene, options, png) for options in (BUMP, ())] for _ in range(ROUNDS)]
    times = sorted(own / base for base, own in rounds)
    found = claims.span_text({"median": times[ROUNDS // 2], "low": times[0], "high": times[-1], "n": ROUNDS}, ".1f")
    size = TIMED_SIZE.replace("x", " x ")
    return f"{found} times the time by {BUMP_ONLY} ({ROUNDS} runs of {size} pixels, one thread)"


def read_scene(path: Path, kage: Path) -> Scene:
    text = path.read_text(encoding="utf-8")
    comment = re.match(r"((?:# .*\n)+)", text)
    method = re.search(r'^render: \{(.*?shadow: "?([^",}]+).*?)\}', text, re.MULTILINE)
    size = re.search(r"^image: \{size: \[(\d+), (\d+)\]", text, re.MULTILINE)
    if not comment or not method or not size:
        raise GalleryError(f"{path}: expected a comment in its first line, an image size and a render.shadow")
    about = " ".join(line[2:] for line in comment[1].splitlines())
    more = [f"{key} {word}" for key, word in re.findall(r"(shade|bump_shadow): (\S+?)(?:,|$)", method[1])]
    return Scene(path.stem, f"scenes/gallery/{path.name}", about, ", ".join([method[2], *more]),
                 (int(size[1]), int(size[2])), text[comment.end():].strip(), cost_of(kage, path))


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="gallery", description="Make the gallery's page.")
    parser.add_argument("scenes", nargs="+", type=Path, metavar="SCENE")
    parser.add_argument("-o", "--output", type=Path, required=True, help="the page; the pictures are beside it")
    parser.add_argument("--kage", type=Path, default=programs.KAGE, metavar="FILE",
                        help="the program (build/float/kage)")
    options = parser.parse_args(arguments)
    try:
        absent = [name for path in options.scenes for name in (f"{path.stem}-none.png", f"{path.stem}.png")
                  if not (options.output.parent / name).exists()]
        if absent:
            raise GalleryError(f"{options.output.parent}: no {', '.join(absent)}; have they been rendered?")
        scenes = [read_scene(path, options.kage.resolve()) for path in options.scenes]
        page_of.write("gallery.html", options.output, scenes=scenes, bump_only=BUMP_ONLY)
    except (GalleryError, programs.MeasureError, OSError) as error:
        print(f"gallery: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
