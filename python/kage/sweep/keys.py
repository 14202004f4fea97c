"""Keys of an animation: values of the scene at some frames, and what they are at the frames between.

A file of keys is YAML: for each path of the scene a list of [frame, value], or the list with the way between them:

    camera.from: [[0, [0, 3, -5]], [24, [4, 3, -3]], [47, [5, 2, 0]]]
    objects.ground.bump.scale: {between: smooth, keys: [[0, 0], [47, 0.3]]}
    render.shadow: [[0, none], [24, 2]]

Numbers and lists of numbers go `linear` from key to key, which is the default, or `smooth`. Anything else, and what is
to `hold`, stays as it is until the next key. Before the first key and after the last the value is the key's.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from kage.sweep.axes import number
from kage.sweep.errors import SweepError

WAYS = ("linear", "smooth", "hold")


@dataclass(frozen=True)
class Track:
    """The keys of one path."""

    path: str
    frames: tuple[float, ...]
    values: tuple[Any, ...]
    between: str

    def at(self, frame: float) -> str:
        """The value at a frame, as the scene's file would have it."""
        if self.between == "hold":
            return as_text(self.values[max(0, int(np.searchsorted(self.frames, frame, side="right")) - 1)])
        points = np.array(self.values, dtype=float)
        columns = points.reshape(len(points), -1).T
        curve = smooth if self.between == "smooth" else linear
        found = [number(curve(np.array(self.frames), column, frame)) for column in columns]
        return found[0] if points.ndim == 1 else f"[{', '.join(found)}]"


def linear(x: NDArray[np.float64], y: NDArray[np.float64], at: float) -> float:
    return float(np.interp(at, x, y))


def smooth(x: NDArray[np.float64], y: NDArray[np.float64], at: float) -> float:
    """Cubic pieces through the keys, with a continuous speed, which is 0 at the first and at the last key. Between two
    keys the value stays between theirs (Fritsch and Butland's slopes)."""
    k = int(np.clip(np.searchsorted(x, at, side="right") - 1, 0, max(0, len(x) - 2)))
    if len(x) == 1 or at <= x[0] or at >= x[-1]:
        return float(np.interp(at, x, y))
    h, d = np.diff(x), np.diff(y) / np.diff(x)
    slope = np.zeros(len(x))
    for i in range(1, len(x) - 1):
        if d[i - 1] * d[i] > 0:
            a, b = 2 * h[i] + h[i - 1], h[i] + 2 * h[i - 1]
            slope[i] = (a + b) / (a / d[i - 1] + b / d[i])
    t = (at - x[k]) / h[k]
    return float(y[k] * (1 + 2 * t) * (1 - t) ** 2 + slope[k] * h[k] * t * (1 - t) ** 2
                 + y[k + 1] * t * t * (3 - 2 * t) + slope[k + 1] * h[k] * t * t * (t - 1))


def as_text(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value)


@dataclass(frozen=True)
class Keys:
    """All tracks of an animation."""

    tracks: tuple[Track, ...]

    def at(self, frame: float) -> dict[str, str]:
        """The changes of the scene at a frame."""
        return {track.path: track.at(frame) for track in self.tracks}

    @staticmethod
    def read(path: Path) -> Keys:
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise SweepError(f"{path}: can't be read: {error}") from error
        return Keys.parse(text, str(path))

    @staticmethod
    def parse(text: str, name: str = "keys") -> Keys:
        """Errors name the line of the path's key."""
        try:
            node = yaml.compose(text, Loader=yaml.SafeLoader)
            found = yaml.safe_load(text)
        except yaml.MarkedYAMLError as error:
            mark = error.problem_mark
            where = f":{mark.line + 1}:{mark.column + 1}" if mark else ""
            raise SweepError(f"{name}{where}: {error.problem}") from error
        if not isinstance(found, Mapping) or not found:
            raise SweepError(f"{name}: expected a path of the scene and its keys, as `camera.fov: [[0, 40], [47, 60]]`")
        marks = {key.value: f"{name}:{key.start_mark.line + 1}:{key.start_mark.column + 1}" for key, _ in node.value}
        return Keys(tuple(track(str(path), about, marks.get(str(path), name)) for path, about in found.items()))


def track(path: str, about: Any, where: str) -> Track:
    """One entry of the file."""
    between = "linear"
    if isinstance(about, Mapping):
        if not {"keys"} <= about.keys() <= {"keys", "between"}:
            raise SweepError(f"{where}: {path} has {', '.join(map(str, about))}, expected `keys` and `between`")
        about, between = about["keys"], about.get("between", "linear")
    if between not in WAYS:
        raise SweepError(f"{where}: between: {between}, expected {', '.join(WAYS)}")
    if not isinstance(about, list) or not about or not all(is_key(key) for key in about):
        raise SweepError(f"{where}: {path}: expected a list of [frame, value]")
    frames, values = tuple(float(key[0]) for key in about), tuple(key[1] for key in about)
    if any(a >= b for a, b in itertools.pairwise(frames)):
        raise SweepError(f"{where}: {path}: the frames of the keys do not rise")
    return Track(path, frames, values, between if is_numeric(values) else "hold")


def is_key(key: Any) -> bool:
    return isinstance(key, list) and len(key) == 2 and is_number(key[0]) and key[1] is not None


def is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def is_numeric(values: tuple[Any, ...]) -> bool:
    """All are numbers, or all are lists of numbers with one length."""
    if all(is_number(value) for value in values):
        return True
    listed = all(isinstance(value, list) and value and all(map(is_number, value)) for value in values)
    return listed and len({len(value) for value in values}) == 1
