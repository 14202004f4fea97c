"""Each target of the fuzzer for half an hour.

    scripts/venv python -m tests.verify.fuzz [--seconds S] [TARGET...]
"""

from __future__ import annotations

import sys

from scripts import fuzz_targets
from tests.verify import record


def main() -> int:
    results = fuzz_targets.fuzz_all(sys.argv[1:])
    figures = {"inputs": sum(result.inputs for result in results),
               "minutes": round(sum(result.seconds for result in results) / 60)}
    figures |= {f"for {result.target} (to {result.edges} edges)": result.inputs for result in results}
    return record.record("fuzz", figures, sum(len(result.finds) for result in results))


if __name__ == "__main__":
    sys.exit(main())
