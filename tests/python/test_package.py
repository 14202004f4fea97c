"""The package kage: a scene to a picture, and the same picture as the program's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import kage
from tests.conftest import TOP, Kage

CUBE = TOP / "scenes" / "cube.yaml"


@pytest.fixture
def program(kage: Kage) -> Kage:
    return kage


def test_the_picture_is_the_programs(program: Kage, tmp_path: Path) -> None:
    picture = kage.load(CUBE).render(shadow="auto", shade="shifted", size=(64, 48))
    picture.save(tmp_path / "ours.png")
    program.good("render", CUBE, "--shadow", "auto", "--shade", "shifted", "--size", "64x48", "-o", "its.png")
    ours, its = (np.asarray(Image.open(tmp_path / name)) for name in ("ours.png", "its.png"))
    assert np.array_equal(ours, its)
    assert picture.rgb.shape == (48, 64, 3)
