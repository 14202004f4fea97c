"""Random scenes, each a valid one: every shape, transform, copy, bump, light, material, camera and option that a scene
file can have, in pictures of a few hundred pixels.

A scene is a tree, as in docs/scene.md, and the files that it names. The same seed gives the same scene everywhere.
"""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tests.random import files

Tree = dict[str, Any]

#: Bounded heights of slopes up to about 1, if u and w are lengths or angles.
SMOOTH = ("sin(4*u)*sin(3*w)", "cos(5*u + 1)*cos(4*w)", "tanh(2*sin(3*u))*cos(2*w + 0.3)",
          "smoothstep(-0.8, 0.8, sin(3*u + 2*w))", "noise(2*u, 2*w + 0.5)", "0.3*sin(9*w) + 0.7*cos(3*u)",
          "exp(-sin(3*u)^2)*cos(w)", "atan(3*sin(2*u))*sin(2*w)", "1", "0.5")
#: With creases, but no jumps.
CREASED = ("abs(sin(3*u))", "max(sin(3*u), cos(4*w), -0.2)", "clamp(2*sin(4*w + u), -0.5, 0.5)")
#: With jumps, or without bounds: neither `exact` nor `displaced` takes them.
WILD = ("mod(floor(3*u) + floor(2*w), 2)", "select(sin(5*u), 0.2, 0.8)", "0.4*u - 0.3*w", "sqrt(0.1 + u^2 + w^2)")

SHADOWS = ("none", "0", "1", "2", "2+", "iter:1", "iter:3", "march:1", "march:6", "auto", "auto:0.05", "exact")
OWN_SHADOWS = ("none", "none", "none", "none", "march:5", "march:5", "horizon", "exact")

#: Shapes whose displaced surface is found in little time, where they are not stretched.
QUICK = ("plane", "rectangle", "disc", "box", "sphere", "cylinder", "torus", "mesh")


