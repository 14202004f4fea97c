"""What varies: `PATH=FROM:TO:COUNT`, `PATH=FROM:TO:COUNT:log` or `PATH=VALUE,VALUE,...`, and names for the values."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kage.sweep.errors import SweepError

#: What is no path in the scene: the frame of an animation, which the keys make into changes.
FRAME = "frame"
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
RANGE = re.compile(rf"({NUMBER}):({NUMBER}):(\d+)(:log)?")
MOST = 1_000_000  # values of one axis
PAIRS = {"[": "]", "{": "}", "(": ")"}


@dataclass(frozen=True)
class Axis:
    """A path in the scene and its values, as the scene's file would have them."""

    path: str
    values: tuple[str, ...]

    def __post_init__(self) -> None:
        if not self.values:
            raise SweepError(f"{self.path}: no values")
        if len(set(self.values)) < len(self.values):
            twice = next(v for k, v in enumerate(self.values) if v in self.values[:k])
            raise SweepError(f"{self.path}: the value {twice} is there twice")
        if self.path == FRAME:
            for value in self.values:
                if not re.fullmatch(NUMBER, value):
                    raise SweepError(f"{FRAME}={value}: expected a number, such as {FRAME}=0:47:48")


def axis(text: str) -> Axis:
    """An axis as the command line has it."""
    path, equals, values = text.partition("=")
    if not equals or not path.strip() or not values.strip():
        raise SweepError(f"--vary {text}: expected PATH=FROM:TO:COUNT or PATH=VALUE,VALUE,...")
    found = RANGE.fullmatch(values.strip())
    if found:
        return Axis(path.strip(), tuple(spread(text, *found.groups())))
    return Axis(path.strip(), tuple(value.strip() for value in split(values) if value.strip()))


def spread(text: str, first: str, last: str, count: str, log: str | None) -> list[str]:
    """COUNT values from the first to the last, both included, with equal differences, or equal ratios."""
    a, b, n = float(first), float(last), int(count)
    if not 1 <= n <= MOST or (n == 1 and a != b):
        raise SweepError(f"--vary {text}: {n} values, expected 2 to {MOST}")
    if not math.isfinite(a) or not math.isfinite(b):
        raise SweepError(f"--vary {text}: the numbers are too large")
    if log and not (a > 0 and b > 0):
        raise SweepError(f"--vary {text}: equal ratios need two numbers above 0")
    return [number(x) for x in (np.geomspace(a, b, n) if log else np.linspace(a, b, n))]


def number(x: float) -> str:
    """To 12 digits, so that 0.1 is not 0.1000000000000001."""
    return f"{x + 0.0:.12g}"  # no -0


def split(text: str) -> list[str]:
    """At the commas that are in no brackets and no quotes."""
    parts, depth, quote = [""], [""], ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "\"'":
            quote = letter
        elif letter in PAIRS:
            depth.append(PAIRS[letter])
        elif letter == depth[-1]:
            depth.pop()
        if letter == "," and len(depth) == 1 and not quote:
            parts.append("")
        else:
            parts[-1] += letter
    return parts


# Names for files ------------------------------------------------------------------------------------


def short_names(paths: Sequence[str]) -> dict[str, str]:
    """For each path its last words, as many as tell it from the others."""
    words = {path: path.split(".") for path in paths}
    names = {}
    for path in paths:
        count = 1
        while any(words[o][-count:] == words[path][-count:] for o in paths if o != path) and count < len(words[path]):
            count += 1
        names[path] = ".".join(words[path][-count:])
    return names


def label(values: Sequence[str]) -> list[str]:
    """For each value of an axis a text for file names, each another one; whole numbers are as wide as the widest, so
    that names sort as numbers do."""
    if all(re.fullmatch(r"\d+", value) for value in values):
        width = max(map(len, values))
        return [value.zfill(width) for value in values]
    texts = [re.sub(r"[^A-Za-z0-9.+-]+", "_", short(value)).strip("_") for value in values]
    good = len(set(texts)) == len(texts) and all(0 < len(text) <= 40 and text.strip(".") for text in texts)
    return texts if good else [f"{k:0{len(str(len(values)))}d}" for k in range(1, len(values) + 1)]


def short(value: str) -> str:
    """A number to 5 digits."""
    return f"{float(value):.5g}" if re.fullmatch(NUMBER, value) else value
