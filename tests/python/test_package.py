"""The package kage: a scene to a picture and its planes, the same as the program's; errors; what a scene tells."""

from __future__ import annotations

import gc
import inspect
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import kage
from kage.structs import BumpWarning
from tests.conftest import SCENE, TOP, Kage

CUBE = TOP / "scenes" / "cube.yaml"
SMALL = (64, 48)


def pixels(path: Path) -> np.ndarray:
    with Image.open(path) as image:
        return np.asarray(image)


@pytest.mark.parametrize(("options", "words"), [
    ({"shadow": "auto", "shade": "shifted"}, ["--shadow", "auto", "--shade", "shifted"]),
    ({"relief": True}, ["--relief"]),
    ({"shadow": 1, "guard": False, "aa": 2}, ["--shadow", "1", "--no-guard", "--aa", "2"]),
    ({"surface": "displaced", "self_shadow": False}, ["--surface", "displaced", "--no-self-shadow"]),
])
def test_the_picture_is_the_programs(program: Kage, tmp_path: Path, options: dict, words: list[str]) -> None:
    picture = kage.load(CUBE).render(size=SMALL, **options)
    picture.save(tmp_path / "ours.png")
    program.good("render", CUBE, *words, "--size", "64x48", "-o", "its.png", "-o", "its.exr")
    assert np.array_equal(pixels(tmp_path / "ours.png"), pixels(tmp_path / "its.png"))
    assert np.array_equal(picture.srgb, pixels(tmp_path / "its.png"))
    picture.save(tmp_path / "ours.exr", layers="color,tau", threads=1)
    assert (tmp_path / "ours.exr").stat().st_size < (tmp_path / "its.exr").stat().st_size


def test_planes() -> None:
    picture = kage.load(CUBE).render(size=SMALL)
    assert picture.rgb.shape == (48, 64, 3) and picture["N"].shape == (48, 64, 3) and picture["uw"].shape == (48, 64, 2)
    assert np.array_equal(picture.rgb[..., 1], picture["G"]) and np.array_equal(picture["N"][..., 2], picture["N.Z"])
    assert picture["visibility"].shape == (48, 64, 1)
    assert {"tau", "order", "visibility.lamp"} < set(picture) and "tau" in picture
    assert picture["tau"].dtype == np.float32 and not picture["tau"].flags.writeable
    with pytest.raises(ValueError, match="read-only"):
        picture["tau"][0, 0] = 1
    with pytest.raises(KeyError, match="no plane 'taux'; there are R G B Z"):
        picture["taux"]


@pytest.mark.parametrize("size", [(17, 3), (64, 48), (700, 500)])
def test_planes_are_no_copies_and_outlive_the_picture(size: tuple[int, int]) -> None:
    picture = kage.load(CUBE).render(size=size, layers=False)
    assert picture.planes == ("R", "G", "B")
    rgb, red = picture.rgb, picture["R"]
    assert np.shares_memory(rgb, red) and np.shares_memory(rgb, picture["B"])
    before = rgb.copy()
    del picture, red
    gc.collect()
    kage.load(CUBE).render(size=size, shadow="none", layers=False)  # would take the memory
    assert np.array_equal(rgb, before)


def test_a_crop_is_a_part_of_the_whole() -> None:
    scene = kage.load(CUBE)
    part = scene.render(size=SMALL, crop=(10, 5, 40, 20))
    assert (part.crop, part.width, part.height) == ((10, 5, 40, 20), 30, 15)
    assert np.array_equal(part.rgb, scene.render(size=SMALL).rgb[5:20, 10:40])


def test_a_file_in_bands_has_the_same_bytes(tmp_path: Path) -> None:
    scene = kage.load(CUBE)
    scene.render(size=SMALL).save(tmp_path / "whole.exr")
    stats = scene.render_file(tmp_path / "bands.exr", size=SMALL, band=16)
    assert stats.camera_rays == 64 * 48 and len(list(tmp_path.iterdir())) == 2
    assert (tmp_path / "bands.exr").read_bytes() == (tmp_path / "whole.exr").read_bytes()
    scene.render_file(tmp_path / "color.exr", size=SMALL, layers=False)
    scene.render(size=SMALL, layers=False).save(tmp_path / "rgb.exr")
    assert (tmp_path / "color.exr").read_bytes() == (tmp_path / "rgb.exr").read_bytes()


def test_for_notebooks_and_people(tmp_path: Path) -> None:
    scene = kage.load(CUBE)
    picture = scene.render(size=SMALL)
    (tmp_path / "shown.png").write_bytes(picture._repr_png_())
    assert np.array_equal(pixels(tmp_path / "shown.png"), picture.srgb)
    assert repr(scene) == "<kage.Scene cube.yaml: 640 x 480 pixels, 1 lights, 2 objects, shadow 0>"
    assert repr(picture).startswith("<kage.Picture cube.yaml: 64 x 48 pixels, planes R G B Z")
    assert picture.metadata["kage:scene"] == CUBE.read_text()
    assert "shadow: 'str | int | None' = None" in str(inspect.signature(scene.render))


