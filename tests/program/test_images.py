"""Pictures as a whole: what the method must give exactly, and the same bytes on every processor.

The unit tests (tests/unit/method) look at the formulas; here the whole way from the scene file to
the layers of the EXR is looked at.
"""

from __future__ import annotations

import hashlib
import platform
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from reference.references import read_exr
from tests.conftest import PROGRAM as KAGE
from tests.conftest import TOP
from tests.support.parity import rgb

SCENE = """
camera: {{from: [0, 3.9, -5.2], at: [0.25, 0.1, 0.05], fov: 36}}
image: {{size: [320, 240]}}
lights:
  lamp: {{at: [-4.5, 5.2, -2.2]}}
  sun: {{at: [3, 9, -4], color: [0.5, 0.5, 0.6]}}
materials:
  clay: {{color: [0.8, 0.7, 0.6]}}
objects:
  ground: {{{ground}, material: clay{bump}}}
  cube:
    box: {{from: [-0.6, 0.55, -0.6], to: [0.6, 1.75, 0.6]}}
    material: clay
  ball: {{sphere: {{center: [1.1, 0.9, -0.4], radius: 0.35}}, material: clay}}
"""
FLAT = "plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}"  # so (u, w) is (z, x), and n is y
ALL = ["0", "1", "2", "2+", "iter:1", "iter:3", "march:1", "march:5"]


def render(tmp_path: Path, scene: str, *options: str) -> dict[str, np.ndarray]:
    """The layers of a scene given as text."""
    path, out = tmp_path / "scene.yaml", tmp_path / "out.exr"
    path.write_text(scene)
    subprocess.run([KAGE, "render", path, "-o", out, *options], check=True, capture_output=True, timeout=120)
    return read_exr(out)


def ground(layers: dict[str, np.ndarray]) -> np.ndarray:
    """Where the picture shows the ground: its place, not above 0.2, and not the cube, which begins at 0.55."""
    return (layers["Z"] < 1e30) & (layers["P.Y"] < 0.2)


