"""Which pictures a sweep makes: the product of its axes, each picture with its changes, its file and its identity."""

from __future__ import annotations

import functools
import hashlib
import itertools
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import kage
from kage.sweep.axes import FRAME, Axis, label, short_names
from kage.sweep.errors import SweepError
from kage.sweep.inputs import VERSION, Inputs
from kage.sweep.keys import Keys

ROWS = 16  # of a chunk of an EXR: a band has a multiple
MOST = 1_000_000  # pictures
LONGEST = 150  # letters of a file's name


@dataclass(frozen=True)
class Output:
    """Where the pictures go, and what they are."""

    folder: str | Path
    kind: str = "png"  # or "exr"
    size: tuple[int, int] | None = None  # None: as the scene says
    bits: int | None = None  # of a PNG: 8 or 16
    layers: str | None = None  # of an EXR: "color,tau"; None: all
    bands: int = 1  # each picture is rendered in so many parts


@dataclass(frozen=True)
class Task:
    """One picture, or one band of it. Its file depends on nothing else."""

    file: str  # below the folder
    values: tuple[tuple[str, str], ...]  # of the axes, by path
    sets: tuple[tuple[str, str], ...]  # the scene's changes
    size: tuple[int, int] | None
    crop: tuple[int, int, int, int] | None
    bits: int | None
    layers: str | None
    identity: str  # of all that the bytes depend on


@dataclass(frozen=True)
class Picture:
    """A file, and what has to be rendered for it: one task, or bands."""

    whole: Task
    bands: tuple[Task, ...] = ()


@dataclass(frozen=True)
class Plan:
    """All pictures of a sweep."""

    inputs: Inputs
    axes: tuple[Axis, ...]
    output: Output
    pictures: tuple[Picture, ...]
    send: bool = False  # files travel to the workers and pictures back; else both are in folders that all share

    @staticmethod
    def of(scene: str | Path, axes: Sequence[Axis], output: Output, *, sets: Mapping[str, str] | None = None,
           keys: Keys | None = None, send: bool = False) -> Plan:
        """Read the scene with the first picture's changes, so that what is wrong with it is told once and at once.

        sets: changes of all pictures. keys: what the axis `frame` means. send: see Plan.send.
        """
        check(axes, output, keys)
        fixed = dict(sets or {})
        tracks = keys.tracks if keys else ()
        values = [v for a in axes for v in a.values] + [*fixed.values()]
        values += [track.at(frame) for track in tracks if track.between == "hold" for frame in track.frames]
        inputs = Inputs.read(Path(scene), values, send)
        found: list[Picture] = []
        sizes = Sizes(inputs, output.size)
        for words in named(axes):
            changed = {**fixed, **changes(words.values, keys)}
            if not found:
                inputs.load(changed)
            found.append(picture(inputs, output, words, changed, sizes))
        return Plan(inputs, tuple(axes), output, tuple(found), send)


def check(axes: Sequence[Axis], output: Output, keys: Keys | None) -> None:
    """What can be said without the scene."""
    paths = [a.path for a in axes]
    count = functools.reduce(lambda n, a: n * len(a.values), axes, 1)
    if len(set(paths)) < len(paths):
        raise SweepError(f"{next(p for k, p in enumerate(paths) if p in paths[:k])} varies twice")
    if (FRAME in paths) != (keys is not None):
        raise SweepError(f"an animation needs both: --vary {FRAME}=FROM:TO:COUNT and --keys KEYS.yaml")
    if keys and (both := {t.path for t in keys.tracks} & set(paths)):
        raise SweepError(f"{min(both)} varies, and has keys, too")
    if count > MOST:
        raise SweepError(f"{count} pictures, expected at most {MOST}")
    if output.kind not in ("png", "exr"):
        raise SweepError(f"'{output.kind}' is no format, expected png or exr")
    if output.bands < 1:
        raise SweepError(f"{output.bands} bands, expected 1 or more")
    if output.bands > 1 and output.kind != "exr":
        raise SweepError("bands are joined to an EXR: --format exr")
    if (output.layers and output.kind != "exr") or (output.bits and output.kind != "png"):
        raise SweepError("layers are those of an EXR, bits those of a PNG")


# One picture ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Words:
    """A place in the grid: the axes' values, and the name that they give."""

    values: dict[str, str]
    name: str


def named(axes: Sequence[Axis]) -> list[Words]:
    """Every combination, the last axis fastest."""
    names = short_names([a.path for a in axes])
    labels = [dict(zip(a.values, label(a.values), strict=True)) for a in axes]
    found = []
    for number, values in enumerate(itertools.product(*(a.values for a in axes)), 1):
        parts = [f"{names[a.path]}={labels[k][values[k]]}" for k, a in enumerate(axes)]
        name = ",".join(parts) or "picture"
        name = name if len(name) <= LONGEST else f"{number:07d}"
        found.append(Words(dict(zip((a.path for a in axes), values, strict=True)), name.replace("/", "_")))
    return found


def changes(values: Mapping[str, str], keys: Keys | None) -> dict[str, str]:
    """A place's values as changes of the scene."""
    found = keys.at(float(values[FRAME])) if keys else {}
    return {**found, **{path: value for path, value in values.items() if path != FRAME}}


class Sizes:
    """The pictures' sizes, which decide on bands; the scene is read only where its changes may alter them."""

    def __init__(self, inputs: Inputs, size: tuple[int, int] | None) -> None:
        self.inputs, self.size = inputs, size
        self.known: dict[tuple[str, ...], tuple[int, int]] = {}

    def of(self, sets: Mapping[str, str]) -> tuple[int, int]:
        key = tuple(value for path, value in sets.items() if path.split(".")[0] == "image")
        if self.size:
            return self.size
        if key not in self.known:
            info = self.inputs.load(sets).info
            self.known[key] = info.width, info.height
        return self.known[key]


def picture(inputs: Inputs, output: Output, words: Words, sets: Mapping[str, str], sizes: Sizes) -> Picture:
    make = functools.partial(task, inputs, output, words.values, sets)
    whole = make(f"{words.name}.{output.kind}", None)
    if output.bands == 1:
        return Picture(whole)
    width, height = sizes.of(sets)
    chunks = -(-height // ROWS)
    tops = sorted({ROWS * (chunks * k // output.bands) for k in range(output.bands)})
    ends = [*tops[1:], height]
    return Picture(whole, tuple(make(f"{words.name}.{top:05d}.band.exr", (0, top, width, end))
                                for top, end in zip(tops, ends, strict=True)))


def task(inputs: Inputs, output: Output, values: Mapping[str, str], sets: Mapping[str, str], file: str,
         crop: tuple[int, int, int, int] | None) -> Task:
    about = [VERSION, inputs.digest, list(sets.items()), output.size, crop, output.kind, output.bits, output.layers]
    identity = hashlib.sha256(json.dumps(about).encode()).hexdigest()
    return Task(file, tuple(values.items()), tuple(sets.items()), output.size, crop, output.bits, output.layers,
                identity)


def scene_of(inputs: Inputs, one: Task) -> kage.Scene:
    """As Inputs.load, but a process reads what the changes do not touch once for all tasks."""
    try:
        return unchanged(inputs).changed(dict(one.sets))
    except kage.InputError:  # it may be right with the changes only; if not, this says what is wrong
        return inputs.load(dict(one.sets))


@functools.lru_cache(maxsize=1)
def unchanged(inputs: Inputs) -> kage.Scene:
    return inputs.load({})
