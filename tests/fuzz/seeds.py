"""What the fuzzer begins with: inputs from the scenes, the tests and the documents, and the readers' own words.

Nothing is a copy under version control: seeds are made from the files of the tree when the fuzzer starts, and words are
taken from the tables in src/, so that neither can differ from what the library reads.
"""

from __future__ import annotations

import json
import random
import re
import struct
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent

#: Methods as scenes name them.
METHODS = ("none", "0", "1", "2", "2+", "iter:3", "march:4", "exact", "auto", "auto:0.5")

#: What a scene needs around a fragment of the documents.
WHOLE = {
    "camera": "camera: {from: [0, 3, -5], at: [0, 0, 0]}\n",
    "lights": "lights:\n  lamp: {at: [-4, 5, -2]}\n",
    "materials": "materials:\n  clay: {color: [0.8, 0.7, 0.6]}\n",
    "objects": "objects: {it: {sphere: {center: [0, 0, 0], radius: 1}, material: clay}}\n",
}

#: Scenes whose surfaces take seconds in instrumented code.
SLOW = ("shell", "teapot", "moebius")

SETS = (
    "render.shadow=1", "render.shadow=march:4", "render={shade: shifted, bump_shadow: march:8}", "image.size=[9, 7]",
    "camera.fov=30", "camera.from=[0, 2, -4]", "lights.lamp.at=[1, 2, -3]", "lights.second={at: [3, 3, -3]}",
    "objects.it.bump.scale=0.2", "objects.it.transform=[{scale: 2}, {rotate: [0, 10, 0]}]",
    "objects.it.transform.0.rotate=[1, 2, 3]", "objects.it.bump={function: 0.1*u}", "materials.it.color=[1, 0, 0]",
    "materials.it.reflection=0.5", 'objects.it.bump.function="sin(u)"', "objects.it.bump.function=\"a # b\"",
)


# ---- scenes ----


def with_arrays(text: str) -> str:
    """A scene's text that names the target's arrays in place of files, so that it can be read anywhere."""
    for key, array in (("map", "map"), ("image", "image"), ("mesh", "mesh")):
        text = re.sub(rf"({key}:\s*{{?\s*file:\s*)[^,}}\n]+", rf"\1array:{array}", text)
    return text


def fragments() -> Iterator[str]:
    """The examples of docs/scene.md."""
    for block in re.findall(r"```yaml\n(.*?)```", (TOP / "docs" / "scene.md").read_text(), re.DOTALL):
        fragment = block
        if fragment.startswith("bump:"):
            inside = "".join("    " + line + "\n" for line in fragment.splitlines())
            fragment = f"objects:\n  it:\n    sphere: {{center: [0, 0, 0], radius: 1}}\n    material: clay\n{inside}"
        missing = [text for key, text in WHOLE.items() if not re.search(rf"^{key}:", fragment, re.MULTILINE)]
        yield fragment + "".join(missing)


def scene_files() -> list[Path]:
    folders = ("scenes", "scenes/gallery", "tests/data", "tests/regression")
    paths = [path for folder in folders for path in sorted((TOP / folder).glob("*.yaml"))]
    return [path for path in paths if path.stem not in SLOW]


def scenes() -> Iterator[bytes]:
    texts = [with_arrays(path.read_text()) for path in scene_files()] + [with_arrays(text) for text in fragments()]
    for text in texts:
        yield text.encode()
    plain = with_arrays((TOP / "tests/data/sphere.yaml").read_text())
    for method in METHODS:
        other = re.sub(r"^render:.*\n", "", plain, flags=re.MULTILINE) + f"render: {{shadow: {method}}}\n"
        yield other.encode()


def sets() -> Iterator[bytes]:
    for line in SETS:
        yield f"{line}\n".encode()
    yield "\n".join(SETS[:8]).encode()
    for k, seed in enumerate(scenes()):
        yield f"{SETS[k % len(SETS)]}\n{SETS[(k + 5) % len(SETS)]}\n\n".encode() + seed


def expressions() -> Iterator[bytes]:
    for case in json.loads((TOP / "tests/golden/expr.json").read_text())["cases"]:
        yield case["text"].encode()
    for path in scene_files():
        for text in re.findall(r"function:\s*(.+)", path.read_text()):
            yield text.strip("\"'}").encode()


# ---- images ----


