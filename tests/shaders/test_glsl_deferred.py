"""examples/shader: a deferred renderer with a shadow map, and in it the method. Its shadows are kage's.

The shaders of the examples draw figure 5's scene in WebGL (deferred.js is the engine around them). What the light sees
is compared with kage's own layer `visibility`.
"""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import OpenEXR
import pytest

from tests.conftest import PROGRAM
from tests.support.deferred import LINE, SCENE, drawn, included
from tests.support.shaders import Gpu, gpu

SIZE = (320, 240)


@pytest.fixture(scope="module")
def shader() -> Iterator[Gpu]:
    with gpu() as found:
        yield found


def kage_visibility(method: str, folder: Path) -> np.ndarray:
    """How much of the lamp kage sees."""
    path = folder / f"{method}.exr"
    subprocess.run([PROGRAM, "render", SCENE, "--shadow", method, "--size", f"{SIZE[0]}x{SIZE[1]}", "--quiet",
                    "--set", "render.aa=1", "-o", path], check=True, timeout=120)
    with OpenEXR.File(str(path)) as file:
        channels = file.channels()
        return np.array(next(c.pixels for name, c in channels.items() if name.startswith("visibility")))


@pytest.fixture(scope="module")
def truth(tmp_path_factory: pytest.TempPathFactory) -> dict[str, np.ndarray]:
    """Where kage sees the lamp, by method."""
    folder = tmp_path_factory.mktemp("truth")
    return {method: kage_visibility(method, folder) > 0.5 for method in ("none", "0")}


def wrong(picture: np.ndarray, seen: np.ndarray) -> float:
    """Pixels whose light is wrong, as a share of the shadow's."""
    return float(((picture[..., 3] > 127) != seen).sum() / (~seen).sum())


def test_shadows_are_kages(shader: Gpu, truth: dict[str, np.ndarray]) -> None:
    """Those of order 0, and without the method's line those of bump mapping alone. What is left are edges, which a map
    of 2048 x 2048 samples does not know better."""
    lighting = included("lighting.frag")
    assert lighting.count(LINE) == 1
    bumpy, plain = drawn(shader, SIZE, lighting), drawn(shader, SIZE, lighting.replace(LINE, "Q"))
    assert wrong(bumpy, truth["0"]) < 0.005 and wrong(plain, truth["none"]) < 0.005
    assert wrong(bumpy, truth["none"]) > 0.05 and wrong(plain, truth["0"]) > 0.05
    shown = bumpy[..., :3].astype(float)
    ground = (shown[..., 0] > shown[..., 2])[truth["0"]]  # clay in light, with bumps
    assert shown[truth["0"]][ground].std() > 15


def test_start_below_the_surface(shader: Gpu, truth: dict[str, np.ndarray]) -> None:
    """Where P < 0 the ray starts below the receiver's own surface: without start.glsl that shadows what it must not."""
    lighting = included("lighting.frag").replace(LINE, "Q + normalize(Q - eye) * n_tau.w")
    assert wrong(drawn(shader, SIZE, lighting), truth["0"]) > 0.5
