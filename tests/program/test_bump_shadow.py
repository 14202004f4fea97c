"""--bump-shadow: shaded at the place of the truth, a picture has the shadows of the displaced surface's bumps.

The truth is `--surface displaced` with its own shadows, on every kind of surface. What may differ is what the object's
far side casts, which is its smooth shape's: on the parametric surface its hills' shadows are among that. A disc's round
edge counts as a square.
"""

from __future__ import annotations

import hashlib

import numpy as np
import pytest

from tests.conftest import Kage
from tests.program.test_shade import SHAPES, inside, picture, scene

LOW = ("--set", "lights.lamp.at=[-4.5, 1.3, -3.2]")
EXACT = ("--shadow", "exact", "--shade", "shifted")
#: % of the pixels: without shadows of the bumps at least, with them at most
BARE = 2.0
MOST = {"march:24": 1.2, "horizon": 1.6, "exact": 0.5}
MORE = {"torus": 1.5, "turned torus": 1.5, "patches": 3.0, "mesh": 2.5, "parametric": 8.0, "ellipsoid": 0.5,
        "stretched sphere": 0.5, "rectangle": 0.5, "disc": 1.5}


def wrong(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> float:
    """% of the object's pixels, not at its silhouette, that differ in whether they see the lamp."""
    pixels = inside((a["order"] == 6) & (b["order"] == 6))
    return float(100 * (np.abs(a["visibility.lamp"] - b["visibility.lamp"])[pixels] > 0.5).mean())


@pytest.mark.parametrize("name", SHAPES)
def test_the_truth_on_every_surface(kage: Kage, name: str) -> None:
    path = scene(kage, name)
    truth = picture(kage, path, "--surface", "displaced", *LOW)
    got = {how: wrong(truth, picture(kage, path, *EXACT, *LOW, "--bump-shadow", how)) for how in ("none", *MOST)}
    print(f"{name}: " + ", ".join(f"{how} {x:.2f} %" for how, x in got.items()))
    assert got["none"] > BARE
    for how, most in MOST.items():
        assert got[how] <= most + MORE.get(name, 0), how


@pytest.mark.parametrize("how", MOST)
def test_a_flat_bump_shadows_nothing(kage: Kage, how: str) -> None:
    """P = 0: the picture without shadows of bumps."""
    path = scene(kage, "sphere")
    path.write_text(path.read_text().replace("0.05*sin(8*u)*sin(7*w)", "0*u"))
    bare, own = picture(kage, path), picture(kage, path, "--bump-shadow", how)
    assert all(np.array_equal(bare[name], own[name]) for name in bare)


def test_an_area_light_is_seen_in_shares(kage: Kage) -> None:
    """A horizon tells the share that is above it: near that of 8 x 8 samples with a march each."""
    path = scene(kage, "rectangle")
    area = ("--set", "lights.lamp.area={u: [1.5, 0, 0], w: [0, 1.5, 0], samples: [8, 8]}", *LOW, *EXACT)
    march, horizon = (picture(kage, path, *area, "--bump-shadow", how)["visibility.lamp"]
                      for how in ("march:32", "horizon"))
    pixels = inside(march >= 0) & (picture(kage, path, *area)["order"] == 6)
    off = (horizon - march)[pixels]
    partly = ((march > 0.05) & (march < 0.95))[pixels].mean()
    print(f"off by {np.abs(off).mean():.4f} on average, {off.mean():.4f} in sum; {100 * partly:.1f} % in half shadow")
    assert partly > 0.1 and np.abs(off).mean() < 0.03 and abs(off.mean()) < 0.025


@pytest.mark.parametrize("how", MOST)
def test_same_bytes_for_any_threads(kage: Kage, how: str) -> None:
    path = scene(kage, "sphere")
    sums = []
    for threads in ("1", "3"):
        out = kage.folder / f"threads{threads}.png"
        kage.good("render", path, *LOW, *EXACT, "--bump-shadow", how, "--threads", threads, "--quiet", "-o", out)
        sums.append(hashlib.sha256(out.read_bytes()).hexdigest())
    assert sums[0] == sums[1]


@pytest.mark.parametrize("how", MOST)
def test_a_crop_is_a_part_of_the_whole(kage: Kage, how: str) -> None:
    """No lane depends on its neighbours, seen from the front or from behind."""
    path = scene(kage, "cylinder")
    whole = picture(kage, path, *LOW, *EXACT, "--bump-shadow", how)
    part = picture(kage, path, *LOW, *EXACT, "--bump-shadow", how, "--crop", "53,31,94,77")
    for name, plane in part.items():
        assert np.array_equal(plane, whole[name][31:77, 53:94]), name


def test_off_without_self_shadow(kage: Kage) -> None:
    path = scene(kage, "plane")
    bare = picture(kage, path, *LOW, "--no-self-shadow")
    own = picture(kage, path, *LOW, "--no-self-shadow", "--bump-shadow", "march:8")
    assert all(np.array_equal(bare[name], own[name]) for name in bare)


def test_from_behind_hollows_are_hills(kage: Kage) -> None:
    """A plane seen from behind is one seen from the front with -P."""
    path = scene(kage, "plane")
    text = path.read_text()
    behind = text.replace("u: [0, 0, 1], w: [1, 0, 0]", "u: [1, 0, 0], w: [0, 0, 1]")
    for how in ("march:16", "horizon"):
        path.write_text(text)
        front = picture(kage, path, *LOW, "--shadow", "march:8", "--bump-shadow", how)["visibility.lamp"]
        path.write_text(behind.replace("0.06*sin(5*u)*cos(4*w)", "-0.06*sin(5*w)*cos(4*u)"))
        back = picture(kage, path, *LOW, "--shadow", "march:8", "--bump-shadow", how)["visibility.lamp"]
        assert (np.abs(front - back) > 0.5).mean() < 0.002


def test_horizon_needs_no_map_on_an_endless_plane(kage: Kage) -> None:
    """A function there has no horizon map; 24 steps of the march stand in."""
    path = scene(kage, "plane")
    march = picture(kage, path, *LOW, "--bump-shadow", "march:24")
    horizon = picture(kage, path, *LOW, "--bump-shadow", "horizon")
    assert all(np.array_equal(march[name], horizon[name]) for name in march)
