"""The programs of examples/, built as their first lines say against the installed library, and what they render."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.conftest import PROGRAM, TOP
from tests.support.installed import Installed, install

EXAMPLES = TOP / "examples"


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Installed:
    return install(tmp_path_factory.mktemp("prefix"))


def picture(path: Path) -> np.ndarray:
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB")).astype(int)


def render(scene: Path, method: str, to: Path) -> np.ndarray:
    subprocess.run([PROGRAM, "render", scene, "--shadow", method, "--quiet", "-o", to], check=True)
    return picture(to)


def differs(a: np.ndarray, b: np.ndarray) -> float:
    """The share of pixels that are not the same but for roundings."""
    return float((np.abs(a - b).max(axis=2) > 2).mean())


def test_render(installed: Installed, tmp_path: Path) -> None:
    program = installed.build(EXAMPLES / "render.c", tmp_path / "render")
    scene = EXAMPLES / "embree.yaml"
    subprocess.run([program, scene, tmp_path / "a.png", "2+"], check=True, capture_output=True)
    assert np.array_equal(picture(tmp_path / "a.png"), render(scene, "2+", tmp_path / "b.png"))
    wrong = subprocess.run([program, scene, tmp_path / "a.png", "best"], capture_output=True, text=True)
    assert wrong.returncode == 1 and "'best' is no method" in wrong.stderr


def test_change(installed: Installed, tmp_path: Path) -> None:
    """Its last picture is that of the text that it writes, with a function in place of the array."""
    program = installed.build(EXAMPLES / "change.c", tmp_path / "change", "-lm")
    subprocess.run([program, tmp_path], check=True)
    scene = tmp_path / "last.yaml"
    assert "lamp: {at: [-2.525, 3, -3.102], color: [1, 1, 1]} # moves" in scene.read_text()
    text = scene.read_text()
    begin = text.index("map: ")
    scene.write_text(text[:begin] + "function: 0.2*cos(9.6*sqrt((u - 4)^2 + (w - 4)^2))}\n")
    last, before = picture(tmp_path / "7.png"), picture(tmp_path / "6.png")
    same = np.abs(last - render(scene, "0", tmp_path / "b.png")).mean()  # apart from what repeats far away
    assert same < 0.3 * np.abs(last - before).mean()


def embree() -> str:
    return "-lembree4" if Path("/usr/include/embree4").exists() else "-lembree3"


def test_embree(installed: Installed, tmp_path: Path) -> None:
    """Somebody else's renderer with bumpshadow.h has kage's pictures by none and by order 0, which are not the same."""
    program = installed.build(EXAMPLES / "embree.c", tmp_path / "embree", embree())
    theirs = {}
    for method in ("none", "0"):
        to = tmp_path / f"{method}.ppm"
        to.write_bytes(subprocess.run([program, method], check=True, capture_output=True).stdout)
        theirs[method] = picture(to)
        assert differs(theirs[method], render(EXAMPLES / "embree.yaml", method, tmp_path / f"{method}.png")) < 0.001
    assert differs(theirs["none"], theirs["0"]) > 0.01


@pytest.mark.parametrize(("name", "most"), [("render.c", 59), ("change.c", 61), ("embree.c", 149)])
def test_examples_are_short(name: str, most: int) -> None:
    assert len((EXAMPLES / name).read_text().splitlines()) <= most


def test_the_docs_show_the_examples() -> None:
    text = (TOP / "docs" / "library.md").read_text()
    for name in ("render.c", "change.c", "embree.c"):
        assert f"<!-- examples/{name} -->\n```c\n{(EXAMPLES / name).read_text()}```\n<!-- end -->" in text