def test_info_probe_survey_stats() -> None:
    scene = kage.load(CUBE)
    info = scene.info
    assert (info.width, info.method, info.guard, [light.name for light in info.lights]) == (640, "0", True, ["lamp"])
    ground = info.objects[0]
    assert (ground.name, ground.bump, ground.map_size, ground.model) == ("ground", "map", (512, 512), None)
    probe = scene.probe(300, 400)
    assert probe.bumped and probe.object == 0
    assert np.allclose(probe.Q, probe.r + probe.t * probe.s, atol=1e-5)
    by_method = {(row.method, row.guard): row for row in probe.rows}
    assert by_method["0", True].tau != 0 == by_method["none", True].tau
    assert by_method["0", True].visible in ((0.0,), (1.0,))
    assert not scene.survey().warnings
    survey = scene.changed("objects.ground.bump.scale", 0.5).survey()
    assert [bump.samples > 0 for bump in survey.objects] == [True, False]
    assert [(warning.code, warning.object) for warning in survey.warnings] == [("steep", 0)]
    assert isinstance(survey.warnings[0], BumpWarning)
    stats = scene.render(size=SMALL, timing=True).stats
    assert stats.camera_rays == 64 * 48 and {order.order: order.samples for order in stats.orders}["0"] == stats.bumped
    assert sum(stage.seconds for stage in stats.stages) > 0


def test_povray(tmp_path: Path) -> None:
    report = kage.load(CUBE).povray(tmp_path / "ours.pov", cast=False)
    assert report.coarse is None and "no_shadow" in (tmp_path / "ours.pov").read_text()


def test_all_errors_of_a_scene_at_once(tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(SCENE.replace("fov: 40", "fov: 400").replace("radius: 0.5", "radius: -1"))
    with pytest.raises(kage.InputError) as caught:
        kage.load(path)
    error = caught.value
    assert (error.file, error.line, error.column) == (str(path), 1, 63)
    assert error.text == "400 is more than 175, expected the horizontal angle in degrees, above 0 and up to 175"
    assert [entry.line for entry in error.errors] == [1, 17, 22]  # the map is missing, too
    assert str(error).count("^") == 3 and isinstance(error, ValueError)
    again = pickle.loads(pickle.dumps(error))  # noqa: S301 - as Dask sends it, our own
    assert (type(again), again.line, again.errors) == (kage.InputError, 1, error.errors)


def test_errors_of_options_changes_and_files(tmp_path: Path) -> None:
    scene = kage.load(CUBE)
    with pytest.raises(kage.OptionError, match="'3' is no method, expected none, 0, 1"):
        scene.render(shadow=3)
    with pytest.raises(kage.OptionError, match="aa is 0, expected a whole number from 1 to 16"):
        scene.render(aa=0)
    with pytest.raises(kage.OptionError, match="size is 64, expected 2 whole numbers"):
        scene.render(size=64)  # type: ignore[typeddict-item]
    with pytest.raises(kage.OptionError, match="shade is 'flat', expected 'smooth' or 'shifted'"):
        scene.render(shade="flat")  # type: ignore[typeddict-item]
    with pytest.raises(TypeError, match=r"render\(\) has no option 'shadows'; it has aa, aa_threshold"):
        scene.render(shadows=1)  # type: ignore[call-arg]
    with pytest.raises(kage.InputError) as caught:
        kage.load(CUBE, sets={"objects.ground.bump.scale": -1})
    assert caught.value.file == "--set"
    picture = scene.render(size=SMALL)
    with pytest.raises(kage.OutputError, match=r"no-folder/x\.png") as missing:
        picture.save(tmp_path / "no-folder" / "x.png")
    assert isinstance(missing.value, OSError)
    with pytest.raises(kage.OptionError, match="png"):
        picture.save(tmp_path / "x.jpg")
    with pytest.raises(ValueError, match="embedded null byte"):
        picture.save(f"{tmp_path}/x.png\0.exr")
    assert not list(tmp_path.iterdir())


def test_texts_and_dicts(tmp_path: Path) -> None:
    scene = {
        "camera": {"from": np.array([0, 3, -5]), "at": (0, 0, 0)},
        "lights": {"lamp": {"at": [-4, 5, -2]}},
        "materials": {"clay": {"diffuse": np.float32(0.75)}},
        "objects": {"ground": {"plane": {"origin": [0, 0, 0], "u": [0, 0, 1], "w": [1, 0, 0]}, "material": "clay",
                               "bump": {"function": "0.1*sin(u)"}}},
    }
    text = """
camera: {from: [0, 3, -5], at: [0, 0, 0]}
lights: {lamp: {at: [-4, 5, -2]}}
materials: {clay: {diffuse: 0.75}}
objects:
  ground:
    plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}
    material: clay
    bump: {function: 0.1*sin(u)}
"""
    ours, its = (kage.load(source).render(size=SMALL) for source in (scene, text))
    assert ours.rgb.max() > 0 and np.array_equal(ours.rgb, its.rgb)
    (tmp_path / "scene.yaml").write_text(text)
    assert kage.load(str(tmp_path / "scene.yaml")).name == "scene.yaml"
    with pytest.raises(kage.InputError, match=r"^scene:4:\d+: ") as caught:
        kage.load(text.replace("0.75", "-1"))
    assert caught.value.file == "scene"


def test_models_are_read_by_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("KAGE_IMPORT", raising=False)
    assert kage.load(TOP / "scenes" / "gallery" / "wall.yaml").info.objects[1].model is not None


def test_the_dataclasses_are_those_of_the_header() -> None:
    made = subprocess.run([sys.executable, TOP / "python" / "structs.py", "--check"])
    assert made.returncode == 0, "make python writes python/kage/structs.py anew"
