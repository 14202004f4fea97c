"""kage.methods against the golden vectors of bumpshadow.h, and against kage itself.

Tolerances are those of the C tests (tests/unit/method/golden_values.h): straightforward code reaches 1e-14 in double
and 1e-5 in float, relative to the size of a sum's terms.
"""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

from kage import methods
from tests.conftest import PROGRAM, TOP

TOLERANCE = {np.float64: 1e-13, np.float32: 3e-5}
BOTH = pytest.mark.parametrize("real", TOLERANCE)


class Cases:
    """The numbers of all cases of a golden file, by their names, in one precision."""

    def __init__(self, file: str, group: str, real: type) -> None:
        self.rows = json.loads((TOP / "tests" / "golden" / file).read_text())[group]
        self.real = real

    def __getitem__(self, name: str) -> np.ndarray:
        return np.array([row[name] for row in self.rows], self.real)

    def wide(self, name: str) -> np.ndarray:
        """As they stand in the file; none is NaN."""
        return np.array([row[name] for row in self.rows], np.float64)

    def bump(self) -> methods.Bump:
        return methods.Bump(*(self[name] for name in methods.Bump._fields))


def near(got: Any, want: np.ndarray, size: Any, real: type) -> None:
    assert np.asarray(got).dtype == real
    off = np.abs(np.asarray(got, np.float64) - want) / size
    assert (off <= TOLERANCE[real]).all(), f"case {off.argmax()}: off by {off.max():.2g}"


def length(v: np.ndarray) -> np.ndarray:
    return np.sqrt((np.asarray(v, np.float64) ** 2).sum(-1))


@BOTH
def test_golden_normals_and_views(real: type) -> None:
    c = Cases("method.json", "cases", real)
    n = methods.normal(c["Qu"], c["Qw"])
    v = methods.view(c["s"], n, c["Qu"], c["Qw"])
    near(n, c.wide("n"), length(c["n"])[:, None], real)
    turned = methods.perturbed_normal(n, c["Qu"], c["Qw"], c["Pu"], c["Pw"])
    near(turned, c.wide("n_perturbed"), length(c["n_perturbed"])[:, None], real)
    near(v.a, c.wide("dudt"), length(c["s"]) / length(c["Qu"]), real)
    near(v.b, c.wide("dwdt"), length(c["s"]) / length(c["Qw"]), real)
    assert methods.regular(n, c["Qu"], c["Qw"]).all()


@BOTH
def test_golden_shifts(real: type) -> None:
    """As tests/unit/method/bumpshadow_cases.h: a bound grows by how much smaller a sum is than its terms."""
    c = Cases("method.json", "cases", real)
    n, p = methods.normal(c["Qu"], c["Qw"]), c.bump()
    v = methods.view(c["s"], n, c["Qu"], c["Qw"])
    curvature = methods.curvature(v, n, c["Quu"], c["Quw"], c["Qww"])
    b = methods.slope(v, p)
    terms = np.abs(p.Pu * v.a) + np.abs(p.Pw * v.b) + np.abs(v.sn)
    one = terms / np.abs(b)

    def two(a: np.ndarray) -> np.ndarray:
        left = np.abs(methods.discriminant(a, b, p.P))
        return one * np.maximum(1, b * b / left) + 4 * np.abs(a * p.P) / left

    conditions = {"tau_order0": 1, "tau_order1": one, "tau_order2": two(methods.quadratic(v, p)),
                  "tau_order2_full": two(methods.quadratic_plus(v, p, curvature))}
    alone = (methods.tau0(n, c["s"], p.P), methods.tau1(v, p), methods.tau2(v, p), methods.tau2_plus(v, p, curvature))
    everything = methods.Slab(real(-np.inf), real(np.inf))
    for order, (name, condition) in enumerate(conditions.items()):
        want = c.wide(name)
        there = np.isfinite(want)
        got = methods.shift(order, v, p, everything, curvature=curvature, guard=False)
        assert ((got.order == order) == there).all()
        size = (np.abs(want) * condition)[there]
        near(got.tau[there], want[there], size, real)
        near(alone[order][there], want[there], size, real)
    assert np.isfinite(c.wide("tau_order2")).sum() > 200


