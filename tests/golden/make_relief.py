#!/usr/bin/env python3
"""Golden vectors for shading at the shifted place and for the bumps' own shadows: writes relief.json beside this file.

Nothing here comes from kage. Surfaces are known by their points alone, and by the nearest point of each in closed form;
all is computed by mpmath with 50 digits. What is true is found without kage's approximations: the nearest point (foot)
of the smooth surface, the height over it, and shadows and horizons by brute force.

    python3 -m venv venv && venv/bin/pip install mpmath && venv/bin/python tests/golden/make_relief.py

`places`: viewing rays Q + s tau at a smooth hit, tau that of order 0, for bumps A, A/2, A/4, ... high; `across`: how
far apart the ways to a light are that start 1 apart in tau.
`ways`: ways to a light from a place X of the rough surface; `dark` by 400 heights of the way, until it is above all
bumps, or, where a hollow surface rises more than the way and it never gets there, until it is highest.
`horizons`: how much P rises from a place in the directions of a horizon map, and towards lights between these.
`shares`: the part of the square -1..1 where above + u x + w y > 0, in fractions.
"""
import json
import os
import random
from fractions import Fraction

import mpmath
from mpmath import mp, mpf

mp.dps = 50
ORDERS = {"Q": (0, 0), "Qu": (1, 0), "Qw": (0, 1), "Quu": (2, 0), "Quw": (1, 1), "Qww": (0, 2)}
KINDS = ("plane", "sphere", "cylinder", "torus")
HALVINGS = 4  # of the bumps' height and, with it, of the distances
FEW, SAMPLES = 50, 400  # of a way to a light: to choose cases, and for their truth
DIRECTIONS = 32  # of a horizon map; a map of 8 or 16 has every fourth or second


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def add(a, b, k=1):
    return [x + k * y for x, y in zip(a, b, strict=True)]


def times(a, k):
    return [x * k for x in a]


def unit(a):
    return times(a, 1 / mp.sqrt(dot(a, a)))


def turned(angle, near):
    """The same angle, by whole turns, next to another."""
    return angle + 2 * mp.pi * mp.nint((near - angle) / (2 * mp.pi))


class Surface:
    """A smooth surface. `inward`: u and w change their roles, so that the normal points the other way."""

    def __init__(self, kind, inward, rng):
        self.kind, self.inward = kind, inward
        e = [unit([mpf(rng.uniform(-1, 1)) for _ in range(3)])]
        e.append(unit(cross(e[0], [mpf(rng.uniform(-1, 1)) for _ in range(3)])))
        self.frame = e + [cross(e[0], e[1])]
        self.centre = [mpf(rng.uniform(-1, 1)) for _ in range(3)]
        self.radius, self.tube = mpf(rng.uniform(1, 1.5)), mpf(rng.uniform(0.5, 0.7))
        self.skew = mpf(rng.uniform(-0.4, 0.4))

    def out_of(self, x, y, z):
        return add(add(add(self.centre, self.frame[0], x), self.frame[1], y), self.frame[2], z)

    def point(self, u, w):
        if self.inward:
            u, w = w, u
        if self.kind == "plane":
            return self.out_of(self.radius * u + self.skew * w, w, 0)
        if self.kind == "cylinder":
            return self.out_of(self.radius * mp.cos(u), self.radius * mp.sin(u), w)
        ring, r = (0, self.radius) if self.kind == "sphere" else (self.radius, self.tube)
        flat = ring + r * mp.cos(w)
        return self.out_of(flat * mp.cos(u), flat * mp.sin(u), r * mp.sin(w))

    def normal(self, u, w):
        """Of unit length."""
        if self.inward:
            u, w = w, u
        w = mpf(0) if self.kind == "cylinder" else w
        n = self.frame[2]
        if self.kind != "plane":
            flat = add(times(self.frame[0], mp.cos(u)), self.frame[1], mp.sin(u))
            n = add(times(flat, mp.cos(w)), n, mp.sin(w))
        return times(n, -1) if self.inward else n

    def foot(self, x, u, w):
        """The nearest point (u,w), next to the given one, and the height over it along the normal."""
        x, y, z = (dot(add(x, self.centre, -1), axis) for axis in self.frame)
        if self.inward:
            u, w = w, u
        if self.kind == "plane":
            found = (x - self.skew * y) / self.radius, y, z
        elif self.kind == "cylinder":
            found = turned(mp.atan2(y, x), u), z, mp.hypot(x, y) - self.radius
        else:
            ring, r = (0, self.radius) if self.kind == "sphere" else (self.radius, self.tube)
            flat = mp.hypot(x, y) - ring
            found = turned(mp.atan2(y, x), u), turned(mp.atan2(z, flat), w), mp.hypot(flat, z) - r
        return (found[1], found[0], -found[2]) if self.inward else found

    def partials(self, u, w):
        return {name: [mp.diff(lambda a, b, k=k: self.point(a, b)[k], (u, w), order) if sum(order) else
                       self.point(u, w)[k] for k in range(3)] for name, order in ORDERS.items()}


