"""How much is measured at each level, and the bounds that kage sets its speed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from bench import programs
from bench.data import BUMP_ONLY, label
from bench.programs import Size
from bench.speed import inputs

PARTS = ("trace", "peers", "exr", "maps", "meshes", "objects", "large", "start", "stages")
METHODS = ("none", "0", "1", "2", "march:4", "march:8")


@dataclass(frozen=True)
class Level:
    """Sizes, and how often. The bounds are meant for those of normal and full."""

    name: str
    rounds: int
    slow_rounds: int  # of jobs that take seconds
    once: int  # of those that take minutes
    size: Size  # of most pictures
    povray_size: Size
    maps: tuple[int, ...]
    exr_map: int
    quads: tuple[int, int]  # of the mesh, two triangles each
    more_quads: tuple[int, int] | None  # of ten million triangles, which are read only
    objects: tuple[int, ...]
    large: Size
    starts: int  # in each round
    yardsticks: bool  # Embree's plane and displaced mesh, which take seconds
    count_size: Size
    counted: int  # scenes whose stages are counted


LEVELS = {
    level.name: level
    for level in (
        Level("quick", 3, 2, 1, (480, 272), (240, 135), (256, 1024), 1024, (100, 50), None, (10, 1000), (1024, 1024), 5,
              False, (64, 48), 2),
        Level("normal", 9, 5, 2, (1920, 1080), (480, 270), (256, 1024, 4096, 8192), 4096, (1000, 500), None,
              (10, 1000, 100_000, 1_000_000), (8192, 8192), 15, True, (160, 120), 7),
        Level("full", 15, 9, 3, (1920, 1080), (960, 540), (256, 1024, 4096, 8192), 4096, (1000, 500), (3162, 1581),
              (10, 1000, 100_000, 1_000_000), (32768, 32768), 31, True, (320, 240), 7),
    )
}


@dataclass(frozen=True)
class About:
    """What the jobs depend on."""

    kage: Path
    out: Path
    level: Level

    @property
    def inputs(self) -> Path:
        """Named by what makes them, so that a change makes them anew."""
        return self.out / f"inputs-{programs.file_digest(Path(inputs.__file__))[:8]}"

    @property
    def picture(self) -> Path:
        """Where pictures go, each over the last."""
        return self.out / "picture"


@dataclass(frozen=True)
class Bound:
    """A figure, or the ratio of two, that is at most `most` or at least `least`."""

    part: str
    what: str
    over: str  # "job: figure", as in rounds.Results
    under: str | None
    limit: float
    unit: str
    at_least: bool = False


GIB = 2.0**30
EXR_SIZE = (1920, 1080)
EXR_BYTES = 34.9  # a pixel of figure 5's scene at that size, all layers, by zlib at level 4: commit ba3bdad


def trace_bounds() -> list[Bound]:
    found = [Bound("trace", f"{label(method)} over the fused loop", f"kage {method}: ns", f"fused: {method}", 1.15,
                   "times")
             for method in ("none", "0")]
    for method, limit in (("1", 1.05), ("2", 1.12), ("march:4", 1.6), ("march:8", 2.1)):
        found.append(Bound("trace", f"{method} over {BUMP_ONLY}", f"kage {method}: ns", "kage none: ns", limit,
                           "times"))
    return [*found, Bound("trace", "order 0: one thread over two", "kage 0: ns", "kage 0, 2 threads: ns", 1.9, "times",
                          at_least=True)]


def map_bounds(level: Level) -> list[Bound]:
    small, large = level.maps[0], level.maps[-1]
    ready = [Bound("maps", f"{size}²: ready, over decoding the PNG", f"map {size}: ready_s", f"decode {size}: s", 1.3,
                   "times") for size in level.maps[2:] or [large]]
    memory = [Bound("maps", f"{large}²: memory by {method}", f"map {large}{ending}: sample_bytes", None, 6,
                    "bytes a sample") for method, ending in (("0", ""), ("march:4", ", march:4"))]
    exr = f"map {level.exr_map}"
    return [*ready, *memory,
            Bound("maps", f"{level.exr_map}²: EXR over PNG, ready", f"{exr} exr: ready_s", f"{exr}: ready_s", 1.0,
                  "times"),
            Bound("maps", f"look-ups of {large}² over {small}²", f"look-ups {large}: bump_ms",
                  f"look-ups {small}: bump_ms", 1.5, "times")]


def bounds(level: Level) -> list[Bound]:
    """In the order of issue 12."""
    few, many = level.objects[0], level.objects[-1]
    triangles = 2 * level.quads[0] * level.quads[1]
    size = [Bound("exr", "its file", "exr, 2 threads: pixel_bytes", None, 1.01 * EXR_BYTES, "bytes a pixel")] \
        if level.size == EXR_SIZE else []
    more = [Bound("meshes", "ten million triangles: memory", "mesh, more: memory", None, 8 * GIB, "bytes")] \
        if level.more_quads else []
    return [
        Bound("exr", "all layers to EXR, two threads", "exr, 2 threads: output_s", None, 0.35, "s"),
        *size,
        *map_bounds(level),
        Bound("meshes", f"{triangles} triangles: read and built, two threads", "mesh: ready_s", None, 1.5, "s"),
        Bound("meshes", f"{triangles} triangles: traced, over Embree's loop", "mesh: ns", "embree mesh: ns", 2.0,
              "times"),
        *more,
        Bound("objects", f"{many} spheres over {few}, as lists", f"spheres {many}: ns", f"spheres {few}: ns", 5.0,
              "times"),
        Bound("objects", f"{many} spheres over {few} written out", f"spheres {many}: ns",
              f"spheres written out {few}: ns", 5.0, "times"),
        *trace_bounds(),
        Bound("large", f"{level.large[0]} x {level.large[1]} to EXR: memory", "large: memory", None, 2 * GIB, "bytes"),
        Bound("large", "its time a pixel over that of "
              f"{level.size[0]} x {level.size[1]}", "large: pixel_ns", "usual: pixel_ns", 1.2, "times"),
        Bound("start", "a small picture, one thread", "start, 1 thread: ms", None, 10, "ms"),
        Bound("start", "a small picture, by default", "start: ms", None, 10, "ms"),
    ]
