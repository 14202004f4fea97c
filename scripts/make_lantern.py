"""Make scenes/data/lantern.obj: a lantern on a wrought-iron bracket, of tubes along curves and of turned profiles.

Right-handed and y up, as OBJ files are. The bracket lies in the plane z = 0, from its bar at x = 0 to the lantern at
x = 1.75. Texture coordinates are lengths in scene units: u goes around each part and v along it. Seen from outside,
where v goes up, u goes to the right.
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent

Vector = tuple[float, float, float]
SIDES = 8  # of a tube


def add(a: Vector, b: Vector, k: float = 1) -> Vector:
    """a + k b."""
    return (a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2])


def dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a: Vector) -> Vector:
    k = math.sqrt(dot(a, a))
    return (a[0] / k, a[1] / k, a[2] / k)


class Model:
    """The lines of an OBJ file: places, texture coordinates and faces."""

    def __init__(self) -> None:
        self.at: list[str] = []
        self.uv: list[str] = []
        self.face: list[str] = []

    def grid(self, rows: list[list[Vector]], u: list[list[float]], v: list[float]) -> None:
        """Quads between rows of places, in the order of v. Each row is a ring: its first place also ends it, but there
        the texture coordinate is another."""
        n, first_at, first_uv = len(rows[0]), len(self.at) + 1, len(self.uv) + 1
        for row, us, y in zip(rows, u, v, strict=True):
            self.at += [f"v {x:.4f} {y:.4f} {z:.4f}\n" for x, y, z in row]
            self.uv += [f"vt {x:.4f} {y:.4f}\n" for x in us]
        for j in range(len(rows) - 1):
            for i in range(n):
                corners = [(j, i), (j, i + 1), (j + 1, i + 1), (j + 1, i)]
                for end, spare in ((j, 1), (j + 1, 2)):  # a row that is one place, as at a tip
                    if rows[end][0] == rows[end][1]:
                        del corners[spare]
                words = (f"{first_at + a * n + b % n}/{first_uv + a * (n + 1) + b}" for a, b in corners)
                self.face.append(f"f {' '.join(words)}\n")

    def tube(self, path: list[Vector], radius: float | list[float], closed: bool = False) -> None:
        """Rings about the places of a path, each turned as little as possible against the one before. A tube that is
        not closed has ends."""
        n = len(path)

        def place(k: int) -> Vector:
            return path[k % n] if closed else path[min(max(k, 0), n - 1)]

        ahead = [unit(add(place(k + 1), place(k - 1), -1)) for k in range(n)]
        x = unit(cross(ahead[0], (0, 0, 1) if abs(ahead[0][2]) < 0.9 else (1, 0, 0)))
        radii = radius if isinstance(radius, list) else [radius] * n
        rows: list[list[Vector]] = []
        lengths: list[float] = []
        length = 0.0
        for k in [*range(n), *([0] if closed else [])]:
            x = unit(add(x, ahead[k], -dot(x, ahead[k])))
            z = cross(x, ahead[k])
            turn = [2 * math.pi * i / SIDES for i in range(SIDES)]
            rows.append([add(add(path[k], x, radii[k] * math.cos(a)), z, -radii[k] * math.sin(a)) for a in turn])
            if lengths:
                length += math.dist(path[k], path[k - 1])
            lengths.append(length)
        if not closed:
            rows, lengths = [[path[0]] * SIDES, *rows, [path[-1]] * SIDES], [-max(radii), *lengths, length + max(radii)]
        around = [2 * math.pi * max(radii) * i / SIDES for i in range(SIDES + 1)]
        self.grid(rows, [around] * len(rows), lengths)

    def turned(self, x: float, profile: list[tuple[float, float]], sides: int) -> None:
        """(radius, y) from bottom to top, about the vertical through x."""
        rows, length, lengths = [], 0.0, []
        for k, (r, y) in enumerate(profile):
            turns = [2 * math.pi * i / sides for i in range(sides)]
            rows.append([(x + r * math.sin(a), y, r * math.cos(a)) for a in turns])
            length += math.dist(profile[k], profile[k - 1]) if k else 0
            lengths.append(length)
        most = max(r for r, _ in profile)
        self.grid(rows, [[2 * math.pi * most * i / sides for i in range(sides + 1)]] * len(rows), lengths)

    def text(self) -> str:
        return "".join(["# a lantern on a bracket, made by scripts/make_lantern.py\n", *self.at, *self.uv, *self.face])


def spiral(x: float, y: float, out: float, turns: float, start: float, n: int) -> list[Vector]:
    """From the outside inward, counterclockwise for turns above 0."""
    places = []
    for k in range(n + 1):
        a, r = start + 2 * math.pi * turns * k / n, out * (1 - 0.8 * k / n)
        places.append((x + r * math.cos(a), y + r * math.sin(a), 0.0))
    return places


def lantern() -> Model:
    m = Model()
    m.tube([(0, -1.75, 0), (0, 0.62, 0)], 0.055)
    m.turned(0, [(0, 0.6), (0.09, 0.66), (0.11, 0.73), (0.08, 0.82), (0, 0.98)], 12)
    m.tube([(-0.02, 0.25, 0), (1.0, 0.25, 0), (1.75, 0.25, 0)], 0.05)
    # a scroll below the arm, one above it, and the brace between bar and arm
    m.tube([(0.03, -1.35 + 0.25 * k, 0) for k in range(2)] + spiral(0.62, -0.36, 0.56, 1.6, math.pi * 1.05, 44), 0.04)
    m.tube(spiral(0.5, 0.49, 0.21, -1.4, math.pi * 1.5, 30), 0.032)
    m.tube(spiral(1.2, -0.02, 0.24, 1.3, math.pi * 0.5, 30), 0.032)
    link = [2 * math.pi * k / 16 for k in range(16)]
    m.tube([(1.75 + 0.11 * math.sin(a), 0.12 + 0.13 * math.cos(a), 0.0) for a in link], 0.025, closed=True)
    # the lantern: knob and roof, six leaning posts with two hoops, a floor, the candle
    x = 1.75
    m.turned(x, [(0, -0.42), (0.40, -0.46), (0.44, -0.42), (0.26, -0.24), (0.16, -0.16), (0.10, -0.10), (0.10, -0.06),
                 (0.05, -0.03), (0, -0.02)], 18)
    for k in range(6):
        s, c = math.sin(math.pi * k / 3), math.cos(math.pi * k / 3)
        m.tube([(x + 0.36 * s, -0.45, 0.36 * c), (x + 0.25 * s, -1.22, 0.25 * c)], 0.028)
    for y, r in ((-0.72, 0.325), (-1.0, 0.285)):
        hoop = [2 * math.pi * k / 18 for k in range(18)]
        m.tube([(x + r * math.sin(a), y, r * math.cos(a)) for a in hoop], 0.02, closed=True)
    m.turned(x, [(0, -1.46), (0.05, -1.44), (0.07, -1.38), (0.04, -1.32), (0.22, -1.27), (0.29, -1.23), (0.29, -1.18),
                 (0, -1.17)], 18)
    m.turned(x, [(0.08, -1.18), (0.08, -0.85), (0, -0.83)], 10)
    return m


def text() -> str:
    return lantern().text()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", dest="path", type=Path, default=TOP / "scenes" / "data" / "lantern.obj")
    args = parser.parse_args()
    args.path.write_text(text())
    return 0


if __name__ == "__main__":
    sys.exit(main())
