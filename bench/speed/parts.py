"""The jobs of each part: kage, and beside it the peers that are here."""

from __future__ import annotations

import functools
import re
import shutil
import statistics
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from bench import programs
from bench.programs import TOP, MeasureError, Size, Word
from bench.speed import inputs
from bench.speed.plan import METHODS, About, Level
from bench.speed.rounds import Figures, Job, Ran, Results, launch, milliseconds

CUBE = "scenes/cube.yaml"
TACHYON = ("tachyon", "tachyon-nox")
DECODE = "import sys, time; from PIL import Image; Image.init(); Image.MAX_IMAGE_PIXELS = None; " \
         "b = time.perf_counter(); Image.open(sys.argv[1]).load(); print('decoded', time.perf_counter() - b, 's')"
MORE_METHODS = ("march:4", "2")  # whose memory for a map is measured, besides order 0's
BEST_OF = 3  # the yardsticks print their best of several, too


def words(about: About, scene: Word, size: Size, *options: str, threads: int = 0, ending: str = "png") -> list[Word]:
    """`kage render`; 0 threads: as many as it takes by itself."""
    return [about.kage, "render", scene, *programs.size_options(size), *options,
            *(["--threads", str(threads)] if threads else []), "--stats", "--quiet",
            "-o", about.picture.with_suffix(f".{ending}")]


def pixels(size: Size) -> int:
    return size[0] * size[1]


def without(found: Ran, times: Figures) -> float:
    """The seconds of a run without its trace and the writing: of starting and reading the scene."""
    return min(found.seconds) - (times["render"] + times.get("output", 0)) / 1e3


def matched(pattern: str, text: str) -> float:
    found = re.search(pattern, text)
    if not found:
        raise MeasureError(f"no {pattern} in {text[-200:]!r}")
    return float(found[1])


# The trace ----------------------------------------------------------------------------------------


def trace_once(command: Sequence[Word], size: Size) -> Figures:
    found = launch(command, BEST_OF)
    times = milliseconds(found.text)
    return {"ns": times["render"] * 1e6 / pixels(size), **found.weight}


def trace_job(about: About, name: str, scene: Word, size: Size, rounds: int, *options: str, threads: int = 1) -> Job:
    command = words(about, scene, size, *options, threads=threads)
    return Job(name, "trace", functools.partial(trace_once, command, size), rounds, programs.shown(command))


def fused_once(program: Path) -> Figures:
    return programs.parse_fused(programs.run([program, "1"]))


def fused(about: About) -> list[Job]:
    program = programs.build_limit("fused_kernel", about.out / "limits")
    return [Job("fused", "trace", functools.partial(fused_once, program), about.level.rounds)]


def trace(about: About) -> list[Job]:
    level = about.level
    jobs = [trace_job(about, f"kage {method}", CUBE, level.size, level.rounds, "--shadow", method)
            for method in METHODS]
    return [*jobs, trace_job(about, "kage 0, 2 threads", CUBE, level.size, level.rounds, "--shadow", "0", threads=2)]


# Peers --------------------------------------------------------------------------------------------


def povray_once(scene: Path, size: Size, picture: Path) -> Figures:
    command = [*programs.povray_command(scene, size), "+FN", f"+O{picture}"]
    command.remove("-F")
    found = launch(command)
    return {"ns": programs.parse_povray(found.text)["trace"] * 1e9 / pixels(size), "whole_s": min(found.seconds),
            **found.weight}


def povray(about: About) -> list[Job]:
    if not programs.has_povray():
        raise MeasureError("no povray")
    size, folder = about.level.povray_size, TOP / "bench"
    smooth = about.inputs / "smooth.pov"
    about.inputs.mkdir(parents=True, exist_ok=True)
    programs.run([about.kage, "pov", CUBE, "--surface", "smooth", *programs.size_options(size), "-o", smooth])
    scenes = {"bump_map": folder / "cube_bump_map.pov", "height_field": folder / "cube_height_field.pov",
              "smooth": smooth}
    picture = about.picture.with_suffix(".png")
    return [Job(f"POV-Ray {name}", "peers", functools.partial(povray_once, scene, size, picture),
                about.level.slow_rounds) for name, scene in scenes.items()]


def whole_once(command: Sequence[Word], size: Size) -> Figures:
    found = launch(command)
    return {"ns": milliseconds(found.text)["render"] * 1e6 / pixels(size), "whole_s": min(found.seconds),
            **found.weight}


def tachyon_once(program: str, scene: Path, size: Size, picture: Path) -> Figures:
    found = launch([program, scene, "-numthreads", "1", "-res", str(size[0]), str(size[1]), "-format", "PPM", "-o",
                    picture])
    seconds = matched(r"Ray Tracing Time: +([0-9.]+) seconds", found.text)
    return {"ns": seconds * 1e9 / pixels(size), "whole_s": min(found.seconds), **found.weight}