def shadows_differ(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> tuple[int, int]:
    """Pixels of ground in both with another visibility of a light; and the size of the shadow."""
    both = ground(a) & ground(b)
    differ = sum(int((both & (a[f"visibility.{k}"] != b[f"visibility.{k}"])).sum()) for k in ("lamp", "sun"))
    return differ, int((both & (a["visibility.lamp"] == 0)).sum())


@pytest.mark.parametrize("method", ["1", "2", "2+"])
def test_clamped_ramp_is_the_function(tmp_path: Path, method: str) -> None:
    """A ramp between two levels, as a map and as a function: the same normals and shifts, but for a sample's distance
    around the bends."""
    n = 256
    Image.fromarray(np.tile(np.arange(n, dtype=np.uint8), (4, 1))).save(tmp_path / "ramp.png")
    low, high, at = -0.5 + 0.5 / n, 0.5 - 0.5 / n, ["--shadow", method, "--no-guard", "--size", "160x120"]
    function = f"0.25*clamp((u-({low}))/{high - low},0,1)"
    want = render(tmp_path, SCENE.format(ground=FLAT, bump=f', bump: {{function: "{function}"}}'), *at)
    got = render(tmp_path,
                 SCENE.format(ground=FLAT,
                              bump=", bump: {map: {file: ramp.png}, scale: 0.25, zero: 0, sign: up, size: [1, 1], "
                                                          "offset: [-0.5, -0.5], wrap: clamp}"), *at)
    u, bend = want["uw.u"], 1.01 / n
    away = ground(want) & (np.abs(u - low) > bend) & (np.abs(u - high) > bend)
    level = away & ((u < low) | (u > high))
    assert level.sum() > 7000 and (away & ~level).sum() > 1000
    assert all((got[f"N.{axis}"][level] == value).all() for axis, value in (("X", 0), ("Y", 1), ("Z", 0)))
    for name in ("N.X", "N.Y", "N.Z", "height", "tau"):
        assert np.abs(got[name] - want[name])[away].max() < 1e-4, name


@pytest.mark.parametrize("method", ["0", "1", "2", "march:4"])
def test_smoothstep_is_the_polynomial(tmp_path: Path, method: str) -> None:
    """The same pictures by smoothstep and by its definition, with a and b that vary."""
    t, at = "clamp((u - 0.3*w)/(1 - 0.3*w), 0, 1)", ["--shadow", method, "--size", "160x120"]
    want = render(tmp_path, SCENE.format(ground=FLAT, bump=f', bump: {{function: "0.2*{t}^2*(3 - 2*{t})"}}'), *at)
    got = render(tmp_path, SCENE.format(ground=FLAT, bump=', bump: {function: "0.2*smoothstep(0.3*w, 1, u)"}'), *at)
    assert (np.abs(want["N.X"]) > 0.01).sum() > 1000
    for name in ("N.X", "N.Y", "N.Z", "height"):
        assert np.abs(got[name] - want[name])[ground(want)].max() < 1e-5, name
    assert shadows_differ(got, want)[0] <= 3


@pytest.mark.parametrize("method", ["march:1", "march:4"])
@pytest.mark.parametrize("function", ["0.1*sqrt(u^2+w^2)", "-0.1*sqrt(u^2+w^2)", "0.01*u^2", "0.3*exp(u)", "0.1*u"])
def test_march_without_a_bound_is_order_0(tmp_path: Path, method: str, function: str) -> None:
    """P on a plane, with no upper bound, no lower one, or neither: there is no slab to step through. And it counts as a
    fallback."""
    scene = SCENE.format(ground=FLAT, bump=f', bump: {{function: "{function}"}}')
    want = render(tmp_path, scene, "--shadow", "0", "--size", "160x120")
    got = render(tmp_path, scene, "--shadow", method, "--size", "160x120")
    assert not np.isnan(want["tau"]).any() and (want["visibility.lamp"][ground(want)] == 0).sum() > 700
    assert all(np.array_equal(got[name], want[name], equal_nan=True) for name in want)
    told = subprocess.run([KAGE, "render", tmp_path / "scene.yaml", "-o", tmp_path / "out.exr", "--shadow", method,
                           "--stats", "--size", "40x30"],
                          check=True, capture_output=True, text=True, timeout=120).stdout
    assert re.search(rf"bumped samples [1-9]\d* by method {method}, fell back \d+ \(100\.0* %\)", told), told


@pytest.mark.parametrize("method", ALL)
@pytest.mark.parametrize("height", [0.08, -0.06])
def test_constant_bump_is_the_offset_plane(tmp_path: Path, method: str, height: float) -> None:
    """P = h on a plane: every method gives the shadow on the plane moved by h."""
    bumped = render(tmp_path, SCENE.format(ground=FLAT, bump=f', bump: {{function: "{height}"}}'), "--shadow", method)
    moved = render(tmp_path, SCENE.format(ground=FLAT.replace("[0, 0, 0]", f"[0, {height}, 0]"), bump=""))
    differ, shadow = shadows_differ(bumped, moved)
    assert shadow > 3000
    assert differ <= 3  # rounding right at the shadow's edge
    none = render(tmp_path, SCENE.format(ground=FLAT, bump=f', bump: {{function: "{height}"}}'), "--shadow", "none")
    assert shadows_differ(none, moved)[0] > 100  # while the smooth plane's is elsewhere


@pytest.mark.parametrize("light", ["area: {u: [1.5, 0, 0], w: [0, 0, 1], samples: [4, 4]}", "parallel: {to: [0, 0, 0]}",
                                   "spot: {to: [0, 0, 0], radius: 40, falloff: 50}"])
def test_constant_bump_under_other_lights(tmp_path: Path, light: str) -> None:
    """Every shadow ray begins at the shifted origin, those to each sample of an area, too."""

    def with_light(**parts: str) -> str:
        return SCENE.format(**parts).replace("lamp: {at: [-4.5, 5.2, -2.2]}",
                                             f"lamp: {{at: [-4.5, 5.2, -2.2], {light}}}")

    bump = ', bump: {function: "0.08"}'
    assert light in with_light(ground=FLAT, bump=bump)
    bumped = render(tmp_path, with_light(ground=FLAT, bump=bump), "--shadow", "2")
    moved = render(tmp_path, with_light(ground=FLAT.replace("[0, 0, 0]", "[0, 0.08, 0]"), bump=""))
    differ, shadow = shadows_differ(bumped, moved)
    assert shadow > 2000
    assert differ <= (30 if "area" in light else 3)
    none = render(tmp_path, with_light(ground=FLAT, bump=bump), "--shadow", "none")
    assert shadows_differ(none, moved)[0] > 100
    if "area" in light:
        assert set(np.unique(bumped["visibility.lamp"] * 16) % 1) == {0}
        assert len(np.unique(bumped["visibility.lamp"])) == 17


@pytest.mark.parametrize("method, exact", [("1", True), ("2", True), ("2+", True), ("0", False)])
def test_linear_bump_is_the_tilted_plane(tmp_path: Path, method: str, exact: bool) -> None:
    """P linear: from order 1 on the shadow is that on the tilted plane, and n' is its normal."""
    bump = ', bump: {function: "0.02 + 0.05*u - 0.04*w"}'
    tilted = "plane: {origin: [0, 0.02, 0], u: [0, 0.05, 1], w: [1, -0.04, 0]}"
    bumped = render(tmp_path, SCENE.format(ground=FLAT, bump=bump), "--shadow", method)
    truth = render(tmp_path, SCENE.format(ground=tilted, bump=""))
    differ, shadow = shadows_differ(bumped, truth)
    assert shadow > 3000
    assert differ <= 3 if exact else differ > 20
    both = ground(bumped) & ground(truth)
    for axis in "XYZ":
        assert np.abs(bumped[f"N.{axis}"] - truth[f"N.{axis}"])[both].max() < 1e-6


def test_no_bump_at_all(tmp_path: Path) -> None:
    """P = 0: every method, guarded or bare, gives the same bytes, layers included but for the order's."""
    scene = SCENE.format(ground=FLAT, bump=', bump: {function: "0*u"}')
    want = render(tmp_path, scene, "--shadow", "none")
    for method in ALL:
        for guard in ([], ["--no-guard"]):
            got = render(tmp_path, scene, "--shadow", method, *guard)
            for name in want:
                if name != "order":
                    assert got[name].tobytes() == want[name].tobytes() or (
                        name == "tau" and not got[name].any()
                    ), (method, guard, name)


def test_layers_without_lights(tmp_path: Path) -> None:
    """A scene without lights has its layers, too: empty where nothing is met, and where nothing is bumped."""
    dark = SCENE.format(ground="sphere: {center: [0, 0, 0], radius: 0.6}", bump=', bump: {function: "0.05"}')
    dark = dark[: dark.index("lights:")] + "lights: {}\n" + dark[dark.index("materials:") :]
    got = render(tmp_path, dark)
    nothing = got["Z"] == np.float32(1e30)
    assert 1000 < nothing.sum() < nothing.size - 1000
    for name in ("P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z", "uw.u", "uw.w", "height", "tau"):
        assert not got[name][nothing].any(), name
    assert (got["order"][nothing] == -1).all()
    assert set(np.unique(got["height"])) == {0, np.float32(0.05)}
    assert not any(name.startswith("visibility") for name in got)


# ---- adaptive antialiasing ----

LIT = """
camera: {{from: [0, 3.9, -5.2], at: [0.25, 0.1, 0.05], {view}}}
image: {{size: [150, 111], background: [0.1, 0.2, 0.4]}}
lights:
  lamp: {{at: [-4.5, 5.2, -2.2], area: {{u: [1, 0, 0], w: [0, 0, 1], samples: [3, 2]}}}}
  sun: {{at: [3, 9, -4], color: [0.5, 0.5, 0.6]}}
  low: {{at: [9, 4, -4], color: [0.3, 0.2, 0.1], parallel: {{to: [0, 0, 0]}}, fade: {{distance: 9, power: 1.7}}}}
  spot: {{at: [1, 4, -3], color: [0.2, 0.5, 0.3], spot: {{to: [0, 0, 0], radius: 8, falloff: 14, tightness: 3.5}}}}
materials:
  clay: {{color: [0.8, 0.7, 0.6], phong: 0.4, specular: 0.3}}
  tiles: {{color: {{checker: {{even: [0.9, 0.9, 0.9], odd: [0.2, 0.1, 0.1], size: [0.5, 0.5]}}}}}}
objects:
  ground: {{plane: {{origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}}, material: tiles,
    bump: {{function: "0.05*sin(7*u)*cos(5*w)"}}}}
  ball: {{sphere: {{center: [0.5, 0.9, -0.4], radius: 0.6}}, material: clay}}
"""


def displayed(layers: dict[str, np.ndarray]) -> np.ndarray:
    linear = np.clip(np.stack([layers[name] for name in "RGB"], axis=-1).astype(float), 0, 1)
    return np.rint(65535 * np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055))


