"""Limits: of memory, of time and of input, and docs/limits.md, whose table must say what the code says."""

from __future__ import annotations

import base64
import json
import re
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import pytest

from tests.conftest import PROGRAM, SCENE, TOP, Kage, not_sanitized
from tests.verify import allocations

MIB = 1 << 20
#: The scene without its map.
BARE = re.sub(r"\n +bump: .*", "", SCENE)
#: What the program takes besides what it counts: its own code, the libraries', the scene's text, stacks.
BESIDE = 30 * MIB


def png_of(width: int, height: int, bits: int, packed: bytes) -> bytes:
    """A grey PNG of packed samples."""
    parts = [(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)), (b"IDAT", packed), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in parts)


def png(path: Path, side: int) -> Path:
    """A grey map of 16 bits that is small as a file."""
    pack = zlib.compressobj(1)
    row = b"\0" + b"\x40\x00\x41\x00" * (side // 2)
    data = b"".join(pack.compress(row) for _ in range(side)) + pack.flush()
    path.write_bytes(png_of(side, side, 16, data))
    return path


def stl(path: Path, side: int) -> Path:
    """side x side cells of two triangles, hills."""
    def at(i: int, j: int) -> bytes:
        return struct.pack("<3f", i / side - 0.5, 0.01 * ((i * 7 + j * 5) % 11), j / side - 0.5)

    faces = [a + b + c for i in range(side) for j in range(side)
             for a, b, c in ((at(i, j), at(i, j + 1), at(i + 1, j)), (at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)))]
    path.write_bytes(b" " * 80 + struct.pack("<I", len(faces)) + b"".join(b"\0" * 12 + f + b"\0\0" for f in faces))
    return path


#: A process of its own, as what was resident before a program is started counts as the program's.
SMALL = """
import os, sys
run = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ)
_, status, used = os.wait4(run, 0)
print(os.waitstatus_to_exitcode(status), used.ru_maxrss)
"""


def measured(folder: Path, *words: object) -> tuple[int, int, str]:
    """Exit status, the most that was resident in bytes, and what was said."""
    run = subprocess.run([sys.executable, "-S", "-E", "-c", SMALL, str(PROGRAM), *map(str, words)], cwd=folder,
                         capture_output=True, text=True, timeout=120)
    last = run.stdout.splitlines()[-1].split()
    return int(last[0]), int(last[1]) * 1024, run.stdout + run.stderr


def scene_of(folder: Path, kind: str) -> tuple[Path, list[str]]:
    """A scene that takes much in one way."""
    text, options = BARE, ["--size", "40x30"]
    ball = "sphere: {center: [1, 1, 0], radius: 0.5}"
    if kind == "map":
        png(folder / "big.png", 2048)
        text = text.replace(ball, ball + "\n    bump: {map: {file: big.png}, scale: 0.01, zero: 0.25, sign: up}")
        options += ["--shadow", "exact"]
    elif kind == "mesh":
        stl(folder / "hills.stl", 250)
        text = text.replace(ball, "mesh: {file: hills.stl}")
    elif kind == "copies":
        (folder / "dots.csv").write_text("x,y,z\n" + "".join(f"{k % 300},{k // 300},0\n" for k in range(100_000)))
        text += "  dots:\n    copies: {of: ball, file: dots.csv}\n    material: clay\n"
    else:
        options = ["--size", "1000x800"]
    path = folder / "scene.yaml"
    path.write_text(text)
    return path, options


@not_sanitized
@pytest.mark.parametrize("kind", ["map", "mesh", "copies", "film"])
def test_all_that_is_large_is_counted(kage: Kage, kind: str) -> None:
    """What is resident is what was counted, and a limit of half as much is refused before it is taken."""
    scene, options = scene_of(kage.folder, kind)
    words = ["render", scene, *options, "--threads", "2", "-q", "-o", "out.exr"]
    status, resident, said = measured(kage.folder, *words, "--stats")
    assert status == 0, said
    found = re.search(r"memory +([\d.]+) MB", said)
    assert found, said
    counted = float(found[1]) * MIB
    assert counted > 8 * MIB
    assert resident < 1.2 * counted + BESIDE
    (kage.folder / "out.exr").unlink()
    status, resident, said = measured(kage.folder, *words, "--max-memory", int(counted * 1.02))
    assert status == 0, said
    (kage.folder / "out.exr").write_text("older")
    status, resident, said = measured(kage.folder, *words, "--max-memory", f"{counted / 2 / 1024:.0f}K")
    assert status in (1, 2)
    assert "there is not enough memory: it needs" in said
    assert "(--max-memory)" in said
    assert resident < 0.6 * counted + BESIDE
    assert (kage.folder / "out.exr").read_text() == "older"


