"""The source archive: the same bytes each time, all files and no others, and nothing in it that needs a repository.

tests/verify/dist.py builds it, and runs all tests there.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest

from scripts import dist, tree
from tests.conftest import PROGRAM, TOP


@pytest.fixture(scope="module")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return dist.make(TOP, tmp_path_factory.mktemp("dist"))


@pytest.fixture(scope="module")
def unpacked(archive: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("unpacked")
    subprocess.run(["tar", "-x", "-f", archive, "-C", folder], check=True)
    (top,) = folder.iterdir()
    return top


def test_it_is_named_after_the_version(archive: Path, unpacked: Path) -> None:
    assert archive.name == f"kage-{dist.version()}.tar.gz" and unpacked.name == f"kage-{dist.version()}"


def test_it_holds_the_tree(archive: Path) -> None:
    with tarfile.open(archive) as file:
        members = file.getmembers()
    names = [member.name.split("/", 1)[1] for member in members]
    assert names == sorted(names)
    listed = tree.git("ls-files", "-z").decode().split("\0")[:-1] if tree.is_repository() else tree.names()
    assert set(names) == set(listed) or tree.git("status", "--porcelain")
    assert {(m.uid, m.gid, m.uname, m.gname) for m in members} == {(0, 0, "root", "root")}
    assert {m.mode for m in members} == {0o644, 0o755} and len({m.mtime for m in members}) == 1


def test_the_same_bytes_again(archive: Path, unpacked: Path, tmp_path: Path) -> None:
    """From this tree, and from the archive itself, in whatever order and with whatever rights its files lie there."""
    assert dist.make(TOP, tmp_path / "again").read_bytes() == archive.read_bytes()
    (unpacked / "README.md").chmod(0o664)
    assert not tree.is_repository(unpacked)
    assert dist.make(unpacked, tmp_path / "unpacked").read_bytes() == archive.read_bytes()


def test_another_file_or_date_changes_the_bytes(archive: Path, unpacked: Path, tmp_path: Path,
                                                monkeypatch: pytest.MonkeyPatch) -> None:
    added = unpacked / "docs" / "added.md"
    added.write_text("# Added\n")
    assert dist.make(unpacked, tmp_path / "added").read_bytes() != archive.read_bytes()
    added.unlink()
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    made = dist.make(TOP, tmp_path / "dated")
    assert made.read_bytes() != archive.read_bytes()
    with tarfile.open(made) as file:
        assert {member.mtime for member in file} == {86400}


def test_all_that_is_built_is_in_it(unpacked: Path) -> None:
    """make finds every source of the programs, the library and the package."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("MAKE", "MFLAGS"))}
    done = subprocess.run(["make", "-n", "BOOTSTRAP=no", "BUILD=new", f"PYTHON={sys.executable}", "programs", "python"],
                          cwd=unpacked, env=environment, capture_output=True, text=True)
    assert done.returncode == 0 and " -o new/kage " in done.stdout, done.stderr


def test_it_renders_and_passes_a_test_of_its_own(unpacked: Path, tmp_path: Path) -> None:
    subprocess.run([PROGRAM, "render", unpacked / "scenes" / "terrain.yaml", "--size", "32x24", "--quiet", "-o",
                    tmp_path / "a.png"], check=True)
    done = subprocess.run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider",
                           "tests/program/test_third_party.py", "-k", "listed or there"], cwd=unpacked,
                          env={**os.environ, "KAGE": str(PROGRAM), "PYTHONPATH": ""}, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
