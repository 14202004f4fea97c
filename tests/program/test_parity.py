"""Every scene of parity.py is the same picture in POV-Ray, which reads the export without a warning.

A scene that fails stands in the test's name: `-k` with it makes that one alone. The suite has the first scene of each
shape and kind; the others are `slow`.
"""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Future

import pytest

from tests.conftest import needs_povray
from tests.support import parity


def marked() -> list[object]:
    """All scenes; those whose shape and kind another one before has are slow."""
    first = {(scene.row, scene.column): scene for scene in reversed(parity.SCENES)}
    return [scene if first[scene.row, scene.column] is scene else pytest.param(scene, marks=pytest.mark.slow)
            for scene in parity.SCENES]


@pytest.fixture(scope="module")
def found(request: pytest.FixtureRequest,
          tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[parity.Scene, Future[parity.Found]]]:
    """Those that this run asks for, in its order."""
    asked = [item.callspec.params["scene"] for item in request.session.items
             if "scene" in getattr(item, "fixturenames", ())
             and item.module is request.module]
    results = parity.compare_all(tmp_path_factory.mktemp("parity"), asked)
    yield results
    for result in results.values():
        result.cancel()


@needs_povray
@pytest.mark.parametrize("scene", marked(), ids=str)
def test_parity(found: dict[parity.Scene, Future[parity.Found]], scene: parity.Scene) -> None:
    """No warning about a gradient, above all: that would be holes."""
    one = found[scene].result()
    assert not one.warnings
    assert one.share >= scene.least, f"{100 * one.share:.3f} %, worst {one.worst:.3f}"
    assert not (scene.plain and one.stray)
    assert one.contrast > 0.01
    assert not scene.shape or scene.shape + " {" in one.export


def test_each_scene_has_a_name_and_a_place() -> None:
    assert len({str(scene) for scene in parity.SCENES}) == len(parity.SCENES)
    assert {scene.row for scene in parity.SCENES} == set(parity.ROWS)
    assert {scene.column for scene in parity.SCENES} == set(parity.COLUMNS)
