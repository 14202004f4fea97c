"""kage's own instructions in eight renders, as valgrind counts them, and those that are kept for each compiler.

    scripts/venv python -m tests.support.instructions    count again, and keep that for this compiler (make counts)

Counts are the same in each run, whatever else the machine does. Those of libraries are left out, as other versions
have others. tests/program/test_instructions.py compares them.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from bench import callgrind
from bench.programs import MeasureError
from tests.conftest import PROGRAM, TOP

KEPT = TOP / "tests" / "golden" / "instructions.json"
SLACK = 0.05
SIZE = "96x64"

# What stands for much of the rest: flat and round surfaces, a mesh, maps and functions, and each kind of method.
PAIRS = {
    "cube by none": ("scenes/cube.yaml", "--shadow", "none"),
    "cube by 0": ("scenes/cube.yaml", "--shadow", "0"),
    "cube by 2": ("scenes/cube.yaml", "--shadow", "2"),
    "cube by march:8": ("scenes/cube.yaml", "--shadow", "march:8"),
    "sphere by exact": ("scenes/sphere.yaml", "--shadow", "exact"),
    "terrain by auto": ("scenes/terrain.yaml", "--shadow", "auto"),
    "waves displaced": ("scenes/waves.yaml", "--surface", "displaced"),
    "mesh by 1": ("scenes/gallery/wall.yaml", "--shadow", "1"),
}


def compiler() -> str:
    """What compiled the program, with its major version, by the note that compilers leave in it: "gcc 12"."""
    note = subprocess.run(["readelf", "-p", ".comment", PROGRAM], capture_output=True, text=True, check=True).stdout
    # A program by clang also has a note by gcc, of the C library's start files.
    for name, pattern in (("clang", r"clang version (\d+)"), ("gcc", r"GCC: \(.*?\) (\d+)")):
        found = re.search(pattern, note)
        if found:
            return f"{name} {found[1]}"
    return "an unknown compiler"


def why_not() -> str:
    """Why nothing can be counted here that could be compared with what is kept; empty where it can."""
    if not shutil.which("valgrind"):
        return "no valgrind"
    if not shutil.which("readelf"):
        return "no readelf, which tells the compiler"
    info = Path("/proc/cpuinfo")
    if not info.exists() or " avx2 " not in info.read_text():
        return "no AVX2: the counts are those of its stages"
    return ""


def kept() -> dict[str, dict[str, int]]:
    """By compiler, by pair."""
    found: dict[str, dict[str, int]] = json.loads(KEPT.read_text())
    return found


def count(pair: str) -> int:
    with tempfile.TemporaryDirectory() as folder:
        counts = callgrind.count([PROGRAM, "render", *PAIRS[pair], "--size", SIZE, "--threads", "1", "--quiet", "-o",
                                  Path(folder) / "a.png"])
    return callgrind.total(counts, program=PROGRAM.name)


def complaint(pair: str, now: int, before: int) -> str:
    """What is wrong with the new count; empty where it is near the one that is kept."""
    change = now / before - 1
    if abs(change) <= SLACK:
        return ""
    how = "slower" if change > 0 else "faster: keep the new count"
    return f"{pair}: {now} instructions, {before} are kept, {100 * change:+.1f} %: {how}. If it is meant: make counts"


def main() -> int:
    missing = why_not()
    if missing:
        print(f"counts: {missing}", file=sys.stderr)
        return 1
    try:
        counts = {pair: count(pair) for pair in PAIRS}
    except MeasureError as error:
        print(f"counts: {error}", file=sys.stderr)
        return 1
    found = kept()
    before = found.get(compiler(), {})
    for pair, now in counts.items():
        change = f"{100 * (now / before[pair] - 1):+.2f} %" if pair in before else "new"
        print(f"{pair:20} {now:12} {change}")
    KEPT.write_text(json.dumps(found | {compiler(): counts}, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
