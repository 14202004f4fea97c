"""Runs the programs that are measured, and reads what they print."""

from __future__ import annotations

import contextlib
import hashlib
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TypedDict

TOP = Path(__file__).resolve().parent.parent
LIMITS = TOP / "bench" / "limits"
KAGE = TOP / "build" / "float" / "kage"

Size = tuple[int, int]
Options = tuple[str, ...]
Word = str | Path


class MeasureError(Exception):
    """What could not be measured, and why."""


# Running ------------------------------------------------------------------------------------------


def shown(command: Sequence[Word]) -> str:
    """A command as a line for a shell in the project's top."""
    return shlex.join(str(word).removeprefix(f"{TOP}/") for word in command)


def run(command: Sequence[Word], environment: Mapping[str, str] = os.environ) -> str:
    """What the command prints, on both streams."""
    env = {**environment, "LC_ALL": "C"}
    try:
        done = subprocess.run(command, cwd=TOP, env=env, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace", check=False)
    except OSError as error:
        raise MeasureError(f"{shown(command)}: {error.strerror}") from error
    if done.returncode:
        last = done.stdout.strip().splitlines()[-1:]
        raise MeasureError(f"{shown(command)}: status {done.returncode}{': ' if last else ''}{''.join(last)}")
    return done.stdout


# A process starts with the peak memory of the process that starts it. This one is smaller than all that are measured.
LAUNCHER = "import os, sys; _, s, u = os.wait4(os.spawnvp(os.P_NOWAIT, sys.argv[1], sys.argv[1:]), 0); " \
           "print('peak', u.ru_maxrss, 'kB'); sys.exit(os.waitstatus_to_exitcode(s))"


def peak_memory(command: Sequence[Word]) -> int:
    """The highest memory in bytes. Not below the 10 MB of the Python that starts the command."""
    found = re.search(r"^peak (\d+) kB$", run([sys.executable, "-I", "-S", "-c", LAUNCHER, *command]), re.MULTILINE)
    if not found:
        raise MeasureError(f"{shown(command)}: no line 'peak' with its memory")
    return int(found[1]) * (1 if sys.platform == "darwin" else 1024)


@contextlib.contextmanager
def pinned() -> Iterator[None]:
    """Programs that are started inside run on one processor, the last, if the system can do that."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def version(command: Sequence[Word], pattern: str = r".+") -> str:
    """The first match in what a command prints; empty where it fails."""
    try:
        found = re.search(pattern, run(command))
    except MeasureError:
        return ""
    return found[0] if found else ""


def commit() -> str:
    """The commit that is checked out, with -dirty where files differ from it; empty outside of git."""
    return version(["git", "describe", "--always", "--dirty"])


def file_digest(*paths: Path) -> str:
    sha = hashlib.sha256()
    for path in paths:
        sha.update(path.read_bytes())
    return sha.hexdigest()[:16]


def processor() -> str:
    info = Path("/proc/cpuinfo")
    model = re.search(r"model name\s*: (.*)", info.read_text()) if info.exists() else None
    return f"{model[1] if model else platform.processor() or platform.machine()}, {os.cpu_count()} processors"


# kage ---------------------------------------------------------------------------------------------


VARIANT = re.compile(r"(?P<shadow>\S+?)(?P<bare> bare)?(?P<shifted> shifted)?(, own (?P<own>\S+))?")


def method_options(method: str) -> Options:
    """kage's options for a method or a variant by its name in the bench.

    `2 bare` is order 2 without the guard. `march:8 shifted, own 24` is the method march:8, shaded at the shifted place,
    with 24 steps for the bumps' own shadows. `relief` is kage's preset, and `displaced` the displaced surface.
    """
    if method in ("displaced", "relief"):
        return ("--surface", "displaced") if method == "displaced" else ("--relief",)
    found = VARIANT.fullmatch(method)
    if not found:
        raise ValueError(f"'{method}' is no method, expected METHOD[ bare][ shifted][, own STEPS|horizon|exact]")
    own = found["own"]
    return ("--shadow", found["shadow"], *(["--no-guard"] if found["bare"] else []),
            *(["--shade", "shifted"] if found["shifted"] else []),
            *(["--bump-shadow", f"march:{own}" if own.isdecimal() else own] if own else []))


def size_options(size: Size) -> Options:
    return ("--size", f"{size[0]}x{size[1]}")


def set_options(sets: dict[str, object]) -> Options:
    return tuple(word for path, value in sets.items() for word in ("--set", f"{path}={value}"))


def parse_kage(text: str) -> dict[str, float]:
    """From `kage render --stats`: ns a sample of the whole `render` and of each stage."""
    found = re.findall(r"^ *(\w+) .*?([0-9.]+) ns a (?:sample|pixel)", text, re.MULTILINE)
    times = {name: float(value) for name, value in found}
    if times.get("render", 0) <= 0:
        raise MeasureError(f"kage --stats: no time of the render in {text[:200]!r}")
    return times


def parse_counts(text: str) -> dict[str, int]:
    """From `kage render --stats`: its counts of rays, shadow_rays, lookups, bumped and fell_back."""
    rays = re.search(r"^camera rays (\d+), shadow rays (\d+), height look-ups (\d+)$", text, re.MULTILINE)
    bumped = re.search(r"^bumped samples (\d+) by .*?, fell back (\d+)", text, re.MULTILINE)
    if not rays or not bumped:
        raise MeasureError(f"kage --stats: no counts in {text[-300:]!r}")
    names = ("rays", "shadow_rays", "lookups", "bumped", "fell_back")
    return {name: int(value) for name, value in zip(names, rays.groups() + bumped.groups(), strict=True)}


class Checked(TypedDict):
    """A scene's light and bumped object."""

    light: str
    at: tuple[float, float, float]
    receiver: str
    casters: tuple[str, ...]  # all other objects
    slope_median: float
    slope_95: float


def parse_check(text: str) -> Checked:
    """From `kage check`: the scene's one light, its one bumped object, and the slopes of that."""
    lights = re.findall(r"^light (\S+) at (.*)$", text, re.MULTILINE)
    bumped = re.findall(r"^object (\S+): .*, bump by", text, re.MULTILINE)
    slopes = re.findall(r"^ +slope +median ([0-9.e-]+), 95 % below ([0-9.e-]+)", text, re.MULTILINE)
    if not len(lights) == len(bumped) == len(slopes) == 1:
        raise MeasureError(f"the scene has {len(lights)} lights and {len(bumped)} bumped objects; the bench needs one "
                           "of each")
    (light, at), (median, most) = lights[0], slopes[0]
    x, y, z = (float(word) for word in at.split(","))
    objects = re.findall(r"^object (\S+): ", text, re.MULTILINE)
    return {"light": light, "at": (x, y, z), "receiver": bumped[0],
            "casters": tuple(name for name in objects if name != bumped[0]), "slope_median": float(median),
            "slope_95": float(most)}


def parse_callgrind(text: str) -> int:
    """The number of instructions that callgrind collected."""
    found = re.search(r"Collected *: *(\d+)", text)
    if not found or int(found[1]) == 0:
        raise MeasureError(f"callgrind collected nothing: kage must have symbols, and a function `{COUNTED}`")
    return int(found[1])


COUNTED = "render"  # the function of kage whose instructions are counted

# All that callgrind sees of the environment: the stack begins below the environment's text, and memset takes some
# instructions more or fewer by the place of an array.
COUNTED_WITH = ("PATH", "LD_LIBRARY_PATH", "VALGRIND_LIB")


def count_instructions(command: Sequence[Word]) -> int:
    """Of kage's function COUNTED and all that it calls."""
    environment = {name: os.environ[name] for name in COUNTED_WITH if name in os.environ}
    with tempfile.TemporaryDirectory() as folder:
        callgrind = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/callgrind",
                     f"--toggle-collect={COUNTED}"]
        return parse_callgrind(run([*callgrind, *command], environment))


