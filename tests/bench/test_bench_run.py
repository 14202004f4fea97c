"""`make bench` as a whole: what is kept, what is done again, and a report from a small bench, interrupted and not."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import pytest

from bench import runner, store, summary
from bench.programs import MeasureError
from bench.runner import Job, Stage
from tests.conftest import PROGRAM, TOP, start
from tests.support import browser

# What is kept --------------------------------------------------------------------------------------


def record(job: str, value: object = 1, **inputs: object) -> dict[str, object]:
    return {"job": job, "inputs": inputs, "value": {"x": value}}


def test_values_are_found_again_by_their_inputs(tmp_path: Path) -> None:
    path = tmp_path / "new" / "r.jsonl"
    with store.Store(path) as kept:
        assert kept.get("a", {"kage": "1"}) is None
        kept.add(record("a", 1, kage="1", size=(4, 3)))
        kept.add(record("a", 2, kage="2", size=(4, 3)))
    with store.Store(path) as kept:
        assert kept.get("a", {"kage": "1", "size": [4, 3]}) == {"x": 1}
        assert kept.get("a", {"kage": "2", "size": [4, 3]}) == {"x": 2}
        assert kept.get("a", {"kage": "3", "size": [4, 3]}) is None
        assert kept.get("b", {"kage": "1", "size": [4, 3]}) is None


@pytest.mark.parametrize("cut", range(1, 45, 4))
def test_a_torn_line_was_not_finished(tmp_path: Path, cut: int) -> None:
    path = tmp_path / "r.jsonl"
    with store.Store(path) as kept:
        kept.add(record("a"))
        kept.add(record("b"))
    path.write_bytes(path.read_bytes()[:-cut])
    with store.Store(path) as kept:
        assert kept.get("a", {}) == {"x": 1}
        assert (kept.get("b", {}) is None) == (cut > 1)  # a line is whole without its end
        kept.add(record("c"))
    with store.Store(path) as kept:
        assert kept.get("a", {}) == kept.get("c", {}) == {"x": 1}


@pytest.mark.parametrize("line", ["", "[]", "7", "{}", '{"job": 1, "inputs": {}, "value": {}}', "\x00\xff",
                                  '{"job": "a"}'])
def test_nonsense_is_passed_over(tmp_path: Path, line: str) -> None:
    path = tmp_path / "r.jsonl"
    path.write_text(line + "\n" + json.dumps(record("a")) + "\n")
    with store.Store(path) as kept:
        assert kept.get("a", {}) == {"x": 1}


def test_one_bench_at_a_time(tmp_path: Path) -> None:
    with store.Store(tmp_path / "r.jsonl"), pytest.raises(store.StoreError, match="another bench"):
        store.Store(tmp_path / "r.jsonl")
    store.Store(tmp_path / "r.jsonl").file.close()


# What is done --------------------------------------------------------------------------------------


class Work:
    """Jobs that say when they were done."""

    def __init__(self, folder: Path) -> None:
        self.done: list[str] = []
        self.store = store.Store(folder / "r.jsonl")

    def job(self, name: str, stage: Stage = Stage.MEASURES, fault: Exception | None = None,
            files: tuple[Path, ...] = (),
            **inputs: object) -> Job:
        def work() -> store.Value:
            self.done.append(name)
            if fault:
                raise fault
            for path in files:
                path.touch()
            return {"name": name}

        return Job(name, inputs, work, stage, 1.0, files)

    def run(self, *jobs: Job) -> dict[str, str]:
        self.done.clear()
        one = runner.Runner(self.store)
        one.run(jobs)
        return one.failed


@pytest.fixture
def work(tmp_path: Path) -> Work:
    return Work(tmp_path)


def test_stages_follow_each_other_and_times_keep_their_order(work: Work) -> None:
    times = [work.job(f"t{k}", Stage.TIMES) for k in range(20)]
    work.run(*times, work.job("m"), work.job("truth", Stage.TRUTHS))
    assert work.done == ["truth", "m", *(job.name for job in times)]


def test_only_what_is_not_done_is_done(work: Work) -> None:
    work.run(work.job("a"), work.job("b", kage="1"))
    work.run(work.job("a"), work.job("b", kage="1"), work.job("c"))
    assert work.done == ["c"]
    work.run(work.job("b", kage="2"))
    assert work.done == ["b"]


def test_a_job_whose_file_is_gone_is_done_again(work: Work, tmp_path: Path) -> None:
    path = tmp_path / "picture"
    work.run(work.job("a", files=(path,)))
    work.run(work.job("a", files=(path,)))
    assert work.done == []
    path.unlink()
    work.run(work.job("a", files=(path,)))
    assert work.done == ["a"]


@pytest.mark.parametrize("stage", Stage)
def test_what_fails_is_told_and_the_rest_is_done(work: Work, stage: Stage) -> None:
    faults = {"a": MeasureError("no such program"), "b": ImportError("No module named 'x'"), "c": OSError("disk full")}
    failed = work.run(*(work.job(name, stage, fault) for name, fault in faults.items()), work.job("d", stage))
    assert failed == {name: str(fault) for name, fault in faults.items()}
    assert work.store.get("d", {}) == {"name": "d"} and work.store.get("a", {}) is None


def test_a_mistake_in_the_bench_is_no_measurement(work: Work) -> None:
    with pytest.raises(ZeroDivisionError):
        work.run(work.job("a", fault=ZeroDivisionError()))


def test_results_are_those_of_the_plan(work: Work) -> None:
    old, new = work.job("a 0", kage="1"), work.job("a 0", kage="2")
    work.run(old)
    assert summary.Results(work.store, [new]).get("a", 0) is None
    assert summary.Results(work.store, [old]).get("a", 0) == {"name": "a 0"}
    assert summary.Results(work.store, [old]).rounds("a", count=2) == []


# A small bench -------------------------------------------------------------------------------------

SMALL = ("--level", "quick", "--scene", "waves")

# With the packages that are to be missing, and for a tiny bench with less of everything.
RUN = """
import dataclasses, runpy, sys
for name in {missing}:
    sys.modules[name] = None
