"""No NaN and no infinity in any plane of any picture, whatever the scene.

    scripts/venv python -m tests.verify.numbers [--count N] [--seed S]

Random hostile scenes: functions with poles and without values, scenes of 1e-6 to 1e6 units, eyes and lights on or in
surfaces, light and rays along them, huge colours; by every method, place of shading, own shadow and kind of surface.
Where a function has no value where the camera looks, the picture must tell so. Z is 1e30 where nothing is hit,
and only there. A trial that fails is told by its number; --seed and --only repeat it.
"""

from __future__ import annotations

import argparse
import itertools
import json
import random
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from tests.verify.record import record

SIZE = (24, 18)
METHODS = ("none", "0", "1", "2", "2+", "iter:3", "march:4", "auto", "exact")
SHAPES = (
    "plane",
    "rectangle",
    "disc",
    "box",
    "sphere",
    "cylinder",
    "cone",
    "torus",
    "ellipsoid",
    "parametric",
    "patches",
    "mesh",
)
#: Heights, in units of the scene's size; those of WITHOUT have no value or no bound somewhere.
HEIGHTS = (
    "0",
    "0.1*sin(7*u)*cos(5*w)",
    "0.2*noise(3*u, 3*w)",
    "1e-30*sin(u)",
    "max(0, 0.1*sin(5*u))",
    "0.05*sin(1e6*u)",
    "0.1*sin(1e20*u)",
    "-0.3 + 0.1*cos(w)",
    "1",
    "0.1*floor(3*u)",
    "0.1*abs(sin(4*u))^0.5",
    "0.1*tanh(1e5*sin(3*u))",
)
WITHOUT = (
    "log(u)",
    "1/u",
    "sqrt(u)",
    "u^w",
    "1/0",
    "1e300*u*1e300",
    "0.1*log(sin(9*u))",
    "tan(5*w)",
    "acos(3*u)",
    "1e30*u^9",
    "0.1*sqrt(sin(3*w))",
    "exp(900*u)",
    "0.1*sin(1/u)",
    "asin(2*w) + sqrt(u - 0.3)",
)
Scene = dict[str, Any]
#: A mesh as the library takes it: a tetrahedron, one of whose triangles has no area on the texture.
TETRAHEDRON = (
    "v 1 0 -1\nv -1 0 -1\nv 0 0 1\nv 0 1.5 0\nvt 0 0\nvt 1 0\nvt 0.5 1\nvt 0.5 0.5\n"
    "f 1/1 2/2 4/4\nf 2/2 3/3 4/4\nf 3/3 1/1 4/4\nf 1/1 3/1 2/1\n"
)


def times(k: float, v: tuple[float, ...] | list[float]) -> list[float]:
    return [max(-1e6, min(1e6, k * x)) for x in v]


def flat(r: random.Random, k: float) -> Scene:
    sides = (((0, 0, 1), (1, 0, 0)), ((1, 0, 0), (0, -1, 0)), ((1, 0, 1e-4), (1, 0, 0)), ((0, 0, 9), (0.2, 0, 0)))
    u, w = r.choice(sides)
    return {"origin": times(k, r.choice(((0, 0, 0), (-0.5, 0, -0.5)))), "u": times(k, u), "w": times(k, w)}


def formula(r: random.Random, k: float) -> Scene:
    x, y, z = r.choice(
        (
            ("u", "0.2*sin(3*u)", "w"),
            ("u", "abs(u)", "w"),
            ("w*cos(u)", "w", "w*sin(u)"),
            ("cos(u)*sin(w)", "cos(w)", "sin(u)*sin(w)"),
            ("u*u", "0", "w"),
            ("u", "sqrt(abs(u))", "w"),
        )
    )
    w = r.choice(([-1, 1], [0, 1]))
    return {"x": f"{k!r}*({x})", "y": f"{k!r}*({y})", "z": f"{k!r}*({z})", "u": [-1, 1], "w": w}


