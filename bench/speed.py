"""How fast kage is beside POV-Ray, and what each order costs: figure 5's scene, one thread, one run.

Each round measures everything once, so that what the machine does beside hits all alike:

    kage        scenes/cube.yaml by each method; the render without reading the scene and writing the picture, from
                `kage render --stats`. A round makes several sweeps over the methods, up and down in turn.
    POV-Ray     bench/cube_bump_map.pov, the same scene with a bump_map: its own 'Trace Time'
    yardsticks  bench/limits/*.c: a hand-fused loop for just this scene, and Embree 3, smooth and displaced. They print
                their best of several repeats, at 1920x1080 whatever --size says; kage and POV-Ray run once, cold.

Two claims are checked: that kage is at least 40 times as fast as POV-Ray by none and by order 0 (the median of the
rounds' ratios), and that order 0 costs at most 8 % over none (the median of the sweeps' differences). Instructions are
counted by valgrind in the function `render` of kage, in a picture of 480x270: noise can't touch them, but one
instruction is not as slow as another, so they stand beside the claim and do not decide it.

status: 0 both claims hold, 1 one fails, 2 wrong usage, or a program fails,
        3 what was measured holds, but POV-Ray is missing or was left out
"""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

TOP = Path(__file__).resolve().parent.parent
SCENE = TOP / "scenes" / "cube.yaml"
POV_SCENE = Path("bench") / "cube_bump_map.pov"  # from TOP, where the names in it start
LIMITS = TOP / "bench" / "limits"
BUILD = TOP / "build" / "bench"

METHODS = ("none", "0", "1", "2", "2+", "iter:4", "march:4")
POVRAY = "POV-Ray bump_map"
CLAIM_SPEED = 40.0  # times as fast as POV-Ray
CLAIM_ORDER0 = 8.0  # % over none
COUNT_SIZE = (480, 270)

Size = tuple[int, int]
Peer = Callable[[], dict[str, float]]  # measures something beside kage, once a round: ns a pixel by name


class MeasureError(Exception):
    """Something could not be measured; the message says what and why."""


# Reading what the programs print ------------------------------------------------------------------


def parse_kage(text: str) -> dict[str, float]:
    """ns a sample of the whole `render` and of each stage, from `kage render --stats`."""
    found = re.findall(r"^ *(\w+) .*?([0-9.]+) ns a (?:sample|pixel)", text, re.MULTILINE)
    times = {name: float(value) for name, value in found}
    if times.get("render", 0) <= 0:
        raise MeasureError(f"kage --stats: no time of the render in {text[:200]!r}")
    return times


def parse_povray(text: str) -> float:
    """Seconds of POV-Ray's trace. Its first lines name a certain Aaron too: only the statistics have the brackets."""
    found = re.search(r"Trace Time:.*\(([0-9.]+) seconds\)", text)
    if not found:
        raise MeasureError(f"POV-Ray: no 'Trace Time' in the end of its output: {text[-300:]!r}")
    return float(found[1])


def parse_fused(text: str) -> dict[str, float]:
    """ns a pixel of each order of the hand-fused loop; it calls none -1."""
    found = re.findall(r"^order +(-?\d+) .*?([0-9.]+) ns/pixel", text, re.MULTILINE)
    if not found:
        raise MeasureError(f"fused_kernel: no 'ns/pixel' in {text[:200]!r}")
    return {f"fused loop {'none' if order == '-1' else order}": float(ns) for order, ns in found}


def parse_embree(text: str) -> float:
    """ns a pixel of the loop over Embree."""
    found = re.search(r"([0-9.]+) ns/pixel", text)
    if not found:
        raise MeasureError(f"embree_loop: no 'ns/pixel' in {text[:200]!r}")
    return float(found[1])


def parse_callgrind(text: str) -> int:
    """The number of instructions that callgrind collected."""
    found = re.search(r"Collected *: *(\d+)", text)
    if not found or int(found[1]) == 0:
        raise MeasureError("callgrind collected nothing: has kage still a function `render`, and its symbols?")
    return int(found[1])


def compile_line(source: str) -> list[str]:
    """The compile command in a C source's opening comment: from `gcc` to `&&`, with continued lines joined."""
    comment = re.sub(r"\\\n \* *", " ", source)
    found = re.search(r"^ \* +(gcc .*?)(?:&&.*)?$", comment, re.MULTILINE)
    if not found:
        raise MeasureError("no compile line in the comments of the source")
    return shlex.split(found[1])


# Statistics ---------------------------------------------------------------------------------------


@dataclass
class Spread:
    """Where the values lie; the quartiles say more than the ends on a busy machine. `sure` holds the median of many
    more such values in 95 of 100 cases, whatever their distribution."""

    median: float
    low: float
    high: float
    quartiles: tuple[float, float]
    sure: tuple[float, float]


