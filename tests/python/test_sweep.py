"""Sweeps on Dask clusters of processes: whole, again, changed; with workers that are killed; interrupted and gone on
with; in bands; frames; and the command."""

from __future__ import annotations

import csv
import functools
import json
import os
import random
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import dask
import pytest
from distributed import Client, LocalCluster

from kage.sweep import Keys, Output, Plan, SweepError, axis, records, run
from kage.sweep import __main__ as program
from kage.sweep.__main__ import main
from kage.sweep.plan import Task
from kage.sweep.run import cluster
from kage.sweep.worker import Result
from tests.conftest import PROGRAM, TOP, Kage, restore_signals

CUBE = TOP / "scenes" / "cube.yaml"
SCALE = "objects.ground.bump.scale"
SIZE = (64, 48)
LONG = 300  # seconds; a busy machine is slow


@pytest.fixture(scope="module")
def client() -> Iterator[Client]:
    with cluster(workers=2) as made:
        yield made


def plan_of(folder: Path, *texts: str, scene: Path = CUBE, send: bool = False, keys: Keys | None = None,
            size: tuple[int, int] = SIZE, **more: Any) -> Plan:
    return Plan.of(scene, [axis(text) for text in texts], Output(folder, size=size, **more), keys=keys, send=send)


def events(folder: Path, event: str) -> Counter[str]:
    return Counter(line["file"] for line in records.read_logs(folder) if line["event"] == event)


def bytes_of(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.suffix in (".png", ".exr")}


# Whole ----------------------------------------------------------------------------------------------


def test_a_grid_is_what_the_program_renders(client: Client, kage: Kage, tmp_path: Path) -> None:
    done = run(plan_of(tmp_path / "out", f"{SCALE}=0.1:0.3:3", "render.shadow=none,2"), client)
    assert (done.rendered, done.found, done.failed, len(done.records)) == (6, 0, {}, 6)
    for scale in ("0.1", "0.3"):
        kage.good("render", CUBE, "--set", f"{SCALE}={scale}", "--set", "render.shadow=2", "--size", "64x48", "-o",
                  tmp_path / "a.png", "--quiet")
        assert (tmp_path / "out" / f"scale={scale},shadow=2.png").read_bytes() == (tmp_path / "a.png").read_bytes()
    with (tmp_path / "out" / "index.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [(row[SCALE], row["render.shadow"]) for row in rows] == [
        (scale, shadow) for scale in ("0.1", "0.2", "0.3") for shadow in ("none", "2")]
    assert all(int(row["camera_rays"]) == 64 * 48 for row in rows)
    about = json.loads((tmp_path / "out" / "index.json").read_text())
    assert [one["sha256"] for one in about["pictures"]] == [row["sha256"] for row in rows]
    page = (tmp_path / "out" / "index.html").read_text()
    assert page.count("<img") == 6 and "scale%3D0.1%2Cshadow%3Dnone.png" in page


def test_again_nothing_is_rendered_and_a_change_alone_is(client: Client, tmp_path: Path) -> None:
    first = run(plan_of(tmp_path, "render.shadow=none,0,1"), client)
    again = run(plan_of(tmp_path, "render.shadow=none,0,1"), client)
    more = run(plan_of(tmp_path, "render.shadow=0,1,2"), client)
    (tmp_path / "shadow=1.png").write_bytes(b"")
    mended = run(plan_of(tmp_path, "render.shadow=0,1,2"), client)
    other = run(plan_of(tmp_path, "render.shadow=0,1,2", bits=16), client)
    assert [(one.rendered, one.found) for one in (first, again, more, mended, other)] == [
        (3, 0), (0, 3), (1, 2), (1, 2), (3, 0)]
    assert sum(events(tmp_path, "end").values()) == 8


def test_a_wrong_value_is_told_once_and_the_rest_stays(client: Client, tmp_path: Path) -> None:
    with pytest.raises(SweepError, match=r"--set:1:27: 'steep' is no number") as raised:
        run(plan_of(tmp_path, f"{SCALE}=0.1,steep,0.2"), client)
    assert raised.value.status == 2 and (tmp_path / "index.html").exists()
    assert run(plan_of(tmp_path, f"{SCALE}=0.1,0.2"), client).failed == {}


