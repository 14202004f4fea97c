"""Fuzz libkage with libFuzzer: each target of tests/fuzz for a time, side by side, and tell what came of it.

    scripts/fuzz                        all targets, 30 minutes each
    scripts/fuzz --seconds 60 expr png  two of them, a minute each

The library is built by clang with AddressSanitizer and UndefinedBehaviorSanitizer into build/fuzz. What the fuzzer has
learned stays in out/fuzz/corpus, so that a later run goes on from there. An input that fails is made smaller, kept in
out/fuzz/finds/TARGET, and printed in base64. To keep it as a test, copy it to tests/fuzz/finds/TARGET.
"""

from __future__ import annotations

import argparse
import base64
import os
import re
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from tests.fuzz import seeds

TOP = Path(__file__).resolve().parent.parent
OUT = TOP / "out" / "fuzz"
PROGRAM = TOP / "build" / "fuzz" / "fuzz" / "kage-fuzz"

#: Seconds for one input before it counts as a hang, MiB before it counts as too large. Instrumented code is 20 times
#: slower than a release, and other programs may run beside it.
HANG, LARGEST = 150, 3000

#: The longest input of each target, where 4096 bytes would only be slower.
LONGEST = {
    "expr": 400, "png": 1500, "patch": 2000, "points": 1000, "mesh": 1200, "set": 2000, "scene": 2500, "film": 2500,
}

MOST_FINDS = 5


@dataclass
class Result:
    target: str
    seconds: float = 0
    inputs: int = 0
    edges: int = 0
    finds: list[Path] = field(default_factory=list)
    log: str = ""


def build() -> None:
    subprocess.run(["make", "--no-print-directory", "fuzz-program"], cwd=TOP, check=True)


def environment(folder: str) -> dict[str, str]:
    """For the fuzzer: its files go to a folder that is removed afterwards; memory may run out, as anywhere."""
    return os.environ | {"TMPDIR": folder, "UBSAN_OPTIONS": "print_stacktrace=1",
                         "ASAN_OPTIONS": "allocator_may_return_null=1",
                         "LSAN_OPTIONS": f"suppressions={TOP}/tests/support/lsan.supp:print_suppressions=0"}


def program(target: str) -> Path:
    """The program by the name that makes it run this target."""
    link = OUT / f"fuzz-{target}"
    link.unlink(missing_ok=True)
    link.symlink_to(PROGRAM)
    return link


def start(target: str, seconds: int, folder: str) -> subprocess.CompletedProcess[str]:
    """One run of the fuzzer, up to a find or to the end of its time."""
    words = OUT / f"{target}.dict"
    words.write_text("\n".join(seeds.words(target)) + "\n")
    corpus, begin, finds = (OUT / kind / target for kind in ("corpus", "seeds", "finds"))
    seeds.write(target, begin)
    for path in (corpus, finds):
        path.mkdir(parents=True, exist_ok=True)
    kept = TOP / "tests" / "fuzz" / "finds" / target
    return subprocess.run([
        program(target), f"-max_total_time={seconds}", f"-max_len={LONGEST.get(target, 4096)}", f"-timeout={HANG}",
        f"-rss_limit_mb={LARGEST}", f"-dict={words}", f"-artifact_prefix={finds}/", "-print_final_stats=1",
        "-report_slow_units=60", corpus, begin, *([kept] if kept.exists() else [])],
        cwd=TOP, env=environment(folder), capture_output=True, text=True, errors="replace", check=False)


def smaller(target: str, find: Path, folder: str) -> Path:
    """The find, made smaller in half a minute; as it was where that fails."""
    to = find.with_name(find.name + "-small")
    subprocess.run([program(target), "-minimize_crash=1", "-max_total_time=30", f"-exact_artifact_path={to}", find],
                   cwd=TOP, env=environment(folder), capture_output=True, check=False)
    return to if to.exists() else find


def number(pattern: str, log: str) -> int:
    found = re.findall(pattern, log)
    return int(found[-1]) if found else 0


def run(target: str, seconds: int) -> Result:
    """Fuzz a target for so long, over as many finds as there are."""
    result = Result(target)
    begin = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="fuzz-") as folder:
        while (left := int(seconds - (time.monotonic() - begin))) > 0 and len(result.finds) < MOST_FINDS:
            done = start(target, left, folder)
            result.log = done.stderr
            (OUT / f"{target}.log").write_text(done.stderr)
            result.inputs += number(r"number_of_executed_units: (\d+)", done.stderr)
            result.edges = max(result.edges, number(r"cov: (\d+)", done.stderr))
            if done.returncode == 0:
                break
            written = re.findall(r"Test unit written to (\S+)", done.stderr)
            result.finds.append(smaller(target, Path(written[-1]), folder) if written else OUT / f"{target}.log")
            print(told(result, done.stderr), flush=True)
    result.seconds = time.monotonic() - begin
    print(f"{target}: {result.inputs} inputs, {result.edges} edges, {result.seconds / 60:.1f} minutes, "
          f"{len(result.finds)} finds", flush=True)
    return result


def told(result: Result, log: str) -> str:
    """The last find: what was printed of it, and how to repeat it."""
    find = result.finds[-1]
    lines = log.splitlines()
    first = next((k for k, line in enumerate(lines)
                  if re.search(r"does not hold|ERROR: |runtime error|panic", line)), max(0, len(lines) - 30))
    data = find.read_bytes()
    shown = base64.b64encode(data).decode() if len(data) <= 1 << 14 else "(too long to print)"
    return "\n".join([f"{result.target}: FOUND {find}", *lines[first : first + 30], f"base64: {shown}",
                      f"repeat: make fuzz-replay FUZZ_INPUTS='{result.target} {find}'"])


def fuzz_all(argv: list[str]) -> list[Result]:
    """What the command line says."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=" ".join(seeds.SEEDS))
    parser.add_argument("--seconds", type=int, default=1800, help="for each target (1800)")
    parser.add_argument("--jobs", type=int, default=(os.cpu_count() or 1) + 1,
                        help="targets at a time (one more than processors, as each waits for files)")
    options = parser.parse_args(argv)
    unknown = [target for target in options.targets if target not in seeds.SEEDS]
    if unknown:
        parser.error(f"no target {unknown[0]}, expected some of: {' '.join(seeds.SEEDS)}")
    OUT.mkdir(parents=True, exist_ok=True)
    build()
    with ThreadPoolExecutor(options.jobs) as pool:
        return list(pool.map(lambda target: run(target, options.seconds), options.targets or list(seeds.SEEDS)))


def main() -> int:
    results = fuzz_all(sys.argv[1:])
    finds = sum(len(result.finds) for result in results)
    print(f"{sum(result.inputs for result in results)} inputs, {finds} finds")
    return 1 if finds else 0


if __name__ == "__main__":
    sys.exit(main())
