"""bumpshadow.glsl in a shader against the golden vectors of tests/golden, which were computed with 50 digits.

The bound is that of the header in float, 3e-5 of a number's or vector's size. Where a sum cancels, the size is that of
its terms, as in tests/unit/method. What has no golden vector (march, iter, the turn of a way) is compared with the
header in double. `pytest -s` prints the worst error of each.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache

import numpy as np
import pytest

from scripts import glsl
from tests.conftest import TOP
from tests.support.shaders import Columns, Gpu, Job, Processor, called, functions, gpu

BOUND = 3e-5

RAY = """
    bs_vec3 n = bs_normal(Qu, Qw);
    bs_view v = bs_view_of(s, n, Qu, Qw);
    bs_real curvature = bs_curvature(v, n, Quu, Quw, Qww);
"""
SURFACE = "bs_vec3 Qu, Qw, Quu, Quw, Qww, s;"

ORDERS = Job("orders", f"{SURFACE} bs_real P, Pu, Pw, Puu, Puw, Pww, Pmin, Pmax", """
    bs_vec3 n, np; bs_bool regular; bs_real v.sn, v.a, v.b, curvature, k0.tau, k1.tau, k2.tau, k3.tau;
    int k0.order, k1.order, k2.order, k3.order; bs_real g0.tau, g1.tau, g2.tau, g3.tau;
    int g0.order, g1.order, g2.order, g3.order
""", f"""{RAY}
    bs_bool regular = bs_regular(n, Qu, Qw);
    bs_vec3 np = bs_perturbed_normal(n, Qu, Qw, Pu, Pw);
    bs_bump p = {{P, Pu, Pw, Puu, Puw, Pww}};
    bs_slab endless = {{(bs_real)-INFINITY, (bs_real)INFINITY}}, slab = bs_slab_of(v, Pmin, Pmax);
    bs_shift k0 = bs_shift_of(0, 0, v, 0, p, endless), k1 = bs_shift_of(1, 0, v, 0, p, endless);
    bs_shift k2 = bs_shift_of(2, 0, v, 0, p, endless), k3 = bs_shift_of(3, 0, v, curvature, p, endless);
    bs_shift g0 = bs_shift_of(0, 1, v, 0, p, slab), g1 = bs_shift_of(1, 1, v, 0, p, slab);
    bs_shift g2 = bs_shift_of(2, 1, v, 0, p, slab), g3 = bs_shift_of(3, 1, v, curvature, p, slab);
""")

PLACES = Job("places", f"{SURFACE} bs_vec3 light, rest, Qu1, Qw1; bs_real u0, w0, tau, u1, w1, P, Pu, Pw", """
    bs_real v.sn, v.a, v.b, curvature, one.u, one.w, two.u, two.w, gap, residual, pixels
""", f"""{RAY}
    bs_place one = bs_place_of(v, u0, w0, tau);
    bs_view again = bs_view_of(rest, bs_normal(Qu1, Qw1), Qu1, Qw1);
    bs_place two = bs_place_of(again, u1, w1, 1);
    bs_bump there = {{P, Pu, Pw, 0, 0, 0}};
    bs_real gap = bs_gap(v, curvature, tau, P), residual = bs_residual(v, curvature, tau, there);
    bs_real pixels = bs_pixels(s, light, (bs_real)0.25, -2);
""")

#: GLSL's sin may be off by 2^-11, so the march starts from a height by the same sin.
WAYS = Job("ways", f"{SURFACE} bs_real side, P, Pu, Pw, u, w, top, A, f0, f1, f2, f3, p0, p1, p2", """
    bs_real v.sn, v.a, v.b, curvature; bs_vec3 np, o.Qu, o.Qw, rough; bs_real y.end, turn.A, turn.B, least;
    bs_bool dark
