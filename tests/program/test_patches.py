"""Surfaces without closed forms, through the program: errors in the scene and in files of patches, the same bytes for
any number of threads. POV-Ray's picture of them: test_parity.py.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from scripts import make_teapot
from tests.conftest import TOP, Kage
from tests.support.parity import CAMERA, FLOOR, HEAD, LIGHTS, SHEETS, layers

PARAMETRIC = '{x: "u", y: "1 + 0.2*sin(3*u)*cos(2*w)", z: "w", u: [-1, 1], w: [-pi/3, pi/3]}'
PATCH = "[" + ", ".join(f"[{i - 1.5}, {1 + (i % 2) * (j % 2)}, {1.5 - j}]" for j in range(4) for i in range(4)) + "]"


def scene(kage: Kage, shape: str, bump: str = "") -> Path:
    path = kage.folder / "sheet.yaml"
    head = HEAD.format(camera=CAMERA, lights=LIGHTS).replace("[160, 120]", "[96, 72]")
    path.write_text(head + FLOOR + f"  it:\n    {shape}\n    material: shiny\n"
                    + (f"    bump: {bump}\n" if bump else ""))
    return path


#: what replaces what in PARAMETRIC, and the message, without its place
WRONG = [
    ('x: "u"', 'x: "u +"', "11:25: "),
    ('x: "u", ', "", "11:17: parametric lacks its 'x'"),
    ("u: [-1, 1]", "u: [-1]", "1 value, expected the range [from, to]"),
    ("u: [-1, 1]", "u: 3", "a single value, expected the range [from, to]"),
    ("u: [-1, 1]", "u: [1, -1]", "a range from 1 to -1, expected the second end above the first"),
    ("u: [-1, 1]", "u: [w, 1]", "an end of a range with u or w in it, expected a number or such as 2*pi"),
    ("u: [-1, 1]", "u: [-1, 1/0]", "an end of a range without a value, expected -1000000 to 1000000"),
    ("u: [-1, 1]", "u: [-1, exp(999)]", "the range ends at inf, expected -1000000 to 1000000"),
    ("u: [-1, 1]", "v: [-1, 1]", "parametric has no 'v', did you mean 'u'?"),
    ('z: "w"', 'z: "1/w"',
     "11:17: the surface has no bounds, or is all in one place; expected x, y and z that are finite, and not all "
     "constant, over the range of u and w"),
    ('x: "u"', 'x: "log(u)"', "11:17: the surface has no bounds, or is all in one place; expected x, y and z"),
]


@pytest.mark.parametrize(("old", "new", "message"), WRONG)
def test_wrong_parametric(kage: Kage, old: str, new: str, message: str) -> None:
    assert old in PARAMETRIC
    path = scene(kage, "parametric: " + PARAMETRIC.replace(old, new))
    result = kage("render", path, "-o", "x.png")
    assert result.returncode == 2
    assert result.stderr.startswith(f"{path}:11:") or result.stderr.startswith("sheet.yaml:11:"), result.stderr
    assert message in result.stderr.splitlines()[0]


def test_a_line_can_not_be_transformed(kage: Kage) -> None:
    path = scene(kage, "parametric: {x: u, y: u, z: u, u: [0, 1], w: [0, 1]}\n    transform: [{scale: 2}]")
    assert ":12:16: the surface is a line or a point, or has no value" in kage("check", path).stderr


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        ("patches: {}", "patches with neither file nor points, expected either 'file' or 'points'"),
        (f"patches: {{file: a.txt, points: [{PATCH}]}}",
         "patches with both file and points, expected either 'file' or 'points'"),
        ("patches: {file: none.txt}", "'none.txt' can't be used: No such file or directory"),
        ("patches: {points: []}", "0 patches, expected 1 to 4096"),
        ("patches: {points: [[[0, 0, 0]]]}", "1 point, expected a patch: a list of 16 control points [x, y, z]"),
        (f"patches: {{points: [{PATCH.replace('[-1.5, 1, 1.5]', '[-1.5, 1]')}]}}",
         "2 values, expected a control point [x, y, z]"),
        (f"patches: {{points: [[{', '.join(['[1, 2, 3]'] * 16)}]]}}",
         "the patches are all in one place, expected points that differ"),
    ],
)
def test_wrong_patches(kage: Kage, shape: str, message: str) -> None:
    result = kage("render", scene(kage, shape), "-o", "x.png")
    assert result.returncode == 2
    assert message in result.stderr.splitlines()[0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 2 3\n4 five 6\n", "patch.txt:2:3: 'five' is no number, expected a coordinate of a control point"),
        ("1 2 nan\n", "patch.txt:1:5: 'nan' is no number, expected a coordinate of a control point"),
        ("1 0x10 3\n", "patch.txt:1:3: '0x10' is no number, expected a coordinate of a control point"),
        ("1 2 3e9\n", "patch.txt:1:5: 3e9 is too far, expected a coordinate from -1e+06 to 1e+06"),
        ("# nothing\n", "the file ends after 0 numbers, expected 48 for each patch: 16 control points of x, y and z"),
        ("1 2 3\n" * 17, "the file ends after 51 numbers, expected 48 for each patch: 16 control points of x, y and z"),
    ],
)
def test_wrong_file(kage: Kage, text: str, message: str) -> None:
    (kage.folder / "patch.txt").write_text(text)
    result = kage("render", scene(kage, "patches: {file: patch.txt}"), "-o", "x.png")
    assert result.returncode == 2
    assert message in result.stderr.splitlines()[0]
    assert "^" in result.stderr.splitlines()[2]


def test_teapot_is_what_its_script_makes() -> None:
    assert (TOP / "scenes" / "data" / "teapot.txt").read_text() == make_teapot.text()


def test_teapot_is_newells() -> None:
    """As it is known: 32 patches, symmetric, its bounds, and parts that join: every edge of a patch that is not the
    teapot's own is another's, too."""
    patches = [np.array(p) for _, p in make_teapot.patches()]
    assert len(patches) == 32
    points = np.concatenate([p.reshape(-1, 3) for p in patches])
    assert np.allclose([points.min(axis=0), points.max(axis=0)], [[-3, 0, -2], [3.525, 3.15, 2]])
    mirrored = {tuple(np.round(p * (1, 1, -1), 9) + 0.0) for p in points}
    assert mirrored == {tuple(np.round(p, 9) + 0.0) for p in points}
    edges: dict[frozenset, int] = {}
    for p in patches:
        for edge in (p[0], p[3], p[:, 0], p[:, 3]):
            key = frozenset(tuple(np.round(q, 9) + 0.0) for q in edge)
            if len(key) > 1:
                edges[key] = edges.get(key, 0) + 1
    assert max(edges.values()) == 2
    # alone are four quarters each of the rim's and the lid's edge, and two halves of each end of handle and spout
    assert sum(count == 1 for count in edges.values()) == 16


@pytest.mark.parametrize("options", [[], ["--surface", "displaced"]])
def test_threads(kage: Kage, options: list[str]) -> None:
    path = scene(kage, SHEETS["moebius"], '{function: "0.02*sin(9*u)*sin(9*w)"}')
    made = []
    for threads in (1, 2, 7):
        kage.good("render", path, "-o", "x.exr", "--quiet", "--threads", str(threads), *options)
        made.append((kage.folder / "x.exr").read_bytes())
    assert made[0] == made[1] == made[2]


# ---- the same scene in other units ----

SCALES = (1e-3, 1e3, 1e4)
PATCH_PLACES = [(0.8 * i - 1.2, 1 + 0.5 * (i % 3 == 0) - 0.6 * (j % 3 == 0), 0.8 * j - 1.2)
                for j in range(4) for i in range(4)]


def times(k: float, *at: float) -> str:
    return str([k * x for x in at])


#: a shape and its bump, k times as large
SCALED = {
    "waves": lambda k: (f'parametric: {{x: "{k}*u", y: "{k}*(1 + 0.2*sin(3*u)*cos(2*w))", z: "{k}*w", '
                        "u: [-1, 1], w: [-1, 1]}",
                        f'{{function: "{0.02 * k}*sin(9*u)*sin(9*w)"}}'),
    "waves, the range too": lambda k: (
        f'parametric: {{x: "u", y: "{k}*(1 + 0.2*sin(3*u/{k})*cos(2*w/{k}))", z: "w", '
        f"u: {times(k, -1, 1)}, w: {times(k, -1, 1)}}}",
        f'{{function: "{0.02 * k}*sin(9*u/{k})*sin(9*w/{k})"}}'),
    "ball": lambda k: (f'parametric: {{x: "{k}*sin(w)*cos(u)", y: "{k}*(1 + cos(w))", z: "{k}*sin(w)*sin(u)", '
                       "u: [-pi, pi], w: [0, pi]}",
                       f'{{function: "{0.03 * k}*sin(6*u)*sin(9*w)"}}'),
    "patch": lambda k: (f"patches: {{points: [[{', '.join(times(k, *at) for at in PATCH_PLACES)}]]}}",
                        f'{{function: "{0.03 * k}*sin(25*u)*sin(25*w)"}}'),
}


def scaled(kage: Kage, name: str, k: float) -> Path:
    """The scene with all its lengths k times as large: the same picture."""
    camera = f"{{from: {times(k, 0.3, 2.9, -5.2)}, at: {times(k, 0, 0.5, 0)}, fov: 40}}"
    lights = f"{{lamp: {{at: {times(k, -4.5, 5.2, -2.2)}, color: [1.1, 1.08, 1]}}}}"
    plane = f"{{origin: [0, 0, 0], u: {times(k, 0, 0, 1)}, w: {times(k, 1, 0, 0)}}}"
    floor = f"  floor: {{plane: {plane}, material: clay}}\n"
    shape, bump = SCALED[name](k)
    text = HEAD.format(camera=camera, lights=lights).replace("[160, 120]", "[96, 72]") + floor
    path = kage.folder / "scaled.yaml"
    path.write_text(text + f"  it:\n    {shape}\n    material: shiny\n    bump: {bump}\n")
    return path


@pytest.mark.parametrize("options", [["--surface", "displaced"], ["--shadow", "2+"]], ids=lambda o: o[-1])
@pytest.mark.parametrize("name", SCALED)
def test_any_scale(kage: Kage, name: str, options: list[str]) -> None:
    """A tenth of a step of 1/255; float leaves 1.4e-5."""
    pictures = []
    for k in (1.0, *SCALES):
        kage.good("render", scaled(kage, name, k), "-o", "x.exr", "--quiet", *options)
        found = layers(kage.folder / "x.exr")
        pictures.append({side: np.stack([found[channel] for channel in channels], axis=-1)
                         for side, channels in {"rgb": "RGB", "normal": ("N.X", "N.Y", "N.Z")}.items()})
    for k, picture in zip(SCALES, pictures[1:], strict=True):
        assert np.isfinite(picture["normal"]).all(), k
        assert np.abs(picture["normal"] - pictures[0]["normal"]).max() < 1e-3, k
        assert np.abs(picture["rgb"] - pictures[0]["rgb"]).max() < 0.1 / 255, k


def exported(kage: Kage, path: Path, *options: str) -> tuple[np.ndarray, np.ndarray, tuple[int, int]]:
    """The mesh's vertices, its normals, and how many cells it has along u and w."""
    kage.good("pov", path, "-o", "x.pov", *options)
    text = (kage.folder / "x.pov").read_text()
    cells = re.search(r"pixels: (\d+) x (\d+) cells", text)
    lists = [re.search(rf"{name}_vectors {{ \d+,(.*?)}}", text, re.DOTALL) for name in ("vertex", "normal")]
    assert cells and all(lists)
    at, normal = (np.array(re.findall(r"[^<>,\s]+", found[1]), dtype=float).reshape(-1, 3) for found in lists)
    return at, normal, (int(cells[1]), int(cells[2]))