def test_what_cannot_be_written_fails_alone(client: Client, tmp_path: Path) -> None:
    (tmp_path / "shadow=1.png").mkdir()
    done = run(plan_of(tmp_path, "render.shadow=0,1,2"), client)
    assert list(done.failed) == ["shadow=1.png"] and "Is a directory" in done.failed["shadow=1.png"]
    assert sorted(done.records) == ["shadow=0.png", "shadow=2.png"]


def test_an_index_that_cannot_be_written_is_told(client: Client, tmp_path: Path,
                                                 capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "index.json").mkdir()
    words = ["--size", "64x48", "--scheduler", client.scheduler.address, "--out", tmp_path]
    assert main([str(CUBE), *map(str, words)]) == 1
    assert "Is a directory" in capsys.readouterr().err


def test_a_scheduler_without_workers_is_told_of(tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                                capsys: pytest.CaptureFixture[str]) -> None:
    """The worker starts when the message is there, so without it nothing would be rendered."""
    with LocalCluster(n_workers=0, threads_per_worker=1, processes=True, dashboard_address=":0") as empty:
        def say(text: str) -> None:
            program_say(text)
            empty.scale(1)

        program_say = program.say
        monkeypatch.setattr(program, "say", say)
        words = ["--size", "64x48", "--scheduler", empty.scheduler_address, "--out", tmp_path]
        assert main([str(CUBE), *map(str, words)]) == 0
        assert capsys.readouterr().err.count(f"kage.sweep: waiting for workers at {empty.scheduler_address}") == 1


# Bands and frames -----------------------------------------------------------------------------------


def test_bands_have_the_bytes_of_the_whole(client: Client, kage: Kage, tmp_path: Path) -> None:
    parts = plan_of(tmp_path / "out", "render.shadow=0,2", kind="exr", bands=3, size=(40, 70))
    done = run(parts, client)
    assert done.rendered == 6 and len(done.records) == 2
    kage.good("render", CUBE, "--set", "render.shadow=2", "--size", "40x70", "-o", tmp_path / "a.exr", "--quiet")
    assert (tmp_path / "out" / "shadow=2.exr").read_bytes() == (tmp_path / "a.exr").read_bytes()
    assert sorted(bytes_of(tmp_path / "out")) == ["shadow=0.exr", "shadow=2.exr"]  # the bands are gone
    assert run(parts, client).rendered == 0


def test_bands_that_are_there_are_joined(client: Client, tmp_path: Path) -> None:
    """As after a kill between the last band and the joining."""
    parts = plan_of(tmp_path, kind="exr", bands=3, size=(40, 70), layers="color")
    whole = run(plan_of(tmp_path / "whole", kind="exr", size=(40, 70), layers="color"), client)
    for band in parts.pictures[0].bands[:2]:
        one = client.submit(functools.partial(render_band, parts, band, str(tmp_path)))
        one.result(timeout=LONG)
    assert run(parts, client).rendered == 1
    assert (tmp_path / "picture.exr").read_bytes() == (whole.folder / "picture.exr").read_bytes()


def render_band(plan: Plan, task: Task, folder: str) -> None:
    from kage.sweep.inputs import VERSION
    from kage.sweep.worker import work

    (Path(folder) / records.FOLDER).mkdir(exist_ok=True)
    work(plan.inputs, task, folder, 1, VERSION)