@pytest.mark.parametrize("view", ["fov: 36", "width: 5"])
@pytest.mark.parametrize(("aa", "threshold"), [("3", 0.1), ("2", 0.02), ("4", 0), ("5", 3)])
def test_adaptive(tmp_path: Path, view: str, aa: str, threshold: float) -> None:
    """Pixels that differ from a neighbour are those of --aa N to the last bit, all others those of --aa 1."""
    scene = LIT.format(view=view)
    one, all_of, got = render(tmp_path, scene), render(tmp_path, scene, "--aa", aa), render(
        tmp_path, scene, "--aa", aa, "--aa-threshold", str(threshold))
    code = displayed(one)
    marked = np.zeros(code.shape[:2], bool)
    across, down = (np.abs(np.diff(code, axis=axis)).sum(axis=-1) > threshold * 65535 for axis in (1, 0))
    marked[:, 1:] |= across
    marked[:, :-1] |= across
    marked[1:] |= down
    marked[:-1] |= down
    assert (0.01 < marked.mean() < 0.9) if threshold and threshold < 3 else threshold == 0 or not marked.any()
    for name in got:
        want = np.where(marked, all_of[name],
                        one[name]) if name in ("R", "G", "B") or name.startswith("visibility") else one[name]
        assert got[name].tobytes() == want.tobytes(), name
    for options in (["--threads", "1"], ["--threads", "5"]):
        again = render(tmp_path, scene, "--aa", aa, "--aa-threshold", str(threshold), *options)
        assert all(again[name].tobytes() == got[name].tobytes() for name in got)
    for x0, y0, x1, y1 in ((20, 10, 90, 70), (0, 50, 37, 111), (149, 0, 150, 1)):
        part = render(tmp_path, scene, "--aa", aa, "--aa-threshold", str(threshold), "--crop", f"{x0},{y0},{x1},{y1}")
        assert all(part[name].tobytes() == got[name][y0:y1, x0:x1].tobytes() for name in got)


