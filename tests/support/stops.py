"""Stopping a program, and what it costs."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path

import OpenEXR
from PIL import Image

#: The signals that ask the program to end.
SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP", "SIGXCPU")


def cpu_seconds(pid: int) -> float:
    """What the process has used of the processors so far, with its children that have ended."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")


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
