"""What kage demands of its speed, measured beside the peers: one table in one run.

Writes OUT/index.html, report.md and report.json, and prints the bounds. Inputs are made once, in OUT/inputs. With
--write nothing is measured: the bounds of the last report go into docs/performance.md.

status: 0 all is measured, 1 nothing can be, 2 wrong usage, 3 something is missing, 130 interrupted
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path

try:
    from bench import programs
    from bench.programs import KAGE, TOP, MeasureError
    from bench.readme import ReadmeError, write
    from bench.speed import pages, parts, plan, stages, verdicts
    from bench.speed.plan import LEVELS, PARTS, About, Bound
    from bench.speed.rounds import Job, Results, run
    from bench.speed.stages import Scene
    from bench.speed.verdicts import Judged
except ModuleNotFoundError as error:
    sys.exit(f"speed: the Python package {error.name} is missing (`scripts/venv` installs it)")

TITLE = "kage's speed"


def parse_arguments(arguments: Sequence[str] | None) -> argparse.Namespace:
    about, _, status = (__doc__ or "").partition("\nstatus:")
    parser = argparse.ArgumentParser(prog="python -m bench.speed", description=about, epilog="status:" + status,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--level", choices=LEVELS, default="normal", help="how much is measured (normal)")
    parser.add_argument("--only", metavar="PART,...", help=f"measure only these: {', '.join(PARTS)}")
    parser.add_argument("--out", type=Path, default=TOP / "out" / "speed", metavar="DIR", help="(out/speed)")
    parser.add_argument("--kage", type=Path, default=KAGE, metavar="FILE", help="the program (build/float/kage)")
    parser.add_argument("--write", action="store_true", help=f"write the last report's bounds into {pages.DOCS}")
    options = parser.parse_args(arguments)
    options.parts = options.only.split(",") if options.only else list(PARTS)
    wrong = [name for name in options.parts if name not in PARTS]
    if wrong:
        parser.error(f"--only {','.join(wrong)}: expected some of {', '.join(PARTS)}")
    options.kage, options.out = options.kage.resolve(), options.out.resolve()
    if not options.write and not os.access(options.kage, os.X_OK):
        parser.error(f"{options.kage} is missing or is not a program: `make` builds it")
    return options


def circumstances(level: str, seconds: float) -> str:
    load = ", ".join(f"{value:.2f}" for value in os.getloadavg())
    return (f"{programs.processor()}, {datetime.now(UTC):%Y-%m-%d}, commit {programs.commit() or 'unknown'}, "
            f"level {level}, {seconds / 60:.0f} minutes, load {load}.")


def teller() -> Callable[[str], None]:
    """A line for each job; on a terminal over the last one."""
    begin = time.monotonic()
    ends = "\r" if sys.stderr.isatty() else "\n"

    def tell(text: str) -> None:
        print(f"speed: {time.monotonic() - begin:5.0f} s  {text:60}", end=ends, file=sys.stderr, flush=True)

    return tell


def keep(options: argparse.Namespace, about: str, judged: list[Judged], jobs: list[Job], results: Results,
         scenes: list[Scene]) -> list[pages.Table]:
    """Write the report's files."""
    found = pages.tables(judged, jobs, results, scenes)
    report = {"about": about, "level": options.level, "parts": options.parts,
              "bounds": [dataclasses.asdict(one) for one in judged], "values": results.values,
              "missing": results.missing, "commands": {job.name: job.command for job in jobs if job.command},
              "stages": [dataclasses.asdict(scene) for scene in scenes]}
    for name, text in (("report.json", json.dumps(report, indent=1) + "\n"),
                       ("report.md", pages.markdown(TITLE, about, found)),
                       ("index.html", pages.page(TITLE, about, found))):
        write(options.out / name, text.encode())
    return found


def measure(options: argparse.Namespace) -> int:
    about = About(options.kage, options.out, LEVELS[options.level])
    about.inputs.mkdir(parents=True, exist_ok=True)
    begin, tell = time.monotonic(), teller()
    tell("inputs")
    jobs, missing = parts.jobs(about, options.parts)
    results = run(jobs, tell)
    parts.sample_bytes(about.level, results)
    scenes, more = stages.measure(about, tell) if "stages" in options.parts else ([], {})
    results.missing |= missing | more
    wanted = [bound for bound in plan.bounds(about.level) if bound.part in options.parts]
    judged = verdicts.judge(results, wanted)
    found = keep(options, circumstances(options.level, time.monotonic() - begin), judged, jobs, results, scenes)
    for line in pages.columns(found[0]) if found else ():
        print(line)
    print(options.out / "index.html")
    for name, why in results.missing.items():
        print(f"speed: {name}: {why}", file=sys.stderr)
    return 3 if results.missing else 0


def write_docs(options: argparse.Namespace) -> int:
    report = json.loads((options.out / "report.json").read_text())
    judged = [Judged(Bound(**one["bound"]), one["found"], one["verdict"]) for one in report["bounds"]]
    path = TOP / pages.DOCS
    write(path, pages.docs(path.read_text(), report["about"], judged).encode())
    return 0


def main(arguments: Sequence[str] | None = None) -> int:
    options = parse_arguments(arguments)
    try:
        return write_docs(options) if options.write else measure(options)
    except (MeasureError, ReadmeError, OSError, ValueError) as error:
        print(f"speed: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("speed: interrupted", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
