"""Render many pictures of a scene on many processors or machines, by dask.distributed.

  --vary PATH=FROM:TO:COUNT   COUNT values of a number in the scene, both ends included; ...:log for equal ratios
  --vary PATH=VALUE,VALUE,... a list of values, as the scene file would have them
  --vary frame=0:47:48        frames of an animation, whose keys are in --keys KEYS.yaml

Given again, --vary makes the product. What is in DIR already, whole and of the same inputs, is not rendered again:
after an interruption the same command goes on. DIR/index.html shows the pictures, index.csv and index.json have their
values.

status: 0 all pictures are there, 1 some are not, 2 wrong usage or a wrong scene, 130 interrupted
"""

from __future__ import annotations

import argparse
import functools
import re
import signal
import sys
from collections.abc import Sequence
from pathlib import Path

from tqdm import tqdm

import kage
from kage.sweep.axes import axis
from kage.sweep.errors import SweepError
from kage.sweep.keys import Keys
from kage.sweep.plan import Output, Plan, Task
from kage.sweep.run import Done, cluster, run
from kage.sweep.worker import Result


def parse_arguments(arguments: Sequence[str] | None) -> argparse.Namespace:
    about, _, status = (__doc__ or "").partition("\nstatus:")
    parser = argparse.ArgumentParser(prog="python -m kage.sweep", description=about, epilog="status:" + status,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=Path, metavar="SCENE")
    parser.add_argument("--vary", action="append", default=[], metavar="PATH=VALUES", help="what varies; see above")
    parser.add_argument("--keys", type=Path, metavar="FILE", help="the keys of an animation (docs/sweep.md)")
    parser.add_argument("--set", action="append", default=[], metavar="PATH=VALUE", help="a change of all pictures")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="where the pictures go")
    parser.add_argument("--format", choices=("png", "exr"), default="png", help="of the pictures (png)")
    parser.add_argument("--size", type=size, metavar="WxH", help="of the pictures, in pixels (as the scene says)")
    parser.add_argument("--bits", type=int, choices=(8, 16), help="of a PNG (8)")
    parser.add_argument("--layers", metavar="LIST", help="of an EXR, such as color,tau (all)")
    parser.add_argument("--bands", type=int, default=1, metavar="N", help="render an EXR in N parts, and join them")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="tcp://HOST:PORT of a Dask scheduler (processes here)")
    parser.add_argument("--workers", type=int, metavar="N", help="processes here (one for each processor)")
    parser.add_argument("--threads", type=int, default=1, metavar="N", help="of one render (1)")
    parser.add_argument("--send", action="store_true",
                        help="send the scene's files to the workers, and the pictures back: no folder is shared")
    parser.add_argument("--quiet", action="store_true", help="no progress")
    options = parser.parse_args(arguments)
    for name in ("workers", "threads", "bands"):
        if getattr(options, name) is not None and getattr(options, name) < 1:
            parser.error(f"--{name}: expected 1 or more")
    if options.workers and options.scheduler:
        parser.error("--workers: a scheduler has its own")
    return options


def size(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d{1,5})x(\d{1,5})", text)
    if not found:
        raise argparse.ArgumentTypeError(f"{text!r}, expected WIDTHxHEIGHT in pixels")
    return int(found[1]), int(found[2])


def sets_of(texts: Sequence[str]) -> dict[str, str]:
    found = {}
    for text in texts:
        path, equals, value = text.partition("=")
        if not equals or not path:
            raise SweepError(f"--set {text}: expected PATH=VALUE")
        found[path] = value
    return found


def plan_of(options: argparse.Namespace) -> Plan:
    output = Output(options.out, options.format, options.size, options.bits, options.layers, options.bands)
    keys = Keys.read(options.keys) if options.keys else None
    return Plan.of(options.scene, [axis(text) for text in options.vary], output, sets=sets_of(options.set), keys=keys,
                   send=options.send)


def say(text: str) -> None:
    """Above the bar."""
    tqdm.write(f"kage.sweep: {text}", file=sys.stderr)


def sweep(options: argparse.Namespace) -> Done:
    plan = plan_of(options)
    count = sum(max(1, len(picture.bands)) for picture in plan.pictures)
    unit = "band" if options.bands > 1 else "picture"
    bar = tqdm(total=count, unit=unit, disable=True if options.quiet else None, dynamic_ncols=True, leave=False)

    def note(_task: Task, result: Result) -> None:
        if not bar.disable:
            bar.initial += result.found  # what was there does not count for the time left
            bar.update()

    with bar:
        return run(plan, functools.partial(cluster, options.scheduler, options.workers, say), threads=options.threads,
                   note=note)


def main(arguments: Sequence[str] | None = None) -> int:
    options = parse_arguments(arguments)
    try:
        done = sweep(options)
    except SweepError as error:
        print(error, file=sys.stderr)
        return error.status
    except (kage.KageError, OSError) as error:
        print(error, file=sys.stderr)
        return 2 if isinstance(error, kage.InputError | kage.OptionError) else 1
    except KeyboardInterrupt:
        print("\nkage.sweep: interrupted; the same command goes on from here", file=sys.stderr)
        return 130
    for why in done.failed.values():
        print(f"kage.sweep: {why}", file=sys.stderr)
    if not options.quiet:
        print(f"{done.folder / 'index.html'}: {len(done.records)} pictures, {done.rendered} rendered now, "
              f"{done.found} found")
    return 1 if done.failed else 0


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    sys.exit(main())
