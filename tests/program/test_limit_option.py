"""The option --limit: of what is exactly at each limit nothing is refused, and one beyond is, with its place."""

from __future__ import annotations

import json
import re
import shutil
import struct
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import PROGRAM, SCENE, TOP, Kage
from tests.program.test_limits import BARE, png, stl

BALL = "sphere: {center: [1, 1, 0], radius: 0.5}"


def bumped(function: str) -> str:
    return BARE.replace(BALL, f"{BALL}\n    bump: {{function: \"{function}\"}}")


def shaped(shape: str) -> str:
    return BARE.replace(BALL, shape)


def mapped(folder: Path) -> str:
    png(folder / "map.png", 8)
    return SCENE


def patched(folder: Path) -> str:
    """Two patches, flat and side by side."""
    points = [f"{x + patch} 0 {z}" for patch in range(2) for z in (0, 0.3, 0.6, 1) for x in (0, 0.3, 0.6, 1)]
    (folder / "two.txt").write_text("\n".join(points) + "\n")
    return shaped("patches: {file: two.txt}")


def inline_patches(folder: Path) -> str:
    patched(folder)
    points = [f"[{line.replace(' ', ', ')}]" for line in (folder / "two.txt").read_text().splitlines()]
    both = ", ".join(f"[{', '.join(points[at : at + 16])}]" for at in (0, 16))
    return shaped(f"patches: {{points: [{both}]}}")


def copied(folder: Path) -> str:
    """Five places; a comment and an empty line are none."""
    (folder / "dots.csv").write_text("x,y,z\n0,0,0\n1,0,0\n\n# more\n2,0,0\n3,0,0\n4,0,0\n")
    return BARE + "  dots:\n    copies: {of: ball, file: dots.csv}\n    material: clay\n"


def copied_ply(folder: Path) -> str:
    head = "ply\nformat binary_little_endian 1.0\nelement vertex 5\n" + "".join(
        f"property float {axis}\n" for axis in "xyz") + "end_header\n"
    (folder / "dots.ply").write_bytes(head.encode() + struct.pack("<15f", *range(15)))
    return BARE + "  dots:\n    copies: {of: ball, file: dots.ply}\n    material: clay\n"


def model(folder: Path) -> str:
    stl(folder / "hills.stl", 2)
    return shaped("mesh: {file: hills.stl}")


def coloured(folder: Path) -> str:
    png(folder / "map.png", 8)
    return BARE.replace("color: [0.8, 0.7, 0.6]", "color: {image: {file: map.png, size: [1, 1]}}")


#: The limit, the scene that is made in a folder, how many it has, and where the error of one fewer is.
PLACE = r"scene\.yaml:\d+:\d+: "
CASES: list[tuple[str, Callable[[Path], str], int, str]] = [
    ("scene", lambda _: BARE, len(BARE), r"scene\.yaml: "),
    ("nesting", lambda _: shaped(f"{BALL}\n    transform: [{{rotate: [0, 10, 0]}}]"), 6, PLACE),
    ("expression", lambda _: BARE, 12, PLACE),
    ("expression-nesting", lambda _: bumped("-((u))^2"), 3, PLACE),
    ("picture", lambda _: BARE, 40, PLACE),
    ("depth", lambda _: BARE.replace("aa: 1", "aa: 1, depth: 3"), 3, PLACE),
    ("objects", lambda _: BARE, 4, PLACE),
    ("side", mapped, 8, PLACE),
    ("side", coloured, 8, PLACE),
    ("samples", mapped, 64, PLACE),
    ("samples", coloured, 64, PLACE),
    ("copies", copied, 5, r"dots\.csv:8:1: "),
    ("copies", copied_ply, 5, r"dots\.ply: "),
    ("triangles", model, 8, PLACE),
    ("patches", patched, 2, r"two\.txt:17:1: "),
    ("patches", inline_patches, 2, PLACE),
]