def tachyon(about: About) -> list[Job]:
    program = next((name for name in TACHYON if shutil.which(name)), None)
    if not program:
        return []
    scene = inputs.text_file(about.inputs / "tachyon.dat", inputs.TACHYON_SCENE)
    work = functools.partial(tachyon_once, program, scene, about.level.size, about.picture.with_suffix(".ppm"))
    return [Job("Tachyon, smooth", "peers", work, about.level.slow_rounds)]


def embree_once(program: Path, *arguments: str) -> Figures:
    text = programs.run([program, *arguments])
    return {"ns": matched(r"([0-9.]+) ns/pixel", text), "build_s": matched(r"build ([0-9.]+) ms", text) / 1e3}


def embree(about: About) -> list[Job]:
    if not about.level.yardsticks:
        return []
    program = programs.build_limit("embree_loop", about.out / "limits")
    return [Job(f"Embree, {name}", "peers", functools.partial(embree_once, program, cells), about.level.slow_rounds)
            for name, cells in (("plane", "1"), ("displaced mesh", "1024"))]


def whole(about: About) -> list[Job]:
    """kage beside the peers, with reading the scene and writing the picture."""
    level, jobs = about.level, []
    for method in ("none", "0", "displaced"):
        command = words(about, CUBE, level.povray_size, *programs.method_options(method), threads=1)
        jobs.append(Job(f"kage {method}, whole", "peers",
                        functools.partial(whole_once, command, level.povray_size), level.slow_rounds,
                        programs.shown(command)))
    return jobs


# Writing ------------------------------------------------------------------------------------------


def write_once(command: Sequence[Word], size: Size) -> Figures:
    found = launch(command)
    path = Path(command[-1])
    return {"output_s": milliseconds(found.text)["output"] / 1e3, "file_bytes": float(path.stat().st_size),
            "pixel_bytes": path.stat().st_size / pixels(size), **found.weight}


def exr(about: About) -> list[Job]:
    level = about.level
    kinds = {"exr, 1 thread": ("exr", 1, []), "exr, 2 threads": ("exr", 2, []),
             "png, 8 bits": ("png", 2, ["--bits", "8"]), "png, 16 bits": ("png", 2, ["--bits", "16"])}
    jobs = []
    for name, (ending, threads, options) in kinds.items():
        command = words(about, CUBE, level.size, *options, threads=threads, ending=ending)
        jobs.append(Job(name, "exr", functools.partial(write_once, command, level.size), level.slow_rounds,
                        programs.shown(command)))
    return jobs


# Maps ---------------------------------------------------------------------------------------------


def map_once(command: Sequence[Word]) -> Figures:
    found = launch(command)
    times = milliseconds(found.text)
    return {"ready_s": without(found, times), **found.weight}


def look_up_once(command: Sequence[Word]) -> Figures:
    times = milliseconds(launch(command, BEST_OF).text)
    return {"bump_ms": times["bump"], "render_ms": times["render"]}


def look_up_job(about: About, size: int) -> Job:
    command = words(about, inputs.map_scene(about.inputs, size, "png"), about.level.size, threads=1)
    return Job(f"look-ups {size}", "maps", functools.partial(look_up_once, command), about.level.slow_rounds,
               programs.shown(command))


def sample_bytes(level: Level, results: Results) -> None:
    """Add the memory of a map's sample: of the run with the map less that with the smallest map."""
    smallest = level.maps[0]
    for ending in ("", *(f", {method}" for method in MORE_METHODS)):
        base = results.values.get(f"map {smallest}{ending}: memory", [])
        for size in level.maps[1:]:
            found = results.values.get(f"map {size}{ending}: memory", [])
            for most, least in zip(found, base, strict=False):
                results.add(f"map {size}{ending}", {"sample_bytes": (most - least) / (size**2 - smallest**2)})


def decode_once(program: Path, picture: Path) -> Figures:
    return {"s": matched(r"decoded ([0-9.]+) s", programs.run([program, picture]))}


def pillow_once(picture: Path) -> Figures:
    return {"s": matched(r"decoded ([0-9.e-]+) s", programs.run([sys.executable, "-c", DECODE, picture]))}


def map_job(about: About, name: str, scene: Path, method: str) -> Job:
    command = words(about, scene, about.level.size, "--shadow", method)
    return Job(name, "maps", functools.partial(map_once, command), about.level.slow_rounds, programs.shown(command))


def decoders(about: About) -> list[Job]:
    """libpng alone, and Pillow."""
    level, jobs = about.level, []
    program = programs.build_limit("png_decode", about.out / "limits")
    for size in level.maps:
        inputs.map_scene(about.inputs, size, "png")
        picture = about.inputs / f"map{size}.png"
        jobs += [Job(f"decode {size}", "maps", functools.partial(decode_once, program, picture), level.slow_rounds),
                 Job(f"Pillow {size}", "maps", functools.partial(pillow_once, picture), level.slow_rounds)]
    return jobs


