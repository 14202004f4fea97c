"""The formulas of bumpshadow.h, Sumi and Noma's method, on numpy arrays.

    n = methods.normal(Qu, Qw)
    tau = methods.tau0(n, s, P)                   # order 0: the shadow ray starts at r + s (t_hit + tau)

Each function calls the header's function of that name at every place; there is no second copy of a formula. Symbols are
those of docs/method.md. Q is the smooth surface, P the height along n/|n|, both in scene units; r + s t is the viewing
ray, and tau is in units of t. Vectors are arrays of shape (..., 3), numbers arrays of shape (...). They are broadcast
against each other, without a copy where one value holds for all places. If all arrays are float32 the result is
computed in float32, otherwise in float64. The interpreter's lock is released meanwhile.

A struct of the header is a NamedTuple of arrays: View, Bump, Slab, Shift ... A field may be a number.

Heights on the way of a ray come from a `Height`: a function of u and w, two arrays, that returns P, an array. A
kage.heights.HeightMap is one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from kage._methods import ffi, lib

Real: TypeAlias = npt.NDArray[Any]  # float32 or float64
Like: TypeAlias = npt.ArrayLike
Height: TypeAlias = Callable[[Real, Real], Like]


class View(NamedTuple):
    """A ray relative to the surface, for each unit of t: sn = s.n/|n|, and du/dt and dw/dt in the tangent plane."""

    sn: Like
    a: Like
    b: Like


class Place(NamedTuple):
    """A place of the surface."""

    u: Real
    w: Real


class Offset(NamedTuple):
    """The partials of the offset surface Q + h n/|n|."""

    Qu: Real
    Qw: Real


class Bump(NamedTuple):
    """The height and its partials at one (u,w)."""

    P: Like
    Pu: Like = 0.0
    Pw: Like = 0.0
    Puu: Like = 0.0
    Puw: Like = 0.0
    Pww: Like = 0.0


class Slab(NamedTuple):
    """tau where the ray enters and leaves what lies between the lowest and the highest P."""

    front: Like
    back: Like


class Shift(NamedTuple):
    """tau, and the order really used: 0, 1, 2, 3 for 2+, 4 for iter and 5 for march, as in kage's layer `order`."""

    tau: Real
    order: npt.NDArray[np.int32]


class March(NamedTuple):
    """The state of a march. found: tau is the shift."""

    tau: Like
    gap: Like
    found: Like


class Way(NamedTuple):
    """A way from the rough surface to a light, as seen from the viewer's side. It leaves the slab at t = end."""

    side: Like
    d: View
    curvature: Like
    P: Like
    end: Like


class Turn(NamedTuple):
    """What a straight way over a curved surface adds: (u + a t + A t^2, w + b t + B t^2)."""

    A: Like
    B: Like


class Bearing(NamedTuple):
    """A direction in samples of a map, 0 to 4 all around, and the rise along it."""

    bearing: Real
    rise: Real


# ---- calling the loops ----

#: Letters of methods.h.
_VECTOR, _INT = "v", "i"


def _table(first: Any) -> dict[str, Any]:
    rows: dict[str, Any] = {}
    while first[len(rows)].name != ffi.NULL:
        row = first[len(rows)]
        rows[ffi.string(row.name).decode()] = row
    return rows


_LOOPS = {np.dtype(np.float32): _table(lib.methods_float), np.dtype(np.float64): _table(lib.methods_double)}


def _flat(values: Sequence[Any]) -> Iterator[Any]:
    for value in values:
        if isinstance(value, tuple) and hasattr(value, "_fields"):
            yield from _flat(value)
        else:
            yield value


def _precision(values: Sequence[Any]) -> np.dtype[Any]:
    """float32 if all arrays are; plain numbers do not count."""
    types = [np.asarray(value).dtype for value in values if type(value) not in (int, float)]
    found = np.result_type(np.float32, *types) if types else np.dtype(np.float64)
    if found not in _LOOPS:
        raise TypeError(f"expected real numbers of at most 64 bits, not {found}")
    return found


