"""Runs the jobs round by round and keeps what they give.

In a round every job runs once, one after the other, so that whatever else the machine does slows all alike; each second
round goes backwards. A part that takes long runs in the first rounds only. Two figures are compared by the ratio within
each round.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from bench import programs
from bench.programs import TOP, MeasureError, Word
from bench.stats import Interval, interval

LAUNCH = Path(__file__).parent / "launch.py"
Figures = dict[str, float]


@dataclass(frozen=True)
class Job:
    """A piece of work, and the round from which on it does not run any more."""

    name: str
    part: str
    work: Callable[[], Figures]
    rounds: int
    command: str = ""  # to show


@dataclass
class Results:
    """By "job: figure", its value in each round. `missing` has the reasons of the jobs that failed."""

    values: dict[str, list[float]] = field(default_factory=dict)
    missing: dict[str, str] = field(default_factory=dict)

    def add(self, job: str, figures: Figures) -> None:
        for name, value in figures.items():
            self.values.setdefault(f"{job}: {name}", []).append(value)

    def interval(self, key: str) -> Interval | None:
        found = self.values.get(key)
        return interval(found) if found else None

    def ratio(self, over: str, under: str) -> Interval | None:
        """Of two figures, round by round."""
        pairs = [a / b for a, b in zip(self.values.get(over, []), self.values.get(under, []), strict=False) if b > 0]
        return interval(pairs) if pairs else None


@dataclass(frozen=True)
class Ran:
    """A command that has run: what it printed, on both streams, and what it took, one value for each run."""

    text: str
    seconds: list[float]
    cpu: list[float]  # seconds of processor time, in the same order
    memory: float  # the most of all runs, bytes
    moved: Figures  # bytes read and written by the last run, memory maps apart; empty where the system has no count

    @property
    def weight(self) -> Figures:
        return {"memory": self.memory, **self.moved}


def launch(command: Sequence[Word], times: int = 1) -> Ran:
    words = [sys.executable, "-I", "-S", str(LAUNCH), str(times), *map(str, command)]
    done = subprocess.run(words, cwd=TOP, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
                          check=False)
    try:
        runs = json.loads(done.stdout)
    except ValueError:
        last = done.stderr.strip().splitlines()[-1:]
        raise MeasureError(f"{programs.shown(command)}: {''.join(last)}") from None
    for run in runs:
        if run["status"]:
            last = done.stderr.strip().splitlines()[-1:]
            raise MeasureError(f"{programs.shown(command)}: status {run['status']}: {''.join(last)}")
    moved = {f"{name}_bytes": float(runs[-1][name]) for name in ("read", "written") if name in runs[-1]}
    return Ran(done.stderr, [run["seconds"] for run in runs], [run["cpu"] for run in runs],
               max(run["memory"] for run in runs), moved)


def milliseconds(text: str) -> Figures:
    """From `kage render --stats`: the lines with a time, such as render, bump and output, in ms; of several runs each
    line's least."""
    times: Figures = {}
    for name, value in re.findall(r"^ *(\w+) +([0-9.]+) ms\b", text, re.MULTILINE):
        times[name] = min(float(value), times.get(name, float(value)))
    return times


def run(jobs: Sequence[Job], tell: Callable[[str], None]) -> Results:
    """All jobs, round by round. A job that fails does not run again."""
    results = Results()
    for number in range(max((job.rounds for job in jobs), default=0)):
        due = [job for job in jobs if number < job.rounds and job.name not in results.missing]
        for job in due[::-1] if number % 2 else due:
            tell(f"round {number + 1}: {job.name}")
            try:
                results.add(job.name, job.work())
            except (MeasureError, OSError) as error:
                results.missing[job.name] = str(error)
    return results