def maps(about: About) -> list[Job]:
    level, jobs = about.level, []
    for size in level.maps:
        scene = inputs.map_scene(about.inputs, size, "png")
        jobs.append(map_job(about, f"map {size}", scene, "0"))
        if size in (level.maps[0], level.maps[-1]):
            jobs += [map_job(about, f"map {size}, {method}", scene, method) for method in MORE_METHODS]
            jobs.append(look_up_job(about, size))
    exr_scene = inputs.map_scene(about.inputs, level.exr_map, "exr")
    return [*jobs, map_job(about, f"map {level.exr_map} exr", exr_scene, "0")]


# Meshes and objects -------------------------------------------------------------------------------


def load_once(command: Sequence[Word], size: Size) -> Figures:
    found = launch(command)
    times = milliseconds(found.text)
    return {"ready_s": without(found, times), **found.weight, "ns": times["render"] * 1e6 / pixels(size)}


def mesh_once(load: Sequence[Word], traced: Sequence[Word], size: Size) -> Figures:
    """Read by two threads, traced by one."""
    found = load_once(load, size)
    return found | {"ns": milliseconds(launch(traced).text)["render"] * 1e6 / pixels(size)}


def embree_mesh(about: About) -> list[Job]:
    level = about.level
    program = programs.build_limit("embree_mesh", about.out / "limits")
    found = inputs.mesh(about.inputs, level.quads)
    work = functools.partial(embree_once, program, str(found), *map(str, level.size))
    return [Job("embree mesh", "meshes", work, level.slow_rounds)]


def meshes(about: About) -> list[Job]:
    level = about.level
    scene = inputs.mesh_scene(about.inputs, level.quads)
    load, traced = words(about, scene, (16, 16), threads=2), words(about, scene, level.size, threads=1)
    jobs = [Job("mesh", "meshes", functools.partial(mesh_once, load, traced, level.size), level.slow_rounds,
                programs.shown(traced))]
    if level.more_quads:
        more = words(about, inputs.mesh_scene(about.inputs, level.more_quads), level.size, threads=2)
        jobs.append(Job("mesh, more", "meshes", functools.partial(load_once, more, level.size), level.once,
                        programs.shown(more)))
    return jobs


def objects(about: About) -> list[Job]:
    """Few spheres written out and as a list of copies, many as a list."""
    jobs = []
    for count in about.level.objects:
        for written_out in (True, False) if count <= inputs.MOST_LISTED else (False,):
            scene = inputs.objects_scene(about.inputs, count, written_out)
            command = words(about, scene, about.level.size, threads=1)
            name = f"{'spheres written out' if written_out else 'spheres'} {count}"
            jobs.append(Job(name, "objects", functools.partial(load_once, command, about.level.size),
                            about.level.slow_rounds, programs.shown(command)))
    return jobs


# Large pictures, and small ones -------------------------------------------------------------------


def whole_picture_once(command: Sequence[Word], size: Size) -> Figures:
    found = launch(command)
    path = Path(command[-1])
    result: Figures = {"pixel_ns": min(found.seconds) * 1e9 / pixels(size), **found.weight,
              "file_bytes": float(path.stat().st_size)}
    path.unlink()
    return result


def large(about: About) -> list[Job]:
    level = about.level
    jobs = []
    for name, size, rounds in (("usual", level.size, level.slow_rounds), ("large", level.large, level.once)):
        command = words(about, CUBE, size, "--layers", "color", ending="exr")
        jobs.append(Job(name, "large", functools.partial(whole_picture_once, command, size), rounds,
                        programs.shown(command)))
    return jobs


def start_once(command: Sequence[Word], times: int) -> Figures:
    found = launch(command, times)
    return {"ms": 1e3 * statistics.median(found.seconds), "cpu_ms": 1e3 * statistics.median(found.cpu),
            **found.weight}


def start(about: About) -> list[Job]:
    scene = inputs.text_file(about.inputs / "small.yaml", inputs.SMALL_SCENE)
    commands: dict[str, list[Word]] = {
        "start, 1 thread": words(about, scene, (64, 64), threads=1), "start": words(about, scene, (64, 64)),
        "kage --version": [about.kage, "--version"], "true": ["true"],
    }
    return [Job(name, "start", functools.partial(start_once, command, about.level.starts), about.level.rounds,
                programs.shown(command)) for name, command in commands.items()]


# kage's own and each peer's apart: where one can't be built or found, the others are still measured.
MAKERS: tuple[tuple[str, Callable[[About], list[Job]]], ...] = (
    ("trace", fused), ("trace", trace), ("peers", povray), ("peers", whole), ("peers", tachyon), ("peers", embree),
    ("exr", exr), ("maps", decoders), ("maps", maps), ("meshes", embree_mesh), ("meshes", meshes), ("objects", objects),
    ("large", large), ("start", start),
)


def jobs(about: About, wanted: Sequence[str]) -> tuple[list[Job], dict[str, str]]:
    """The jobs of the parts, and why parts can't be measured."""
    found: list[Job] = []
    missing: dict[str, str] = {}
    for part, make in MAKERS:
        if part in wanted:
            try:
                found += make(about)
            except (MeasureError, OSError, ImportError) as error:
                missing[f"{part}, {make.__name__}"] = str(error)
    return found, missing