def png_chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png_file(bits: int, colour: int, interlaced: bool) -> bytes:
    """A picture of 5 x 4 pixels, grey in all of its kinds of colour."""
    channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[colour]
    row = (5 * channels * bits + 7) // 8
    alpha = bytes([255]) if channels in (2, 4) else b""
    pixel = (b"\x55" * (channels - len(alpha)) + alpha) if bits >= 8 else b"\x1b"
    wide = b"".join(byte.to_bytes(1, "big") * (bits // 8) for byte in pixel) if bits == 16 else pixel
    rows = b"".join(b"\0" + (wide * 5)[:row].ljust(row, b"\0") for _ in range(4))
    if interlaced:
        rows = rows * 2 + b"\0" * 64
    palette = png_chunk(b"PLTE", bytes(3 * [k * 16 for k in range(1)]) + bytes(range(45))) if colour == 3 else b""
    head = struct.pack(">IIBBBBB", 5, 4, bits, colour, 0, 0, int(interlaced))
    return (b"\x89PNG\r\n\x1a\n" + png_chunk(b"IHDR", head) + palette + png_chunk(b"IDAT", zlib.compress(rows))
            + png_chunk(b"IEND", b""))


def pngs() -> Iterator[bytes]:
    kinds = {0: (1, 2, 4, 8, 16), 2: (8, 16), 3: (1, 2, 4, 8), 4: (8, 16), 6: (8, 16)}
    for colour, all_bits in kinds.items():
        for bits in all_bits:
            yield png_file(bits, colour, False)
            yield png_file(bits, colour, True)
    for name in ("still-life-quarters.png", "garden leaves.png"):
        yield (TOP / "scenes/models" / name).read_bytes()


def exrs() -> Iterator[bytes]:
    for path in sorted((TOP / "tests/data").glob("*.exr")):
        yield path.read_bytes()


# ---- lists ----


def patch_files() -> Iterator[bytes]:
    lines = (TOP / "scenes/data/teapot.txt").read_text().splitlines(keepends=True)
    numbers = [line for line in lines if line.strip() and not line.startswith("#")]
    for k in range(1, 4):
        yield "".join(numbers[: 40 * k]).encode()
    for bend in ("0", "0.5", "1e3", "-1e-7"):
        points = [f"{u / 3} {w / 3} {bend if 0 < u < 3 else 0} # a point\n" for w in range(4) for u in range(4)]
        yield "".join(points).encode()
    yield b"0 0 0\n" * 16
    yield b"1e6,1e6,-1e6\n" * 16


def point_files() -> Iterator[bytes]:
    yield b"x,y,z,scale,turn,material\n0,0,0,1,0,a\n0.5,0.25,-1,0.5,90,b\n-1,0,0,2,45,\n"
    yield b"# x y z\n0 0 0\n# remark\n\n1 1 1\n"
    yield b'"x";"y";"z";sx;sy;sz;rx;ry;rz;other\n1;2;3;1;2;1;10;20;30;"q""q"\n'
    yield b"x\ty\tz\tmaterial\r\n0\t0\t0\t1\r\n1\t0\t0\t0\r\n"
    rows = b"element vertex 2\nproperty float x\nproperty float y\nproperty double z\nproperty uchar material\n"
    for kind, order in (("little", "<"), ("big", ">")):
        body = struct.pack(order + "ffdBffdB", 0, 0, 0, 1, 0.5, 0.5, 0.5, 0)
        yield b"ply\nformat binary_%s_endian 1.0\n" % kind.encode() + rows + b"end_header\n" + body
    yield (b"ply\nformat ascii 1.0\ncomment a\n" + rows
           + b"element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1\n1 1 1 0\n3 0 1 0\n")


# ---- structured bytes, which the targets read as choices ----


def choices(first: range, size: int) -> Iterator[bytes]:
    rng = random.Random(14)
    for kind in first:
        for _ in range(6):
            yield bytes([kind]) + rng.randbytes(size)


def letters() -> Iterator[bytes]:
    number = bytes([16 + 2])  # 1, in the targets' form of numbers
    small = bytes(rng for k in range(200) for rng in (64 + (k * 37) % 190,))
    for use in range(5, 12):
        named = bytes([1, 0, 8, 1]) + b"a" + bytes([0, 4, 1]) + b"b"
        yield bytes([use]) + bytes([1, 1, 3, 3 + 16, 1]) + b"note" + bytes([5, 8, 2, 0]) + small[:192] + named
        yield bytes([use, 5, 1, 1, 0]) + number * 24 + named
    scene = with_arrays((TOP / "tests/data/sphere.yaml").read_text()).encode()
    yield bytes([10, 4, 5]) + b"a.png" + bytes([9]) + b"picture.." + bytes([5, 0]) + scene
    yield bytes([11, 3, 4]) + b"note" + bytes([5, 0]) + scene
    yield from choices(range(12), 240)


SEEDS: dict[str, Callable[[], Iterator[bytes]]] = {
    "scene": scenes, "expr": expressions, "png": pngs, "exr": exrs, "patch": patch_files, "points": point_files,
    "mesh": letters, "set": sets,
    "film": lambda: (data for seeds in (choices(range(6), 120), (b"\4" + exr for exr in exrs())) for data in seeds),
}


def write(target: str, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for k, data in enumerate(SEEDS[target]()):
        (folder / f"seed-{k:03}").write_bytes(data)


# ---- words ----


def table_words(*folders: str) -> set[str]:
    """Words in the texts of the sources there: keys, kinds and choices as the readers' tables have them."""
    found: set[str] = set()
    for folder in folders:
        for path in sorted((TOP / "src" / folder).glob("*.c")):
            for text in re.findall(r'"((?:[^"\\\n]|\\.)*)"', path.read_text()):
                if re.fullmatch(r"[a-z_0-9:+ ]+", text):
                    found |= {word for word in text.split() if 1 < len(word) < 20}
    return found


def words(target: str) -> list[str]:
    """The target's dictionary, in libFuzzer's form."""
    found = set()
    if target in ("scene", "set"):
        found = table_words("read", "geometry", "patch", "method", "texture") | {*METHODS, "array:map", "array:image"}
    if target in ("scene", "set", "expr"):
        rows = r'(?:ELEMENTARY|CURVED|ROW)\((\w+), "|(?:\.name = |ROW\(|\{)"(\w+)", (?:\.least|CHAIN|[\w, ]+\.)'
        texts = [path.read_text() for path in (TOP / "src" / "expr").glob("*.c")]
        found |= {f"{first or second}(" for text in texts for first, second in re.findall(rows, text)}
    if target == "points":
        found = table_words("points") | set(re.findall(r'\{"(\w+)", (?:PLACES|SCALES|ANGLES)', (
            TOP / "src/read/copies.c").read_text()))
    if target == "set":
        found |= {line for line in SETS if '"' not in line}
    lines = [f'"{word}"' for word in sorted(found)]
    kept = HERE / f"{target}.dict"
    return lines + (kept.read_text().splitlines() if kept.exists() else [])
