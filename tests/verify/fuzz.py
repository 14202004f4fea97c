"""Each target of the fuzzer for half an hour: python -m tests.verify.fuzz [--seconds S] [TARGET...]."""

from __future__ import annotations

import sys

from scripts import fuzz_targets
from tests.verify import record


def main() -> int:
    words, results = fuzz_targets.fuzz_all(sys.argv[1:])
    figures: dict[str, int | float | str] = {
        "inputs": sum(result.inputs for result in results),
        "minutes": round(sum(result.seconds for result in results) / 60),
    }
    for result in results:
        figures[f"({result.target})"] = f"{result.inputs} to {result.edges} edges"
    finds = sum(len(result.finds) for result in results)
    return record.record("fuzz", " ".join(["scripts/venv python -m tests.verify.fuzz", *words]), figures, finds)


if __name__ == "__main__":
    sys.exit(main())