# ---- highlights ----


SHINY = """
camera: {{from: {eye}, at: {at}, {lens}}}
image: {{size: [41, 31], background: [0, 0, 0]}}
lights:
  lamp: {{at: {lamp}}}
materials:
  clay: {{color: [0.8, 0.7, 0.6], specular: 0.5, roughness: {roughness}}}
objects:
  {thing}
"""


@pytest.mark.parametrize("roughness", ["0.05", "0.001", "1e-6"])
@pytest.mark.parametrize("bump", ["", ", bump: {function: '0.05*sin(20*u)*sin(9*w)'}"], ids=["smooth", "bumped"])
def test_a_light_right_behind_gives_no_highlight(tmp_path: Path, bump: str, roughness: str) -> None:
    """It is on the viewing ray through the middle pixel, so that the half-way vector has no length."""
    for k in range(8):
        eye, at = np.array([-2.81 + 0.6 * k, 2.66 - 0.53 * k, -5]), np.array([0.29, -0.04, 0.2])
        lamp = (2 * at - eye).tolist()
        scene = SHINY.format(eye=eye.tolist(), at=at.tolist(), lens="fov: 40", lamp=lamp, roughness=roughness,
                             thing=f"ball: {{sphere: {{center: [0, 0, 0], radius: 1}}, material: clay{bump}}}")
        color = rgb(render(tmp_path, scene))
        assert np.allclose(color[15, 20], [0.08, 0.07, 0.06])
        assert np.isfinite(color).all()


