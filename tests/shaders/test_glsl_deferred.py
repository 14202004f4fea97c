"""examples/shader: a deferred renderer with a shadow map, and in it the method. Its shadows are kage's.

The shaders of the examples draw figure 5's scene in WebGL (deferred.js is the engine around them). What the light sees
is compared with kage's own layer `visibility`.
"""

from __future__ import annotations

import base64
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest
import yaml
from PIL import Image

from scripts import glsl
from tests.conftest import PROGRAM, TOP
from tests.support.shaders import Gpu, gpu

SHADERS = TOP / "examples/shader"
SIZE, MAP = (320, 240), 2048
SCENE = TOP / "scenes/cube.yaml"


def unit(a: np.ndarray) -> np.ndarray:
    return a / np.linalg.norm(a)


def clip_matrix(origin: np.ndarray, at: np.ndarray, fov: float, aspect: float, near: float, far: float) -> np.ndarray:
    """World to clip space. fov: across, in degrees."""
    back = unit(origin - at)
    right = unit(np.cross([0, 1, 0], back))
    look = np.eye(4)
    look[:3, :3] = [right, np.cross(back, right), back]
    look[:3, 3] = -look[:3, :3] @ origin
    f = 1 / np.tan(np.radians(fov) / 2)
    project = np.zeros((4, 4))
    project[0, 0], project[1, 1], project[3, 2] = f, f * aspect, -1
    project[2, 2:] = (far + near) / (near - far), 2 * far * near / (near - far)
    return np.diag([-1, 1, 1, 1]) @ project @ look  # kage's x goes to the right: it is left-handed


def rows(matrix: np.ndarray) -> list[float]:
    """As WebGL wants it, column by column."""
    return matrix.T.ravel().tolist()


def quad(origin: np.ndarray, u: np.ndarray, w: np.ndarray, n: np.ndarray, size: float) -> list[float]:
    """Two triangles. The height map has its corner at the origin, and the given size."""
    corners = [(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)]
    lengths = np.array([np.linalg.norm(u), np.linalg.norm(w)]) / size
    return [float(x) for corner in corners for x in (*(origin + corner @ np.array([u, w])), *n, *(lengths * corner))]


def box(low: np.ndarray, high: np.ndarray) -> list[float]:
    found = []
    for axis in range(3):
        u, w = np.roll(np.eye(3), 1, axis=0)[axis] * (high - low), np.roll(np.eye(3), 2, axis=0)[axis] * (high - low)
        for side, origin in ((-1, low), (1, high)):
            found += quad(origin, -u * side, -w * side, side * np.eye(3)[axis], 1)
    return found


def given(lighting: str) -> dict[str, Any]:
    """Figure 5's scene for deferred.js."""
    scene = yaml.safe_load(SCENE.read_text(encoding="utf-8"))
    eye, at = np.array(scene["camera"]["from"]), np.array(scene["camera"]["at"])
    light, ground = np.array(scene["lights"]["lamp"]["at"]), scene["objects"]["ground"]
    cube, bump = scene["objects"]["cube"]["box"], scene["objects"]["ground"]["bump"]
    with Image.open(SCENE.parent / bump["map"]["file"]) as image:
        heights = (np.asarray(image, float) / (65535 if image.mode.startswith("I") else 255)).astype(np.float32)
    to_picture = clip_matrix(eye, at, scene["camera"]["fov"], SIZE[0] / SIZE[1], 1, 30)
    origin, u, w = (np.array(ground["plane"][name], float) for name in ("origin", "u", "w"))
    color = {name: scene["materials"][name]["color"] for name in ("clay", "blue")}
    plane = {"vertices": quad(origin - 12 * (u + w), 36 * u, 36 * w, np.array([0, 1, 0]), bump["size"][0]),
             "color": color["clay"], "scale": bump["scale"]}
    cubic = {"vertices": box(np.array(cube["from"]), np.array(cube["to"])), "color": color["blue"], "scale": 0}
    return {"width": SIZE[0], "height": SIZE[1], "map": MAP, "meshes": [plane, cubic], "eye": eye.tolist(),
            "light": light.tolist(), "light_color": [0.8 * x for x in scene["lights"]["lamp"]["color"]],
            "ambient": [0.12] * 3, "heights": base64.b64encode(heights.tobytes()).decode(),
            "map_size": heights.shape[::-1], "zero": bump["zero"], "world_to_picture": rows(to_picture),
            "picture_to_world": rows(np.linalg.inv(to_picture)),
            "world_to_map": rows(clip_matrix(light, np.array([0.5, 0, 0.3]), 50, 1, 2, 20)),
            "gbuffer": included("gbuffer.frag"), "lighting": lighting}


def included(name: str) -> str:
    """The shader with what it includes."""
    text = (SHADERS / name).read_text(encoding="utf-8")
    for file in (glsl.TARGET, SHADERS / "start.glsl"):
        text = text.replace(f'#include "{file.name}"', file.read_text(encoding="utf-8"))
    return text


@pytest.fixture(scope="module")
def shader() -> Iterator[Gpu]:
    with gpu() as found:
        yield found


def drawn(shader: Gpu, lighting: str) -> np.ndarray:
    script = (TOP / "tests/shaders/deferred.js").read_text(encoding="utf-8")
    out = shader.driver.execute_script(f"{script}\nreturn deferred(arguments[0]);", given(lighting))
    return np.frombuffer(base64.b64decode(out), np.uint8).reshape(SIZE[1], SIZE[0], 4)[::-1]


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


LINE = "shadow_start(Q, normalize(Q - eye), n_tau.w, n, to_light)"


def test_shadows_are_kages(shader: Gpu, truth: dict[str, np.ndarray]) -> None:
    """Those of order 0, and without the method's line those of bump mapping alone. What is left are edges, which a map
    of 2048 x 2048 samples does not know better."""
    lighting = included("lighting.frag")
    assert lighting.count(LINE) == 1
    bumpy, plain = drawn(shader, lighting), drawn(shader, lighting.replace(LINE, "Q"))
    assert wrong(bumpy, truth["0"]) < 0.005 and wrong(plain, truth["none"]) < 0.005
    assert wrong(bumpy, truth["none"]) > 0.05 and wrong(plain, truth["0"]) > 0.05
    shown = bumpy[..., :3].astype(float)
    ground = (shown[..., 0] > shown[..., 2])[truth["0"]]  # clay in light, with bumps
    assert shown[truth["0"]][ground].std() > 15


def test_start_below_the_surface(shader: Gpu, truth: dict[str, np.ndarray]) -> None:
    """Where P < 0 the ray starts below the receiver's own surface: without start.glsl that shadows what it must not."""
    lighting = included("lighting.frag").replace(LINE, "Q + normalize(Q - eye) * n_tau.w")
    assert wrong(drawn(shader, lighting), truth["0"]) > 0.5
