"""Structs of C as the dataclasses of structs.py, whose names and types of fields decide."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any, TypeVar

import numpy as np

from kage import structs
from kage._kage import ffi
from kage.text import text_of

T = TypeVar("T")


def converted(kind: type[T], value: Any, counts: Mapping[str, int] | None = None) -> T:
    """A copy of a struct. counts: of the fields whose number of elements the struct itself does not say."""
    names = {field.name: str(field.type) for field in fields(kind)}  # type: ignore[arg-type]
    return kind(**{name: field_value(name, text, value, counts or {}) for name, text in names.items()})


def field_value(name: str, kind: str, struct: Any, counts: Mapping[str, int]) -> Any:
    value = getattr(struct, name)
    if not isinstance(value, ffi.CData):
        # An enum comes as its number; the name has more to say.
        return bool(value) if kind == "bool" else enum_name(name, struct) if kind == "str" else value
    if kind.startswith("str"):
        return text_of(value)
    if kind.startswith("NDArray"):
        vector = np.array(list(value))
        vector.setflags(write=False)
        return vector
    if not kind.startswith("tuple"):
        return converted(getattr(structs, kind.split()[0]), value, counts) if value else None
    return elements(name, kind, struct, value, counts)


def elements(name: str, kind: str, struct: Any, value: Any, counts: Mapping[str, int]) -> tuple[Any, ...]:
    """An array, or a pointer with a count."""
    if ffi.typeof(value).kind == "array":
        return tuple(value)
    count = counts[name] if name in counts else getattr(struct, f"{name.removesuffix('s')}_count")
    item = kind.removeprefix("tuple[").split(",")[0]
    if item == "float":
        return tuple(value[0:count])
    if item == "str":
        return tuple(text_of(value[index]) for index in range(count))
    return tuple(converted(getattr(structs, item), value[index], counts) for index in range(count))


def enum_name(name: str, struct: Any) -> str:
    """KAGE_WARN_STEEP: "steep"."""
    kind = ffi.typeof(struct)
    members = dict((kind.item if kind.kind == "pointer" else kind).fields)
    spelled: str = members[name].type.elements[getattr(struct, name)]
    return spelled.removeprefix("KAGE_WARN_").lower().replace("_", " ")
