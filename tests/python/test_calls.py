"""Calls that last: Ctrl-C at any moment, progress, the lock of Python, several at once, files whole or not at all."""

from __future__ import annotations

import random
import signal
import subprocess
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kage
from kage import workers
from tests.conftest import TOP

CUBE = TOP / "scenes" / "cube.yaml"

#: Makes a call that takes far longer than any test, interrupts itself in it, and prints how soon it came out.
INTERRUPTED = """
import os, signal, sys, threading, time
import kage
scene = kage.load(os.environ["SCENES"] + "/{scene}.yaml", progress=False)
pressed = []
def press():
    pressed.append(time.perf_counter())
    os.kill(os.getpid(), signal.SIGINT)
work = lambda: {call}
threading.Timer({after}, press).start()
try:
    work()
except KeyboardInterrupt:
    print(f"{{time.perf_counter() - pressed[0]:.3f}}")
"""

CALLS = {
    "render": ("cube", 'scene.render(size=(8000, 6000), surface="displaced", layers=False)'),
    "build": ("gallery/wall", 'scene.render(size=(8, 6), bump_shadow="horizon")'),
    "file": ("cube", 'scene.render_file("big.exr", size=(8000, 6000), aa=4)'),
    "png": ("cube", 'scene.render_file("big.png", size=(8000, 6000), aa=4)'),
    "povray": ("cube", 'scene.povray("scene.pov", surface="displaced")'),
}

Python = Callable[..., "subprocess.Popen[Any]"]


@pytest.mark.parametrize("name", CALLS)
def test_ctrl_c_ends_any_call_at_once(python: Python, tmp_path: Path, name: str) -> None:
    """0.2 s on a machine of its own; the tests may share theirs with many others."""
    scene, call = CALLS[name]
    child = python(INTERRUPTED.format(scene=scene, call=call, after=0.4))
    out, err = child.communicate(timeout=120)
    assert (child.returncode, err) == (0, ""), err
    assert float(out) < 2, "within a fraction of a second"
    files = sorted(path.name for path in tmp_path.iterdir())
    assert files in ([], ["big.exr.part"]) if name == "file" else files == []


def test_ctrl_c_while_a_file_is_written(python: Python, tmp_path: Path) -> None:
    (tmp_path / "x.exr").write_bytes(b"older")
    text = INTERRUPTED.replace("pressed = []", "picture = scene.render(size=(3000, 2000)); pressed = []")
    child = python(text.format(scene="cube", call='picture.save("x.exr", threads=1)', after=0.05))
    out, err = child.communicate(timeout=120)
    assert (child.returncode, err) == (0, "") and float(out) < 2, err
    assert [path.name for path in tmp_path.iterdir()] == ["x.exr"] and (tmp_path / "x.exr").read_bytes() == b"older"


#: Interrupts itself a moment after a step has begun, and prints at which share of that step it came out.
IN_STEP = """
import os, signal, threading
import numpy as np
import kage
heights = np.random.default_rng(1).integers(0, 255, (3000, 3000), np.uint8)
bump = {{"map": {{"file": heights}}, "scale": 0.1, "zero": 0.5, "sign": "up", "smooth": {smooth}}}
floor = {{"rectangle": {{"origin": [-3, 0, 3], "u": [6, 0, 0], "w": [0, 0, -6]}}, "material": "clay", "bump": bump}}
scene = {{"camera": {{"from": [0, 3, -5], "at": [0, 0, 0], "fov": 40}}, "image": {{"size": [8, 6]}},
         "lights": {{"lamp": {{"at": [-4, 5, -2], "color": [1, 1, 1]}}}},
         "materials": {{"clay": {{"color": [0.8, 0.7, 0.6]}}}}, "objects": {{"floor": floor}}}}
shares = []
def listen(what, share):
    if what == "{step}":
        shares.append(share)
        if len(shares) == 1:
            threading.Timer(0.01, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    kage.load(scene, progress=listen).render(progress=listen, {options})
except KeyboardInterrupt:
    print(shares[-1])
"""

#: A map's tables, each of which takes a second or so. smooth, what render is told, and the step.
TABLES = {
    "smooth": (16, "", "smoothing"),
    "horizon": (0, 'bump_shadow="horizon"', "horizons"),
    "exact": (0, 'bump_shadow="exact"', "building"),
    "displaced": (0, 'surface="displaced"', "building"),
}


