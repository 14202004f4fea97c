"""The gallery: every scene shows what the method does, and its page shows every scene."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from reference.references import read_exr
from scripts import gallery, start_page
from tests.conftest import PROGRAM, TOP
from tests.support import browser

SCENES = sorted((TOP / "scenes" / "gallery").glob("*.yaml"))


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


FAKE = """#!/bin/sh
ns=20.0
for word; do case $word in none) own=1 ;; esac; done
test -n "$own" || ns=46.0
echo " render   1.00 ms  $ns ns a sample"
"""


@pytest.fixture
def fake(tmp_path: Path) -> Path:
    """A kage that renders nothing, and takes 2.3 times as long by a scene's own method."""
    program = tmp_path / "kage"
    program.write_text(FAKE)
    program.chmod(0o755)
    return program


def pictures(folder: Path, scenes: list[Path]) -> None:
    for scene in scenes:
        for name, grey in (("-none", 90), ("", 160)):
            Image.new("L", (160, 120), grey).save(folder / f"{scene.stem}{name}.png")


def test_page(fake: Path, tmp_path: Path) -> None:
    """Each scene with both pictures, its method, its cost and its file."""
    pictures(tmp_path, SCENES)
    assert gallery.main(["--kage", str(fake), "-o", str(tmp_path / "index.html"), *map(str, SCENES)]) == 0
    page = (tmp_path / "index.html").read_text()
    for scene in SCENES:
        assert page.count(f'src="{scene.stem}-none.png"') == page.count(f'src="{scene.stem}.png"') == 1
        assert f"kage render scenes/gallery/{scene.name} --aa 3\n\ncamera:" in page
    assert "march:4" in page and "<h2>golf</h2>" in page and "march:8, shade shifted, bump_shadow horizon" in page
    assert page.count("2.3 times the time by bump only (3 runs of 320 x 240 pixels, one thread)") == len(SCENES)
    assert "left:" not in re.sub(r"<style>.*?</style>", "", page.lower(), flags=re.DOTALL)  # nothing about sides


def test_slider(fake: Path, tmp_path: Path) -> None:
    """By keys, mouse and finger, in a page that fits a desk and a phone."""
    pictures(tmp_path, SCENES[:1])
    page = tmp_path / "index.html"
    assert gallery.main(["--kage", str(fake), "-o", str(page), str(SCENES[0])]) == 0
    with browser.browser() as driver:
        browser.resize(driver, browser.DESKTOP)
        browser.open_page(driver, page)
        driver.find_element("name", "split").send_keys("\ue011")  # Home
        assert browser.split_of(driver, ".pair") == 0
        browser.drag_mouse(driver, 0.8, 0.3)
        assert abs(browser.split_of(driver, ".pair") - 30) <= 1
        assert driver.find_element("name", "split").get_attribute("aria-valuetext") == "30 % bump only, 70 % march:4"
        browser.resize(driver, browser.PHONE, phone=True)
        browser.drag_finger(driver, 0.3, 0.7)
        assert abs(browser.split_of(driver, ".pair") - 70) <= 2
        assert browser.sideways(driver) <= 0 and not browser.errors(driver) and not browser.bad_images(driver)


def test_what_is_missing_is_told_and_no_page_made(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page, first = tmp_path / "index.html", SCENES[0].stem
    assert gallery.main(["-o", str(page), str(SCENES[0])]) == 1
    assert f"no {first}-none.png, {first}.png; have they been rendered?" in capsys.readouterr().err
    bare = tmp_path / "bare.yaml"
    bare.write_text("camera: {}\n")
    pictures(tmp_path, [bare])
    assert gallery.main(["-o", str(page), str(bare)]) == 1
    assert "expected a comment in its first line" in capsys.readouterr().err
    assert not page.exists()


def test_start_page_shows_only_what_is_there(tmp_path: Path) -> None:
    def shown() -> list[str]:
        assert start_page.main([str(tmp_path)]) == 0
        return re.findall(r'(?:href|src)="(?!data:)([^"]+)"', (tmp_path / "index.html").read_text())

    assert shown() == [] and "Nothing has been made yet" in (tmp_path / "index.html").read_text()
    for name in ("gallery/index.html", "bench/index.html", "figures.png"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    assert shown() == ["gallery/index.html", "bench/index.html", "figures.png", "figures.png"]
    (tmp_path / "gallery" / "wall.png").touch()
    assert shown()[:2] == ["gallery/index.html", "gallery/wall.png"]