def test_the_sharpest_highlight_is_finite(tmp_path: Path) -> None:
    """All of a plane in the middle of its highlight: the cosine is 1 to the last digits."""
    for x, y, z in ((5, 1, 2), (1, 1, 4), (3, 1, 2), (1, 2, 3)):
        scene = SHINY.format(eye=[x, y, -z], at=[0, 0, 0], lens="width: 4",
                             lamp=f"[{-x}, {y}, {z}], parallel: {{to: [0, 0, 0]}}", roughness="1e-6",
                             thing="ground: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: clay}")
        color = rgb(render(tmp_path, scene))
        assert np.isfinite(color).all()
        assert color.max() < 2


# ---- secondary rays ----

VANITY = """
camera: {{from: [0.3, 0.6, -2.2], at: [0, 0.2, 0], fov: 50}}
image: {{size: [200, 150], background: [0.2, 0.3, 0.5]}}
lights:
  lamp: {{at: [-2.5, 4, {near}3]}}
  area: {{at: [2, 3, {near}2], color: [0.3, 0.2, 0.4], area: {{u: [1, 0, 0], w: [0, 0.5, 0], samples: [2, 2]}}}}
materials:
  mirror: {{color: [0, 0, 0], ambient: 0, diffuse: 0, reflection: 1}}
  clay: {{color: [0.8, 0.7, 0.6], phong: 0.3}}
  red: {{color: [0.8, 0.2, 0.1], specular: 0.4}}
objects:
  {mirror}
  floor: {{plane: {{origin: [0, -1, 0], {axes}}}, material: clay, bump: {{function: "{bump}"}}}}
  ball: {{sphere: {{center: [0.4, 0, {near}4.5], radius: 0.8}}, material: red,
    bump: {{function: "0.05*cos(5*u)*sin(7*w)*sin(w)"}}}}
  block: {{box: {{from: [-1.6, 0.2, {near}5], to: [-0.8, 1.2, {near}4]}}, material: clay}}
"""


def share_close(a: dict[str, np.ndarray], b: dict[str, np.ndarray], tolerance: float = 2e-4) -> float:
    return float((np.abs(rgb(a) - rgb(b)).max(axis=-1) < tolerance).mean())


@pytest.mark.parametrize("options",
                         [["--shadow", "none"], ["--shadow", "2"], ["--shadow", "march:4"], ["--shadow", "exact"],
                          ["--surface", "displaced"], ["--shade", "shifted", "--bump-shadow", "exact"],
                          ["--shadow", "march:8", "--shade", "shifted", "--bump-shadow", "march:8"]],
                         ids=lambda o: o[-1])
def test_mirror_is_the_mirrored_scene(tmp_path: Path, options: list[str]) -> None:
    """What stands behind the eye, seen in a mirror, is that scene mirrored: every method works on reflected rays,
    too."""
    mirror = "mirror: {plane: {origin: [0, 0, 0], u: [1, 0, 0], w: [0, -1, 0]}, material: mirror}"
    bump = "0.05*sin(5*{0})*cos(3*{1})"
    seen = render(tmp_path, VANITY.format(near="-", mirror=mirror, axes="u: [0, 0, 1], w: [1, 0, 0]",
                                          bump=bump.format("u", "w")), *options)
    want = render(tmp_path, VANITY.format(near="", mirror="", axes="u: [1, 0, 0], w: [0, 0, -1]",
                                          bump=bump.format("w", "u")), *options)
    assert share_close(seen, want) > 0.998
    assert rgb(want).std() > 0.1


GLASS = """
camera: {{from: [0.3, 1.9, -4.2], at: [0, 0.7, 0], fov: 40}}
image: {{size: [160, 120], background: [1, 1, 1]}}
render: {{depth: {depth}}}
lights: {lights}
materials:
  clay: {{color: [0.8, 0.7, 0.6], ambient: 0.2}}
  tiles: {{color: {{checker: {{even: [0.9, 0.9, 0.8], odd: [0.1, 0.1, 0.3], size: [0.5, 0.5]}}}}}}
  pane: {{color: [0.9, 0.3, 0.2], filter: 0.5, transmit: 0.2, reflection: 0.2}}
  glass: {{color: [1, 1, 1], ambient: 0, diffuse: 0, {glass}}}
objects:
  {objects}
  ball: {{{shape}, material: glass{bump}}}
"""
LAMP = "{lamp: {at: [-4.5, 5.2, -2.2]}}"
ROUND = "sphere: {center: [0, 1, 0], radius: 0.8}"
TILES = "floor: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: tiles}"
BUMP = ", bump: {function: '0.04*sin(9*u)*sin(8*w)*sin(w)^2'}"
PANES = """floor: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: tiles,
    bump: {function: "0.05*sin(7*u)*cos(5*w)"}}
  left: {rectangle: {origin: [-1.4, 2, -0.5], u: [1, 0, 0.3], w: [0, -1.6, 0.1]}, material: pane}
  right: {box: {from: [0.9, 0.1, -0.6], to: [1.6, 1.3, 0.6]}, material: pane}
  back: {sphere: {center: [-0.9, 0.5, 1.2], radius: 0.5}, material: clay}"""


