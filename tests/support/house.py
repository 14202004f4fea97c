"""What holds of the whole source tree: each rule is a function from the tree to the lines that break it.

The tree is read once, as texts and as the symbols of the compiled objects; so a test can change a copy of it in memory
and see that the rule notices. The order of the rooms itself is in scripts/rooms.py.
"""

from __future__ import annotations

import ast
import re
import subprocess
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from scripts import rooms, tree

#: Rooms that the library has not: only these print, exit and install signal handlers.
PROGRAMS = ("cli", "look", "view", "import")

#: Headers of other projects, and the only places that include each: beginnings of a path below src/.
OUTSIDE: dict[str, str | tuple[str, ...]] = {
    "png.h": ("image/png.c", "import/picture.c"), "jpeglib.h": "import/picture.c", "openexr.h": "image/exr_",
    "OpenEXRConfig.h": "image/exr_zip.c", "libdeflate.h": "image/exr_zip.c", "libfyaml.h": "yaml/",
    "embree": "bvh/embree.c", "assimp/": "import/", "SDL": "view/", "fontconfig/": "view/font.c",
    "omp.h": "base/threads.h", "pthread.h": ("api/api.h", "bvh/embree.c", "image/"),
}

#: What a library leaves to its caller: the streams, the process, its signals and settings.
FORBIDDEN = {
    "printf", "vprintf", "puts", "putchar", "perror", "stdout", "stderr", "exit", "_exit", "_Exit", "quick_exit",
    "abort", "atexit", "fork", "vfork", "system", "popen", "signal", "__sysv_signal", "sigaction", "raise", "setrlimit",
    "setlocale", "chdir", "umask", "setenv", "putenv", "srand", "rand", "strtok", "omp_set_num_threads",
}

#: Circles of calls that stay, and why. A circle is named by its files below src/, without .c.
RECURSIVE: dict[frozenset[str], str] = {}

FILES_OF_ROOM, COLUMNS, LINES_OF_FUNCTION = 17, 120, 60


@dataclass(frozen=True)
class Symbol:
    name: str
    kind: str  # of nm: U is undefined, capitals are global
    section: str

    @property
    def writable(self) -> bool:
        return self.section.startswith((".data", ".bss", ".tdata", ".tbss", "*COM*")) and ".rel.ro" not in self.section


@dataclass(frozen=True)
class House:
    texts: Mapping[str, str]  # by path from the top: C, Python, shell, documents
    objects: Mapping[str, list[Symbol]]  # by path below src/, without .c
    exported: list[str]  # by libkage.so

    @property
    def sources(self) -> dict[str, str]:
        """By path below src/."""
        return {path[4:]: text for path, text in self.texts.items() if path.startswith("src/")}

    @property
    def library(self) -> dict[str, list[Symbol]]:
        return {name: symbols for name, symbols in self.objects.items() if rooms.room_of(name) not in PROGRAMS}


def symbols(path: Path, *options: str) -> list[Symbol]:
    """Of an object or a shared library."""
    text = subprocess.run(["nm", "-f", "sysv", *options, path], check=True, capture_output=True, text=True).stdout
    rows = [[field.strip() for field in line.split("|")] for line in text.splitlines() if line.count("|") == 6]
    return [Symbol(row[0], row[2], row[6]) for row in rows if row[0] != "Name"]


def load(top: Path, build: Path) -> House:
    """What is in the source tree `top`, and the objects made from it in `build`."""
    names = [name for name in tree.names(top) if is_text(name)]
    texts = {name: (top / name).read_text() for name in names}
    made = {name[4:-2]: build / (name[4:-2] + ".o") for name in names if re.fullmatch(r"src/.*\.c", name)}
    objects = {name: symbols(path) for name, path in made.items() if path.exists() or not name.startswith("view/")}
    shared = build / "libkage.so"
    return House(texts, objects, [s.name for s in symbols(shared, "-D", "--defined-only")] if shared.exists() else [])


