"""Options of Python as the structs of kage.h. Zero is a struct's default, None is Python's."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from kage._kage import ffi, lib
from kage.calls import Call
from kage.errors import OptionError
from kage.structs import Limits
from kage.text import bytes_of


class Struct:
    """A struct of kage.h, and what its pointers point to."""

    def __init__(self, kind: str, call: Call | None = None, threads: int | None = None) -> None:
        self.kept: list[Any] = []
        self.c = ffi.new(f"{kind} *")
        if call is not None:
            self.kept.append(call)
            self.c.progress, self.c.user = call.progress, call.user
        if threads is not None:
            self.c.threads = whole("threads", threads, 1, lib.KAGE_MAX_THREADS)

    def text(self, field: str, value: str | None) -> None:
        if value is not None:
            setattr(self.c, field, self.keep(ffi.new("char[]", bytes_of(value))))

    def limits(self, limits: Limits | None) -> None:
        if limits is None:
            return
        if not isinstance(limits, Limits):
            raise OptionError(f"limits is {limits!r}, expected kage.Limits(...)")
        values = asdict(limits)
        seconds, memory = values.pop("seconds"), values.pop("memory")
        numbers = {name: whole(f"limits.{name}", value, 0, 1 << 62) for name, value in values.items()}
        memory = whole("limits.memory", memory, -1, 1 << 62)
        self.c.limits = self.keep(ffi.new("kage_limits *", {"memory": memory, "seconds": float(seconds), **numbers}))

    def keep(self, value: Any) -> Any:
        self.kept.append(value)
        return value


def render_struct(options: Mapping[str, Any], call: Call) -> Struct:
    """The options of rendering as kage_render_options."""
    made = Struct("kage_render_options", call, options.get("threads"))
    relief = bool(options.get("relief"))
    shadow, shade, bump_shadow = (options.get(name) for name in ("shadow", "shade", "bump_shadow"))
    if relief:
        shadow = ffi.string(lib.KAGE_RELIEF_METHOD).decode() if shadow is None else shadow
        bump_shadow = ffi.string(lib.KAGE_RELIEF_BUMP_SHADOW).decode() if bump_shadow is None else bump_shadow
        shade = shade or "shifted"
    made.text("method", None if shadow is None else str(shadow))
    made.text("bump_shadow", bump_shadow)
    made.c.shifted = one_of("shade", shade, no="smooth", yes="shifted")
    made.c.displaced = one_of("surface", options.get("surface"), no="smooth", yes="displaced")
    made.c.self_shadow = choice(options.get("self_shadow"))
    made.c.guard = choice(options.get("guard"))
    if options.get("size") is not None:
        made.c.width, made.c.height = whole_numbers("size", options["size"], 2, lib.KAGE_MAX_SIDE, least=1)
    if options.get("crop") is not None:
        made.c.crop = whole_numbers("crop", options["crop"], 4, lib.KAGE_MAX_SIDE)
        if not any(made.c.crop):
            raise OptionError("crop: no pixels, expected x0 < x1 and y0 < y1")
    if options.get("aa") is not None:
        made.c.aa = whole("aa", options["aa"], 1, lib.KAGE_MAX_AA)
    if options.get("aa_threshold") is not None:
        made.c.aa_threshold = threshold(options["aa_threshold"])
    layers = options.get("layers")
    made.c.layers = layers is None or bool(layers)
    made.c.timing = bool(options.get("timing"))
    made.limits(options.get("limits"))
    return made


def write_struct(options: Mapping[str, Any], call: Call | None = None) -> Struct:
    """The options of writing as kage_write_options."""
    made = Struct("kage_write_options", call, options.get("threads"))
    layers = options.get("layers")
    if not isinstance(layers, bool | None):
        made.text("layers", layers if isinstance(layers, str) else ",".join(layers))
    if options.get("bits") is not None:
        made.c.bits = whole("bits", options["bits"], 8, 16)
    if options.get("band") is not None:
        made.c.band = whole("band", options["band"], 16, lib.KAGE_MAX_SIDE)
    made.limits(options.get("limits"))
    made.c.resume, made.c.keep = bool(options.get("resume")), bool(options.get("keep"))
    return made


def check_names(function: str, given: Iterable[str], options: type) -> None:
    """A name that no option has is a TypeError, as for any function."""
    for name in given:
        if name not in options.__annotations__:
            raise TypeError(f"{function}() has no option {name!r}; it has {', '.join(sorted(options.__annotations__))}")


def choice(value: bool | None) -> int:
    """A kage_choice."""
    return int(lib.KAGE_AS_SCENE if value is None else lib.KAGE_YES if value else lib.KAGE_NO)


def one_of(name: str, value: str | None, *, no: str, yes: str) -> int:
    """The kage_choice of a key with two words."""
    if value not in (None, no, yes):
        raise OptionError(f"{name} is {value!r}, expected {no!r} or {yes!r}")
    return choice(None if value is None else value == yes)


def whole(name: str, value: Any, low: int, high: int) -> int:
    """A whole number within bounds."""
    try:
        number = value.__index__()
    except AttributeError:
        number = low - 1
    if not low <= number <= high:
        raise OptionError(f"{name} is {value!r}, expected a whole number from {low} to {high}")
    return int(number)


def whole_numbers(name: str, values: Sequence[Any], count: int, high: int, least: int = 0) -> list[int]:
    try:
        listed = list(values)
    except TypeError:
        listed = []
    if len(listed) != count:
        raise OptionError(f"{name} is {values!r}, expected {count} whole numbers")
    return [whole(name, value, least, high) for value in listed]


def threshold(value: Any) -> float:
    number = float(value)
    if not 0 < number <= 3:
        raise OptionError(f"aa_threshold is {value!r}, expected a number above 0 and up to 3")
    return number
