"""Lists of copies from CSV and PLY files: the same pixels as objects that are written out one by one, whatever the
shape, the method and the material; errors with their places in the list; a hundred thousand of them.
"""

from __future__ import annotations

import os
import random
import struct
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import Kage
from tests.support.parity import layers

HEAD = """\
camera: {{from: [0, 9, -8], at: [0, 0, 0], fov: 45}}
image: {{size: [96, 72], background: [0.3, 0.4, 0.6]}}
render: {{{render}}}
lights:
  lamp: {{at: [-4.5, 15.2, -6.2], color: [0.8, 0.8, 0.8]}}
  window: {{at: [4.5, 5.2, -6.2], color: [0.4, 0.4, 0.4], area: {{u: [1, 0, 0], w: [0, 0, 1], samples: [2, 2]}}}}
materials:
  clay: {{color: [0.82, 0.72, 0.58], ambient: 0.12, diffuse: 0.8}}
  tiles: {{color: {{checker: {{even: [0.1, 0.2, 0.9], odd: [0.9, 0.2, 0.1], size: [0.5, 0.5]}}}}}}
  mirror: {{color: [0.5, 0.5, 0.5], diffuse: 0.1, reflection: 0.8}}
  glass: {{ambient: 0, diffuse: 0, phong: 0.6, reflection: 0.1, filter: 0.9, ior: 1.3}}
objects:
  ground: {{plane: {{origin: [0, -1, 0], u: [0, 0, 1], w: [1, 0, 0]}}, material: clay}}
  stone: {{{shape}, material: clay, hidden: true{bump}, transform: [{{rotate: [0, 20, 0]}}]}}
"""
SPHERE = "sphere: {center: [0.5, 0, 0], radius: 1}"
BOX = "box: {from: [-1, -0.5, -1], to: [1, 0.7, 0.6]}"
TORUS = "torus: {center: [0, 0.1, 0], axis: [0, 1, 0.2], major: 1, minor: 0.4}"
DISC = "disc: {center: [0, 0, 0], normal: [0, 1, 0.3], radius: 1}"
MODEL = "mesh: {file: model.off, normals: smooth}"
BALL = 'parametric: {x: "cos(u)*sin(w)", y: "cos(w)", z: "sin(u)*sin(w)", u: [-pi, pi], w: [0, pi]}'
WAVES = '{function: "0.03*sin(9*u)*sin(7*w)"}'

Row = tuple[float, float, float, float, float, float, float, str]


def rows(materials: Sequence[str], n: int = 30) -> list[Row]:
    rng = random.Random(3)

    def within(lo: float, hi: float) -> float:
        return round(rng.uniform(lo, hi), 3)

    return [(within(-4, 4), within(-0.6, 1.2), within(-4, 4), within(0.2, 0.6), within(0, 360), within(0, 360),
             within(0, 360), rng.choice(materials)) for _ in range(n)]


def write_model(kage: Kage) -> None:
    """An octahedron."""
    (kage.folder / "model.off").write_text(
        "OFF\n6 8 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n3 2 0 5\n"
        "3 1 2 5\n3 3 1 5\n3 0 3 5\n")


def head_of(shape: str, render: str = "shadow: 0", bump: str = "") -> str:
    return HEAD.format(shape=shape, render=render, bump=f", bump: {bump}" if bump else "")