@BOTH
def test_golden_places_and_residuals(real: type) -> None:
    """As tests/unit/method/relief_cases.h; columns of the rows: tau, P, u, w, P, Pu, Pw there, gap."""
    c = Cases("relief.json", "places", real)
    n = methods.normal(c["Qu"], c["Qw"])
    v = methods.view(c["s"], n, c["Qu"], c["Qw"])
    bend = methods.curvature(v, n, c["Quu"], c["Quw"], c["Qww"])
    for row in range(4):
        x = c.wide("rows")[:, row]
        tau, there = x[:, 1].astype(real), methods.Bump(*x[:, 5:8].astype(real).T)
        at = methods.place(v, c["u"], c["w"], tau)
        near(at.u, x[:, 3], 1, real)
        near(at.w, x[:, 4], 1, real)
        terms = np.abs(tau * v.sn) + np.abs(there.P) + np.abs(bend * tau**2)
        near(methods.gap(v, bend, tau, there.P), x[:, 8], terms, real)
        steep = np.abs(v.sn) + np.abs(bend * tau) + np.abs(there.Pu * v.a) + np.abs(there.Pw * v.b)
        slope = c.wide("sn") - c.wide("curvature") * x[:, 1] - x[:, 6] * c.wide("a") - x[:, 7] * c.wide("b")
        want = -x[:, 8] / slope
        near(methods.residual(v, bend, tau, there), want, (terms + np.abs(want) * steep) / np.abs(slope), real)
    near(methods.pixels(c["s"], c["light"], real(0.25), real(-2)), 8 * c.wide("across"), 16, real)


def unit(v: np.ndarray) -> np.ndarray:
    return np.asarray(v, np.float64) / length(v)[:, None]


@BOTH
def test_golden_ways(real: type) -> None:
    c = Cases("relief.json", "ways", real)
    n = methods.normal(c["Qu"], c["Qw"])
    v = methods.view(c["d"], n, c["Qu"], c["Qw"])
    near(v.sn, c.wide("sn"), length(c["d"]), real)
    rough = methods.offset(n, c["Qu"], c["Qw"], c["Quu"], c["Quw"], c["Qww"], c["P"])
    near(rough.Qu, c.wide("offset")[:, :3], length(c["offset"][:, :3])[:, None], real)
    near(rough.Qw, c.wide("offset")[:, 3:], length(c["offset"][:, 3:])[:, None], real)
    turned = methods.perturbed_normal(methods.normal(*rough), *rough, c["Pu"], c["Pw"])
    assert np.abs(unit(turned) - c.wide("n_rough")).max() <= TOLERANCE[real]
    bend = methods.curvature(v, n, c["Quu"], c["Quw"], c["Qww"])
    y = methods.way(c["side"], v, bend, c["P"], -c["highest"], c["highest"])
    square, rest = v.sn**2, 2 * np.abs(bend) * (c["highest"] + np.abs(c["P"]))
    near(y.end, c.wide("end"), 1 + (square + rest) / np.abs(square - rest), real)


def bumps(c: Cases) -> methods.Height:
    """The heights of each case."""
    a, f0, f1, f2, f3, p0, p1, p2 = c["bumps"].T
    return lambda u, w: a * (np.sin(f0 * u + p0) * np.cos(f1 * w + p1) + np.sin(f2 * u + f3 * w + p2) / 2)


def test_golden_own_shadows() -> None:
    """On a plane 256 steps agree with the truth in all cases; one step does not."""
    c = Cases("relief.json", "ways", np.float64)
    n = methods.normal(c["Qu"], c["Qw"])
    v = methods.view(c["d"], n, c["Qu"], c["Qw"])
    y = methods.way(c["side"], v, 0.0, c["P"], -c["highest"], c["highest"])
    away = c["side"] * (c["n_perturbed"] * c["d"]).sum(-1) <= 0
    plane = np.array([row["surface"] == "plane" for row in c.rows])
    wrong = [((methods.own_shadow(y, bumps(c), c["u"], c["w"], steps) | away) != (c["dark"] == 1))[plane].sum()
             for steps in (1, 256)]
    assert plane.sum() > 30
    assert wrong[0] > 0 == wrong[1]