@pytest.mark.parametrize("shape", [ROUND, "box: {from: [-0.6, 0.3, -0.5], to: [0.6, 1.5, 0.5]}",
                                   "rectangle: {origin: [-1, 0.4, 0.2], u: [2, 0.4, 0.3], w: [0.2, 1.2, 0.4]}"])
@pytest.mark.parametrize("bump", ["", BUMP])
def test_clear_without_refraction_is_not_there(tmp_path: Path, shape: str, bump: str) -> None:
    """transmit 1, ior 1: neither seen nor a shadow, at any depth from 2 on."""
    scene = {"depth": 2, "lights": LAMP, "objects": TILES, "shape": shape, "bump": bump}
    seen = render(tmp_path, GLASS.format(glass="transmit: 1", **scene))
    without = render(tmp_path, GLASS.format(glass="transmit: 1",
                                            **{**scene, "shape": "sphere: {center: [0, 0, -20], radius: 0.1}"}))
    assert share_close(seen, without) > 0.9995
    assert share_close(render(tmp_path, GLASS.format(glass="ior: 1", **scene)), without) < 0.95


@pytest.mark.parametrize("bump", ["", BUMP])
@pytest.mark.parametrize("ior", [0.8, 1, 1.5])
def test_energy(tmp_path: Path, ior: float, bump: str) -> None:
    """Half mirrored, half let through, in a white world: white, but for what is beyond the depth, and never
    brighter."""
    scene = {"lights": "{}", "objects": "", "shape": ROUND, "bump": bump,
             "glass": f"transmit: 0.5, reflection: 0.5, ior: {ior}"}
    before = np.zeros((120, 160, 3))
    for depth in (1, 2, 5, 24):
        now = rgb(render(tmp_path, GLASS.format(depth=depth, **scene)))
        # total reflection is all of the light, as in POV-Ray, whatever the material lets through
        if not bump and ior >= 1:
            assert now.max() < 1 + 1e-5
        assert (now >= before - 1e-5).all()
        before = now
    if not bump and ior >= 1:
        assert before.min() > 1 - 1e-5
    assert render(tmp_path, GLASS.format(depth=1, **scene))["R"].min() == 0


def test_depth(tmp_path: Path) -> None:
    """Between two mirrors that glow a little: a geometric series with as many terms as the depth."""
    scene = """
camera: {from: [0, 0, 0], at: [0.3, 0.2, 1], fov: 60}
image: {size: [40, 30], background: [9, 9, 9]}
lights: {}
materials:
  mirror: {ambient: 0.1, reflection: [0.5, 0.9, 1]}
objects:
  front: {plane: {origin: [0, 0, 2], u: [1, 0, 0], w: [0, 1, 0]}, material: mirror}
  back: {plane: {origin: [0, 0, -2], u: [1, 0, 0], w: [0, 1, 0]}, material: mirror}
"""
    for depth in (1, 2, 3, 8, 32):
        got = rgb(render(tmp_path, scene, "--set", f"render.depth={depth}"))
        want = [0.1 * sum(r**k for k in range(depth)) for r in (0.5, 0.9, 1)]
        assert np.abs(got - want).max() < 1e-5
    assert render(tmp_path, scene)["G"].max() < 0.1 * sum(0.9**k for k in range(5)) + 1e-5  # the default is 5


