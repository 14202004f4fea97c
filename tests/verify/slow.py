"""The tests of the suite that are marked `slow`, as they take too long for each change.

    scripts/venv python -m tests.verify.slow
"""

from __future__ import annotations

import re
import subprocess
import sys

from tests.verify import record


def main() -> int:
    done = subprocess.run([sys.executable, "-m", "pytest", "-q", "-n", "auto", "-m", "slow", "tests"], cwd=record.TOP,
                          capture_output=True, text=True)
    passed = re.search(r"(\d+) passed", done.stdout)
    failed = re.search(r"(\d+) failed", done.stdout)
    if done.returncode:
        print(done.stdout[-8000:], done.stderr[-2000:], sep="\n")
    return record.record("slow", {"tests": int(passed[1]) if passed else 0},
                         int(failed[1]) if failed else int(done.returncode != 0))


if __name__ == "__main__":
    sys.exit(main())
