"""The gallery: every scene shows what the method does, and its page shows every scene."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from reference.references import read_exr
from tests.conftest import PROGRAM, TOP

SCENES = sorted((TOP / "scenes" / "gallery").glob("*.yaml"))
SCRIPT = TOP / "scripts" / "gallery.py"


def visibility(scene: Path, out: Path, *options: str) -> np.ndarray:
    command = [PROGRAM, "render", scene, *options, "--size", "320x240", "--layers", "visibility", "--quiet", "-o", out]
    subprocess.run(command, check=True, capture_output=True, timeout=120)
    return np.stack(list(read_exr(out).values()))


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.stem)
def test_the_effect_is_visible(scene: Path, tmp_path: Path) -> None:
    """The method moves the shadows' edges on a share of the picture that an eye does not miss."""
    none, best = visibility(scene, tmp_path / "a.exr", "--shadow", "none"), visibility(scene, tmp_path / "b.exr")
    moved = (np.abs(none - best) > 0.2).any(axis=0).mean()
    assert moved > 0.005, f"{100 * moved:.2f} % of the pixels"


def run(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, SCRIPT, *map(str, arguments)], capture_output=True, text=True, timeout=60)


def test_page(tmp_path: Path) -> None:
    for scene in SCENES:
        (tmp_path / f"{scene.stem}-none.png").touch()
        (tmp_path / f"{scene.stem}.png").touch()
    done = run("-o", tmp_path / "index.html", *SCENES)
    assert (done.returncode, done.stderr) == (0, "")
    page = (tmp_path / "index.html").read_text()
    for scene in SCENES:
        assert page.count(f'src="{scene.stem}-none.png"') == page.count(f'src="{scene.stem}.png"') == 1
    assert "&#34;" not in page and "march:4" in page and "<h2>golf</h2>" in page


def test_what_is_missing_is_told_and_no_page_made(tmp_path: Path) -> None:
    done = run("-o", tmp_path / "index.html", SCENES[0])
    first = SCENES[0].stem
    assert done.returncode == 1 and f"no {first}-none.png, {first}.png; have they been rendered?" in done.stderr
    (tmp_path / "bare.yaml").write_text("camera: {}\n")
    done = run("-o", tmp_path / "index.html", tmp_path / "bare.yaml")
    assert done.returncode == 1 and "expected a comment in its first line" in done.stderr
    assert not (tmp_path / "index.html").exists()
