"""Sweeps without a cluster: axes, names, the keys of an animation, the files of a scene, what is done already."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from distributed import KilledWorker

from kage.sweep import Keys, Output, Plan, SweepError, axis, records
from kage.sweep.axes import label, short_names
from kage.sweep.inputs import VERSION, Inputs, here
from kage.sweep.records import Record
from kage.sweep.run import ROUNDS, Done, Sweep, ignore
from kage.sweep.worker import work
from tests.conftest import SCENE, TOP

CUBE = TOP / "scenes" / "cube.yaml"
SIZE = (32, 24)


# Axes -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("text", "values"), [
    ("a.b=0:1:5", ["0", "0.25", "0.5", "0.75", "1"]),
    ("a.b=0.1:0.3:3", ["0.1", "0.2", "0.3"]),
    ("a=0.01:1:3:log", ["0.01", "0.1", "1"]),
    ("a=47:0:2", ["47", "0"]),
    ("a=none,0,iter:2,march:4", ["none", "0", "iter:2", "march:4"]),
    ("a=[0, 1, 2],[3, 4, 5]", ["[0, 1, 2]", "[3, 4, 5]"]),
    ("a=noise(u, w),'x, y'", ["noise(u, w)", "'x, y'"]),
    ("a={file: m.png, channel: R}", ["{file: m.png, channel: R}"]),
])
def test_values(text: str, values: list[str]) -> None:
    assert list(axis(text).values) == values


@pytest.mark.parametrize(("text", "words"), [
    ("a", "expected PATH="), ("=1:2:3", "expected PATH="), ("a= ", "expected PATH="), ("a=1:2:1", "1 values"),
    ("a=1:2:0", "0 values"), ("a=1:2:99999999", "99999999 values"), ("a=0:1:3:log", "above 0"), ("a=1,2,1", "twice"),
    ("frame=a,b", "expected a number"), ("a=1e999:2:3", "too large"), ("a=,", "no values"),
])
def test_wrong_values(text: str, words: str) -> None:
    with pytest.raises(SweepError, match=words):
        axis(text)


def test_names_are_short_and_tell_paths_apart() -> None:
    assert short_names(["objects.a.bump.scale", "render.shadow"]) == {
        "objects.a.bump.scale": "scale", "render.shadow": "shadow"}
    assert short_names(["objects.a.bump.scale", "objects.b.bump.scale"]) == {
        "objects.a.bump.scale": "a.bump.scale", "objects.b.bump.scale": "b.bump.scale"}


def test_labels_sort_as_numbers_and_are_names_of_files() -> None:
    assert label(["0", "5", "10"]) == ["00", "05", "10"]
    assert label(["0.1", "0.133333333333"]) == ["0.1", "0.13333"]
    assert label(["0.100001", "0.1000011"]) == ["1", "2"]  # the same to 5 digits
    assert label(["[0, 1]", "../x"]) == ["0_1", ".._x"]
    assert label(["..", "a"]) == ["1", "2"]
    assert label(["x" * 50, "y"]) == ["1", "2"]


# Keys -----------------------------------------------------------------------------------------------


KEYS = """\
camera.from: [[0, [0, 3, -5]], [10, [4, 3, -1]]]
objects.ground.bump.scale: {between: smooth, keys: [[0, 0], [4, 1], [8, 1], [10, 3]]}
render.shadow: [[0, none], [5, 2]]
image.size: {between: hold, keys: [[0, [32, 24]], [9, [48, 36]]]}
"""


def test_keys_between() -> None:
    keys = Keys.parse(KEYS)
    assert keys.at(5) == {"camera.from": "[2, 3, -3]", "objects.ground.bump.scale": "1", "render.shadow": "2",
                          "image.size": "[32, 24]"}
    assert keys.at(0)["render.shadow"] == "none" and keys.at(4.9)["render.shadow"] == "none"
    assert keys.at(-3) == keys.at(0) and keys.at(99) == keys.at(10)
    assert keys.at(10)["image.size"] == "[48, 36]" and keys.at(10)["objects.ground.bump.scale"] == "3"


def test_smooth_keys_never_overshoot_and_start_and_stop_gently() -> None:
    track = next(t for t in Keys.parse(KEYS).tracks if t.between == "smooth")
    frames = np.linspace(0, 10, 201)
    values = np.array([float(track.at(frame)) for frame in frames])
    assert (np.diff(values) >= 0).all() and values.min() == 0 and values.max() == 3
    assert values[frames == 4] == 1 and (values[(frames >= 4) & (frames <= 8)] == 1).all()
    speed = np.diff(values) / np.diff(frames)
    assert abs(speed[0]) < 0.05 and abs(speed[-1]) < 0.2  # 0.25 and 1 on the mean
    assert np.abs(np.diff(speed)).max() < 0.25  # no jump


@pytest.mark.parametrize(("text", "words"), [
    ("a: [[0, 1], [0, 2]]", "keys.yaml:1:1: a: the frames of the keys do not rise"),
    ("b: [[0, 1]]\na: 3", "keys.yaml:2:1: a: expected a list of"),
    ("a: {keys: [[0, 1]], between: jumpy}", "between: jumpy, expected linear, smooth, hold"),
    ("a: {key: [[0, 1]]}", "a has key, expected `keys`"),
    ("a: [[x, 1]]", "expected a list of"),
    ("- 1", "expected a path of the scene"),
    ("a: [", "keys.yaml:"),
    ("", "expected a path of the scene"),
])
def test_wrong_keys(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "keys.yaml"
    path.write_text(text)
    with pytest.raises(SweepError) as raised:
        Keys.read(path)
    assert words in str(raised.value)
    with pytest.raises(SweepError, match="can't be read"):
        Keys.read(tmp_path / "none.yaml")


# Plans ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("axes", "more", "words"), [
    (["a=1,2", "a=3,4"], {}, "a varies twice"),
    (["frame=0:1:2"], {}, "needs both"),
    ([], {"bands": 2}, "--format exr"),
    ([], {"bands": 0}, "0 bands"),
    ([], {"layers": "color"}, "layers are those of an EXR"),
    ([], {"kind": "gif"}, "'gif' is no format"),
    (["a=1:2:1001", "b=1:2:1000"], {}, "1001000 pictures"),
])
def test_wrong_plans(tmp_path: Path, axes: list[str], more: dict[str, Any], words: str) -> None:
    with pytest.raises(SweepError, match=words):
        Plan.of(CUBE, [axis(text) for text in axes], Output(tmp_path, **more))


def test_a_wrong_scene_is_told_with_its_place(tmp_path: Path) -> None:
    (tmp_path / "bad.yaml").write_text(SCENE.replace("fov: 40", "fov: 400"))
    with pytest.raises(ValueError, match=r"bad\.yaml:1:\d+: "):
        Plan.of(tmp_path / "bad.yaml", [], Output(tmp_path))
    with pytest.raises(SweepError, match="can't be read"):
        Plan.of(tmp_path / "none.yaml", [], Output(tmp_path))


def test_bands_are_whole_chunks(tmp_path: Path) -> None:
    (picture,) = Plan.of(CUBE, [], Output(tmp_path, kind="exr", size=(32, 100), bands=3)).pictures
    assert [band.crop for band in picture.bands] == [(0, 0, 32, 32), (0, 32, 32, 64), (0, 64, 32, 100)]
    (picture,) = Plan.of(CUBE, [], Output(tmp_path, kind="exr", size=(32, 20), bands=9)).pictures
    assert [band.crop for band in picture.bands] == [(0, 0, 32, 16), (0, 16, 32, 20)]


def test_sizes_that_vary_have_bands_of_their_own(tmp_path: Path) -> None:
    plan = Plan.of(CUBE, [axis("image.size=[32, 32],[32, 64]")], Output(tmp_path, kind="exr", bands=2))
    assert [[band.crop for band in picture.bands] for picture in plan.pictures] == [
        [(0, 0, 32, 16), (0, 16, 32, 32)], [(0, 0, 32, 32), (0, 32, 32, 64)]]


# A scene's files ------------------------------------------------------------------------------------


def copy_scene(folder: Path) -> Path:
    (folder / "scenes").mkdir()
    (folder / "maps").mkdir()
    (folder / "maps" / "map.png").write_bytes((TOP / "scenes" / "data" / "bumps.png").read_bytes())
    scene = folder / "scenes" / "a.yaml"
    scene.write_text(SCENE.replace("file: map.png", "file: ../maps/map.png"))
    return scene


def test_files_are_found_and_travel(tmp_path: Path) -> None:
    scene = copy_scene(tmp_path)
    sent, shared = Inputs.read(scene, send=True), Inputs.read(scene)
    assert [file.name for file in sent.files] == ["../maps/map.png"]
    assert sent.digest == shared.digest  # so that pictures are found in either way
    folder = here(sent)
    assert not folder.is_relative_to(tmp_path)
    assert (folder / "../maps/map.png").read_bytes() == (tmp_path / "maps" / "map.png").read_bytes()
    assert here(shared) == tmp_path / "scenes"


def test_other_files_at_a_worker_are_refused(tmp_path: Path) -> None:
    inputs = Inputs.read(copy_scene(tmp_path))
    (tmp_path / "maps" / "map.png").write_bytes(b"other")
    with pytest.raises(SweepError, match="it is another file"):
        here(inputs)
    (tmp_path / "maps" / "map.png").unlink()
    with pytest.raises(SweepError, match="--send sends files along"):
        here(inputs)


def test_a_changed_file_is_another_picture(tmp_path: Path) -> None:
    scene = copy_scene(tmp_path)
    before = Plan.of(scene, [], Output(tmp_path, size=SIZE)).pictures[0].whole
    (tmp_path / "maps" / "map.png").write_bytes((TOP / "scenes" / "data" / "bumps.png").read_bytes() + b" ")
    after = Plan.of(scene, [], Output(tmp_path, size=SIZE)).pictures[0].whole
    assert before.identity != after.identity


def test_absolute_names_do_not_travel(tmp_path: Path) -> None:
    scene = copy_scene(tmp_path)
    scene.write_text(scene.read_text().replace("../maps/map.png", str(tmp_path / "maps" / "map.png")))
    assert Inputs.read(scene).files
    with pytest.raises(SweepError, match="must be named from the scene's folder on"):
        Inputs.read(scene, send=True)


def test_buffers_of_gltf_are_found(tmp_path: Path) -> None:
    (tmp_path / "m.gltf").write_text(json.dumps({"buffers": [{"uri": "m.bin"}, {"uri": "data:,x"}]}))
    (tmp_path / "m.bin").write_bytes(b"1")
    (tmp_path / "a.yaml").write_text("objects: {m: {mesh: {file: m.gltf}}}")
    assert [file.name for file in Inputs.read(tmp_path / "a.yaml").files] == ["m.bin", "m.gltf"]


# One task -------------------------------------------------------------------------------------------


def plan_of(folder: Path, **more: Any) -> Plan:
    return Plan.of(CUBE, [axis("render.shadow=0,1")], Output(folder, size=SIZE, **more))


def test_a_task_is_done_once(tmp_path: Path) -> None:
    plan = plan_of(tmp_path)
    task = plan.pictures[0].whole
    (tmp_path / records.FOLDER).mkdir()
    first = work(plan.inputs, task, str(tmp_path), 1, VERSION)
    again = work(plan.inputs, task, str(tmp_path), 1, VERSION)
    assert first.record and again.record == first.record and (first.found, again.found) == (False, True)
    assert [line["event"] for line in records.read_logs(tmp_path)] == ["begin", "end"]


@pytest.mark.parametrize("harm", ["cut", "other", "gone", "record"])
def test_what_is_not_whole_is_done_again(tmp_path: Path, harm: str) -> None:
    plan = plan_of(tmp_path)
    task = plan.pictures[0].whole
    (tmp_path / records.FOLDER).mkdir()
    work(plan.inputs, task, str(tmp_path), 1, VERSION)
    path = tmp_path / task.file
    good = path.read_bytes()
    if harm == "cut":
        path.write_bytes(good[:-1])
    elif harm == "other":
        path.write_bytes(good[:-1] + b"?")
    elif harm == "gone":
        path.unlink()
    else:
        records.path_of(tmp_path, task.file).write_text("{")
    assert records.find(tmp_path, task.file, task.identity) is None
    assert not work(plan.inputs, task, str(tmp_path), 1, VERSION).found
    assert path.read_bytes() == good and records.find(tmp_path, task.file, task.identity)


def test_what_a_worker_says_of_itself(tmp_path: Path) -> None:
    plan = plan_of(tmp_path)
    task = plan.pictures[0].whole
    other = work(plan.inputs, task, str(tmp_path), 1, "0.0.9 float")
    assert other.status == 1 and "0.0.9 float where the sweep was started" in other.wrong
    away = work(plan.inputs, task, str(tmp_path / "away"), 1, VERSION)
    assert away.status == 1 and "--send" in away.wrong


def test_one_sweep_at_a_time(tmp_path: Path) -> None:
    with records.locked(tmp_path), pytest.raises(SweepError, match="another sweep"), records.locked(tmp_path):
        pass
    with records.locked(tmp_path):
        pass
    (tmp_path / "file").write_text("")
    with pytest.raises(SweepError, match="can't be written"), records.locked(tmp_path / "file"):
        pass


class Dying:
    """A future whose workers die."""

    status = "error"

    def __init__(self) -> None:
        self.retried = 0

    def exception(self) -> Exception:
        return KilledWorker("task", None, 3)

    def retry(self) -> None:
        self.retried += 1


def test_what_kills_its_workers_is_given_up(tmp_path: Path) -> None:
    plan = plan_of(tmp_path)
    task = plan.pictures[0].whole
    done, future = Done(tmp_path), Dying()
    sweep = Sweep(plan, None, 1, ignore, done)  # type: ignore[arg-type]
    rounds = [sweep.finish(future, task) for _ in range(ROUNDS)]  # type: ignore[arg-type]
    assert rounds == [True] * (ROUNDS - 1) + [False] and future.retried == ROUNDS - 1
    assert "the worker died" in done.failed[task.file] and not done.records


def test_records_are_read_as_they_were_written(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(b"abc")
    (tmp_path / records.FOLDER).mkdir()
    digest = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    record = Record("a.png", "x", digest, 3, 0.5, {"seconds": 0.25}, "w")
    records.keep(tmp_path, record)
    assert records.find(tmp_path, "a.png", "x") == record
    assert records.find(tmp_path, "a.png", "y") is None
    records.drop(tmp_path, "a.png")
    assert not list((tmp_path / records.FOLDER).iterdir())