def bezier(r: random.Random, k: float) -> Scene:
    points = [times(k, (i / 3 - 0.5, r.uniform(0, 0.3), j / 3 - 0.5)) for j in range(4) for i in range(4)]
    return {"points": [points if r.random() < 0.7 else [points[0]] * 4 + points[4:]]}


def shape(r: random.Random, kind: str, k: float) -> Scene:
    """A shape of about the size k around the origin."""
    low, high, origin = times(k, (0, -0.5, 0)), times(k, (0, 0.5, 0)), [0, 0, 0]
    made: dict[str, Callable[[], Scene]] = {
        "plane": lambda: flat(r, k),
        "rectangle": lambda: flat(r, k),
        "disc": lambda: {"center": origin, "normal": r.choice(([0, 1, 0], [0, 1, -0.2])), "radius": k},
        "box": lambda: {
            "from": times(k, (-0.5, -0.5, -0.5)),
            "to": times(k, r.choice(((0.5, 0.5, 0.5), (0.5, -0.4999, 0.5)))),
        },
        "sphere": lambda: {"center": origin, "radius": k},
        "cylinder": lambda: {"from": low, "to": high, "radius": 0.5 * k, "open": r.random() < 0.5},
        "cone": lambda: {
            "from": low,
            "from_radius": 0.5 * k,
            "to": high,
            "to_radius": r.choice((0, 0.1 * k)),
            "open": r.random() < 0.5,
        },
        "torus": lambda: {"center": origin, "axis": [0, 1, 0], "major": k, "minor": r.choice((0.3, 0.9, 0.999)) * k},
        "ellipsoid": lambda: {
            "center": origin,
            "radii": times(k, r.choice(((1, 0.5, 0.7), (1, 0.001, 1), (0.01, 1, 0.01)))),
        },
        "parametric": lambda: formula(r, k),
        "patches": lambda: bezier(r, k),
        "mesh": lambda: {"file": "tetrahedron.obj"},
    }
    return made[kind]()


def eyes(r: random.Random, k: float) -> tuple[list[float], list[float]]:
    """Where the eye is and where it looks: from afar, along the surface, on it, in it, straight down on a pole."""
    return r.choice(
        (
            (times(k, (0.3, 2, -3)), [0.0, 0.0, 0.0]),
            (times(k, (0, 3, 0)), [0.0, 0.0, 0.0]),
            (times(k, (0, 0, -3)), [0.0, 0.0, 0.0]),
            (times(k, (0, 1e-4, -3)), times(k, (0, 1e-4, 3))),
            ([0.0, 0.0, 0.0], times(k, (0, 0, 1))),
            (times(k, (0, 0.5, 0)), times(k, (0, -1, 0))),
            (times(k, (0, 1, 0)), times(k, (1, 1, 0))),
            (times(k, (0.1, 0.05, 0.1)), times(k, (1, 0.05, 0.3))),
            (times(1e5 * k, (1, 2, -3)), [0.0, 0.0, 0.0]),
            (times(k, (2, 0, 0)), times(k, (-1, 0, 0))),
            (times(k, (0, -2, 1)), [0.0, 0.0, 0.0]),
        )
    )


def lights(r: random.Random, k: float) -> Scene:
    found: Scene = {}
    for name in ("a", "b")[: r.choice((1, 1, 2))]:
        at = times(k, r.choice(((-3, 4, -2), (0, 0, 0), (0, 0.5, 0), (0, 1, 0), (-3, 0, 0), (0, 1e-6, 5), (1, 0, 0))))
        light: Scene = {"at": at, "color": r.choice(([1, 1, 1], [1e6, 1e6, 1e6], [0, 0, 0]))}
        to = r.choice((times(k, (0, 0, 0.1)), times(k, (5, 0, 0)), times(k, (0, -1, 0))))
        kind = r.randrange(5)
        if kind == 1 and np.linalg.norm(np.subtract(to, at)) > 2e-6:
            light["parallel"] = {"to": to}
        elif kind == 2 and np.linalg.norm(np.subtract(to, at)) > 2e-6:
            light["spot"] = {
                "to": to,
                "radius": r.choice((0, 20)),
                "falloff": r.choice((20, 90)),
                "tightness": r.choice((0, 1e6)),
            }
        elif kind == 3:
            light["area"] = {
                "u": times(k, (1, 0, 0)),
                "w": times(k, r.choice(((0, 0, 1), (0, 0, 0)))),
                "samples": [2, 2],
            }
        if r.random() < 0.2:
            light["fade"] = {"distance": r.choice((1e-6, 1e6, min(max(k, 1e-6), 1e6))), "power": r.choice((2, 100))}
        found[name] = light
    return found


