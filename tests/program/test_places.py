"""A disk that is full, one that is read-only, a folder that is closed or goes away, and a file that two write: an error
in words, nothing left, and the older file stays.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import PROGRAM, TOP, Kage, not_sanitized, start
from tests.support.failing import OLDER, make_library
from tests.support.places import (
    Done,
    may_mount,
    on_read_only_disk,
    on_small_disk,
    remove,
    where_writes_fail,
    without_permission,
)
from tests.support.stops import cpu_seconds, left_over, open_bytes, wait_until

CUBE = TOP / "tests" / "data" / "cube.yaml"
CORNER = TOP / "scenes" / "models" / "corner.glb"
BRING = ["import", CORNER, "--overwrite", "--quiet", "-o", "a.yaml"]

#: What is written, the file that does not fit, the pages of the disk, and the writes that go well where a library
#: stands in for the disk. The older file takes a page. Of the last, all images fit, but the scene does not.
TOO_MUCH: dict[str, tuple[list[object], str, int, int]] = {
    "png": (["render", CUBE, "--size", "160x120", "-o", "a.png"], "a.png", 4, 0),
    "exr": (["render", CUBE, "--size", "160x120", "-o", "a.exr"], "a.exr", 4, 1),
    "pov": (["pov", CUBE, "-o", "a.pov"], "a.pov", 1, 0),
    "image": (BRING, "a-planks.png", 4, 2),
    "import": (BRING, "a.yaml", 9, 3),
}


#: Disks: real ones, and as the library has them.
both_disks = pytest.mark.parametrize("real", [True, False] if may_mount() else [False],
                                     ids=lambda real: "disk" if real else "stand-in")


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_library(tmp_path_factory.mktemp("library"))


@not_sanitized
@pytest.mark.parametrize("name", TOO_MUCH)
@both_disks
def test_a_full_disk(kage: Kage, library: Path, name: str, real: bool) -> None:
    command, file, pages, writes = TOO_MUCH[name]
    output = str(command[-1])
    done = (on_small_disk(kage.folder, pages, command, [output]) if real else
            where_writes_fail(kage.folder, library, writes, command, [output]))
    assert done.status == 1
    assert done.said.splitlines()[-1] == f"{file}: cannot be written: No space left on device"
    assert done.files() == {output: OLDER}


@not_sanitized
@both_disks
def test_a_disk_that_fills_up_under_an_unfinished_picture(kage: Kage, library: Path, real: bool) -> None:
    """What is there of it stays, and is gone on with where there is room."""
    command = ["render", CUBE, "--size", "160x120", "--resume", "-o", "a.exr"]
    done = (on_small_disk(kage.folder, 50, command, ["a.exr"]) if real else
            where_writes_fail(kage.folder, library, 8, command, ["a.exr"]))
    assert (done.status, done.said) == (1, "a.exr: cannot be written: No space left on device\n")
    files = done.files()
    assert files["a.exr"] == OLDER and set(files) == {"a.exr", "a.exr.part"}
    assert kage(*command, cwd=done.folder).returncode == 0
    kage.good("render", CUBE, "--size", "160x120", "--quiet", "-o", "whole.exr")
    assert done.files() | {"whole.exr": b""} == {"a.exr": (kage.folder / "whole.exr").read_bytes(), "whole.exr": b""}


Place = Callable[..., Done]
CLOSED: dict[str, tuple[Place, str]] = {"folder": (without_permission, "Permission denied")}
if may_mount():
    CLOSED["disk"] = on_read_only_disk, "Read-only file system"


@pytest.mark.parametrize("there", [True, False], ids=["older", "none"])
@pytest.mark.parametrize("name", ["a.png", "a.exr", "resume.exr", "a.pov", "a.yaml"])
@pytest.mark.parametrize("place", CLOSED)
def test_nothing_can_be_written(kage: Kage, place: str, name: str, there: bool) -> None:
    """An error before the work: the pictures would take minutes, and the model is none."""
    run, why = CLOSED[place]
    (kage.folder / "none.obj").write_text("no model")
    picture: list[object] = ["render", CUBE, "--size", "8000x6000", "--aa", "8"]
    commands: dict[str, list[object]] = {"a.pov": ["pov", CUBE], "resume.exr": [*picture, "--resume"],
                                         "a.yaml": ["import", "../none.obj", "--overwrite"]}
    done = run(kage.folder, [*commands.get(name, picture), "-o", name], [name] * there)
    assert (done.status, done.said) == (1, f"{name}: cannot be written: {why}\n")
    assert done.files() == ({name: OLDER} if there else {})


#: Wait until a process has begun with its work: a picture of all layers is being written, or only rendered.
def writes(process: subprocess.Popen[str]) -> None:
    wait_until(process, lambda: open_bytes(process) > 1 << 18)


def renders(process: subprocess.Popen[str]) -> None:
    wait_until(process, lambda: cpu_seconds(process.pid) > 0.05)


@pytest.mark.parametrize(("command", "begun"), [
    (["render", CUBE, "--size", "1200x900", "--aa", "8", "-o", "gone/a.png"], renders),
    (["render", CUBE, "--size", "2000x1500", "-o", "gone/a.exr"], writes),
    (["render", CUBE, "--size", "1000x700", "--aa", "6", "--resume", "-o", "gone/a.exr"], renders),
    (["pov", CUBE, "--set", "render.surface=displaced", "--size", "400x300", "-o", "gone/a.pov"], writes),
], ids=["png", "exr", "resume", "pov"])
def test_a_folder_that_goes_away(kage: Kage, command: list[object],
                                 begun: Callable[[subprocess.Popen[str]], None]) -> None:
    (kage.folder / "gone").mkdir()
    process = start([PROGRAM, *command], cwd=kage.folder, stderr=subprocess.PIPE, text=True)
    begun(process)
    remove(kage.folder / "gone")
    _, said = process.communicate(timeout=120)
    # an EXR that can be resumed is FILE.part until it is whole, and the folder may go away before or after that
    where = re.escape(str(command[-1])) + (r"(\.part)?" if "--resume" in command else "")
    assert process.returncode == 1
    assert re.fullmatch(where + ": cannot be written: No such file or directory\n", said), said
    assert kage.files() == set()


# ---- one file, and two that write it ----

BRIGHT = ["--set", "lights.lamp.color=[2, 2, 2]"]
BOTH: dict[str, tuple[list[object], list[str], str]] = {
    "png": (["render", CUBE, "--size", "160x120", "--quiet"], BRIGHT, "a.png"),
    "exr": (["render", CUBE, "--size", "160x120", "--quiet"], BRIGHT, "a.exr"),
    "resume": (["render", CUBE, "--size", "160x120", "--quiet", "--resume"], BRIGHT, "a.exr"),
    "pov": (["pov", CUBE], BRIGHT, "a.pov"),
    "import": (["import", CORNER, "--overwrite", "--quiet"], ["--brightness", "2"], "a.yaml"),
}


@pytest.mark.parametrize("name", BOTH)
def test_two_at_once(kage: Kage, name: str) -> None:
    """Each replaces the file by a whole one, or says that the other is at it."""
    one, more, output = BOTH[name]
    commands, wanted = (one, [*one, *more]), []
    for command in commands:
        kage(*command, "-o", output)
        wanted.append((kage.folder / output).read_bytes())
    assert wanted[0] != wanted[1]
    files = kage.files()
    for _ in range(2):
        (kage.folder / output).write_bytes(OLDER)
        both = [start([PROGRAM, *command, "-o", output], cwd=kage.folder, stderr=subprocess.PIPE, text=True)
                for command in commands]
        said = [process.communicate(timeout=120)[1] for process in both]
        ended = [process.returncode for process in both]
        assert 0 in ended
        for status, words in zip(ended, said, strict=True):
            assert not status or (status == 1 and name == "resume" and "another process" in words), said
        assert (kage.folder / output).read_bytes() in [w for w, status in zip(wanted, ended, strict=True) if not status]
        assert kage.files() == files and not left_over(kage.folder)


def test_one_that_is_at_it_refuses_the_other(kage: Kage) -> None:
    """Only an unfinished picture has a name that both would write to."""
    command = ["render", CUBE, "--size", "1000x700", "--aa", "6", "--resume", "-o", "a.exr"]
    process = start([PROGRAM, *command], cwd=kage.folder, stderr=subprocess.PIPE, text=True)
    wait_until(process, lambda: (kage.folder / "a.exr.part").exists() and cpu_seconds(process.pid) > 0.05)
    done = kage(*command)
    assert (done.returncode, done.stderr) == (
        1, "a.exr.part: cannot be written: another process writes it\n")
    assert process.communicate(timeout=120)[1] == "" and process.returncode == 0
    assert kage.files() == {"a.exr"}


@pytest.mark.parametrize(("first", "second"), [
    ("a.png", "a.png"), ("a.exr", "./a.exr"), ("a.png", "links/../a.png"), ("a.png", "links/to.png"),
    ("links/to.png", "links/again.png"),
])
@pytest.mark.parametrize("there", [True, False], ids=["older", "none"])
def test_the_same_output_twice(kage: Kage, first: str, second: str, there: bool) -> None:
    """The second would silently replace the first."""
    (kage.folder / "links").mkdir()
    for name in ("to", "again"):
        (kage.folder / "links" / f"{name}.png").symlink_to("../a.png")
    output = "a" + Path(first).suffix
    if there:
        (kage.folder / output).write_bytes(OLDER)
    files = kage.files()
    done = kage("render", CUBE, "-o", first, "-o", "b.png", "-o", second)
    assert (done.returncode, done.stderr) == (
        2, f"kage: -o {second}: the same file as -o {first}, expected another one\n")
    assert kage.files() == files
    assert not there or (kage.folder / output).read_bytes() == OLDER


def test_other_outputs_are_not_the_same(kage: Kage) -> None:
    """Of the same name in another folder; pipes; a second kind of picture."""
    (kage.folder / "b").mkdir()
    kage.good("render", CUBE, "--size", "40x30", "--quiet", "-o", "a.png", "-o", "b/a.png", "-o", "a.exr")
    assert kage.files() == {"a.png", "a.exr", "b", "b/a.png"}
    shutil.rmtree(kage.folder / "b")
    for name in ("null.png", "none.png"):
        (kage.folder / name).symlink_to("/dev/null")
    kage.good("render", CUBE, "--size", "40x30", "--quiet", "-o", "null.png", "-o", "none.png")