def test_a_refused_map_is_named(kage: Kage) -> None:
    scene, _ = scene_of(kage.folder, "map")
    done = kage("check", scene, "--max-memory", "10M")
    assert done.returncode == 2
    assert re.match(r"\S*scene.yaml:\d+:\d+: 'big.png' can't be used: there is not enough memory: it needs 1[67].* MB, "
                    r"more than the limit of 10 MB \(--max-memory\)\n", done.stderr), done.stderr


def test_check_needs_no_more_for_exact(kage: Kage) -> None:
    """The pyramid of bounds, of ten times the map, is for rendering."""
    scene, _ = scene_of(kage.folder, "map")
    done = kage("check", scene, "--set", "render.shadow=exact", "--max-memory", "24M")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("size", ["0", "-1", "4Q", "4GG", "G", "", "1e3"])
def test_no_size(kage: Kage, size: str) -> None:
    (kage.folder / "scene.yaml").write_text(BARE)
    done = kage("check", "scene.yaml", "--max-memory", size)
    assert done.returncode == 2
    assert "--max-memory" in done.stderr


def test_time_is_over(kage: Kage) -> None:
    """A render that takes minutes ends as by Ctrl-C, with a status of its own, and the older file stays."""
    (kage.folder / "scene.yaml").write_text(BARE)
    (kage.folder / "out.png").write_text("older")
    words = ["render", "scene.yaml", "--size", "20000x20000", "--crop", "0,0,8000,8000", "--aa", "16", "-o", "out.png"]
    done = kage(*words, "--max-seconds", "0.5")
    assert done.returncode == 124
    assert "nothing written" in done.stderr
    assert done.stderr.endswith("kage: the time of --max-seconds is over\n")
    assert (kage.folder / "out.png").read_text() == "older"
    assert kage.files() == {"scene.yaml", "out.png"}


def test_a_wild_surface_stops(kage: Kage) -> None:
    """What has no bound of time ends cleanly."""
    wild = 'parametric: {x: u, y: "0.1*sin(1e20*u)", z: w, u: [0, 1], w: [0, 1]}'
    (kage.folder / "scene.yaml").write_text(BARE.replace("sphere: {center: [1, 1, 0], radius: 0.5}", wild))
    done = kage("render", "scene.yaml", "--size", "4000x4000", "--aa", "16", "-o", "out.png", "--max-seconds", "1")
    assert done.returncode == 124, done.stderr
    assert kage.files() == {"scene.yaml"}


def constant(file: str, name: str) -> int:
    found = re.search(rf"\b{name}(?: =)? ([^,;}}\n]+?)\s*[,;}}\n]", (TOP / file).read_text())
    assert found, (file, name)
    value = found[1].split("/*")[0].replace("(long)", "").replace("(int64_t)", "")
    assert re.fullmatch(r"[\d<() ]+", value), value
    base, _, by = value.partition("<<")
    return int(base.strip("() ")) << int(by.strip("() ") or 0)


def size_of(text: str) -> int:
    """64M as a number."""
    digits = text.rstrip("KMG")
    return int(digits) << 10 * ("KMG".find(text[len(digits) :]) + 1 if len(digits) < len(text) else 0)


def test_the_table_is_that_of_the_code(kage: Kage) -> None:
    built_in = {limit["name"]: size_of(limit["most"]) for limit in json.loads(kage.good("table"))["limits"]}
    row = r"^\| (?:.*?) \| (\d+) \| (?:`([\w-]+)`)? ?\| `(\S+)` (\w+) \|$"
    rows = re.findall(row, (TOP / "docs" / "limits.md").read_text(), re.M)
    assert len(rows) > 15
    for number, _, file, name in rows:
        assert int(number) == constant(file, name), name
    assert {option: int(number) for number, option, _, _ in rows if option} == built_in


