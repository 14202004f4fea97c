"""docs/third-party.md lists all that is not kage's own: data files, linked libraries, Python packages."""

from __future__ import annotations

import re
import subprocess
from fnmatch import fnmatchcase
from pathlib import Path

import pytest

from scripts import third_party, tree
from tests.conftest import PROGRAM, TOP, not_sanitized

LIST = third_party.LIST.read_text(encoding="utf-8")

#: Sources and documents: what people write by hand. All else is data, and is listed.
WRITTEN = (".c", ".h", ".py", ".pyi", ".md", ".yaml", ".yml", ".toml", ".ini", ".cff", ".txt", ".in", ".js", ".css",
           ".html", ".jinja", ".typed", ".glsl", ".frag", ".comp", ".pov", ".supp", ".dict", ".man", ".1", ".3", ".5")
FOLDERS_OF_DATA = ("scenes/data/", "scenes/models/", "reference/", "tests/data/", "tests/golden/")


def rows(heading: str) -> list[list[str]]:
    """The cells of the table below a heading, without its first two rows."""
    part = LIST.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    return [[cell.strip() for cell in line.strip("|").split("|")]
            for line in part.splitlines() if line.startswith("|")][2:]


def named(cell: str) -> list[str]:
    return re.findall(r"`([^`]+)`", cell)


OTHERS = [name for row in rows("Data from others") for name in named(row[0])]
MADE = [(pattern, row[1]) for row in rows("Data made here") for pattern in named(row[0])]


def is_data(name: str) -> bool:
    if name.startswith(FOLDERS_OF_DATA):
        return not name.endswith((".py", ".md", ".yaml"))
    folder_of_sources = name.startswith(("src/", "include/", "debian/", "man/", "completions/")) or "/" not in name
    return not (folder_of_sources or name.endswith(WRITTEN) or is_script(name))


def is_script(name: str) -> bool:
    with (TOP / name).open("rb") as file:
        return file.read(2) == b"#!"


def unlisted(names: list[str]) -> list[str]:
    patterns = [*OTHERS, *(pattern for pattern, _ in MADE)]
    return [name for name in names if is_data(name) and not any(fnmatchcase(name, p) for p in patterns)]


def test_each_data_file_is_listed() -> None:
    assert unlisted(tree.names()) == [], "say in docs/third-party.md where it is from, or what makes it"


@pytest.mark.parametrize("name", ["docs/photo.jpg", "scenes/data/rock.txt", "tests/data/odd.tif", "bench/font.ttf"])
def test_a_new_data_file_is_noticed(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.program.test_third_party.TOP", tmp_path)
    (tmp_path / name).parent.mkdir(parents=True)
    (tmp_path / name).write_bytes(b"\x89")
    assert unlisted([name]) == [name]


def test_what_is_listed_is_there() -> None:
    names = tree.names()
    gone = [p for p in [*OTHERS, *(pattern for pattern, _ in MADE)] if not any(fnmatchcase(n, p) for n in names)]
    assert gone == []
    makers = {name for _, cell in MADE for name in named(cell)} | {
        name for row in rows("Data from others") for name in re.findall(r"scripts/\w+\.py", row[1])}
    assert len(makers) > 15 and [maker for maker in makers if not (TOP / maker).is_file()] == []


# Libraries ------------------------------------------------------------------------------------------------------------

LINKED = {file: row[2] for row in rows("Libraries") for file in named(row[1])}


def needed(path: Path) -> set[str]:
    """The libraries that a file names itself, without their versions: libpng16.so.16 is libpng16."""
    text = subprocess.run(["readelf", "-d", path], check=True, capture_output=True, text=True).stdout
    names = re.findall(r"NEEDED.*\[([^\]]+)\]", text)
    return {re.sub(r"(-\d+_\d+)?\.so.*", "", name) for name in names if not name.startswith("ld-")}


@not_sanitized
@pytest.mark.parametrize("name", ["libkage.so", "kage", "kage-import", "kage-view"])
def test_each_library_is_listed(name: str) -> None:
    path = PROGRAM.parent / name
    if name == "kage-view" and not path.exists():
        pytest.skip("kage view is not built")
    found = needed(path)
    assert found and found <= LINKED.keys(), f"{name} links {found - LINKED.keys()}"
    own = name if name.startswith("kage-") else "libkage"
    assert [lib for lib in found if own not in LINKED[lib] and LINKED[lib] not in ("all",)
            and not (name == "kage-view" and "libkage" in LINKED[lib])] == []


def test_what_the_makefile_asks_for_is_listed() -> None:
    """Also what this machine's build does without."""
    text = (TOP / "Makefile").read_text()
    packages = set(" ".join(re.findall(r"^(?:PKGS|VIEW_PKGS) *= (.*)$", text, re.MULTILINE)).replace("$(DEFLATE)", "")
                   .split()) | {"libdeflate", "assimp", "libjpeg", "embree"}
    listed = " ".join(" ".join(row[:2]) for row in rows("Libraries")).lower()
    assert len(packages) > 7 and [name for name in packages if name.lower() not in listed] == []


# Python packages ------------------------------------------------------------------------------------------------------


def test_the_python_packages_are_listed() -> None:
    assert [row[0] for row in rows("Python packages")] == sorted(third_party.required(), key=str.lower), \
        "scripts/venv python -m scripts.third_party --write"
    assert third_party.written(LIST) == LIST, "scripts/venv python -m scripts.third_party --write"


def test_no_package_without_a_licence() -> None:
    assert all(len(row[1]) > 2 for row in rows("Python packages"))
    assert third_party.license_of("numpy").startswith("BSD-3-Clause")
