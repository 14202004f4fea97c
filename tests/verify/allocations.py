"""Each allocation of kage's own code fails in turn, over commands that reach every room.

    scripts/venv python -m tests.verify.allocations [--count N] [--seconds S]

allocations.c is preloaded into the program and makes the N-th call fail. The command must then succeed or end with an
error: exit status 1 or 2 and a message that says so, nothing left of the program's blocks, no crash, and the older
output as it was.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from tests.conftest import PROGRAM
from tests.support.failing import preloaded
from tests.verify.record import TOP, record

SCENES = TOP / "scenes"
OLD = b"an older file"

#: A scene of copies, glass, a model, a map for colours, a checker, a list.
ROOMS = """\
camera: {from: [0, 3, -6], at: [0, 0, 0]}
image: {size: [16, 12]}
render: {shadow: 2, depth: 3}
lights:
  sun: {at: [-3, 8, -4], color: [1, 1, 1]}
materials:
  clay: {color: {checker: {even: [1, 1, 1], odd: [0, 0, 0]}}}
  skin: {color: {image: {file: %(data)s/bumps.png}}}
  glass: {color: [0.1, 0.1, 0.1], filter: 0.9, ior: 1.5}
objects:
  floor: {rectangle: {origin: [-3, -1, -3], u: [6, 0, 0], w: [0, 0, 6]}, material: clay,
          bump: {function: 0.05*sin(5*u)*cos(5*w)}}
  model: {mesh: {file: %(data)s/lantern.obj}, material: clay}
  ball: {sphere: {center: [0, 0, 0], radius: 0.5}, material: glass}
  dot: {sphere: {center: [0, 0, 0], radius: 0.1}, material: clay}
  dots: {copies: {of: dot, file: places.csv}, material: clay}
"""


@dataclass(frozen=True)
class Command:
    name: str
    words: tuple[str, ...]  # OUT stands for the output's name
    ending: str = ""  # of the output; "": none


def picture(name: str, *words: str) -> Command:
    return Command(name, ("render", *words, "--size", "16x12", "--threads", "1", "-q", "-o", "OUT"), ".exr")


def commands(folder: Path) -> list[Command]:
    """Small ones first."""
    cube, teapot = str(SCENES / "cube.yaml"), str(SCENES / "gallery" / "teapot.yaml")
    rooms = folder / "rooms.yaml"
    rooms.write_text(ROOMS % {"data": SCENES / "data"})
    (folder / "places.csv").write_text("x,y,z\n1,0,0\n2,0,0\n1,0,2\n")
    return [
        picture("map from a PNG", cube),
        Command("picture as a PNG", ("render", cube, "--size", "16x12", "--threads", "1", "-q", "-o", "OUT"), ".png"),
        picture("map from an EXR", str(SCENES / "terrain.yaml")),
        picture("exact", cube, "--shadow", "exact"),
        picture("displaced", str(SCENES / "torus.yaml"), "--surface", "displaced"),
        picture("adaptive samples", str(SCENES / "sphere.yaml"), "--aa", "2", "--aa-threshold", "0.1"),
        picture("mesh, copies, glass", str(rooms)),
        picture("patches", teapot),
        Command("check", ("check", cube)),
        Command("pixel", ("pixel", cube, "200,200")),
        Command("POV-Ray", ("pov", str(rooms), "--size", "16x12", "-o", "OUT"), ".pov"),
        Command("import", ("import", str(SCENES / "data" / "lantern.obj"), "--overwrite", "-q", "-o", "OUT"), ".yaml"),
        picture("auto, horizons", cube, "--shadow", "auto", "--bump-shadow", "horizon"),
    ]


class Trial:
    """The program with the preloaded library."""

    def __init__(self, kage: Path, folder: Path) -> None:
        self.kage, self.folder = kage, folder
        self.library = preloaded(Path(__file__).with_name("allocations.c"), folder)

    def run(self, command: Command, failing: int | None) -> tuple[subprocess.CompletedProcess[str], int, int, bytes]:
        """The result, the calls, the blocks that are left, and the output's bytes."""
        out, told = self.folder / ("out" + command.ending), self.folder / "told"
        told.unlink(missing_ok=True)
        out.write_bytes(OLD)
        words = [str(out) if word == "OUT" else word for word in command.words]
        env = {**os.environ, "LD_PRELOAD": str(self.library), "KAGE_ALLOCATIONS_TO": str(told),
               "KAGE_IMPORT": str(self.kage.with_name("kage-import"))}
        env |= {} if failing is None else {"KAGE_ALLOCATION": str(failing)}
        done = subprocess.run([self.kage, *words], env=env, capture_output=True, text=True, timeout=300)
        calls, left = map(int, told.read_text().split()) if told.exists() else (0, -1)
        return done, calls, left, out.read_bytes() if out.exists() else b""

    def wrong(self, command: Command, failing: int, base: int) -> str:
        """What is wrong where a call fails; "": nothing."""
        done, calls, left, out = self.run(command, failing)
        if done.returncode not in (0, 1, 2):
            return f"exit status {done.returncode}"
        if done.returncode and "memory" not in done.stderr:
            return f"no word of memory: {done.stderr[:300]!r}"
        if done.returncode and command.ending and out != OLD:
            return "the older output is changed"
        if left > base:
            return f"{left - base} blocks are left"
        return "" if calls >= failing else "the call was not reached"


def try_all(kage: Path, most: int, seconds: float, chosen: str = "", show: bool = False) -> tuple[int, int, list[str]]:
    """Fail up to `most` calls of each command, evenly over them. Returns commands, failed calls, what is wrong."""
    end = time.monotonic() + seconds
    tried, ran, bad = 0, 0, []
    with tempfile.TemporaryDirectory() as name:
        trial = Trial(kage, Path(name))
        for command in commands(Path(name)):
            if chosen not in command.name:
                continue
            done, calls, base, _ = trial.run(command, None)
            if done.returncode or not calls:
                bad.append(f"{command.name}, no call failing: {calls} calls, exit status {done.returncode}: "
                           f"{done.stderr[:300]}")
                continue
            ran += 1
            step = max(1, -(-calls // most))
            for failing in range(1, calls + 1, step):
                if time.monotonic() > end:
                    return ran, tried, bad
                tried += 1
                if what := trial.wrong(command, failing, base):
                    bad.append(f"{command.name}, call {failing} of {calls}: {what}")
            if show:
                print(f"{command.name}: {calls} calls, every {step}.; {len(bad)} wrong so far", flush=True)
    return ran, tried, bad


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=10**9, help="calls that fail in each command")
    parser.add_argument("--seconds", type=float, default=1e9)
    parser.add_argument("--only", default="", help="commands with this in their names")
    given = parser.parse_args()
    ran, tried, bad = try_all(PROGRAM, given.count, given.seconds, given.only, show=True)
    print(*bad[:60], sep="\n", file=sys.stderr)
    return record("allocations", {"commands": ran, "allocations that failed in turn": tried}, len(bad))


if __name__ == "__main__":
    sys.exit(main())
