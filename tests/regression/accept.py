"""Accept changed pictures: show old, new and difference on a page, ask, then keep the new ones for
tests/program/test_regression.py.

ACCEPT=yes answers the question beforehand. Without it and without a terminal nothing is kept.

status: 0 nothing has changed, or what has is kept; 1 changes are not kept; 2 a picture can't be made
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.regression import cases


def find_changes() -> list[cases.Change]:
    with tempfile.TemporaryDirectory() as folder:
        found = (cases.compare(case, cases.render(case, Path(folder))) for case in cases.CASES)
        return [change for change in found if change]


def find_left_over() -> list[Path]:
    """Pictures of cases that are no more."""
    wanted = {f"{case.name}.exr" for case in cases.CASES}
    return [path for path in sorted(cases.HERE.glob("*.exr")) if path.name not in wanted]


def agreed() -> bool:
    answer = os.environ.get("ACCEPT", "")
    if not answer and sys.stdin.isatty():
        answer = input("Keep the new pictures? Type yes: ")
    return answer == "yes"


def main() -> int:
    try:
        changes, left_over = find_changes(), find_left_over()
    except (OSError, subprocess.SubprocessError) as error:
        print(f"accept.py: {error}", file=sys.stderr)
        return 2
    if not changes and not left_over:
        print(f"all {len(cases.CASES)} pictures are as before")
        return 0
    for change in changes:
        print(f"{change.case.name}: {change.what}")
    for path in left_over:
        print(f"{path.name}: of no case any more")
    print(f"Look at {cases.write_page(changes)}")
    if not agreed():
        print("not kept; ACCEPT=yes make accept keeps them")
        return 1
    for change in changes:
        cases.keep(change)
    for path in left_over:
        path.unlink()
    print(f"kept {len(changes)}, removed {len(left_over)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
