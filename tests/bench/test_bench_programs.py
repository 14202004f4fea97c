"""Running what the bench measures, and reading what it prints. No claim about speed is tested here."""

from __future__ import annotations

import os
import platform
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from PIL import Image

from bench import cost, plan, programs
from tests.conftest import PROGRAM, TOP

needs_povray = pytest.mark.skipif(not shutil.which("povray"), reason="no povray")

# What the programs print --------------------------------------------------------------------------

KAGE_TEXT = """\
render        88.67 ms     42.76 ns a sample    46.77 Mrays/s (camera, shadow)
  camera       4.67 ms      2.25 ns a sample    5.3 %
  bump        16.53 ms    107.97 ns a sample   18.6 %
output       122.55 ms
camera rays 2073600, shadow rays 2073599, height look-ups 1705798
bumped samples 1705790 by method 2, fell back 12 (0.001 %); by order  0: 12  2: 1705778
"""

CHECK_TEXT = """\
scenes/waves.yaml: 640 x 480 pixels, 1 x 1 samples each, shadow 0
light lamp at -4, 5, -2.5
object ground: plane, material clay, bump by function
    P         from -0.045 to 0.045 scene units (bounds)
    slope     median 0.145, 95 % below 0.291, steepest 0.347 (where the camera sees it)
object cube: box, material blue
1 warning
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
    assert programs.parse_kage(KAGE_TEXT) == {"render": 42.76, "camera": 2.25, "bump": 107.97}


def test_kage_stats_need_not_come_first() -> None:
    assert programs.parse_kage("a warning\n" + KAGE_TEXT.replace("a sample", "a pixel"))["render"] == 42.76


def test_kage_counts() -> None:
    assert programs.parse_counts(KAGE_TEXT) == {"rays": 2073600, "shadow_rays": 2073599, "lookups": 1705798,
                                                "bumped": 1705790,
                                                "fell_back": 12}


def test_kage_check() -> None:
    assert programs.parse_check(CHECK_TEXT) == {"light": "lamp", "at": (-4, 5, -2.5), "receiver": "ground",
                                                "casters": ("cube",), "slope_median": 0.145,
                                                "slope_95": 0.291}


def test_povray_times() -> None:
    assert programs.parse_povray(POVRAY_TEXT) == {"parse": 0.037, "trace": 64.062}


def test_fused_kernel() -> None:
    assert programs.parse_fused(FUSED_TEXT) == {"none": 22.09, "0": 22.28, "1": 22.71}


def test_embree_loop() -> None:
    told = "G=1 build 0.3 ms\nembree16 130.90 ms 63.13 ns/pixel mean 0.41\n"
    assert programs.parse_embree(told) == {"ns": 63.13, "build_s": 0.0003}


def test_callgrind() -> None:
    assert programs.parse_callgrind("==7== Events    : Ir\n==7== Collected : 17000123\n") == 17000123


@pytest.mark.parametrize(
    ("parse", "text"),
    [
        ("parse_kage", "render took long\n"),
        ("parse_kage", "  camera 1.00 ms 2.00 ns a sample\n"),
        ("parse_counts", "camera rays 1\n"),
        ("parse_check", CHECK_TEXT.replace("light lamp", "lamp")),
        ("parse_check", CHECK_TEXT + "light sun at 0, 1, 0\n"),
        ("parse_povray", "Trace Time: none"),
        ("parse_povray", POVRAY_TEXT.replace("64.062", "0.000")),
        ("parse_fused", "Segmentation fault"),
        ("parse_embree", ""),
        ("parse_callgrind", "Collected : 0"),
        ("compile_line", "/* no line */\nint main(void);\n"),
    ],
)
def test_nonsense_is_an_error(parse: str, text: str) -> None:
    with pytest.raises(programs.MeasureError):
        getattr(programs, parse)(text)


def test_compile_line_is_joined_and_ends_before_the_run() -> None:
    source = "/* It is.\n *\n *   gcc -std=c99 -O3 \\\n *       -fopenmp a.c -o a -lm && ./a THREADS\n */\nint x;\n"
    assert programs.compile_line(source) == ["gcc", "-std=c99", "-O3", "-fopenmp", "a.c", "-o", "a", "-lm"]


@pytest.mark.parametrize("name", ["fused_kernel", "embree_loop", "embree_mesh", "png_decode"])
def test_compile_lines_of_the_yardsticks(name: str) -> None:
    words = programs.compile_line((TOP / "bench" / "limits" / f"{name}.c").read_text())
    assert words[0] == "gcc" and f"{name}.c" in words and words[words.index("-o") + 1] == name


@pytest.mark.skipif(platform.machine() != "x86_64" or not shutil.which("gcc"), reason="needs gcc on x86-64")
def test_the_fused_loop_builds(tmp_path: Path) -> None:
    assert programs.build_limit("fused_kernel", tmp_path).exists()


# Running ------------------------------------------------------------------------------------------


def test_a_failure_tells_the_last_words() -> None:
    with pytest.raises(programs.MeasureError, match="^sh -c 'echo first; echo last; exit 3': status 3: last$"):
        programs.run(["sh", "-c", "echo first; echo last; exit 3"])
    with pytest.raises(programs.MeasureError, match="^no-such-program: No such file"):
        programs.run(["no-such-program"])


def test_peak_memory_is_the_commands_own() -> None:
    """Not that of this process, which is larger than 40 MB."""
    small = programs.peak_memory(["sh", "-c", ":"])
    large = programs.peak_memory([sys.executable, "-c", "b = b'x' * 100_000_000"])
    assert 1e6 < small < 30e6 and 100e6 < large < 150e6
    with pytest.raises(programs.MeasureError):
        programs.peak_memory(["sh", "-c", "exit 1"])


@pytest.mark.skipif(not shutil.which("valgrind"), reason="no valgrind")
def test_instructions_do_not_depend_on_the_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A longer environment moves the stack, and memset takes other steps by the place of an array."""
    command = [PROGRAM, "render", "scenes/waves.yaml", "--shadow", "exact", "--size", "16x16", "--threads", "1",
               "--quiet"]
    counts = set()
    for length in (0, 16, 32, 48):
        monkeypatch.setenv("LONG", "x" * length)
        counts.add(programs.count_instructions([*command, "-o", tmp_path / "a.png"]))
    assert len(counts) == 1