def test_golden_turns() -> None:
    """(u,w) on a way over a curved surface: off by t^2 without the turn, by t^3 with it. P and t are halved by row."""
    c = Cases("relief.json", "ways", np.float64)
    flat = np.array([row["surface"] == "plane" for row in c.rows])
    n = methods.normal(c["Qu"], c["Qw"])
    second = [c[name] for name in ("Quu", "Quw", "Qww")]
    off: dict[str, list[np.ndarray]] = {"straight": [], "turned": []}
    for k in (1, 3):
        rough = methods.offset(n, c["Qu"], c["Qw"], *second, c["P"] / 2**k)
        d = methods.view(c["d"], methods.normal(*rough), *rough)
        bend = methods.turn(d, n, c["Qu"], c["Qw"], *second)
        t, u_true, w_true = c["rows"][:, k, [1, 6, 7]].T
        at = methods.place(d, c["u"], c["w"], t)
        off["straight"].append(np.hypot(at.u - u_true, at.w - w_true))
        off["turned"].append(np.hypot(at.u + bend.A * t**2 - u_true, at.w + bend.B * t**2 - w_true))
    order = {how: float(np.median(np.log2(x[0][~flat] / x[1][~flat]))) / 2 for how, x in off.items()}
    assert order == {"straight": pytest.approx(2, abs=0.15), "turned": pytest.approx(3, abs=0.15)}
    assert max(x[flat].max() for x in off["turned"]) < 1e-12


@BOTH
def test_golden_horizons(real: type) -> None:
    lights = 0
    for row in json.loads((TOP / "tests" / "golden" / "relief.json").read_text())["horizons"]:
        a, b, sn, bearing, rise, horizon = np.array(row["lights"]).T
        got = methods.bearing(methods.View(*(x.astype(real) for x in (sn, a, b))), row["ku"], row["kw"])
        near(got.bearing, bearing, 4, real)
        near(got.rise, rise, np.abs(rise), real)
        around = np.array(row["around"], real)
        x = got.bearing * (len(around) / 4)
        k = x.astype(int)
        found = methods.horizon(around[k], around[(k + 1) % len(around)], x - k)
        assert np.abs(found - horizon).max() < 0.1 * around.max()
        lights += len(a)
    assert lights > 60


@BOTH
def test_golden_shares(real: type) -> None:
    """A horizon that runs along a side, within 1 in 1000, is taken to be askew by that much: 1/8 of it at most."""
    x = np.array(json.loads((TOP / "tests" / "golden" / "relief.json").read_text())["shares"])
    got = methods.horizon_share(*x[:, :3].astype(real).T, real(1e-6))
    across = np.abs(x[:, 1:3])
    along = across.min(1) < 1e-3 * across.max(1)
    near(got, x[:, 3], np.where(along, 1e-3 / 8 / TOLERANCE[real] + 1, 4), real)


# ---- arrays ----

FRONT = methods.View(-0.5, 1.0, 0.0)


def test_the_call_of_the_issue() -> None:
    program = "import kage; print(kage.methods.tau0([0, 2, 0], [0.3, -0.5, 0], 0.1))"
    done = subprocess.run([sys.executable, "-c", program], env={"PYTHONPATH": str(PROGRAM.parent / "python")},
                          capture_output=True, text=True, timeout=120)
    assert (done.stdout, done.stderr) == ("-0.2\n", "")


