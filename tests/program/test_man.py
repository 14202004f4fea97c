"""The manual pages are made from what they describe, are good roff, and are where `man` looks for them."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from scripts import man, roff
from tests.conftest import PROGRAM, TOP

PAGES = ("man/kage.1", "man/kage-scene.5", "man/kage.3", "man/bumpshadow.3")


def run(*command: object) -> str:
    """What a program says of a page. CI must have it."""
    if not shutil.which(str(command[0])):
        assert not os.environ.get("CI"), f"CI has no {command[0]}"
        pytest.skip(f"no {command[0]}")
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    return done.stdout + done.stderr


def shown(page: str) -> str:
    return re.sub(r".\x08", "", run("mandoc", "-T", "utf8", "-O", "width=78", TOP / page))


def test_fresh() -> None:
    for name, text in man.pages(PROGRAM).items():
        assert (TOP / name).read_text() == text, f"{name}: make manuals"


@pytest.mark.parametrize("page", PAGES)
def test_good_roff(page: str) -> None:
    assert run("mandoc", "-T", "lint", "-W", "warning", TOP / page) == ""
    assert run("groff", "-man", "-Tutf8", "-ww", "-z", TOP / page) == ""


def test_the_program_is_described() -> None:
    text = shown("man/kage.1")
    table = man.read_table(PROGRAM)
    for option in table["options"]:
        assert re.search(rf"^ +(-\w, )?{re.escape(option['name'])}\b", text, re.MULTILINE), option["name"]
    assert "Where shadow rays start; kage methods lists the methods." in text
    assert max(map(len, text.splitlines())) <= 80


def test_every_function_is_described() -> None:
    for page, header, pattern in (("man/kage.3", "kage.h", r"KAGE_API[^;(]*?\b(kage_\w+)\("),
                                  ("man/bumpshadow.3", "bumpshadow.h", r"^static inline \w+ (bs_\w+)\(")):
        text = shown(page)
        names = re.findall(pattern, (TOP / "include" / header).read_text(), re.MULTILINE)
        assert len(names) > 20
        for name in names:
            assert re.search(rf"^ {{7}}\S.*\b{name}\(", text, re.MULTILINE), name


def test_every_key_of_a_scene_is_described() -> None:
    text, page = (TOP / "docs" / "scene.md").read_text(), shown("man/kage-scene.5")
    keys = re.findall(r"^\| `([^`|]+)` \|", text, re.MULTILINE)
    assert len(keys) > 80
    for key in keys:
        assert re.search(rf"^ +{re.escape(key)}(,| |$)", page, re.MULTILINE), key


@pytest.mark.parametrize(("text", "made"), [
    ("a `b-c` d", "a \\fBb\\-c\\fR d"),
    ("**a** and *b*", "\\fBa\\fR and \\fIb\\fR"),
    ("[this](x.md), [that](https://x.org/)", "this, that (https://x.org/)"),
    ("2 × 3\\4", "2 \\[u00D7] 3\\e4"),
    ("![picture](a.png)", ""),
])
def test_inline(text: str, made: str) -> None:
    assert roff.inline(text) == made


def test_markdown() -> None:
    page = roff.Page("x", 5, "kage", "2026-01-01", "a test")
    roff.markdown(page, "# T\n\nWords.\n\n## A b\n\n- one\n  more\n- two\n\n```yaml\n.a: 1\n```\n\n"
                        "| key | value | default |\n|---|---|---|\n| `k` | a thing | 1 |\n")
    assert str(page).splitlines()[4:] == [
        ".SH DESCRIPTION", "Words.", ".SH A B", ".IP \\(bu 4", "one more", ".IP \\(bu 4", "two", ".PP", ".RS 4", ".EX",
        "\\&.a: 1", ".EE", ".RE", ".TP", "\\fBk\\fR", "a thing.", "Default: 1."]
    with pytest.raises(ValueError, match="no HTML"):
        roff.markdown(page, "# T\n\n<div>\n")


def test_pages_are_those_that_are_installed() -> None:
    listed = re.search(r"^MANUALS += (.*)", (TOP / "Makefile").read_text(), re.MULTILINE)
    assert listed
    assert {Path(word).name for word in listed[1].split()} == {path.name for path in (TOP / "man").iterdir()}