@pytest.mark.skipif(not hasattr(os, "sched_getaffinity"), reason="this system pins no process")
def test_pinned() -> None:
    before = os.sched_getaffinity(0)
    with programs.pinned():
        assert len(os.sched_getaffinity(0)) == 1
    assert os.sched_getaffinity(0) == before


def test_shown_commands_are_for_the_top() -> None:
    assert programs.shown([TOP / "build" / "float" / "kage", "a b"]) == "build/float/kage 'a b'"


# kage and POV-Ray ---------------------------------------------------------------------------------


@needs_povray
def test_both_renderers_show_the_same_scene(tmp_path: Path) -> None:
    """By `none`, which is what POV-Ray does, the pictures differ only in how the slopes between texels are taken."""
    kage, povray = tmp_path / "kage.png", tmp_path / "povray.png"
    programs.run([PROGRAM, "render", "scenes/cube.yaml", "--shadow", "none", "--size", "320x180", "--quiet", "-o",
                  kage])
    programs.run(["povray", "+Ibench/cube_bump_map.pov", "+W320", "+H180", "-A", "-D", "-P", "-V", f"+O{povray}"])
    a, b = (np.asarray(Image.open(path).convert("RGB"), dtype=float) for path in (kage, povray))
    difference = np.abs(a - b).max(axis=2)
    assert difference.mean() < 2  # of 255
    assert np.mean(difference > 10) < 0.005


@needs_povray
def test_height_field_is_the_displaced_surface(tmp_path: Path) -> None:
    """POV-Ray's triangles between the samples are not kage's bilinear patches, and end at the map's edge."""
    kage, povray = tmp_path / "kage.png", tmp_path / "povray.png"
    programs.run([PROGRAM, "render", "scenes/cube.yaml", "--surface", "displaced", "--size", "320x240", "--quiet", "-o",
                  kage])
    programs.run(["povray", "+Ibench/cube_height_field.pov", "+W320", "+H240", "-A", "-D", "-P", "-V", f"+O{povray}"])
    a, b = (np.asarray(Image.open(path).convert("RGB"), dtype=float)[40:] for path in (kage, povray))
    difference = np.abs(a - b).max(axis=2)
    assert difference.mean() < 1  # of 255
    assert np.mean(difference > 30) < 0.005


def test_a_coarse_mesh_is_not_measured(tmp_path: Path) -> None:
    """POV-Ray would show another surface than the scene's."""
    kage, made = tmp_path / "kage", tmp_path / "out" / "a.pov"
    kage.write_text(f"#!/bin/sh\ntouch {made}\necho 'kage: object ground: coarse mesh: heights are off by up to 0.1, 9 "
                    f"pixels' >&2\n")
    kage.chmod(0o755)
    bench, scene = SimpleNamespace(kage=kage), SimpleNamespace(name="cube", file=Path("cube.yaml"))
    with pytest.raises(programs.MeasureError, match="cube: POV-Ray would show another surface: .*coarse mesh"):
        cost.export(cast("Any", bench), cast("Any", scene), (4, 3), True, made)
    assert not made.exists()


@pytest.mark.parametrize(("name", "options"), [
    ("none", "--shadow none"), ("2 bare", "--shadow 2 --no-guard"), ("auto:1", "--shadow auto:1"),
    ("march:8 shifted", "--shadow march:8 --shade shifted"),
    ("march:8 shifted, own 24", "--shadow march:8 --shade shifted --bump-shadow march:24"),
    ("0, own horizon", "--shadow 0 --bump-shadow horizon"),
    ("exact shifted, own exact", "--shadow exact --shade shifted --bump-shadow exact"),
    ("relief", "--relief"), ("displaced", "--surface displaced"),
])
def test_options_of_methods_and_variants(name: str, options: str) -> None:
    assert programs.method_options(name) == tuple(options.split())


@pytest.mark.parametrize("name", ["", "0 shiny", "0 shifted own 8", "0 shifted, own"])
def test_no_variant(name: str) -> None:
    with pytest.raises(ValueError, match="is no method, expected METHOD"):
        programs.method_options(name)


def test_kage_knows_the_variants(tmp_path: Path) -> None:
    """All but those of methods that this program has not."""
    known = programs.run([PROGRAM, "methods"])
    for name in (*plan.METHODS, *plan.VARIANTS):
        if not name.startswith("auto") or "auto" in known:
            programs.run([PROGRAM, "render", "scenes/waves.yaml", *programs.method_options(name), "--size", "8x6",
                          "--quiet", "-o", tmp_path / "a.png"])
