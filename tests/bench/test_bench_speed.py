"""`make speed`: how it measures, judges and reports. No claim about speed is tested here."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from bench.callgrind import Function
from bench.programs import MeasureError
from bench.readme import ReadmeError
from bench.speed import __main__ as program
from bench.speed import inputs, pages, parts, plan, stages, verdicts
from bench.speed.plan import Bound, Level
from bench.speed.rounds import Job, Results, launch, milliseconds, run
from tests.conftest import PROGRAM, TOP

KAGE_TEXT = """\
render        88.67 ms     42.76 ns a sample    46.77 Mrays/s (camera, shadow)
  bump        16.53 ms    107.97 ns a sample   18.6 %
output       122.55 ms
camera rays 2073600, shadow rays 2073599, height look-ups 1705798
render        80.00 ms     42.76 ns a sample    46.77 Mrays/s (camera, shadow)
  bump        17.00 ms    107.97 ns a sample   18.6 %
output       130.00 ms
"""

PERF_TEXT = """\
# Samples: 1K of event 'cpu-clock:ppp'
    40.50%  kage                 [.] map_interpolate.arch_x86_64_v3
     2.50%  kage                 [.] map_interpolate.default
     7.00%  libz.so.1.2.13       [.] 0x0000000000004a26
     1.00%  libz.so.1.2.13       [.] 0x0000000000004a27
     2.00%  [kernel.kallsyms]    [k] clear_page_erms
