"""Scenes with arrays in place of files, and scenes that change."""

from __future__ import annotations

import gc
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import kage
from tests.conftest import TOP

CUBE = TOP / "scenes" / "cube.yaml"
SMALL = (64, 48)
PLANE = {"plane": {"origin": [0, 0, 0], "u": [0, 0, 1], "w": [1, 0, 0]}}
HEIGHTS = np.random.default_rng(5).random((16, 24))


def scene(**ground: Any) -> dict[str, Any]:
    return {
        "camera": {"from": [0, 3, -5], "at": [0, 0, 0]},
        "lights": {"lamp": {"at": [-4, 5, -2]}},
        "materials": {"clay": {"diffuse": 0.75}},
        "objects": {"ground": {**PLANE, "material": "clay", **ground}},
    }


def bump(array: Any) -> dict[str, Any]:
    return {"map": array, "scale": 0.3, "zero": 0.5, "sign": "up", "size": [3, 2]}


def test_a_height_map_is_what_its_file_is(tmp_path: Path) -> None:
    bytes_ = np.round(HEIGHTS * 255).astype(np.uint8)
    Image.fromarray(bytes_).save(tmp_path / "map.png")
    of_file = kage.load(scene(bump=bump({"file": "map.png"})), folder=tmp_path).render(size=SMALL)
    of_array = kage.load(scene(bump=bump(bytes_))).render(size=SMALL)
    of_floats = kage.load(scene(bump=bump(bytes_ / 255))).render(size=SMALL)
    of_name = kage.load(scene(bump=bump({"file": "array:heights"})), arrays={"heights": bytes_}).render(size=SMALL)
    assert np.ptp(of_file["height"]) > 0.1
    assert np.array_equal(of_array["height"], of_file["height"]) and np.array_equal(of_array.rgb, of_file.rgb)
    assert np.array_equal(of_name.rgb, of_file.rgb) and np.allclose(of_floats["height"], of_file["height"], atol=1e-6)


@pytest.mark.parametrize("turned", [
    lambda a: a, np.asfortranarray, lambda a: np.repeat(a, 2, axis=1)[:, ::2], lambda a: a.astype(">f8")])
def test_any_order_in_memory(turned: Any) -> None:
    one, other = (kage.load(scene(bump=bump(array))).render(size=SMALL) for array in (HEIGHTS, turned(HEIGHTS.copy())))
    assert np.array_equal(one.rgb, other.rgb) and one.metadata == other.metadata


def test_an_image_on_a_material() -> None:
    image = np.zeros((2, 2, 3), np.uint8)
    image[0, 0] = (255, 0, 0)
    made = scene()
    made["materials"]["clay"]["color"] = {"image": {"file": image, "size": [1, 1], "interpolation": "nearest"}}
    rgb = kage.load(made).render(size=SMALL).rgb
    assert rgb[..., 0].max() > 0.3 and rgb[..., 1].max() == 0


def test_a_mesh(tmp_path: Path) -> None:
    vertices = np.array([[-1, 0, 0], [1, 0, 0], [0, 2, 0]], float)
    lines = [f"v {x} {y} {z}" for x, y, z in vertices] + ["f 1 2 3", "f 3 2 1"]
    (tmp_path / "model.obj").write_text("\n".join(lines))
    triangles = [[0, 1, 2], [2, 1, 0]]
    made = scene()
    of_file, of_array = (
        kage.load({**made, "objects": {**made["objects"], "sail": {"mesh": mesh, "material": "clay"}}}, folder=tmp_path)
        for mesh in ({"file": "model.obj", "normals": "flat"},
                     {"vertices": vertices, "triangles": triangles, "normals": "flat"})
    )
    assert of_array.info.objects[1].model is not None and of_array.info.objects[1].model.triangles == 2
    assert np.array_equal(of_array.render(size=SMALL).rgb, of_file.render(size=SMALL).rgb)


