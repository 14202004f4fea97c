"""--shade shifted: by the exact shift a picture is that of the displaced surface, on every kind of surface.

The truth is `--surface displaced`. Only colours within the silhouette can agree, so pixels are compared where both
pictures show the object, two pixels from where either ends: there the smooth hit is on another part of the surface.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.conftest import TOP, Kage
from tests.support import models
from tests.support.parity import layers

HEAD = """\
camera: {from: [0.3, 2.9, -5.2], at: [0, 0.5, 0], fov: 40}
image: {size: [160, 120], background: [0.05, 0.1, 0.2]}
lights:
  lamp: {at: [-2.5, 6.2, -4.2], color: [1.1, 1.08, 1], fade: {distance: 9, power: 2}}
materials:
  clay: {color: {checker: {even: [0.82, 0.72, 0.58], odd: [0.5, 0.6, 0.7], size: SIZE}}, ambient: 0.1, diffuse: 0.8,
         phong: 0.2, phong_size: 12}
objects:
  it:
    SHAPE
    material: clay
    bump: {function: "FUNCTION"}
"""

#: shape, size of the checker's fields in (u,w), bump
SHAPES = {
    "plane": ("plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}", "[0.4, 0.4]", "0.06*sin(5*u)*cos(4*w)"),
    "rectangle": ("rectangle: {origin: [-1.5, 0.3, 1.5], u: [3, 0.2, 0], w: [0, 0, -3]}", "[0.2, 0.2]",
                  "0.06*sin(15*u)*cos(12*w)"),
    "disc": ("disc: {center: [0, 0.4, 0], normal: [0.1, 1, 0], radius: 1.6}", "[0.4, 0.4]", "0.06*sin(5*u)*cos(4*w)"),
    "box": ("box: {from: [-0.9, 0, -0.9], to: [0.9, 1.2, 0.9]}", "[0.25, 0.25]", "0.04*sin(4*pi*u)*sin(4*pi*w)"),
    "sphere": ("sphere: {center: [0, 0.8, 0], radius: 1.2}", "[0.5, 0.5]", "0.05*sin(8*u)*sin(7*w)"),
    "cylinder": ("cylinder: {from: [0, 0, 0], to: [0.2, 1.6, 0], radius: 0.9, open: true}", "[0.5, 0.4]",
                 "0.05*sin(8*u)*cos(7*w)"),
    "cone": ("cone: {from: [0, 0, 0], from_radius: 1.3, to: [0, 1.6, 0], to_radius: 0.4, open: true}", "[0.5, 0.4]",
             "0.05*sin(8*u)*cos(7*w)"),
    "torus": ("torus: {center: [0, 0.5, 0], axis: [0, 1, 0], major: 1.2, minor: 0.5}", "[0.5, 0.5]",
              "0.03*sin(12*u)*cos(7*w)"),
    "ellipsoid": ("ellipsoid: {center: [0, 0.7, 0], radii: [1.5, 0.8, 1.1]}", "[0.5, 0.5]", "0.04*sin(8*u)*sin(7*w)"),
    "stretched sphere": ("sphere: {center: [0, 0, 0], radius: 1}\n    transform: [{scale: [1.5, 0.8, 1]}, "
                         "{translate: [0, 0.7, 0]}]", "[0.5, 0.5]", "0.04*sin(8*u)*sin(7*w)"),
    "turned torus": ("torus: {center: [0, 0, 0], axis: [0, 1, 0], major: 1.2, minor: 0.5}\n    transform: "
                     "[{scale: 0.9}, {rotate: [20, 30, 0]}, {translate: [0, 0.6, 0]}]", "[0.5, 0.5]",
                     "0.03*sin(12*u)*cos(7*w)"),
    "parametric": ('parametric: {x: "u", y: "0.4 + 0.2*sin(3*u)*cos(2*w)", z: "w", u: [-1.5, 1.5], w: [-1.5, 1.5]}',
                   "[0.4, 0.4]", "0.05*sin(7*u)*cos(6*w)"),
    "patches": (f"patches: {{file: {TOP / 'scenes/data/teapot.txt'}}}\n    transform: [{{scale: 0.6}}, "
                "{rotate: [0, 20, 0]}]", "[0.5, 0.5]", "0.01*sin(2*pi*u)*sin(2*pi*w)"),
    "mesh": ("mesh: {file: ball.obj}\n    transform: [{scale: 1.2}, {translate: [0, 0.8, 0]}]", "[0.1, 0.1]",
             "0.03*sin(12*pi*u)*sin(6*pi*w)"),
}


def picture(kage: Kage, path: Path, *options: str) -> dict[str, np.ndarray]:
    out = kage.folder / "out.exr"
    kage.good("render", path, *options, "--quiet", "-o", out)
    return layers(out)


def inside(mask: np.ndarray) -> np.ndarray:
    """Without two pixels along its edge."""
    for _ in range(2):
        edge = np.pad(mask, 1)
        mask = mask & edge[2:, 1:-1] & edge[:-2, 1:-1] & edge[1:-1, 2:] & edge[1:-1, :-2]
    return mask


def scene(kage: Kage, name: str) -> Path:
    models.obj(kage.folder / "ball.obj", models.ball(48, 24))
    shape, size, function = SHAPES[name]
    path = kage.folder / "shade.yaml"
    path.write_text(HEAD.replace("SHAPE", shape).replace("SIZE", size).replace("FUNCTION", function))
    return path


def compare(kage: Kage, name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """On the pixels that are compared: the distance in (u,w) from the truth, and the largest difference of a colour by
    --shade smooth and by --shade shifted."""
    path = scene(kage, name)
    truth, smooth, shifted = (picture(kage, path, "--no-self-shadow", *options) for options in (
        ("--surface", "displaced"), ("--shadow", "exact"), ("--shadow", "exact", "--shade", "shifted")))
    pixels = inside((truth["order"] == 6) & (shifted["order"] == 6))
    assert pixels.sum() > 1000
    off = np.hypot(shifted["uw.u"] - truth["uw.u"], shifted["uw.w"] - truth["uw.w"])
    colors = [np.max([np.abs(got[c] - truth[c]) for c in "RGB"], axis=0) for got in (smooth, shifted)]
    return off[pixels], colors[0][pixels], colors[1][pixels]


@pytest.mark.parametrize("name", SHAPES)
def test_shifted_is_shaded_where_the_truth_is(kage: Kage, name: str) -> None:
    """To float's rounding on every pixel; patches have creases, where the closest point jumps, and a mesh's displaced
    surface ends at each triangle's prism."""
    off, smooth, shifted = compare(kage, name)
    near = (off < 2e-5).mean()
    far = {"patches": 0.002, "mesh": 0.002}.get(name, 0)
    print(f"{name}: {100 * (1 - near):.3f} % elsewhere, largest {off.max():.1e}")
    assert near >= 1 - far
    # What is left lies near the terminator: bumps there see a light that is behind the smooth surface, and stay dark.
    wrong, before = 100 * (shifted > 8 / 255).mean(), 100 * (smooth > 8 / 255).mean()
    print(f"{name}: off by more than 8/255: smooth {before:.2f} %, shifted {wrong:.2f} %")
    assert wrong <= 3 and wrong < before / 4


