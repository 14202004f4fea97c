"""Run the whole suite again and again on a busy machine: what fails once is a defect.

`stress-ng` keeps every processor, the memory and the disk busy beside it. The programs must be built. What a run has
printed is in out/verify/load-N-SUITE.log.

    scripts/venv python -m tests.verify.load --count 10
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
from collections import Counter
from contextlib import contextmanager
from typing import TYPE_CHECKING

from tests.verify import record

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

TOO_LONG = 3 * 3600  # seconds: something waits for ever
FAILED = re.compile(r"^(?:FAILED|ERROR) (\S+)|^  FAILED  (\S+)", re.MULTILINE)
SUITES = {"float": ["make", "-j2", "BOOTSTRAP=no", "unit-tests", "REAL=float"],
          "double": ["make", "-j2", "BOOTSTRAP=no", "unit-tests", "REAL=double"],
          "pytest": [sys.executable, "-m", "pytest", "-q", "-n", "auto", "--dist", "loadfile", "tests"]}


@contextmanager
def busy() -> Iterator[None]:
    """Other work on the machine, in bursts: a loop a processor, one that fills memory, one that writes files."""
    stress = subprocess.Popen(["stress-ng", "--quiet", "--cpu", "0", "--cpu-load", "50", "--vm", "1", "--vm-bytes",
                               "256M", "--vm-hang", "1", "--hdd", "1", "--hdd-bytes", "64M", "--temp-path",
                               str(record.KEPT)])
    try:
        yield
    finally:
        stress.terminate()
        stress.wait()


def run(suite: list[str], log: Path) -> list[str]:
    """The tests that failed. What they print goes into the log, also where they never end."""
    try:
        status = record.logged(suite, log, env={**os.environ, "CI": "1"}, timeout=TOO_LONG)
    except subprocess.TimeoutExpired as ended:
        return [f"{' '.join(suite)} took more than {ended.timeout} s"]
    found = [a or b for a, b in FAILED.findall(log.read_text(encoding="utf-8"))]
    return found or ([" ".join(suite)] if status else [])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=10, help="runs (10)")
    count = parser.parse_args().count
    record.KEPT.mkdir(parents=True, exist_ok=True)
    failed: Counter[str] = Counter()
    status = 0
    with busy():
        for k in range(count):
            failed.update(name for kind, suite in SUITES.items()
                          for name in run(suite, record.KEPT / f"load-{k + 1}-{kind}.log"))
            # After each run, as ten of them take hours.
            status = record.record("load", {"runs of the whole suite beside stress-ng": k + 1}, failed.total())
            for name, times in failed.most_common():
                print(f"  {name} failed {times} times")
            sys.stdout.flush()
    return status


if __name__ == "__main__":
    sys.exit(main())