""", f"""{RAY}
    bs_vec3 np = bs_perturbed_normal(n, Qu, Qw, Pu, Pw);
    bs_offset o = bs_offset_of(n, Qu, Qw, Quu, Quw, Qww, P);
    bs_vec3 rough = bs_perturbed_normal(bs_normal(o.Qu, o.Qw), o.Qu, o.Qw, Pu, Pw);
    bs_turn turn = bs_turn_of(v, n, Qu, Qw, Quu, Quw, Qww);
    bs_real here = A * (sin(f0 * u + p0) * cos(f1 * w + p1) + (bs_real)0.5 * sin(f2 * u + f3 * w + p2));
    bs_way y = bs_way_of(side, v, curvature, P, -top, top), march = bs_way_of(side, v, curvature, here, -top, top);
    bs_real first = y.side * bs_dot(np, s), least = 1;
    bs_bool dark = first <= 0;
    for (int i = 1; i <= 64; i++) {{
        bs_real t = bs_way_step(march.end, i, 64), a = u + march.d.a * t, b = w + march.d.b * t;
        bs_real h = A * (sin(f0 * a + p0) * cos(f1 * b + p1) + (bs_real)0.5 * sin(f2 * a + f3 * b + p2));
        bs_real gap = bs_gap(march.d, march.curvature, t, march.side * (h - here)) / t;
        dark |= bs_way_below(march, t, h);
        least = gap < least ? gap : least;
    }}
""")

HORIZONS = Job("horizons", "bs_real sn, a, b, ku, kw, at_k, at_next, k", "bs_real g.bearing, g.rise, horizon", """
    bs_view d = {sn, a, b};
    bs_bearing g = bs_bearing_of(d, ku, kw);
    bs_real horizon = bs_horizon(at_k, at_next, g.bearing * 8 - k);
""")

SHARES = Job("shares", "bs_real above, u, w", "bs_real share", """
    bs_real share = bs_horizon_share(above, u, w, (bs_real)1e-6);
""")

#: The height is the Taylor polynomial of the golden vectors.
MARCH = Job("march", f"{SURFACE} bs_real P, Pu, Pw, Puu, Puw, Pww, Pmin, Pmax", """
    bs_real v.sn, m.tau, iter, slab.front, slab.back, turn.A, turn.B; bs_bool m.found, finite; bs_vec3 o.Qu, o.Qw
""", f"""{RAY}
    bs_slab slab = bs_slab_of(v, Pmin, Pmax);
    bs_bool finite = bs_slab_ends(slab);
    bs_offset o = bs_offset_of(n, Qu, Qw, Quu, Quw, Qww, P);
    bs_turn turn = bs_turn_of(v, n, Qu, Qw, Quu, Quw, Qww);
    bs_march m = bs_march_start(slab);
    for (int i = 0; i <= 16; i++) {{
        bs_real tau = bs_march_tau(slab, i, 16), x = v.a * tau, y = v.b * tau;
        bs_real h = P + Pu * x + Pw * y + (bs_real)0.5 * (Puu * x * x + 2 * Puw * x * y + Pww * y * y);
        m = bs_march_step(m, tau, bs_gap(v, curvature, tau, h), v);
    }}
    bs_real iter = 0;
    for (int i = 0; i < 3; i++) {{
        bs_real x = v.a * iter, y = v.b * iter;
        bs_real h = P + Pu * x + Pw * y + (bs_real)0.5 * (Puu * x * x + 2 * Puw * x * y + Pww * y * y);
        iter = bs_tau0(v, h);
    }}
""")

ENDS = Job("ends", "bs_real sn, Pmin, Pmax", "bs_bool finite, m.found; bs_real sum", """
    bs_view v = {sn, 1, (bs_real)0.5};
    bs_slab slab = bs_slab_of(v, Pmin, Pmax);
    bs_bool finite = bs_slab_ends(slab);
    bs_march m = bs_march_start(slab);
    bs_real sum = 0;
    for (int i = 0; i <= 8; i++) {
        bs_real tau = bs_march_tau(slab, i, 8);
        m = bs_march_step(m, tau, bs_gap(v, 0, tau, (bs_real)0.1), v);
        sum = sum + (tau < 0 ? -tau : tau);
    }