def write_list(kage: Kage, head: str, text: str | bytes, name: str = "list.csv", keys: str = "") -> Path:
    path = kage.folder / "list.yaml"
    path.write_text(head + f"  stones: {{copies: {{of: stone, file: {name}{keys}}}}}\n")
    (kage.folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def csv_of(some: Sequence[Row]) -> str:
    return "x,y,z,scale,rx,ry,rz,material\n" + "".join(",".join(map(str, row)) + "\n" for row in some)


def picture(kage: Kage, path: Path, *options: str) -> dict[str, np.ndarray]:
    result = kage("render", path, "-o", path.with_suffix(".exr"), *options)
    assert result.returncode == 0, result.stderr
    return layers(path.with_suffix(".exr"))


def written_out(kage: Kage, head: str, some: Sequence[Row]) -> Path:
    path = kage.folder / "single.yaml"
    path.write_text(head + "".join(
        f"  s{i}: {{copy: stone, material: {m}, transform: [{{scale: {k}}}, {{rotate: [{a}, {b}, {c}]}}, "
        f"{{translate: [{x}, {y}, {z}]}}]}}\n" for i, (x, y, z, k, a, b, c, m) in enumerate(some)))
    return path


@pytest.mark.parametrize(
    ("shape", "render", "bump", "materials", "within"),
    [
        (SPHERE, "shadow: 0", "", ("clay",), 0),
        (BOX, "shadow: 0", "", ("clay", "tiles", "mirror"), 0),
        (TORUS, "shadow: 2, shade: shifted", WAVES, ("clay", "tiles"), 0),
        (BALL, "shadow: 2", WAVES, ("clay", "tiles"), 0),
        (MODEL, "shadow: 0", "", ("clay", "mirror"), 0),
        (SPHERE, "shadow: 1", WAVES, ("clay", "mirror"), 0),
        (SPHERE, "shadow: 0, bump_shadow: march:8", WAVES, ("clay",), 0),
        (SPHERE, "shadow: 0", "", ("glass", "clay", "mirror"), 0),
        (DISC, "shadow: 0", "", ("clay",), 1e-6),  # a copy of a disc is a disc, not a disc under a map: other roundings
    ],
)
def test_same_as_written_out(kage: Kage, shape: str, render: str, bump: str, materials: tuple[str, ...],
                             within: float) -> None:
    some, head = rows(materials), head_of(shape, render, bump)
    write_model(kage)
    got = picture(kage, write_list(kage, head, csv_of(some)))
    want = picture(kage, written_out(kage, head, some))
    for name in "RGB":
        assert np.max(np.abs(got[name] - want[name])) <= within, name


def test_same_as_written_out_among_many_objects(kage: Kage) -> None:
    """With so many objects that there is a hierarchy over them, and one that has no end."""
    spheres = "".join(
        f"  s{100 + k}: {{sphere: {{center: [{k - 7}, -0.7, {3 - k % 3}], radius: 0.3}}, material: mirror}}\n"
        for k in range(14))
    some, head = rows(("clay", "tiles", "mirror", "glass"), 60), head_of(SPHERE) + spheres
    got = picture(kage, write_list(kage, head, csv_of(some)))
    want = picture(kage, written_out(kage, head, some))
    assert all(np.array_equal(got[name], want[name]) for name in "RGB")


def test_same_bytes_with_any_threads(kage: Kage) -> None:
    path = write_list(kage, head_of(SPHERE, bump=WAVES), csv_of(rows(("clay", "mirror", "glass"), 3000)))
    kage("render", path, "-o", "one.exr", "--threads", "1")
    kage("render", path, "-o", "four.exr", "--threads", "4")
    assert (kage.folder / "one.exr").read_bytes() == (kage.folder / "four.exr").read_bytes()


def ply_of(some: Sequence[Row], encoding: str, order: str) -> bytes:
    names = ("x", "y", "z", "scale", "rx", "ry", "rz")
    head = "".join(f"property double {name}\n" for name in names) + "property uchar material\nproperty float red\n"
    text = f"ply\nformat {encoding} 1.0\ncomment by hand\nelement vertex {len(some)}\n{head}element face 0\n" \
           "property list uchar int vertex_indices\nend_header\n"
    kinds = ("clay", "tiles")
    if order:
        return text.encode() + b"".join(struct.pack(order + "7dBf", *row[:7], kinds.index(row[7]), 0.5) for row in some)
    return (text + "".join(" ".join(map(str, row[:7])) + f" {kinds.index(row[7])} 0.5\n" for row in some)).encode()


@pytest.mark.parametrize(("encoding", "order"),
                         [("ascii", ""), ("binary_little_endian", "<"), ("binary_big_endian", ">")])
def test_ply(kage: Kage, encoding: str, order: str) -> None:
    some, head = rows(("clay", "tiles")), head_of(BOX)
    want = picture(kage, write_list(kage, head, csv_of(some)))
    got = picture(kage, write_list(kage, head, ply_of(some, encoding, order), "list.ply", ", materials: [clay, tiles]"))
    assert all(np.array_equal(got[name], want[name]) for name in "RGB")


def test_what_programs_write(kage: Kage) -> None:
    """numpy's savetxt, a spreadsheet with semicolons and quotes, a table with columns of another program."""
    places, head = [(0.5, 0, 1), (-1, 0.25, 2)], head_of(SPHERE)
    want = picture(kage, write_list(kage, head, "x,y,z\n0.5,0,1\n-1,0.25,2\n"))
    np.savetxt(kage.folder / "numpy.csv", places, header="x y z")
    texts = ((kage.folder / "numpy.csv").read_bytes(), b'\xef\xbb\xbf"Z";"X";"Y"\r\n1;"0.5";0\r\n\r\n2;-1;.25\r\n',
             b"id\ty\tx\tz\tmaterial\n# two\n7\t0\t5e-1\t1\t\n8\t0.25\t-1.0\t2\tclay")
    for text in texts:
        got = picture(kage, write_list(kage, head, text))
        assert all(np.array_equal(got[name], want[name]) for name in "RGB"), text


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x,y,z\n1,2\n", "list.csv:2:3: 2 values in this line, expected 3, as in the first line"),
        ("x,y,z\n1,2,3,4\n", "list.csv:2:7: more values in this line, expected 3"),
        ("x,y,z\n1,2,3\n\n1,b,3\n", "list.csv:4:3: 'b' is no number, expected a coordinate from -1e6 to 1e6"),
        ("x,y,z\n1,,3\n", "list.csv:2:3: no value for y, expected a coordinate"),
        ("x,y,z\n1,2,nan\n", "list.csv:2:5: 'nan' is no number"),
        ("x,y,z\n1,2e7,3\n", "list.csv:2:3: y is 2e+07, expected a coordinate from -1e6 to 1e6"),
        ("x,y,z,scale\n1,2,3,0\n", "list.csv:2:7: scale is 0, expected a factor from 1e-6 to 1e6"),
        ("x,y,scael\n1,2,3\n", "list.csv:1:5: unknown column 'scael', did you mean 'scale'?"),
        ("x,y\n1,2\n", "list.csv:1:1: no column 'z' in the first line"),
        ("1,2,3\n1,2,3\n", "list.csv:1:1: no column 'x' in the first line, expected the columns' names there"),
        ("x,y,z,x\n1,2,3,4\n", "list.csv:1:7: a second 'x', expected each column once"),
        ("x,y,z,scale,sx\n1,2,3,1,1\n", "list.csv: columns 'scale' and 'sx', expected one of them"),
        ("x,y,z,material\n1,2,3,clay\n1,2,3,gold\n", "list.csv:3:1: no material 'gold', expected one of those under"),
        ("x,y,z,sx\n1,2,3,1e6\n", "list.csv:2:1: a size of 1.879e+06 scene units after all"),
        ("x,y,z,sx,sy\n0,0,0,1000,0.001\n", "list.csv:2:1: one direction is scaled more than 10000 times"),
        ("x,y,z\n", "list.csv: a list without places, expected one or more"),
        ("", "list.csv:1:1: no column 'x'"),
        ("x,y,z\n1,2,\0\n", "list.csv: bytes of 0, expected text"),
        ("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
         "1 2 3\n4 5", "list.csv: the file ends at vertex 1, expected 2"),
        ("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
         "1 2 b\n", "'b' is no number, expected a value of vertex 0"),
        ("ply\nformat ascii 1.0\nelement vertex 99999\nproperty float x\nproperty float y\nproperty float z\n"
         "end_header\n1 2 3\n", "list.csv: 99999 vertices in"),
        ("ply\nformat ascii 1.0\nelement face 1\nend_header\n", "list.csv:3:9: another element before 'vertex'"),
        ("ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\nend_header\n1\n",
         "list.csv:4:10: an unknown type of a vertex's property"),
        ("ply\nformat text 1.0\nelement vertex 1\nend_header\n1\n", "list.csv:2:8: an unknown format"),
        ("ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
         "property float z\nend_header\n" + "\0" * 12, "list.csv: the file ends at vertex 1, expected 3"),
        ('x,y,z\n"1"2,3,4\n', "list.csv:2:1: '\"1\"2' is no number"),
        ('x,y,z\n"1,2,3\n', "list.csv:2:1: '\"1' is no number"),
        ('x,y,z,material\n1,2,3,"a ""b"\n', "no material 'a \"\"b', expected one of those under"),
        ("x,y,z,turn\n1,2,3,1e7\n", "list.csv:2:7: turn is 1e+07, expected an angle from -1e6 to 1e6 degrees"),
    ],
)
def test_wrong_lists(kage: Kage, text: str, message: str) -> None:
    result = kage("render", write_list(kage, head_of(SPHERE), text), "-o", "x.png")
    assert result.returncode == 2
    assert message in result.stderr.splitlines()[0], result.stderr
    assert not (kage.folder / "x.png").exists()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("of: stone", "of: sand", "no object 'sand', expected one of those under 'objects'"),
        ("of: stone", "of: stones", "'stones' copies itself, expected another object"),
        ("of: stone, ", "", "copies lacks its 'of'"),
        (", file: list.csv", "", "copies lacks its 'file'"),
        ("file: list.csv", "file: none.csv", "none.csv: can't read the list: No such file"),
        ("of: stone", "of: ground", "a plane has no end, expected copies of an object that has one"),
        ("{copies:", "{copy: stone, copies:", "'copies' beside 'copy', expected one of them"),
        ("stones:", "more: {copy: stones}\n  stones:", "'stones' is a list of copies, expected an object of one shape"),
        ("file: list.csv}", f"file: list.csv}}, {SPHERE}", "a shape, 'sphere', beside 'copies', expected one of them"),
        ("list.csv", "list.csv, materials: []", "an empty list, expected names of materials"),
        ("list.csv", "list.csv, materials: [clay]", "'clay' is no number of a material, expected 0 to 0"),
    ],
)
def test_wrong_copies(kage: Kage, old: str, new: str, message: str) -> None:
    path = write_list(kage, head_of(SPHERE), "x,y,z,material\n1,2,3,clay\n")
    path.write_text(path.read_text().replace(old, new))
    result = kage("render", path, "-o", "x.png")
    assert result.returncode == 2
    assert message in result.stderr.splitlines()[0], result.stderr