def limits(kage: Kage) -> dict[str, str]:
    return {limit["name"]: limit["most"] for limit in json.loads(kage.good("table"))["limits"]}


def refused(kage: Kage, what: str, most: int, place: str, *words: object) -> None:
    """One beyond: with place, figure and option, and nothing is written."""
    before = kage.files()
    done = kage("render", "scene.yaml", *words, "--limit", f"{what}={most}", "-q", "-o", "out.png")
    assert done.returncode == 2, done.stderr
    assert re.match(rf"(?:\S*/)?{place}.*\b{most}\b.*\(--limit {what}\)\n", done.stderr), done.stderr
    assert kage.files() == before


@pytest.mark.parametrize(("what", "scene", "has", "place"), CASES,
                         ids=[f"{what}-{scene.__name__.strip('<>')}" for what, scene, _, _ in CASES])
def test_at_each_limit_and_beyond(kage: Kage, what: str, scene: Callable[[Path], str], has: int, place: str) -> None:
    (kage.folder / "scene.yaml").write_text(scene(kage.folder))
    kage.good("render", "scene.yaml", "--limit", f"{what}={has}", "-q", "-o", "good.png")
    refused(kage, what, has - 1, place)


@pytest.mark.parametrize(("scene", "name"), [
    (mapped, "map.png"), (coloured, "map.png"), (copied, "dots.csv"), (patched, "two.txt"), (model, "hills.stl"),
], ids=["map", "image", "copies", "patches", "model"])
def test_bytes_of_each_kind_of_file(kage: Kage, scene: Callable[[Path], str], name: str) -> None:
    (kage.folder / "scene.yaml").write_text(scene(kage.folder))
    size = (kage.folder / name).stat().st_size
    kage.good("render", "scene.yaml", "--limit", f"file={size}", "-q", "-o", "good.png")
    refused(kage, "file", size - 1, PLACE + rf"'{name}' can't be used: it has {size} bytes")


def test_every_limit_has_a_case(kage: Kage) -> None:
    assert set(limits(kage)) == {what for what, *_ in CASES} | {"file"}


@pytest.mark.parametrize("words", [
    ("check", "scene.yaml"), ("render", "scene.yaml", "-o", "out.exr"), ("pixel", "scene.yaml", "20,15"),
    ("pov", "scene.yaml", "-o", "out.pov"), ("view", "scene.yaml"),
], ids=lambda words: words[0])
def test_every_command_that_reads_a_scene_has_it(kage: Kage, words: tuple[str, ...]) -> None:
    (kage.folder / "scene.yaml").write_text(mapped(kage.folder))
    before = kage.files()
    done = kage(*words, "--limit", "samples=64", "--limit=side=7")
    assert done.returncode == 2
    assert re.match(PLACE + r".*8 x 8 samples, expected at most 7 a side \(--limit side\)\n", done.stderr), done.stderr
    assert kage.files() == before


@pytest.mark.parametrize(("limit", "words"), [
    ("file=1000", r"corner.glb: it has \d+ bytes, expected at most 1000 \(--limit file\)"),
    ("triangles=5", r"'corner.glb' can't be used: \d+ triangles, expected 1 to 5 \(--limit triangles\)"),
    ("side=2", r"samples, expected at most 2 a side \(--limit side\)"),
])
def test_an_imported_model_is_within_them(kage: Kage, limit: str, words: str) -> None:
    shutil.copy(TOP / "scenes" / "models" / "corner.glb", kage.folder)
    done = kage("import", "corner.glb", "-o", "x.yaml", "--limit", limit)
    assert done.returncode == 2
    assert re.search(words, done.stderr), done.stderr
    assert kage.files() == {"corner.glb"}