def test_broadcasting() -> None:
    n, s = np.random.default_rng(1).normal(size=(2, 4, 1, 3))
    heights = np.linspace(-1, 1, 5)
    got = methods.tau0(n, s, heights)
    assert got.shape == (4, 5)
    assert all(got[i, j] == methods.tau0(n[i, 0], s[i, 0], heights[j]) for i in range(4) for j in range(5))
    assert methods.tau0(n[:0], s[:0], heights).shape == (0, 5)
    turned = np.asfortranarray(np.broadcast_to(n, (4, 5, 3)))  # strides of all kinds
    assert np.array_equal(methods.tau0(turned, s, heights[::-1])[:, ::-1], got)
    assert np.array_equal(methods.tau0(turned[:, ::2], s, heights[::2]), got[:, ::2])


def test_precision_is_that_of_the_arrays() -> None:
    one = np.float32([0, 1, 0])
    assert methods.tau0(one, -one, 0.5).dtype == np.float32
    assert methods.tau0(one, -one, np.float64(0.5)).dtype == np.float64
    assert methods.tau0(np.float16([0, 1, 0]), np.float16([0, -1, 0]), 1).dtype == np.float32
    with pytest.raises(TypeError, match="complex128"):
        methods.tau0(one, -one, 1j * np.ones(2))


@pytest.mark.parametrize(("call", "message"), [
    (lambda: methods.tau0([0, 1], [0, 1, 0], 1), r"tau0: expected vectors, an array of shape (..., 3), not (2,)"),
    (lambda: methods.normal(1.0, [0, 1, 0]), r"normal: expected vectors"),
    (lambda: methods.shift(4, FRONT, methods.Bump(0.1), methods.Slab(-1, 1)), "order 4: expected 0, 1, 2 or 3"),
    (lambda: methods.march(FRONT, lambda u, w: u * w, 0, 0, methods.Slab(-1, 1), 0), "steps=0: expected 1 or more"),
    (lambda: methods.tau1(methods.View([1, 2], 1, [1, 2, 3]), methods.Bump(1)), "broadcast"),
])
def test_what_is_wrong_is_said(call: Any, message: str) -> None:
    with pytest.raises(ValueError) as wrong:
        call()
    assert message in str(wrong.value)


def test_the_guard_falls_back() -> None:
    """The cases of the C test `guard`, in one array."""
    v, slab = methods.View(-0.5, 1.0, 0.0), methods.slab(FRONT, -0.1, 0.1)
    p = methods.Bump(0.05, np.array([0.1, -0.7, -0.49, -0.4]), 0.0, np.array([0.1, 0.0, 0.0, 2.0]))
    assert (slab.front, slab.back) == (-0.2, 0.2)
    for order in range(4):
        assert methods.shift(order, v, p, slab).order.tolist() == [order, 0, 0, 0]
    assert methods.shift(1, v, p, slab, guard=False).tau[2] == pytest.approx(-5)
    assert methods.shift(2, v, p, slab, guard=False).order.tolist() == [2, 1, 2, 1]


def test_marches_find_the_surface() -> None:
    """iter and march come nearer to where the ray meets P with each step; a march that finds nothing is order 0."""
    def height(u: np.ndarray, w: np.ndarray) -> np.ndarray:
        return 0.1 * np.sin(3 * u) * np.cos(w)

    u, w = np.random.default_rng(2).uniform(-3, 3, (2, 200))
    slab = methods.slab(FRONT, -0.1, 0.1)

    def left(tau: np.ndarray) -> float:
        at = methods.place(FRONT, u, w, tau)
        return float(np.abs(methods.gap(FRONT, 0.0, tau, height(*at))).max())

    gaps = [left(methods.march(FRONT, height, u, w, slab, steps).tau) for steps in (2, 8, 64)]
    assert gaps[0] > 4 * gaps[1] > 64 * gaps[2]
    again = [left(methods.iterate(FRONT, height, u, w, times).tau) for times in (1, 4, 16)]
    assert again[0] > 2 * again[1] > 8 * again[2]
    zero = methods.tau0([0, 1, 0], [1, -0.5, 0], height(u, w))
    assert np.array_equal(methods.iterate(FRONT, height, u, w, 1).tau, zero)
    endless = methods.march(FRONT, height, u, w, methods.Slab(-np.inf, np.inf), 4)
    assert np.array_equal(endless.tau, zero) and not endless.order.any()