def test_frames_and_files_that_are_sent(client: Client, kage: Kage, tmp_path: Path) -> None:
    """No worker reads or writes where the sweep was started: the scene is gone before they begin."""
    keys = Keys.parse(f"{SCALE}: [[0, 0], [10, 0.4]]\nrender.shadow: [[0, none], [9, 2]]")
    (tmp_path / "data").mkdir()
    scene = tmp_path / "a.yaml"
    scene.write_text(CUBE.read_text())
    (tmp_path / "data" / "bumps.png").write_bytes((TOP / "scenes" / "data" / "bumps.png").read_bytes())
    sent = plan_of(tmp_path / "sent", "frame=0:10:3", scene=scene, keys=keys, send=True)
    shared = run(plan_of(tmp_path / "shared", "frame=0:10:3", scene=scene, keys=keys), client)
    kage.good("render", scene, "--set", f"{SCALE}=0.4", "--set", "render.shadow=2", "--size", "64x48", "-o",
              tmp_path / "a.png", "--quiet")
    (tmp_path / "data" / "bumps.png").unlink()
    done = run(sent, client)
    assert (shared.rendered, done.rendered) == (3, 3) and not events(tmp_path / "sent", "begin")
    assert bytes_of(tmp_path / "sent") == bytes_of(tmp_path / "shared")
    assert sorted(bytes_of(tmp_path / "sent")) == ["frame=00.png", "frame=05.png", "frame=10.png"]
    assert (tmp_path / "sent" / "frame=10.png").read_bytes() == (tmp_path / "a.png").read_bytes()
    assert run(sent, client).found == 3


# Workers are killed ---------------------------------------------------------------------------------


def killer(kills: int, pids: list[int]) -> Callable[[Task, Result], None]:
    """Kills the process of a task that is done, which has begun the next one, at random."""
    dice = random.Random(13)

    def note(_task: Task, result: Result) -> None:
        assert result.record is not None, result.wrong
        pid = int(result.record.worker.rpartition("-")[2])
        if pid not in pids and len(pids) < kills and dice.random() < 0.5:
            os.kill(pid, signal.SIGKILL)
            pids.append(pid)

    return note


def test_killed_workers_lose_nothing_and_nothing_is_done_twice(client: Client, tmp_path: Path) -> None:
    count, kills = 30, 3
    killed: list[int] = []
    done = run(plan_of(tmp_path / "a", f"{SCALE}=0.01:0.3:{count}"), client, note=killer(kills, killed))
    assert len(killed) == kills and done.failed == {}
    assert len(done.records) == len(bytes_of(tmp_path / "a")) == count
    assert events(tmp_path / "a", "end") == Counter(done.records.keys())  # each once
    began = events(tmp_path / "a", "begin")
    assert sum(began.values()) - count <= kills  # again only what was being rendered
    for name, record in done.records.items():
        assert records.find(tmp_path / "a", name, record.identity) == record


def test_a_worker_may_be_slow_to_come_back() -> None:
    """On a busy machine its start took more than the 15 s of Dask, which then gave it up: the sweep waited for ever."""
    with dask.config.set({"distributed.deploy.lost-worker-timeout": "0.1 s"}), cluster(workers=1) as client:
        pid = client.submit(os.getpid, pure=False).result(timeout=LONG)
        os.kill(pid, signal.SIGKILL)
        # One that is given up may come back for a moment, so this takes longer.
        client.submit(time.sleep, 3).result(timeout=LONG)


# The command ----------------------------------------------------------------------------------------


def start(*words: object) -> subprocess.Popen[str]:
    """In a session of its own: its workers can be killed with it."""
    environment = {**os.environ, "PYTHONPATH": str(PROGRAM.parent / "python")}
    return subprocess.Popen([sys.executable, "-m", "kage.sweep", *map(str, words)], env=environment, text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True,
                            preexec_fn=restore_signals)


def command(*words: object) -> tuple[int, str, str]:
    process = start(*words)
    out, err = process.communicate(timeout=LONG)
    return process.returncode, out, err


def wait_for(condition: Callable[[], bool], process: subprocess.Popen[str]) -> None:
    end = time.monotonic() + LONG
    while not condition():
        assert process.poll() is None and time.monotonic() < end, process.communicate()[1]
        time.sleep(0.02)


