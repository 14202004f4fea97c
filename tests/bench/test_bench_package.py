"""Renders by the package have the program's very values."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

from bench import package, programs
from reference import references
from tests.conftest import PROGRAM, TOP

SIZE = programs.size_options((64, 48))


@pytest.mark.parametrize("words", [
    (*programs.method_options("auto"), "--no-self-shadow", "--layers", "color,tau,order,visibility"),
    (*programs.method_options("2 bare"), *programs.set_options({"camera.from": "[0, 3, -5]", "image.size": "[9, 9]"})),
    (*programs.method_options("march:8 shifted, own 24"), "--layers", "N,P"),
    programs.method_options("displaced"),
    programs.method_options("relief"),
])
def test_the_same_values(tmp_path: Path, words: tuple[str, ...]) -> None:
    path = tmp_path / "a.exr"
    subprocess.run([PROGRAM, "render", "scenes/cube.yaml", *words, *SIZE, "-o", path, "--quiet"], cwd=TOP, check=True)
    its = references.read_exr(path)
    ours = package.render(PROGRAM, "scenes/cube.yaml", (*words, *SIZE))
    assert ours is not None and ours.keys() == its.keys()
    assert all(np.array_equal(ours[name], its[name]) for name in its)


def test_what_is_for_the_program(tmp_path: Path) -> None:
    assert package.render(PROGRAM, "scenes/cube.yaml", ("--stats",)) is None
    assert package.render(tmp_path / "kage", "scenes/cube.yaml", SIZE) is None


def test_an_error_is_one_of_the_bench() -> None:
    with pytest.raises(programs.MeasureError, match="no method"):
        package.render(PROGRAM, "scenes/cube.yaml", ("--shadow", "3"))