#: Value at the limit and one beyond: what replaces what in the scene, and the message of the second.
EDGES = {
    "expression": ("{center: [1, 1, 0], radius: 0.5}", "{center: [1, 1, 0], radius: 0.5}\n    bump: {function: '%s'}",
                   lambda k: "u" + " " * (4095 + k), "4096 bytes"),
    "nesting": ("{center: [1, 1, 0], radius: 0.5}", "{center: [1, 1, 0], radius: 0.5}\n    bump: {function: '%s'}",
                lambda k: "(" * (62 + k) + "u" + ")" * (62 + k), "nesting too deep"),
    "depth": ("aa: 1", "aa: 1, depth: %s", lambda k: str(32 + k), "32"),
    "picture": ("size: [40, 30]", "size: [2, %s]", lambda k: str(32768 + k), "32768"),
    "steps": ("aa: 1", "aa: 1, shadow: 'march:%s'", lambda k: str(1024 + k), "1024"),
}


@pytest.mark.parametrize("name", EDGES)
def test_at_the_limit_and_beyond(kage: Kage, name: str) -> None:
    old, new, value, word = EDGES[name]
    assert old in BARE
    scene = re.sub(r"shadow: [^,}]+, ", "", BARE) if name == "steps" else BARE
    beyond = 4 if name == "nesting" else 1
    for over in (0, beyond):
        (kage.folder / "scene.yaml").write_text(scene.replace(old, new % value(over)))
        done = kage("check", "scene.yaml")
        assert done.returncode == (2 if over else 0), done.stderr
        assert not over or word in done.stderr, done.stderr


def refused(kage: Kage, text: str, words: str, *files: str) -> None:
    """One beyond a limit that stands by itself, told with the place; files: that are there besides the scene."""
    (kage.folder / "scene.yaml").write_text(text)
    done = kage("render", "scene.yaml", "-o", "out.png")
    assert done.returncode == 2
    place = r"(?:\S*/)?(?:scene\.yaml|\S+\.(?:ply|txt))(?::\d+:\d+)?: "
    assert re.match(f"{place}.*{words}", done.stderr), done.stderr[:400]
    assert kage.files() == {"scene.yaml", *files}


def test_bytes_of_a_scene(kage: Kage) -> None:
    """67108864 are taken, comments for the most part."""
    most = 1 << 26
    comments = ("#" * 127 + "\n") * (most // 128 - 10)
    text = BARE + comments + "#" * (most - len(BARE) - len(comments))
    (kage.folder / "scene.yaml").write_text(text)
    assert (kage.folder / "scene.yaml").stat().st_size == most
    assert kage("check", "scene.yaml").returncode == 0
    refused(kage, text + "#", f"too large, expected at most {most} bytes")


@pytest.mark.parametrize("shape", ["lists", "maps", "lines"])
def test_nesting_of_a_scene(kage: Kage, shape: str) -> None:
    """No key has a value of 63 levels, but up to there only the value is wrong."""
    def text(levels: int) -> str:
        inner = levels - 3  # the scene, its objects and one of them are around it
        if shape == "lines":
            return BARE + "    bump:\n" + "".join(" " * (6 + k) + f"k{k}:\n" for k in range(inner)) + " " * 80 + "1\n"
        opening, closing = ("[", "]") if shape == "lists" else ("{k: ", "}")
        return BARE + f"    bump: {opening * inner}1{closing * inner}\n"

    (kage.folder / "scene.yaml").write_text(text(63))
    done = kage("check", "scene.yaml")
    assert done.returncode == 2 and "nested" not in done.stderr and "bump" in done.stderr, done.stderr
    for levels in (64, 65, 3000):
        refused(kage, text(levels), "nested too deep, expected at most 63 levels of maps and lists")


#: Scenes with an image for a colour, and with a map.
MAPPED = BARE + "    bump: {map: {file: big.png}, scale: 0.01, zero: 0.25, sign: up}\n"
COLOURED = BARE.replace("color: [0.8, 0.7, 0.6]", "color: {image: {file: big.png, size: [1, 1]}}")


@pytest.mark.parametrize("text", [MAPPED, COLOURED], ids=["map", "image"])
def test_sides_and_samples_of_an_image(kage: Kage, text: str) -> None:
    image = kage.folder / "big.png"
    image.write_bytes(png_of(65536, 2, 8, zlib.compress((b"\0" + b"\x40" * 65536) * 2)))
    (kage.folder / "scene.yaml").write_text(text)
    assert kage("check", "scene.yaml").returncode == 0
    for width, height, words in ((65537, 2, "65537 x 2 samples, expected at most 65536 a side"),
                                 (2, 65537, "2 x 65537 samples, expected at most 65536 a side"),
                                 (16384, 16385, f"{16384 * 16385} samples, expected at most 268435456")):
        image.write_bytes(png_of(width, height, 8, zlib.compress(b"")))
        refused(kage, text, words, "big.png")


def test_bytes_of_a_file(kage: Kage) -> None:
    """17179869184, of which none is on the disk: then it is only no image."""
    with (kage.folder / "big.png").open("wb") as file:
        file.truncate(1 << 34)
    (kage.folder / "scene.yaml").write_text(MAPPED)
    done = kage("check", "scene.yaml")
    assert done.returncode == 2 and "its first bytes are those of neither" in done.stderr, done.stderr
    with (kage.folder / "big.png").open("r+b") as file:
        file.truncate((1 << 34) + 1)
    refused(kage, MAPPED, "it has 17179869185 bytes, expected at most 17179869184", "big.png")


def test_bytes_of_a_model(kage: Kage) -> None:
    with (kage.folder / "big.stl").open("wb") as file:
        file.truncate((1 << 30) + 1)
    text = BARE.replace("sphere: {center: [1, 1, 0], radius: 0.5}", "mesh: {file: big.stl}")
    refused(kage, text, "it has 1073741825 bytes, expected at most 1073741824", "big.stl")


def test_triangles_of_a_model(kage: Kage) -> None:
    """2^24 and 4096 of them: a mesh of 4096, at 4097 places. 2^24 take too much memory for a test."""
    corners = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    indices = struct.pack("<3H", 0, 1, 2) * 4096
    data = base64.b64encode(corners + indices).decode()
    places = 4097
    (kage.folder / "many.gltf").write_text(json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(places))}],
        "nodes": [{"mesh": 0, "translation": [k, 0, 0]} for k in range(places)],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
                       "max": [1, 1, 0]},
                      {"bufferView": 1, "componentType": 5123, "count": 3 * 4096, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36},
                        {"buffer": 0, "byteOffset": 36, "byteLength": len(indices)}],
        "buffers": [{"byteLength": 36 + len(indices), "uri": f"data:application/octet-stream;base64,{data}"}],
    }))
    text = BARE.replace("sphere: {center: [1, 1, 0], radius: 0.5}", "mesh: {file: many.gltf}")
    refused(kage, text, "more than 16777216 triangles, expected no more", "many.gltf")


