"""What others rely on: of kage.h sizes and places in structs, values, types of functions; of bumpshadow.h the functions
and structs; of the Python package the names and parameters.

    scripts/venv python -m tests.support.abi --write     keep what this kage.h has, at a release

tests/data/abi.json holds it as of the last release. `broken` says what has changed since for those who use it. What is
new is no change.
"""

from __future__ import annotations

import inspect
import json
import re
import sys
from typing import Any

import cffi

from scripts import glsl
from tests.conftest import TOP

sys.path.append(str(TOP / "python"))
from build_ext import declarations

KEPT = TOP / "tests" / "data" / "abi.json"
HEADER = TOP / "include" / "kage.h"

#: Structs that the caller makes room for, or that are passed by value: their size stays.
CALLERS = re.compile(r"kage_(\w+_options|\w+_array|limits|metadata|povray_report)")


def within_others(structs: dict[str, Any]) -> set[str]:
    """Structs that others hold, or have arrays of: their size is part of the others."""
    types = " ".join(kind for struct in structs.values() for _, kind in struct["fields"].values())
    return {name for name in structs if re.search(rf"\b{name}\b(?! const)", types)}


def of_header(text: str) -> dict[str, Any]:
    """On this processor; the file is of x86-64."""
    ffi = cffi.FFI()
    ffi.cdef(declarations(text))
    found: dict[str, Any] = {"functions": {}, "constants": {}, "structs": {}}
    callbacks = dict(re.findall(r"typedef ([^;{}()]*\b(kage_\w+)\([^;{}]*\));", declarations(text)))
    for name in ffi.list_types()[0]:
        if name in callbacks.values():
            continue
        kind = ffi.typeof(name)
        if kind.kind == "struct":
            fields = {field: [at.offset, at.type.cname] for field, at in kind.fields or [] if field != "reserved"}
            found["structs"][name] = {"size": ffi.sizeof(kind) if kind.fields else 0, "fields": fields}
        elif kind.kind == "enum":
            found["constants"] |= {word: value for value, word in kind.elements.items()}
    found["functions"] |= {name: " ".join(f"typedef {text}".split()) for text, name in callbacks.items()}
    for declared in re.finditer(r"\b(\w[^;{}()]*?)\b(kage_\w+)\(([^;{}]*)\);", declarations(text)):
        if declared[2] in callbacks.values():
            continue
        found["functions"][declared[2]] = " ".join(declared[0].split())
    return found


def of_formulas() -> dict[str, Any]:
    """Of bumpshadow.h, by the types of its parameters: what scripts/glsl.py reads of it."""
    known = glsl.Writer(glsl.SOURCE.read_text(encoding="utf-8")).known
    return {**{name: [result, *wanted] for name, (result, wanted) in known.functions.items() if name.startswith("bs_")},
            **{name: list(fields.items()) for name, fields in known.structs.items()}}


def of_package() -> dict[str, Any]:
    """The functions and methods of the Python package by their parameters; classes and values by their names."""
    import kage

    found: dict[str, Any] = {}
    for module in (kage, kage.methods, kage.gbuffer, kage.heights):
        for name in getattr(module, "__all__", [n for n in vars(module) if not n.startswith("_")]):
            thing = getattr(module, name)
            home = getattr(thing, "__module__", "kage")
            if inspect.ismodule(thing) or not home.startswith("kage") or name == "ffi":
                continue
            whole = f"{module.__name__}.{name}"
            found[whole] = parameters(thing) if inspect.isfunction(thing) else []
            for method, code in inspect.getmembers(thing, inspect.isfunction) if inspect.isclass(thing) else ():
                if not method.startswith("_"):
                    found[f"{whole}.{method}"] = parameters(code)
    return found


def parameters(function: Any) -> list[str]:
    """In their order; a ? behind what has a default, a = before what is given by its name alone."""
    return [("=" if p.kind is p.KEYWORD_ONLY else "") + p.name + ("?" if p.default is not p.empty else "")
            for p in inspect.signature(function).parameters.values() if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)]


def takes(old: list[str], new: list[str]) -> bool:
    """Whether each call with the old parameters is one with the new: those that are new have defaults."""
    here = {word.strip("=?"): word for word in new}
    names = [word.strip("=?") for word in old]
    in_order = [word.strip("?") for word in old if not word.startswith("=")]
    return (all(name in here for name in names)
            and [word.strip("?") for word in new if not word.startswith("=")][:len(in_order)] == in_order
            and all(here[word.strip("=?")].endswith("?") for word in old if word.endswith("?"))
            and all(word.endswith("?") for name, word in here.items() if name not in names))


def broken_package(old: dict[str, list[str]], new: dict[str, list[str]]) -> list[str]:
    return [f"{name} took {had}, and takes {new[name]}" if name in new else f"{name} is gone"
            for name, had in old.items() if name not in new or not takes(had, new[name])]


def broken(old: dict[str, Any], new: dict[str, Any]) -> list[str]:
    """What a program built with `old` finds changed."""
    wrong = [f"{name} was {what}, and is {new[part].get(name, 'gone')}" for part in ("functions", "constants")
             for name, what in old[part].items() if new[part].get(name) != what]
    held = within_others(old["structs"])
    for name, struct in old["structs"].items():
        now = new["structs"].get(name, {"size": -1, "fields": {}})
        wrong += [f"{name}.{field} was at {at[0]}, {at[1]}, and is {now['fields'].get(field, 'gone')}"
                  for field, at in struct["fields"].items() if now["fields"].get(field) != at]
        fixed = CALLERS.fullmatch(name) or name in held
        if now["size"] < struct["size"] or (fixed and now["size"] != struct["size"]):
            wrong.append(f"{name} had {struct['size']} bytes, and has {now['size']}")
    return wrong


def major() -> int:
    """Of the version, for which the promise is."""
    return int(re.findall(r'define KAGE_VERSION "(\d+)', HEADER.read_text())[0])


def present() -> dict[str, Any]:
    """What this tree has, and its major version."""
    return {"major": major(), "kage.h": of_header(HEADER.read_text()), "bumpshadow.h": of_formulas(),
            "python": of_package()}


def main() -> None:
    if sys.argv[1:] != ["--write"]:
        sys.exit(__doc__)
    KEPT.write_text(json.dumps(present(), indent=1) + "\n")


if __name__ == "__main__":
    main()