def spread(values: Iterable[float]) -> Spread:
    v = np.sort(np.array(list(values), dtype=float))
    q1, q2, q3 = (float(x) for x in np.percentile(v, (25, 50, 75)))
    cut = max(int((len(v) - 1.96 * math.sqrt(len(v))) / 2), 0)  # a median's rank, as in tossing a coin len(v) times
    return Spread(q2, float(v[0]), float(v[-1]), (q1, q3), (float(v[cut]), float(v[-1 - cut])))


@dataclass
class Samples:
    """ns a pixel by name: a list for each round, in it a value for each sweep. And the stages of kage, the same way."""

    ns: dict[str, list[list[float]]] = field(default_factory=dict)
    stages: dict[str, dict[str, list[float]]] = field(default_factory=dict)

    def add(self, number: int, name: str, value: float) -> None:
        rounds = self.ns.setdefault(name, [])
        if len(rounds) == number:
            rounds.append([])
        rounds[number].append(value)

    def add_stages(self, method: str, times: dict[str, float]) -> None:
        for stage, value in times.items():
            self.stages.setdefault(method, {}).setdefault(stage, []).append(value)

    def all(self, name: str) -> list[float]:
        return [value for values in self.ns[name] for value in values]

    def rounds(self, name: str) -> list[float]:
        """The median of each round."""
        return [float(np.median(values)) for values in self.ns[name]]


def times_as_fast(samples: Samples, name: str, other: str) -> Spread:
    """How many times as fast `name` is as `other`: the ratio of each round."""
    return spread(b / a for a, b in zip(samples.rounds(name), samples.rounds(other), strict=True))


def added_cost(samples: Samples, name: str, base: str) -> Spread:
    """% that `name` costs over `base`: the difference in each sweep."""
    return spread(100 * (a / b - 1) for a, b in zip(samples.all(name), samples.all(base), strict=True))


# Running ------------------------------------------------------------------------------------------


def run(command: Sequence[str | Path], cwd: Path = TOP) -> str:
    """What the command prints, on both streams."""
    shown = shlex.join(map(str, command))
    env = os.environ | {"LC_ALL": "C"}
    try:
        done = subprocess.run(command, cwd=cwd, env=env, capture_output=True, text=True, errors="replace", check=False)
    except OSError as error:
        raise MeasureError(f"{shown}: {error.strerror}") from error
    if done.returncode:
        raise MeasureError(f"{shown}: status {done.returncode}\n{(done.stdout + done.stderr)[-1000:].strip()}")
    return done.stdout + done.stderr


def render_command(kage: Path, method: str, size: Size, folder: Path) -> list[str | Path]:
    """An 8-bit PNG is the smallest output that kage has, and is not part of the time."""
    what = ["--shadow", method, "--size", f"{size[0]}x{size[1]}", "-o", folder / "cube.png"]
    return [kage, "render", SCENE, *what, "--threads", "1", "--stats", "--quiet"]


def time_kage(kage: Path, method: str, size: Size, folder: Path) -> dict[str, float]:
    return parse_kage(run(render_command(kage, method, size, folder)))


def time_povray(povray: str, size: Size) -> float:
    """ns a pixel. No file, no display, no antialiasing, one thread; -V for no count of pixels on the way."""
    command = [povray, f"+I{POV_SCENE}", f"+W{size[0]}", f"+H{size[1]}", "+WT1", "-A", "-D", "-F", "-P", "-V"]
    return parse_povray(run(command)) * 1e9 / (size[0] * size[1])


def count_instructions(kage: Path, method: str, folder: Path) -> int:
    callgrind = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder / 'callgrind'}"]
    command = render_command(kage, method, COUNT_SIZE, folder)
    return parse_callgrind(run([*callgrind, "--toggle-collect=render", *command]))


def build_limit(name: str) -> Path:
    """Compile a yardstick by the line in its comment."""
    source, program = LIMITS / f"{name}.c", BUILD / name
    BUILD.mkdir(parents=True, exist_ok=True)
    places: dict[str, str | Path] = {f"{name}.c": source, name: program}
    run([places.get(word, word) for word in compile_line(source.read_text())])
    return program


def has_embree() -> bool:
    try:
        run(["gcc", "-E", "-include", "embree3/rtcore.h", "-x", "c", os.devnull, "-o", os.devnull])
    except MeasureError:
        return False
    return True


def fused_peers() -> list[Peer]:
    program = build_limit("fused_kernel")
    return [lambda: parse_fused(run([program, "1"]))]