class Bumps:
    """P = A (sin(f0 u + p0) cos(f1 w + p1) + sin(f2 u + f3 w + p2)/2), by its A, f0 to f3 and p0 to p2."""

    def __init__(self, rng, height=0.1):
        self.A = mpf(rng.uniform(0.6 * height, height))
        self.f = [mpf(rng.uniform(2, 4)) for _ in range(4)]
        self.p = [mpf(rng.uniform(0, 6)) for _ in range(3)]

    def __call__(self, u, w):
        f, p = self.f, self.p
        return self.A * (mp.sin(f[0] * u + p[0]) * mp.cos(f[1] * w + p[1]) + mp.sin(f[2] * u + f[3] * w + p[2]) / 2)

    def partials(self, u, w):
        return mp.diff(self, (u, w), (1, 0)), mp.diff(self, (u, w), (0, 1))

    def numbers(self):
        return [self.A, *self.f, *self.p]


def tangent(q, v):
    """s.n/|n| and the rates of u and w: v = s.n/|n| n + a Qu + b Qw, solved without the paper's formulas."""
    n = unit(cross(q["Qu"], q["Qw"]))
    E, F, G = dot(q["Qu"], q["Qu"]), dot(q["Qu"], q["Qw"]), dot(q["Qw"], q["Qw"])
    x, y = dot(v, q["Qu"]), dot(v, q["Qw"])
    return dot(v, n), (x * G - y * F) / (E * G - F * F), (y * E - x * F) / (E * G - F * F)


def curvature(q, a, b):
    n = unit(cross(q["Qu"], q["Qw"]))
    return dot(q["Quu"], n) * a * a + 2 * dot(q["Quw"], n) * a * b + dot(q["Qww"], n) * b * b


def anywhere(rng):
    """A place of any surface, off a sphere's poles."""
    return mpf(rng.uniform(-1, 1)), mpf(rng.uniform(-1, 1))


def direction(rng, n, lowest, highest):
    """A unit vector at an angle in degrees above the tangent plane."""
    flat = unit(cross(n, [mpf(rng.uniform(-1, 1)) for _ in range(3)]))
    angle = mp.radians(mpf(rng.uniform(lowest, highest)))
    return add(times(flat, mp.cos(angle)), n, mp.sin(angle))


# The place to shade ---------------------------------------------------------------------------------

def place_row(surface, bumps, q, s, u0, w0):
    """For one height of the bumps; None where the ray's hit is not next to order 0's."""
    P, (sn, a, b) = bumps(u0, w0), tangent(q, s)
    tau = P / sn

    def true_gap(t):
        u, w, h = surface.foot(add(q["Q"], s, t), u0, w0)
        return h - bumps(u, w)

    u, w, h = surface.foot(add(q["Q"], s, tau), u0, w0)
    u1, w1 = u0 + a * tau, w0 + b * tau
    one = surface.partials(u1, w1)
    rest = add(add(q["Q"], s, tau), one["Q"], -1)
    _, a1, b1 = tangent(one, rest)
    gap = tau * sn - curvature(q, a, b) * tau * tau / 2 - bumps(u1, w1)
    hit = mp.findroot(true_gap, (tau, tau * mpf("0.99")))
    if abs(hit - tau) > abs(tau) / 2:
        return None
    return [bumps.A, tau, P, u1, w1, bumps(u1, w1), *bumps.partials(u1, w1), gap, *rest, *one["Qu"], *one["Qw"],
            u1 + a1, w1 + b1, u, w, h, true_gap(tau), hit]


