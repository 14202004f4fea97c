"""Runs the jobs that are not done yet.

Jobs come in stages, one after the other, as later ones need files of earlier ones. The jobs of a stage share the
processors, or those of other machines, except jobs that measure time: each of those runs alone and pinned. They run in
the order of the plan, in which jobs that are compared are neighbours.
"""

from __future__ import annotations

import functools
import os
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import IntEnum
from pathlib import Path

from bench import programs
from bench.programs import MeasureError, pinned
from bench.store import Inputs, Store, Value


class Stage(IntEnum):
    """When a job runs."""

    TRUTHS = 0  # pictures that others are compared with
    MEASURES = 1
    TIMES = 2  # alone


@dataclass(frozen=True)
class Job:
    """A piece of work whose value is kept."""

    name: str
    inputs: Inputs  # all that the value depends on
    work: Callable[[], Value]
    stage: Stage
    seconds: float  # expected, for the time left
    files: tuple[Path, ...] = ()  # that it makes; it is done only where they exist


def is_done(job: Job, store: Store) -> bool:
    return store.get(job.name, job.inputs) is not None and all(path.exists() for path in job.files)


class Progress:
    """A bar with the time left where stderr is a terminal, otherwise a line for each stage."""

    def __init__(self, jobs: Sequence[Job]) -> None:
        self.total, self.bar = sum(job.seconds for job in jobs), None
        if sys.stderr.isatty():
            try:
                from tqdm import tqdm
            except ImportError:
                return  # the report names missing packages
            form = "{percentage:3.0f} % |{bar}| {elapsed} gone, {remaining} left  {desc}"
            self.bar = tqdm(total=self.total, bar_format=form, dynamic_ncols=True, leave=False)

    def begin(self, stage: Stage, jobs: Sequence[Job]) -> None:
        if self.bar is None and jobs:
            print(f"bench: {stage.name.lower()}: {len(jobs)} jobs", file=sys.stderr, flush=True)

    def done(self, job: Job) -> None:
        if self.bar is not None:
            self.bar.set_description_str(job.name, refresh=False)
            self.bar.update(job.seconds)

    def end(self) -> None:
        if self.bar is not None:
            self.bar.close()


class Runner:
    """Does jobs and keeps their values. `failed` has the jobs that could not be done, each with its reason.

    elsewhere: where jobs run that measure no time (bench/machines.py); None: in threads here.
    """

    def __init__(self, store: Store, elsewhere: Executor | None = None) -> None:
        self.store, self.commit, self.elsewhere = store, programs.commit(), elsewhere
        self.failed: dict[str, str] = {}

    def keep(self, job: Job, value: Value, seconds: float) -> None:
        self.store.add({"job": job.name, "inputs": job.inputs, "commit": self.commit, "seconds": round(seconds, 3),
                        "date": datetime.now(UTC).isoformat(timespec="seconds"), "value": value})

    def finish(self, job: Job, work: Callable[[], tuple[Value, float]]) -> None:
        try:
            self.keep(job, *work())
        except (MeasureError, OSError, ImportError) as error:
            self.failed[job.name] = str(error)

    def together(self, jobs: Sequence[Job], progress: Progress) -> None:
        here = ThreadPoolExecutor(os.cpu_count())
        pool = self.elsewhere or here
        futures: dict[Future[tuple[Value, float]], Job] = {pool.submit(timed, job): job for job in jobs}
        try:
            left = set(futures)
            while left:
                ended, left = wait(left, return_when=FIRST_COMPLETED)
                for future in ended:
                    self.finish(futures[future], future.result)
                    progress.done(futures[future])
        finally:
            here.shutdown(cancel_futures=True)

    def alone(self, jobs: Sequence[Job], progress: Progress) -> None:
        with pinned():
            for job in jobs:
                self.finish(job, functools.partial(timed, job))
                progress.done(job)

    def run(self, jobs: Iterable[Job]) -> None:
        due = [job for job in jobs if not is_done(job, self.store)]
        progress = Progress(due)
        try:
            for stage in Stage:
                part = [job for job in due if job.stage == stage]
                progress.begin(stage, part)
                (self.alone if stage == Stage.TIMES else self.together)(part, progress)
        finally:
            progress.end()


def timed(job: Job) -> tuple[Value, float]:
    """The job's value, and the seconds it took."""
    start = time.monotonic()
    value = job.work()
    return value, time.monotonic() - start