def test_what_the_scene_leaves_out_is_within_them(kage: Kage) -> None:
    """The picture's size, and the depth where something mirrors."""
    text = BARE.replace("size: [40, 30], ", "")
    (kage.folder / "scene.yaml").write_text(text)
    refused(kage, "picture", 639, PLACE + "no size of the picture, which is then 640 x 480 pixels")
    kage.good("check", "scene.yaml", "--limit", "picture=640")
    kage.good("check", "scene.yaml", "--limit", "depth=1")
    (kage.folder / "scene.yaml").write_text(BARE.replace("diffuse: 0.8", "diffuse: 0.8, reflection: 0.3"))
    refused(kage, "depth", 4, PLACE + "no depth, which is then 5 rays in a row")
    kage.good("check", "scene.yaml", "--limit", "depth=5")
    refused(kage, "depth", 4, "--set:1:14: ", "--set", "render.depth=5")


def test_changes_are_within_them(kage: Kage) -> None:
    (kage.folder / "scene.yaml").write_text(BARE)
    refused(kage, "picture", 50, "--set:1:13: ", "--size", "51x10")
    refused(kage, "nesting", 5, "--set:1:34: ", "--set", "objects.ball.transform=[{rotate: [0, 10, 0]}]")
    refused(kage, "expression", 3, "--set:1:33: ", "--set", "objects.ground.bump.function=u+w*u")


def test_standard_input_is_within_them(kage: Kage) -> None:
    """It is not read to its end."""
    for text, status in ((BARE, 0), (BARE + "#", 2), (BARE + "#" * 1_000_000, 2)):
        done = subprocess.run([PROGRAM, "check", "-", "--limit", f"scene={len(BARE)}"], input=text, text=True,
                              capture_output=True, cwd=kage.folder, timeout=60)
        assert done.returncode == status
        assert not status or ("too large" in done.stderr and "(--limit scene)" in done.stderr), done.stderr


@pytest.mark.parametrize(("value", "words"), [
    ("sides=4", "did you mean 'side'?"),
    ("expresion=4K", "did you mean 'expression'?"),
    ("whatever=4", "no such limit, expected WHAT=N with one of: scene nesting expression"),
    ("side", "expected side=N, N from 1 to 65536"),
    ("side=", "expected side=N"),
    ("side=0", "expected side=N"),
    ("side=-1", "expected side=N"),
    ("side=1K", "expected side=N"),
    ("side=1.5", "expected side=N"),
    ("side=99999999999999999999", "expected side=N"),
    ("scene=1Q", "expected scene=N, N from 1 to 64M"),
    ("=4", "no such limit"),
    ("", "no such limit"),
])
def test_no_limit(kage: Kage, value: str, words: str) -> None:
    (kage.folder / "scene.yaml").write_text(BARE)
    done = kage("check", "scene.yaml", "--limit", value)
    assert done.returncode == 2
    assert done.stderr.startswith(f"kage: --limit {value}: ") and words in done.stderr, done.stderr


def test_no_limit_can_be_raised(kage: Kage) -> None:
    (kage.folder / "scene.yaml").write_text(BARE)
    for name, most in limits(kage).items():
        unit = most.lstrip("0123456789")
        kage.good("check", "scene.yaml", "--limit", f"{name}={most}")
        done = kage("check", "scene.yaml", "--limit", f"{name}={int(most.removesuffix(unit)) + 1}{unit}")
        assert done.returncode == 2
        assert f"N from 1 to {most} " in done.stderr


def test_a_later_one_counts(kage: Kage) -> None:
    (kage.folder / "scene.yaml").write_text(BARE)
    kage.good("check", "scene.yaml", "--limit", "objects=1", "--limit", "objects=4")


def test_units(kage: Kage) -> None:
    (kage.folder / "scene.yaml").write_text(BARE + "#" * (1024 - len(BARE)))
    kage.good("check", "scene.yaml", "--limit", "scene=1K")
    (kage.folder / "scene.yaml").write_text(BARE + "#" * (1025 - len(BARE)))
    refused(kage, "scene", 1024, r"scene\.yaml: ")
