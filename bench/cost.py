"""What the methods cost: time, instructions, memory; and what other programs take for similar work.

A round measures everything once, so that whatever else the machine does slows all alike. In a round the methods of a
scene come one after the other; the next round takes them in the opposite order. kage's time is that of the render,
without reading the scene and writing the picture.
"""

from __future__ import annotations

import functools
import shutil
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

from bench import programs
from bench.plan import Bench, Facts
from bench.programs import TOP, MeasureError, Size, Word
from bench.runner import Job, Stage
from bench.store import Inputs, Value

POVRAY = "POV-Ray"
POV_SCENES = {"bump_map": "cube_bump_map", "height_field": "cube_height_field"}  # of the scene cube, in bench/
# What `kage pov` makes of a displaced scene. Other scenes give larger meshes, which are not timed.
DISPLACED = {"waves": "isosurface", "torus": "isosurface", "cube": "mesh2"}


# kage ---------------------------------------------------------------------------------------------


def command(bench: Bench, scene: Facts, method: str, size: Size, png: Path) -> list[Word]:
    """Render to an 8-bit PNG, the smallest output that kage has. To write it is not part of the time."""
    options = (*programs.method_options(method), *programs.size_options(size))
    return [bench.kage, "render", scene.file, *options, "-o", png, "--threads", "1", "--stats", "--quiet"]


def shown(bench: Bench, scene: Facts, method: str) -> str:
    return programs.shown(command(bench, scene, method, bench.level.cost_size, Path(f"{scene.name}.png")))


def with_png(work: Callable[[Path], Value]) -> Value:
    """Do the work with the path of a picture that is soon deleted."""
    with tempfile.TemporaryDirectory() as folder:
        return work(Path(folder) / "a.png")


def time_kage(bench: Bench, scene: Facts, method: str) -> Value:
    def work(png: Path) -> Value:
        text = programs.run(command(bench, scene, method, bench.level.cost_size, png))
        return {"ns": programs.parse_kage(text), "counts": programs.parse_counts(text)}

    return with_png(work)


def count_kage(bench: Bench, scene: Facts, method: str) -> Value:
    size = bench.level.count_size

    def work(png: Path) -> Value:
        count = programs.count_instructions(command(bench, scene, method, size, png))
        return {"instructions": count / (size[0] * size[1])}

    return with_png(work)


def weigh_kage(bench: Bench, scene: Facts, method: str) -> Value:
    size = bench.level.cost_size
    return with_png(lambda png: peak_memory(command(bench, scene, method, size, png)))


def peak_memory(words: Sequence[Word]) -> Value:
    return {"memory": programs.peak_memory(words)}


# Other programs -----------------------------------------------------------------------------------


def time_povray(scene: Path, size: Size) -> Value:
    times = programs.parse_povray(programs.run(programs.povray_command(scene, size)))
    return {"ns": times["trace"] * 1e9 / (size[0] * size[1]), "build_s": times["parse"]}


def export(bench: Bench, scene: Facts, size: Size, displaced: bool, path: Path) -> Value:
    path.parent.mkdir(parents=True, exist_ok=True)
    surface = "displaced" if displaced else "smooth"
    size_options = programs.size_options(size)
    words = programs.run([bench.kage, "pov", scene.file, "--surface", surface, *size_options, "-o", path])
    if "coarse mesh" in words:
        path.unlink()
        raise MeasureError(f"{scene.name}: POV-Ray would show another surface: {words.strip()}")
    return {}


def time_fused(program: Path) -> Value:
    return {"orders": programs.parse_fused(programs.run([program, "1"]))}


def time_embree(program: Path, grid: int) -> Value:
    return dict(programs.parse_embree(programs.run([program, str(grid)])))


# Jobs ---------------------------------------------------------------------------------------------


def machine_inputs(**more: object) -> Inputs:
    return {"processor": programs.processor(), **more}


def kage_inputs(bench: Bench, scene: Facts, size: Size, **more: object) -> Inputs:
    return {"kage": bench.kage_digest, "scene": scene.digest, "size": list(size), **more}


def kage_round(bench: Bench, number: int) -> list[Job]:
    methods = bench.level.timed if number % 2 == 0 else bench.level.timed[::-1]
    return [
        Job(f"time {scene.name} {method} {number}",
            machine_inputs(**kage_inputs(bench, scene, bench.level.cost_size, method=method)),
            functools.partial(time_kage, bench, scene, method), Stage.TIMES, 0.4)
        for scene in bench.scenes.values() for method in methods
    ]


