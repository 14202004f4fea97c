"""The bench's jobs in other processes by Dask: the same figures as in threads here."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from bench import plan, sweep
from bench.machines import machines
from bench.programs import MeasureError
from bench.runner import Job, Runner
from bench.store import Store
from tests.conftest import PROGRAM


def jobs(folder: Path) -> list[Job]:
    level = dataclasses.replace(plan.LEVELS["quick"], slopes=(0.35,), angles=(40,), methods=("none", "0"))
    one = plan.Bench(PROGRAM, "tested", folder, level, {"waves": plan.facts(PROGRAM, "waves")})
    found = sweep.jobs(one)
    return [*found[:2], found[-1]]


def test_other_processes_have_the_same_figures(tmp_path: Path) -> None:
    found = []
    for name, scheduler in (("here", None), ("there", "local:1")):
        due = jobs(tmp_path / name)
        with Store(tmp_path / name / "results.jsonl") as store, machines(scheduler) as elsewhere:
            runner = Runner(store, elsewhere)
            runner.run(due)
            assert runner.failed == {}
            found.append([store.get(job.name, job.inputs) for job in due])
    here, there = found
    assert here == there and all(here)


def test_no_scheduler() -> None:
    for wrong in ("local:x", "nonsense://"):
        with pytest.raises(MeasureError, match=f"--scheduler {wrong}: expected"), machines(wrong):
            pass
