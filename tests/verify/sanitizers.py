"""Everything under the sanitizers, and scenes under valgrind: what `make sanitize` has no time for.

- The unit tests and the tests of the program under AddressSanitizer, UndefinedBehaviorSanitizer and LeakSanitizer.
- Several renders at once in one process, under ThreadSanitizer.
- Renders of all shipped scenes, by each method that reads other data, under valgrind's memcheck.

    scripts/venv python -m tests.verify.sanitizers
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from pathlib import Path

from tests.verify import record

SCENES = sorted([*record.TOP.glob("scenes/*.yaml"), *record.TOP.glob("scenes/gallery/*.yaml")])
WAYS = (["--shadow", "auto", "--shade", "shifted", "--bump-shadow", "march:8"], ["--shadow", "exact"],
        ["--surface", "displaced"], ["--bump-shadow", "horizon"])
#: Valgrind knows no AVX-512, and the plain code has no other accesses than the clones.
PLAIN = ["CLONES=no", "OPTIMISE=-O1 -g -fno-math-errno -fno-trapping-math -ffp-contract=off", "BUILD=build/plain"]
MAKE = ["make", "-j2", "BOOTSTRAP=no"]
SUMMARY = re.compile(r"(?:(\d+) failed, )?(\d+) passed")


def sanitized() -> tuple[int, int]:
    """The whole of `make sanitize`, with all tests of the program: those that ran, those that failed."""
    log = record.KEPT / "sanitize.log"
    status = record.logged([*MAKE, "sanitize", "SANE_TESTS=tests/program"], log)
    text = log.read_text(encoding="utf-8")
    units = len(re.findall(r"^  OK  ", text, re.MULTILINE))
    bad = re.findall(r"^  FAILED  .*|^FAILED .*", text, re.MULTILINE)
    found = SUMMARY.search(text)
    if status:
        print(*(bad or [text[-8000:]]), f"all that it printed: {log}", sep="\n")
    return units + (int(found[2]) if found else 0), len(bad) or (1 if status else 0)


def memcheck(scene: Path, way: list[str]) -> bool:
    """Whether valgrind finds nothing in a small render."""
    kage = record.TOP / "build" / "plain" / "kage"
    command = ["valgrind", "--quiet", "--error-exitcode=9", "--leak-check=full", "--show-leak-kinds=definite",
               "--errors-for-leak-kinds=definite",
               kage, "render", scene, *way, "--size", "12x9", "--threads", "1", "--quiet", "-o", "a.exr"]
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([*map(str, command)], capture_output=True, text=True, cwd=folder,
                              env={**os.environ, "KAGE_IMPORT": str(kage.parent / "kage-import")})
    if done.returncode:
        print(scene.name, *way, done.stderr[-3000:], sep="\n  ")
    return done.returncode == 0


def main() -> int:
    tried, failed = sanitized()
    log = record.KEPT / "plain.log"
    if record.logged([*MAKE, *PLAIN, "build/plain/kage", "build/plain/kage-import"], log):
        sys.exit(log.read_text(encoding="utf-8"))
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        clean = list(pool.map(lambda one: memcheck(*one), product(SCENES, WAYS)))
    return record.record("sanitizers", {"tests under ASan, UBSan, LSan and TSan": tried,
                                        "renders under valgrind": len(clean)}, failed + clean.count(False))


if __name__ == "__main__":
    sys.exit(main())
