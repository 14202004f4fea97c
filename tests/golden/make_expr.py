#!/usr/bin/env python3
"""Golden values for the expression language: writes expr.json beside this file.

Nothing here comes from kage: each text is evaluated as Python (with ** for ^, which binds and associates
the same way) by mpmath with 50 digits, and its partials are mpmath's numerical ones at that precision, good
to far more digits than a double has. Noise is written anew from its description in src/math/noise.h.

    python3 -m venv venv && venv/bin/pip install mpmath && venv/bin/python tests/golden/make_expr.py
"""
import json
import math
import os
import random

import mpmath
from mpmath import mp, mpf

mp.dps = 50


def mod(a, b):
    q = a / b
    return a - b * (mp.floor(q) if q >= 0 else mp.ceil(q))


def select(a, b, c, d=None):
    return b if a < 0 else c if d is None or a == 0 else d


def smoothstep(a, b, x):
    t = min(max((x - a) / (b - a), 0), 1)
    return t * t * (3 - 2 * t)


def mix(h):
    h = (h ^ h >> 16) * 0x7FEB352D % 2**32
    h = (h ^ h >> 15) * 0x846CA68B % 2**32
    return h ^ h >> 16


def noise(x, y):
    x, y = mpf(x), mpf(y)
    i, j = int(mp.floor(x)), int(mp.floor(y))
    a, b = x - i, y - j

    def ramp(di, dj):
        angle = 2 * mp.pi * mix((i + di + mix((j + dj) % 2**32)) % 2**32) / 2**32
        return mpf(1.4142135) * (mp.cos(angle) * (a - di) + mp.sin(angle) * (b - dj))

    def fade(t):
        return 6 * t**5 - 15 * t**4 + 10 * t**3

    near = ramp(0, 0) + fade(a) * (ramp(1, 0) - ramp(0, 0))
    far = ramp(0, 1) + fade(a) * (ramp(1, 1) - ramp(0, 1))
    return near + fade(b) * (far - near)


NAMES = dict(
    sin=mp.sin, cos=mp.cos, tan=mp.tan, asin=mp.asin, acos=mp.acos, atan=mp.atan, atan2=mp.atan2,
    sinh=mp.sinh, cosh=mp.cosh, tanh=mp.tanh, exp=mp.exp, log=mp.log, sqrt=mp.sqrt, floor=mp.floor,
    abs=abs, min=min, max=max, pow=lambda a, b: mpf(a) ** b, mod=mod, noise=noise, select=select,
    smoothstep=smoothstep,
    clamp=lambda x, lo, hi: min(max(x, lo), hi), pi=mpf(math.pi))

