"""Limits of memory, of time, and of what a scene and its files have, from Python."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kage
from tests.conftest import SCENE
from tests.program.test_limits import BARE, png


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    png(tmp_path / "map.png", 8)
    png(tmp_path / "large.png", 10)
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE)
    return path


def test_at_a_limit_and_beyond(scene: Path) -> None:
    assert kage.load(scene, limits=kage.Limits(side=8, samples=64, objects=4, picture=40, scene=len(SCENE)))
    with pytest.raises(kage.InputError, match=r"scene\.yaml:17:24: .* at most 7 a side \(--limit side\)") as caught:
        kage.load(scene, limits=kage.Limits(side=7))
    assert (caught.value.line, caught.value.column) == (17, 24)
    with pytest.raises(kage.InputError, match=r"4 objects, expected at most 3 \(--limit objects\)"):
        kage.load(SCENE, folder=scene.parent, limits=kage.Limits(objects=3))


def test_changes_are_within_them(scene: Path) -> None:
    loaded = kage.load(scene, limits=kage.Limits(side=9, expression=12))
    with pytest.raises(kage.InputError, match=r"'large.png' .* at most 9 a side"):
        loaded.set("objects.wall.bump.map.file", "large.png")
    with pytest.raises(kage.InputError, match="at most 12 bytes"):
        loaded.changed("objects.ground.bump.function", "0.1 * sin(2*u)")
    assert loaded.render(progress=False).rgb.shape == (30, 40, 3)


def test_files_that_a_render_reads_again_are_within_them(scene: Path) -> None:
    """The map is another one by then."""
    loaded = kage.load(scene, limits=kage.Limits(side=9))
    (scene.parent / "large.png").rename(scene.parent / "map.png")
    with pytest.raises(kage.InputError, match="at most 9 a side"):
        loaded.render(surface="displaced")


def test_arrays_are_within_them() -> None:
    source = {"camera": {"from": [0, 3, -5], "at": [0, 0, 0]}, "lights": {}, "materials": {"clay": {}},
              "objects": {"ball": {"sphere": {"center": [0, 0, 0], "radius": 1}, "material": "clay",
                                   "bump": {"map": np.zeros((8, 16)), "scale": 0.1, "zero": 0, "sign": "up"}}}}
    assert kage.load(source, limits=kage.Limits(side=16, samples=128))
    with pytest.raises(kage.InputError, match="128 samples, expected at most 127"):
        kage.load(source, limits=kage.Limits(samples=127))


def test_memory_and_time(scene: Path, tmp_path: Path) -> None:
    loaded = kage.load(scene, limits=kage.Limits(memory=1 << 20))
    with pytest.raises(kage.NoMemoryError, match=r"it needs .* more than the limit of 1 MB"):
        loaded.render(size=(1000, 1000))
    assert loaded.render(size=(1000, 1000), limits=kage.Limits(memory=1 << 30)).rgb.shape == (1000, 1000, 3)
    short = kage.Limits(memory=-1, seconds=0.2)
    with pytest.raises(kage.OutOfTimeError) as caught:
        loaded.render(size=(2000, 2000), aa=16, layers=False, limits=short)
    assert isinstance(caught.value, TimeoutError)
    before = set(tmp_path.iterdir())
    with pytest.raises(kage.OutOfTimeError):
        loaded.render_file(tmp_path / "x.png", size=(2000, 2000), aa=16, layers=False, limits=short)
    with pytest.raises(kage.OutOfTimeError):
        kage.load(BARE, limits=kage.Limits(seconds=1e-9))
    with pytest.raises(kage.OutOfTimeError):
        loaded.povray(tmp_path / "x.pov", surface="displaced", limits=kage.Limits(seconds=1e-9))
    assert set(tmp_path.iterdir()) == before


@pytest.mark.parametrize(("limits", "words"), [
    (kage.Limits(side=65537), "a limit of 65537 for 'side'"),
    (kage.Limits(side=-1), "limits.side is -1"),
    (kage.Limits(side=1.5), "limits.side is 1.5"),  # type: ignore[arg-type]
    (kage.Limits(memory="2G"), "limits.memory is '2G'"),  # type: ignore[arg-type]
    (kage.Limits(seconds=-1), "a limit of -1 seconds"),
    (kage.Limits(seconds=float("nan")), "a limit of nan seconds"),
    ({"side": 3}, "expected kage.Limits"),
])
def test_no_limits(limits: Any, words: str) -> None:
    with pytest.raises(kage.OptionError, match=words):
        kage.load(BARE, limits=limits)
