"""bumpshadow.h as others will use it: alone, in C99 and C++17, in float and double, and in a loop that becomes SIMD."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.conftest import TOP

SRC = TOP / "include"
WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Wdouble-promotion", "-Wundef", "-Werror"]
FLAGS = ["-O3", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off"]
COMPILERS = [("gcc", "c99"), ("clang", "c99"), ("g++", "c++17"), ("clang++", "c++17")]

PROGRAM = r"""
#include "bumpshadow.h"
#include <stdio.h>

static bs_vec3 vec(double x, double y, double z)
{
    bs_vec3 v;
    v.x = (bs_real)x, v.y = (bs_real)y, v.z = (bs_real)z;
    return v;
}

/* The place to shade, and from there a march and a horizon towards a light. */
static void relief(bs_view v, bs_slab slab, bs_vec3 n, bs_vec3 Qu, bs_vec3 Qw)
{
    bs_place q = bs_place_of(v, (bs_real).5, (bs_real).25, slab.front);
    bs_view d = bs_view_of(vec(-.3, 1, .6), n, Qu, Qw);
    bs_bump there = {(bs_real).03, (bs_real).1, (bs_real)-.2, 0, 0, 0};
    bs_real left = bs_residual(v, (bs_real).3, slab.front, there);
    printf("%a %a %a\n", (double)q.u, (double)q.w, (double)bs_pixels(Qu, vec(-.3, 1, .6), (bs_real).01, left));
    for (int side = -1; side <= 1; side += 2) {
        bs_way y = bs_way_of((bs_real)side, d, (bs_real)-.2, (bs_real).04, (bs_real)-.1, (bs_real).2);
        int dark = 0;
        for (int i = 1; i <= 5; i++)
            dark += bs_way_below(y, bs_way_step(y.end, i, 5), (bs_real)(.04 + .03 * i * side));
        printf("%a %d\n", (double)y.end, dark);
    }
    for (int k = 0; k < 4; k++) {
        bs_view way = {d.sn, k & 1 ? d.a : -d.a, k & 2 ? d.b : -d.b};
        bs_bearing g = bs_bearing_of(way, 40, 30);
        bs_real above = g.rise - bs_horizon((bs_real).001, (bs_real).004, (bs_real).25);
        bs_real share = bs_horizon_share(above, (bs_real).01, (bs_real)-.004, (bs_real)1e-6);
        printf("%a %a %a\n", (double)g.bearing, (double)g.rise, (double)share);
    }
}

int main(void)
{
    bs_vec3 Qu = vec(1, .2, 0), Qw = vec(.1, .3, -1.2), z = vec(.1, .2, .3), s = vec(.3, -1, .4), n = bs_normal(Qu, Qw);
    bs_vec3 np = bs_perturbed_normal(n, Qu, Qw, (bs_real).2, (bs_real)-.1);
    bs_view v = bs_view_of(s, n, Qu, Qw);
    bs_bump p = {(bs_real).04, (bs_real).2, (bs_real)-.1, (bs_real).3, (bs_real).2, (bs_real)-.4};
    bs_slab slab = bs_slab_of(v, (bs_real)-.1, (bs_real).2);
    printf("%a %a %a %d\n", (double)np.x, (double)np.y, (double)np.z, bs_regular(n, Qu, Qw));
    for (int guard = 0; guard < 2; guard++)
        for (int order = 0; order < 4; order++) {
            bs_shift t = bs_shift_of(order, guard, v, bs_curvature(v, n, z, z, z), p, slab);
            printf("%a %d\n", (double)t.tau, t.order);
        }
    bs_march m = bs_march_start(slab);
    for (int i = 0; i <= 5; i++) {
        bs_real t = bs_march_tau(slab, i, 5);
        m = bs_march_step(m, t, bs_gap(v, 0, t, p.P + p.Pu * v.a * t), v);
    }
    printf("%a %d\n", (double)m.tau, m.found);
    for (int k = 0; k < 3; k++) { /* no bound above, none below, none at all */
        bs_real low = k ? (bs_real)-INFINITY : (bs_real)-.1, high = k == 1 ? (bs_real).2 : (bs_real)INFINITY;
        bs_slab endless = bs_slab_of(v, low, high);
        bs_march e = bs_march_start(endless);
        for (int i = 0; i <= 5; i++) {
            bs_real t = bs_march_tau(endless, i, 5);
            e = bs_march_step(e, t, bs_gap(v, 0, t, p.P + p.Pu * v.a * t), v);
            printf("%a ", (double)t);
        }
        printf("%d\n", e.found);
    }
    relief(v, slab, n, Qu, Qw);
    return 0;
}
"""

LOOP = """
#include "bumpshadow.h"
void shift(int n, const float *restrict sn, const float *restrict a, const float *restrict b, const float *restrict P,
           const float *restrict Pu, const float *restrict Pw, const float *restrict Puu, const float *restrict Pww,
           float *restrict tau);
