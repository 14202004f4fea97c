"""bench/whole.py and bench/bounds.py: what the silhouette is, what is off, and whether bounds follow the numbers."""

from __future__ import annotations

import json
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bench import bounds, claims, plan, programs, quality, whole, whole_tables
from reference import own, references
from tests.conftest import PROGRAM
from tests.support import bench_sample

# The silhouette ---------------------------------------------------------------------------------------


def layers(order: np.ndarray, depth: np.ndarray, tau: np.ndarray) -> quality.Layers:
    return {"order": order, "Z": depth, "tau": tau}


def flat(value: float) -> np.ndarray:
    return np.full((9, 12), value, dtype=np.float32)


def test_silhouette() -> None:
    """A pixel that only the displaced picture has, one whose true hit is on another part, and their neighbours."""
    order, depth, tau = flat(6), flat(5), flat(0.25)
    smooth, displaced = layers(order.copy(), depth.copy(), tau), layers(order.copy(), depth + tau, tau)
    smooth["order"][:, 9:], smooth["Z"][:, 9:] = -1, 1e30  # the background
    displaced["order"][:, 10:], displaced["Z"][:, 10:] = -1, 1e30
    displaced["Z"][4, 3] = 4
    receiver, edge = whole.silhouette(smooth, displaced)
    assert receiver[:, :10].all() and not receiver[:, 10:].any()
    want = np.zeros((9, 12), bool)
    want[3:6, 2:5], want[:, 8:10] = True, True
    assert (edge == want).all()


def test_errors() -> None:
    """Of 100 pixels: 10 at the silhouette, all far off; of the other 90 some a little."""
    truth = whole.Truth(np.zeros((10, 10, 3), np.float32), np.ones((10, 10), bool), np.zeros((10, 10), bool))
    truth.silhouette[0] = True
    color = np.zeros((10, 10, 3), np.float32)
    color[0] = 1
    color[1, :9, 1] = -20 / 255  # the largest of the three, whatever its sign
    color[2, :9, 0] = 2 / 255
    found = whole.errors(color, truth)
    assert {key: found[key] for key in ("off_1", "off_8", "off_32", "silhouette", "silhouette_off")} == {
        "off_1": 20, "off_8": 10, "off_32": 0, "silhouette": 10, "silhouette_off": 100}
    assert found["of_rest"] == pytest.approx(100 * 10 / 19)
    assert found["median"] == 0 and found["p95"] == pytest.approx(20)
    levels = whole.error_levels(color, truth)
    assert np.bincount(levels.ravel()).tolist() == [0, 81, 0, 9, 10]


@pytest.mark.parametrize("elevation", references.ELEVATIONS)
def test_lamps(elevation: int) -> None:
    at = (-4.4, 5.8, -2.6)
    lamp = own.lamp_at(at, elevation)
    assert np.linalg.norm(lamp) == pytest.approx(np.linalg.norm(at))
    assert np.degrees(np.arcsin(lamp[1] / np.linalg.norm(lamp))) == pytest.approx(elevation)
    assert np.arctan2(lamp[2], lamp[0]) == pytest.approx(np.arctan2(at[2], at[0]))


# With kage --------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> plan.Bench:
    facts = {name: plan.facts(PROGRAM, name) for name in ("waves", "torus")}
    return plan.Bench(PROGRAM, "digest", tmp_path_factory.mktemp("whole"), plan.LEVELS["quick"], facts)


def off(bench: plan.Bench, scene: plan.Facts, setting: whole.Setting, variant: str) -> float:
    truth = whole.read_truth(bench.whole_truth(scene.name, setting.name))
    found = whole.errors(references.stack(whole.picture(bench, scene, variant, setting)), truth)["off_8"]
    assert found is not None
    return found


@pytest.mark.parametrize("name", ["waves", "torus"])
def test_pictures_by_kage(bench: plan.Bench, name: str) -> None:
    """Displaced is the truth; to shade at the shifted place is nearer to it than any shadow alone."""
    scene = bench.scenes[name]
    setting = whole.Setting("test", whole.lamp_set(scene, 45), (160, 120))
    whole.make_truth(bench, scene, setting)
    truth = whole.read_truth(bench.whole_truth(name, setting.name))
    assert truth.silhouette.any() == (name == "torus") and truth.silhouette.sum() < 0.3 * truth.receiver.sum()
    assert off(bench, scene, setting, "displaced") == 0
    none, zero, shifted = (off(bench, scene, setting, v) for v in ("none", "0", "march:8 shifted"))
    assert none > zero > 5 * shifted


def test_own_shadows_by_kage(bench: plan.Bench) -> None:
    """Both programs see the same shadows, and the march is the better the more steps it has."""
    value: dict[str, Any] = whole.measure_own(bench, bench.scenes["waves"], 10)
    assert value["shadow"] > 5000
    wrong = {how: count / value["shadow"] for how, count in value["wrong"].items()}
    assert wrong.keys() == set(plan.OWN)
    assert wrong["displaced"] < 0.01 and wrong["own exact"] < 0.01
    assert wrong["own 24"] < wrong["own 4"] < 0.5


