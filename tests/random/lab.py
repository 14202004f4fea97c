"""Renders random scenes with the builds that are compared: each build by a process of its own (worker.py), which a
crash or an endless render ends without harm.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from tests.random.draw import Scene

TOP = Path(__file__).resolve().parents[2]
Planes = dict[str, np.ndarray]


class RefusedError(Exception):
    """The library says that the scene or an option is wrong."""


class LostError(Exception):
    """The library crashed, or gave no answer in time."""


class Worker:
    """The Python package in `build`/python."""

    def __init__(self, build: Path, seconds: float) -> None:
        self.build = build
        self.seconds = seconds
        self.process: subprocess.Popen[bytes] | None = None

    def started(self) -> subprocess.Popen[bytes]:
        if self.process is None:
            path = os.pathsep.join((str(self.build / "python"), str(TOP)))
            self.process = subprocess.Popen([sys.executable, "-m", "tests.random.worker"], stdin=subprocess.PIPE,
                                            stdout=subprocess.PIPE, env=os.environ | {"PYTHONPATH": path}, cwd=TOP)
        return self.process

    def ask(self, request: dict[str, Any]) -> Planes:
        process = self.started()
        if process.stdin is None or process.stdout is None:
            raise LostError("no pipes")
        late = threading.Timer(self.seconds, process.kill)
        late.start()
        try:
            process.stdin.write((json.dumps(request) + "\n").encode())
            process.stdin.flush()
            line = process.stdout.readline()
            answer = json.loads(line) if line else {}
            shape = answer.get("shape", [0, 0])
            data = [process.stdout.read(4 * shape[0] * shape[1]) for _ in answer.get("planes", ())]
        except BrokenPipeError:
            answer, data = {}, []
        finally:
            late.cancel()
        if "error" in answer:
            raise RefusedError(answer["error"])
        if "planes" not in answer or any(len(plane) < 4 * shape[0] * shape[1] for plane in data):
            self.end()
            raise LostError(f"{self.build.name}: no answer in {self.seconds:g} s" if late.finished.is_set() and
                       process.returncode == -9 else f"{self.build.name}: exit status {process.returncode}")
        return {name: np.frombuffer(plane, "<f4").reshape(shape)
                for name, plane in zip(answer["planes"], data, strict=True)}

    def end(self) -> None:
        if self.process is not None:
            if self.process.stdin is not None:
                self.process.stdin.close()
            self.process.wait()
            if self.process.stdout is not None:
                self.process.stdout.close()
            self.process = None


@dataclass
class Lab:
    """builds: names, and their folders. folder: where scenes are written. It counts what it renders."""

    builds: dict[str, Path]
    folder: Path
    seconds: float = 120
    pictures: int = 0
    workers: dict[str, Worker] = field(default_factory=dict)

    def picture(self, scene: Scene, build: str = "float", **more: Any) -> Planes:
        """more: options of kage.Scene.render, or of the request to the worker: first, then, save, file, name."""
        for name, data in scene.named().items():
            (self.folder / name).write_bytes(data)
        own: dict[str, Any] = {key: more.pop(key) for key in ("first", "then", "save", "file", "name") if key in more}
        request = own | {"folder": str(self.folder), "text": scene.text(), "options": {"threads": 1} | more}
        if build not in self.workers:
            self.workers[build] = Worker(self.builds[build], self.seconds)
        self.pictures += 1
        return self.workers[build].ask(request)

    def end(self) -> None:
        for worker in self.workers.values():
            worker.end()
