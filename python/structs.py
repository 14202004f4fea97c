"""Write kage/structs.py: structs of the library as dataclasses, from include/kage.h.

    python structs.py [--check]

--check writes nothing and fails where the file is not what it would write. `make python` writes it when kage.h changes.
"""

from __future__ import annotations

import re
import sys
import textwrap
from collections.abc import Iterator
from typing import Any

import cffi

from build_ext import HEADER, HERE, declarations

MADE = HERE / "kage" / "structs.py"

#: Structs that the caller fills in, or that errors.py and picture.py turn into something else.
OTHERS = re.compile(r"kage_(\w+_options|\w+_array|error|metadata|import_report|limit)")

#: An int that is yes or no; kage.h says so in words only.
FLAGS = {"fades", "transformed", "mirrors", "transparent", "bounded", "guard", "displaced", "self_shadow", "shifted",
         "orthographic", "regular", "bumped", "sends"}

#: A struct that the caller fills in by its name in Python; 0 is each field's default.
GIVEN = "kage_limits"

#: What a status is called as an exception.
EXCEPTIONS = {"KAGE_BAD_INPUT": "InputError", "KAGE_NO_MEMORY": "NoMemoryError", "KAGE_OUT_OF_TIME": "OutOfTimeError"}

HEAD = '''"""What the library takes and returns, as dataclasses. Made from include/kage.h by structs.py: do not edit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
'''

STRUCT = re.compile(r"(?:/\*((?:(?!\*/).)*?)\*/\n)?typedef struct (kage_\w+) \{\n(.*?)\n\} \2;", re.DOTALL)
FIELD = re.compile(r"([^;]+);(?:[ ]*/\*(.*?)\*/)?", re.DOTALL)


def class_name(struct: str) -> str:
    """kage_light_info: LightInfo. A Warning is something else in Python."""
    if struct == "kage_warning":
        return "BumpWarning"
    return "".join(word.capitalize() for word in struct.removeprefix("kage_").split("_"))


def words(comment: str | None) -> str:
    """A comment's text in one line, in words of Python."""
    line = re.sub(r"\s*\n\s*\*?\s*", " ", comment or "").strip()
    line = re.sub(r"\bkage_\w+(?=\.)", lambda struct: class_name(struct[0]), line).replace("NULL", "None")
    return re.sub(r"\bKAGE_\w+", lambda status: EXCEPTIONS.get(status[0], status[0]), line)


def counts(fields: dict[str, Any]) -> dict[str, str]:
    """The fields that only count another, and which."""
    return {name: f"{name.removesuffix('_count')}s" for name in fields
            if name.endswith("_count") and f"{name.removesuffix('_count')}s" in fields}


def python_type(name: str, kind: Any, comment: str, counted: bool) -> str:
    """The type of a field in Python."""
    if kind.kind == "primitive":
        return "float" if kind.cname == "double" else "bool" if kind.cname == "int" and name in FLAGS else "int"
    if kind.kind == "array":
        if (kind.item.cname, kind.length) == ("double", 3):
            return "NDArray[np.float64]"
        return f"tuple[{', '.join([python_type('', kind.item, '', False)] * kind.length)}]"
    if kind.kind == "struct":
        return class_name(kind.cname)
    if kind.kind == "enum" or kind.item.cname == "char":
        return "str | None" if "None" in comment else "str"
    item = {"double": "float", "char *": "str"}.get(kind.item.cname) or class_name(kind.item.cname)
    return f"tuple[{item}, ...]" if counted or item == "float" else f"{item} | None"


def lines_of(struct: str, title: str, body: str, fields: dict[str, Any]) -> Iterator[str]:
    yield f"\n\n@dataclass(frozen=True{'' if struct == GIVEN else ', eq=False'})"
    yield f"class {class_name(struct)}:"
    text = title or f"{struct} of kage.h."
    yield from textwrap.wrap(f'"""{text}"""', 116, initial_indent="    ", subsequent_indent="    ")
    yield ""
    counting = counts(fields)
    for declaration, comment in FIELD.findall(body):
        names = re.findall(r"(\w+)(?:\[\d+\])?(?=\s*(?:,|$))", re.sub(r"/\*.*?\*/", "", declaration, flags=re.DOTALL))
        kept = [name for name in names if name not in counting and name != "reserved"]
        text = words(comment)
        if kept and text:
            yield from textwrap.wrap(text, 110, initial_indent="    #: ", subsequent_indent="    #: ")
        for name in kept:
            # `objects` of a survey has a count elsewhere: that of the scene.
            counted = name in counting.values() or "for each" in text
            default = " = 0" if struct == GIVEN else ""
            yield f"    {name}: {python_type(name, fields[name], text, counted)}{default}"


def python_text() -> str:
    ffi = cffi.FFI()
    header = HEADER.read_text()
    ffi.cdef(declarations(header))
    lines = [HEAD.rstrip()]
    for title, struct, body in STRUCT.findall(header):
        if not OTHERS.fullmatch(struct):
            fields = {name: field.type for name, field in ffi.typeof(struct).fields}
            lines += lines_of(struct, words(title), body, fields)
    return "\n".join(lines) + "\n"


def main() -> int:
    made = python_text()
    same = MADE.exists() and MADE.read_text() == made
    if "--check" in sys.argv:
        return int(not same)
    if not same:
        MADE.write_text(made)
    return 0


if __name__ == "__main__":
    sys.exit(main())