@pytest.mark.parametrize(("ground", "words"), [
    ({"bump": bump(HEIGHTS.astype(np.int64))}, r"objects\.ground\.bump\.map: an array of int64, expected uint8"),
    ({"bump": bump(HEIGHTS[0])}, r"map: an array of shape \(24,\), expected height x width"),
    ({"mesh": {"vertices": HEIGHTS, "triangles": [[0, 1, 2]]}}, r"vertices: an array of float64 and shape \(16, 24"),
    ({"mesh": {"vertices": np.eye(3), "triangles": [[0, 1, 3]]}}, r"mesh\.triangles: vertices 0 to 3, but there are 3"),
    ({"mesh": {"vertices": np.eye(3), "triangles": [[0, 1, 2]], "uvs": np.eye(2)}}, r"\.uvs: 2 of them, expected one"),
    ({"hidden": float("nan")}, "in a scene: Out of range float"),
    ({"hidden": object()}, "in a scene: object .* expected numbers, texts"),
])
def test_wrong_arrays_and_values(ground: dict[str, Any], words: str) -> None:
    with pytest.raises(kage.OptionError, match=words):
        kage.load(scene(**ground))


def test_an_array_that_is_not_there() -> None:
    with pytest.raises(kage.InputError, match="heights"):
        kage.load(scene(bump=bump({"file": "array:heights"})))


def test_a_scene_changes_as_one_that_was_read_with_the_changes() -> None:
    ours = kage.load(CUBE)
    before = ours.render(size=SMALL)
    ours.set("objects.ground.bump.scale", 0.1)
    ours.set({"render.shadow": 1, "lights.lamp.at": np.array([1.0, 5, -3])})
    its = kage.load(CUBE, sets={"objects.ground.bump.scale": 0.1, "render.shadow": 1, "lights.lamp.at": "[1, 5, -3]"})
    assert ours.info.method == "1"
    assert np.array_equal(ours.render(size=SMALL).rgb, its.render(size=SMALL).rgb)
    other = ours.changed("objects.ground.bump.scale", 0.5)
    assert not np.array_equal(other.render(size=SMALL).rgb, ours.render(size=SMALL).rgb)
    assert np.array_equal(kage.load(CUBE).render(size=SMALL).rgb, before.rgb)


def test_a_wrong_change_changes_nothing() -> None:
    ours = kage.load(CUBE)
    with pytest.raises(kage.InputError) as caught:
        ours.set("objects.ground.bump.scale", -1)
    assert (caught.value.file, caught.value.errors[0].line) == ("--set", 1)
    with pytest.raises(kage.InputError):
        ours.set("objects.grund.bump.scale", 1)
    assert np.array_equal(ours.render(size=SMALL).rgb, kage.load(CUBE).render(size=SMALL).rgb)


def test_arrays_by_a_change() -> None:
    ours = kage.load(scene(bump=bump(HEIGHTS)))
    low = ours.render(size=SMALL)
    ours.set("objects.ground.bump.map", 1 - HEIGHTS)
    assert np.array_equal(ours.render(size=SMALL).rgb, kage.load(scene(bump=bump(1 - HEIGHTS))).render(size=SMALL).rgb)
    assert not np.array_equal(low.rgb, ours.render(size=SMALL).rgb)


def test_a_scene_changes_while_others_render_it() -> None:
    ours = kage.load(CUBE)
    wanted = {scale: ours.changed("objects.ground.bump.scale", scale).render(size=SMALL).rgb for scale in (0.05, 0.3)}
    stop, wrong = threading.Event(), []

    def render() -> None:
        while not stop.is_set():
            rgb = ours.render(size=SMALL, threads=1).rgb
            if not any(np.array_equal(rgb, one) for one in wanted.values()):
                wrong.append(rgb)

    ours.set("objects.ground.bump.scale", 0.3)
    workers = [threading.Thread(target=render) for _ in range(3)]
    for worker in workers:
        worker.start()
    for k in range(12):
        ours.set("objects.ground.bump.scale", (0.05, 0.3)[k % 2])
        gc.collect()
    stop.set()
    for worker in workers:
        worker.join()
    assert not wrong


def test_the_text_has_the_changes(tmp_path: Path) -> None:
    text = "# a scene\n" + CUBE.read_text()
    ours = kage.load(text, folder=CUBE.parent)
    ours.set({"objects.ground.bump.scale": 0.1, "render.shadow": "2+"})
    assert ours.text.startswith("# a scene\n") and "2+" in ours.text
    ours.save(tmp_path / "new.yaml")
    again = kage.load((tmp_path / "new.yaml").read_text(), folder=CUBE.parent)
    assert (tmp_path / "new.yaml").read_text() == ours.text
    assert np.array_equal(again.render(size=SMALL).rgb, ours.render(size=SMALL).rgb)
    with pytest.raises(kage.OutputError):
        ours.save(tmp_path / "nowhere" / "new.yaml")
