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
from kage import gbuffer
from kage.heights import HeightMap
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


@pytest.mark.parametrize("tangents", ["its tangents", "differences"])
def test_a_ball_with_a_mirrored_texture(example: Any, monkeypatch: pytest.MonkeyPatch, tangents: str) -> None:
    """scenes/sphere.yaml: Mitsuba's uv go around the ball the other way, so Qu x Qw points inward."""
    lamp = np.array([-5.4, 4.4, -4.9])
    for name, value in (("EYE", [0.9, 1.0, -6.4]), ("AT", [-0.2, 0.32, 0]), ("FOV", 38), ("LAMP", lamp)):
        monkeypatch.setattr(example, name, value)
    pose = example.mi.ScalarTransform4f
    box = {"type": "cube", "to_world": pose().translate([-1.175, 1.25, -1.7]).scale([0.325, 0.3, 0.25])}
    up = pose([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    image = example.trace({"cube": box, "ground": {"type": "sphere", "radius": 1.5, "to_world": up}}, *SIZE)
    samples = np.asarray(Image.open(example.MAP), np.float64)[:, ::-1] / 65535
    heights = HeightMap(samples, (0.5, 1), scale=0.09, zero=0.417)
    given = (image["Qu"], image["Qw"]) if tangents == "its tangents" else None
    a = gbuffer.layers(example.EYE, image["Q"], image["uv"], normal=image["n"], tangents=given, there=image["ground"])
    assert (a.sign[a.there] == -1).all()
    for method in ("2+", "march:8"):
        c = gbuffer.correct(a, heights, method)
        picture = kage.load(TOP / "scenes" / "sphere.yaml").render(shadow=method, size=SIZE)
        # the ball's own far side is not in Mitsuba's test
        asked = image["ground"] & (np.array(picture["order"]) >= 0) & ((image["n"] * (lamp - image["Q"])).sum(-1) > 0)
        lit = example.is_lit(box, c.origin, asked)
        assert 500 < (asked & ~lit).sum() < 3000 < asked.sum()
        assert (lit == (np.array(picture["visibility.lamp"]) > 0.5))[asked].mean() > 0.999
        assert (c.order == picture["order"])[asked].mean() > 0.995
        assert np.median(np.abs(c.normal - picture["N"])[asked]) < 1e-4


def test_the_program_writes_the_three(example: Any, tmp_path: Path) -> None:
    options = ["--size", "60", "45", "--mesh", "128", "--method", "march:4", "-o", "out.png"]
    path = {"PYTHONPATH": str(PROGRAM.parent / "python"), "PATH": "/usr/bin:/bin"}
    done = subprocess.run([sys.executable, example.__file__, *options], cwd=tmp_path, env=path,
                          capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert [line.split(":")[0] for line in done.stdout.splitlines()] == ["none", "march", "displaced"]
    assert Image.open(tmp_path / "out.png").width > 3 * 60
