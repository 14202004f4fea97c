"""How good the methods' shadows are: each scene and method against POV-Ray's true displacement, and against kage's own.

    against POV-Ray   wrong pixels of the cast shadow, in % of the shadow, by the masks in reference/ (640x480). A pixel
                      counts where both programs see the receiver there, and where it faces the light: the smooth surface
                      in kage, the rough one in POV-Ray, as turned away there is no cast shadow to be seen. kage shades
                      the smooth hit of the very same viewing ray, so pixels are compared one to one.
    against exact     the same against `--shadow exact`: the true hit in kage's own engine
    tau               |tau - tau of exact| in scene units: the median and the 95th percentile over the receiver
    fell back         share of the receiver where the method fell back to a lower order

and how true that truth is: `kage render --surface displaced` against POV-Ray's pictures in reference/ (320x240), in linear
light, with the bounds that the project demands of itself:

    self              rough surfaces cast shadows: at least 99.5 % of the pixels within 1/255
    cast              only other objects do: at least 99.8 %
    mask              of `cast` (640x480): at most 0.1 % of the shadow's pixels differ

On function data with slopes below 0.35 (the scene waves) fewer and fewer pixels must be wrong from none to 0, 1, 2, 2+.

status: 0 all this holds, 1 something does not, 2 wrong usage, or a program or reference fails
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

TOP = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(TOP / "reference"))

import references  # noqa: E402  (the folder is no package)

Layers = dict[str, np.ndarray]
Options = tuple[str, ...]


def shadow(method: str) -> Options:
    """The options of kage for one of the names below."""
    name, _, bare = method.partition(" ")
    return ("--shadow", name, *(["--no-guard"] if bare else []))


METHODS = ("none", "0", "1", "1 bare", "2", "2 bare", "2+", "iter:2", "iter:4", "march:2", "march:4", "march:8", "exact")
MERIT = ("none", "0", "1", "2", "2+")  # each better than the one before, on
MERIT_SCENE = "waves"
ORDER_CODES = {"none": -1, "0": 0, "1": 1, "2": 2, "2+": 3, "iter": 4, "march": 5, "exact": 6}  # of the layer `order`
DISPLACED: dict[str, Options] = {
    "self": ("--surface", "displaced"),
    "cast": ("--surface", "displaced", "--no-self-shadow"),
}
CLOSE = 1 / 255
LEAST_CLOSE = {"self": 99.5, "cast": 99.8}  # % of the pixels
MOST_DIFFERENT = 0.1  # % of the shadow's pixels


class QualityError(Exception):
    """Something could not be measured; the message says what and why."""


@dataclass(frozen=True)
class Row:
    """What a method is worth on a scene; shares in %, tau in scene units."""

    scene: str
    method: str
    wrong_povray: float
    wrong_exact: float
    tau_median: float
    tau_95: float
    fell_back: float


@dataclass(frozen=True)
class Parity:
    """`--surface displaced` against POV-Ray."""

    scene: str
    self: float  # % of the pixels within 1/255
    cast: float
    mask_differs: int  # pixels
    mask_shadow: int

    @property
    def mask(self) -> float:
        return 100 * self.mask_differs / self.mask_shadow

    def holds(self) -> bool:
        return self.self >= LEAST_CLOSE["self"] and self.cast >= LEAST_CLOSE["cast"] and self.mask <= MOST_DIFFERENT


# Running kage ---------------------------------------------------------------------------------------


def run(command: Sequence[str | Path]) -> str:
    try:
        done = subprocess.run(command, cwd=TOP, capture_output=True, text=True, check=False)
    except OSError as error:
        raise QualityError(f"{command[0]}: {error.strerror}") from error
    if done.returncode:
        raise QualityError(f"{' '.join(map(str, command))}: status {done.returncode}\n{done.stderr[-1000:].strip()}")
    return done.stdout


def render(kage: Path, scene: str, shape: tuple[int, ...], options: Options) -> Layers:
    """All layers, at the size of an array of that shape."""
    size = ("--size", f"{shape[1]}x{shape[0]}")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.exr"
        run([kage, "render", f"scenes/{scene}.yaml", *size, *options, "--threads", "1", "--quiet", "-o", path])
        return references.read_exr(path)


@dataclass(frozen=True)
class Facts:
    """What the measures need to know of a scene; `kage check` tells it."""

    light: str
    at: np.ndarray
    receiver: str


def facts(kage: Path, scene: str) -> Facts:
    text = run([kage, "check", f"scenes/{scene}.yaml"])
    lights = re.findall(r"^light (\S+) at (.*)", text, re.MULTILINE)
    receivers = re.findall(r"^object (\S+): .*, bump by", text, re.MULTILINE)
    if len(lights) != 1 or len(receivers) != 1:
        raise QualityError(f"scenes/{scene}.yaml: masks tell of one light and one bumped object, here are {len(lights)} "
                           f"and {len(receivers)}")
    name, at = lights[0]
    return Facts(name, np.array([float(x) for x in at.split(",")]), receivers[0])


# Measuring ------------------------------------------------------------------------------------------


def percent(part: np.ndarray, whole: np.ndarray) -> float:
    return 100 * int(part.sum()) / int(whole.sum())


def share_close(a: np.ndarray, b: np.ndarray) -> float:
    """% of the pixels with all three colours within 1/255 of each other."""
    return 100 * float((np.abs(a - b) <= CLOSE).all(axis=-1).mean())


def in_shadow(layers: Layers, light: str) -> np.ndarray:
    return layers[f"visibility.{light}"] == 0


def mask_tells(mask: np.ndarray) -> np.ndarray:
    return (mask == references.SHADOW) | (mask == references.LIT)


def smooth_faces_light(layers: Layers, at: np.ndarray) -> np.ndarray:
    """In a picture without bumps, where N is the smooth normal."""
    n, p = (np.stack([layers[f"{v}.{axis}"] for axis in "XYZ"], axis=-1) for v in "NP")
    return ((at - p) * n).sum(axis=-1) > 0


def measure_method(method: str, scene: str, got: Layers, exact: Layers, mask: np.ndarray, facing: np.ndarray,
                   light: str) -> Row:
    """`facing`: where kage sees the receiver, and its smooth surface faces the light."""
    code = ORDER_CODES[re.split("[ :]", method)[0]]
    ours, own_truth, truth = in_shadow(got, light), in_shadow(exact, light), mask == references.SHADOW
    both = facing & mask_tells(mask)
    found = exact["order"] == ORDER_CODES["exact"]  # where the ray meets the rough surface at all
    error = np.abs(got["tau"] - exact["tau"])[found]
    bumped = exact["order"] >= 0
    return Row(scene, method, percent(both & (ours != truth), both & truth),
               percent(facing & (ours != own_truth), facing & own_truth),
               float(np.median(error)), float(np.percentile(error, 95)), percent(bumped & (got["order"] != code), bumped))


def measure_scene(kage: Path, scene: str, pool: ThreadPoolExecutor, methods: Sequence[str]) -> list[Row]:
    mask = references.load(scene).mask
    about = facts(kage, scene)
    flat = pool.submit(render, kage, scene, mask.shape,
                       (*shadow("none"), "--set", f"objects.{about.receiver}.bump.scale=0"))
    wanted = dict.fromkeys((*methods, "exact"))
    pictures = {method: pool.submit(render, kage, scene, mask.shape, shadow(method)) for method in wanted}
    exact = pictures["exact"].result()
    facing = (exact["order"] >= 0) & smooth_faces_light(flat.result(), about.at)
    return [measure_method(method, scene, pictures[method].result(), exact, mask, facing, about.light)
            for method in methods]


def measure_parity(kage: Path, scene: str, pool: ThreadPoolExecutor) -> Parity:
    truth = references.load(scene)
    light = facts(kage, scene).light
    pictures = {kind: pool.submit(render, kage, scene, truth.pictures[kind].shape, options)
                for kind, options in DISPLACED.items()}
    large = pool.submit(render, kage, scene, truth.mask.shape, DISPLACED["cast"]).result()
    close = {kind: share_close(references.stack(picture.result()), truth.pictures[kind])
             for kind, picture in pictures.items()}
    both = mask_tells(truth.mask) & (large["order"] == ORDER_CODES["exact"])
    differs = both & (in_shadow(large, light) != (truth.mask == references.SHADOW))
    return Parity(scene, close["self"], close["cast"], int(differs.sum()), int((truth.mask == references.SHADOW).sum()))


def merit_holds(rows: Iterable[Row]) -> bool:
    """Whether each of MERIT is better than the one before, against either truth."""
    found = {row.method: row for row in rows if row.scene == MERIT_SCENE}
    ranks = [found[method] for method in MERIT]
    return all(a.wrong_povray > b.wrong_povray and a.wrong_exact > b.wrong_exact
               for a, b in zip(ranks, ranks[1:], strict=False))


# Printing -------------------------------------------------------------------------------------------

HEAD = ("scene", "method", "wrong, POV-Ray", "wrong, exact", "tau median", "tau 95 %", "fell back")
PARITY_HEAD = ("displaced", "self", "cast", "mask", "pixels of the mask")


def row_cells(row: Row) -> list[str]:
    return [row.scene, row.method, f"{row.wrong_povray:.2f} %", f"{row.wrong_exact:.2f} %", f"{row.tau_median:.2g}",
            f"{row.tau_95:.2g}", f"{row.fell_back:.2f} %"]


def parity_cells(parity: Parity) -> list[str]:
    return [parity.scene, f"{parity.self:.2f} %", f"{parity.cast:.2f} %", f"{parity.mask:.3f} %",
            f"{parity.mask_differs} of {parity.mask_shadow}"]


def print_table(head: Sequence[str], rows: Sequence[Sequence[str]], markdown: bool) -> None:
    if markdown:
        print("| " + " | ".join(head) + " |")
        print("|---" + "|---:" * (len(head) - 1) + "|")
        for row in rows:
            print("| " + " | ".join(row) + " |")
        return
    widths = [max(len(row[i]) for row in (head, *rows)) for i in range(len(head))]
    for row in (head, *rows):
        first, *others = zip(row, widths, strict=True)
        print("  ".join([first[0].ljust(first[1]), *(cell.rjust(width) for cell, width in others)]))


def print_verdicts(rows: Sequence[Row], parities: Sequence[Parity]) -> int:
    """A line for each claim that was measured; the status."""
    claims = {f"{p.scene}: displaced as POV-Ray's": p.holds() for p in parities}
    if any(row.scene == MERIT_SCENE for row in rows):
        claims[f"{MERIT_SCENE}: wrong pixels {' > '.join(MERIT)}"] = merit_holds(rows)
    for claim, good in claims.items():
        print(f"{'PASS' if good else 'FAIL'}  {claim}")
    return 0 if all(claims.values()) else 1


# The command line -----------------------------------------------------------------------------------


def parse_arguments(arguments: Sequence[str] | None) -> argparse.Namespace:
    about, _, status = (__doc__ or "").partition("\nstatus:")
    parser = argparse.ArgumentParser(prog="quality.py", description=about, epilog="status:" + status,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"{', '.join(references.SCENES)} (all)")
    parser.add_argument("--kage", type=Path, default=TOP / "build" / "float" / "kage", metavar="FILE",
                        help="the program to measure (the project's build/float/kage)")
    parser.add_argument("--markdown", action="store_true", help="print the tables as Markdown")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all numbers there")
    options = parser.parse_args(arguments)
    for name in options.scenes:
        if name not in references.SCENES:
            parser.error(f"'{name}' is none of the scenes {', '.join(references.SCENES)}")
    options.kage = options.kage.resolve()
    if not os.access(options.kage, os.X_OK):
        parser.error(f"{options.kage} is not there, or no program: `make build/float/kage` makes it")
    return options


def bench(options: argparse.Namespace) -> int:
    scenes = options.scenes or references.SCENES
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        rows = [row for scene in scenes for row in measure_scene(options.kage, scene, pool, METHODS)]
        parities = [measure_parity(options.kage, scene, pool) for scene in scenes]
    print_table(HEAD, [row_cells(row) for row in rows], options.markdown)
    print()
    print_table(PARITY_HEAD, [parity_cells(parity) for parity in parities], options.markdown)
    print()
    if options.json:
        content = {"methods": [asdict(row) for row in rows], "displaced": [asdict(p) | {"mask": p.mask} for p in parities]}
        options.json.write_text(json.dumps(content, indent=1) + "\n")
    return print_verdicts(rows, parities)


def main(arguments: Sequence[str] | None = None) -> int:
    options = parse_arguments(arguments)
    try:
        return bench(options)
    except (QualityError, references.ReferenceError, OSError) as error:
        print(f"quality.py: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
