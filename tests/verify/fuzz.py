"""Each target of the fuzzer for half an hour.

    scripts/venv python -m tests.verify.fuzz [--seconds S] [TARGET...]
"""

from __future__ import annotations

import sys

from scripts import fuzz_targets
from tests.verify import record


def main() -> int:
    failed = 0
    for result in fuzz_targets.fuzz_all(sys.argv[1:]):
        seconds = round(result.seconds)
        figures = {"inputs": result.inputs, "edges": result.edges, "minutes": round(seconds / 60)}
        failed += record.record(f"fuzz-{result.target}", figures, len(result.finds),
                                ["--seconds", str(seconds), result.target])
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