@pytest.mark.parametrize("k", [1.0, *SCALES])
def test_exported_bumps(kage: Kage, k: float) -> None:
    """Every vertex is as far from the smooth surface as the bump is high there."""
    at, normal, (n, m) = exported(kage, scaled(kage, "waves", k), "--surface", "displaced")
    w, u = (x.ravel() for x in np.meshgrid(np.linspace(-1, 1, m + 1), np.linspace(-1, 1, n + 1), indexing="ij"))
    smooth = np.stack([u, 1 + 0.2 * np.sin(3 * u) * np.cos(2 * w), w], axis=1)
    height = 0.02 * np.sin(9 * u) * np.sin(9 * w)
    assert np.abs(height).max() > 0.019
    assert np.abs(np.linalg.norm(at / k - smooth, axis=1) - np.abs(height)).max() < 2e-6
    assert np.abs(np.linalg.norm(normal, axis=1) - 1).max() < 1e-5


@pytest.mark.parametrize(("k", "surface"), [(1.0, "smooth"), (1e-3, "displaced"), (1e4, "displaced")])
def test_exported_cusp(kage: Kage, k: float, surface: str) -> None:
    """At its tip both partials are 0, and near it the square of their product is beyond float's range."""
    shape = f'parametric: {{x: "{k}*u^3*cos(w)", y: "{k}*(1 + u^3)", z: "{k}*u^3*sin(w)", u: [0, 1], w: [0, 2*pi]}}'
    bump = f'{{function: "{0.02 * k}*sin(9*u)*sin(3*w)"}}'
    at, normal, _ = exported(kage, scene(kage, shape, bump), "--surface", surface)
    assert np.isfinite(at).all() and np.abs(np.linalg.norm(normal, axis=1) - 1).max() < 1e-5