@pytest.mark.parametrize(("materials", "message"), [
    ("", "the scene lacks its 'materials'"), ("materials: 3\n", "materials is a single value, expected a map")])
def test_no_materials(kage: Kage, materials: str, message: str) -> None:
    head = head_of(SPHERE)
    head = head[:head.index("materials:")] + materials + head[head.index("objects:"):]
    result = kage("check", write_list(kage, head, "x,y,z\n1,2,3\n"))
    assert result.returncode == 2
    assert message in result.stderr.splitlines()[0], result.stderr


def test_a_material_between_two(kage: Kage) -> None:
    text = "ply\nformat ascii 1.0\nelement vertex 1\n" + "".join(
        f"property float {name}\n" for name in ("x", "y", "z", "material")) + "end_header\n1 2 3 0.4\n"
    path = write_list(kage, head_of(SPHERE), text, "list.ply", ", materials: [clay, tiles]")
    result = kage("render", path, "-o", "x.png")
    assert result.returncode == 2
    assert "list.ply: vertex 0: '0.4' is no number of a material, expected 0 to 1" in result.stderr


def test_no_regular_file(kage: Kage) -> None:
    """A pipe that nobody writes to; without a wait."""
    path = write_list(kage, head_of(SPHERE), "")
    (kage.folder / "list.csv").unlink()
    os.mkfifo(kage.folder / "list.csv")
    result = kage("render", path, "-o", "x.png")
    assert result.returncode == 2
    assert "list.csv: can't read the list: no regular file" in result.stderr