def is_text(name: str) -> bool:
    return name.endswith((".c", ".h", ".py", ".md", "Makefile")) or name in (
        "scripts/bootstrap",
        "scripts/deb",
        "scripts/venv",
        ".ci/run",
    )


# Graphs ---------------------------------------------------------------------------------------------

Graph = Mapping[str, set[str]]


def circles(graph: Graph) -> list[list[str]]:
    """The groups of more than one that reach each other."""
    def reach(start: str) -> set[str]:
        found: set[str] = set()
        left = [start]
        while left:
            new = graph.get(left.pop(), set()) - found
            found |= new
            left += new
        return found

    below = {name: reach(name) for name in graph}
    groups = {
        frozenset(other for other in below[name] if name in below.get(other, ()))
        for name in below
        if name in below[name]
    }
    return sorted(sorted(group) for group in groups if len(group) > 1)


def calls(house: House) -> dict[str, dict[str, str]]:
    """For each object those whose symbols it uses, with one such symbol."""
    home = {s.name: name for name, found in house.objects.items() for s in found if s.kind in "TDRBVWi"}
    return {name: {home[s.name]: s.name for s in found if s.kind == "U" and home.get(s.name, name) != name}
            for name, found in house.objects.items()}


# Rules ----------------------------------------------------------------------------------------------


def rooms_are_known(house: House) -> Iterator[str]:
    for room in sorted({rooms.room_of(path) for path in house.sources} - rooms.ROOMS.keys()):
        yield f"src/{room}: scripts/rooms.py has no rank and idea of it"


def includes_go_down(house: House) -> Iterator[str]:
    for path, text in house.sources.items():
        room = rooms.room_of(path)
        for other in (name for name in rooms.includes(text) if "/" in name):
            if rooms.room_of(other) != room and rooms.rank(rooms.room_of(other)) >= rooms.rank(room):
                yield f"src/{path} includes {other}, of a room that is not below"


def calls_go_down(house: House) -> Iterator[str]:
    for name, used in calls(house).items():
        room = rooms.room_of(name)
        for other, symbol in used.items():
            if rooms.room_of(other) != room and rooms.rank(rooms.room_of(other)) >= rooms.rank(room):
                yield f"src/{name}.c uses {symbol} of src/{other}.c, a room that is not below"


def no_circles_of_includes(house: House) -> Iterator[str]:
    for circle in circles({path: set(rooms.includes(text)) for path, text in house.sources.items()}):
        yield f"include each other: {' '.join(circle)}"


def no_circles_of_calls(house: House) -> Iterator[str]:
    for circle in circles({name: set(used) for name, used in calls(house).items()}):
        if frozenset(circle) not in RECURSIVE:
            yield f"call each other: {' '.join(circle)}"


def other_projects_in_one_place(house: House) -> Iterator[str]:
    for path, text in house.sources.items():
        for header in re.findall(r"^ *# *include <([^>]+)>", text, re.MULTILINE):
            for name, places in OUTSIDE.items():
                if header.startswith(name) and not path.startswith(places):
                    yield f"src/{path} includes <{header}>, which only {places} below src/ may"


def library_leaves_the_process_alone(house: House) -> Iterator[str]:
    for name, found in house.library.items():
        for symbol in found:
            if symbol.kind == "U" and symbol.name.split("@")[0] in FORBIDDEN:
                yield f"src/{name}.c uses {symbol.name}"


def library_has_no_writable_globals(house: House) -> Iterator[str]:
    """Locks of OpenMP's named critical sections are such, and meant so: they are the process's."""
    for name, found in house.library.items():
        for symbol in found:
            if (
                symbol.writable
                and symbol.kind != "U"
                and not symbol.name.startswith((".gomp_critical_user_", ".data", ".bss"))
            ):
                yield f"src/{name}.c has the writable global {symbol.name}"


