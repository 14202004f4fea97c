"""bench/speed.py: what it reads, what it reckons, and a small run of it. No claim about speed is tested here."""

from __future__ import annotations

import argparse
import importlib.util
import json
import platform
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from PIL import Image

TOP = Path(__file__).resolve().parent.parent
SPEED = TOP / "bench" / "speed.py"
KAGE = TOP / "build" / "float" / "kage"


def load() -> ModuleType:
    """bench/ is no package."""
    spec = importlib.util.spec_from_file_location("speed", SPEED)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules["speed"] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


speed = load()
needs_kage = pytest.mark.skipif(not KAGE.exists(), reason="build/float/kage is not built")
needs_povray = pytest.mark.skipif(not shutil.which("povray"), reason="no povray")

# What the programs print --------------------------------------------------------------------------

KAGE_TEXT = """\
render        88.67 ms     42.76 ns a sample    46.77 Mrays/s (camera and shadow)
  camera       4.67 ms      2.25 ns a sample    5.3 %
  bump        16.53 ms    107.97 ns a sample   18.6 %
output       122.55 ms
camera rays 2073600, shadow rays 2073600, height look-ups 1705798
"""

POVRAY_TEXT = """\
POV-Ray is based on DKBTrace 2.12 by David K. Buck & Aaron A. Collins
    Primary Developers: Trace Time: 1 seconds
  Parse Time:       0 hours  0 minutes  0 seconds (0.037 seconds)
Render Time:
  Photon Time:      No photons
  Trace Time:       0 hours  1 minutes  4 seconds (64.062 seconds)
              using 1 thread(s) with 63.626 CPU-seconds total
"""

FUSED_TEXT = """\
order -1  45.80 ms  22.09 ns/pixel  45.3 Mpix/s
order 0  46.20 ms  22.28 ns/pixel  44.9 Mpix/s
order 1  47.10 ms  22.71 ns/pixel  44.0 Mpix/s
0.50123
"""


def test_kage_stats() -> None:
    assert speed.parse_kage(KAGE_TEXT) == {"render": 42.76, "camera": 2.25, "bump": 107.97}


def test_kage_stats_need_not_come_first() -> None:
    assert speed.parse_kage("a warning\n" + KAGE_TEXT.replace("a sample", "a pixel"))["render"] == 42.76


def test_povray_trace_time() -> None:
    assert speed.parse_povray(POVRAY_TEXT) == 64.062


def test_fused_kernel() -> None:
    assert speed.parse_fused(FUSED_TEXT) == {"fused loop none": 22.09, "fused loop 0": 22.28, "fused loop 1": 22.71}


def test_embree_loop() -> None:
    assert speed.parse_embree("G=1 build 0.3 ms\nembree16 130.90 ms 63.13 ns/pixel mean 0.41\n") == 63.13


def test_callgrind() -> None:
    assert speed.parse_callgrind("==7== Events    : Ir\n==7== Collected : 17000123\n") == 17000123


@pytest.mark.parametrize(
    ("parse", "text"),
    [
        ("parse_kage", "render took long\n"),
        ("parse_kage", "  camera 1.00 ms 2.00 ns a sample\n"),
        ("parse_povray", "Trace Time: none"),
        ("parse_fused", "Segmentation fault"),
        ("parse_embree", ""),
        ("parse_callgrind", "Collected : 0"),
        ("compile_line", "/* no line */\nint main(void);\n"),
    ],
)
def test_nonsense_is_an_error(parse: str, text: str) -> None:
    with pytest.raises(speed.MeasureError):
        getattr(speed, parse)(text)


def test_compile_line_is_joined_and_ends_before_the_run() -> None:
    source = "/* It is.\n *\n *   gcc -std=c99 -O3 \\\n *       -fopenmp a.c -o a -lm && ./a THREADS\n */\nint x;\n"
    assert speed.compile_line(source) == ["gcc", "-std=c99", "-O3", "-fopenmp", "a.c", "-o", "a", "-lm"]


@pytest.mark.parametrize("name", ["fused_kernel", "embree_loop"])
def test_compile_lines_of_the_yardsticks(name: str) -> None:
    words = speed.compile_line((TOP / "bench" / "limits" / f"{name}.c").read_text())
    assert words[0] == "gcc" and f"{name}.c" in words and words[words.index("-o") + 1] == name


@pytest.mark.skipif(platform.machine() != "x86_64" or not shutil.which("gcc"), reason="needs gcc on x86-64")
def test_the_fused_loop_builds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(speed, "BUILD", tmp_path)
    assert speed.build_limit("fused_kernel").exists()


# Statistics ---------------------------------------------------------------------------------------


def made_up() -> object:
    """Two rounds of two sweeps; the machine was twice as slow in the second round."""
    samples = speed.Samples()
    for number, slow in enumerate((1, 2)):
        for wobble in (0, 2):
            samples.add(number, "kage none", slow * 10.0)
            samples.add(number, "kage 0", slow * (10.0 + wobble))
        samples.add(number, speed.POVRAY, slow * 440.0)
    return samples


