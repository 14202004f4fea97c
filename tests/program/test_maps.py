"""Large height maps: memory, and the same pictures from PNG and OpenEXR."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from PIL import Image

from bench.programs import peak_memory
from tests.conftest import PROGRAM as KAGE

SIDE = 4096
SCENE = """
camera: {{from: [0, 3, -4], at: [0, 0, 0], fov: 40}}
image: {{size: [64, 48]}}
lights: {{lamp: {{at: [4, 5, -2]}}}}
materials: {{clay: {{color: [0.8, 0.7, 0.6]}}}}
objects:
  ground:
    plane: {{origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}}
    material: clay
    bump: {{map: {{file: {0}}}, size: [4, 4], scale: 0.2, zero: 0.5, sign: up}}
  ball: {{sphere: {{center: [0, 0.8, 0], radius: 0.5}}, material: clay}}
"""


def peak(*arguments: str | Path) -> int:
    """The most memory that a render takes, in bytes."""
    return peak_memory([KAGE, "render", *arguments, "--threads", "2", "--overwrite"])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Waves of 4096 x 4096 samples of 16 bits as PNG, the same as OpenEXR, and a small map."""
    where = tmp_path_factory.mktemp("maps")
    wave = np.sin(np.arange(SIDE) * (8 * np.pi / SIDE))
    grey = np.rint(32768 + 30000 * np.outer(wave, wave)).astype(np.uint16)
    Image.fromarray(grey).save(where / "large.png", compress_level=1)
    Image.fromarray(grey[::64, ::64].copy()).save(where / "small.png")
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {"Y": grey.astype(np.float32) / np.float32(65535)}) as file:
        file.write(str(where / "large.exr"))
    for name in ("large.png", "small.png", "large.exr"):
        (where / f"{name}.yaml").write_text(SCENE.format(name))
    return where


@pytest.mark.parametrize("method", ["0", "march:4"])
@pytest.mark.parametrize("name", ["large.png", "large.exr"])
def test_six_bytes_a_sample(folder: Path, name: str, method: str) -> None:
    """A sample is 4 bytes, and no second copy is held while the file is read. Peaks of the same command were up to
    600 kB apart: 0.04 bytes a sample."""
    options = "--shadow", method, "-o", folder / "out.png"
    more = peak(folder / f"{name}.yaml", *options) - peak(folder / "small.png.yaml", *options)
    assert 3.9 * SIDE**2 <= more <= 6 * SIDE**2, f"{more / SIDE**2:.2f} bytes a sample"


def test_formats_give_the_same_picture(folder: Path) -> None:
    for name in ("large.png", "large.exr"):
        peak(folder / f"{name}.yaml", "--shadow", "1", "-o", folder / f"from-{name}.png")
    first, second = (np.asarray(Image.open(folder / f"from-large.{kind}.png")) for kind in ("png", "exr"))
    assert np.array_equal(first, second)
    assert first.std() > 10


def test_a_large_png_on_any_threads(folder: Path) -> None:
    """One thread, or two that share the decoding: the same bytes; a file that is cut is refused by both."""
    pictures: list[bytes] = []
    whole = (folder / "large.png").read_bytes()
    (folder / "half.png").write_bytes(whole[: len(whole) // 2])
    (folder / "half.yaml").write_text(SCENE.format("half.png"))
    for threads in "1", "2":
        out = folder / f"by-{threads}.png"
        subprocess.run([KAGE, "render", folder / "large.png.yaml", "--threads", threads, "-o", out], check=True)
        pictures.append(out.read_bytes())
        command = [str(KAGE), "render", str(folder / "half.yaml"), "--threads", threads, "-o", str(out)]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 2
        assert "'half.png' can't be used: libpng: the file ends too early" in done.stderr
    assert pictures[0] == pictures[1]