""")

POLES = Job("poles", "bs_vec3 Qu, Qw", "bs_bool regular", """
    bs_bool regular = bs_regular(bs_normal(Qu, Qw), Qu, Qw);
""")

JOBS = (ORDERS, PLACES, WAYS, HORIZONS, SHARES, MARCH, ENDS, POLES)


# The golden vectors ---------------------------------------------------------------------------------------------


@cache
def golden(name: str) -> dict:
    return json.loads((TOP / f"tests/golden/{name}.json").read_text(encoding="utf-8"))


def column(cases: list[dict], name: str) -> np.ndarray:
    """null becomes nan."""
    values = [case[name] for case in cases]
    return np.array(values, None if isinstance(values[0], str) else float)


def columns(cases: list[dict], *names: str) -> Columns:
    return {name: column(cases, name) for name in names}


TAU = ("tau_order0", "tau_order1", "tau_order2", "tau_order2_full")
PARTIALS = ("Qu", "Qw", "Quu", "Quw", "Qww")


def size(x: np.ndarray) -> np.ndarray:
    return np.sqrt((x * x).sum(axis=-1))


@dataclass
class Errors:
    """What must be near, and the worst of each, as a share of its size."""

    worst: dict[str, float] = field(default_factory=dict)

    def near(self, name: str, got: np.ndarray, want: np.ndarray, sizes: np.ndarray | float) -> None:
        error = np.abs(got - want) / np.reshape(sizes, (-1,) + (1,) * (want.ndim - 1))
        worst = int(np.argmax(np.where(np.isnan(error), np.inf, error).reshape(len(want), -1).max(axis=1)))
        self.worst[name] = max(float(np.max(error)), self.worst.get(name, 0.0))
        assert (error <= BOUND).all(), f"{name}, case {worst}: {got[worst]}, expected {want[worst]}"

    def near_vector(self, name: str, got: np.ndarray, want: np.ndarray) -> None:
        self.near(name, got, want, size(want))

    def tell(self, job: str) -> None:
        print(*(f"\n{job:9} {name:12} {error:.1e}" for name, error in self.worst.items()), end="")


@pytest.fixture(scope="module")
def shader() -> Iterator[Gpu]:
    with gpu() as found:
        yield found


@pytest.fixture(scope="module")
def processor(tmp_path_factory: pytest.TempPathFactory) -> Processor:
    return Processor(JOBS, tmp_path_factory.mktemp("jobs"))


@pytest.fixture
def errors(request: pytest.FixtureRequest) -> Iterator[Errors]:
    found = Errors()
    yield found
    found.tell(request.node.name.removeprefix("test_"))


def check_view(errors: Errors, got: Columns, cases: list[dict], q: Columns) -> None:
    """The ray relative to the surface: a and b against |s| over the edges, as either may vanish by itself."""
    length, a, b = size(q["s"]), column(cases, "a"), column(cases, "b")
    errors.near("s.n", got["v.sn"], column(cases, "sn"), length)
    errors.near("a, b", got["v.a"], a, length / size(q["Qu"]))
    errors.near("a, b", got["v.b"], b, length / size(q["Qw"]))
    terms = size(q["Quu"]) * a * a + 2 * size(q["Quw"]) * abs(a * b) + size(q["Qww"]) * b * b
    flat = terms == 0
    errors.near("curvature", got["curvature"], column(cases, "curvature"), np.where(flat, 1, terms))


# Orders and guard -----------------------------------------------------------------------------------------------


def rise(cases: list[dict]) -> np.ndarray:
    """s.n/|n|"""
    n = column(cases, "n")
    return (column(cases, "s") * n).sum(axis=1) / size(n)


def with_slab(cases: list[dict]) -> Columns:
    """The inputs of the orders, and bounds of P: of every other case such that order 1 is just inside of these."""
    q = columns(cases, *PARTIALS, "s", "P", "Pu", "Pw", "Puu", "Puw", "Pww")
    beyond = np.random.default_rng(13).uniform(0, 0.5, (2, len(cases))) * abs(q["P"])
    low, high = np.minimum(q["P"], 0) - beyond[0], np.maximum(q["P"], 0) + beyond[1]
    at = np.array([q["P"], column(cases, "tau_order1") * rise(cases)])
    close = np.arange(len(cases)) % 2 == 1
    slack = 0.01 * abs(q["P"])
    low, high = np.where(close, at.min(axis=0) - slack, low), np.where(close, at.max(axis=0) + slack, high)
    return q | {"Pmin": low, "Pmax": high}


def turned(q: Columns) -> Columns:
    """The same place of the same rough surface, seen from behind: u and w exchanged, so that n and P turn."""
    other = {"Qu": "Qw", "Qw": "Qu", "Quu": "Qww", "Qww": "Quu", "Pu": "Pw", "Pw": "Pu", "Puu": "Pww", "Pww": "Puu",
             "Pmin": "Pmax", "Pmax": "Pmin"}
    return {name: q[other.get(name, name)] * (-1 if name.startswith("P") else 1) for name in q}


def orders(shader: Gpu, q: Columns, behind: bool) -> Columns:
    """As seen from the front."""
    if not behind:
        return shader.run(ORDERS, q)
    got = shader.run(ORDERS, turned(q))
    turned_back = {name: -got[name] for name in ("n", "np", "v.sn", "curvature")}
    return got | turned_back | {"v.a": got["v.b"], "v.b": got["v.a"]}


BOTH_SIDES = pytest.mark.parametrize("behind", [False, True], ids=["front", "behind"])


def conditions(q: Columns, sn: np.ndarray, a: np.ndarray, b: np.ndarray, curvature: np.ndarray) -> list[np.ndarray]:
    """By how much the bound of tau grows for each order, where B or B^2 - 4 A P cancels."""
    slope = q["Pu"] * a + q["Pw"] * b - sn
    one = (abs(q["Pu"] * a) + abs(q["Pw"] * b) + abs(sn)) / abs(slope)
    found = [np.ones(len(sn)), one]
    half = (q["Puu"] * a * a + q["Pww"] * b * b) / 2
    for quadratic in (half, half + q["Puw"] * a * b + curvature / 2):
        root = abs(slope * slope - 4 * quadratic * q["P"])
        found.append(one * np.maximum(1, slope * slope / root) + abs(4 * quadratic * q["P"]) / root)
    return found


@BOTH_SIDES
def test_orders(behind: bool, shader: Gpu, errors: Errors) -> None:
    cases = golden("method")["cases"]
    q = with_slab(cases)
    got = orders(shader, q, behind)
    assert len(cases) == 240 and got["regular"].all()
    a, b, sn = column(cases, "dudt"), column(cases, "dwdt"), rise(cases)
    errors.near_vector("n", got["n"], column(cases, "n"))
    errors.near_vector("n'", got["np"], column(cases, "n_perturbed"))
    length = size(q["s"])
    errors.near("s.n", got["v.sn"], sn, length)
    errors.near("a, b", got["v.a"], a, length / size(q["Qu"]))
    errors.near("a, b", got["v.b"], b, length / size(q["Qw"]))
    plain = 0
    for order, (key, condition) in enumerate(zip(TAU, conditions(q, sn, a, b, got["curvature"]), strict=True)):
        want = column(cases, key)
        there = ~np.isnan(want)
        assert (got[f"k{order}.order"][there] == order).all() and (got[f"k{order}.order"][~there] != order).all()
        errors.near(f"order {order}", got[f"k{order}.tau"][there], want[there], (abs(want) * condition)[there])
        plain += int((condition < 4).sum())
    assert plain > 0.8 * 4 * len(cases)  # the bounds have not been stretched for all


@dataclass
class Guarded:
    """What the guard leaves, by the golden tau of each order and its rule; `sure`: not on the border of a decision."""

    tau: np.ndarray
    order: np.ndarray
    condition: np.ndarray
    sure: np.ndarray


def guarded(cases: list[dict], q: Columns, asked: int, conditions: list[np.ndarray]) -> Guarded:
    a, b, sn = column(cases, "dudt"), column(cases, "dwdt"), rise(cases)
    front, back = np.sort([q["Pmin"] / sn, q["Pmax"] / sn], axis=0)
    down = (q["Pu"] * a + q["Pw"] * b - sn) * np.where(sn < 0, 1, -1)
    sure = abs(down) > 1e-4 * (abs(q["Pu"] * a) + abs(q["Pw"] * b) + abs(sn))
    tau, order, condition = column(cases, "tau_order0"), np.zeros(len(cases)), np.ones(len(cases))
    for k in (1, asked) if asked > 1 else (1,):  # each over the one before
        bare = column(cases, TAU[k])
        margin = np.minimum(abs(bare - front), abs(bare - back)) / (abs(bare) * conditions[k])
        sure &= np.isnan(bare) | (margin > 1e-4)
        good = (down > 0) & (bare >= front) & (bare <= back)
        tau, order, condition = np.where(good, (bare, np.full(len(cases), k), conditions[k]), (tau, order, condition))
    return Guarded(tau, order, condition, sure)


@BOTH_SIDES
def test_guard(behind: bool, shader: Gpu, errors: Errors) -> None:
    cases = golden("method")["cases"]
    q = with_slab(cases)
    got = orders(shader, q, behind)
    known = conditions(q, rise(cases), column(cases, "dudt"), column(cases, "dwdt"), got["curvature"])
    left = set()
    for asked in (1, 2, 3):
        want = guarded(cases, q, asked, known)
        sure, bound = want.sure, abs(want.tau) * want.condition
        assert sure.sum() > 0.9 * len(cases)
        assert (got[f"g{asked}.order"][sure] == want.order[sure]).all()
        errors.near(f"order {asked}", got[f"g{asked}.tau"][sure], want.tau[sure], bound[sure])
        left |= {(asked, int(k)) for k in np.unique(want.order[sure])}
    assert left == {(1, 0), (1, 1), (2, 0), (2, 1), (2, 2), (3, 0), (3, 1), (3, 3)}  # all of it has happened


def test_poles(shader: Gpu) -> None:
    """At any scale, and whichever of Qu and Qw is short."""
    short = np.array([1e-8, 0, 1e-5, 1e-8, 0, 1e-5])
    scale = np.array([1, 1, 1, 100, 0.01, 100])
    long = np.outer(scale, [1, 0, 0])
    for turned in (False, True):
        across = np.outer(scale * short, [0, 1, 0])
        got = shader.run(POLES, {"Qu": across if turned else long, "Qw": long if turned else across})
        assert got["regular"].tolist() == [0, 0, 1] * 2
    nearly = shader.run(POLES, {"Qu": [[1, 0, 0]] * 3, "Qw": [[1, 0, 0], [1, 1e-8, 0], [1, 1e-5, 0]]})
    assert nearly["regular"].tolist() == [0, 0, 1]


# March and iter -------------------------------------------------------------------------------------------------


def turn_size(q: Columns) -> np.ndarray:
    """Of a quotient of second partials and first ones, times two steps."""
    second = size(q["Quu"]) + size(q["Quw"]) + size(q["Qww"])
    return size(q["s"])**2 * (second + 1) / np.minimum(size(q["Qu"]), size(q["Qw"]))**3


@BOTH_SIDES
def test_march(behind: bool, shader: Gpu, processor: Processor, errors: Errors) -> None:
    """As the header in double; and so what bends surfaces, here of a general kind."""
    q = with_slab(golden("method")["cases"])
    q |= {"Pmin": -2 * abs(q["P"]), "Pmax": 2 * abs(q["P"])}
    q = turned(q) if behind else q
    got, want = shader.run(MARCH, q), processor.run(MARCH, q)
    assert got["finite"].all() and want["finite"].all()
    found, thick = want["m.found"] == 1, want["slab.back"] - want["slab.front"]
    assert (got["m.found"] == want["m.found"]).all() and found.sum() > 200
    errors.near("march:16", got["m.tau"][found], want["m.tau"][found], thick[found])
    tame = abs(want["iter"]) < 2 * abs(want["slab.back"])  # where the repeated look-up stays in the slab
    assert tame.sum() > 0.9 * len(tame)
    errors.near("iter:3", got["iter"][tame], want["iter"][tame], thick[tame])
    errors.near_vector("offset", got["o.Qu"], want["o.Qu"])
    errors.near_vector("offset", got["o.Qw"], want["o.Qw"])
    for axis in "AB":
        errors.near("turn", got[f"turn.{axis}"], want[f"turn.{axis}"], turn_size(q))


@pytest.mark.parametrize("large", [1e38, math.inf], ids=["1e38", "infinite"])
def test_no_end(large: float, shader: Gpu) -> None:
    """Where P has no bounds, a march looks P up at 0 only and finds nothing."""
    bounds = np.array([(-0.1, large), (-large, 0.2), (-large, large), (-0.1, 0.2)] * 2)
    sn = np.repeat([0.5, -0.5], 4)
    got = shader.run(ENDS, {"sn": sn, "Pmin": bounds[:, 0], "Pmax": bounds[:, 1]})
    assert got["finite"].tolist() == [0, 0, 0, 1] * 2
    assert got["m.found"].tolist() == [0, 0, 0, 1] * 2
    assert (got["sum"][got["finite"] == 0] == 0).all() and (got["sum"][got["finite"] == 1] > 0).all()


# The place to shade, and what it leaves -------------------------------------------------------------------------

ROW = {"tau": 1, "u1": 3, "w1": 4, "P": 5, "Pu": 6, "Pw": 7, "gap": 8, "rest": slice(9, 12), "Qu1": slice(12, 15),
       "Qw1": slice(15, 18), "u2": 18, "w2": 19}


def test_places(shader: Gpu, errors: Errors) -> None:
    cases = [case for case in golden("relief")["places"] for _ in case["rows"]]
    rows = np.array([row for case in golden("relief")["places"] for row in case["rows"]])
    q = columns(cases, *PARTIALS, "s", "light") | {"u0": column(cases, "u"), "w0": column(cases, "w")}
    q |= {name: rows[:, at] for name, at in ROW.items() if name not in ("gap", "u2", "w2")}
    got = shader.run(PLACES, q)
    check_view(errors, got, cases, q)
    errors.near("place", got["one.u"], q["u1"], 1)
    errors.near("place", got["one.w"], q["w1"], 1)
    errors.near("second step", got["two.u"], rows[:, ROW["u2"]], 1)
    errors.near("second step", got["two.w"], rows[:, ROW["w2"]], 1)
    sn, a, b, bend = (column(cases, name) for name in ("sn", "a", "b", "curvature"))
    bend, uphill, along, want = bend * q["tau"], q["Pu"] * a, q["Pw"] * b, rows[:, ROW["gap"]]
    slope, slope_size = sn - bend - uphill - along, abs(sn) + abs(bend) + abs(uphill) + abs(along)
    gap_size = abs(q["tau"] * sn) + abs(q["P"]) + abs(bend * q["tau"])
    errors.near("gap", got["gap"], want, gap_size)
    errors.near("residual", got["residual"], -want / slope,
                (gap_size + abs(want / slope) * slope_size) / abs(slope))
    errors.near("pixels", got["pixels"], 8 * column(cases, "across"), 16)


# The bumps' own shadows -----------------------------------------------------------------------------------------


def ways_of(cases: list[dict]) -> Columns:
    bumps = dict(zip(("A", "f0", "f1", "f2", "f3", "p0", "p1", "p2"), column(cases, "bumps").T, strict=True))
    q = columns(cases, *PARTIALS, "side", "P", "Pu", "Pw", "u", "w")
    return q | bumps | {"s": column(cases, "d"), "top": column(cases, "highest")}


def test_ways(shader: Gpu, processor: Processor, errors: Errors) -> None:
    cases = golden("relief")["ways"]
    q = ways_of(cases)
    got, double = shader.run(WAYS, q), processor.run(WAYS, q)
    check_view(errors, got, cases, q)
    offset = column(cases, "offset")
    errors.near_vector("offset", got["o.Qu"], offset[:, :3])
    errors.near_vector("offset", got["o.Qw"], offset[:, 3:])
    for name, key in (("np", "n_perturbed"), ("rough", "n_rough")):
        errors.near_vector("n'" if name == "np" else "rough n'", got[name] / size(got[name])[:, None],
                           column(cases, key))
    bend, sn = column(cases, "curvature"), column(cases, "sn")
    rest = 2 * abs(bend) * (q["top"] + abs(q["P"]))  # the root of sn^2 - 2 curvature rise: it may cancel
    errors.near("way's end", got["y.end"], column(cases, "end"), 1 + (sn**2 + rest) / abs(sn**2 - rest))
    for axis in "AB":
        errors.near("way's turn", got[f"turn.{axis}"], double[f"turn.{axis}"], turn_size(q))


def test_own_shadows(shader: Gpu, processor: Processor) -> None:
    """Dark or not by 64 steps: as by the header in double, but for ways that just touch, and on planes as in truth."""
    cases = golden("relief")["ways"]
    q = ways_of(cases)
    got, double = shader.run(WAYS, q), processor.run(WAYS, q)
    sure = abs(double["least"]) > 3e-3
    assert sure.sum() > 0.9 * len(cases)
    assert (got["dark"] == double["dark"])[sure].all()
    wrong = got["dark"] != column(cases, "dark")
    assert not wrong[column(cases, "surface") == "plane"].any() and wrong.sum() < 6
    assert 20 < got["dark"].sum() < len(cases) - 20


# Horizons -------------------------------------------------------------------------------------------------------


def test_horizons(shader: Gpu, errors: Errors) -> None:
    lights, q = [], []
    for case in golden("relief")["horizons"]:
        around = case["around"]
        for light in case["lights"]:
            k = int(light[3] * len(around) / 4)
            lights.append(light)
            q.append((case["ku"], case["kw"], around[k], around[(k + 1) % len(around)], k))
    light, rest = np.array(lights), np.array(q)
    given = dict(zip(("a", "b", "sn"), light[:, :3].T, strict=True))
    given |= dict(zip(("ku", "kw", "at_k", "at_next", "k"), rest.T, strict=True))
    got = shader.run(HORIZONS, given)
    errors.near("bearing", got["g.bearing"], light[:, 3], 4)
    errors.near("rise", got["g.rise"], light[:, 4], abs(light[:, 4]))
    fraction = light[:, 3] * 8 - given["k"]
    want = given["at_k"] * (1 - fraction) + given["at_next"] * fraction
    errors.near("horizon", got["horizon"], want,
                abs(given["at_k"]) + abs(given["at_next"]) + 32 * abs(given["at_next"] - given["at_k"]))


def test_shares(shader: Gpu, errors: Errors) -> None:
    """A horizon that runs along a side, within 1 in 1000, is taken to be askew by that much, which is 1/8 of it."""
    above, u, w, want = np.array(golden("relief")["shares"]).T
    got = shader.run(SHARES, {"above": above, "u": u, "w": w})["share"]
    sides = np.sort([abs(u), abs(w)], axis=0)
    askew = sides[0] / sides[1] < 1e-3
    assert 0 < askew.sum() < 20
    assert (abs(got - want)[askew] < 1e-3 / 8 + BOUND).all()
    errors.near("share", got[~askew], want[~askew], 1)


# All of it ------------------------------------------------------------------------------------------------------


def test_every_function_is_computed() -> None:
    """By a job, or by a function that a job calls."""
    bodies = functions(glsl.TARGET.read_text(encoding="utf-8"))
    reached, new = set(), called(" ".join(job.body for job in JOBS))
    while new:
        reached |= new
        new = {name for f in new for name in called(bodies.get(f, ""))} - reached
    assert set(bodies) - reached == set() and len(bodies) > 30