PLACE_COLUMNS = ["A", "tau of order 0", "P at the hit", "u + a tau", "w + b tau", "P, Pu, Pw there",
                 "tau sn - curvature tau^2/2 - P there", "Q + s tau - Q there: x, y, z", "Qu there", "Qw there",
                 "u and w moved again by a and b of that rest", "true foot u, w", "true height over it",
                 "true gap", "tau of the true hit"]


def place(kind, inward, behind, rng):
    """A case, or None."""
    surface, bumps, (u0, w0) = Surface(kind, inward, rng), Bumps(rng), anywhere(rng)
    q = surface.partials(u0, w0)
    n = surface.normal(u0, w0)
    s = times(direction(rng, n, 25, 70) if behind else direction(rng, n, -70, -25), mpf(rng.uniform(0.7, 1.4)))
    if abs(bumps(u0, w0)) < bumps.A / 4:
        return None
    rows = []
    for _ in range(HALVINGS):
        rows.append(place_row(surface, bumps, q, s, u0, w0))
        bumps.A /= 2
    bumps.A *= 2**HALVINGS
    if None in rows:
        return None
    sn, a, b = tangent(q, s)
    light = [mpf(x) for x in (3, -2, 4)]
    across = add(s, light, -dot(s, light) / dot(light, light))
    return {"surface": kind, "inward": int(inward), "bumps": bumps.numbers(), "u": u0, "w": w0, **q, "s": s, "sn": sn,
            "a": a, "b": b, "curvature": curvature(q, a, b), "light": light, "across": mp.sqrt(dot(across, across)),
            "rows": rows}


# The way to a light ---------------------------------------------------------------------------------

def raised(surface, height, u, w, order):
    """A partial of Q + height n/|n|, by differences of its points."""
    return [mp.diff(lambda a, b, k=k: surface.point(a, b)[k] + height(a, b) * surface.normal(a, b)[k], (u, w), order)
            for k in range(3)]


def formula_end(sn, k, rise):
    """The first t > 0 at which sn t - k t^2/2 reaches the rise, or is highest; 1 where the light comes before."""
    roots = [rise / sn] if k == 0 else mp.polyroots([-k / 2, sn, -rise], maxsteps=200, extraprec=200)
    real = [x.real for x in map(mp.mpc, roots) if abs(x.imag) < mpf(10)**-20]
    return min([x for x in real if x > 0] + [mpf(1)] + ([sn / k] if not real and sn > 0 else []))


def true_end(height, top):
    """As formula_end, of a true height, by equal steps and then by halving."""
    step = mpf(1) / FEW
    for i in range(1, FEW + 1):
        before, t = (i - 1) * step, i * step
        if height(t) >= top:
            return mp.findroot(lambda x: height(x) - top, (before, t), solver="anderson", tol=1e-30)
        if i > 1 and height(before - step) <= height(before) > height(t):
            lo, hi = before - step, t
            for _ in range(100):
                x, y = lo + (hi - lo) / 3, hi - (hi - lo) / 3
                lo, hi = (lo, y) if height(x) > height(y) else (x, hi)
            return lo
    return mpf(1)


def true_way(surface, bumps, start, d, side, u, w, top, samples):
    """Of brute force: where the way ends, and the least gap over t, which is < 0 where it is dark. That is the tangent
    of an angle, times |d|: how far the light would have to move for the other answer."""
    def at(t):
        foot = surface.foot(add(start, d, t), u, w)
        return side * foot[2], side * (foot[2] - bumps(foot[0], foot[1]))

    end = true_end(lambda t: at(t)[0], top)
    places = [end * (mpf(i) / samples)**2 for i in range(1, samples + 1)]
    return end, min(at(t)[1] / t for t in places)


