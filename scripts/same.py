"""Compare kage with itself at another commit: are all pictures the same, byte by byte, and does it take as many
instructions?

    scripts/venv python -m scripts.same REVISION [--real float|double] [--only TEXT] [--instructions]

Both programs are built, each from its own sources, in build/same/. They render the pictures of `make render`, of the
gallery, of the regression tests and of a normal bench's quality table, and write the exports to POV-Ray, from this
tree's scenes. With --instructions, valgrind counts what a pixel of figure 5's scene costs by each method: the
difference of two sizes, so that the start of the program and of its libraries does not count.

Exit status: 0 all alike (instructions within 1 %), 1 something differs, 2 wrong usage.
"""

from __future__ import annotations

import argparse
import hashlib
import itertools
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from bench import plan

TOP = Path(__file__).resolve().parent.parent

SMALL, LARGE = (160, 120), (320, 240)
WITHIN = 0.01  # of the instructions
OPTIONS = {"displaced": ("--surface", "displaced"), "1 bare": ("--shadow", "1", "--no-guard"),
           "2 bare": ("--shadow", "2", "--no-guard")}

Commands = list[tuple[str, tuple[str, ...]]]


def options(method: str) -> tuple[str, ...]:
    return OPTIONS.get(method, ("--shadow", method))


def commands() -> Commands:
    """Names, and the words after `kage`; {} is the output without its ending."""
    figures = [("cube", "1"), ("cube", "2"), *itertools.product(("cube", "sphere", "terrain"), ("none", "0"))]
    both = ("-o", "{}.png", "-o", "{}.exr")
    found: Commands = [(f"render {scene} {method}",
                        ("render", f"scenes/{scene}.yaml", "--shadow", method, "--aa", "3", *both))
                       for scene, method in figures]
    for scene in sorted((TOP / "scenes" / "gallery").glob("*.yaml")):
        name = f"scenes/gallery/{scene.name}"
        found += [(f"gallery {scene.stem}", ("render", name, "--aa", "3", *both)),
                  (f"gallery {scene.stem} none", ("render", name, "--shadow", "none", "--aa", "3", *both)),
                  (f"pov {scene.stem}", ("pov", name, "-o", "{}.pov"))]
    for title in plan.TITLES:
        name = f"scenes/{title}.yaml"
        for method in plan.METHODS:
            found += [(f"quality {title} {method}", ("render", name, *options(method), *both)),
                      (f"regression {title} {method}", ("render", name, *options(method), "--size", "128x96", *both))]
        found += [(f"cast {title}", ("render", name, "--surface", "displaced", "--no-self-shadow", *both)),
                  (f"pov {title}", ("pov", name, "-o", "{}.pov")),
                  (f"pov {title} displaced",
                   ("pov", name, "--surface", "displaced", "--size", "64x48", "-o", "{}.pov"))]
    for scene in sorted((TOP / "tests" / "regression").glob("*.yaml")):
        found += [(f"regression {scene.stem}", ("render", f"tests/regression/{scene.name}", "--size", "80x60", *both))]
    return [(name, (*words, "--quiet") if words[0] == "render" else words) for name, words in found]


def build(revision: str | None, real: str) -> Path:
    """The program at a commit, or, for None, of this tree as it is."""
    if revision is None:
        tree, target = TOP, f"build/{real}"
    else:
        commit = subprocess.run(["git", "rev-parse", "--verify", revision + "^{commit}"], cwd=TOP, check=True,
                                capture_output=True,
                                text=True).stdout.strip()
        tree, target = TOP / "build" / "same" / commit[:12], f"build/{real}"
        if not tree.exists():
            tree.mkdir(parents=True)
            archive = subprocess.run(["git", "archive", commit], cwd=TOP, check=True, capture_output=True).stdout
            subprocess.run(["tar", "x"], cwd=tree, check=True, input=archive)
    jobs = f"-j{os.cpu_count() or 1}"
    subprocess.run(["make", "--no-print-directory", jobs, f"REAL={real}", f"{target}/kage"], cwd=tree, check=True,
                   stdout=subprocess.DEVNULL)
    return tree / target / "kage"


def digests(program: Path, words: tuple[str, ...], folder: Path) -> dict[str, str]:
    """What a command writes, by the endings of the files."""
    filled = [word.replace("{}", str(folder / "out")) for word in words]
    done = subprocess.run([program, *filled], cwd=TOP, capture_output=True, text=True, check=False)
    if done.returncode:
        return {"status": f"{done.returncode}: {done.stderr.strip()[:200]}"}
    return {path.suffix: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir()}


def compare(old: Path, new: Path, job: tuple[str, tuple[str, ...]]) -> tuple[str, list[str]]:
    """The name, and the endings that differ."""
    name, words = job
    with tempfile.TemporaryDirectory() as a, tempfile.TemporaryDirectory() as b:
        one, two = digests(old, words, Path(a)), digests(new, words, Path(b))
    if "status" in one or "status" in two:
        return name, [] if one == two else [f"status {one.get('status')} -> {two.get('status')}"]
    return name, sorted(ending for ending in one | two if one.get(ending) != two.get(ending))


def instructions(program: Path, method: str) -> float:
    """Instructions a pixel of figure 5's scene."""
    counts = []
    for width, height in (SMALL, LARGE):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run(
                ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out", program, "render",
                 "scenes/cube.yaml",
                 *options(method), "--size", f"{width}x{height}", "--threads", "1", "--quiet", "-o",
                 f"{folder}/cube.png"],
                cwd=TOP, check=True, capture_output=True, text=True)
        counts.append(int(re.search(r"Collected : (\d+)", done.stderr)[1]))  # type: ignore[index]
    return (counts[1] - counts[0]) / (LARGE[0] * LARGE[1] - SMALL[0] * SMALL[1])


def count(old: Path, new: Path, only: str) -> Iterator[bool]:
    for method in plan.METHODS:
        if only in method:
            before, after = instructions(old, method), instructions(new, method)
            change = after / before - 1
            print(f"{method:10} {before:9.1f} {after:9.1f} instructions a pixel  {100 * change:+.2f} %", flush=True)
            yield abs(change) <= WITHIN or change < 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("revision")
    parser.add_argument("--real", choices=("float", "double"), default="float")
    parser.add_argument("--only", default="", metavar="TEXT", help="only the names that hold this text")
    parser.add_argument("--instructions", action="store_true")
    parser.add_argument("--old", type=Path, metavar="PROGRAM",
                        help="a build of that commit, which is then not built again")
    asked = parser.parse_args()
    old, new = asked.old or build(asked.revision, asked.real), build(None, asked.real)
    if asked.instructions:
        return 0 if all(list(count(old, new, asked.only))) else 1
    jobs = [job for job in commands() if asked.only in job[0]]
    if not jobs:
        parser.error(f"no picture has '{asked.only}' in its name")
    different = 0
    for job in jobs:
        name, endings = compare(old, new, job)
        if endings:
            different += 1
            print(f"{name}: {', '.join(endings)}", flush=True)
    print(f"{len(jobs) - different} of {len(jobs)} alike, {different} different")
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())
