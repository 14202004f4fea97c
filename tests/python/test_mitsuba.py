"""examples/mitsuba_shadows.py: Mitsuba's rays and shadow tests with kage's shift, against the truth and kage itself."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import kage
from tests.conftest import PROGRAM, TOP

SIZE = (160, 120)


@pytest.fixture(scope="module")
def example() -> Iterator[Any]:
    sys.path.insert(0, str(TOP / "examples"))
    try:
        import mitsuba_shadows
        yield mitsuba_shadows
    finally:
        sys.path.remove(str(TOP / "examples"))


@pytest.fixture(scope="module")
def made(example: Any) -> Any:
    return example.pictures(SIZE, "2", 512)


def test_the_shadow_is_nearer_to_the_truth(made: Any) -> None:
    """Pixels of the shadow that Mitsuba's own displaced mesh has otherwise."""
    truth, asked = made["displaced"][2], made["displaced"][1] & made["none"][1]
    dark = (asked & ~truth).sum()
    wrong = {name: (asked & (lit != truth)).sum() / dark for name, (_, _, lit) in made.items()}
    print(wrong)
    assert dark > 1000
    assert wrong["none"] > 0.04
    assert wrong["2"] < 0.01


@pytest.mark.parametrize("method", ["none", "2"])
def test_the_shadow_is_kages(made: Any, method: str) -> None:
    """The same scene by kage alone: rays, formulas and shadow tests are its own."""
    picture = kage.load(TOP / "scenes" / "cube.yaml").render(shadow=method, size=SIZE)
    _, ground, lit = made[method]
    seen = np.array(picture["order"]) >= (-1 if method == "none" else 0)
    asked = ground & seen
    assert asked.sum() > 0.99 * ground.sum()
    same = (lit == (np.array(picture["visibility.lamp"]) > 0.5))[asked].mean()
    print(f"{method}: {100 * same:.2f} % of the ground's pixels see the lamp alike")
    assert same >= 0.999
    off = np.abs(made[method][0] - picture.rgb)[asked].max(-1)
    assert np.percentile(off, 99) < 0.005


def test_the_program_writes_the_three(example: Any, tmp_path: Path) -> None:
    options = ["--size", "60", "45", "--mesh", "128", "--method", "march:4", "-o", "out.png"]
    path = {"PYTHONPATH": str(PROGRAM.parent / "python"), "PATH": "/usr/bin:/bin"}
    done = subprocess.run([sys.executable, example.__file__, *options], cwd=tmp_path, env=path,
                          capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert [line.split(":")[0] for line in done.stdout.splitlines()] == ["none", "march", "displaced"]
    assert Image.open(tmp_path / "out.png").width > 3 * 60
