"""What each stage costs: instructions and cache misses by callgrind, and time, or cycles, by perf.

A stage is one loop over the lanes, a function of its own, so its counts are the function's. callgrind imitates a
processor with AVX2 and the caches of this one; misses are exact for that, and the same in each run. perf samples real
runs; without counters in the processor it samples by the clock.
"""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from bench import callgrind, programs
from bench.callgrind import Counts
from bench.data import label
from bench.programs import MeasureError, Word
from bench.speed import inputs, parts
from bench.speed.plan import About

LEAST = 0.01  # of a scene's instructions or samples: smaller stages are added up
OTHERS = "all others"
FREQUENCY = 4000


@dataclass(frozen=True)
class Row:
    """A stage's counts a pixel, and its share of perf's samples, if there are any."""

    stage: str
    instructions: float
    accesses: float  # data read and written
    first_misses: float  # of the first-level data cache
    last_misses: float  # of the last level: lines from memory
    share: float | None  # of the samples in all rows, 0 to 1


@dataclass(frozen=True)
class Scene:
    """A scene's table."""

    name: str
    rows: list[Row]
    event: str  # what the samples are of; empty: there are none


def scenes(about: About) -> dict[str, list[Word]]:
    """Each with its command, without the size."""
    found: dict[str, list[Word]] = {f"figure 5's scene by {label(method)}": [parts.CUBE, "--shadow", method]
                                    for method in ("none", "0", "2", "march:8")}
    found["terrain by auto"] = ["scenes/terrain.yaml", "--shadow", "auto"]
    found["mesh"] = [inputs.mesh_scene(about.inputs, about.level.quads)]
    found["spheres"] = [inputs.objects_scene(about.inputs, about.level.objects[1], False)]
    return found


def stage_name(name: str) -> str:
    """Without the instruction level that the compiler has added."""
    return re.sub(r"\.(arch_x86_64_v\d|default|avx2|isra\.\d+|constprop\.\d+|part\.\d+|lto_priv\.\d+)\b.*", "", name)


def place(function: callgrind.Function) -> str:
    """A function of kage by its name, of a library by the library's."""
    return stage_name(function.name) if function.program == "kage" else function.program


def summed(counts: dict[callgrind.Function, Counts]) -> dict[str, Counts]:
    found: dict[str, Counts] = {}
    for function, costs in counts.items():
        sums = found.setdefault(place(function), dict.fromkeys(costs, 0))
        for event, cost in costs.items():
            sums[event] += cost
    return found


def parse_perf(text: str) -> tuple[str, dict[str, float]]:
    """From `perf report`: the event, and each function's share of the samples."""
    event = re.search(r"of event '([\w-]+)", text)
    found: dict[str, float] = {}
    for share, program, name in re.findall(r"^ *([0-9.]+)% +(\S+) +\[[.k]\] (.+?) *$", text, re.MULTILINE):
        where = place(callgrind.Function("kage" if program == "kage" else program, name))
        found[where] = found.get(where, 0) + float(share) / 100
    return event[1] if event and found else "", found


def sample(command: Sequence[Word]) -> tuple[str, dict[str, float]]:
    """The event, and the share of each function; empty where perf is not here or may not sample. perf takes cycles, or
    the clock where it can't count them."""
    if not shutil.which("perf"):
        return "", {}
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder) / "perf"
        try:
            programs.run(["perf", "record", "-o", data, "-F", str(FREQUENCY), *command])
            text = programs.run(["perf", "report", "-i", data, "--stdio", "--no-children", "--sort", "dso,symbol"])
        except MeasureError:
            return "", {}
    return parse_perf(text)


def row(stage: str, counts: Sequence[Counts], pixels: int, share: float | None) -> Row:
    def a_pixel(*events: str) -> float:
        return sum(found.get(event, 0) for found in counts for event in events) / pixels

    return Row(stage, a_pixel("Ir"), a_pixel("Dr", "Dw"), a_pixel("D1mr", "D1mw"), a_pixel("DLmr", "DLmw"), share)


def table(name: str, counts: dict[str, Counts], pixels: int, event: str, shares: dict[str, float]) -> Scene:
    """The stages that cost most, first; the last row is all others."""
    total = sum(found["Ir"] for found in counts.values())
    inside = {stage: share for stage, share in shares.items() if stage in counts}  # without reading and writing
    event = event if any(inside.values()) else ""
    shares = {stage: share / sum(inside.values()) for stage, share in inside.items()} if event else {}
    most = sorted((stage for stage, found in counts.items()
                   if found["Ir"] >= LEAST * total or shares.get(stage, 0) >= LEAST),
                  key=lambda stage: -counts[stage]["Ir"])
    rows = [row(stage, [counts[stage]], pixels, shares.get(stage, 0) if event else None) for stage in most]
    left = [found for stage, found in counts.items() if stage not in most]
    rest = sum(share for stage, share in shares.items() if stage not in most) if event else None
    return Scene(name, [*rows, row(OTHERS, left, pixels, rest)], event)


def measure(about: About, tell: parts.Callable[[str], None]) -> tuple[list[Scene], dict[str, str]]:
    """A table for each scene, and why some are missing."""
    size, found, missing = about.level.count_size, [], {}
    output: list[Word] = ["--threads", "1", "--quiet", "-o", about.picture.with_suffix(".png")]
    for name, words in list(scenes(about).items())[:about.level.counted]:
        tell(f"stages: {name}")
        command = [about.kage, "render", *words, *output]
        try:
            counts = callgrind.count([*command, *programs.size_options(size)], caches=True)
        except MeasureError as error:
            missing[f"stages, {name}"] = str(error)
            continue
        event, shares = sample([*command, *programs.size_options(about.level.size)])
        found.append(table(name, summed(counts), parts.pixels(size), event, shares))
    return found, missing
