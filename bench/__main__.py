"""What each method costs, what it buys, and when to use which: measures, then writes the report.

Results are kept in OUT/results.jsonl as they come. If the bench is interrupted and started again, it goes on where it
was: it repeats a measurement only if the scene, the program or the options have changed. The report is OUT/index.html,
with report.md, report.json and CSV files.

status: 0 the report is made, 1 it can't be made, 2 wrong usage, 3 it is made but incomplete, 130 interrupted
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
from collections.abc import Sequence
from pathlib import Path

try:
    from bench import bounds, claims, cost, plan, programs, quality, report, summary, sweep, whole
except ModuleNotFoundError as error:
    sys.exit(f"bench: the Python package {error.name} is missing, and the bench needs it (`scripts/venv` installs it)")
from bench.data import Claim, Report
from bench.machines import machines
from bench.plan import LEVELS, TITLES, Bench
from bench.programs import KAGE, TOP, MeasureError
from bench.runner import Job, Runner
from bench.store import Store, StoreError

PARTS = ("quality", "whole", "cost", "sweeps")


def parse_arguments(arguments: Sequence[str] | None) -> argparse.Namespace:
    about, _, status = (__doc__ or "").partition("\nstatus:")
    parser = argparse.ArgumentParser(prog="python -m bench", description=about, epilog="status:" + status,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--level", choices=LEVELS, default="normal", help="how much is measured (normal)")
    parser.add_argument("--only", action="append", choices=PARTS, metavar="PART",
                        help=f"measure only this part; may be given again: {', '.join(PARTS)}")
    parser.add_argument("--scene", action="append", choices=TITLES, metavar="SCENE",
                        help=f"measure only this scene; may be given again: {', '.join(TITLES)}")
    parser.add_argument("--out", type=Path, default=TOP / "out" / "bench", metavar="DIR", help="(out/bench)")
    parser.add_argument("--kage", type=Path, default=KAGE, metavar="FILE", help="the program (build/float/kage)")
    parser.add_argument("--again", action="store_true",
                        help="measure nothing: judge OUT/report.json again, and write the report from it")
    parser.add_argument("--scheduler", metavar="ADDRESS",
                        help="measure all but times on a Dask cluster: tcp://HOST:PORT, or local:N processes")
    options = parser.parse_args(arguments)
    options.kage, options.out = options.kage.resolve(), options.out.resolve()
    if not options.again and not os.access(options.kage, os.X_OK):
        parser.error(f"{options.kage} is missing or is not a program: `make` builds it")
    return options


def plan_jobs(bench: Bench, parts: Sequence[str]) -> tuple[list[Job], list[str]]:
    """All jobs, and a line for each thing that can't be measured."""
    jobs: list[Job] = []
    faults: list[str] = []
    if "quality" in parts:
        jobs += quality.jobs(bench)
    if "whole" in parts:
        jobs += whole.jobs(bench)
    if "sweeps" in parts:
        jobs += sweep.jobs(bench)
    if "cost" in parts:
        found, faults = cost_jobs(bench)
        jobs += found
    return jobs, faults


def cost_jobs(bench: Bench) -> tuple[list[Job], list[str]]:
    """As plan_jobs, for the part `cost`."""
    wanted = bench.level.yardsticks and "cube" in bench.scenes
    built, faults = cost.limits(bench) if wanted else ({}, [])
    scenes = cost.povray_scenes(bench) if programs.has_povray() else []
    version = programs.version(["povray", "--version"], r"POV-Ray \d\S*")
    jobs = cost.kage_once(bench) + [made for *_, made in scenes if made]
    for number in range(bench.level.rounds):
        jobs += cost.kage_round(bench, number) + cost.povray_round(bench, number, version, scenes)
        jobs += cost.limits_round(number, built)
    return jobs + cost.povray_memory(bench, version, scenes) + cost.limits_memory(built), faults


def make_references(bench: Bench) -> list[str]:
    """Make the references that are larger than the project's, where they are stale. Returns why they can't be made."""
    if bench.references == TOP / "reference":
        return []
    print("bench: POV-Ray's references; to make them takes minutes", file=sys.stderr, flush=True)
    try:
        programs.run([sys.executable, TOP / "reference" / "render.py", "--kage", bench.kage, "--folder",
                      bench.references, "--scale", str(bench.level.reference_scale), *bench.scenes])
    except MeasureError as error:
        return [str(error)]
    return []


def judge(found: Report) -> list[Claim]:
    return claims.claims(found) + bounds.bounds(found)


def measured(options: argparse.Namespace) -> Report:
    names = options.scene or TITLES
    facts = {name: plan.facts(options.kage, name) for name in TITLES if name in names}
    about = Bench(options.kage, programs.file_digest(options.kage), options.out, LEVELS[options.level], facts)
    with Store(options.out / "results.jsonl") as store, machines(options.scheduler) as elsewhere:
        faults = make_references(about)
        jobs, more = plan_jobs(about, options.only or PARTS)
        runner = Runner(store, elsewhere)
        runner.run(jobs)
        data = summary.summarise(about, store, jobs, runner.failed, judge)
    data["incomplete"] += faults + more
    return data


def stored(options: argparse.Namespace) -> Report:
    """As it was measured, but judged by today's claims and told in today's words."""
    path = options.out / "report.json"
    if not path.exists():
        raise MeasureError(f"{path}: not there; --again needs the report of a bench, so run make bench first")
    data: Report = json.loads(path.read_text())
    data["claims"] = judge(data)
    data["answer"] = summary.answer(data)
    return data


def bench(options: argparse.Namespace) -> int:
    """Measure, write the report, and name all that is missing. The exit status."""
    data = stored(options) if options.again else measured(options)
    missing = report.write(data, options.out)
    data["incomplete"] += [line for line in missing if line not in data["incomplete"]]
    data["complete"] = not data["incomplete"]
    report.write_all(options.out, {"report.json": json.dumps(data, indent=1) + "\n"})
    for line in data["incomplete"] + data["notes"]:
        print(f"bench: {line}", file=sys.stderr)
    for line in bounds.lines(data["claims"]):
        print(line)
    print(f"{options.out / 'index.html'}")
    return 0 if data["complete"] else 3


def main(arguments: Sequence[str] | None = None) -> int:
    options = parse_arguments(arguments)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        return bench(options)
    except (MeasureError, StoreError, OSError, ValueError) as error:
        print(f"bench: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("bench: interrupted; the same command goes on from here", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