def kage_once(bench: Bench) -> list[Job]:
    """What has little or no noise: instructions and memory."""
    level = bench.level
    names = level.count_scenes if shutil.which("valgrind") else ()
    counted = [scene for scene in bench.scenes.values() if scene.name in names]
    return [
        Job(f"count {scene.name} {method}", kage_inputs(bench, scene, level.count_size, method=method),
            functools.partial(count_kage, bench, scene, method), Stage.MEASURES, 4)
        for scene in counted for method in level.timed
    ] + [
        Job(f"memory {scene.name} {method}", kage_inputs(bench, scene, level.cost_size, method=method),
            functools.partial(weigh_kage, bench, scene, method), Stage.MEASURES, 0.4)
        for scene in bench.scenes.values() for method in level.timed
    ]


PovScene = tuple[str, str, Path, Job | None]  # name, scene, file, and the job that makes that file


def povray_scenes(bench: Bench) -> list[PovScene]:
    found: list[PovScene] = [
        (f"{POVRAY}, {name}", "cube", TOP / "bench" / f"{file}.pov", None)
        for name, file in POV_SCENES.items() if "cube" in bench.scenes
    ]
    for scene in bench.scenes.values():
        kinds = {"smooth, no bumps": (bench.level.povray_size, False)}
        kind = DISPLACED.get(scene.name)
        if kind == "isosurface":
            kinds[kind] = (bench.level.povray_size, True)
        elif kind and bench.level.mesh_size:
            kinds[f"{kind} of the bumps"] = (bench.level.mesh_size, True)
        for name, (size, displaced) in kinds.items():
            path = bench.out / "povray" / f"{scene.name}-{name.split(',')[0].replace(' ', '-')}-{size[0]}.pov"
            job = Job(f"export {path.stem}", kage_inputs(bench, scene, size, displaced=displaced),
                      functools.partial(export, bench, scene, size, displaced, path), Stage.TRUTHS, 1, (path,))
            found.append((f"{POVRAY}, {name}", scene.name, path, job))
    return found


def povray_job(bench: Bench, version: str, scene: PovScene, name: str, work: Callable[[Path, Size], Value]) -> Job:
    kind, _, path, made = scene
    size = bench.level.povray_size
    file = programs.file_digest(path) if made is None else [made.inputs, path.name]
    return Job(name, machine_inputs(povray=version, size=list(size), file=file), functools.partial(work, path, size),
               Stage.TIMES, 6 if "mesh2" in kind else 1)


def povray_round(bench: Bench, number: int, version: str, scenes: Sequence[PovScene]) -> list[Job]:
    return [povray_job(bench, version, scene, f"time {scene[1]} {scene[0]} {number}", time_povray) for scene in scenes]


def weigh_povray(scene: Path, size: Size) -> Value:
    return peak_memory(programs.povray_command(scene, size))


def povray_memory(bench: Bench, version: str, scenes: Sequence[PovScene]) -> list[Job]:
    return [povray_job(bench, version, scene, f"memory {scene[1]} {scene[0]}", weigh_povray) for scene in scenes]


EMBREE = {"Embree 3, smooth": 1, "Embree 3, displaced mesh of 1024 x 1024": 1024}
FUSED = "fused loop for this scene"


def limits(bench: Bench) -> tuple[dict[str, Path], list[str]]:
    """The yardsticks that build here, and why others do not. They need gcc, x86-64 and Embree 3."""
    built: dict[str, Path] = {}
    faults: list[str] = []
    for name in ("fused_kernel", "embree_loop"):
        try:
            built[name] = programs.build_limit(name, bench.out / "limits")
        except MeasureError as error:
            faults.append(f"the yardstick bench/limits/{name}.c does not build here: {error}")
    return built, faults


def limits_round(number: int, built: dict[str, Path]) -> list[Job]:
    """At 1920 x 1080, the best of several repeats, at every level."""
    found: list[Job] = []
    for program, path in built.items():
        inputs = machine_inputs(source=programs.file_digest(programs.LIMITS / f"{program}.c"))
        if program == "fused_kernel":
            work = functools.partial(time_fused, path)
            found.append(Job(f"time cube {FUSED} {number}", inputs, work, Stage.TIMES, 2))
        else:
            found += [Job(f"time cube {name} {number}", inputs | {"grid": grid},
                          functools.partial(time_embree, path, grid), Stage.TIMES, 3) for name, grid in EMBREE.items()]
    return found


def limits_memory(built: dict[str, Path]) -> list[Job]:
    if "embree_loop" not in built:
        return []
    inputs = machine_inputs(source=programs.file_digest(programs.LIMITS / "embree_loop.c"))
    path = built["embree_loop"]
    return [Job(f"memory cube {name}", inputs | {"grid": grid}, functools.partial(peak_memory, [path, str(grid)]),
                Stage.TIMES, 3)
            for name, grid in EMBREE.items()]
