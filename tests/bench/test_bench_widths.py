"""bench/widths.py: derivatives over a width, and what docs/method.md says of them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from bench import widths
from tests.conftest import PROGRAM

SMALL = (160, 120)
PLACES = np.array([40.25, 63.5, 71.0]), np.array([50.75, 64.0, 57.5])  # x and y, away from the ends


@pytest.mark.parametrize("width", widths.WIDTHS[:5])
def test_a_quadratic_has_its_derivatives_at_each_width(width: int) -> None:
    """The mean of a quadratic is that quadratic and a constant; at a level's samples differences are exact."""
    y, x = np.mgrid[0:128, 0:128].astype(float)
    table = widths.level(0.5 * x + 0.25 * y + 0.01 * x * x - 0.02 * y * y, width, repeat=False)
    j, i = np.array([2, 4]), np.array([3, 5])
    x, y = (i + 0.5) * width - 0.5, (j + 0.5) * width - 0.5
    means = (width * width - 1) / 12 * np.array([0.01 - 0.02])
    want = [0.5 * x + 0.25 * y + 0.01 * x * x - 0.02 * y * y + means, 0.5 + 0.02 * x, 0.25 - 0.04 * y,
            np.full(2, 0.02), np.full(2, -0.04)]
    assert table[j, i] == pytest.approx(np.stack(want, axis=-1))


def test_look_ups_interpolate_between_levels() -> None:
    pyramid = widths.Pyramid(np.random.default_rng(7).normal(size=(128, 128)), repeat=True)
    x, y = PLACES
    for k, width in enumerate(widths.WIDTHS):
        assert pyramid.trilinear(np.full(3, width), x, y) == pytest.approx(pyramid.bilinear(k, x, y))
    half = pyramid.trilinear(np.full(3, 4 * np.sqrt(2)), x, y)
    assert half == pytest.approx((pyramid.bilinear(2, x, y) + pyramid.bilinear(3, x, y)) / 2)
    assert pyramid.trilinear(np.zeros(3), x, y) == pytest.approx(pyramid.bilinear(0, x, y))
    wide = pyramid.bilinear(7, x, y)  # one sample, which repeats: the mean of all
    assert wide[:, 1:] == pytest.approx(0) and np.ptp(wide[:, 0]) == pytest.approx(0)
    assert pyramid.bilinear(3, x + 128, y - 256) == pytest.approx(pyramid.bilinear(3, x, y))


def test_clamped_ends_are_level() -> None:
    pyramid = widths.Pyramid(np.random.default_rng(8).normal(size=(9, 7)), repeat=False)
    far = pyramid.bilinear(0, np.array([-5.0, 6, 90]), np.array([-1.0, 8, 90]))
    assert far[:, 0] == pytest.approx(pyramid.levels[0][[0, 8, 8], [0, 6, 6], 0])


def test_guard() -> None:
    """The cases of tests/unit/method/bumpshadow_cases.h."""
    one = np.ones(1)
    rays = widths.Rays(np.zeros((1, 3)), np.zeros((1, 3)), -0.5 * one, one, 0 * one, one, one, 1, 1)
    bump = {"gentle": (0.05, 0.1, 0.1), "facing away": (0.05, -0.7, 0), "far off": (0.05, -0.49, 0),
            "no root": (0.05, -0.4, 2)}
    used = {}
    for name, (height, slope, bend) in bump.items():
        p = widths.Bump(height * one, slope * one, 0 * one, bend * one, 0 * one)
        used[name] = [int(widths.shift(order, rays, p, -0.1, 0.1)[1][0]) for order in widths.ORDERS]
        assert widths.shift(0, rays, p, -0.1, 0.1)[0] == pytest.approx(-0.1)
    assert used == {"gentle": [0, 1, 2], "facing away": [0, 0, 0], "far off": [0, 0, 0], "no root": [0, 0, 0]}
    no_root = widths.Bump(0.05 * one, -0.4 * one, 0 * one, 2 * one, 0 * one)
    assert widths.shift(2, rays, no_root, -1, 1)[1] == 1


@pytest.mark.parametrize("name", widths.SCENES)
def test_width_1_is_kages_and_wider_is_better(name: str) -> None:
    """What docs/method.md concludes."""
    picture = widths.Picture(PROGRAM, widths.SCENES[name], SMALL)
    picture.check()
    rows = {row.width: row for row in picture.rows()}
    zero, _, two = rows["shift"].own
    assert list(rows) == [str(width) for width in widths.WIDTHS] + list(widths.SHIFTS)
    assert len({row.own[0] for row in rows.values()}) == 1  # P itself is kage's
    assert two < 0.75 * zero
    assert rows["1"].fell_back[2] > 1.5 * rows["shift"].fell_back[2]
    if name == "terrain":
        assert rows["1"].own[1] > zero and rows["1"].own[2] > zero
        assert min(row.own[2] for row in rows.values()) > picture.others()["iter:2"]


def test_notices_another_scene() -> None:
    scene = widths.SCENES["cube"]
    with pytest.raises(widths.WidthsError, match="the heights are not those of kage's"):
        widths.Picture(PROGRAM, dataclasses.replace(scene, size=(6, 12)), SMALL)
    other = widths.Picture(PROGRAM, dataclasses.replace(scene, light=(-4.4, 4.8, -2.6)), SMALL)
    with pytest.raises(widths.WidthsError, match="order 0 at width 1 differs from kage in"):
        other.check()


def test_prints_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    widths.main(["terrain", "--size", "80x60", "--kage", str(PROGRAM)])
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("terrain, 80x60: wrong pixels in % of the true shadow's ")
    assert lines[2].startswith("| width | order 0 | order 1 | order 2 |")
    assert len({line.count("|") for line in lines[2:-1]}) == 1 and len(lines) == 4 + 11 + 1
