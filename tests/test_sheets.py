"""Surfaces without closed forms, through the program: errors in the scene and in files of patches, the same bytes for any number of
threads, and POV-Ray's picture of them.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import TOP, Kage
from test_pov import CAMERA, FLOOR, HEAD, LIGHTS, layers, needs_povray, povray

sys.path.insert(0, str(TOP / "scripts"))

import make_teapot  # noqa: E402

PARAMETRIC = '{x: "u", y: "1 + 0.2*sin(3*u)*cos(2*w)", z: "w", u: [-1, 1], w: [-pi/3, pi/3]}'
MOEBIUS = '{x: "(1 + w*cos(u/2))*cos(u)", y: "0.9 + w*sin(u/2)", z: "(1 + w*cos(u/2))*sin(u)", u: [0, 2*pi], w: [-0.4, 0.4]}'
PATCH = "[" + ", ".join(f"[{i - 1.5}, {1 + (i % 2) * (j % 2)}, {1.5 - j}]" for j in range(4) for i in range(4)) + "]"


SHAPES = {
    "waves": (f"parametric: {PARAMETRIC}", "0.02*sin(9*u)*sin(9*w)"),
    "moebius": (f"parametric: {MOEBIUS}", "0.02*sin(9*u)*sin(9*w)"),
    "teapot": (f"patches: {{file: {TOP / 'scenes' / 'data' / 'teapot.txt'}}}", "0.04*sin(3*pi*u)*sin(3*pi*w)"),
}


def scene(kage: Kage, shape: str, bump: str = "") -> Path:
    path = kage.folder / "sheet.yaml"
    text = HEAD.format(camera=CAMERA, lights=LIGHTS).replace("[200, 150]", "[96, 72]") + FLOOR + f"  it:\n    {shape}\n    material: shiny\n"
    path.write_text(text + (f"    bump: {bump}\n" if bump else ""))
    return path


#: what replaces what in PARAMETRIC, and the message, without its place
WRONG = [
    ('x: "u"', 'x: "u +"', "11:25: "),
    ('x: "u", ', "", "11:17: parametric lacks its 'x'"),
    ("u: [-1, 1]", "u: [-1]", "1 value, expected the range [from, to]"),
    ("u: [-1, 1]", "u: 3", "a single value, expected the range [from, to]"),
    ("u: [-1, 1]", "u: [1, -1]", "a range from 1 to -1, expected the second end above the first"),
    ("u: [-1, 1]", "u: [w, 1]", "an end of a range with u or w in it, expected a number or such as 2*pi"),
    ("u: [-1, 1]", "u: [-1, 1/0]", "the range ends at inf, expected -1000000 to 1000000"),
    ("u: [-1, 1]", "v: [-1, 1]", "parametric has no 'v', did you mean"),
    ('z: "w"', 'z: "1/w"', "11:17: a surface without bounds, or all in one place, expected functions that are bounded over the range of u and w"),
    ('x: "u"', 'x: "log(u)"', "11:17: a surface without bounds, or all in one place, expected functions"),
]


@pytest.mark.parametrize(("old", "new", "message"), WRONG)
def test_wrong_parametric(kage: Kage, old: str, new: str, message: str) -> None:
    assert old in PARAMETRIC
    path = scene(kage, "parametric: " + PARAMETRIC.replace(old, new))
    result = kage("render", path, "-o", "x.png")
    assert result.returncode == 2
    assert result.stderr.startswith(f"{path}:11:") or result.stderr.startswith("sheet.yaml:11:"), result.stderr
    assert message in result.stderr.splitlines()[0]


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        ("patches: {}", "patches with neither file nor points, expected either 'file' or 'points'"),
        (f"patches: {{file: a.txt, points: [{PATCH}]}}", "patches with both file and points, expected either 'file' or 'points'"),
        ("patches: {file: none.txt}", "'none.txt' can't be used: No such file or directory"),
        ("patches: {points: []}", "0 patches, expected 1 to 4096"),
        ("patches: {points: [[[0, 0, 0]]]}", "1 point, expected a patch: a list of 16 control points [x, y, z]"),
        (f"patches: {{points: [{PATCH.replace('[-1.5, 1, 1.5]', '[-1.5, 1]')}]}}", "2 values, expected a control point [x, y, z]"),
        (f"patches: {{points: [[{', '.join(['[1, 2, 3]'] * 16)}]]}}", "patches that are all in one place, expected some extent"),
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
    """As it is known: 32 patches, symmetric, its bounds, and parts that join: every edge of a patch that is not the teapot's own is
    another's, too."""
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
    path = scene(kage, f"parametric: {MOEBIUS}", '{function: "0.02*sin(9*u)*sin(9*w)"}')
    made = []
    for threads in (1, 2, 7):
        kage.good("render", path, "-o", "x.exr", "--quiet", "--threads", str(threads), *options)
        made.append((kage.folder / "x.exr").read_bytes())
    assert made[0] == made[1] == made[2]


def share(kage: Kage, path: Path, *options: str) -> float:
    kage.good("pov", path, "-o", "x.pov", *options)
    kage.good("render", path, "-o", "x.exr", "--quiet", *options)
    picture = layers(kage.folder / "x.exr")
    theirs, words = povray(kage.folder / "x.pov", (96, 72))
    assert not words.strip()
    off = np.abs(np.stack([picture[c] for c in "RGB"], axis=-1) - theirs).max(axis=-1)
    return float((off <= np.maximum(1 / 255, np.abs(theirs).max(axis=-1) * 2.0**-10)).mean())


@needs_povray
@pytest.mark.parametrize("shape", SHAPES)
def test_parity(kage: Kage, shape: str) -> None:
    """A bump on a patch is 0 at its edges, so that patches that join still do."""
    said, bump = SHAPES[shape]
    for surface, text, least in (("smooth", "", 0.999), ("displaced", f'{{function: "{bump}"}}', 0.995)):
        path = scene(kage, said, text)
        if shape == "teapot":
            path.write_text(path.read_text().replace(CAMERA, "{from: [1.3, 5, -9], at: [0.2, 1.2, 0], fov: 40}"))
        assert share(kage, path, "--surface", surface) >= least
