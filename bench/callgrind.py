"""What valgrind's callgrind counts in each function: instructions, and misses of the caches that it imitates.

Counts are the same in each run on one machine, whatever else it does. A function's count is its own, without those of
the functions that it calls.
"""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from bench import programs
from bench.programs import MeasureError, Word


class Function(NamedTuple):
    """Where a function is, and its name."""

    program: str  # or the library, without its folder
    name: str


Counts = dict[str, int]  # by callgrind's names: Ir are instructions, Dr and Dw data read and written, D1mr misses


class Reader:
    """Names in a profile stand once, with a number, and later by the number alone."""

    def __init__(self) -> None:
        self.names: dict[tuple[str, str], str] = {}

    def name(self, kind: str, text: str) -> str:
        number, _, name = text.partition(" ")
        if name:
            self.names[kind, number] = name
        return self.names.get((kind, number), text)


def own_costs(text: str) -> Iterator[tuple[Function, list[int]]]:
    """The lines of a profile with costs of a function itself. The line after `calls=` is the called one's."""
    reader, place, name, called = Reader(), "", "", False
    for line in text.splitlines():
        key, sign, value = line.partition("=")
        if sign and key in ("ob", "cob"):
            found = reader.name("ob", value)
            place = found if key == "ob" else place
        elif sign and key in ("fn", "cfn"):
            found = reader.name("fn", value)
            name = found if key == "fn" else name
        elif key == "calls":
            called = True
        elif line[:1] in tuple("0123456789+-*"):
            if not called:
                yield Function(Path(place).name, name), [int(word) for word in line.split()[1:]]
            called = False


def parse(text: str) -> dict[Function, Counts]:
    """From callgrind's file: the counts of each function itself."""
    found = re.search(r"^events: (.*)$", text, re.MULTILINE)
    if not found:
        raise MeasureError("callgrind: no line 'events:' in its profile")
    events = found[1].split()
    counts: dict[Function, Counts] = {}
    for function, costs in own_costs(text):
        sums = counts.setdefault(function, dict.fromkeys(events, 0))
        for event, cost in zip(events, costs, strict=False):  # zeros at a line's end are left out
            sums[event] += cost
    if not counts:
        raise MeasureError(f"callgrind collected nothing: kage must have symbols, and a function `{programs.COUNTED}`")
    return counts


def count(command: Sequence[Word], caches: bool = False) -> dict[Function, Counts]:
    """Of kage's function `render` and all that it calls."""
    environment = {name: os.environ[name] for name in programs.COUNTED_WITH if name in os.environ}
    with tempfile.TemporaryDirectory() as folder:
        profile = Path(folder) / "callgrind"
        programs.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={profile}",
                      f"--toggle-collect={programs.COUNTED}", f"--cache-sim={'yes' if caches else 'no'}", *command],
                     environment)
        return parse(profile.read_text(errors="replace"))


def total(counts: dict[Function, Counts], event: str = "Ir", program: str | None = None) -> int:
    """The sum over all functions, or over those of one program."""
    return sum(found[event] for function, found in counts.items() if program in (None, function.program))
