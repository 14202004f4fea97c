"""Ctrl-C and its like, and kills: the program ends at once, says how far it was, and leaves no half of a file.

A wall clock can't judge a busy machine: there the system takes its time to end any process. So what is measured is the
processor time that a program uses after the signal. tests/verify/stops.py does it for all stages and many moments.
"""

from __future__ import annotations

import re
import signal
import subprocess
import time
from pathlib import Path

import pytest

from tests.conftest import PROGRAM, TOP, Kage, start
from tests.support.stops import (
    SIGNALS,
    cpu_seconds,
    listens,
    open_bytes,
    sleeps,
    stop_and_wait,
    wait_until,
    whole_or_absent,
)

CUBE = TOP / "tests" / "data" / "cube.yaml"

RENDER = [PROGRAM, "render", CUBE, "--size", "900x600", "-o", "a.exr", "-o", "b.png"]


@pytest.fixture(scope="module")
def lasted(tmp_path_factory: pytest.TempPathFactory) -> float:
    """How long RENDER takes, more or less."""
    begin = time.monotonic()
    subprocess.run([*map(str, RENDER), "--quiet"], cwd=tmp_path_factory.mktemp("whole"), check=True)
    return time.monotonic() - begin


@pytest.mark.parametrize("share", [0.1, 0.4, 0.7, 0.9])
def test_a_stop_leaves_no_half_file(kage: Kage, lasted: float, share: float) -> None:
    """At several times, some of them while files are written."""
    process = start(RENDER, cwd=kage.folder, stderr=subprocess.PIPE, text=True)
    time.sleep(share * lasted)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode in (0, -signal.SIGINT)
    written = {path.name for path in kage.folder.iterdir()}
    assert written <= {"a.exr", "b.png"}
    assert all(whole_or_absent(path) for path in kage.folder.iterdir())
    assert said or not written or process.returncode == 0  # without a word before the program has begun, or at its end
    if process.returncode and said:
        told = re.fullmatch(r"cube.yaml: stopped while (\w+)(, after \d+ %)?; (nothing written|written: (.*))\n", said)
        assert told, said
        assert set((told[4] or "").split(", ")) - {""} == written


@pytest.mark.parametrize("name", SIGNALS)
def test_a_stop_is_quick_and_tells(kage: Kage, name: str) -> None:
    """While an EXR of all layers is written, which takes seconds."""
    command = [PROGRAM, "render", CUBE, "--size", "1920x1080", "--threads", "2", "-o", "a.exr"]
    process = start(command, cwd=kage.folder, stderr=subprocess.PIPE, text=True)
    wait_until(process, lambda: open_bytes(process) > 1 << 20)
    number = signal.Signals[name]
    used, said = stop_and_wait(process, number)
    assert process.returncode == -number
    assert re.fullmatch(r"cube.yaml: stopped while writing, after \d+ %; nothing written\n", said), said
    assert used < 0.2 * 2  # of each of two processors
    assert kage.files() == set()


def test_a_command_that_does_not_listen_is_ended(kage: Kage) -> None:
    """Nobody reads from the pipe, so that the program waits for ever to open it."""
    fifo = kage.folder / "a.png"
    subprocess.run(["mkfifo", str(fifo)], check=True)
    process = start([PROGRAM, "render", CUBE, "--size", "40x30", "-o", "a.png"], cwd=kage.folder,
                    stderr=subprocess.PIPE, text=True)
    wait_until(process, lambda: listens(process.pid, signal.SIGTERM) and sleeps(process.pid))
    _, said = stop_and_wait(process, signal.SIGTERM)
    assert process.returncode == -signal.SIGTERM
    assert "stopped while" in said
    assert kage.files() == {"a.png"}


def test_an_ignored_signal_stays_ignored(kage: Kage) -> None:
    """As under nohup."""
    command = f"trap '' HUP; exec {PROGRAM} render {CUBE} --size 800x600 -o a.png"
    process = subprocess.Popen(["sh", "-c", command], cwd=kage.folder, stderr=subprocess.PIPE, text=True)
    wait_until(process, lambda: "kage" in Path(f"/proc/{process.pid}/comm").read_text())
    process.send_signal(signal.SIGHUP)
    assert process.wait(timeout=60) == 0
    assert kage.files() == {"a.png"}


def test_quiet_stops_without_a_word(kage: Kage) -> None:
    process = start([PROGRAM, "render", CUBE, "--size", "3000x2000", "--aa", "4", "--quiet", "-o", "a.png"],
                    cwd=kage.folder, stderr=subprocess.PIPE, text=True)
    wait_until(process, lambda: cpu_seconds(process.pid) > 0.1)
    _, said = stop_and_wait(process, signal.SIGINT)
    assert (process.returncode, said) == (-signal.SIGINT, "")


@pytest.mark.parametrize("share", [0.2, 0.5, 0.8, 0.9, 0.95])
def test_a_kill_loses_no_older_file(kage: Kage, lasted: float, share: float) -> None:
    """And leaves nothing: the new file has no name yet."""
    kage.good("render", CUBE, "--size", "40x30", "--quiet", "-o", "a.exr", "-o", "b.png")
    process = start(RENDER, cwd=kage.folder)
    time.sleep(share * lasted)
    process.kill()
    process.wait()
    assert {path.name for path in kage.folder.iterdir() if not path.name.startswith(".kage-")} == {"a.exr", "b.png"}
    assert all(whole_or_absent(path) for path in kage.folder.iterdir())
    done = kage("render", CUBE, "--size", "40x30", "-o", "c.png")
    assert done.returncode == 0
    assert kage.files() == {"a.exr", "b.png", "c.png"}  # what was left is removed