def test_a_killed_sweep_goes_on_where_it_was(client: Client, tmp_path: Path) -> None:
    """Killed with its workers, then begun again by a scheduler's workers; and compared with one that ran through."""
    words = [CUBE, "--vary", f"{SCALE}=0.01:0.3:24", "--size", "128x96"]
    process = start(*words, "--workers", 2, "--out", tmp_path / "a")
    wait_for(lambda: len(events(tmp_path / "a", "end")) >= 4, process)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    before = {name for name in events(tmp_path / "a", "end") if records.path_of(tmp_path / "a", name).exists()}
    assert 4 <= len(before) < 24
    status, out, err = command(*words, "--scheduler", client.scheduler.address, "--out", tmp_path / "a")
    assert (status, err) == (0, "") and "24 pictures" in out
    ended, began = events(tmp_path / "a", "end"), events(tmp_path / "a", "begin")
    assert len(ended) == 24 and set(ended.values()) == {1}
    assert all(began[name] == 1 for name in before) and sum(began.values()) <= 26


def test_ctrl_c_says_how_to_go_on(tmp_path: Path) -> None:
    process = start(CUBE, "--vary", f"{SCALE}=0.01:0.3:1000", "--size", "160x120", "--workers", 1, "--out", tmp_path)
    wait_for(lambda: len(events(tmp_path, "end")) >= 2, process)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to all processes
    out, err = process.communicate(timeout=LONG)
    assert (process.returncode, out) == (130, "")
    assert err.strip() == "kage.sweep: interrupted; the same command goes on from here"
    assert 2 <= len(json.loads((tmp_path / "index.json").read_text())["pictures"]) == 1000


def test_ctrl_c_is_not_dropped(client: Client, tmp_path: Path) -> None:
    """On a busy machine it came within the __del__ of a future, and the sweep went on to its end."""
    class Dropped:
        def __del__(self) -> None:
            seen.append(0)
            raise KeyboardInterrupt

    def note(_task: Task, _result: Result) -> None:
        if not seen:
            Dropped()

    seen: list[int] = []
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # it may be ignored, as nohup has it
    try:
        with pytest.raises(KeyboardInterrupt):
            run(plan_of(tmp_path, f"{SCALE}=0.01:0.3:1000"), client, note=note)
    finally:
        signal.signal(signal.SIGINT, before)
    assert len(seen) == 1 and len(events(tmp_path, "end")) < 1000


@pytest.mark.parametrize(("words", "status", "says"), [
    (["--vary", "a"], 2, "--vary a: expected PATH="),
    (["--set", "objects.grund.color=1"], 2, "did you mean 'ground'?"),
    (["--set", "a"], 2, "--set a: expected PATH=VALUE"),
    (["--keys", "none.yaml"], 2, "none.yaml: can't be read"),
    (["--scheduler", "nonsense://"], 1, "nonsense://: no scheduler answers"),
    (["--size", "12"], 2, "expected WIDTHxHEIGHT"),
    (["--workers", "0"], 2, "--workers: expected 1 or more"),
])
def test_what_is_wrong_is_told(words: list[str], status: int, says: str, tmp_path: Path,
                               capsys: pytest.CaptureFixture[str]) -> None:
    try:
        found = main([str(CUBE), "--out", str(tmp_path), *words])
    except SystemExit as error:  # of argparse
        found = int(str(error.code))
    assert found == status and says in capsys.readouterr().err


# docs/sweep.md ---------------------------------------------------------------------------------------


def test_the_examples_of_the_page(client: Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                  capsys: pytest.CaptureFixture[str]) -> None:
    """In Python, with this cluster in place of the reader's, and smaller; and the keys of the film."""
    page = (TOP / "docs" / "sweep.md").read_text()
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenes").symlink_to(TOP / "scenes")
    (block,) = re.findall(r"^```python\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    monkeypatch.setattr("distributed.Client", lambda _: client)
    exec(compile(block.replace("320, 240", "32, 24"), "docs/sweep.md", "exec"), {})  # noqa: S102 - our own
    assert capsys.readouterr().out.splitlines()[-1] == "4 0 {}"
    (keys,) = re.findall(r"^```yaml\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    made = plan_of(tmp_path / "film", "frame=0:47:48", keys=Keys.parse(keys))
    assert len(made.pictures) == 48