def embree_peers() -> list[Peer]:
    if not has_embree():
        print("Embree: left out, the headers of version 3 are not here (Debian: libembree-dev)")
        return []
    program = build_limit("embree_loop")
    return [lambda: {"Embree, smooth": parse_embree(run([program, "1"]))},
            lambda: {"Embree, 1024^2 mesh": parse_embree(run([program, "1024"]))}]


def limit_peers() -> list[Peer]:
    """The yardsticks that build here; they are written for gcc and x86-64."""
    peers: list[Peer] = []
    for build in (fused_peers, embree_peers):
        try:
            peers += build()
        except MeasureError as error:
            print(f"a yardstick is left out, it does not build here: {str(error).splitlines()[0]}")
    return peers


def povray_peers(size: Size) -> list[Peer]:
    povray = shutil.which("povray")
    if not povray:
        print("POV-Ray: left out, there is no povray here (Debian: povray)")
        return []
    return [lambda: {POVRAY: time_povray(povray, size)}]


def measure_round(samples: Samples, number: int, options: argparse.Namespace, peers: list[Peer], folder: Path) -> None:
    for sweep in range(options.sweeps):
        for method in METHODS if sweep % 2 == 0 else METHODS[::-1]:
            times = time_kage(options.kage, method, options.size, folder)
            samples.add_stages(method, times)
            samples.add(number, f"kage {method}", times["render"])
    for peer in peers:
        for name, ns in peer().items():
            samples.add(number, name, ns)


def measure(options: argparse.Namespace, peers: list[Peer], folder: Path) -> Samples:
    samples = Samples()
    for number in range(options.rounds):
        if sys.stderr.isatty():
            print(f"\rround {number + 1} of {options.rounds} ", end="", file=sys.stderr, flush=True)
        measure_round(samples, number, options, peers, folder)
    if sys.stderr.isatty():
        print("\r\033[K", end="", file=sys.stderr)
    return samples


def measure_instructions(kage: Path, folder: Path) -> dict[str, float]:
    """Instructions a pixel by method; nothing without valgrind."""
    if not shutil.which("valgrind"):
        print("instructions: left out, there is no valgrind here (Debian: valgrind)")
        return {}
    pixels = COUNT_SIZE[0] * COUNT_SIZE[1]
    return {method: count_instructions(kage, method, folder) / pixels for method in METHODS}


# Printing -----------------------------------------------------------------------------------------


def print_times(samples: Samples) -> None:
    print(f"\n{'ns a pixel':20s}{'median':>9s}{'min':>9s}{'max':>9s}"
          f"{'x POV-Ray':>11s}{'over none':>11s}{'quartiles':>16s}")
    for name in samples.ns:
        s = spread(samples.all(name))
        line = f"{name:20s}{s.median:9.2f}{s.low:9.2f}{s.high:9.2f}"
        speed = f"{times_as_fast(samples, name, POVRAY).median:.1f}" if POVRAY in samples.ns else "-"
        line += f"{speed:>11s}"
        if name.startswith("kage ") and name != "kage none":
            c = added_cost(samples, name, "kage none")
            line += f"{c.median:+9.1f} %{c.quartiles[0]:+8.1f} to {c.quartiles[1]:+.1f}"
        print(line)


def print_stages(samples: Samples) -> None:
    print(f"\n{'stages, ns a pixel':20s}" + "".join(f"{method:>9s}" for method in METHODS))
    for stage in samples.stages["none"]:
        medians = (float(np.median(samples.stages[method].get(stage, [0]))) for method in METHODS)
        print(f"{stage:20s}" + "".join(f"{value:9.2f}" for value in medians))


def print_instructions(counts: dict[str, float]) -> None:
    width, height = COUNT_SIZE
    print(f"\ninstructions a pixel in the render at {width}x{height}, by valgrind")
    for method, count in counts.items():
        over = "" if method == "none" else f"{100 * (count / counts['none'] - 1):+9.1f} %"
        print(f"{'kage ' + method:20s}{count:9.1f}{over}")


def verdict(good: bool) -> str:
    return "PASS" if good else "FAIL"


def check_claims(samples: Samples, counts: dict[str, float]) -> int:
    """Print a line for each claim; the status."""
    print()
    failed = 0
    for method in ("none", "0"):
        claim = f"kage {method} at least {CLAIM_SPEED:g} times as fast as POV-Ray"
        if POVRAY not in samples.ns:
            print(f"----  {claim}: not measured")
            continue
        s = times_as_fast(samples, f"kage {method}", POVRAY)
        good = s.median >= CLAIM_SPEED
        failed += not good
        print(f"{verdict(good)}  {claim}: {s.median:.1f} (95 % sure: {s.sure[0]:.1f} to {s.sure[1]:.1f})")
    c = added_cost(samples, "kage 0", "kage none")
    good = c.median <= CLAIM_ORDER0
    failed += not good
    counted = f"; instructions {100 * (counts['0'] / counts['none'] - 1):+.1f} %" if counts else ""
    print(f"{verdict(good)}  order 0 costs at most {CLAIM_ORDER0:g} % over none: {c.median:+.1f} % "
          f"(95 % sure: {c.sure[0]:+.1f} to {c.sure[1]:+.1f}){counted}")
    return 1 if failed else 0 if POVRAY in samples.ns else 3