def way_rows(surface, bumps, q, n, d, u, w):
    """Heights of ways from the rough surface, both shrinking with A: A, t, the formula's height, the true one, the
    moved place and the true foot."""
    rows, A = [], bumps.A
    sn, a, b = tangent(q, d)
    for i in range(HALVINGS):
        bumps.A, t = A / 2**i, mpf(1) / 4 / 2**i / mp.sqrt(dot(d, d))
        P = bumps(u, w)
        foot = surface.foot(add(add(q["Q"], n, P), d, t), u, w)
        rows.append([bumps.A, t, P + sn * t - curvature(q, a, b) * t * t / 2, foot[2], u + a * t, w + b * t, foot[0],
                     foot[1]])
    bumps.A = A
    return rows


def way(kind, inward, side, dark, rng):
    """A case, or None."""
    surface, bumps, (u, w) = Surface(kind, inward, rng), Bumps(rng, 0.16), anywhere(rng)
    q = surface.partials(u, w)
    n, P, (Pu, Pw) = surface.normal(u, w), bumps(u, w), bumps.partials(u, w)
    hollow = kind != "plane" and inward != (side < 0)  # seen from there
    angle = rng.uniform(2, 24) if hollow or kind == "plane" else rng.uniform(-6, 24)
    d = direction(rng, n, *((angle, angle) if side > 0 else (-angle, -angle)))
    # in a hollow a way must stay away from the middle, where a point has no nearest one
    least = min(surface.radius, surface.tube) if kind == "torus" else surface.radius
    d = times(d, mpf(rng.uniform(0.5, 1.6)) * least * mp.sin(mp.radians(angle)) if hollow else mpf(rng.uniform(2, 3)))
    sn, a, b = tangent(q, d)
    k, highest = curvature(q, a, b), mpf("1.5") * bumps.A
    if (true_way(surface, bumps, add(q["Q"], n, P), d, side, u, w, highest, FEW)[1] < 0) != dark:
        return None
    end, clearance = true_way(surface, bumps, add(q["Q"], n, P), d, side, u, w, highest, SAMPLES)
    offset = [raised(surface, lambda *_: P, u, w, order) for order in ((1, 0), (0, 1))]
    rough = unit(cross(*(raised(surface, bumps, u, w, order) for order in ((1, 0), (0, 1)))))
    turn = unit(add(add(cross(q["Qu"], q["Qw"]), cross(n, q["Qw"]), Pu), cross(q["Qu"], n), Pw))
    return {"surface": kind, "inward": int(inward), "side": side, "bumps": bumps.numbers(), "u": u, "w": w, **q,
            "P": P, "Pu": Pu, "Pw": Pw, "n_perturbed": turn, "offset": offset[0] + offset[1],
            "n_rough": rough, "highest": highest, "d": d, "sn": sn, "a": a, "b": b,
            "curvature": k, "end": formula_end(side * sn, side * k, highest - side * P), "true_end": end,
            "dark": int(clearance < 0), "clearance": clearance, "rows": way_rows(surface, bumps, q, n, d, u, w)}


# Horizons -------------------------------------------------------------------------------------------

def heading(bearing):
    """0 along +x, 1 along +y, 2 and 3 against them; |x| + |y| = 1."""
    turn, part = int(mp.floor(bearing)) % 4, bearing - mp.floor(bearing)
    x, y = [(1 - part, part), (-part, 1 - part), (part - 1, -part), (part, part - 1)][turn]
    return x, y


def horizon(bumps, u, w, du, dw):
    """The most that P rises from (u,w) along (du,dw), per unit of these: from dense samples, then by halving."""
    P, top = bumps(u, w), mpf("1.5") * bumps.A

    def rise(t):
        return (bumps(u + du * t, w + dw * t) - P) / t

    best, at, step = mpf("-inf"), mpf(0), mpf(1) / 40 / max(abs(du), abs(dw)) / 4
    i = 1
    while best <= 0 or (top - P) / (i * step) > best:
        if rise(i * step) > best:
            best, at = rise(i * step), i * step
        i += 1
        if i > 4000:
            break
    lo, hi = max(at - step, step / 1000), at + step
    for _ in range(120):  # ternary search: one hill between the samples next to the highest
        x, y = lo + (hi - lo) / 3, hi - (hi - lo) / 3
        lo, hi = (lo, y) if rise(x) > rise(y) else (x, hi)
    slope = bumps.partials(u, w)
    return max(rise((lo + hi) / 2), slope[0] * du + slope[1] * dw)