def test_no_lane_is_lost(kage: Kage) -> None:
    """Grazing rays, and an order 0 whose place is behind the eye: every value is a number."""
    path = scene(kage, "plane")
    low = ("--set", "camera.from=[0, 0.02, -3]", "--set", "camera.at=[0, 0.01, 0]")
    for method in ("0", "1", "2", "2+", "iter:4", "march:8", "exact"):
        for name, plane in picture(kage, path, "--shadow", method, "--shade", "shifted", *low).items():
            assert not np.isnan(plane).any(), (method, name)


def test_mirrors_show_shifted_places(kage: Kage) -> None:
    """In a mirror a picture by the exact shift is that of the displaced surface, too."""
    path = scene(kage, "plane")
    path.write_text(path.read_text() + "  mirror: {rectangle: {origin: [-2, 0.1, 2], u: [4, 0, 0], w: [0, 3, 0]}, "
                    "material: silver}\n")
    path.write_text(path.read_text().replace("objects:", "  silver: {color: [0, 0, 0], reflection: [0.9, 0.9, 0.9]}\n"
                                                         "objects:"))
    truth, smooth, shifted = (picture(kage, path, "--no-self-shadow", *options) for options in (
        ("--surface", "displaced"), ("--shadow", "exact"), ("--shadow", "exact", "--shade", "shifted")))
    glass = inside(truth["P.Z"] > 1.999)
    assert glass.sum() > 500
    wrong = [100 * (np.max([np.abs(got[c] - truth[c]) for c in "RGB"], axis=0)[glass] > 8 / 255).mean()
             for got in (smooth, shifted)]
    print(f"off by more than 8/255: smooth {wrong[0]:.2f} %, shifted {wrong[1]:.2f} %")
    assert wrong[1] < 0.5 and wrong[0] > 5


def test_smooth_is_the_default(kage: Kage) -> None:
    path = scene(kage, "sphere")
    default, smooth = picture(kage, path), picture(kage, path, "--shade", "smooth")
    assert all((default[name] == smooth[name]).all() for name in default)


def test_threads_change_nothing(kage: Kage) -> None:
    path, out = scene(kage, "torus"), kage.folder
    for threads in ("1", "3"):
        kage.good("render", path, "--relief", "--threads", threads, "--quiet", "-o", out / f"{threads}.exr")
    assert (out / "1.exr").read_bytes() == (out / "3.exr").read_bytes()
