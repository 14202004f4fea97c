"""Files that can't be read or written, and what is no file: an error in words, and an older file stays."""

from __future__ import annotations

import io
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.conftest import PROGRAM, SCENE, TOP, Kage, not_sanitized
from tests.support.failing import FAILURES, OLDER, fail, make_library

CUBE = TOP / "tests" / "data" / "cube.yaml"
SMALL = ("--size", "40x30")


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_library(tmp_path_factory.mktemp("library"))


@not_sanitized
@pytest.mark.parametrize("name", ["a.exr", "a.png"])
def test_each_failing_call_is_an_error(kage: Kage, library: Path, name: str) -> None:
    """The first calls of each kind; tests/verify/files.py does all of them."""
    sites = 0
    for call, codes in FAILURES.items():
        for at in (1, 2):
            found = fail(["render", str(CUBE), *SMALL, "-o", name], name, kage.folder, library, call, at, codes[0])
            assert not found or not found.wrong, found
            sites += found is not None
    assert sites >= 8


def raw(*arguments: object, cwd: Path, stdin: bytes = b"") -> subprocess.CompletedProcess[bytes]:
    return subprocess.run([str(PROGRAM), *map(str, arguments)], cwd=cwd, input=stdin, capture_output=True, timeout=60,
                          check=False)


def test_standard_output(kage: Kage) -> None:
    """The same bytes as a file's, alone: statistics go to stderr."""
    kage.good("render", CUBE, *SMALL, "--quiet", "-o", "a.png", "-o", "a.exr")
    for output, name in (("-", "a.png"), ("png:-", "a.png"), ("/dev/stdout", "a.png"), ("exr:-", "a.exr")):
        done = raw("render", CUBE, *SMALL, "--stats", "-o", output, cwd=kage.folder)
        assert (done.returncode, done.stdout) == (0, (kage.folder / name).read_bytes())
        assert b"camera rays" in done.stderr
    assert raw("render", CUBE, "-o", "-", "-o", "exr:-", cwd=kage.folder).returncode == 2
    assert raw("pov", CUBE, "-o", "-", cwd=kage.folder).stdout.startswith(b"// cube.yaml")


def test_standard_output_is_appended_to(kage: Kage) -> None:
    """It may be a file that others write, too: it is not replaced."""
    script = f"(echo one; {PROGRAM} render {CUBE} --size 40x30 -o -; echo two) > all"
    subprocess.run(["sh", "-c", script], cwd=kage.folder, check=True, timeout=60)
    found = (kage.folder / "all").read_bytes()
    assert found.startswith(b"one\n\x89PNG") and found.endswith(b"IEND\xaeB`\x82two\n")


def test_a_terminal_gets_no_picture(kage: Kage) -> None:
    here, there = os.openpty()
    done = subprocess.run([str(PROGRAM), "render", str(CUBE), "-o", "-"], stdout=there, stderr=subprocess.PIPE,
                          cwd=kage.folder, timeout=60, check=False)
    os.close(there)
    os.close(here)
    assert done.returncode == 2
    assert b"standard output is a terminal" in done.stderr


def test_a_scene_from_standard_input(kage: Kage) -> None:
    text = CUBE.read_bytes()
    done = raw("render", "-", *SMALL, "-o", kage.folder / "a.png", cwd=CUBE.parent, stdin=text)
    assert (done.returncode, done.stderr) == (0, b"")
    kage.good("render", CUBE, *SMALL, "--quiet", "-o", "b.png")
    one, two = (np.array(Image.open(kage.folder / name)) for name in ("a.png", "b.png"))
    assert (one == two).all()
    done = raw("render", "-", cwd=kage.folder, stdin=text)
    assert (done.returncode, done.stderr) == (
        2, b"kage: a scene from standard input gives the picture no name, expected -o FILE\n")
    done = raw("check", "-", cwd=kage.folder, stdin=b"camera: 1\n")
    assert done.returncode == 2
    assert done.stderr.startswith(b"stdin:1:")


@pytest.mark.parametrize("kind", ["scene", "map", "model", "patch", "image"])
@pytest.mark.parametrize("what", ["fifo", "folder", "/dev/zero"])
def test_what_is_no_file_is_refused_as_input(kage: Kage, kind: str, what: str) -> None:
    """At once: nobody waits for a pipe."""
    ending = {"scene": "yaml", "map": "png", "model": "obj", "patch": "bpt", "image": "png"}[kind]
    path = kage.folder / f"input.{ending}"
    if what == "fifo":
        os.mkfifo(path)
    elif what == "folder":
        path.mkdir()
    else:
        path.symlink_to(what)
    Image.new("L", (4, 4)).save(kage.folder / "map.png")
    text = {"scene": SCENE, "map": SCENE.replace("map.png", path.name),
            "model": SCENE.replace("box: {from: [-1, 0.5, -1], to: [0, 1.5, 0]}", f"mesh: {{file: {path.name}}}"),
            "patch": SCENE.replace("box: {from: [-1, 0.5, -1], to: [0, 1.5, 0]}", f"patches: {{file: {path.name}}}"),
            "image": SCENE.replace("clay: {color: [0.8, 0.7, 0.6]", f"clay: {{color: {{image: {{file: {path.name}}}}}")}
    (kage.folder / "scene.yaml").write_text(text[kind])
    done = kage("check", path if kind == "scene" else "scene.yaml", timeout=30)
    assert done.returncode == 2
    assert path.name in done.stderr
    assert "Is a directory" in done.stderr if what == "folder" else "no regular file" in done.stderr


def test_a_pipe_as_output_gets_the_bytes(kage: Kage) -> None:
    os.mkfifo(kage.folder / "a.png")
    with subprocess.Popen(["cat", "a.png"], cwd=kage.folder, stdout=subprocess.PIPE) as reader:
        kage.good("render", CUBE, *SMALL, "--quiet", "-o", "a.png")
        assert reader.stdout
        assert Image.open(io.BytesIO(reader.stdout.read())).size == (40, 30)
    assert (kage.folder / "a.png").is_fifo()


def test_a_link_to_nothing_leads_to_the_picture(kage: Kage) -> None:
    (kage.folder / "links").mkdir()
    (kage.folder / "links" / "a.png").symlink_to("../b.png")
    kage.good("render", CUBE, *SMALL, "--quiet", "-o", "links/a.png")
    assert (kage.folder / "links" / "a.png").is_symlink()
    assert kage.files() == {"links", "links/a.png", "b.png"}


def test_a_file_that_grows_too_large(kage: Kage) -> None:
    """SIGXFSZ would end the program without a word."""
    (kage.folder / "a.exr").write_bytes(OLDER)
    done = subprocess.run(["sh", "-c", f"ulimit -f 20; exec {PROGRAM} render {CUBE} --size 400x300 -o a.exr"],
                          cwd=kage.folder, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (1, "a.exr: cannot be written: File too large\n")
    assert (kage.folder / "a.exr").read_bytes() == OLDER
    assert kage.files() == {"a.exr"}


def test_what_a_killed_process_left_is_named_and_removed(kage: Kage) -> None:
    (kage.folder / ".kage-1-0").write_text("left")
    done = kage("render", CUBE, *SMALL, "-o", "a.png")
    assert (done.returncode, done.stderr) == (0, ".kage-1-0: left by a process that was killed; removed\n")
    assert kage.files() == {"a.png"}