# text, range of u, range of w, points
CASES = [
    ("sin(u)", (-30, 30), (-1, 1), 40),
    ("sin(u)", (-90000, 90000), (-1, 1), 20),
    ("cos(u)", (-30, 30), (-1, 1), 40),
    ("cos(w)", (-1, 1), (-90000, 90000), 20),
    ("tan(u)", (-1.5, 1.5), (-1, 1), 30),
    ("tan(w)", (-1, 1), (-20, 20), 20),
    ("asin(u)", (-0.999, 0.999), (-1, 1), 30),
    ("acos(u)", (-0.999, 0.999), (-1, 1), 30),
    ("atan(u)", (-5, 5), (-1, 1), 30),
    ("atan(1000*u)", (-5, 5), (-1, 1), 10),
    ("atan2(u, w)", (-3, 3), (-3, 3), 40),
    ("sinh(u)", (-3, 3), (-1, 1), 30),
    ("sinh(u)", (-40, 40), (-1, 1), 20),
    ("sinh(u/1000)", (-3, 3), (-1, 1), 10),
    ("cosh(u)", (-40, 40), (-1, 1), 30),
    ("tanh(u)", (-4, 4), (-1, 1), 30),
    ("tanh(u)", (-25, 25), (-1, 1), 15),
    ("exp(u)", (-5, 5), (-1, 1), 30),
    ("exp(u)", (-300, 300), (-1, 1), 20),
    ("log(u)", (0.01, 4), (-1, 1), 30),
    ("log(u)", (1, 1e6), (-1, 1), 20),
    ("sqrt(u)", (0.01, 9), (-1, 1), 30),
    ("abs(u)", (-3, 3), (-1, 1), 12),
    ("floor(u)*w", (-30, 30), (-3, 3), 12),
    ("min(u, w)", (-3, 3), (-3, 3), 16),
    ("max(u, w, u*w, 0.25)", (-3, 3), (-3, 3), 30),
    ("mod(u, w)", (-30, 30), (0.5, 3), 30),
    ("mod(u*u, -w)", (-3, 3), (0.5, 3), 20),
    ("pow(u, w)", (0.1, 6), (-6, 6), 50),
    ("u^2.5", (0.01, 6), (-1, 1), 20),
    ("u^-0.75", (0.01, 6), (-1, 1), 15),
    ("u^2 - w^3", (-3, 3), (-3, 3), 20),
    ("u^16 + w^7", (-2, 2), (-2, 2), 20),
    ("u^-2 - w^-5", (0.5, 3), (-3, -0.5), 20),
    ("u^20 + w^-17", (-2, -0.5), (-2, -0.5), 15),
    ("2^u * 0.5^w", (-5, 5), (-5, 5), 20),
    ("2^-u^2", (-2, 2), (-1, 1), 10),
    ("-u^2 + -2^u", (-2, 2), (-1, 1), 10),
    ("2^u^w", (0.5, 2), (-1.5, 1.5), 15),
    ("clamp(u*w, -0.5, 0.75)", (-2, 2), (-2, 2), 30),
    ("select(u, w*w, sin(w))", (-2, 2), (-2, 2), 20),
    ("select(u-w, u*u, w, w*u)", (-2, 2), (-2, 2), 20),
    ("noise(u, w)", (-20, 20), (-20, 20), 90),
    ("noise(u, w)", (-3e9, 3e9), (-3e9, 3e9), 20),
    ("noise(3*u + w*w, 2.5*w - sin(u))", (-3, 3), (-3, 3), 30),
    ("u", (-3, 3), (-3, 3), 3),
    ("pi", (-3, 3), (-3, 3), 2),
    ("1 - u", (-3, 3), (-3, 3), 4),
    ("u/w", (-3, 3), (0.25, 3), 20),
    ("(u*w + 1)/(2 + u^2 + w^2)", (-3, 3), (-3, 3), 30),
    ("u - w - 1 - (u - 2)/4/w", (-3, 3), (0.5, 3), 10),
    ("0.03*(sin(6*u)*cos(5.4*w) + 0.5*sin(10.2*u + 6.6*w))", (-3, 3), (-3, 3), 40),
    ("exp(-(u^2 + w^2)/0.5)*cos(12*sqrt(u^2 + w^2))", (-2, 2), (-2, 2), 30),
    ("sin(u*w)*tanh(u - w) + log(3 + u*sin(w))", (-1, 1), (-2, 2), 30),
    ("atan2(sinh(u) + 3, cosh(w))*asin(0.5*sin(u + w))", (-2, 2), (-2, 2), 30),
    ("acos(u*w/5)^2 - tan(u/3)*atan(w)^3", (-2, 2), (-2, 2), 30),
    ("smoothstep(-1.5, 2, u)", (-3, 3), (-1, 1), 30),
    ("smoothstep(u*w, 2 + w*w, sin(u) + w)", (-1, 1), (-2, 2), 50),
    ("0.1*smoothstep(0.75, 0.25, u^2 + w^2)", (-1, 1), (-1, 1), 30),
]
ORDERS = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]


def main():
    draw = random.Random(20240607)
    cases = []
    for text, ur, wr, count in CASES:
        code = compile(text.replace("^", "**"), text, "eval")

        def f(u, w):
            return mpf(eval(code, {"__builtins__": {}}, dict(NAMES, u=u, w=w)))

        rows = []
        while len(rows) < count:
            # Few binary digits keep the file short; odd ones stay clear of the edges of floor, min, ...
            u, w = (round(draw.uniform(*r) * 2048) / 2048 + 2**-13 for r in (ur, wr))
            mu, mw = mpf(u), mpf(w)
            jet = [f(mu, mw)] + [mp.diff(f, (mu, mw), o) for o in ORDERS[1:]]
            # What numerical differentiation leaves of a 0 is noise of its own.
            biggest = max(abs(x) for x in jet)
            jet = [float(x) if abs(x) > biggest * mpf(10) ** -20 else 0 for x in jet]
            rows.append([u, w] + jet)
        cases.append({"text": text, "rows": rows})
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "expr.json")
    with open(path, "w", encoding="ascii") as out:
        out.write('{"made_by": "make_expr.py, mpmath %s, %d digits",\n' % (mpmath.__version__, mp.dps))
        out.write('"columns": ["u", "w", "f", "f_u", "f_w", "f_uu", "f_uw", "f_ww"],\n"cases": [\n')
        out.write(",\n".join('{"text": %s, "rows": [\n%s]}' % (
            json.dumps(c["text"]), ",\n".join(json.dumps(r, separators=(",", ":")) for r in c["rows"])) for c in cases))
        out.write("\n]}\n")


if __name__ == "__main__":
    main()