def material(r: random.Random) -> Scene:
    color = r.choice(
        (
            [0.8, 0.7, 0.6],
            [1e6, 1, 0],
            {"checker": {"even": [1, 1, 1], "odd": [0, 0, 1e6], "size": r.choice(([1, 1], [1e-6, 1e-6]))}},
        )
    )
    m: Scene = {"color": color, "ambient": r.choice((0.1, 1e6)), "diffuse": r.choice((0.6, 1e6))}
    what = r.randrange(6)
    if what == 1:
        m |= {
            "phong": r.choice((0.5, 1e6)),
            "phong_size": r.choice((40, 1e6, 1e-6)),
            "specular": 1,
            "roughness": r.choice((1e-6, 0.05, 1e6)),
        }
    elif what == 2:
        m |= {"reflection": r.choice((1, [0.2, 0, 1]))}
    elif what == 3:
        m |= {"filter": 0.9, "transmit": 0.1, "ior": r.choice((1, 1.5, 1e-3, 100))}
    elif what == 4:
        m |= {"filter": 1, "reflection": 0.3, "ior": 1}
    return m


def trial(r: random.Random) -> tuple[Scene, dict[str, Any], bool]:
    """A scene, options of its render, and whether its bump may be without a value."""
    k = r.choice((1, 1, 1, 10.0 ** r.randint(-5, 5), 3e-6, 9e5))
    kind, without = r.choice(SHAPES), r.random() < 0.5
    bump: Scene = {"function": r.choice(WITHOUT if without else HEIGHTS),
                   "scale": min(k, 1e6) * r.choice((1, 1, 0.1, -1))}
    eye, at = eyes(r, k)
    up = [0, 0, 1] if eye[0] == at[0] and eye[2] == at[2] else [0, 1, 0]
    camera: Scene = {"from": eye, "at": at, "up": up}
    camera |= {"width": max(1e-6, min(1e6, 3 * k))} if r.random() < 0.2 else {"fov": r.choice((40, 90, 175, 1e-3))}
    thing: Scene = {kind: shape(r, kind, k), "material": "m", "bump": bump}
    if r.random() < 0.3:
        thing["transform"] = [
            {"scale": r.choice((2, [1, 1, -1], [3, 0.5, 1], [1e-3, 1, 1]))},
            {"rotate": r.choice(([0, 0, 0], [20, 30, 0], [90, 0, 0]))},
        ]
    objects: Scene = {
        "it": thing,
        "ball": {"sphere": {"center": times(k, (0.5, 1, 0.5)), "radius": max(1e-6, 0.2 * k)}, "material": "n"},
    }
    scene = {
        "camera": camera,
        "image": {"size": list(SIZE), "background": r.choice(([0, 0, 0], [1e6, 0, 1]))},
        "render": {"depth": r.choice((1, 3, 8))},
        "lights": lights(r, k),
        "materials": {"m": material(r), "n": material(r)},
        "objects": objects,
    }
    options = {
        "shadow": r.choice(METHODS),
        "shade": r.choice(("smooth", "shifted")),
        "bump_shadow": r.choice(("none", "march:6", "horizon", "exact")),
        "surface": r.choice(("smooth", "smooth", "displaced")),
        "guard": r.random() < 0.7,
        "aa": r.choice((1, 1, 2)),
        "self_shadow": r.random() < 0.8,
    }
    steep = any(power in bump["function"] for power in ("e6", "e20", "e30"))  # a ray of a patch takes its limit
    truly = options["surface"] == "displaced"
    if steep or (truly and scene["render"]["depth"] == 8):  # a clear mirror doubles the rays at each depth
        scene["image"]["size"], options["aa"] = [8, 6], 1
    if steep and truly:
        scene["render"]["depth"] = min(scene["render"]["depth"], 2)
    return scene, options, without