def test_spread() -> None:
    s = speed.spread([5, 1, 4, 2, 3])
    assert (s.median, s.low, s.high, s.quartiles) == (3, 1, 5, (2, 4))


def test_surety_of_a_median_is_counted_in_ranks() -> None:
    assert speed.spread(range(100)).sure == (40, 59)
    assert speed.spread([7]).sure == (7, 7)


def test_rounds_are_medians_of_their_sweeps() -> None:
    assert made_up().rounds("kage 0") == [11, 22]
    assert made_up().all("kage 0") == [10, 12, 20, 24]


def test_ratio_is_taken_within_a_round() -> None:
    s = speed.times_as_fast(made_up(), "kage 0", speed.POVRAY)
    assert (s.median, s.low, s.high) == (40, 40, 40)


def test_added_cost_is_taken_within_a_sweep() -> None:
    s = speed.added_cost(made_up(), "kage 0", "kage none")
    assert (s.median, s.low, s.high) == pytest.approx((10, 0, 20))


def claims(none: float, zero: float, povray: float | None) -> int:
    samples = speed.Samples()
    samples.add(0, "kage none", none)
    samples.add(0, "kage 0", zero)
    if povray:
        samples.add(0, speed.POVRAY, povray)
    return speed.check_claims(samples, {"none": 100.0, "0": 103.0})


@pytest.mark.parametrize(
    ("none", "zero", "povray", "status", "fails"),
    [
        (10, 10.5, 500, 0, 0),
        (10, 10.5, 410, 1, 1),  # order 0 is 39.05 times as fast
        (10, 11, 500, 1, 1),  # 10 % over none
        (10, 11, 390, 1, 3),
        (10, 10.5, None, 3, 0),
        (10, 11, None, 1, 1),
    ],
)
def test_claims(none: float, zero: float, povray: float | None, status: int, fails: int,
                capsys: pytest.CaptureFixture[str]) -> None:
    assert claims(none, zero, povray) == status
    out = capsys.readouterr().out
    assert out.count("FAIL") == fails
    assert out.count("not measured") == (0 if povray else 2)
    assert "instructions +3.0 %" in out


# The command line ---------------------------------------------------------------------------------


def run(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(SPEED), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)


def test_size() -> None:
    assert speed.parse_size("160x120") == (160, 120)


@pytest.mark.parametrize("text", ["", "160", "0x120", "160x", "-1x2", "1e2x3", "160x120x2", "999999x1"])
def test_bad_size(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError):
        speed.parse_size(text)


@pytest.mark.parametrize(
    "arguments", [["--rounds", "0"], ["--sweeps", "-1"], ["--size", "big"], ["--kage", "none"], ["more"]]
)
def test_wrong_usage(arguments: list[str]) -> None:
    done = run(*arguments)
    assert done.returncode == 2 and "speed.py: error: " in done.stderr


def test_help() -> None:
    done = run("--help")
    assert done.returncode == 0 and "status: 0 both claims hold" in done.stdout


# Small runs ---------------------------------------------------------------------------------------


@needs_kage
def test_small_run(tmp_path: Path) -> None:
    small = ("--size", "160x120", "--rounds", 1, "--sweeps", 2, "--without", "limits")
    done = run(*small, "--json", tmp_path / "raw.json")
    assert done.returncode in ((0, 1) if shutil.which("povray") else (1, 3)), done.stderr
    for method in speed.METHODS:
        assert f"\nkage {method} " in done.stdout
    assert "order 0 costs at most 8 % over none" in done.stdout
    raw = json.loads((tmp_path / "raw.json").read_text())
    assert [len(values) for values in raw["ns_per_pixel"]["kage march:4"]] == [2]
    assert raw["about"]["size"] == [160, 120] and raw["about"]["kage"].startswith("kage ")
    assert set(raw["stages_ns_per_pixel"]) == set(speed.METHODS)


@needs_kage
def test_without_povray_the_table_is_there_and_the_status_tells() -> None:
    done = run("--size", "160x120", "--rounds", 1, "--sweeps", 1, "--without", "limits", "--without", "povray")
    assert done.returncode in (1, 3), done.stderr  # 1 where noise made order 0 look dear
    assert "\nkage none " in done.stdout and speed.POVRAY not in done.stdout
    assert done.stdout.count("not measured") == 2


@needs_kage
@needs_povray
def test_both_renderers_show_the_same_scene(tmp_path: Path) -> None:
    """By `none`, which is what POV-Ray does, the pictures differ only in how the slopes between texels are taken."""
    kage, povray = tmp_path / "kage.png", tmp_path / "povray.png"
    speed.run([KAGE, "render", speed.SCENE, "--shadow", "none", "--size", "320x180", "--quiet", "-o", kage])
    speed.run(["povray", f"+I{speed.POV_SCENE}", "+W320", "+H180", "-A", "-D", "-P", "-V", f"+O{povray}"])
    a, b = (np.asarray(Image.open(path).convert("RGB"), dtype=float) for path in (kage, povray))
    difference = np.abs(a - b).max(axis=2)
    assert difference.mean() < 2  # of 255
    assert np.mean(difference > 10) < 0.005