# POV-Ray ------------------------------------------------------------------------------------------


def povray_command(scene: Path, size: Size) -> list[Word]:
    """No file, no display, no antialiasing, one thread, and no progress messages (-V)."""
    return ["povray", f"+I{str(scene).removeprefix(f'{TOP}/')}", f"+W{size[0]}", f"+H{size[1]}", "+WT1", "-A", "-D",
            "-F", "-P", "-V"]


def parse_povray(text: str) -> dict[str, float]:
    """Seconds of POV-Ray's parsing and of its trace. Only its statistics have the time in brackets."""
    times = {}
    for name in ("Parse", "Trace"):
        found = re.search(rf"{name} Time:.*\(([0-9.]+) seconds\)", text)
        if not found:
            raise MeasureError(f"POV-Ray: no '{name} Time' in the end of its output: {text[-300:]!r}")
        times[name.lower()] = float(found[1])
    if not times["trace"]:
        raise MeasureError("POV-Ray: its trace took less than a millisecond, expected a picture that takes longer")
    return times


def has_povray() -> bool:
    return shutil.which("povray") is not None


# The yardsticks -----------------------------------------------------------------------------------


def parse_fused(text: str) -> dict[str, float]:
    """From fused_kernel: ns a pixel of each order of the hand-fused loop. It calls none -1."""
    found = re.findall(r"^order +(-?\d+) .*?([0-9.]+) ns/pixel", text, re.MULTILINE)
    if not found:
        raise MeasureError(f"fused_kernel: no 'ns/pixel' in {text[:200]!r}")
    return {"none" if order == "-1" else order: float(ns) for order, ns in found}


def parse_embree(text: str) -> dict[str, float]:
    """From embree_loop: ns a pixel of the loop over Embree, and the seconds of its build."""
    ns, build = re.search(r"([0-9.]+) ns/pixel", text), re.search(r"build ([0-9.]+) ms", text)
    if not ns or not build:
        raise MeasureError(f"embree_loop: no 'ns/pixel' or no 'build' in {text[:200]!r}")
    return {"ns": float(ns[1]), "build_s": float(build[1]) / 1e3}


def compile_line(source: str) -> list[str]:
    """The compile command in a C source's opening comment: from `gcc` to `&&`, with continued lines joined."""
    comment = re.sub(r"\\\n \* *", " ", source)
    found = re.search(r"^ \* +(gcc .*?)(?:&&.*)?$", comment, re.MULTILINE)
    if not found:
        raise MeasureError("no compile line in the comments of the source")
    return shlex.split(found[1])


def build_limit(name: str, folder: Path) -> Path:
    """Compile a yardstick by the line in its comment."""
    source, program = LIMITS / f"{name}.c", folder / name
    folder.mkdir(parents=True, exist_ok=True)
    places: dict[str, Word] = {f"{name}.c": source, name: program}
    run([places.get(word, word) for word in compile_line(source.read_text())])
    return program