def trials(seed: int, only: int | None) -> Iterator[tuple[int, tuple[Scene, dict[str, Any], bool]]]:
    for k in itertools.count() if only is None else [only]:
        yield k, trial(random.Random(f"{seed} {k}"))


def wrong(picture: Any) -> list[str]:
    """The planes with a value that is no number, and where."""
    found = []
    for name in picture:
        plane = picture[name]
        bad = ~np.isfinite(plane)
        if name == "Z":  # of a miss, at which all else is empty
            bad |= (plane >= 1e30) & ~((plane == np.float32(1e30)) & (picture["order"] == -1) & ~picture["N"].any(-1))
        if bad.any():
            y, x = np.argwhere(bad)[0]
            found.append(f"{name} is {plane[y, x]} at {x},{y} and {int(bad.sum()) - 1} more")
    return found


def told(scene: Scene, options: dict[str, Any], picture: Any) -> bool:
    """Whether a bump that is nowhere defined is told."""
    seen = picture["Z"] < 1e30
    nowhere = scene["objects"]["it"]["bump"]["function"] == "1/0"
    return not (nowhere and seen.all() and options["surface"] == "smooth") or picture.stats.undefined > 0


def simpler(options: dict[str, Any], message: str) -> dict[str, Any] | None:
    """Without what needs bounds of P that this scene lacks; None: the scene is refused for another reason."""
    if "bound" not in message and "jump" not in message and "slope" not in message:
        return None
    return options | {
        "shadow": "march:4" if options["shadow"] == "exact" else options["shadow"],
        "surface": "smooth",
        "bump_shadow": "march:6" if options["bump_shadow"] == "exact" else options["bump_shadow"],
    }


def render(kage: Any, folder: Path, scene: Scene, options: dict[str, Any]) -> tuple[Any, dict[str, Any]] | str:
    """The picture and its options, or why there is none."""
    try:
        loaded = kage.load(json.dumps(scene) + "\n", folder=folder)
    except kage.KageError as e:
        return str(e)
    for _ in range(2):
        try:
            return loaded.render(**options), options
        except kage.KageError as e:
            why = str(e)
            less = simpler(options, why)
            if less is None or less == options:
                return why
            options = less
    return "refused twice"


def run(kage: Any, folder: Path, count: int, seed: int, only: int | None = None, loud: bool = True) -> dict[str, Any]:
    """Do `count` trials that render."""
    (folder / "tetrahedron.obj").write_text(TETRAHEDRON, encoding="ascii")
    done: dict[str, Any] = {"trials": 0, "refused": 0, "samples without a value": 0, "failed": []}
    for k, (scene, options, _) in trials(seed, only):
        if loud:
            print(f"\r{k} {done['trials']}", end="", file=sys.stderr, flush=True)
        found = render(kage, folder, scene, options)
        if isinstance(found, str):
            done["refused"] += 1
            if only is not None:
                print(found)
        else:
            bad = wrong(found[0]) + ([] if told(scene, found[1], found[0]) else ["a pole is not told"])
            done["trials"] += 1
            done["samples without a value"] += found[0].stats.undefined
            if bad:
                done["failed"].append(k)
                print(f"\ntrial {k}: {'; '.join(bad)}\n  {found[1]}\n  {json.dumps(scene)}")
        if done["trials"] >= count or only is not None:
            return done
    return done


def main() -> int:
    from tests.conftest import TOP  # also puts the package's folder into sys.path

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=3000, help="scenes that are rendered")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, help="this trial alone")
    a = parser.parse_args()
    import kage

    folder = TOP / "out" / "verify-numbers"
    folder.mkdir(parents=True, exist_ok=True)
    done = run(kage, folder, a.count, a.seed, a.only)
    failed = done.pop("failed")
    return record("numbers", done, len(failed))


if __name__ == "__main__":
    sys.exit(main())