def _shape(name: str, letter: str, x: npt.NDArray[Any]) -> tuple[int, ...]:
    if letter != _VECTOR:
        return x.shape
    if x.ndim == 0 or x.shape[-1] != 3:
        raise ValueError(f"{name}: expected vectors, an array of shape (..., 3), not {x.shape}")
    return x.shape[:-1]


def _run(name: str, *values: Any) -> list[Any]:
    """The results of one loop of methods.c. A result of shape () is a scalar of NumPy."""
    given = list(_flat(values))
    precision = _precision([value for value, letter in zip(given, _letters(name), strict=True) if letter != _INT])
    row = _LOOPS[precision][name]
    types = [np.dtype(np.int32) if letter == _INT else precision for letter in _letters(name)]
    inputs = [np.asarray(value, dtype) for value, dtype in zip(given, types, strict=True)]
    shapes = [_shape(name, letter, x) for letter, x in zip(_letters(name), inputs, strict=True)]
    shape = np.broadcast_shapes(*shapes)
    arrays, steps = [], []
    for letter, x, own in zip(_letters(name), inputs, shapes, strict=True):
        width = 3 if letter == _VECTOR else 1
        one = math.prod(own) == 1
        full = x if one else np.broadcast_to(x, (*shape, 3) if letter == _VECTOR else shape)
        arrays.append(np.ascontiguousarray(full))
        steps.append(0 if one else width)
    results: list[Any] = []
    for letter in ffi.string(row.outputs).decode():
        results.append(np.empty((*shape, 3) if letter == _VECTOR else shape,
                                np.int32 if letter == _INT else precision))
        steps.append(3 if letter == _VECTOR else 1)
    pointers = [ffi.cast("void *", x.ctypes.data) for x in (*arrays, *results)]
    row.run(math.prod(shape), ffi.new("void *[]", pointers), ffi.new("ptrdiff_t[]", steps))
    return [x[()] for x in results]


def _letters(name: str) -> str:
    letters: str = ffi.string(_LOOPS[np.dtype(np.float32)][name].inputs).decode()
    return letters


def _one(name: str, *values: Any) -> Real:
    (result,) = _run(name, *values)
    return result  # type: ignore[no-any-return]


# ---- the surface and the ray ----


def normal(Qu: Like, Qw: Like) -> Real:
    """The smooth normal n = Qu x Qw, not normalised (section 6). It points to the side of +P."""
    return _one("normal", Qu, Qw)


def regular(n: Like, Qu: Like, Qw: Like) -> npt.NDArray[np.bool_]:
    """False where Qu and Qw are parallel or 0, as at a sphere's pole: take the smooth normal and tau = 0 (ours)."""
    return np.not_equal(_one("regular", n, Qu, Qw), 0)


def perturbed_normal(n: Like, Qu: Like, Qw: Like, Pu: Like, Pw: Like) -> Real:
    """n' = Qu x Qw + Pu (n x Qw)/|n| + Pw (Qu x n)/|n|, not normalised (section 6; Rogers 1985)."""
    return _one("perturbed_normal", n, Qu, Qw, Pu, Pw)


def view(s: Like, n: Like, Qu: Like, Qw: Like) -> View:
    """sn = s.n/|n|,  a = s.(Qw x n)/|n|^2,  b = s.(n x Qu)/|n|^2."""
    return View(*_run("view", s, n, Qu, Qw))


def place(v: View, u0: Like, w0: Like, tau: Like) -> Place:
    """(u,w) = (u0,w0) + (a,b) tau: below the shifted point; the place to shade (ours). Exact on a plane."""
    return Place(*_run("place", v, u0, w0, tau))


def offset(n: Like, Qu: Like, Qw: Like, Quu: Like, Quw: Like, Qww: Like, h: Like) -> Offset:
    """The partials of Q + h n/|n| (ours). In perturbed_normal they give the rough surface's own normal."""
    return Offset(*_run("offset", n, Qu, Qw, Quu, Quw, Qww, h))


