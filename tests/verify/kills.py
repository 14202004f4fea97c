"""Kills every command at random moments (kill -9): an older good file is never lost, and nothing is left but what the
next run names and removes.

    scripts/venv python -m tests.verify.kills [--count N]
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
from tests.support.stops import COMMANDS, OUTPUTS, left_over, make_inputs, make_outputs, whole_or_absent
from tests.verify.record import record
from tests.verify.stops import lasted


def kill_once(command: list[str], folder: Path, after: float) -> tuple[bool, list[str]]:
    """Whether it came before the end, and what is wrong after it."""
    process = start([PROGRAM, *command, "--quiet"] if command[0] in ("render", "import") else [PROGRAM, *command],
                    cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    time.sleep(after)
    process.kill()
    killed = process.wait() == -signal.SIGKILL
    wrong = [f"lost {name}" for name in OUTPUTS if not (folder / name).exists()]
    wrong += [f"half a file: {name}" for name in OUTPUTS
              if name.endswith((".png", ".exr")) and (folder / name).exists() and not whole_or_absent(folder / name)]
    unknown = [path.name for path in folder.glob(".*") if not path.name.startswith(".kage-")]
    return killed, wrong + [f"left {name}" for name in unknown]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100, help="kills, some of them after the end (100)")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    chance = random.Random(given.seed)
    failures = named = kills = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make_inputs(folder)
        times = [lasted(command, folder) for command in COMMANDS]
        make_outputs(folder)
        for k in range(given.count):
            which = k % len(COMMANDS)
            after = chance.random() * times[which]
            killed, wrong = kill_once(COMMANDS[which], folder, after)
            kills += killed
            named += len(left_over(folder))
            done = start([PROGRAM, "render", "small.yaml", "--quiet", "-o", "small.png"], cwd=folder).wait()
            if done or left_over(folder):
                wrong.append("what was left is not removed by the next run")
            failures += bool(wrong)
            if wrong:
                print(f"kage {' '.join(COMMANDS[which])}: killed after {after:.2f} s: {'; '.join(wrong)}",
                      file=sys.stderr)
    return record("kills", {"commands": len(COMMANDS), "kills before the end": kills,
                            "temporary files that the next run removed": named}, failures)


if __name__ == "__main__":
    sys.exit(main())
