"""What docs/versioning.md promises, as far as a test can hold it: interfaces, scene files, layers; and one version."""

from __future__ import annotations

import copy
import json
import re
import subprocess
from typing import Any

import OpenEXR
import pytest
import yaml

from tests.conftest import PROGRAM, TOP, Kage, not_sanitized
from tests.support import abi

PROMISE = (TOP / "docs" / "versioning.md").read_text(encoding="utf-8")
HEADER = abi.HEADER.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def kept() -> dict[str, Any]:
    return json.loads(abi.KEPT.read_text())


def breaks(kept: dict[str, Any]) -> bool:
    """Whether this is no release of the major version that was kept: 0 promises nothing, and a new one may break."""
    return abi.major() in (0, kept["major"] + 1)


def version() -> str:
    return re.findall(r'define KAGE_VERSION "([^"]+)"', HEADER)[0]


# Interfaces -----------------------------------------------------------------------------------------------------------


def test_programs_built_with_the_last_release_still_run(kept: dict[str, Any]) -> None:
    assert len(kept["kage.h"]["functions"]) > 40 and len(kept["kage.h"]["structs"]) > 20
    assert abi.broken(kept["kage.h"], abi.of_header(HEADER)) == [] or breaks(kept)


@pytest.mark.parametrize(("old", "new", "words"), [
    ("KAGE_API int kage_errors_count(", "KAGE_API int kage_errors_number(", "kage_errors_count was"),
    ("KAGE_API int kage_errors_count(", "KAGE_API long kage_errors_count(", "kage_errors_count was"),
    ("int bits; ", "int depth, bits; ", "kage_write_options.bits was at 0"),
    ("const char *name, *value;", "const char *name, *value, *more;", "kage_metadata had 16 bytes"),
    ("KAGE_U8, KAGE_U16", "KAGE_U16, KAGE_U8", "KAGE_U8 was 0"),
    ("typedef int kage_progress(void *user,", "typedef int kage_progress(int line, void *user,", "kage_progress was"),
])
def test_a_change_of_the_header_is_noticed(old: str, new: str, words: str) -> None:
    assert old in HEADER
    found = abi.broken(abi.of_header(HEADER), abi.of_header(HEADER.replace(old, new, 1)))
    assert [line for line in found if line.startswith(words)], found


def test_an_addition_is_no_change() -> None:
    """A function, an option in place of a reserved field, a field at the end of what only the library makes."""
    text = HEADER.replace("KAGE_API int kage_errors_count(", "KAGE_API int kage_more(void);\nKAGE_API int "
                          "kage_errors_count(", 1)
    text, options = re.subn(r"void \*reserved\[(\d)\];(\s*\} kage_write_options;)",
                            lambda m: f"const char *more; void *reserved[{int(m[1]) - 1}];{m[2]}", text)
    text, stats = re.subn(r"\} kage_stats;", "int64_t more; } kage_stats;", text)
    assert (options, stats) == (1, 1) and abi.broken(abi.of_header(HEADER), abi.of_header(text)) == []


def test_the_formulas_keep_their_parameters(kept: dict[str, Any]) -> None:
    now = json.loads(json.dumps(abi.of_formulas()))
    assert len(now) > 30
    assert {name: now.get(name) for name in kept["bumpshadow.h"]} == kept["bumpshadow.h"] or breaks(kept)


@not_sanitized
def test_the_package_keeps_its_names(kept: dict[str, Any]) -> None:
    assert len(kept["python"]) > 40
    assert abi.broken_package(kept["python"], abi.of_package()) == [] or breaks(kept)


def test_a_change_of_the_package_is_noticed(kept: dict[str, Any]) -> None:
    now = copy.deepcopy(kept["python"])
    for right in ([*now["kage.load"], "more?"], ["=more?", *now["kage.load"]]):
        assert abi.broken_package(kept["python"], now | {"kage.load": right}) == []
    for wrong in ([], ["other", *now["kage.load"]], [*now["kage.load"], "=needed"]):
        assert abi.broken_package(kept["python"], now | {"kage.load": wrong})
    del now["kage.load"]
    assert abi.broken_package(kept["python"], now) == ["kage.load is gone"]


# Scene files and layers -----------------------------------------------------------------------------------------------


def test_a_scene_of_the_first_version_is_read(kage: Kage) -> None:
    """With every layer that is promised."""
    scene = TOP / "tests" / "data" / "scene-1.0.yaml"
    done = kage("render", scene, "--size", "32x24", "--quiet", "-o", "a.exr")
    assert done.returncode == 0, done.stderr
    with OpenEXR.File(str(kage.folder / "a.exr"), separate_channels=True) as file:
        channels, header = set(file.channels()), set(file.header())
    layers = PROMISE.split("**EXR layers.**")[1].split("\n\n")[0]
    promised = set(re.findall(r"`([\w.]+)`", layers)) | set(re.findall(r"`(kage:\w+)`", layers))
    lights = yaml.safe_load(scene.read_text())["lights"]
    wanted = (promised - {"visibility.LIGHT"}) | {f"visibility.{name}" for name in lights}
    assert len(wanted) > 20 and wanted <= channels | header, wanted - channels - header


# One version ----------------------------------------------------------------------------------------------------------


def test_the_version_is_the_same_everywhere() -> None:
    told = subprocess.run([PROGRAM, "--version"], check=True, capture_output=True, text=True).stdout
    assert re.search(rf"\b{re.escape(version())}\b", told), told
    citation = yaml.safe_load((TOP / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["version"] == version()
    changelog = (TOP / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.findall(r"^## (\S+)", changelog, re.MULTILINE)[0] == version(), "CHANGELOG.md begins with another version"
    debian = (TOP / "debian" / "changelog").read_text(encoding="utf-8")
    assert re.match(r"kage \(([\d.]+)-\d+\)", debian)[1] == version()
    design = (TOP / "docs" / "design.md").read_text(encoding="utf-8")
    assert f"kage {'.'.join(version().split('.')[:2])}" in design.split("\n\n")[1], "docs/design.md, first paragraph"


def test_the_promise_is_of_this_major_version() -> None:
    major = version().split(".")[0]
    assert re.findall(r"libkage\.so\.(\d+)", PROMISE) == [major]
    told = subprocess.run(["readelf", "-d", PROGRAM.parent / "libkage.so"], check=True, capture_output=True, text=True)
    assert f"[libkage.so.{major}]" in told.stdout


def test_the_citation_is_complete() -> None:
    """What version 1.2.0 of the format requires, and whom to cite first."""
    citation = yaml.safe_load((TOP / "CITATION.cff").read_text(encoding="utf-8"))
    assert {"cff-version", "message", "title", "authors"} <= citation.keys() and citation["cff-version"] == "1.2.0"
    assert citation["license"] == "MIT" and (TOP / "LICENSE").read_text().startswith("MIT License")
    paper = citation["preferred-citation"]
    assert {"type", "title", "authors"} <= paper.keys() and paper["doi"] == "10.1007/BF01900827"
    assert paper["doi"] in (TOP / "docs" / "method.md").read_text()
    assert [author["family-names"] for author in paper["authors"]] == ["Noma", "Sumi"]


def test_copies_carry_the_licence() -> None:
    """The two files that people copy into their projects hold all of its text."""
    words = (TOP / "LICENSE").read_text().split()[2:]
    for name in ("bumpshadow.h", "bumpshadow.glsl"):
        text = re.sub(r"^ \*", "", (TOP / "include" / name).read_text(), flags=re.MULTILINE).replace("*/", "").split()
        assert any(text[i:i + len(words)] == words for i in range(len(text))), name