void shift(int n, const float *restrict sn, const float *restrict a, const float *restrict b, const float *restrict P,
           const float *restrict Pu, const float *restrict Pw, const float *restrict Puu, const float *restrict Pww,
           float *restrict tau)
{
    for (int i = 0; i < n; i++) {
        bs_view v = {sn[i], a[i], b[i]};
        bs_bump p = {P[i], Pu[i], Pw[i], Puu[i], 0, Pww[i]};
        tau[i] = bs_shift_of(ORDER, 1, v, 0, p, bs_slab_of(v, -1, 1)).tau;
    }
}
"""


MARCH = """
#include "bumpshadow.h"
void march(int n, const float *restrict sn, const float *restrict a, const float *restrict b, const float *restrict P,
           const float *restrict P_on_the_way, int *restrict dark);
void march(int n, const float *restrict sn, const float *restrict a, const float *restrict b, const float *restrict P,
           const float *restrict P_on_the_way, int *restrict dark)
{
    for (int i = 0; i < n; i++) {
        bs_view d = {sn[i], a[i], b[i]};
        bs_way y = bs_way_of(1, d, -0.5f, P[i], -1, 1);
        dark[i] |= bs_way_below(y, bs_way_step(y.end, STEP, 8), P_on_the_way[i]);
    }
}
"""

HORIZON = """
#include "bumpshadow.h"
void horizon(int n, const float *restrict sn, const float *restrict a, const float *restrict b,
             const float *restrict at_k, const float *restrict at_next, float *restrict share);
void horizon(int n, const float *restrict sn, const float *restrict a, const float *restrict b,
             const float *restrict at_k, const float *restrict at_next, float *restrict share)
{
    for (int i = 0; i < n; i++) {
        bs_view d = {sn[i], a[i], b[i]};
        bs_bearing g = bs_bearing_of(d, 40, 40);
        float part = 2 * g.bearing, fraction = part - (float)(int)part;
        share[i] = bs_horizon_share(g.rise - bs_horizon(at_k[i], at_next[i], fraction), 0.1f, 0.2f, 1e-6f);
    }
}
"""

def run(compiler: str, standard: str, tmp_path: Path, real: list[str]) -> str:
    source = tmp_path / ("main.cpp" if "++" in compiler else "main.c")
    source.write_text(PROGRAM)
    program = tmp_path / "program"
    command = [compiler, f"-std={standard}", *WARNINGS, *FLAGS, *real, f"-I{SRC}", source, "-o", program, "-lm"]
    subprocess.run(command, check=True, timeout=120)
    return subprocess.run([program], check=True, capture_output=True, text=True, timeout=10).stdout


@pytest.mark.parametrize("real", [[], ["-DBS_DOUBLE"]], ids=["float", "double"])
@pytest.mark.parametrize("compiler, standard", COMPILERS[1:])
def test_alike_in_every_language(compiler: str, standard: str, real: list[str], tmp_path: Path) -> None:
    """No warning, and to the bit the numbers of gcc's C99."""
    if not shutil.which(compiler):
        pytest.skip(f"{compiler} is not installed")
    want = run("gcc", "c99", tmp_path, real)
    assert want.count("\n") == 13 + 7 and "nan" not in want and "inf" not in want
    assert [line[-1] for line in want.splitlines()[9:13]] == ["1", "0", "0", "0"]  # what the marches found
    assert run(compiler, standard, tmp_path, real) == want


LOOPS = {**{f"order {order}": (LOOP, f"-DORDER={order}") for order in range(4)},
         "march": (MARCH, "-DSTEP=3"), "horizon": (HORIZON, "-DSTEP=0")}


@pytest.mark.parametrize("name", LOOPS)
def test_vectorises(name: str, tmp_path: Path) -> None:
    source = tmp_path / "loop.c"
    text, constant = LOOPS[name]
    source.write_text(text)
    command = ["gcc", "-std=c99", *FLAGS, "-fopt-info-vec", constant, f"-I{SRC}", "-c", source, "-o",
               tmp_path / "loop.o"]
    told = subprocess.run(command, check=True, capture_output=True, text=True, timeout=120).stderr
    assert re.search(r"loop vectorized using 16 byte vectors", told), told


def test_depends_on_nothing() -> None:
    """The one inclusion is <math.h>, for sqrt."""
    assert re.findall(r"#include\s+(\S+)", (SRC / "bumpshadow.h").read_text()) == ["<math.h>"]