@dataclass
class Scene:
    """A tree, and the bytes of the files that it names."""

    tree: Tree
    files: dict[str, bytes] = field(default_factory=dict)

    def text(self) -> str:
        """As a scene file, an object or light on a line each; it is JSON, too."""
        parts = []
        for key, value in self.tree.items():
            if key in ("lights", "materials", "objects"):
                inner = ",\n".join(f"  {json.dumps(name)}: {json.dumps(item)}" for name, item in value.items())
                parts.append(f"{json.dumps(key)}: {{\n{inner}}}" if value else f"{json.dumps(key)}: {{}}")
            else:
                parts.append(f"{json.dumps(key)}: {json.dumps(value)}")
        return "{" + ",\n".join(parts) + "}\n"

    def named(self) -> dict[str, bytes]:
        """The files that the tree does name."""
        return {name: data for name, data in self.files.items() if json.dumps(name) in self.text()}

    def write(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(self.text(), encoding="utf-8")
        for name, data in self.named().items():
            (path.parent / name).write_bytes(data)

    def copy(self) -> Scene:
        return Scene(json.loads(json.dumps(self.tree)), dict(self.files))


def read(path: Path) -> Scene:
    """A scene that `write` has written."""
    tree = json.loads(path.read_text(encoding="utf-8"))
    scene = Scene(tree, {other.name: other.read_bytes() for other in path.parent.iterdir() if other.suffix != ".yaml"})
    scene.files = scene.named()
    return scene


class Draw(random.Random):
    """Draws numbers with few digits, so that scenes can be read."""

    def within(self, lo: float, hi: float) -> float:
        return round(self.uniform(lo, hi), 3)

    def point(self, lo: float, hi: float) -> list[float]:
        return [self.within(lo, hi) for _ in range(3)]

    def colour(self, lo: float = 0.05, hi: float = 1) -> list[float]:
        return self.point(lo, hi)

    def often(self, share: float) -> bool:
        return self.random() < share


# ---- camera, lights, materials -------------------------------------------------------------------

def camera(r: Draw) -> Tree:
    made: Tree = {"from": [r.within(-4, 4), r.within(1.5, 6), r.within(-8, -4)], "at": r.point(-0.5, 0.7)}
    if r.often(0.3):
        made["up"] = [r.within(-0.5, 0.5), 1, r.within(-0.3, 0.3)]
    if r.often(0.25):
        made["width"] = r.within(4, 8)
    else:
        made["fov"] = r.within(25, 75)
    return made


def light(r: Draw) -> Tree:
    made: Tree = {"at": [r.within(-6, 6), r.within(2.5, 9), r.within(-7, 3)], "color": r.colour(0.2, 1)}
    kind = r.choice(("point", "point", "spot", "parallel", "area", "area spot"))
    to = r.point(-0.5, 0.5)
    if "spot" in kind:
        radius = r.within(5, 30)
        made["spot"] = {"to": to, "radius": radius, "falloff": round(radius + r.within(2, 25), 3),
                        "tightness": r.choice((0, 0, 1, 5.5))}
    if kind == "parallel":
        made["parallel"] = {"to": to}
    if "area" in kind:
        made["area"] = {"u": r.point(-1, 1), "w": [r.within(-1, 1), r.within(-0.2, 0.2), r.within(1, 1.5)],
                        "samples": [r.randint(1, 4), r.randint(1, 4)]}
    if r.often(0.3):
        made["fade"] = {"distance": r.within(2, 9), "power": r.choice((1, 2, 2, 3.5))}
    return made


def colour(r: Draw, made: Scene) -> Any:
    if r.often(0.2):
        return {"checker": {"even": r.colour(), "odd": r.colour(), "size": [r.within(0.2, 0.9), r.within(0.2, 0.9)],
                            "offset": [r.within(-0.4, 0.4), r.within(-0.4, 0.4)]}}
    if r.often(0.15):
        made.files["colour.png"] = files.picture(r)
        return {"image": {"file": "colour.png", "size": [r.within(0.5, 2), r.within(0.5, 2)],
                          "interpolation": r.choice(("bilinear", "nearest"))}}
    return r.colour()


def material(r: Draw, made: Scene) -> Tree:
    it: Tree = {"color": colour(r, made), "ambient": r.within(0, 0.3), "diffuse": r.within(0.3, 0.9)}
    if r.often(0.4):
        it |= {"phong": r.within(0.1, 0.8), "phong_size": r.within(3, 60)}
    if r.often(0.3):
        it |= {"specular": r.within(0.1, 0.8), "roughness": r.within(0.01, 0.3)}
    if r.often(0.25):
        it["reflection"] = r.choice((r.within(0.1, 0.8), r.colour(0.1, 0.8)))
    if r.often(0.2):
        it["filter"] = r.within(0, 0.6)
        it["transmit"] = r.within(0, 0.4)
        it["ior"] = r.choice((1, 1.1, 1.5, 0.8, 2.2))
    return it


# ---- shapes --------------------------------------------------------------------------------------

def rectangle(r: Draw, _: Scene) -> Tree:
    return {"origin": r.point(-1, 0), "u": [r.within(0.6, 1.5), r.within(-0.5, 0.5), r.within(-0.5, 0.5)],
            "w": [r.within(-0.5, 0.5), r.within(0.5, 1), r.within(-1.2, 1.2)]}


def disc(r: Draw, _: Scene) -> Tree:
    return {"center": r.point(-0.2, 0.2), "normal": [r.within(-1, 1), r.within(0.3, 1), r.within(-1, 1)],
            "radius": r.within(0.4, 1.1)}


def box(r: Draw, _: Scene) -> Tree:
    return {"from": r.point(-0.8, -0.2), "to": r.point(0.2, 0.8)}


def sphere(r: Draw, _: Scene) -> Tree:
    return {"center": r.point(-0.2, 0.2), "radius": r.within(0.3, 0.9)}


def cylinder(r: Draw, _: Scene) -> Tree:
    return {"from": r.point(-0.6, -0.3), "to": r.point(0.3, 0.6), "radius": r.within(0.2, 0.7), "open": r.often(0.5)}


def cone(r: Draw, _: Scene) -> Tree:
    return {"from": r.point(-0.6, -0.3), "from_radius": r.within(0.4, 0.7), "to": r.point(0.3, 0.6),
            "to_radius": r.choice((0, r.within(0.1, 0.3), r.within(0.8, 0.9))), "open": r.often(0.5)}


def torus(r: Draw, _: Scene) -> Tree:
    return {"center": r.point(-0.2, 0.2), "axis": [r.within(-1, 1), r.within(0.4, 1), r.within(-1, 1)],
            "major": r.within(0.6, 0.9), "minor": r.within(0.1, 0.4)}


def ellipsoid(r: Draw, _: Scene) -> Tree:
    return {"center": r.point(-0.2, 0.2), "radii": r.point(0.3, 0.9)}


def parametric(r: Draw, _: Scene) -> Tree:
    return r.choice((
        {"x": "(1.2 + w*cos(u/2))*cos(u)*0.7", "y": "0.7*w*sin(u/2)", "z": "(1.2 + w*cos(u/2))*sin(u)*0.7",
         "u": [0, "2*pi"], "w": [-0.4, 0.4]},
        {"x": "u", "y": "0.25*sin(2*u)*cos(3*w)", "z": "w", "u": [-0.9, 0.8], "w": [-0.7, 0.9]},
        {"x": "0.7*cos(u)*sin(w)", "y": "0.6*cos(w)", "z": "0.7*sin(u)*sin(w)", "u": ["-pi", "pi"], "w": [0, "pi"]},
        {"x": "0.6*u", "y": "0.3*abs(w) + 0.1*u*w", "z": "w", "u": [-1, 1], "w": [-1, 1]}))


def patches(r: Draw, _: Scene) -> Tree:
    return {"points": [[[round(0.6 * (i - 1.5) + r.within(-0.15, 0.15), 3), r.within(-0.4, 0.4),
                         round(0.6 * (j - 1.5) + r.within(-0.15, 0.15), 3)] for j in range(4) for i in range(4)]
                       for _ in range(r.choice((1, 1, 2)))]}


def mesh(r: Draw, made: Scene) -> Tree:
    name = f"model{sum(other.endswith('.obj') for other in made.files)}.obj"
    made.files[name] = files.model(r)
    return {"file": name, "normals": r.choice(("file", "smooth", "flat")), "crease": r.choice((20, 40, 90))}


SHAPES: dict[str, Callable[[Draw, Scene], Tree]] = {
    "rectangle": rectangle, "disc": disc, "box": box, "sphere": sphere, "cylinder": cylinder, "cone": cone,
    "torus": torus, "ellipsoid": ellipsoid, "parametric": parametric, "patches": patches, "mesh": mesh}
PLANE = {"origin": [0, -0.9, 0], "u": [0, 0, 1], "w": [1, 0, 0]}


def shape_of(tree: Tree) -> str:
    """The key of an object that is its shape; copy or copies where it has none."""
    return next(key for key in tree if key in SHAPES or key in ("plane", "copy", "copies"))


# ---- bumps, objects ------------------------------------------------------------------------------

def bump(r: Draw, made: Scene, shape: str, height: float) -> Tree:
    """Heights up to about `height` up and down, such that the scene's method takes them."""
    how = made.tree["render"]
    if shape in ("parametric", "patches") and searched(how):
        return {"function": r.choice(SMOOTH[:2]), "scale": round(0.3 * height, 4)}
    # a function's table of horizons is fine, and takes seconds
    if r.often(1 if how["bump_shadow"] == "horizon" and shape != "plane" else 0.35):
        name = "heights.exr" if r.often(0.3) else "heights.png"
        if name not in made.files:
            made.files[name] = files.heights(r, name)
        it: Tree = {"map": {"file": name}, "scale": round(1.5 * height, 4), "zero": r.choice((0.5, 0.3)),
                    "sign": r.choice(("up", "down")), "wrap": r.choice(("repeat", "clamp", "mirror")),
                    "samples": r.choice(("cells", "corners"))}
        if shape in ("plane", "mesh"):
            it["size"] = [r.within(0.8, 2), r.within(0.8, 2)]
        elif r.often(0.5):
            it["repeat"] = [r.randint(1, 3), r.randint(1, 3)]
        if name == "heights.png" and r.often(0.2):
            it["smooth"] = r.choice((1, 2.5))
        return it
    return {"function": r.choice(SMOOTH + CREASED + (() if searched(how) else WILD)), "scale": round(height, 4)}


def transform(r: Draw, uniform: bool = False) -> list[Tree]:
    steps: list[Tree] = []
    for _ in range(r.choice((0, 0, 1, 2))):
        kind = r.choice(("rotate", "scale", "stretch", "mirror"))
        if kind == "rotate":
            steps.append({"rotate": r.point(-180, 180)})
        elif kind == "mirror":
            steps.append({"scale": [-1, 1, 1]})
        elif kind == "scale" or uniform:
            steps.append({"scale": r.within(0.6, 1.3)})
        else:
            steps.append({"scale": r.point(0.6, 1.4)})
    return [*steps, {"translate": [r.within(-1.8, 1.8), r.within(-0.4, 0.9), r.within(-1.8, 1.8)]}]


def item(r: Draw, made: Scene, materials: list[str], size: float = 1) -> Tree:
    name = r.choice(tuple(SHAPES))
    shape = SHAPES[name](r, made)
    it: Tree = {name: shape, "material": r.choice(materials)}
    slow = searched(made.tree["render"])
    if r.often(0.6) and (not slow or name in QUICK or r.often(0.05)):
        it["bump"] = bump(r, made, name, r.within(0.01, 0.08))
        if name == "cone" and slow:  # its apex, where it has one, stays where it is
            it["bump"] = {"function": "min(w, 1)*sin(3*u)", "scale": 0.03}
    it["transform"] = transform(r, "bump" in it and slow)
    if size != 1:
        it["transform"].insert(-1, {"scale": size})
    return it


def add_copies(r: Draw, made: Scene, materials: list[str]) -> None:
    """Copies of one object each, and a list of copies of a hidden one."""
    objects, slow = made.tree["objects"], searched(made.tree["render"])
    for name in [name for name in objects if shape_of(objects[name]) != "plane" and r.often(0.15)]:
        objects[f"{name}_copy"] = {"copy": name, "transform": transform(r, slow)}
    if r.often(0.2):
        original = item(r, made, materials, 0.5)
        if slow:
            original.pop("bump", None)
        objects["stone"] = original | {"hidden": True}
        made.files["stones.csv"] = files.list_of_copies(r, materials)
        objects["stones"] = {"copies": {"of": "stone", "file": "stones.csv"}}


def render(r: Draw) -> Tree:
    it: Tree = {"shadow": r.choice(SHADOWS), "shade": r.choice(("smooth", "smooth", "shifted")),
                "bump_shadow": r.choice(OWN_SHADOWS), "depth": r.choice((1, 2, 3, 5))}
    if r.often(0.12):
        it["surface"] = "displaced"
    if r.often(0.15):
        it["self_shadow"] = False
    if r.often(0.2):
        it["guard"] = False
    if r.often(0.2):
        it["aa"] = 2
        if r.often(0.5):
            it["aa_threshold"] = r.choice((0, 0.1, 0.5))
    return it


def searched(how: Tree) -> bool:
    """Whether the truth is asked, which needs bounds, and takes longer."""
    return "exact" in (how.get("shadow"), how.get("bump_shadow")) or how.get("surface") == "displaced"


def draw(seed: int) -> Scene:
    """The scene of a seed."""
    r = Draw(seed)
    made = Scene({"camera": camera(r), "image": {"size": [r.randint(18, 26), r.randint(13, 20)],
                                                 "background": r.colour(0, 0.5)}, "render": render(r)})
    made.tree["lights"] = {f"light{i}": light(r) for i in range(r.choice((1, 1, 2, 3)))}
    made.tree["materials"] = {f"stuff{i}": material(r, made) for i in range(r.choice((1, 2, 3)))}
    materials = list(made.tree["materials"])
    objects: Tree = {}
    made.tree["objects"] = objects
    if r.often(0.75):
        objects["ground"] = {"plane": dict(PLANE), "material": r.choice(materials)}
        if r.often(0.8):
            objects["ground"]["bump"] = bump(r, made, "plane", r.within(0.02, 0.12))
    many = not searched(made.tree["render"]) and r.often(0.15)  # so many that there is a hierarchy over them
    for i in range(r.randint(13, 15) if many else r.randint(1, 4)):
        objects[f"thing{i}"] = item(r, made, materials, 0.5 if many else 1)
    add_copies(r, made, materials)
    made.files = made.named()
    return made


def variables(expression: str, u: str, w: str) -> str:
    """The expression with other expressions in place of u and w."""
    return re.sub(r"\b[uw]\b", lambda found: f"({u if found[0] == 'u' else w})", expression)
