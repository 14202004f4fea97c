"""Lets each read, write, open, close, rename ... of the commands fail in turn: an error in words, no crash, no loss.

    scripts/venv python -m tests.verify.files [--count N]
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from tests.support.failing import fail_each, make_library
from tests.support.stops import make_inputs
from tests.verify.record import record

COMMANDS = [
    (["render", "small.yaml", "--size", "80x60", "-o", "a.exr"], "a.exr"),
    (["render", "small.yaml", "--size", "80x60", "-o", "a.png"], "a.png"),
    (["render", "map.yaml", "-o", "a.png"], "a.png"),
    (["render", "model.yaml", "-o", "a.png"], "a.png"),
    (["pov", "small.yaml", "-o", "a.pov"], "a.pov"),
    (["import", "model.obj", "-o", "a.yaml", "--overwrite"], "a.yaml"),
]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=40, help="calls of each function, at most (40)")
    given = parser.parse_args()
    sites = failures = refused = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make_inputs(folder)
        library = make_library(folder)
        for command, output in COMMANDS:
            trials = list(fail_each(command, output, folder, library, given.count))
            if not trials:
                failures += 1
                print(f"kage {' '.join(command)}: no call was made to fail", file=sys.stderr)
            for found in trials:
                sites += 1
                refused += found.status != 0
                failures += bool(found.wrong)
                if found.wrong:
                    print(f"kage {' '.join(command)}: {found.call} {found.at}, errno {found.code}: "
                          f"{'; '.join(found.wrong)}: {found.said}", file=sys.stderr)
    return record("files", {"commands": len(COMMANDS), "calls that failed in turn": sites,
                            "of them told as errors": refused}, failures)


if __name__ == "__main__":
    sys.exit(main())