@pytest.mark.parametrize("method", ALL)
@pytest.mark.parametrize("material", ["reflection: 0.9", "transmit: 0.8, ior: 1.33"])
def test_constant_bump_is_the_offset_mirror(tmp_path: Path, method: str, material: str) -> None:
    """P = h: reflected and refracted rays start from the plane moved by h, so that what they show is moved, too."""
    scene = GLASS.format(depth=4, lights="{}", glass=material, bump="BUMP",
                         shape="plane: {origin: [0, HEIGHT, 0], u: [0, 0, 1], w: [1, 0, 0]}",
                         objects="cube: {box: {from: [-0.6, 0.3, 0.1], to: [0.5, 1.4, 1.1]}, material: clay}\n"
                         "  bed: {plane: {origin: [0, -0.5, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: tiles}")
    def show(height: float, bump: str, *options: str) -> dict[str, np.ndarray]:
        return render(tmp_path, scene.replace("HEIGHT", str(height)).replace("BUMP", bump), *options)

    for height in (0.1, -0.08):
        moved = show(height, "")
        bumped = show(0, f", bump: {{function: '{height}'}}", "--shadow", method)
        none = show(0, f", bump: {{function: '{height}'}}", "--shadow", "none")
        assert share_close(bumped, moved) > 0.998
        assert share_close(none, moved) < 0.985


def test_secondary_layers_and_threads(tmp_path: Path) -> None:
    """Layers are those of the first hit; pictures do not depend on threads, crops or the layers."""
    scene = GLASS.format(depth=6, lights=LAMP.replace("}}", ", area: {u: [1, 0, 0], w: [0, 0, 1], samples: [2, 2]}}, "
                                                            "sun: {at: [3, 9, -4]}}"),
                         glass="filter: 0.8, reflection: 0.15, ior: 1.5, phong: 0.5", bump=BUMP, shape=ROUND,
                         objects=PANES)
    for options in ([], ["--shadow", "2+"], ["--surface", "displaced", "--size", "40x30"],
                    ["--aa", "3", "--aa-threshold", "0.1"]):
        got = render(tmp_path, scene, *options)
        plain = render(tmp_path, scene, *options, "--set", "render.depth=1")
        for name in got:
            assert name in "RGB" or got[name].tobytes() == plain[name].tobytes() or "--aa" in options, name
        for more in (["--threads", "1"], ["--threads", "2"], ["--threads", "7"]):
            again = render(tmp_path, scene, *options, *more)
            assert all(again[name].tobytes() == got[name].tobytes() for name in got)
        part = render(tmp_path, scene, *options, "--crop", "17,5,39,29")
        assert all(part[name].tobytes() == got[name][5:29, 17:39].tobytes() for name in got)


def test_visibility_behind_a_filter(tmp_path: Path) -> None:
    """It is the mean of red, green and blue that arrive."""
    scene = GLASS.format(depth=2, lights=LAMP, glass="filter: 0.5, transmit: 0.2", bump="", objects=TILES,
                         shape="rectangle: {origin: [-1, 1.5, -0.6], u: [1.2, 0, 0], w: [0, 0, 1]}")
    colored = scene.replace("[1, 1, 1], ambient", "[0.8, 0.4, 0], ambient")
    got = np.unique(render(tmp_path, colored)["visibility.lamp"].round(5))
    assert [x for x in got if x not in (0, 1)] == [pytest.approx((0.6 + 0.4 + 0.2) / 3, abs=1e-5)]


FUNCTION = ', bump: {function: "0.05*sin(7*u)*cos(5*w) + 0.02*noise(3*u, 3*w) + 0.01*exp(-u^2)*tanh(w)"}'


#: Shapes that turn about an axis, bumped and not; `exact` also takes the stages of true displacement.
TURNED = """
  ring: {{torus: {{center: [-1.4, 0.5, 0.4], axis: [0.2, 1, -0.3], major: 0.6, minor: 0.25}}, material: clay{bump}}}
  drum: {{cylinder: {{from: [1, 0, 0.9], to: [1.2, 0.9, 0.8], radius: 0.4}}, material: clay{bump}}}
  pipe: {{cylinder: {{from: [-0.9, 0.3, -1.2], to: [-0.2, 0.4, -1.1], radius: 0.3, open: true}}, material: clay{bump}}}
  bell: {{cone: {{from: [0, 0, 1.2], from_radius: 0.5, to: [0, 1, 1.2], to_radius: 0.3}}, material: clay{bump}}}
  hat: {{cone: {{from: [0.4, 0, -1.3], from_radius: 0.4, to: [0.4, 0.7, -1.2], to_radius: 0, open: true}},
    material: clay}}
  plate: {{disc: {{center: [1.3, 0.3, -1.1], normal: [0.1, 1, -0.4], radius: 0.4}}, material: clay{bump}}}
"""