"""

TINY = Level("tiny", 2, 1, 1, (96, 56), (192, 108), (16, 32), 32, (12, 6), (20, 10), (2, 20), (128, 128), 2, False,
             (16, 16), 1)


# Running and timing -------------------------------------------------------------------------------


def test_the_least_time_of_several_runs() -> None:
    assert milliseconds(KAGE_TEXT) == {"render": 80.0, "bump": 16.53, "output": 122.55}


def test_a_command_is_measured() -> None:
    source = "import sys, time; x = bytearray(60_000_000); time.sleep(0.05); print('out'); " \
             "print('err', file=sys.stderr)"
    found = launch([sys.executable, "-c", source], 2)
    assert len(found.seconds) == len(found.cpu) == 2 and min(found.seconds) >= 0.05
    assert found.memory > 60_000_000
    assert found.text.count("out") == found.text.count("err") == 2
    if Path("/proc/self/io").exists():
        assert found.moved["written_bytes"] >= len("out\nerr\n")


@pytest.mark.parametrize(("command", "message"), [
    (["/nowhere/kage"], "/nowhere/kage"),
    ([sys.executable, "-c", "import sys; sys.exit('no such scene')"], "status 1: no such scene"),
])
def test_a_command_that_fails_is_an_error(command: list[str], message: str) -> None:
    with pytest.raises(MeasureError, match=message):
        launch(command)


def test_rounds_go_back_and_forth_and_a_failure_is_not_repeated() -> None:
    order: list[str] = []

    def work(name: str) -> dict[str, float]:
        order.append(name)
        if name == "bad":
            raise MeasureError("it broke")
        return {"s": float(len(order))}

    jobs = [Job(name, "exr", lambda name=name: work(name), rounds) for name, rounds in
            (("a", 3), ("bad", 3), ("b", 2))]
    results = run(jobs, [].append)
    assert order == ["a", "bad", "b", "b", "a", "a"]
    assert results.missing == {"bad": "it broke"} and results.values == {"a: s": [1, 5, 6], "b: s": [3, 4]}


# Judging ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("values", "limit", "at_least", "expected"), [
    ([0.9, 1.0, 0.8], 1.0, False, "met"), ([1.1, 1.2, 1.3], 1.0, False, "missed"),
    ([0.9, 1.0, 1.3], 1.0, False, "undecided"), ([1.9, 2.0, 2.1], 1.9, True, "met"),
    ([1.5, 1.6, 1.8], 1.9, True, "missed"), ([1.5, 1.9, 2.0], 1.9, True, "undecided"), ([], 1.0, False, "not measured"),
])
def test_verdicts(values: list[float], limit: float, at_least: bool, expected: str) -> None:
    results = Results({"a: s": values, "b: s": [1.0] * len(values)})
    for under in (None, "b: s"):
        bound = Bound("exr", "what", "a: s", under, limit, "s", at_least)
        assert verdicts.judge(results, [bound])[0].verdict == expected


def test_ratios_are_those_of_each_round() -> None:
    """A machine that is ten times as slow in one round gives the same ratio."""
    found = Results({"a: s": [2, 20, 2], "b: s": [1, 10, 1]}).ratio("a: s", "b: s")
    assert found and found["median"] == found["low"] == found["high"] == 2


def test_each_bound_of_the_levels_is_of_a_job(tmp_path: Path) -> None:
    about = plan.About(PROGRAM, tmp_path, TINY)
    jobs, missing = parts.jobs(about, plan.PARTS)
    assert not missing
    names = {job.name for job in jobs}
    for bound in plan.bounds(TINY):
        for key in filter(None, (bound.over, bound.under)):
            assert key.rpartition(": ")[0] in names, key


def test_memory_of_a_sample() -> None:
    results = Results({"map 16: memory": [1000.0, 1100.0], "map 32: memory": [1000 + 768 * 6, 1100 + 768 * 6]})
    parts.sample_bytes(TINY, results)
    assert results.values["map 32: sample_bytes"] == [6, 6]


def test_a_missing_peer_leaves_the_rest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(name: str, folder: Path) -> Path:
        raise MeasureError(f"{name}: no compiler")

    monkeypatch.setattr(parts.programs, "build_limit", fail)
    monkeypatch.setattr(parts.programs, "has_povray", lambda: False)
    jobs, missing = parts.jobs(plan.About(PROGRAM, tmp_path, TINY), ("trace", "peers", "maps"))
    assert set(missing) == {"trace, fused", "peers, povray", "maps, decoders"}
    assert {"kage none", "kage none, whole", "map 16"} <= {job.name for job in jobs}


# Inputs -------------------------------------------------------------------------------------------


def test_maps(tmp_path: Path) -> None:
    inputs.map_scene(tmp_path, 64, "png")
    with Image.open(tmp_path / "map64.png") as image:
        assert image.mode == "I;16" and image.size == (64, 64)
        values = np.asarray(image)
    assert values.min() > 0 and values.max() < 65535 and values.std() > 3000


def test_the_mesh_is_closed(tmp_path: Path) -> None:
    """Each edge is between two triangles, once in each direction; those at the poles may have no area."""
    raw = inputs.mesh(tmp_path, (8, 5)).read_bytes()
    head, _, body = raw.partition(b"end_header\n")
    assert b"element vertex 48\n" in head and b"element face 80\n" in head
    faces = np.frombuffer(body[48 * 12:], dtype=[("count", "u1"), ("index", "<i4", 3)])
    assert len(faces) == 80 and (faces["count"] == 3).all()
    edges = [tuple(edge) for a, b, c in faces["index"] for edge in ((a, b), (b, c), (c, a))]
    assert len(edges) == len(set(edges))
    inner = [(a, b) for a, b in edges if (b, a) not in edges]
    assert all(a // 8 in (0, 5) and b // 8 == a // 8 for a, b in inner)


def test_a_file_is_made_once_and_its_text_renewed(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    calls: list[Path] = []
    for _ in range(2):
        inputs.made(path, lambda to: (calls.append(to), to.write_text("one")))
    assert len(calls) == 1 and path.read_text() == "one"
    inputs.text_file(path, "two")
    assert path.read_text() == "two" and [one.name for one in tmp_path.iterdir()] == ["a.yaml"]


# Stages -------------------------------------------------------------------------------------------


def test_perf_is_read() -> None:
    event, found = stages.parse_perf(PERF_TEXT)
    assert event == "cpu-clock" and stages.parse_perf("nothing") == ("", {})
    assert found == pytest.approx({"map_interpolate": 0.43, "libz.so.1.2.13": 0.08, "[kernel.kallsyms]": 0.02})


@pytest.mark.parametrize(("name", "stage"), [
    ("diffuse_to.arch_x86_64_v3", "diffuse_to"), ("pick.default", "pick"), ("walk.constprop.0", "walk"),
    ("f.part.0.isra.1", "f"), ("box_hit", "box_hit"), ("default_of", "default_of")])
def test_stages_have_no_level(name: str, stage: str) -> None:
    assert stages.stage_name(name) == stage


def test_stages_are_summed_and_small_ones_together() -> None:
    counts = {Function("kage", "a.default"): {"Ir": 500, "Dr": 3, "Dw": 1, "D1mr": 1, "D1mw": 0, "DLmr": 1, "DLmw": 0},
              Function("kage", "a.avx2"): {"Ir": 490, "Dr": 1, "Dw": 0, "D1mr": 0, "D1mw": 1, "DLmr": 0, "DLmw": 0},
              Function("kage", "b"): {"Ir": 5, "Dr": 0, "Dw": 0, "D1mr": 0, "D1mw": 0, "DLmr": 0, "DLmw": 0},
              Function("libc.so.6", "c"): {"Ir": 5, "Dr": 0, "Dw": 5, "D1mr": 0, "D1mw": 0, "DLmr": 0, "DLmw": 0}}
    found = stages.table("x", stages.summed(counts), 10, "cpu-clock", {"a": 0.45, "b": 0.05, "z": 0.5})
    assert found.rows == [stages.Row("a", 99, 0.5, 0.2, 0.1, pytest.approx(0.9)),
                          stages.Row("b", 0.5, 0, 0, 0, pytest.approx(0.1)),
                          stages.Row(stages.OTHERS, 0.5, 0.5, 0, 0, 0)]
    assert stages.table("x", stages.summed(counts), 10, "cpu-clock", {"z": 1}).event == ""


# The report ---------------------------------------------------------------------------------------


def judged(verdict: str = "met") -> verdicts.Judged:
    bound = Bound("large", "memory & more", "large: memory", None, 2 * plan.GIB, "bytes")
    found = {"median": plan.GIB, "low": plan.GIB, "high": 1.5 * plan.GIB, "n": 3}
    return verdicts.Judged(bound, found, verdict)


def test_pages() -> None:
    found = [pages.bounds_table([judged()])]
    row = "| large: memory & more | 1 (1 to 1.5) | at most 2 GiB | met |"
    assert row in pages.markdown("t", "about", found)
    assert '<td>large: memory &amp; more</td>' in pages.page("t", "about", found)
    assert '<td class="met">met</td>' in pages.page("t", "about", found)
    assert "large: memory & more  1 (1 to 1.5)  at most 2 GiB  met" in list(pages.columns(found[0]))


def test_peers_are_compared_round_by_round() -> None:
    values = {"POV-Ray smooth: ns": [100.0, 900.0], "kage none, whole: ns": [10.0, 90.0], "embree mesh: ns": [1.0]}
    assert pages.peers_table(Results(values)).rows == [("POV-Ray smooth", "trace", "kage bump only", "10")]


def test_docs_get_the_bounds() -> None:
    text = "a\n<!-- bench:speed -->\nold\n<!-- /bench:speed -->\nb\n"
    new = pages.docs(text, "machine, date.", [judged("missed")])
    assert "old" not in new and "machine, date.\n\n| bound" in new and "| missed |" in new and new.endswith("b\n")
    with pytest.raises(ReadmeError):
        pages.docs("no place", "x", [judged()])
    assert pages.docs((TOP / pages.DOCS).read_text(), "x", [judged()])


# The program --------------------------------------------------------------------------------------


def speed(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "bench.speed", *map(str, arguments)], cwd=TOP, text=True,
                          capture_output=True)


def test_wrong_options() -> None:
    assert "expected some of trace," in speed("--only", "exr,nonsense", "--kage", PROGRAM).stderr
    assert speed("--only", "nonsense", "--kage", PROGRAM).returncode == 2
    assert speed("--kage", "/nowhere").returncode == 2


def test_all_parts_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """At a tiny size; what is not installed is named, and the rest is there."""
    monkeypatch.setitem(plan.LEVELS, "tiny", TINY)
    status = program.main(["--level", "tiny", "--out", str(tmp_path), "--kage", str(PROGRAM)])
    said = capsys.readouterr()
    report = json.loads((tmp_path / "report.json").read_text())
    assert (status == 0) == (not report["missing"]), said.err
    absent = {"peers, povray": "povray", "stages, figure 5's scene by bump only": "valgrind"}
    assert set(report["missing"]) == {name for name, needed in absent.items() if not shutil.which(needed)}
    verdict = {one["verdict"] for one in report["bounds"]}
    assert verdict <= {"met", "missed", "undecided"} and len(report["bounds"]) == len(plan.bounds(TINY))
    for one in report["bounds"]:
        assert one["bound"]["what"] in said.out and one["bound"]["what"] in (tmp_path / "report.md").read_text()
    assert (tmp_path / "index.html").read_text().startswith("<!doctype html>")
    if shutil.which("valgrind"):
        rows = report["stages"][0]["rows"]
        assert rows[-1]["stage"] == stages.OTHERS and any(row["instructions"] > 1 for row in rows)
