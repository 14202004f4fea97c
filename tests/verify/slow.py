"""The tests of the suite that are marked `slow`, as they take too long for each change.

    scripts/venv python -m tests.verify.slow
"""

from __future__ import annotations

import re
import sys

from tests.verify import record


def main() -> int:
    log = record.KEPT / "slow.log"
    status = record.logged([sys.executable, "-m", "pytest", "-q", "-n", "auto", "-m", "slow", "tests"], log)
    text = log.read_text(encoding="utf-8")
    passed = re.search(r"(\d+) passed", text)
    failed = re.search(r"(\d+) failed", text)
    if status:
        print(text[-8000:], f"all that it printed: {log}", sep="\n")
    return record.record("slow", {"tests": int(passed[1]) if passed else 0},
                         int(failed[1]) if failed else int(status != 0))


if __name__ == "__main__":
    sys.exit(main())