@pytest.mark.parametrize("name", TABLES)
def test_ctrl_c_ends_the_making_of_tables(python: Python, name: str) -> None:
    """Far from the end of them, however fast or busy the machine is."""
    smooth, options, step = TABLES[name]
    out, err = python(IN_STEP.format(smooth=smooth, options=options, step=step)).communicate(timeout=120)
    assert err == "" and float(out) < 0.8, (out, err)


def test_ctrl_c_is_always_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the caller is at while it waits; it looks far oftener here, as Ctrl-C must come between two steps."""
    chance, ended = random.Random(1), threading.Event()
    monkeypatch.setattr(workers, "STEP", 2e-5)
    before = signal.signal(signal.SIGALRM, signal.default_int_handler)
    try:
        for _ in range(1000):
            ended.clear()
            with pytest.raises(KeyboardInterrupt):
                signal.setitimer(signal.ITIMER_REAL, chance.uniform(5e-4, 1e-3))
                workers.run(lambda: ended.wait(10), lambda: None, ended.set, files=False)
    finally:
        signal.signal(signal.SIGALRM, before)


def test_progress_is_told() -> None:
    steps: list[tuple[str, float]] = []
    kage.load(CUBE).render(size=(1500, 1000), aa=2, threads=1, progress=lambda *step: steps.append(step))
    shares = [share for what, share in steps if what == "rendering"]
    assert shares and shares == sorted(shares) and shares[0] >= 0 and shares[-1] <= 1


#: A picture of one tile that takes ten seconds and more: 4096 samples of an area light, on the dearest surface.
ONE_TILE = {"image.size": [16, 8], "render.aa": 16, "render.surface": "displaced",
            "lights.lamp.area": {"u": [1, 0, 0], "w": [0, 0, 1], "samples": [64, 64]}}


def test_a_long_tile_is_told_of_again_and_again() -> None:
    steps: list[tuple[str, float]] = []

    def listen(what: str, share: float) -> None:
        steps.append((what, share))
        if steps.count(("rendering", 0)) == 4:
            raise LookupError

    scene = kage.load(CUBE, sets=ONE_TILE)
    with pytest.raises(LookupError):
        scene.render(progress=listen)
    assert steps[-4:] == [("rendering", 0)] * 4


def test_what_the_callers_function_raises_ends_the_call() -> None:
    def listen(what: str, _share: float) -> None:
        raise LookupError(what)

    with pytest.raises(LookupError, match="rendering"):
        kage.load(CUBE).render(size=(8000, 6000), aa=8, layers=False, progress=listen)


def test_the_callers_function_may_use_the_package() -> None:
    scene, made = kage.load(CUBE), []

    def listen(_what: str, _share: float) -> None:
        made.append(scene.render(size=(16, 12)))

    scene.render(size=(300, 200), progress=listen)
    assert made


def test_the_lock_of_python_is_free_and_pictures_are_the_same() -> None:
    scene = kage.load(CUBE)
    alone = scene.render(size=(320, 240), relief=True)
    pictures: list[kage.Picture] = []

    def render() -> None:
        pictures.extend(scene.render(size=(320, 240), relief=True, threads=1) for _ in range(3))

    threads = [threading.Thread(target=render) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(pictures) == 12
    assert all(np.array_equal(picture[name], alone[name]) for picture in pictures for name in ("R", "tau"))


def test_python_goes_on_while_a_call_lasts() -> None:
    """A thread counts while another renders: all of the time, and not only between two steps."""
    scene, seen = kage.load(CUBE), []
    worker = threading.Thread(target=lambda: scene.render(size=(1200, 900), aa=3, threads=1))
    worker.start()
    while worker.is_alive():
        seen.append(time.perf_counter())
        time.sleep(0.001)
    assert len(seen) > 20


#: The second render lasts far longer than the 0.3 s without a bar, on a fast machine, too.
BAR = """
import os, sys, kage
scene = kage.load(os.environ["SCENES"] + "/cube.yaml")
scene.render(size=(64, 48), progress=None)
scene.render(size=(1600, 1200), aa=8, threads=1, layers=False, progress=PROGRESS)
"""


def test_no_bar_without_a_terminal(python: Python) -> None:
    assert python(BAR.replace("PROGRESS", "None")).communicate(timeout=120) == ("", "")


def test_a_bar_where_it_is_asked_for(python: Python) -> None:
    out, err = python(BAR.replace("PROGRESS", "True")).communicate(timeout=120)
    assert out == "" and "cube.yaml: rendering" in err and "pixel/s" in err
