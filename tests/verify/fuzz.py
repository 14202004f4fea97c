"""Each target of the fuzzer for half an hour: python -m tests.verify.fuzz [--seconds S] [TARGET...]."""

from __future__ import annotations

import sys

from scripts import fuzz_targets

if __name__ == "__main__":
    sys.exit(fuzz_targets.main())