def test_scales_are_those_of_the_scenes() -> None:
    for name, scale in whole.SCALE.items():
        assert f"scale: {scale:g}" in (programs.TOP / "scenes" / f"{name}.yaml").read_text()


# Bounds -----------------------------------------------------------------------------------------------


def around(times: float, half: float = 0.05) -> dict[str, float]:
    """% over none."""
    return {"median": 100 * (times - 1), "low": 100 * (times - 1 - half), "high": 100 * (times - 1 + half), "n": 7}


def cost(times: float) -> dict[str, Any]:
    return {"ns": None, "added": around(times), "instructions_added": 100 * (times - 1)}


def good() -> dict[str, Any]:
    """Where every bound is met."""
    costs = {method: cost(times) for method, times in
             {"0": 1.05, "march:8": 3.0, "auto": 1.2, "exact": 5.0, "displaced": 9.0, "relief": 3.0}.items()}
    wrong = {"none": 5.0, "0": 1.0, "march:8": 0.09, "auto": 0.05, "exact": 0.0, "displaced": 0.0}
    scenes = list(whole.SCALE)
    report = {
        "methods": list(wrong), "scenes": dict.fromkeys(scenes),
        "cost": {"scenes": {scene: {"methods": costs} for scene in scenes},
                 "peers": [{"name": bounds.EMBREE_MESH, "scene": "cube", "ns": None, "times": {
                     "displaced": {"median": 1.3, "low": 1.2, "high": 1.4, "n": 7}}}]},
        "quality": {"scenes": {scene: {m: {"mask": None, "exact": {"wrong": share}} for m, share in wrong.items()}
                               for scene in scenes}},
        "whole": {"scenes": {scene: {"relief": {"off_8": 0.4}} for scene in scenes}},
    }
    return json.loads(json.dumps(report))


def verdicts(report: dict[str, Any]) -> dict[str, str]:
    return {claim["id"]: claim["verdict"] for claim in bounds.bounds(report)}  # type: ignore[arg-type]


def test_all_bounds_are_met() -> None:
    assert set(verdicts(good()).values()) == {claims.HOLDS}


@pytest.mark.parametrize(("path", "value", "bad"), [
    (("cost", "scenes", "cube", "methods", "exact", "added"), around(6.5), {"exact-cost"}),
    (("cost", "scenes", "cube", "methods", "displaced", "added"), around(11), {"exact-cost"}),
    (("cost", "peers", 0, "times", "displaced"), {"median": 0.8, "low": 0.7, "high": 0.9, "n": 7}, {"embree"}),
    (("cost", "scenes", "torus", "methods", "exact", "instructions_added"), 1000, {"faster"}),
    (("quality", "scenes", "torus", "auto", "exact", "wrong"), 0.11, {"auto-wrong", "auto-least"}),
    (("cost", "scenes", "sphere", "methods", "march:8", "added"), around(1.05), {"auto-least"}),
    (("cost", "scenes", "waves", "methods", "auto", "added"), around(1.5), {"auto-cost"}),
    (("cost", "scenes", "terrain", "methods", "relief", "added"), around(4.2), {"relief"}),
    (("whole", "scenes", "terrain", "relief", "off_8"), 1.01, {"relief"}),
])
def test_a_bound_that_is_not_met(path: tuple, value: object, bad: set[str]) -> None:
    report = good()
    place: Any = report
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    found = verdicts(report)
    assert {name for name, verdict in found.items() if verdict != claims.HOLDS} == bad
    assert all(found[name] in (claims.FAILS, claims.IN_PART) for name in bad)


def test_noise_decides_nothing() -> None:
    report = good()
    report["cost"]["scenes"]["cube"]["methods"]["exact"]["added"] = around(6.0)
    assert verdicts(report)["exact-cost"] == claims.UNDECIDED
    report["cost"]["scenes"]["waves"]["methods"]["march:8"]["added"] = around(1.25, 0.5)
    assert verdicts(report)["auto-least"] == claims.UNDECIDED


def test_nothing_measured() -> None:
    assert set(verdicts({"methods": [], "scenes": {}}).values()) == {claims.UNMEASURED}


def test_lines_have_figure_bound_and_verdict() -> None:
    lines = bounds.lines(bounds.bounds(good()))  # type: ignore[arg-type]
    assert "bound exact-cost: exact on cube: 5.00 times bump only (4.95 to 5.05), at most 6: holds" in lines
    assert "bound relief: off, waves: 0.4 % of the pixels off by more than 8/255, at most 1: holds" in lines


def test_the_cheapest_that_is_good_enough(tmp_path: Path) -> None:
    report = deepcopy(bench_sample.make_report(tmp_path))
    assert whole_tables.good_enough(report, "cube") == ["auto", "march:8", "exact"]
    assert whole_tables.good_enough(report, "terrain") == ["exact"]
