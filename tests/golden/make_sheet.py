#!/usr/bin/env python3
"""Golden partials of surfaces that are known by their points alone: writes sheet.json beside this file.

Nothing here comes from kage. Functions are evaluated as Python by mpmath with 50 digits, their partials are mpmath's
numerical ones at that precision; Bezier patches by Bernstein's polynomials in fractions, differentiated term by term,
without any rounding.

    python3 -m venv venv && venv/bin/pip install mpmath && venv/bin/python tests/golden/make_sheet.py
"""
import json
import math
import os
import random
from fractions import Fraction

import mpmath
from mpmath import mp, mpf

mp.dps = 50
NAMES = {"sin": mp.sin, "cos": mp.cos, "exp": mp.exp, "abs": abs, "pi": mpf(math.pi)}
ORDERS = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]

MOEBIUS = ["(1.2 + w*cos(u/2))*cos(u)", "0.9 + w*sin(u/2)", "(1.2 + w*cos(u/2))*sin(u)"]
SHELL = ["exp(0.17*w)*(1+cos(u))*cos(w)/8", "2 - exp(0.17*w)*(sin(u) + 1.8)*0.15", "exp(0.17*w)*(1+cos(u))*sin(w)/8"]
RING = "1 + 0.5*cos(u/2)*sin(w) - 0.5*sin(u/2)*sin(2*w)"
KLEIN = [f"({RING})*cos(u)", "sin(u/2)*sin(w) + cos(u/2)*sin(2*w)", f"({RING})*sin(u)"]
FUNCTIONS = [(MOEBIUS, (0, 2), (-1, 1)), (SHELL, (0, 6), (-9, 9)), (KLEIN, (0, 6), (0, 6))]


def dyadic(rng, lo, hi):
    """A number that a float holds, too, so that both builds are asked for the same place."""
    return round(rng.uniform(lo, hi) * 4096) / 4096


def of_function(text, u, w):
    code = compile(text, "golden", "eval")

    def f(x, y):
        return eval(code, dict(NAMES, u=x, w=y))

    return [f(mpf(u), mpf(w)) if order == (0, 0) else mp.diff(f, (mpf(u), mpf(w)), order) for order in ORDERS]


def bernstein(t, derivative):
    """Bernstein's polynomials of degree 3, by their coefficients in powers of t."""
    powers = [[1, -3, 3, -1], [0, 3, -6, 3], [0, 0, 3, -3], [0, 0, 0, 1]]
    for _ in range(derivative):
        powers = [[k * c for k, c in enumerate(p)][1:] for p in powers]
    return [sum(c * t**k for k, c in enumerate(p)) for p in powers]


def of_patch(points, axis, u, w):
    values = []
    for du, dw in ORDERS:
        a, b = bernstein(Fraction(u), du), bernstein(Fraction(w), dw)
        exact = sum(b[j] * a[i] * Fraction(points[4 * j + i][axis]) for j in range(4) for i in range(4))
        values.append(mpf(exact.numerator) / exact.denominator)
    return values


def number(x):
    return repr(float(x))


def main():
    rng = random.Random(20261122)
    out = [f'{{"made_by": "make_sheet.py, mpmath {mpmath.__version__}, {mp.dps} digits",',
           '"columns": ["u", "w", "Q", "Qu", "Qw", "Quu", "Quw", "Qww: each x, y, z"],', '"functions": [']
    for k, (texts, U, W) in enumerate(FUNCTIONS):
        out.append(f'{{"xyz": {json.dumps(texts)}, "rows": [')
        rows = []
        for _ in range(12):
            u, w = dyadic(rng, *U), dyadic(rng, *W)
            axes = [of_function(text, u, w) for text in texts]
            rows.append("[" + ",".join(map(number, [u, w] + [axes[a][o] for o in range(6) for a in range(3)])) + "]")
        out.append(",\n".join(rows) + "]}" + ("," if k < len(FUNCTIONS) - 1 else ""))
    out.append('],\n"patches": [')
    for k in range(3):
        points = [[dyadic(rng, -2, 2) for _ in range(3)] for _ in range(16)]
        rows = []
        places = [(0, 0), (1, 0), (0, 1), (1, 1),
                  (0.5, 0.5)] + [(dyadic(rng, 0, 1), dyadic(rng, 0, 1)) for _ in range(10)]
        for u, w in places:
            axes = [of_patch(points, a, u, w) for a in range(3)]
            rows.append("[" + ",".join(map(number, [u, w] + [axes[a][o] for o in range(6) for a in range(3)])) + "]")
        out.append(f'{{"points": {json.dumps(points)}, "rows": [\n' + ",\n".join(rows) + "]}" + ("," if k < 2 else ""))
    out.append("]}")
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "sheet.json"), "w", encoding="utf-8") as file:
        file.write("\n".join(out) + "\n")


if __name__ == "__main__":
    main()