def curvature(v: View, n: Like, Quu: Like, Quw: Like, Qww: Like) -> Real:
    """L a^2 + 2 M a b + N b^2: the smooth surface's curvature along the ray (ours; the paper leaves it out)."""
    return _one("curvature", v, n, Quu, Quw, Qww)


# ---- the shift ----


def gap(v: View, curvature: Like, tau: Like, P: Like) -> Real:
    """gap(tau) = tau (s.n/|n|) - 1/2 curvature tau^2 - P, with P at (u0 + a tau, w0 + b tau): 0 at the true shift."""
    return _one("gap", v, curvature, tau, P)


def tau0(n: Like, s: Like, P: Like) -> Real:
    """Order 0, a plane at height P parallel to the tangent plane (section 6):  tau = P |n|/(s.n)."""
    return _one("tau0", n, s, P)


def slope(v: View, p: Bump) -> Real:
    """B = Pu a + Pw b - s.n/|n| = -(s.n')/|n|: from the front it is positive where the ray enters the rough plane."""
    return _one("slope", v, p)


def tau1(v: View, p: Bump) -> Real:
    """Order 1, the tangent plane of the rough surface (section 6):  tau = P |n|/(s.n')."""
    return _one("tau1", v, p)


def quadratic(v: View, p: Bump) -> Real:
    """A = 1/2 (Puu a^2 + Pww b^2), as in section 4.1."""
    return _one("quadratic", v, p)


def quadratic_plus(v: View, p: Bump, curvature: Like) -> Real:
    """A = 1/2 (Puu a^2 + 2 Puw a b + Pww b^2 + curvature) of 2+ (ours)."""
    return _one("quadratic_plus", v, p, curvature)


def discriminant(A: Like, B: Like, P: Like) -> Real:
    """B^2 - 4 A P: negative where the ray does not meet the quadric."""
    return _one("discriminant", A, B, P)


def tau2(v: View, p: Bump) -> Real:
    """Order 2 (section 4.1): the root of A tau^2 + B tau + P = 0 that tends to order 1 as A -> 0. NaN: no real root."""
    return _one("tau2", v, p)


def tau2_plus(v: View, p: Bump, curvature: Like) -> Real:
    """2+ (ours): order 2 with Puw and the smooth surface's curvature. NaN: no real root."""
    return _one("tau2_plus", v, p, curvature)


def slab(v: View, Pmin: Like, Pmax: Like) -> Slab:
    """The true tau lies between Pmin/(s.n/|n|) and Pmax/(s.n/|n|) (ours)."""
    return Slab(*_run("slab", v, Pmin, Pmax))


def shift(order: int, v: View, p: Bump, slab: Slab, *, curvature: Like = 0.0, guard: bool = True) -> Shift:
    """tau by order 0, 1, 2 or 3 (2+).

    With the guard (ours) a result outside the slab, or where the ray does not enter the rough surface's tangent plane,
    falls back: 3 and 2 to 1, 1 to 0. Without it only an order 2 without a real root does.
    """
    if order not in (0, 1, 2, 3):
        raise ValueError(f"order {order}: expected 0, 1, 2 or 3 (which is 2+)")
    return Shift(*_run("shift", order, int(guard), v, curvature, p, slab))


def iterate(v: View, height: Height, u0: Like, w0: Like, times: int) -> Shift:
    """iter:K (ours): order 0, repeated with P at the place that the last tau leads to. Once is order 0."""
    _count("times", times)
    tau: Like = np.zeros_like(v.sn)
    for _ in range(times):
        p = Bump(height(*place(v, u0, w0, tau)))
        tau = shift(0, v, p, Slab(0.0, 0.0)).tau
    return Shift(np.asarray(tau), np.full_like(tau, 4, dtype=np.int32))


def march_start(slab: Slab) -> March:
    """The state before step 0."""
    return March(*_run("march_start", slab))


def march_tau(slab: Slab, i: int, steps: int) -> Real:
    """The place of step i of 0..steps."""
    return _one("march_tau", slab, i, steps)


def march_step(m: March, tau: Like, gap: Like, v: View) -> March:
    """One step; at the first point that is not above the rough surface a secant finds the shift."""
    return March(*_run("march_step", m, tau, gap, v))


