"""examples/shader: a deferred renderer with a shadow map, and in it the method. Its shadows are kage's.

The shaders of the examples draw the scenes of figures 5 and 8 in WebGL (deferred.js is the engine around them). What
the light sees is compared with kage's own layer `visibility`.
"""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import OpenEXR
import pytest

from tests.conftest import PROGRAM
from tests.support.deferred import CUBE, LINE, SPHERE, drawn, included
from tests.support.shaders import Gpu, gpu

SIZE = (320, 240)


@pytest.fixture(scope="module")
def shader() -> Iterator[Gpu]:
    with gpu() as found:
        yield found


@cache
def lamp_seen(scene: Path, method: str, folder: Path) -> np.ndarray:
    """Where kage sees the lamp."""
    path = folder / f"{scene.stem}-{method}.exr"
    subprocess.run([PROGRAM, "render", scene, "--shadow", method, "--size", f"{SIZE[0]}x{SIZE[1]}", "--quiet",
                    "--set", "render.aa=1", "-o", path], check=True, timeout=120)
    with OpenEXR.File(str(path)) as file:
        channels = file.channels()
        return np.array(next(c.pixels for name, c in channels.items() if name.startswith("visibility"))) > 0.5


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("truth")


def wrong(picture: np.ndarray, seen: np.ndarray) -> float:
    """Pixels of the objects whose light is wrong, as a share of the shadow's."""
    there = picture[..., :3].any(axis=2)
    return float(((picture[..., 3] > 127) != seen)[there].sum() / (~seen)[there].sum())


@pytest.mark.parametrize("scene", [CUBE, SPHERE], ids=lambda scene: scene.stem)
def test_shadows_are_kages(scene: Path, shader: Gpu, folder: Path) -> None:
    """Those of order 0, and without the method's line those of bump mapping alone. What is left are edges, which a map
    of 2048 x 2048 samples does not know better. The sphere is a mesh, and in shadow on its far side, too."""
    lighting = included("lighting.frag")
    assert lighting.count(LINE) == 1
    bumpy, plain = drawn(shader, SIZE, lighting, scene), drawn(shader, SIZE, lighting.replace(LINE, "Q"), scene)
    order, none = lamp_seen(scene, "0", folder), lamp_seen(scene, "none", folder)
    assert wrong(bumpy, order) < 0.005 and wrong(plain, none) < 0.005
    assert wrong(bumpy, none) > 5 * wrong(bumpy, order) and wrong(plain, order) > 5 * wrong(bumpy, order)
    shown = bumpy[..., :3].astype(float)
    clay = (shown[..., 0] > shown[..., 2])[order]  # in light, with bumps
    assert shown[order][clay].std() > 15


def test_start_below_the_surface(shader: Gpu, folder: Path) -> None:
    """Where P < 0 the ray starts below the receiver's own surface: without start.glsl that shadows what it must not."""
    lighting = included("lighting.frag").replace(LINE, "Q + normalize(Q - eye) * n_tau.w")
    assert wrong(drawn(shader, SIZE, lighting), lamp_seen(CUBE, "0", folder)) > 0.5
