"""Stopping a program, and what it costs."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenEXR
from PIL import Image

from tests import conftest
from tests.conftest import PROGRAM, TOP

#: The signals that ask the program to end.
SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP", "SIGXCPU")


def cpu_seconds(pid: int) -> float:
    """What the process has used of the processors so far, with its children that have ended."""
    return sum(map(int, stat_of(Path(f"/proc/{pid}"))[11:15])) / os.sysconf("SC_CLK_TCK")


def stat_of(process: Path) -> list[str]:
    """What /proc says of a process or a thread, from its state on."""
    return (process / "stat").read_text().rsplit(")", 1)[1].split()


def sleeps(pid: int) -> bool:
    """Whether all threads of the process wait for something."""
    try:
        return all(stat_of(thread)[0] == "S" for thread in Path(f"/proc/{pid}/task").iterdir())
    except (FileNotFoundError, ProcessLookupError):  # one has just ended
        return False


def listens(pid: int, number: signal.Signals) -> bool:
    """Whether the process has a handler for the signal."""
    caught = re.search(r"^SigCgt:\s*(\w+)$", Path(f"/proc/{pid}/status").read_text(), re.MULTILINE)
    return caught is not None and int(caught[1], 16) >> number - 1 & 1 == 1


def wait_until(process: subprocess.Popen[str], true: Callable[[], bool]) -> None:
    end = time.monotonic() + 100
    while not true():
        assert process.poll() is None
        assert time.monotonic() < end
        time.sleep(0.002)


def open_bytes(process: subprocess.Popen[str]) -> int:
    """The size of the largest file that the process has open and that has no name, or one for a time."""
    sizes = [0]
    for link in Path(f"/proc/{process.pid}/fd").iterdir():
        try:
            if re.search(r" \(deleted\)$|/\.kage-[^/]*$", str(link.readlink())):
                sizes.append(link.stat().st_size)
        except OSError:
            continue
    return max(sizes)


def stop_and_wait(process: subprocess.Popen[str], number: signal.Signals) -> tuple[float, str]:
    """Send the signal and wait. The processor time of the process after it, and what it said on stderr."""
    before = cpu_seconds(process.pid)
    process.send_signal(number)
    said = process.stderr.read() if process.stderr else ""
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.stderr:
        process.stderr.close()
    return usage.ru_utime + usage.ru_stime - before, said


def whole_or_absent(path: Path) -> bool:
    """Whether the picture can be read to its last pixel."""
    if path.suffix == ".exr":
        with OpenEXR.File(str(path), separate_channels=True) as file:
            return bool(file.channels())
    with Image.open(path) as image:
        image.load()
    return True


# ---- all stages of all commands ----

#: The threads of each command, as COMMANDS says.
THREADS = 2

#: Read and build (model, maps, horizons, displaced surfaces), render (waves and bands), write each kind.
COMMANDS = [
    ["render", "small.yaml", "--size", "1600x1200", "--threads", "2", "-o", "a.exr", "-o", "b.png"],
    ["render", "small.yaml", "--size", "900x700", "--aa", "3", "--surface", "displaced", "--threads", "2", "-o",
     "a.exr"],
    ["render", "map.yaml", "--bump-shadow", "horizon", "--threads", "2", "-o", "b.png"],
    ["render", "small.yaml", "--size", "2000x1500", "--resume", "--threads", "2", "-o", "c.exr"],
    ["render", "model.yaml", "--threads", "2", "-o", "b.png"],
    ["check", "map.yaml"],
    ["check", "model.yaml"],
    ["pixel", "map.yaml", "20,15"],
    ["pov", "map.yaml", "--surface", "displaced", "-o", "d.pov"],
    ["import", "model.obj", "-o", "e.yaml", "--overwrite"],
]

#: What the commands write.
OUTPUTS = ("a.exr", "b.png", "c.exr", "d.pov", "e.yaml")

#: The camera, light and material of the tests' scene, and its ball.
SCENE = conftest.SCENE[: conftest.SCENE.index("  ground:")] + conftest.SCENE[conftest.SCENE.index("  ball:") :]


def make_inputs(folder: Path) -> None:
    """The scenes of COMMANDS, a large map and a model."""
    rng = np.random.default_rng(1)
    coarse = Image.fromarray((rng.random((64, 64)) * 255).astype(np.uint8))
    coarse.resize((2048, 2048), Image.Resampling.BICUBIC).save(folder / "map.png")
    (folder / "small.yaml").write_text((TOP / "tests" / "data" / "cube.yaml").read_text())
    for path in (TOP / "tests" / "data").glob("*.png"):
        (folder / path.name).write_bytes(path.read_bytes())
    ground = "  ground:\n    {}\n    material: clay\n"
    (folder / "map.yaml").write_text(SCENE + ground.format(
        "rectangle: {origin: [-3, 0, 3], u: [6, 0, 0], w: [0, 0, -6]}")
        + "    bump: {map: {file: map.png}, scale: 0.1, zero: 0.5, sign: up}\n")
    (folder / "model.yaml").write_text(SCENE + ground.format("mesh: {file: model.obj}"))
    side = 150
    points = [f"v {x / side * 6 - 3} {rng.random() * 0.1} {z / side * 6 - 3}\n"
              for z in range(side) for x in range(side)]
    faces = [f"f {k + 1} {k + 1 + side} {k + 2}\nf {k + 2} {k + 1 + side} {k + 2 + side}\n"
             for z in range(side - 1) for k in range(z * side, z * side + side - 1)]
    (folder / "model.obj").write_text("".join(points + faces))


def make_outputs(folder: Path) -> None:
    """Older good files where COMMANDS write."""
    for name in ("a.exr", "b.png", "c.exr"):
        subprocess.run([PROGRAM, "render", "small.yaml", "--size", "40x30", "--quiet", "-o", name],
                       cwd=folder, check=True)
    (folder / "d.pov").write_text("// older\n")
    (folder / "e.yaml").write_text("# older\n")


def left_over(folder: Path) -> list[str]:
    """Names of temporary files."""
    return [path.name for path in folder.glob(".kage-*")]