def horizons(rng):
    bumps, (u, w) = Bumps(rng), anywhere(rng)
    ku, kw = mpf(rng.randint(20, 60)), mpf(rng.randint(20, 60))
    if bumps(u, w) > bumps.A / 2:
        return None
    all_around = [horizon(bumps, u, w, x / ku, y / kw) for x, y in (heading(mpf(4 * i) / DIRECTIONS)
                                                                  for i in range(DIRECTIONS))]
    lights = []
    for _ in range(6):
        bearing, length, sn = mpf(rng.uniform(0, 4)), mpf(rng.uniform(5, 200)), mpf(rng.uniform(0.01, 1))
        x, y = heading(bearing)
        lights.append([x * length / ku, y * length / kw, sn, bearing, sn / length,
                       horizon(bumps, u, w, x / ku, y / kw)])
    return {"bumps": bumps.numbers(), "u": u, "w": w, "ku": ku, "kw": kw, "around": all_around, "lights": lights}


def positive_part(above, u, w):
    """Of the square -1..1: the polygon that is left of it, by its area."""
    corners = [(Fraction(x), Fraction(y)) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    values = [above + u * x + w * y for x, y in corners]
    left = []
    for i in range(4):
        (p, f), (q, g) = (corners[i], values[i]), (corners[(i + 1) % 4], values[(i + 1) % 4])
        if f > 0:
            left.append(p)
        if (f > 0) != (g > 0):
            left.append((p[0] + (q[0] - p[0]) * f / (f - g), p[1] + (q[1] - p[1]) * f / (f - g)))
    area = sum(p[0] * q[1] - p[1] * q[0] for p, q in zip(left, left[1:] + left[:1], strict=True))
    return area / 8


def share(rng, i):
    above, u, w = (Fraction(rng.randint(-2048, 2048), 1024) for _ in range(3))
    u, w = (u * Fraction(1, 256), w) if i % 5 == 0 else (u, w)
    return [above, u, w, positive_part(above, u, w)]


# The file -------------------------------------------------------------------------------------------

def number(x):
    if isinstance(x, Fraction):
        return float(x)
    return x if isinstance(x, (int, str)) else float(x)


def plain(x):
    if isinstance(x, dict):
        return {key: plain(value) for key, value in x.items()}
    return [plain(v) for v in x] if isinstance(x, list) else number(x)


def many(n, make):
    """n cases that are not None."""
    found = []
    while len(found) < n:
        case = make()
        if case is not None:
            found.append(case)
    return found


def main():
    rng = random.Random(20261126)
    places, ways = [], []
    for kind in KINDS:
        for inward in (False, True):
            for behind in (False, True):
                places += many(2 if behind else 4, lambda: place(kind, inward, behind, rng))
            for side in (1, -1):
                for dark in (False, True):
                    ways += many(6 if side > 0 else 3, lambda: way(kind, inward, side, dark, rng))
    parts = {"places": places, "ways": ways, "horizons": many(12, lambda: horizons(rng)),
             "shares": [share(rng, i) for i in range(60)]}
    about = {"made_by": f"make_relief.py, mpmath {mpmath.__version__}, {mp.dps} digits",
             "P": "A (sin(f0 u + p0) cos(f1 w + p1) + sin(f2 u + f3 w + p2)/2); bumps: A, f0 to f3, p0 to p2",
             "rows of places": PLACE_COLUMNS,
             "rows of ways": ["A", "t", "P + sn t - curvature t^2/2", "true height", "u + a t", "w + b t",
                              "true foot u, w"],
             "lights of horizons": ["a", "b", "sn", "bearing", "rise", "horizon"],
             "rows of shares": ["above", "u", "w", "share"]}
    text = ['{"about": ' + json.dumps(about)]
    for name, cases in parts.items():
        text.append(f',"{name}": [\n' + ",\n".join(json.dumps(plain(case)) for case in cases) + "]")
    text.append("}")
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "relief.json"), "w", encoding="utf-8") as file:
        file.write("\n".join(text) + "\n")


if __name__ == "__main__":
    main()
