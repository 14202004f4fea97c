"""What the tests of the program share: the program under test, a scene to break, ways to run both.

The environment variable KAGE names the program, by default build/float/kage.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

TOP = Path(__file__).resolve().parent.parent
PROGRAM = Path(os.environ.get("KAGE", TOP / "build" / "float" / "kage")).resolve()

#: The Python package of the same build (`make python`).
sys.path.insert(0, str(PROGRAM.parent / "python"))

#: CI must have POV-Ray: there its absence is a failure.
needs_povray = pytest.mark.skipif(not shutil.which("povray") and not os.environ.get("CI"), reason="no povray")

#: How the program was built; an installed one does not say. A sanitizer has memory, addresses and libraries of its own.
FLAGS = PROGRAM.parent / "flags"
SANITIZED = FLAGS.exists() and "-fsanitize" in FLAGS.read_text()
not_sanitized = pytest.mark.skipif(SANITIZED, reason="a sanitizer has memory, addresses and libraries of its own")

#: The files that take longest, which begin first, so that two workers end together.
LONG = ("test_parity.py", "test_bench_run.py", "test_images.py", "test_regression.py", "test_input.py", "test_mesh.py",
        "test_pov.py", "test_live.py")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    items.sort(key=lambda item: LONG.index(item.path.name) if item.path.name in LONG else len(LONG))


#: A scene with one of everything that can be wrong. Tests replace parts of it.
SCENE = """\
camera: {from: [0, 3, -5], at: [0, 0, 0], up: [0, 1, 0], fov: 40}
image: {size: [40, 30], background: [0, 0, 0]}
render: {shadow: 0, guard: true, aa: 1}
lights:
  lamp: {at: [-4, 5, -2], color: [1, 1, 1]}
materials:
  clay: {color: [0.8, 0.7, 0.6], ambient: 0.1, diffuse: 0.8}
objects:
  ground:
    plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}
    material: clay
    bump:
      function: "0.1 * sin(u)"
  wall:
    rectangle: {origin: [2, 0, 2], u: [1, 0, 0], w: [0, -1, 0]}
    material: clay
    bump: {map: {file: map.png}, scale: 0.1, zero: 0.5, sign: up}
  cube:
    box: {from: [-1, 0.5, -1], to: [0, 1.5, 0]}
    material: clay
  ball:
    sphere: {center: [1, 1, 0], radius: 0.5}
    material: clay
"""


def start(command: Sequence[object], **options: Any) -> subprocess.Popen[Any]:
    """Start a command that is to be stopped: signals end it even where they are ignored here, as under nohup."""
    return subprocess.Popen([str(word) for word in command], preexec_fn=restore_signals, **options)


def restore_signals() -> None:
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


@dataclass
class Kage:
    """Runs the program in a folder of its own."""

    folder: Path
    environment: dict[str, str] = field(default_factory=lambda: dict(os.environ))

    def __call__(self, *arguments: object, cwd: Path | None = None,
                 timeout: float = 120) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [str(PROGRAM), *map(str, arguments)],
            cwd=cwd or self.folder,
            env=self.environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=timeout,
            encoding="utf-8",
        )

    def good(self, *arguments: object, cwd: Path | None = None) -> str:
        """Run what must succeed without a word on stderr; its stdout."""
        done = self(*arguments, cwd=cwd)
        assert (done.returncode, done.stderr) == (0, ""), done.stderr
        return done.stdout

    def files(self) -> set[str]:
        return {str(path.relative_to(self.folder)) for path in self.folder.rglob("*")}


@pytest.fixture
def kage(tmp_path: Path) -> Kage:
    assert PROGRAM.exists(), f"{PROGRAM} is not there: run make"
    return Kage(tmp_path)