def test_bumps_that_would_be_displaced(kage: Kage) -> None:
    path = write_list(kage, head_of(SPHERE, "shadow: exact", WAVES), "x,y,z\n1,2,3\n")
    result = kage("render", path, "-o", "x.png")
    assert result.returncode == 2
    assert "a list of copies with a bump can't be displaced" in result.stderr


def test_hidden_objects_are_not_there(kage: Kage) -> None:
    head = head_of(SPHERE)
    without = kage.folder / "without.yaml"
    without.write_text("\n".join(line for line in head.splitlines() if "stone" not in line) + "\n")
    hidden = kage.folder / "hidden.yaml"
    hidden.write_text(head)
    want, got = picture(kage, without), picture(kage, hidden)
    assert all(np.array_equal(got[name], want[name]) for name in want)


def test_check_counts_them(kage: Kage) -> None:
    some = rows(("clay", "glass", "tiles"), 50)
    text = kage("check", write_list(kage, head_of(SPHERE), csv_of(some))).stdout
    for name in ("clay", "glass", "tiles"):
        number = sum(row[7] == name for row in some)
        assert f"object stones: {number} copies of stone, transformed, material {name}" in text


def test_povray_has_a_union(kage: Kage) -> None:
    some = rows(("clay", "tiles"), 20)
    path = write_list(kage, head_of(BOX), csv_of(some))
    assert kage("pov", path, "-o", "list.pov").returncode == 0
    text = (kage.folder / "list.pov").read_text()
    assert text.count("#declare Copies_") == 2
    assert text.count("object {\n  Copies_") == 20


def test_a_hundred_thousand(kage: Kage) -> None:
    n = 100_000
    places = np.random.default_rng(1).uniform((-5, -1, -5, 0.005), (5, 1, 5, 0.02), (n, 4)).astype("<f4")
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {n}\n" + "".join(
        f"property float {name}\n" for name in ("x", "y", "z", "scale")) + "end_header\n"
    path = write_list(kage, head_of(SPHERE), head.encode() + places.tobytes(), "list.ply")
    got = picture(kage, path)
    assert len(np.unique(got["R"])) > 1000


def test_twenty_thousand_written_out(kage: Kage) -> None:
    """Names are found by hashing: this took a minute when each was compared with all before it."""
    path = kage.folder / "many.yaml"
    path.write_text(head_of(SPHERE) + "".join(
        f"  s{i}: {{copy: stone, transform: [{{scale: 0.02}}, {{translate: [{i % 141 / 14 - 5}, 0, {i // 141 / 14 - 5}]"
        "}]}\n" for i in range(20_000)))
    picture(kage, path)
