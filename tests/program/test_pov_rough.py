"""Maps too rough for a mesh that is fine everywhere: the export ends, stays below its limit, and is fine where it is
seen or says that it is not.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.conftest import Kage, needs_povray
from tests.support.parity import GLOBE, HEAD, LIGHTS, PLANE, ROUND_ONES, difference, layers, povray, rgb

MOST = 4_000_000
ABOVE = "{from: [0.3, 3.9, -1.8], at: [0, 0, 0.1], fov: 40}"
FAR = "{from: [0.3, 2.9, -5.2], at: [0, 0.5, 0], fov: 40}"


def noise(size: int) -> np.ndarray:
    return np.random.default_rng(1).random((size, size))


def gravel(size: int = 256) -> np.ndarray:
    """Of stones of all sizes, down to some samples."""
    f = np.hypot(np.fft.fftfreq(size)[:, None], np.fft.fftfreq(size)[None])
    f[0, 0] = 1
    spectrum = np.fft.fft2(np.random.default_rng(5).standard_normal((size, size))) * (f < 0.35) / f**1.2
    heights = np.fft.ifft2(spectrum).real
    return (heights - heights.min()) / np.ptp(heights)


def write(kage: Kage, heights: np.ndarray, shape: str, camera: str = FAR, scale: float = 0.1, more: str = "") -> Path:
    Image.fromarray((65535 * heights).astype(np.uint16)).save(kage.folder / "rough.png")
    scene = kage.folder / "rough.yaml"
    scene.write_text(HEAD.format(camera=camera, lights=LIGHTS) + f"  rough:\n    {shape}\n    material: clay\n"
                     f"    bump: {{map: {{file: rough.png}}, scale: {scale:.4f}, zero: 0.5, sign: up{more}}}\n")
    return scene


def export(kage: Kage, scene: Path, *options: object) -> tuple[str, int, str]:
    """What the file says of its mesh, its triangles, and stderr."""
    done = kage("pov", scene, "-o", "rough.pov", "--surface", "displaced", *options,
                timeout=600)  # under a sanitizer on a busy machine
    assert done.returncode == 0, done.stderr
    with (kage.folder / "rough.pov").open() as file:
        text = "".join(line for line in file if line[0] not in ",<")
    return text, sum(map(int, re.findall(r"face_indices { (\d+)", text))), done.stderr


def figures(text: str) -> list[float]:
    found = re.search(r"^// its heights are off by up to (\S+), which is (\S+) pixels$", text, re.MULTILINE)
    assert found, text
    return [float(figure) for figure in found.groups()]


@pytest.mark.parametrize("shape", [GLOBE, ROUND_ONES["torus"]], ids=["sphere", "torus"])
def test_noise_on_a_curved_surface(kage: Kage, shape: str) -> None:
    """It never ended: a tolerance grew that had no effect any more."""
    text, triangles, words = export(kage, write(kage, noise(256), shape))
    assert 1e5 < triangles <= MOST and not words and "COARSE" not in text
    height, pixels = figures(text)
    assert 0 < height < 0.01 and 0 < pixels < 0.5


def test_more_samples_than_triangles(kage: Kage) -> None:
    text, triangles, words = export(kage, write(kage, noise(2048), GLOBE))
    height, pixels = figures(text)
    assert 1e5 < triangles <= MOST and 0.02 < height < 0.11 and pixels > 1
    assert "COARSE: finer ones are above 4000000 triangles" in text
    assert "// 2 x 2 samples of its map are one cell" in text
    assert words == (f"kage: object rough: coarse mesh: heights are off by up to {height:g}, {pixels:g} pixels; "
                     "a finer one has too many triangles\n")


def write_gravel(kage: Kage) -> Path:
    heights = gravel()
    slopes = np.hypot(*((np.roll(heights, -1, k) - np.roll(heights, 1, k)) * 128 / 1.3 for k in (0, 1)))
    return write(kage, heights, PLANE, ABOVE, 1 / np.quantile(slopes, 0.95), ", size: [1.3, 1.3]")


@pytest.mark.slow
@needs_povray
def test_gravel_on_a_plane(kage: Kage) -> None:
    """95 % of slopes below 1. Cells were joined, and nothing but the width of facets was said."""
    scene, size = write_gravel(kage), (80, 60)
    text, triangles, words = export(kage, scene, "--size", "80x60")
    assert triangles <= MOST and not words and "COARSE" not in text
    assert figures(text)[1] < 0.5
    kage.good("render", scene, "-o", "rough.exr", "--surface", "displaced", "--size", "80x60", "--quiet")
    theirs, warnings = povray(kage.folder / "rough.pov", size)
    _, bad = difference(rgb(layers(kage.folder / "rough.exr")), theirs)
    assert not warnings.strip() and bad.mean() < 0.01, bad.mean()


@pytest.mark.parametrize("option", ["render.aa=3", "materials.clay.reflection=0.2"])
def test_rays_that_come_anywhere(kage: Kage, option: str) -> None:
    """A mesh that is fine for one ray a pixel does not serve them: it is coarse, and says so."""
    scene = write_gravel(kage)
    text, triangles, words = export(kage, scene, "--size", "80x60", "--set", option)
    assert triangles <= MOST and "COARSE" in text and "where the rays" not in text
    height, pixels = figures(text)
    assert f"object rough: coarse mesh: heights are off by up to {height:g}, {pixels:g} pixels" in words
