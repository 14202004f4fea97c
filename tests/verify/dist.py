"""The source archive built and tested in a folder without a repository, as one who has only the archive does.

    scripts/venv python -m tests.verify.dist [--tests PATH...]

It is made twice and compared, unpacked, and built; then its own tests run (default: all of tests/, 20 minutes). What
they print is in out/verify/dist.log.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from scripts import dist
from tests.verify.record import KEPT, TOP, logged, record


def build(top: Path) -> None:
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("MAKE", "MFLAGS", "KAGE"))}
    subprocess.run(["make", f"-j{os.cpu_count()}", "BOOTSTRAP=no", f"PYTHON={sys.executable}", "tested-programs"],
                   cwd=top, env=environment, check=True, stdout=subprocess.DEVNULL)


def tested(top: Path, paths: list[str]) -> dict[str, int]:
    """How many tests passed, failed, and so on."""
    environment = {name: value for name, value in os.environ.items() if name not in ("KAGE", "PYTHONPATH")}
    log = KEPT / "dist.log"
    status = logged([sys.executable, "-m", "pytest", "-q", "-n", "auto", "--dist", "loadfile", *paths], log,
                    env=environment, top=top)
    text = log.read_text(encoding="utf-8")
    last = text.rstrip().rpartition("\n")[2]
    counted = {word: int(number) for number, word in re.findall(r"(\d+) (passed|failed|errors?|skipped)", last)}
    if status != 0:
        print(text[-8000:], f"all that it printed: {log}", sep="\n")
        counted.setdefault("failed", 1)
    return counted


def main() -> int:
    parser = argparse.ArgumentParser(description="Build and test the source archive by itself.")
    parser.add_argument("--tests", nargs="+", default=["tests"], metavar="PATH", help="default: tests")
    paths = parser.parse_args().tests
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        archives = [dist.make(TOP, folder / part) for part in ("a", "b")]
        differ = int(archives[0].read_bytes() != archives[1].read_bytes())
        subprocess.run(["tar", "-x", "-f", archives[0], "-C", folder], check=True)
        top = folder / f"kage-{dist.version()}"
        (top / ".venv").symlink_to(Path(sys.prefix))
        build(top)
        counted = tested(top, paths)
        megabytes = round(archives[0].stat().st_size / 1e6, 1)
    failures = differ + sum(number for word, number in counted.items() if word.startswith(("failed", "error")))
    return record("dist", {"MB": megabytes, "archives that differ": differ,
                           "tests passed in it": counted.get("passed", 0),
                           "skipped": counted.get("skipped", 0)}, failures)


if __name__ == "__main__":
    sys.exit(main())