def version(command: Sequence[str | Path], pattern: str = r".+") -> str:
    """The first match in what a command prints; nothing where it fails."""
    try:
        found = re.search(pattern, run(command))
    except MeasureError:
        return ""
    return found[0] if found else ""


def circumstances(options: argparse.Namespace) -> dict[str, object]:
    """What the numbers depend on."""
    info = Path("/proc/cpuinfo")
    model = re.search(r"model name\s*: (.*)", info.read_text()) if info.exists() else None
    return {
        "kage": version([options.kage, "--version"]),
        "commit": version(["git", "describe", "--always", "--dirty"]),
        "compiler": version(["gcc", "--version"]),
        "povray": version(["povray", "--version"], r"POV-Ray \d\S*"),
        "processor": model[1] if model else platform.processor(),
        "processors": os.cpu_count(),
        "load": os.getloadavg(),
        "size": options.size,
        "rounds": options.rounds,
        "sweeps": options.sweeps,
    }


def write_json(path: Path, about: dict[str, object], samples: Samples, counts: dict[str, float]) -> None:
    content = {"about": about, "ns_per_pixel": samples.ns, "stages_ns_per_pixel": samples.stages,
               "instructions_per_pixel": counts}
    path.write_text(json.dumps(content, indent=1) + "\n")


# The command line ---------------------------------------------------------------------------------


def parse_size(text: str) -> Size:
    found = re.fullmatch(r"([1-9]\d{0,4})x([1-9]\d{0,4})", text)
    if not found:
        raise argparse.ArgumentTypeError(f"'{text}' is no size, expected WIDTHxHEIGHT in pixels, as in 1920x1080")
    return int(found[1]), int(found[2])


def parse_count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"'{text}' is no number of times, expected 1 or more")
    return int(text)


def parse_arguments(arguments: Sequence[str] | None) -> argparse.Namespace:
    about, _, status = (__doc__ or "").partition("\nstatus:")
    parser = argparse.ArgumentParser(
        prog="speed.py", description=about, epilog="status:" + status,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=parse_count, default=7, metavar="N", help="rounds over everything (7)")
    parser.add_argument("--sweeps", type=parse_count, default=6, metavar="N",
                        help="sweeps over kage's methods in a round (6)")
    parser.add_argument("--size", type=parse_size, default=(1920, 1080), metavar="WxH",
                        help="of the picture (1920x1080, which the claims are about)")
    parser.add_argument("--instructions", action="store_true", help="count instructions too, with valgrind")
    parser.add_argument("--without", action="append", choices=("povray", "limits"), default=[],
                        help="leave out POV-Ray or the yardsticks; may be given twice")
    parser.add_argument("--kage", type=Path, default=TOP / "build" / "float" / "kage", metavar="FILE",
                        help="the program to measure (the project's build/float/kage, by `make build/float/kage`)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all raw numbers there")
    options = parser.parse_args(arguments)
    options.kage = options.kage.resolve()
    if not os.access(options.kage, os.X_OK):
        parser.error(f"{options.kage} is not there, or no program: `make build/float/kage` makes it")
    return options


def bench(options: argparse.Namespace) -> int:
    about = circumstances(options)
    width, height = options.size
    print(f"{about['kage']} ({about['commit']}), {about['processor']}\n"
          f"{width}x{height}, one thread, {options.rounds} rounds of {options.sweeps} sweeps")
    peers = [] if "povray" in options.without else povray_peers(options.size)
    peers += [] if "limits" in options.without else limit_peers()
    with tempfile.TemporaryDirectory() as folder:
        samples = measure(options, peers, Path(folder))
        counts = measure_instructions(options.kage, Path(folder)) if options.instructions else {}
    print_times(samples)
    print_stages(samples)
    if counts:
        print_instructions(counts)
    if options.json:
        write_json(options.json, about, samples, counts)
    return check_claims(samples, counts)


def main(arguments: Sequence[str] | None = None) -> int:
    options = parse_arguments(arguments)
    try:
        return bench(options)
    except (MeasureError, OSError) as error:
        print(f"speed.py: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
