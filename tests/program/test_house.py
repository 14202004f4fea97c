"""The order of the source tree: each rule of tests/support/house.py holds, and notices a tree in which it does not."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from scripts import rooms
from tests.conftest import PROGRAM, SANITIZED, TOP
from tests.support import house
from tests.support.house import House

Rule = Callable[[House], Iterator[str]]


@pytest.fixture(scope="module")
def tree() -> House:
    return house.load(TOP, PROGRAM.parent)


@pytest.mark.parametrize("rule", house.RULES, ids=lambda rule: rule.__name__)
def test_holds(tree: House, rule: Rule) -> None:
    if rule is house.exported_names_begin_with_kage and not tree.exported:
        pytest.skip("no libkage.so is built yet")
    if rule is house.library_has_no_writable_globals and SANITIZED:
        pytest.skip("AddressSanitizer gives the library globals of its own")
    broken = list(rule(tree))
    assert not broken, "\n".join(broken)


# Trees that break one rule each: files that are added to the tree, and what the rule says of them. --------------------

HEAD = "/* A test. */\n"
BROKEN: list[tuple[Rule, dict[str, str], str]] = [
    (house.rooms_are_known, {"src/cellar/a.c": HEAD}, "src/cellar: "),
    (
        house.includes_go_down,
        {"src/base/a.c": HEAD + '#include "scene/scene.h"\n'},
        "src/base/a.c includes scene/scene.h",
    ),
    (
        house.includes_go_down,
        {"src/wave/a.h": HEAD + '#include "math/noise.h"\n'},
        "src/wave/a.h includes math/noise.h",
    ),
    (
        house.calls_go_down,
        {
            "src/base/a.c": "void above(void); void below(void); void below(void) { above(); }\n",
            "src/math/b.c": "void above(void); void above(void) {}\n",
        },
        "src/base/a.c uses above of src/math/b.c",
    ),
    (
        house.no_circles_of_includes,
        {"src/base/a.h": HEAD + '#include "base/b.h"\n', "src/base/b.h": HEAD + '#include "base/a.h"\n'},
        "include each other: base/a.h base/b.h",
    ),
    (
        house.no_circles_of_calls,
        {
            "src/base/a.c": "void f(int); void g(int); void f(int n) { if (n) g(n - 1); }\n",
            "src/base/b.c": "void f(int); void g(int); void g(int n) { if (n) f(n - 1); }\n",
        },
        "call each other: base/a base/b",
    ),
    (house.other_projects_in_one_place, {"src/base/a.c": HEAD + "#include <png.h>\n"}, "src/base/a.c includes <png.h>"),
    (
        house.other_projects_in_one_place,
        {"src/base/a.c": HEAD + "#if 1\n# include <embree3/rtcore.h>\n#endif\n"},
        "src/base/a.c includes <embree3/rtcore.h>",
    ),
    (
        house.library_leaves_the_process_alone,
        {"src/base/a.c": '#include <stdio.h>\nvoid f(void); void f(void) { puts("a"); }\n'},
        "src/base/a.c uses puts",
    ),
    (
        house.library_leaves_the_process_alone,
        {"src/base/a.c": "#include <stdlib.h>\nvoid f(void); void f(void) { exit(1); }\n"},
        "src/base/a.c uses exit",
    ),
    (
        house.library_leaves_the_process_alone,
        {"src/base/a.c": "#include <unistd.h>\nint f(void); int f(void) { return fork(); }\n"},
        "src/base/a.c uses fork",
    ),
    (
        house.library_leaves_the_process_alone,
        {"src/base/a.c": "#include <signal.h>\nvoid f(void); void f(void) { raise(2); }\n"},
        "src/base/a.c uses raise",
    ),
    (
        house.library_has_no_writable_globals,
        {"src/base/a.c": "int f(void); int f(void) { static int calls; return calls++; }\n"},
        "src/base/a.c has the writable global calls",
    ),
    (
        house.library_has_no_writable_globals,
        {"src/base/a.c": "extern int most; int most = 7;\n"},
        "src/base/a.c has the writable global most",
    ),
    (
        house.the_program_uses_the_public_header,
        {"src/cli/a.c": HEAD + '#include "scene/scene.h"\n'},
        "src/cli/a.c includes scene/scene.h",
    ),
    (house.rooms_are_small, {f"src/base/a{k}.c": HEAD for k in range(17)}, "src/base has "),
    (house.lines_are_short, {"docs/a.md": "word " * 25 + "\n"}, "docs/a.md:1: 125 columns"),
    (house.lines_are_short, {"bench/a.py": "# " + 119 * "-" + "\n"}, "bench/a.py:1: 121 columns"),
    (
        house.functions_are_short,
        {"src/base/a.c": HEAD + "void f(void)\n{\n" + "    f();\n" * 60 + "}\n"},
        "src/base/a.c:3: a function has 61 lines",
    ),
    (house.functions_are_short, {"bench/a.py": "def f():\n" + "    f()\n" * 60}, "bench/a.py:1: f has 61 lines"),
    (house.files_say_what_they_are, {"src/base/a.c": "#include <math.h>\n"}, "src/base/a.c: "),
    (house.files_say_what_they_are, {"bench/a.py": "import math\n"}, "bench/a.py: "),
    (
        house.stages_have_names_of_their_own,
        {"src/base/a.c": "STAGE static void f(int n)\n", "src/math/b.c": "STAGE static int f(int n)\n"},
        "src/math/b.c has a stage f, as has src/base/a.c",
    ),
    (house.files_say_what_they_are, {".ci/run": "#!/bin/sh\nexec make test\n"}, ".ci/run: "),
]


#: The rules that read compiled objects.
OF_OBJECTS = (house.calls_go_down, house.no_circles_of_calls, house.library_leaves_the_process_alone,
              house.library_has_no_writable_globals)


def built(path: str, text: str, folder: Path) -> list[house.Symbol]:
    source, made = folder / Path(path).name, folder / "a.o"
    source.write_text(text)
    subprocess.run(
        ["cc", "-std=c99", "-D_POSIX_C_SOURCE=200809L", "-O2", "-fPIC", "-c", source, "-o", made], check=True
    )
    return house.symbols(made)


@pytest.mark.parametrize("rule, files, words", BROKEN, ids=[f"{rule.__name__}-{words}" for rule, _, words in BROKEN])
def test_notices(tree: House, tmp_path: Path, rule: Rule, files: dict[str, str], words: str) -> None:
    compiled = files.items() if rule in OF_OBJECTS else ()
    objects = {path[4:-2]: built(path, text, tmp_path) for path, text in compiled}
    broken = replace(tree, texts={**tree.texts, **files}, objects={**tree.objects, **objects})
    added = set(rule(broken)) - set(rule(tree))
    assert [line for line in added if line.startswith(words)], added


def test_notices_other_exports(tree: House) -> None:
    assert list(house.exported_names_begin_with_kage(replace(tree, exported=["kage_version", "render"]))) == [
        "libkage.so exports render"]


def test_every_rule_is_seen_to_fail() -> None:
    assert {rule for rule, _, _ in BROKEN} | {house.exported_names_begin_with_kage} == set(house.RULES)


def test_recursion_that_is_allowed_is_there(tree: House) -> None:
    """An entry that no circle needs any more would hide the next one."""
    found = house.circles({name: set(used) for name, used in house.calls(tree).items()})
    assert set(house.RECURSIVE) <= {frozenset(circle) for circle in found}


# The rooms in docs/design.md ------------------------------------------------------------------------


def test_table_and_picture_are_fresh() -> None:
    sources, text = rooms.read_sources(TOP), (TOP / rooms.DESIGN).read_text()
    why = "is stale: python3 scripts/rooms.py --write"
    assert rooms.with_block(text, sources) == text, f"{rooms.DESIGN} {why}"
    assert rooms.picture(sources) == (TOP / rooms.PICTURE).read_text(), f"{rooms.PICTURE} {why}"


def test_a_document_without_the_markers() -> None:
    with pytest.raises(ValueError, match="has no"):
        rooms.with_block("# Design\n", rooms.read_sources(TOP))