def test_points_of_a_list(kage: Kage) -> None:
    """A head that says more than there are is enough."""
    for points, words in ((1 << 28, "268435456 vertices in .* bytes, expected a longer file"),
                          ((1 << 28) + 1, "268435457 vertices, expected at most 268435456")):
        axes = "".join(f"property float {axis}\n" for axis in "xyz")
        (kage.folder / "dots.ply").write_text(
            f"ply\nformat ascii 1.0\nelement vertex {points}\n{axes}end_header\n0 0 0\n")
        refused(kage, BARE + "  dots:\n    copies: {of: ball, file: dots.ply}\n    material: clay\n", words, "dots.ply")


def test_patches_of_an_object(kage: Kage) -> None:
    """With so many a scene takes seconds: that all of them are looked at is enough."""
    points = "".join(f"{x} 0 {z}\n" for z in (0, 0.3, 0.6, 1) for x in (0, 0.3, 0.6, 1))
    text = BARE.replace("sphere: {center: [1, 1, 0], radius: 0.5}", "patches: {file: many.txt}")
    (kage.folder / "many.txt").write_text(points * 4095 + points.removesuffix("1\n") + "one\n")
    refused(kage, text, "'one' is no number", "many.txt")
    (kage.folder / "many.txt").write_text(points * 4097)
    refused(kage, text, "too many patches, expected at most 4096", "many.txt")


def test_lights_at_the_limit_and_beyond(kage: Kage) -> None:
    for over in (0, 1):
        lights = "".join(f"  l{k}: {{at: [0, 5, 0], color: [1, 1, 1]}}\n" for k in range(4095 + over))
        (kage.folder / "scene.yaml").write_text(BARE.replace("lights:\n", "lights:\n" + lights))
        done = kage("check", "scene.yaml", timeout=600)  # under a sanitizer on a busy machine
        assert done.returncode == (2 if over else 0), done.stderr[:400]
        assert not over or "4097 lights, expected at most 4096" in done.stderr


@not_sanitized
def test_some_failed_allocations() -> None:
    """A few of what tests/verify/allocations.py does in full."""
    ran, tried, bad = allocations.try_all(PROGRAM, 3, 12)
    assert not bad
    assert tried >= ran >= 1