def march(v: View, height: Height, u0: Like, w0: Like, slab: Slab, steps: int, *, curvature: Like = 0.0) -> Shift:
    """march:N (ours): N equal steps through the slab, to the first point on or below the rough surface, then a secant.

    Where none is found (the slab is infinite, or the surface curves away) it is order 0.
    """
    _count("steps", steps)
    m = march_start(slab)
    for i in range(steps + 1):
        tau = march_tau(slab, i, steps)
        m = march_step(m, tau, gap(v, curvature, tau, height(*place(v, u0, w0, tau))), v)
    found = np.asarray(m.found) != 0
    zero = shift(0, v, Bump(height(*place(v, u0, w0, 0.0))), slab)
    return Shift(np.where(found, m.tau, zero.tau), np.where(found, np.int32(5), zero.order))


def residual(v: View, curvature: Like, tau: Like, there: Bump) -> Real:
    """What tau lacks (ours): gap over its slope, with P, Pu and Pw at `place`. Added to tau it is Newton's step."""
    return _one("residual", v, curvature, tau, there)


def pixels(s: Like, d: Like, pixel: Like, residual: Like) -> Real:
    """So many pixels is a shadow's edge off by that (ours). d: to the light; pixel: a pixel's size at the hit."""
    return _one("pixels", s, d, pixel, residual)


# ---- the bumps' own shadows ----


def way(side: Like, d: View, curvature: Like, P: Like, Pmin: Like, Pmax: Like) -> Way:
    """The way from X = Q + P n/|n| to a light (ours). d: view(light - X, ...). side: -1 for a view from behind."""
    side_, sn, a, b, bend, at, end = _run("way", side, d, curvature, P, Pmin, Pmax)
    return Way(side_, View(sn, a, b), bend, at, end)


def turn(d: View, n: Like, Qu: Like, Qw: Like, Quu: Like, Quw: Like, Qww: Like) -> Turn:
    """How a straight way bends in (u,w) over a curved surface (ours)."""
    return Turn(*_run("turn", d, n, Qu, Qw, Quu, Quw, Qww))


def way_step(end: Like, i: int, steps: int) -> Real:
    """t of step i of 1..steps: end (i/steps)^2, denser near X."""
    return _one("way_step", end, i, steps)


def way_below(y: Way, t: Like, P: Like) -> npt.NDArray[np.bool_]:
    """Whether the way is below P at t."""
    return np.not_equal(_one("way_below", y, t, P), 0)


def own_shadow(y: Way, height: Height, u: Like, w: Like, steps: int, *, turn: Turn | None = None) -> Real:
    """Whether bumps stand in the way (ours; Max 1986 is the problem). u, w: of X, the place that is shaded.

    A place that n' turns away from the light is dark, too; that is not in the result.
    """
    _count("steps", steps)
    bend = turn or Turn(0.0, 0.0)
    dark: Real = np.zeros(np.shape(y.end), np.bool_)
    for i in range(1, steps + 1):
        t = way_step(y.end, i, steps)
        at = place(y.d, u, w, t)
        dark = dark | way_below(y, t, height(at.u + np.multiply(bend.A, t) * t, at.w + np.multiply(bend.B, t) * t))
    return dark


def bearing(d: View, ku: Like, kw: Like) -> Bearing:
    """A light's direction and rise for Max's table of horizons, in samples (ours). ku, kw: samples per u and per w."""
    return Bearing(*_run("bearing", d, ku, kw))


def horizon(at_k: Like, at_next: Like, fraction: Like) -> Real:
    """Between the horizons of two directions next to each other."""
    return _one("horizon", at_k, at_next, fraction)


def horizon_share(above: Like, u: Like, w: Like, least: Like) -> Real:
    """The share of an area light above the horizon (ours): the part of the square -1..1 where above + u x + w y > 0."""
    return _one("horizon_share", above, u, w, least)


def _count(what: str, n: int) -> None:
    if n < 1:
        raise ValueError(f"{what}={n}: expected 1 or more")
