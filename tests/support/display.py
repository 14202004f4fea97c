"""A display without a screen (Xvfb), kage view on it, real events (xdotool), and what the window shows."""

from __future__ import annotations

import os
import queue
import re
import struct
import subprocess
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

TIMEOUT = 90.0  # seconds; a busy machine is no failure


@dataclass
class Display:
    """An X server whose screen is in a file."""

    name: str
    folder: Path

    def screen(self) -> np.ndarray[Any, Any]:
        """Its pixels, height x width x (red, green, blue), from the XWD file that the server keeps."""
        data = (self.folder / "Xvfb_screen0").read_bytes()
        header = struct.unpack(">25I", data[:100])
        width, height, row, colors = header[4], header[5], header[12], header[19]
        start = header[0] + 12 * colors
        pixels = np.frombuffer(data[start:start + row * height], np.uint8).reshape(height, row // 4, 4)
        return pixels[:, :width, 2::-1].copy()

    def do(self, *words: object) -> str:
        """xdotool."""
        return subprocess.run(["xdotool", *map(str, words)], env=self.environment, check=True, capture_output=True,
                              text=True, timeout=TIMEOUT).stdout

    @property
    def environment(self) -> dict[str, str]:
        return {**os.environ, "DISPLAY": self.name, "SDL_VIDEODRIVER": "x11"}


@contextmanager
def display(folder: Path, size: str = "1280x800") -> Iterator[Display]:
    """Start a server under a number that is free, and end it."""
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", f"{size}x24", "-fbdir", str(folder), "-nolisten", "tcp"],
        pass_fds=[write], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(write)
    try:
        with os.fdopen(read) as pipe:
            number = pipe.readline().strip()
        assert number, "Xvfb did not start"
        yield Display(f":{number}", folder)
    finally:
        server.terminate()
        server.wait()


@dataclass
class View:
    """kage view --report: its lines as they come, and its window."""

    display: Display
    process: subprocess.Popen[str]
    lines: queue.Queue[str] = field(default_factory=queue.Queue)
    said: list[str] = field(default_factory=list)
    place: tuple[int, int] = (0, 0)  # of the window on the screen

    def listen(self) -> None:
        assert self.process.stdout
        for line in self.process.stdout:
            self.lines.put(line.rstrip("\n"))
        self.lines.put("")

    def wait(self, pattern: str) -> str:
        """The next line in which the pattern is found."""
        while True:
            line = self.lines.get(timeout=TIMEOUT)
            self.said.append(line)
            assert line or self.process.poll() is None, f"ended before {pattern}: {self.said[-9:]}"
            if re.search(pattern, line):
                return line

    def settle(self, pattern: str = "") -> str:
        """Wait for the last picture of the newest look, in which the pattern is found."""
        return self.wait(rf"^shown \d+ last .*{pattern}")

    def key(self, *keys: str) -> None:
        self.display.do("key", *keys)

    def mouse(self, x: int, y: int) -> None:
        self.display.do("mousemove", self.place[0] + x, self.place[1] + y)

    def park(self) -> None:
        """Take the pointer off the window: the server draws it into the screen."""
        self.display.do("mousemove", 0, 0)

    def drag(self, x: int, y: int, to_x: int, to_y: int, button: int = 1, hold: str = "") -> None:
        """Press at x, y, move, and let go, with a key held."""
        left, top = self.place
        down, up = (["keydown", hold], ["keyup", hold]) if hold else ([], [])
        self.display.do("mousemove", left + x, top + y, *down, "mousedown", button, "mousemove", left + to_x,
                        top + to_y, "mouseup", button, *up)

    def pixels(self, width: int, height: int) -> np.ndarray[Any, Any]:
        """The picture in the window."""
        left, top = self.place
        return self.display.screen()[top:top + height, left:left + width]


@contextmanager
def view(on: Display, program: Path, *arguments: object, cwd: Path) -> Iterator[View]:
    """Open the window, wait until its first picture is finished, and close it."""
    process = subprocess.Popen([str(program), "view", *map(str, arguments), "--report"], env=on.environment, cwd=cwd,
                               stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True)
    opened = View(on, process)
    threading.Thread(target=opened.listen, daemon=True).start()
    try:
        opened.settle()
        window = on.do("search", "--pid", process.pid).split()[0]
        place = dict(line.split("=") for line in on.do("getwindowgeometry", "--shell", window).splitlines())
        opened.place = int(place["X"]), int(place["Y"])
        yield opened
    finally:
        process.terminate()
        process.wait()


def until(happens: Callable[[], bool], tries: int = 900, pause: float = 0.1) -> bool:
    """Whether it happens before long; for what no line of --report tells of."""
    wait = threading.Event()
    return any(happens() or wait.wait(pause) for _ in range(tries))
