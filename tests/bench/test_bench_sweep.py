"""The sweeps' scenes: eye and light are where the axes say, the bumps are as steep, and the shadow is in the
picture."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from bench import plan, programs, sweep
from bench.sweep import Place
from tests.conftest import PROGRAM


@pytest.fixture(scope="module", params=["waves", "cube"])
def scene(request: pytest.FixtureRequest) -> plan.Facts:
    return plan.facts(PROGRAM, request.param)


def place_of(sets: dict[str, object], name: str) -> np.ndarray:
    return np.array([float(x) for x in str(sets[name]).strip("[]").split(",")])


def above(direction: np.ndarray) -> float:
    return float(np.degrees(np.arcsin(direction[1] / np.linalg.norm(direction))))


@pytest.mark.parametrize("angle", [6, 30, 80])
def test_angles(scene: plan.Facts, angle: float) -> None:
    sets = sweep.changes(scene, Place(view=angle, light=angle))
    eye, target, light = (place_of(sets, name) for name in ("camera.from", "camera.at", "lights.lamp.at"))
    assert above(eye - target) == pytest.approx(angle, abs=1e-3)
    assert above(light - (0, sweep.CENTRE[scene.name], 0)) == pytest.approx(angle, abs=1e-3)
    assert target[1] == 0


@pytest.mark.parametrize("frequency", [0.5, 1, 4])
def test_slopes_are_kept_at_other_frequencies(scene: plan.Facts, frequency: float) -> None:
    sets = sweep.changes(scene, Place(slope=0.4, frequency=frequency))
    bumps = {path: value for path, value in sets.items() if ".bump." in path}
    found = programs.parse_check(programs.run([PROGRAM, "check", scene.file, *programs.set_options(bumps)]))
    assert found["slope_95"] == pytest.approx(0.4, rel=0.1)


@pytest.mark.parametrize("level", ["quick", "normal"])
def test_every_corner_shows_shadow(scene: plan.Facts, level: str, tmp_path: Path) -> None:
    """`none` alone is rendered: its shadow is about the true one's size."""
    one = plan.Bench(PROGRAM, "tested", tmp_path, dataclasses.replace(plan.LEVELS[level], methods=("none",)),
                     {scene.name: scene})
    angles, slopes = one.level.angles, one.level.slopes
    for view, light, slope in [(angles[0], 45, slopes[0]), (angles[-1], 45, slopes[-1]), (40, angles[0], slopes[-1]),
                               (40, angles[-1], slopes[0])]:
        assert sweep.measure_cell(one, scene,
                                  Place(slope=slope, view=view, light=light))["shadow"] >= sweep.LEAST_SHADOW


def test_cells_count_wrong_pixels(scene: plan.Facts, tmp_path: Path) -> None:
    one = plan.Bench(PROGRAM, "tested", tmp_path, plan.LEVELS["quick"], {scene.name: scene})
    gentle, steep = (sweep.measure_cell(one, scene, Place(slope=slope)) for slope in (0.1, 0.6))
    assert gentle["wrong"].keys() == set(sweep.methods(one)) and "exact" not in gentle["wrong"]
    assert gentle["wrong"]["none"] > gentle["wrong"]["0"] and steep["wrong"]["none"] > gentle["wrong"]["none"]


def test_by_cost() -> None:
    assert sweep.by_cost({"2": 3.0, "0": 1.0}, ("none", "2", "0")) == ["0", "2", "none"]
