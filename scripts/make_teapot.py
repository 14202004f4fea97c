"""Make scenes/data/teapot.txt: Newell's teapot as 32 bicubic Bezier patches.

The numbers are Martin Newell's of 1975, with the bottom of F. Crow's version of 1987. Ten patches in one quadrant or
half give the others by reflection. Here y is up, as in kage; u goes around and w along the profile, so that Qu x Qw
points outward.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent

#: Rings of the profile of what is turned: (radius, height); 0.56 makes a quarter of a circle of each.
PROFILES = {
    "rim": [(1.4, 2.4), (1.3375, 2.53125), (1.4375, 2.53125), (1.5, 2.4)],
    "upper body": [(1.5, 2.4), (1.75, 1.875), (2, 1.35), (2, 0.9)],
    "lower body": [(2, 0.9), (2, 0.45), (1.5, 0.225), (1.5, 0.15)],
    "knob": [(0, 3.15), (0.8, 3.15), (0, 2.85), (0.2, 2.7)],
    "lid": [(0.2, 2.7), (0.4, 2.55), (1.3, 2.55), (1.3, 2.4)],
    "bottom": [(0, 0), (1.425, 0), (1.5, 0.075), (1.5, 0.15)],
}

#: The knob's second ring is no circle of that kind, as Newell had it.
KNOB = [(0.8, 0), (0.8, -0.45), (0.45, -0.8), (0, -0.8)]

#: Rings of half a tube: (x, height) of the upper and of the lower line, and half the width of each.
TUBES = {
    "upper handle": [((-1.6, 2.025), (-1.5, 2.25), 0.3), ((-2.3, 2.025), (-2.5, 2.25), 0.3),
                     ((-2.7, 2.025), (-3, 2.25), 0.3), ((-2.7, 1.8), (-3, 1.8), 0.3)],
    "lower handle": [((-2.7, 1.8), (-3, 1.8), 0.3), ((-2.7, 1.575), (-3, 1.35), 0.3),
                     ((-2.5, 1.125), (-2.65, 0.9375), 0.3), ((-2, 0.9), (-1.9, 0.6), 0.3)],
    "lower spout": [((1.7, 1.425), (1.7, 0.6), 0.66), ((2.6, 1.425), (3.1, 0.825), 0.66),
                    ((2.3, 2.1), (2.4, 2.025), 0.25), ((2.7, 2.4), (3.3, 2.4), 0.25)],
    "upper spout": [((2.7, 2.4), (3.3, 2.4), 0.25), ((2.8, 2.475), (3.525, 2.49375), 0.25),
                    ((2.9, 2.475), (3.45, 2.5125), 0.15), ((2.8, 2.4), (3.2, 2.4), 0.15)],
}

Point = tuple[float, float, float]
Patch = list[list[Point]]  # rows along w, each along u


def turned(name: str) -> Patch:
    """The quarter with x >= 0 and z <= 0."""
    rows = []
    for k, (radius, height) in enumerate(PROFILES[name]):
        ring = [(1, 0), (1, -0.56), (0.56, -1), (0, -1)]
        at = KNOB if name == "knob" and k == 1 else [(radius * x, radius * z) for x, z in ring]
        rows.append([(x, height, z) for x, z in at])
    return rows


def tube(name: str) -> Patch:
    """The half with z <= 0."""
    return [[(*a, 0), (*a, -wide), (*b, -wide), (*b, 0)] for a, b, wide in TUBES[name]]


def reflected(p: Patch, x: int, z: int) -> Patch:
    """A reflection turns the inside out, unless u is turned too."""
    rows = [[(x * q[0], q[1], z * q[2]) for q in row] for row in p]
    return [row[::-1] for row in rows] if x * z < 0 else rows


def outward(p: Patch, direction: Point) -> Patch:
    """Turned so that Qu x Qw in the middle is on the side of a direction."""
    b, d = (0.125, 0.375, 0.375, 0.125), (-0.75, -0.75, 0.75, 0.75)
    u = [sum(b[j] * d[i] * p[j][i][k] for j in range(4) for i in range(4)) for k in range(3)]
    w = [sum(d[j] * b[i] * p[j][i][k] for j in range(4) for i in range(4)) for k in range(3)]
    n = (u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0])
    return p if sum(a * c for a, c in zip(n, direction, strict=True)) > 0 else [row[::-1] for row in p]


def patches() -> list[tuple[str, Patch]]:
    towards = {"rim": (0, 1, 0), "knob": (1, 0, -1), "lid": (0, 1, 0), "bottom": (0, -1, 0)}
    made = []
    for name in PROFILES:
        base = outward(turned(name), towards.get(name, (1, 0, -1)))
        made += [(name, reflected(base, x, z)) for x, z in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    for name in TUBES:
        base = outward(tube(name), (0, 0, -1))
        made += [(name, reflected(base, 1, z)) for z in (1, -1)]
    return made


def text() -> str:
    lines = ["# Newell's teapot: 32 bicubic Bezier patches, y up. Made by scripts/make_teapot.py.",
             "# A row is along u, four rows a patch along w."]
    for name, patch in patches():
        lines.append(f"\n# {name}")
        lines += ["  ".join(" ".join(f"{c + 0:.7g}" for c in point) for point in row) for row in patch]
    return "\n".join(lines) + "\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", dest="path", type=Path, default=TOP / "scenes" / "data" / "teapot.txt")
    args = parser.parse_args()
    args.path.write_text(text())
    return 0


if __name__ == "__main__":
    sys.exit(main())
