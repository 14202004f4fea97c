"""Figure 5's scene by the shaders of examples/shader, in a small deferred renderer (tests/shaders/deferred.js).

    scripts/venv python -m tests.support.deferred -o docs/shaders.png

draws it without the method and with it, side by side.
"""

from __future__ import annotations

import argparse
import base64
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from PIL import Image

from scripts import glsl
from tests.conftest import TOP
from tests.support.shaders import Gpu, gpu

SHADERS, SCRIPT = TOP / "examples/shader", TOP / "tests/shaders/deferred.js"
MAP = 2048  # samples of the shadow map, across
SCENE = TOP / "scenes/cube.yaml"
#: Where lighting.frag looks the shadow map up.
LINE = "shadow_start(Q, normalize(Q - eye), n_tau.w, n, to_light)"


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


def given(size: tuple[int, int], lighting: str) -> dict[str, Any]:
    """Figure 5's scene for deferred.js."""
    scene = yaml.safe_load(SCENE.read_text(encoding="utf-8"))
    eye, at = np.array(scene["camera"]["from"]), np.array(scene["camera"]["at"])
    light, ground = np.array(scene["lights"]["lamp"]["at"]), scene["objects"]["ground"]
    cube, bump = scene["objects"]["cube"]["box"], scene["objects"]["ground"]["bump"]
    with Image.open(SCENE.parent / bump["map"]["file"]) as image:
        heights = (np.asarray(image, float) / (65535 if image.mode.startswith("I") else 255)).astype(np.float32)
    to_picture = clip_matrix(eye, at, scene["camera"]["fov"], size[0] / size[1], 1, 30)
    origin, u, w = (np.array(ground["plane"][name], float) for name in ("origin", "u", "w"))
    color = {name: scene["materials"][name]["color"] for name in ("clay", "blue")}
    plane = {"vertices": quad(origin - 12 * (u + w), 36 * u, 36 * w, np.array([0, 1, 0]), bump["size"][0]),
             "color": color["clay"], "scale": bump["scale"]}
    cubic = {"vertices": box(np.array(cube["from"]), np.array(cube["to"])), "color": color["blue"], "scale": 0}
    return {"width": size[0], "height": size[1], "map": MAP, "meshes": [plane, cubic], "eye": eye.tolist(),
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


def drawn(shader: Gpu, size: tuple[int, int], lighting: str) -> np.ndarray:
    script = SCRIPT.read_text(encoding="utf-8")
    out = shader.driver.execute_script(f"{script}\nreturn deferred(arguments[0]);", given(size, lighting))
    return np.frombuffer(base64.b64decode(out), np.uint8).reshape(size[1], size[0], 4)[::-1]


def srgb(linear: np.ndarray) -> np.ndarray:
    x = linear / 255
    display = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    return (255 * display + 0.5).astype(np.uint8)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.support.deferred", description="A picture for docs/.")
    parser.add_argument("-o", type=Path, required=True, help="the PNG to write")
    path = parser.parse_args().o
    lighting = included("lighting.frag")
    with gpu() as shader:
        sides = [drawn(shader, (960, 720), text) for text in (lighting.replace(LINE, "Q"), lighting)]
    small = [Image.fromarray(srgb(side[..., :3])).resize((480, 360), Image.Resampling.LANCZOS) for side in sides]
    Image.fromarray(np.concatenate([np.asarray(image) for image in small], axis=1)).save(path, optimize=True)


if __name__ == "__main__":
    main()
