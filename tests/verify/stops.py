"""Stops every command at many random moments, and measures how soon it ends and what it leaves.

    scripts/venv python -m tests.verify.stops [--count N]

A wall clock can't judge a busy machine, so a stop is measured by the processor time that the command uses after the
signal, with that of its children: at most 0.2 s on each of its threads. A calibrated sleeper, `sleep` stopped in the
same way, tells how much of the wall time is the machine's own.
"""

from __future__ import annotations

import argparse
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.conftest import PROGRAM, start
from tests.support.stops import (
    COMMANDS,
    SIGNALS,
    THREADS,
    left_over,
    listens,
    make_inputs,
    stop_and_wait,
    whole_or_absent,
)
from tests.verify.record import record

LIMIT = 0.2  # seconds


def lasted(command: list[str], folder: Path) -> float:
    """How long a command runs, but at most five seconds."""
    begin = time.monotonic()
    process = start([PROGRAM, *command], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        process.wait(timeout=5)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    return time.monotonic() - begin


def sleeper() -> float:
    """The wall time that the machine takes to end a program that does nothing."""
    process = start(["sleep", "60"], stderr=subprocess.PIPE, text=True)
    time.sleep(0.05)
    begin = time.monotonic()
    stop_and_wait(process, signal.SIGTERM)
    return time.monotonic() - begin


def stop_once(command: list[str], folder: Path, after: float,
              number: signal.Signals) -> tuple[float, float, list[str]] | None:
    """The processor time and the wall time after the signal, and what is wrong. None: it had ended before."""
    wrong = []
    process = start([PROGRAM, *command], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    time.sleep(after)
    if process.poll() is not None:
        process.communicate()
        return None
    heard = listens(process.pid, number)
    begin = time.monotonic()
    used, said = stop_and_wait(process, number)
    wall = time.monotonic() - begin
    if process.returncode not in (0, -number):
        wrong.append(f"status {process.returncode}")
    if process.returncode and heard and "stopped" not in said:
        wrong.append(f"said {said!r}")
    wrong += [f"half a file: {path.name}" for path in folder.iterdir()
              if path.suffix in (".png", ".exr") and not path.is_symlink() and not whole_or_absent(path)]
    wrong += [f"left {name}" for name in left_over(folder)]
    if used > LIMIT * THREADS:
        wrong.append(f"{used:.2f} s of processor time")
    return used, wall, wrong


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200, help="stops, some of them after the end (200)")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    chance = random.Random(given.seed)
    stops, failures, worst, over = 0, 0, 0.0, 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make_inputs(folder)
        times = [lasted(command, folder) for command in COMMANDS]
        for k in range(given.count):
            which = k % len(COMMANDS)
            number = signal.Signals[chance.choice(SIGNALS)]
            after = chance.random() * times[which]
            machine = sleeper()
            stopped = stop_once(COMMANDS[which], folder, after, number)
            if not stopped:
                continue
            used, wall, wrong = stopped
            stops += 1
            worst = max(worst, used)
            over += wall > machine + LIMIT
            failures += bool(wrong)
            if wrong:
                print(f"kage {' '.join(COMMANDS[which])}: {number.name} after {after:.2f} s: {'; '.join(wrong)}",
                      file=sys.stderr)
    return record("stops", {"commands": len(COMMANDS), "stops before the end": stops,
                            "ms of processor time after the signal at worst": round(1e3 * worst),
                            "later than 0.2 s by the wall clock": over}, failures)


if __name__ == "__main__":
    sys.exit(main())