def hashes(kage: Path, tmp_path: Path) -> dict[str, str]:
    """A digest of the pictures and all layers of scenes that use every stage."""
    (tmp_path / "function.yaml").write_text(SCENE.format(ground=FLAT, bump=FUNCTION))
    (tmp_path / "lit.yaml").write_text(LIT.format(view="width: 5"))
    (tmp_path / "glass.yaml").write_text(GLASS.format(depth=6, lights=LAMP.replace("}}", "}, sun: {at: [3, 9, -4], "
                                                                                         "parallel: {to: [0, 0, 0]}}}"),
        glass="filter: 0.8, reflection: 0.15, ior: 1.5, phong: 0.5, specular: 0.2", bump=BUMP, shape=ROUND,
        objects=PANES.replace("tiles", "glass")))
    (tmp_path / "image.yaml").write_text(
        SCENE.format(ground=FLAT, bump="").replace("{color: [0.8, 0.7, 0.6]}",
                                                   "{color: {image: {file: color.png, size: [1.3, 0.7]}}}"))
    columns, rows = np.meshgrid(np.arange(31), np.arange(17))
    Image.fromarray(np.stack([columns * 8, rows * 15, columns * rows % 251],
                             axis=-1).astype(np.uint8)).save(tmp_path / "color.png")
    turned = TURNED.format(bump=', bump: {function: "0.03*sin(7*u)*cos(5*w)"}')
    (tmp_path / "turned.yaml").write_text(SCENE.format(ground=FLAT, bump="") + turned.lstrip("\n"))
    result = {}
    made = (tmp_path / f"{name}.yaml" for name in ("function", "lit", "glass", "image", "turned"))
    for scene in [*sorted((TOP / "scenes").glob("*.yaml")), *made]:
        bounded = scene.parent != tmp_path or scene.stem == "turned"
        for options in [*(f"--shadow {method}" for method in ("0", "2+", "march:4", "iter:3", "auto")), "--relief",
                        "--shade shifted --bump-shadow horizon", *(["--shadow exact"] if bounded else [])]:
            out = [tmp_path / f"{scene.stem}.exr", tmp_path / f"{scene.stem}.png"]
            subprocess.run(
                [kage, "render", scene, *options.split(), "--size", "201x149", "-o", out[0], "-o", out[1]],
                check=True,
                capture_output=True,
                timeout=300,
            )
            for path in out:
                result[f"{scene.stem} {options} {path.suffix}"] = hashlib.sha256(path.read_bytes()).hexdigest()
    return result


def levels() -> list[str]:
    """The lowest and the highest x86-64 level that this processor runs, without the clones: each builds the whole
    program for itself."""
    flags = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    if " avx512vl " in flags:
        return ["x86-64", "x86-64-v4"]
    return ["x86-64", "x86-64-v3"] if " avx2 " in flags and " fma " in flags else ["x86-64"]


@pytest.mark.slow
@pytest.mark.skipif(platform.machine() != "x86_64", reason="levels of x86-64 only")
def test_same_bytes_on_each_level(tmp_path: Path) -> None:
    """The clones choose by processor; programs built for one level alone must give the same bytes."""
    want = hashes(KAGE, tmp_path)
    for level in levels():
        build = TOP / "build" / "levels" / level
        flags = f"OPTIMISE=-O3 -fno-math-errno -fno-trapping-math -ffp-contract=off -march={level}"
        subprocess.run(
            ["make", "-s", "-j2", f"BUILD={build}", "CLONES=no", flags, f"{build}/kage"],
            cwd=TOP,
            check=True,
            capture_output=True,
            timeout=600,
        )
        assert hashes(build / "kage", tmp_path) == want, level
