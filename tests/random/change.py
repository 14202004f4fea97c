"""Changes of a whole scene after which its picture is known: moved, turned, mirrored, with u and w exchanged."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tests.random import files
from tests.random.draw import Draw, Scene, Tree, shape_of, variables

Steps = list[Tree]


class CannotError(Exception):
    """The change is not defined for this scene."""


# ---- maps of space -------------------------------------------------------------------------------

def turn(degrees: list[float]) -> np.ndarray:
    """About x, then y, then z, by the left-hand rule, as `rotate` does."""
    made = np.eye(3)
    for axis, angle in enumerate(degrees):
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        j, k = (axis + 1) % 3, (axis + 2) % 3
        step = np.eye(3)
        step[j, j], step[j, k], step[k, j], step[k, k] = c, -s, s, c
        made = step @ made
    return made


class Move:
    """Scaled by one factor, turned, then moved; or mirrored in x."""

    def __init__(self, scale: float, degrees: list[float], to: list[float], mirrors: bool = False) -> None:
        self.scale = scale
        self.matrix = scale * turn(degrees) @ np.diag([-1.0 if mirrors else 1.0, 1, 1])
        self.to = np.array(to)
        first: Steps = [{"scale": [-1, 1, 1]}] if mirrors else []
        self.steps: Steps = [*first, {"scale": scale}, {"rotate": degrees}, {"translate": to}]
        x, y, z = degrees
        self.back: Steps = [{"translate": [-v for v in to]}, {"rotate": [0, 0, -z]}, {"rotate": [0, -y, 0]},
                            {"rotate": [-x, 0, 0]}, {"scale": 1 / scale}, *first]

    def point(self, p: list[float]) -> list[float]:
        return [float(v) for v in self.matrix @ np.array(p) + self.to]

    def way(self, v: list[float]) -> list[float]:
        return [float(x) for x in self.matrix @ np.array(v)]


def move_view(tree: Tree, m: Move) -> None:
    view = tree["camera"]
    view |= {"from": m.point(view["from"]), "at": m.point(view["at"]), "up": m.way(view.get("up", [0, 1, 0]))}
    if "width" in view:
        view["width"] *= m.scale
    for light in tree["lights"].values():
        light["at"] = m.point(light["at"])
        for kind in ("spot", "parallel"):
            if kind in light:
                light[kind]["to"] = m.point(light[kind]["to"])
        if "area" in light:
            light["area"] |= {"u": m.way(light["area"]["u"]), "w": m.way(light["area"]["w"])}
        if "fade" in light:
            light["fade"]["distance"] *= m.scale


def scale_heights(objects: Tree, factor: float) -> None:
    for thing in objects.values():
        if "bump" in thing:
            thing["bump"]["scale"] = thing["bump"].get("scale", 1) * factor


def moved(scene: Scene, m: Move) -> Scene:
    """All of it, by m. Heights and other lengths are scaled, too."""
    made = scene.copy()
    objects = made.tree["objects"]
    move_view(made.tree, m)
    scale_heights(objects, m.scale)
    for thing in objects.values():
        own = thing.get("transform", [])
        if thing.get("hidden"):
            continue  # it stays; its copies move
        if "copy" in thing and not objects[thing["copy"]].get("hidden"):
            thing["transform"] = [*m.back, *own, *m.steps]  # the original has moved already
        else:
            thing["transform"] = [*own, *m.steps]
    return made


def any_move(r: Draw) -> Move:
    return Move(r.choice((1.0, 0.5, 2.0, 0.037, 25.0)), r.choice(([0.0, 0.0, 0.0], r.point(-180, 180))),
                r.choice(([0.0, 0.0, 0.0], r.point(-9, 9))))


# ---- patterns mirrored in u ----------------------------------------------------------------------

def shapes(scene: Scene) -> dict[str, str]:
    """The shape of each object; of a copy that of its original."""
    objects = scene.tree["objects"]

    def shape(name: str) -> str:
        thing = objects[name]
        kind = shape_of(thing)
        if kind in ("copy", "copies"):
            return shape(thing["copy"] if kind == "copy" else thing["copies"]["of"])
        return kind

    return {name: shape(name) for name in objects}


def mirrored_bump(made: Scene, bump: Tree, shape: str) -> None:
    one = 1 if shape in ("rectangle", "box") else 0
    if "function" in bump:
        bump["function"] = variables(bump["function"], f"{one} - u", "w")
    elif shape != "plane" and bump["wrap"] != "repeat":
        raise CannotError("where a map begins that comes from the other end")
    else:
        name = bump["map"]["file"]
        joined = bump["wrap"] == "repeat" and bump.get("samples") == "corners"
        made.files[f"mirrored_{name}"] = mirror_file(made.files[name], name, joined)
        bump["map"] = bump["map"] | {"file": f"mirrored_{name}"}
        if shape == "plane":
            bump["offset"] = [-bump["size"][0], 0]  # the map lies from 0 to its size, so now from -size to 0


def mirror_file(data: bytes, name: str, joined: bool) -> bytes:
    """joined: the last column is not looked at, as it is where the first one comes again."""
    to, old = (files.exr, files.exr_values(data)) if name.endswith(".exr") else (files.png, files.pixels(data))
    columns = np.arange(old.shape[1])[::-1] % (old.shape[1] - joined)
    return to(np.ascontiguousarray(old[:, columns]))


def mirrored(scene: Scene) -> Scene:
    """In x, with the patterns, which a transform alone does not mirror."""
    made = moved(scene, Move(1, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], mirrors=True))
    shape = shapes(made)
    if any(isinstance(material["color"], dict) for material in made.tree["materials"].values()):
        raise CannotError("one material's pattern on several shapes")
    if any("copies" in thing for thing in made.tree["objects"].values()):
        raise CannotError("heights of a list of copies are those of the hidden original")
    for name, thing in made.tree["objects"].items():
        if "bump" in thing:
            if shape[name] in ("parametric", "patches", "mesh"):
                raise CannotError("no rule for where u goes there")
            mirrored_bump(made, thing["bump"], shape[name])
    return made


# ---- u and w exchanged ---------------------------------------------------------------------------

def exchanged_bump(made: Scene, bump: Tree) -> None:
    """n points to the other side then, so heights are negative."""
    if "function" in bump:
        bump |= {"function": variables(bump["function"], "w", "u"), "scale": -bump.get("scale", 1)}
        return
    name = bump["map"]["file"]
    turned = files.exr_values(made.files[name]) if name.endswith(".exr") else files.pixels(made.files[name])
    write = files.exr if name.endswith(".exr") else files.png
    made.files[f"exchanged_{name}"] = write(np.ascontiguousarray(turned.T))
    bump["map"] = bump["map"] | {"file": f"exchanged_{name}"}
    bump["sign"] = "down" if bump["sign"] == "up" else "up"
    for key in ("size", "repeat", "offset"):
        if key in bump:
            bump[key] = bump[key][::-1]


def exchanged_shape(thing: Tree, kind: str) -> None:
    shape: Any = thing[kind]
    if kind == "parametric":
        for axis in "xyz":
            shape[axis] = variables(shape[axis], "w", "u")
    if kind == "patches":
        shape["points"] = [[patch[4 * i + j] for j in range(4) for i in range(4)] for patch in shape["points"]]
    else:
        shape["u"], shape["w"] = shape["w"], shape["u"]


def exchanged(scene: Scene) -> Scene:
    """u and w of all shapes whose keys say which is which. What is on n's side changes, so glass can't be there."""
    made = scene.copy()
    done = False
    for thing in made.tree["objects"].values():
        kind = shape_of(thing)
        if kind not in ("plane", "rectangle", "parametric", "patches"):
            continue
        material = made.tree["materials"][thing["material"]]
        if isinstance(material["color"], dict) or "filter" in material or thing.get("hidden"):
            continue
        if any(thing is made.tree["objects"].get(other.get("copy")) for other in made.tree["objects"].values()):
            continue  # a copy may have a bump or a material of its own
        if any(step.get("scale") == [-1, 1, 1] for step in thing.get("transform", [])):
            continue  # u, whichever it is, runs the other way there
        exchanged_shape(thing, kind)
        if "bump" in thing:
            exchanged_bump(made, thing["bump"])
        done = True
    if not done:
        raise CannotError("no such shape")
    if made.tree["render"].get("bump_shadow") == "horizon":
        raise CannotError("surfaces seen from behind have the march in place of the table")
    return made


# ---- copies written out --------------------------------------------------------------------------

def written_out(scene: Scene) -> Scene:
    """Objects with `copy` in place of a list of copies."""
    made = scene.copy()
    objects: Tree = {}
    for name, thing in made.tree["objects"].items():
        if "copies" not in thing:
            objects[name] = thing
            continue
        lines = made.files[thing["copies"]["file"]].decode().split("\n")[1:-1]
        for k, line in enumerate(lines):
            *numbers, material = line.split(",")
            x, y, z, scale, a, b, c = map(float, numbers)
            objects[f"{name}{k}"] = {"copy": thing["copies"]["of"], **({"material": material} if material else {}),
                                     "transform": [{"scale": scale}, {"rotate": [a, b, c]}, {"translate": [x, y, z]}]}
    if len(objects) == len(made.tree["objects"]):
        raise CannotError("no list of copies with several copies")
    made.tree["objects"] = objects
    return made


# ---- P plus c on a plane moved by -c -------------------------------------------------------------

def one_rough_ground(scene: Scene, function: str, how: Tree) -> Scene:
    """The ground alone is rough, all else is above it."""
    made = scene.copy()
    objects = made.tree["objects"]
    for thing in objects.values():
        thing.pop("bump", None)
    objects["ground"] = {"plane": {"origin": [0, -1.6, 0], "u": [0, 0, 1], "w": [1, 0, 0]}, "material": "earth",
                         "bump": {"function": function}}
    made.tree["materials"]["earth"] = {"color": [0.8, 0.7, 0.6]}
    made.tree["render"] = how
    made.tree["camera"]["from"][1] += 2
    return made


def lowered(scene: Scene, c: float) -> Scene:
    """P is higher by c, and the plane lower."""
    made = scene.copy()
    ground = made.tree["objects"]["ground"]
    ground["plane"]["origin"][1] -= c
    ground["bump"]["function"] = f"{ground['bump']['function']} + {c}"
    return made


# ---- a scene that is symmetric under quarter turns about y ---------------------------------------

QUARTER = Move(1, [0.0, 90.0, 0.0], [0.0, 0.0, 0.0])


def symmetric(scene: Scene) -> Scene:
    """Up to two things of the scene, each four times, on a ground that is the same after a quarter turn; from above.
    They are tilted, as faces of two copies in one plane would be met in any order."""
    made = scene.copy()
    old = made.tree["objects"]
    things = {name: thing for name, thing in old.items() if name.startswith("thing") and "copy" not in thing}
    objects: Tree = {}
    for name, thing in list(things.items())[:2]:
        objects[name] = thing | {"transform": [{"rotate": [11, 3, 7]}, *thing.get("transform", [])]}
        for k in (1, 2, 3):
            objects[f"{name}_{k}"] = {"copy": name, "transform": [{"rotate": [0, 90 * k, 0]}]}
    f = "sin(3*u + 1)*cos(2*w) + 0.5*sin(u)"
    around = " + ".join(variables(f, u, w) for u, w in (("u", "w"), ("-w", "u"), ("-u", "-w"), ("w", "-u")))
    bounded = {"function": around, "scale": 0.02}
    objects["ground"] = {"plane": {"origin": [0, -0.9, 0], "u": [0, 0, 1], "w": [1, 0, 0]}, "material": "earth",
                         "bump": bounded}
    made.tree["materials"]["earth"] = {"color": [0.8, 0.7, 0.6], "phong": 0.4}
    made.tree["objects"] = objects
    made.tree["camera"] = {"from": [0, 8, 0], "at": [0, 0, 0], "up": [0, 0, 1], "width": 6}
    made.tree["image"]["size"] = [20, 20]
    return made


def lights_turned(scene: Scene) -> Scene:
    made = scene.copy()
    view = dict(made.tree["camera"])
    move_view(made.tree, QUARTER)
    made.tree["camera"] = view
    return made