def exported_names_begin_with_kage(house: House) -> Iterator[str]:
    for name in house.exported:
        if not name.startswith("kage_"):
            yield f"libkage.so exports {name}"


def the_program_uses_the_public_header(house: House) -> Iterator[str]:
    """base/spelling.h alone is linked besides, as it is no part of a tracer."""
    for path, text in house.sources.items():
        for other in rooms.includes(text):
            room = rooms.room_of(path)
            if other == "base/spelling.h":
                continue
            if room in PROGRAMS[:3] and rooms.room_of(other) not in (room, "kage.h", "look" if room == "view" else ""):
                yield f"src/{path} includes {other}; it knows the tracer by kage.h alone"


def rooms_are_small(house: House) -> Iterator[str]:
    """Headers go with their .c files, and are not counted."""
    files = [rooms.room_of(path) for path in house.sources if path.endswith(".c")]
    for room in sorted(set(files)):
        if files.count(room) > FILES_OF_ROOM:
            yield f"src/{room} has {files.count(room)} files, {FILES_OF_ROOM} at most"


def lines_are_short(house: House) -> Iterator[str]:
    """In documents, rows of tables and links can't be broken."""
    for path, text in house.texts.items():
        for number, line in enumerate(text.splitlines(), 1):
            whole = path.endswith(".md") and (line.startswith("|") or "](" in line)
            if len(line) > COLUMNS and not whole:
                yield f"{path}:{number}: {len(line)} columns"


def functions_are_short(house: House) -> Iterator[str]:
    """The yardsticks of the bench are left out: each is one long loop, as that is what they measure."""
    for path, text in house.texts.items():
        if path.startswith("bench/limits/"):
            continue
        for name, line, length in (functions_in_python if path.endswith(".py") else functions_in_c)(path, text):
            if length > LINES_OF_FUNCTION:
                yield f"{path}:{line}: {name} has {length} lines"


def functions_in_c(path: str, text: str) -> Iterator[tuple[str, int, int]]:
    """By the braces in the first column, where clang-format puts a function's."""
    begin = 0
    for number, line in enumerate(text.splitlines() if path.endswith((".c", ".h")) else [], 1):
        if line == "{":
            begin = number
        elif line == "}" and begin:
            yield "a function", begin, number - begin
            begin = 0


def functions_in_python(path: str, text: str) -> Iterator[tuple[str, int, int]]:
    for node in ast.walk(ast.parse(text, path)):
        if isinstance(node, ast.FunctionDef):
            yield node.name, node.lineno, (node.end_lineno or node.lineno) - node.lineno + 1


def files_say_what_they_are(house: House) -> Iterator[str]:
    for path, text in house.texts.items():
        start = re.sub(r"\A#!.*\n", "", text)
        if not start.startswith("/*" if path.endswith((".c", ".h")) else '"""' if path.endswith(".py") else "#"):
            yield f"{path}: no comment at its head"


def stages_have_names_of_their_own(house: House) -> Iterator[str]:
    """clang 14 exports what chooses between a stage's clones, so two of one name can't be linked."""
    first: dict[str, str] = {}
    for path, text in house.sources.items():
        for name in re.findall(r"^STAGE static \w[\w ]*[ *](\w+)\(", text, re.MULTILINE):
            if first.setdefault(name, path) != path:
                yield f"src/{path} has a stage {name}, as has src/{first[name]}"


RULES: tuple[Callable[[House], Iterator[str]], ...] = (
    rooms_are_known,
    includes_go_down,
    calls_go_down,
    no_circles_of_includes,
    no_circles_of_calls,
    other_projects_in_one_place,
    library_leaves_the_process_alone,
    library_has_no_writable_globals,
    exported_names_begin_with_kage,
    the_program_uses_the_public_header,
    rooms_are_small,
    lines_are_short,
    functions_are_short,
    files_say_what_they_are,
    stages_have_names_of_their_own,
)
