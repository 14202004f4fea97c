"""No NaN and no infinity in a picture: where a function has no value the surface is smooth, and that is told."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import TOP, Kage, needs_povray
from tests.support.parity import layers, povray, rgb

MOEBIUS = TOP / "tests" / "regression" / "moebius.yaml"
WAVES = TOP / "scenes" / "waves.yaml"
SMALL = ("--size", "48x36")


def bump(function: str) -> tuple[str, str]:
    return "--set", f'objects.ground.bump={{function: "{function}"}}'


def finite(path: Path) -> dict[str, np.ndarray]:
    """The planes, all finite; Z is 1e30 where nothing is hit."""
    picture = layers(path)
    for name, plane in picture.items():
        assert np.isfinite(plane).all(), name
    assert picture["Z"].max() <= np.float32(1e30)
    return picture


@pytest.mark.parametrize("function", ["log(u)", "sqrt(u)", "1/0", "1e300*u*1e300"])
@pytest.mark.parametrize("method", ["none", "2", "2+", "iter:3", "march:4", "auto"])
def test_a_function_without_a_value(kage: Kage, function: str, method: str) -> None:
    done = kage("render", WAVES, *SMALL, *bump(function), "--shadow", method, "--shade", "shifted", "-o", "x.exr")
    assert done.returncode == 0
    assert re.search(r"^waves\.yaml: no value at [1-9]\d* samples, first on ground: ", done.stderr, re.M), done.stderr
    picture = finite(kage.folder / "x.exr")
    none = (picture["order"] == -1) & (picture["height"] == 0) & (picture["P.Y"] == 0) & (picture["Z"] < 1e30)
    assert none.sum() > 100
    assert (picture["tau"][none] == 0).all()
    assert np.abs(picture["N.Y"][none] - 1).max() < 1e-6


def test_a_function_with_values_is_not_told_of(kage: Kage) -> None:
    assert "no value" not in kage("render", WAVES, *SMALL, "-o", "x.exr").stderr


def test_check_and_pixel(kage: Kage) -> None:
    told = " ".join(kage.good("check", WAVES, *bump("log(u)")).split())
    assert re.search(r"P has no value at 4\d(\.\d)? % of the surface", told)
    assert "nan" not in told and "march:8" not in told  # march needs bounds
    assert "P has no value at 100 %" in " ".join(kage.good("check", WAVES, *bump("1/0")).split())
    none = kage.good("pixel", WAVES, "320,400", *bump("log(u)"))
    assert "no value" in none and "nan" not in none
    assert "no value" not in kage.good("pixel", WAVES, "320,400")


WILD = """\
camera: {from: [0, 2, -3], at: [0, 0, 0], fov: 40}
image: {size: [6, 4]}
lights: {lamp: {at: [-4, 5, -2]}}
materials: {clay: {color: [0.8, 0.7, 0.6]}}
objects:
  it: {parametric: {x: u, y: 0.2*sin(3*u), z: w, u: [-1, 1], w: [-1, 1]}, material: clay, bump: {function: FUNCTION}}
"""


@pytest.mark.parametrize("function", ["0.01*sin(1e4*u)", "0.1*sin(1e20*u)"])
@pytest.mark.parametrize("surface", [("--shadow", "exact"), ("--surface", "displaced")])
def test_the_work_for_a_ray_is_bounded(kage: Kage, function: str, surface: tuple[str, str]) -> None:
    """By halvings (2 each) and tries (256 of up to 24 steps, 24 on average half of them); what they leave is told."""
    (kage.folder / "wild.yaml").write_text(WILD.replace("FUNCTION", function))
    done = kage("render", "wild.yaml", *surface, "--stats", "-o", "x.exr")
    rays, shadows, looked = (int(x) for x in re.findall(r"(?:rays|look-ups) (\d+)", done.stdout)[:3])
    assert looked < (rays + shadows) * (2 * 1024 + 256 * 24 + 24 * 64)
    told = re.search(r"[1-9]\d* hits of displaced or parametric surfaces are not confirmed", done.stderr)
    assert told or "1e20" not in function  # the other one's roots are proved
    finite(kage.folder / "x.exr")


def test_a_smooth_surface_that_proves_nothing_is_told(kage: Kage) -> None:
    wild = WILD.replace("0.2*sin(3*u)", "0.1*sin(1e20*u)").replace(", bump: {function: FUNCTION}", "")
    (kage.folder / "wild.yaml").write_text(wild)
    told = re.search(r"([1-9]\d*) hits of displaced or parametric surfaces", kage("render", "wild.yaml").stderr)
    assert told
    found = kage("render", "wild.yaml", "--stats").stdout
    assert f"displaced or parametric surfaces that are not confirmed: {told[1]}" in found
    assert "not confirmed" not in kage("render", MOEBIUS, *SMALL).stderr


HORIZON = """\
camera: {from: [0, 1.2, -5], at: [0, 1, 0], fov: 60}
image: {size: [60, 45], background: [0.1, 0.2, 0.4]}
render: {surface: displaced}
lights: {lamp: {at: [-4, 5, -2]}}
materials: {clay: {color: [0.8, 0.7, 0.6], ambient: 0.1, diffuse: 0.8}}
objects:
  ground:
    plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}
    material: clay
    bump: {function: 0.05*sin(2*u)*sin(2*w)}
"""


@needs_povray
def test_a_plane_with_a_horizon_is_a_mesh_for_povray(kage: Kage) -> None:
    """Its isosurface lets light through toward the horizon."""
    (kage.folder / "far.yaml").write_text(HORIZON)
    kage("pov", "far.yaml", "-o", "far.pov")
    text = (kage.folder / "far.pov").read_text()
    assert "mesh2" in text and "isosurface" not in text
    kage.good("render", "far.yaml", "-q", "-o", "far.exr")
    theirs, _ = povray(kage.folder / "far.pov", (60, 45))
    near = np.abs(theirs - rgb(layers(kage.folder / "far.exr"))).max(-1) < 1 / 100
    assert near.mean() > 0.97, near.mean()  # the horizon is in one row of 45, where all of it is below a pixel
    kage.good("pov", "far.yaml", "--set", "camera.at=[0, 0, -3]", "-o", "near.pov")
    assert "isosurface" in (kage.folder / "near.pov").read_text()


def test_the_shift_is_not_behind_an_eye_in_the_slab(kage: Kage) -> None:
    (kage.folder / "in.yaml").write_text(
        HORIZON.replace("[0, 1.2, -5]", "[0, 0.04, -5]").replace("surface: displaced", "shadow: 0")
    )
    for method in ("0", "1", "2+", "iter:3", "march:4", "exact"):
        kage("render", "in.yaml", "--shadow", method, "-o", "in.exr")
        picture = finite(kage.folder / "in.exr")
        hit = picture["Z"] < 1e30
        assert (picture["Z"] + picture["tau"])[hit].min() >= 0, method


@pytest.mark.parametrize("q", ['x: u, y: "0", z: "0"', "x: u-u, y: w, z: 0*u"])
def test_a_line_has_no_displaced_surface(kage: Kage, q: str) -> None:
    (kage.folder / "line.yaml").write_text(
        WILD.replace("x: u, y: 0.2*sin(3*u), z: w", q).replace("FUNCTION", "0.1*sin(u)")
    )
    done = kage("render", "line.yaml", "--shadow", "exact", "-o", "x.exr")
    assert done.returncode == 2 and "the surface has no normal to displace it along" in done.stderr, done.stderr
    done = kage("render", "line.yaml", "-o", "x.exr")
    assert done.returncode == 0
    finite(kage.folder / "x.exr")
