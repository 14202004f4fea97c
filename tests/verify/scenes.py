"""Random scenes: each by every build that must give the same bytes, and as its properties say (tests/random).

    scripts/venv python -m tests.verify.scenes --count 1000      the first 1000 seeds
    scripts/venv python -m tests.verify.scenes --first 77 --count 1 --all

The builds are gcc and clang with -O0 and -O3, one without hierarchies, and double; they go to build/random. A scene
that breaks something is made small and kept in tests/random/found.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from tests.random.draw import Scene, draw
from tests.random.lab import Lab, LostError, RefusedError
from tests.random.properties import check, chosen
from tests.random.shrink import keep, shrunk
from tests.verify.record import TOP, record

FLAGS = "-fno-math-errno -fno-trapping-math -ffp-contract=off"
#: What make is told for each build, besides BUILD.
BUILDS = {
    "float": ("REAL=float",), "double": ("REAL=double",),
    "gcc-O0": ("CC=gcc", "CLONES=no", f"OPTIMISE=-O0 {FLAGS}"),
    "clang-O0": ("CC=clang", "CLONES=no", f"OPTIMISE=-O0 {FLAGS}"),
    "clang-O3": ("CC=clang", f"OPTIMISE=-O3 {FLAGS}"),
    "brute": ("BVH=brute",),
}


def folder_of(build: str) -> Path:
    return TOP / "build" / (build if build in ("float", "double") else f"random/{build}")


def make(build: str, jobs: int) -> None:
    how = [word.replace("CC=", "CC=ccache ") if os.environ.get("CCACHE") else word for word in BUILDS[build]]
    subprocess.run(["make", "-s", f"-j{jobs}", "BOOTSTRAP=no", f"PYTHON={sys.executable}",
                    f"BUILD={folder_of(build)}", *how, "python", *(["programs"] if build == "float" else [])],
                   cwd=TOP, check=True)


def tried(lab: Lab, scene: Scene, name: str, seed: int) -> str | None:
    """As check; a crash or an endless render is wrong, too, and so is a refusal, as all scenes are valid."""
    try:
        return check(lab, scene, name, seed)
    except (RefusedError, LostError) as wrong:
        return f"{type(wrong).__name__}: {wrong}"


def made_small(lab: Lab, scene: Scene, name: str, seed: int, wrong: str) -> Scene:
    refused = wrong.startswith("RefusedError")

    def fails(other: Scene) -> bool:
        try:
            found = tried(lab, other, name, seed)
        except (LookupError, ValueError, TypeError, StopIteration):
            return False  # it lacks what the property changes
        return bool(found and found.startswith("RefusedError") == refused)

    return shrunk(scene, fails)


def run(lab: Lab, seeds: Sequence[int], few: int, seconds: float) -> tuple[Counter[str], int, int]:
    """How often each property was looked at, how many were broken, and of how many scenes."""
    looked: Counter[str] = Counter()
    bad, end = 0, time.monotonic() + seconds
    for done, seed in enumerate(seeds):
        if time.monotonic() > end:
            return looked, bad, done
        scene = draw(seed)
        for name in ["builds", *chosen(seed, few)]:
            wrong = tried(lab, scene, name, seed)
            looked[name] += wrong is not None
            if wrong:
                bad += 1
                path = keep(made_small(lab, scene, name, seed, wrong), name, seed)
                print(f"seed {seed}, {name}: {wrong}\n  {path.relative_to(TOP)}", flush=True)
        if done % 50 == 49:
            print(f"{done + 1} scenes, {lab.pictures} pictures, {bad} failed", flush=True)
    return looked, bad, len(seeds)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000, help="scenes (1000)")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="no new scene after these (no bound)")
    parser.add_argument("--first", type=int, default=0, help="the first seed (0)")
    parser.add_argument("--few", type=int, default=3, help="properties a scene, besides the builds (3)")
    parser.add_argument("--all", action="store_true", help="all properties of each scene")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--builds", default=",".join(BUILDS), help="those of them that are compared (all)")
    parser.add_argument("--built", action="store_true", help="the builds are fresh")
    asked = parser.parse_args()
    builds = asked.builds.split(",")
    for build in () if asked.built else builds:
        make(build, asked.jobs)
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        lab = Lab({build: folder_of(build) for build in builds}, Path(folder))
        seeds = range(asked.first, asked.first + asked.count)
        looked, bad, scenes = run(lab, seeds, 99 if asked.all else asked.few, asked.seconds)
        lab.end()
    print(", ".join(f"{name} {count}" for name, count in sorted(looked.items())))
    return record("scenes", {"random scenes": scenes, "builds": len(builds), "comparisons": sum(looked.values()),
                   "pictures": lab.pictures, "minutes": round((time.monotonic() - begun) / 60)}, bad)


if __name__ == "__main__":
    sys.exit(main())
