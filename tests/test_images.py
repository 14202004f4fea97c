"""Pictures as a whole: what the method must give exactly, and the same bytes on every processor.

The unit tests (tests/test_shift.c and its neighbours) look at the formulas; here the whole way from the scene file to the
layers of the EXR is looked at.
"""

from __future__ import annotations

import hashlib
import os
import platform
import subprocess
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from PIL import Image

TOP = Path(__file__).resolve().parent.parent
KAGE = Path(os.environ.get("KAGE", TOP / "build" / "float" / "kage"))

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
    with OpenEXR.File(str(out), separate_channels=True) as f:
        return {name: np.array(c.pixels) for name, c in f.channels().items()}


def ground(layers: dict[str, np.ndarray]) -> np.ndarray:
    """Where the picture shows the ground: its place, not above 0.2, and not the cube, which begins at 0.55."""
    return np.isfinite(layers["Z"]) & (layers["P.Y"] < 0.2)


def shadows_differ(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> tuple[int, int]:
    """Pixels of ground in both with another visibility of a light; and the size of the shadow."""
    both = ground(a) & ground(b)
    differ = sum(int((both & (a[f"visibility.{k}"] != b[f"visibility.{k}"])).sum()) for k in ("lamp", "sun"))
    return differ, int((both & (a["visibility.lamp"] == 0)).sum())


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
        return SCENE.format(**parts).replace("lamp: {at: [-4.5, 5.2, -2.2]}", f"lamp: {{at: [-4.5, 5.2, -2.2], {light}}}")

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
        assert set(np.unique(bumped["visibility.lamp"] * 16) % 1) == {0} and len(np.unique(bumped["visibility.lamp"])) == 17


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
    nothing = ~np.isfinite(got["Z"])
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
  ground: {{plane: {{origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}}, material: tiles, bump: {{function: "0.05*sin(7*u)*cos(5*w)"}}}}
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
        want = np.where(marked, all_of[name], one[name]) if name in ("R", "G", "B") or name.startswith("visibility") else one[name]
        assert got[name].tobytes() == want.tobytes(), name
    for options in (["--threads", "1"], ["--threads", "5"]):
        again = render(tmp_path, scene, "--aa", aa, "--aa-threshold", str(threshold), *options)
        assert all(again[name].tobytes() == got[name].tobytes() for name in got)
    for x0, y0, x1, y1 in ((20, 10, 90, 70), (0, 50, 37, 111), (149, 0, 150, 1)):
        part = render(tmp_path, scene, "--aa", aa, "--aa-threshold", str(threshold), "--crop", f"{x0},{y0},{x1},{y1}")
        assert all(part[name].tobytes() == got[name][y0:y1, x0:x1].tobytes() for name in got)


FUNCTION = ', bump: {function: "0.05*sin(7*u)*cos(5*w) + 0.02*noise(3*u, 3*w) + 0.01*exp(-u^2)*tanh(w)"}'


#: Shapes that turn about an axis, bumped and not; `exact` also takes the stages of true displacement.
TURNED = """
  ring: {{torus: {{center: [-1.4, 0.5, 0.4], axis: [0.2, 1, -0.3], major: 0.6, minor: 0.25}}, material: clay{bump}}}
  drum: {{cylinder: {{from: [1, 0, 0.9], to: [1.2, 0.9, 0.8], radius: 0.4}}, material: clay{bump}}}
  pipe: {{cylinder: {{from: [-0.9, 0.3, -1.2], to: [-0.2, 0.4, -1.1], radius: 0.3, open: true}}, material: clay{bump}}}
  bell: {{cone: {{from: [0, 0, 1.2], from_radius: 0.5, to: [0, 1, 1.2], to_radius: 0.3}}, material: clay{bump}}}
  hat: {{cone: {{from: [0.4, 0, -1.3], from_radius: 0.4, to: [0.4, 0.7, -1.2], to_radius: 0, open: true}}, material: clay}}
  plate: {{disc: {{center: [1.3, 0.3, -1.1], normal: [0.1, 1, -0.4], radius: 0.4}}, material: clay{bump}}}
"""


def hashes(kage: Path, tmp_path: Path) -> dict[str, str]:
    """A digest of the pictures and all layers of scenes that use every stage."""
    (tmp_path / "function.yaml").write_text(SCENE.format(ground=FLAT, bump=FUNCTION))
    (tmp_path / "lit.yaml").write_text(LIT.format(view="width: 5"))
    (tmp_path / "image.yaml").write_text(
        SCENE.format(ground=FLAT, bump="").replace("{color: [0.8, 0.7, 0.6]}", "{color: {image: {file: color.png, size: [1.3, 0.7]}}}"))
    columns, rows = np.meshgrid(np.arange(31), np.arange(17))
    Image.fromarray(np.stack([columns * 8, rows * 15, columns * rows % 251], axis=-1).astype(np.uint8)).save(tmp_path / "color.png")
    turned = TURNED.format(bump=', bump: {function: "0.03*sin(7*u)*cos(5*w)"}')
    (tmp_path / "turned.yaml").write_text(SCENE.format(ground=FLAT, bump="") + turned.lstrip("\n"))
    result = {}
    made = (tmp_path / f"{name}.yaml" for name in ("function", "lit", "image", "turned"))
    for scene in [*sorted((TOP / "scenes").glob("*.yaml")), *made]:
        for method in ["0", "2+", "march:4", "iter:3", *(["exact"] if scene.stem == "turned" else [])]:
            out = [tmp_path / f"{scene.stem}.exr", tmp_path / f"{scene.stem}.png"]
            subprocess.run(
                [kage, "render", scene, "--shadow", method, "--size", "201x149", "-o", out[0], "-o", out[1]],
                check=True,
                capture_output=True,
                timeout=300,
            )
            for path in out:
                result[f"{scene.stem} {method} {path.suffix}"] = hashlib.sha256(path.read_bytes()).hexdigest()
    return result


def levels() -> list[str]:
    """The x86-64 levels that this processor runs, without the clones: each builds the whole program for itself."""
    found = ["x86-64"]
    flags = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    if " avx2 " in flags and " fma " in flags:
        found.append("x86-64-v3")
    if " avx512vl " in flags:
        found.append("x86-64-v4")
    return found


@pytest.mark.skipif(platform.machine() != "x86_64", reason="levels of x86-64 only")
def test_same_bytes_on_every_level(tmp_path: Path) -> None:
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