if {tiny}:
    from bench import plan
    plan.LEVELS["quick"] = dataclasses.replace(
        plan.LEVELS["quick"], methods=("none", "0", "exact", "displaced"), variants=("none", "relief"), rounds=3,
        cost_size=(96, 54), povray_size=(192, 108), count_size=(16, 16), slopes=(0.2, 1.0), angles=(30, 60))
sys.argv = ["bench", *{arguments}]
runpy.run_module("bench", run_name="__main__", alter_sys=True)
"""


def command(out: Path, *more: str, tiny: bool = True, missing: Sequence[str] = ()) -> list[str]:
    arguments = [*SMALL, "--out", str(out), "--kage", str(PROGRAM), *more]
    return [sys.executable, "-c", RUN.format(missing=list(missing), tiny=tiny, arguments=arguments)]


def bench(words: Sequence[str], **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(words, cwd=TOP, env=os.environ | environment, capture_output=True, text=True, timeout=600)


def records(out: Path) -> list[dict[str, object]]:
    found = [store.parse(line) for line in (out / "results.jsonl").read_text().splitlines()]
    return [one for one in found if one]


def report(out: Path) -> dict[str, object]:
    return json.loads((out / "report.json").read_text())


def stable(out: Path) -> dict[str, object]:
    """What may not differ from run to run."""
    data = report(out)
    cost = {scene: {m: {k: c[k] for k in ("lookups", "shadow_rays")} for m, c in found["methods"].items()}
            for scene, found in data["cost"]["scenes"].items()}
    return {"quality": data["quality"], "whole": data["whole"], "sweeps": data["sweeps"],
            "slopes": data["slopes"], "cost": cost}


def instructions(out: Path) -> dict[tuple[str, str], float]:
    """Added to those of none, in per cent. How often progress is told goes by the clock: on a busy machine a count
    differs by 0.03 % of the whole, which is more of the difference of two."""
    scenes = report(out)["cost"]["scenes"]
    return {(scene, m): c["instructions_added"] for scene, found in scenes.items() for m, c in found["methods"].items()
            if c["instructions_added"] is not None}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("whole")
    done = bench(command(out, tiny=False))
    assert done.returncode in (0, 3), done.stderr
    *lines, last = done.stdout.splitlines()
    assert last == f"{out}/index.html"
    assert len(lines) > 10 and all(line.startswith("bound ") for line in lines)
    assert "bound auto-wrong: waves: 0 % of the shadow's pixels wrong, at most 0.1: holds" in lines
    return out


def test_a_small_bench_has_it_all(whole: Path) -> None:
    data = report(whole)
    none, zero = (data["quality"]["scenes"]["waves"][method] for method in ("none", "0"))
    assert none["mask"]["wrong"] > 3 > 1 > zero["mask"]["wrong"] > 0.1
    assert none["edge_moved"] == {"mean": 0, "p95": 0, "hausdorff": 0} and zero["edge_moved"]["mean"] > 1
    assert zero["hybrid"]["flip"] < none["hybrid"]["flip"] < none["self"]["flip"]
    assert zero["tau"]["median"] < none["tau"]["median"]
    assert data["quality"]["scenes"]["waves"]["exact"]["tau"]["p95"] == 0
    assert data["quality"]["parity"]["waves"]["cast"] > 99.8
    methods = data["cost"]["scenes"]["waves"]["methods"]
    assert methods["none"]["added"] is None and methods["displaced"]["added"]["median"] > 100
    assert all(cost["ns"]["n"] == 7 and cost["memory"] > 5e6 for cost in methods.values())
    assert methods["exact"]["lookups"] > methods["march:4"]["lookups"] > methods["2"]["lookups"] == 1
    assert {sweep["id"] for sweep in data["sweeps"]} == {"waves-slope-view", "waves-slope-light"}
    steep, gentle = (data["sweeps"][0]["wrong"][2][k] for k in (-1, 0))
    assert steep["0"] > 1 > 0.2 > gentle["0"] and gentle["none"] > gentle["0"] > gentle["2"]
    fit = data["slopes"]["waves"]["fit"]
    assert abs(fit["0"] - 2) < 0.2 and abs(fit["1"] - 3) < 0.3 and abs(fit["2+"] - 4) < 0.5
    assert len(data["answer"]) == 7 and len(data["claims"]) == 12 + 7


def test_a_small_bench_has_whole_pictures(whole: Path) -> None:
    part = report(whole)["whole"]
    none, shifted, relief = (part["scenes"]["waves"][v] for v in ("none", "march:8 shifted", "relief"))
    assert none["off_8"] > 10 > 0.1 > shifted["off_8"] and none["flip"] > 10 * relief["flip"]
    assert abs(none["off_8"] - none["povray"]["off_8"]) < 0.5 and none["silhouette"] == 0
    low, high = (part["lamps"]["waves"]["off"]["march:8 shifted"][i] for i in (0, -1))
    assert low > 1 > 0.1 > high, "bumps shadow each other by a low lamp"
    own = part["own"]["waves"]
    assert own["values"] == [10, 20, 30, 45, 60] and own["shadow"][0] > 5000
    assert own["wrong"]["displaced"][0] < 1 and own["wrong"]["own 4"][-1] is None, "no shadow, no share"
    assert sum(part["orders"]["waves"].values()) == pytest.approx(100)
    pictures = report(whole)["pictures"]["scenes"]["waves"]
    assert pictures["variants"].keys() == {"displaced", *report(whole)["variants"]} and pictures["orders"]


def test_its_page_works_in_a_browser(whole: Path) -> None:
    browser.check_page(whole / "index.html")


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("tiny")
    assert bench(command(out)).returncode in (0, 3)
    return out


def test_the_same_again_repeats_nothing(tiny: Path) -> None:
    before, first = (tiny / "results.jsonl").read_bytes(), stable(tiny)
    assert bench(command(tiny)).returncode in (0, 3)
    assert (tiny / "results.jsonl").read_bytes() == before
    assert stable(tiny) == first


@pytest.mark.parametrize("how", [signal.SIGINT, pytest.param(signal.SIGKILL, marks=pytest.mark.slow)])
def test_interrupted_and_started_again(tiny: Path, tmp_path: Path, how: signal.Signals) -> None:
    """It ends with the same report, and repeats nothing that was finished; so two runs agree, too."""
    for least in (3, 10, 40):
        running = start(command(tmp_path), cwd=TOP, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while running.poll() is None and (not (tmp_path / "results.jsonl").exists() or len(records(tmp_path)) < least):
            time.sleep(0.02)
        assert running.poll() is None, "it ended before it could be interrupted"
        running.send_signal(how)
        assert running.wait(timeout=60) == (130 if how == signal.SIGINT else -how)
        assert not (tmp_path / "report.json").exists()
    assert bench(command(tmp_path)).returncode in (0, 3)
    times = Counter(str(one["job"]) for one in records(tmp_path))
    assert set(times.values()) == {1}
    assert times.keys() == {str(one["job"]) for one in records(tiny)}
    assert stable(tmp_path) == stable(tiny)
    assert instructions(tmp_path) == pytest.approx(instructions(tiny), rel=1e-3, abs=1)


@pytest.mark.parametrize("missing, names, left", [
    (["flip_evaluator"], ["flip-evaluator"], {"index.html", "report.md", "report.json"}),
    (["matplotlib", "tqdm"], ["tqdm", "matplotlib"], {"index.html", "report.md", "report.json"}),
    (["jinja2"], ["Jinja2"], {"report.md", "report.json", "quality.csv"}),
    (["OpenEXR"], ["OpenEXR"], {"index.html", "report.md", "report.json", "cost.csv"}),
])
def test_without_a_package_the_rest_is_made(tiny: Path, tmp_path: Path, missing: list[str], names: list[str],
                                            left: set[str]) -> None:
    """What was measured with the package is not taken for what is measured without."""
    if missing != ["OpenEXR"]:
        shutil.copytree(tiny, tmp_path, dirs_exist_ok=True, ignore=shutil.ignore_patterns("*.html", "*.md"))
    done = bench(command(tmp_path, "--only", "quality", "--only", "cost", missing=missing))
    assert done.returncode == 3 and "Traceback" not in done.stderr, done.stderr
    data = report(tmp_path)
    assert not data["complete"]
    for name in names:
        assert len([line for line in done.stderr.splitlines() if line.startswith("bench: ") and f"{name}" in line]) == 1
        assert len([line for line in data["incomplete"] if name in line]) == 1
    assert left <= {path.name for path in tmp_path.iterdir()}
    assert data["cost"]["scenes"]["waves"]["methods"]["0"]["ns"]["n"] == 3
    zero = data["quality"]["scenes"]["waves"]["0"]
    if "OpenEXR" in missing:
        assert zero["mask"] is None
    else:
        assert zero["mask"]["wrong"] < 1 and (zero["hybrid"]["flip"] is None) == (missing == ["flip_evaluator"])


def test_without_povray(tmp_path: Path) -> None:
    """A PATH with all programs but that."""
    folder = tmp_path / "bin"
    folder.mkdir()
    for place in os.environ["PATH"].split(os.pathsep):
        for path in Path(place).glob("*") if place else ():
            if path.name not in ("povray", "valgrind") and not (folder / path.name).exists():
                (folder / path.name).symlink_to(path)
    done = bench(command(tmp_path / "out", "--only", "cost"), PATH=str(folder))
    assert done.returncode == 3
    told = [text for text in done.stderr.splitlines() if "missing" in text]
    assert [text.split()[1] for text in told] == ["POV-Ray", "valgrind"], done.stderr
    data = report(tmp_path / "out")
    assert data["cost"]["peers"] == [] and data["cost"]["scenes"]["waves"]["methods"]["0"]["ns"]["n"] == 3


@pytest.mark.parametrize("arguments",
                         [["--level", "huge"], ["--scene", "moon"], ["--only", "nothing"], ["--kage", "none"],
                                       ["more"]])
def test_wrong_usage(arguments: list[str]) -> None:
    done = subprocess.run([sys.executable, "-m", "bench", *arguments], cwd=TOP, capture_output=True, text=True,
                          timeout=60)
    assert done.returncode == 2 and "bench: error: " in done.stderr
