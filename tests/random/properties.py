"""What must hold for every scene. A property renders a scene and a change of it, and says in words how the pictures
differ more than they may.

Where a bound is not 0, it comes from rounding. In double the pictures of a scene and of a moved one agree to 1e-9, and
planes are floats, so 2e-5 of a value is far above what is due. But a ray that passes an edge within the rounding may
fall on its other side; so a property says how many pixels of the few hundred may be others.
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from typing import Any

import numpy as np

from tests.random.change import (
    CannotError,
    any_move,
    exchanged,
    lights_turned,
    lowered,
    mirrored,
    moved,
    one_rough_ground,
    shapes,
    symmetric,
    written_out,
)
from tests.random.draw import Draw, Scene, searched, shape_of
from tests.random.lab import Lab, Planes
from tests.random.oracle import FORMS, nearest

Property = Callable[[Lab, Scene, Draw], str]
SAME = 2e-5
EDGES = 2  # pixels


def unlike(a: np.ndarray, b: np.ndarray, within: float) -> np.ndarray:
    """Where two planes differ by more than `within` of 1 or of the value."""
    with np.errstate(invalid="ignore"):
        far = np.abs(a.astype(float) - b) > within * np.maximum(1, np.abs(b))
    return np.asarray(np.where(np.isfinite(a) & np.isfinite(b), far, ~((a == b) | (np.isnan(a) & np.isnan(b)))))


def complaint(a: Planes, b: Planes, names: list[str] | None = None, within: float = SAME, edges: int = EDGES,
              where: np.ndarray | None = None) -> str:
    """Empty where the pictures agree but for `edges` pixels."""
    names = list(b) if names is None else [name for name in b if any(name.startswith(start) for start in names)]
    wrong = {name: unlike(a[name], b[name], within) & (True if where is None else where) for name in names}
    some = np.logical_or.reduce(list(wrong.values()))
    if some.sum() <= edges:
        return ""
    y, x = np.argwhere(some)[0]
    told = [f"{name} {a[name][y, x]:g} for {b[name][y, x]:g}" for name in names if wrong[name][y, x]]
    return f"{some.sum()} of {some.size} pixels differ, {edges} may; the first, {x},{y}: {', '.join(told[:6])}"


def same(a: Planes, b: Planes) -> str:
    """Byte by byte."""
    if list(a) != list(b):
        return f"planes {list(a)} for {list(b)}"
    bad = [name for name in a if a[name].tobytes() != b[name].tobytes()]
    return complaint(a, b, bad, 0, -1) if bad else ""


COLOURS = ["R", "G", "B", "visibility"]
#: Of the layers those that do not change as the scene is moved and scaled.
FIXED = [*COLOURS, "uw"]


def plain(scene: Scene) -> Scene:
    """Without what a last digit may change as a whole: adaptive samples, and `auto`, whose steps depend on the size of
    a pixel (march:4 in its place). And without a march to the light over plateaus: its last step is where the way has
    just risen to Pmax, so a plateau at Pmax is neither below the way nor above it."""
    made = scene.copy()
    how = made.tree["render"]
    how.pop("aa_threshold", None)
    if str(how.get("shadow")).startswith("auto"):
        how["shadow"] = "march:4"
    bumps = [thing["bump"] for thing in made.tree["objects"].values() if "bump" in thing]
    level = ("select", "mod", "clamp", "smoothstep")
    if any(word in bump.get("function", "") or bump.get("wrap") == word for bump in bumps for word in level):
        how["bump_shadow"] = "none"
    return made


# ---- the same bytes ------------------------------------------------------------------------------

def builds(lab: Lab, scene: Scene, r: Draw) -> str:
    """All builds in float: compilers, levels of optimisation, and, for 20 pixels, without hierarchies."""
    others = [name for name in lab.builds if name not in ("float", "double")]
    if not others:
        raise CannotError("there is one build only")
    want = lab.picture(scene)
    x, y = r.randint(0, 12), r.randint(0, 8)
    part = {name: np.ascontiguousarray(plane[y:y + 4, x:x + 5]) for name, plane in want.items()}
    wrong = ((name, same(lab.picture(scene, name, crop=(x, y, x + 5, y + 4)), part) if name == "brute" else
              same(lab.picture(scene, name), want)) for name in others)
    return "; ".join(f"{name}: {told}" for name, told in wrong if told)


def threads(lab: Lab, scene: Scene, _: Draw) -> str:
    return same(lab.picture(scene, threads=7), lab.picture(scene))


def crops(lab: Lab, scene: Scene, r: Draw) -> str:
    """A part, and single pixels: one ray at a time in place of waves."""
    whole = lab.picture(scene)
    width, height = scene.tree["image"]["size"]
    parts = [(r.randint(0, 8), r.randint(0, 6), r.randint(9, width), r.randint(7, height))]
    parts += [(x, y, x + 1, y + 1) for x, y in ((r.randrange(width), r.randrange(height)) for _ in range(12))]
    for x0, y0, x1, y1 in parts:
        wrong = same(lab.picture(scene, crop=(x0, y0, x1, y1)),
                     {name: np.ascontiguousarray(plane[y0:y1, x0:x1]) for name, plane in whole.items()})
        if wrong:
            return f"crop {x0},{y0},{x1},{y1}: {wrong}"
    return ""


def larger(lab: Lab, scene: Scene, _: Draw) -> str:
    """Written at once, and in bands of 16 rows: the same file."""
    made = scene.copy()
    made.tree["image"]["size"][1] = 37
    lab.picture(made, save=str(lab.folder / "whole.exr"))
    lab.picture(made, file=str(lab.folder / "bands.exr"), band=16)
    if (lab.folder / "whole.exr").read_bytes() != (lab.folder / "bands.exr").read_bytes():
        return "the file in bands has other bytes"
    return ""


def far_objects(lab: Lab, scene: Scene, _: Draw) -> str:
    """14 specks where no ray goes: then a hierarchy finds what a ray meets, in place of a test of all."""
    if str(scene.tree["render"].get("shadow")).startswith("auto"):
        raise CannotError("auto asks the hierarchy by three rays only, as method.md says")
    made = scene.copy()
    made.tree["materials"]["dull"] = {"color": [0, 0, 0]}  # with glass in it light is summed in another order
    for k in range(14):
        made.tree["objects"][f"speck{k}"] = {"sphere": {"center": [2e4 + 3e3 * k, 7e4, -9e4 + 5e3 * k], "radius": 1e-3},
                                             "material": "dull"}
    return same(lab.picture(made), lab.picture(scene))


def reversed_objects(lab: Lab, scene: Scene, _: Draw) -> str:
    made = scene.copy()
    made.tree["objects"] = dict(reversed(made.tree["objects"].items()))
    return complaint(lab.picture(made), lab.picture(scene), within=1e-6)  # what glass lets through, in another order


def channels(lab: Lab, scene: Scene, _: Draw) -> str:
    """Red for green, green for blue, blue for red in all colours."""
    if "aa_threshold" in scene.tree["render"] or "colour.png" in scene.named():
        raise CannotError("the sum of the channels, and pictures")

    def turned(value: Any, key: str = "") -> Any:
        if isinstance(value, dict):
            return {name: turned(inner, name) for name, inner in value.items()}
        if key in ("color", "even", "odd", "background", "reflection") and isinstance(value, list):
            return [value[1], value[2], value[0]]
        return value

    made = scene.copy()
    made.tree = turned(made.tree)
    a, b = lab.picture(made), lab.picture(scene)
    b = b | {"R": b["G"], "G": b["B"], "B": b["R"]}
    return complaint(a, b, within=1e-6, edges=0)  # the visibility is a mean of the three, summed in another order


def fresh(lab: Lab, scene: Scene, r: Draw) -> str:
    """A scene that is changed after a render is as if it had been read so."""
    made = scene.copy()
    changes: dict[str, Any] = {"camera.from": [r.within(-4, 4), 5.5, r.within(-8, -5)], "render.shadow": "1"}
    name = r.choice(list(made.tree["objects"]))
    changes[f"objects.{name}.transform"] = [{"rotate": [0, 30, 0]}, {"translate": [0.3, 0.2, -0.1]}]
    light = r.choice(list(made.tree["lights"]))
    changes[f"lights.{light}.color"] = [0.5, 0.7, 0.9]
    got = lab.picture(scene, then=changes)
    made.tree["camera"]["from"], made.tree["render"]["shadow"] = changes["camera.from"], "1"
    made.tree["objects"][name]["transform"] = changes[f"objects.{name}.transform"]
    made.tree["lights"][light]["color"] = changes[f"lights.{light}.color"]
    return same(got, lab.picture(made)) or same(lab.picture(scene, first=changes), got)


def list_of_copies(lab: Lab, scene: Scene, _: Draw) -> str:
    """As objects that are written out: the same pixels, on discs and rectangles up to roundings."""
    made = plain(scene)
    if str(scene.tree["render"]["shadow"]) != made.tree["render"]["shadow"]:
        raise CannotError("auto has other layers there, as scene.md says")
    if made.tree["render"].get("bump_shadow") == "horizon":
        raise CannotError("the march stands in on a list")
    stuff = [material for material in made.tree["materials"].values() if "filter" in material]
    stone = made.tree["objects"].get("stone", {})
    if stuff and "bump" in stone:
        raise CannotError("between bumped copies of glass shadow rays start elsewhere")
    other = written_out(made)
    if shape_of(stone) in ("rectangle", "disc"):
        return complaint(lab.picture(made, "double"), lab.picture(other, "double"))
    return complaint(lab.picture(made), lab.picture(other), [*COLOURS, "Z", "P", "N", "height"], within=0, edges=0)


# ---- lights and colours --------------------------------------------------------------------------

def brightness(lab: Lab, scene: Scene, _: Draw) -> str:
    """Light adds: that of each light alone, and of none, gives the picture; twice the light is twice the rest."""
    made = plain(scene)

    def lit(factors: dict[str, float]) -> np.ndarray:
        other = made.copy()
        for name, light in other.tree["lights"].items():
            light["color"] = [x * factors.get(name, 0) for x in light["color"]]
        planes = lab.picture(other)
        return np.stack([planes[c] for c in "RGB"], -1).astype(float)

    names = list(made.tree["lights"])
    dark, all_lit = lit({}), lit(dict.fromkeys(names, 1.0))
    total = dark + sum(lit({name: 1.0}) - dark for name in names)
    twice = lit(dict.fromkeys(names, 2.0))
    for told, a, b in (("the sum of the lights", total, all_lit), ("twice the light", twice, 2 * all_lit - dark)):
        wrong = unlike(a, b, 1e-5).any(-1).sum()
        if wrong:
            return f"{told}: {wrong} pixels differ"
    return ""


def deeper(lab: Lab, scene: Scene, _: Draw) -> str:
    """One more reflection or refraction never takes light away."""
    made = plain(scene)
    last: Planes = {}
    for depth in (1, 2, 3, 5):
        made.tree["render"]["depth"] = depth
        now = lab.picture(made)
        if last:
            lost = max(float((last[c] - now[c] - 1e-6 * np.abs(now[c])).max()) for c in "RGB")
            if lost > 0:
                return f"depth {depth}: {lost:g} less light than before"
        last = now
    return ""


def samples(lab: Lab, scene: Scene, _: Draw) -> str:
    """aa: 2 is the mean of the four pixels of a picture of twice the size."""
    made = plain(scene)
    made.tree["render"]["aa"] = 2
    few = lab.picture(made)
    made.tree["render"]["aa"] = 1
    made.tree["image"]["size"] = [2 * n for n in made.tree["image"]["size"]]
    many = lab.picture(made, layers=False)
    mean = {c: sum(many[c][i::2, j::2].astype(float) for i in (0, 1) for j in (0, 1)) / 4 for c in "RGB"}
    return complaint(few, {c: np.asarray(mean[c]) for c in "RGB"}, within=1e-5)


def no_height(lab: Lab, scene: Scene, r: Draw) -> str:
    """P = 0: all methods are none."""
    made = plain(scene)
    for thing in made.tree["objects"].values():
        if "bump" in thing:
            thing["bump"] = {"function": "0*u"}
    made.tree["render"] = {"shadow": "none", "depth": made.tree["render"]["depth"]}
    want = lab.picture(made)
    methods = ["0", "1", "2", "2+", "iter:2", "march:3", "auto"]
    if searched(scene.tree["render"]):  # then the shapes are those on which it is quick
        methods.append("exact")
    for method in r.sample(methods, 3):
        made.tree["render"]["shadow"] = method
        got = lab.picture(made)
        found = method == "exact"  # by a search, to float's rounding
        wrong = complaint(got, want, [name for name in want if name not in ("order", "tau")], SAME if found else 0,
                          2 * EDGES if found else 0)
        if wrong or np.abs(got["tau"]).max() > (1e-4 if found else 0):
            return f"{method}: {wrong or 'tau is not 0'}"
    return ""


# ---- the scene moved -----------------------------------------------------------------------------

def moves(lab: Lab, scene: Scene, r: Draw) -> str:
    made = plain(scene)
    return complaint(lab.picture(moved(made, any_move(r)), "double"), lab.picture(made, "double"), FIXED)


def mirrors(lab: Lab, scene: Scene, _: Draw) -> str:
    made = plain(scene)
    made.tree["render"].pop("aa", None)  # layers are those of the first sample, which is not in the middle
    got = lab.picture(mirrored(made), "double")
    return complaint({name: plane[:, ::-1] for name, plane in got.items()}, lab.picture(made, "double"),
                     [*COLOURS, "Z", "height", "tau"])


def exchanges(lab: Lab, scene: Scene, _: Draw) -> str:
    """u and w."""
    made = plain(scene)
    return complaint(lab.picture(exchanged(made), "double"), lab.picture(made, "double"), [*COLOURS, "Z", "P", "tau"])


def lower_plane(lab: Lab, scene: Scene, r: Draw) -> str:
    """P plus c on a plane moved by -c is the same rough surface. A method finds the same start of shadow rays where it
    depends on that surface alone: the truth and the march, whose slab stays, for any P; an order where its Taylor
    polynomial is P itself, order 2 without a cross term. Near the middle: far from it a ray meets a quadric twice."""
    method, function = r.choice((
        ("exact", "0.1*sin(3*u)*cos(4*w)"), ("march:7", "0.1*sin(3*u + w)"), ("march:2", "0.08*noise(2*u, 3*w)"),
        ("0", "0.05"), ("1", "0.03 + 0.1*u - 0.05*w"), ("2", "0.02*u^2 - 0.03*w^2 + 0.1*u"),
        ("2+", "0.02*u^2 - 0.03*w^2 + 0.04*u*w + 0.01")))
    shade = r.choice(("smooth", "shifted"))
    made = one_rough_ground(scene, function, {"shadow": method, "shade": shade, "guard": r.often(0.5), "depth": 1})
    a, b = (lab.picture(other, "double") for other in (lowered(made, r.choice((0.05, -0.04, 0.2))), made))
    near = np.all([np.abs(planes[f"uw.{k}"]) < 2.5 for planes in (a, b) for k in "uw"], axis=0)
    as_asked = ["0", "1", "2", "2+", "iter", "march", "exact"].index(method.partition(":")[0])  # not a lower order
    both = near & (a["height"] != 0) & (b["height"] != 0) & (a["order"] == as_asked) & (b["order"] == as_asked)
    if shade == "shifted":
        return complaint(a, b, [*COLOURS, "Z", "P", "N"], where=both)
    for planes in (a, b):
        planes["start"] = planes["Z"] + planes["tau"]
    return complaint(a, b, ["visibility", "start"], where=both)


def quarter_turns(lab: Lab, scene: Scene, _: Draw) -> str:
    """A quarter turn of the lights over a scene that such a turn does not change turns the picture."""
    made = symmetric(plain(scene))
    made.tree["render"].pop("aa", None)
    got = lab.picture(lights_turned(made), "double")
    return complaint({name: np.rot90(plane) for name, plane in got.items()}, lab.picture(made, "double"),
                     [*COLOURS, "Z", "height", "tau"])


def same_view(lab: Lab, scene: Scene, _: Draw) -> str:
    """`at` further along, and an `up` of another length that leans along the view."""
    made = plain(scene)
    view = made.tree["camera"]
    eye, ahead = np.array(view["from"]), np.array(view["at"]) - np.array(view["from"])
    want = lab.picture(made, "double")
    view["up"] = (3 * np.array(view.get("up", [0, 1, 0])) + 0.4 * ahead).tolist()
    view["at"] = (eye + 2.5 * ahead).tolist()
    return complaint(lab.picture(made, "double"), want, [name for name in want if name != "order"])


def first_hits(lab: Lab, scene: Scene, _: Draw) -> str:
    """Depths against numpy's (oracle.py)."""
    made = scene.copy()
    objects, shape = made.tree["objects"], shapes(scene)
    made.tree["objects"] = {name: thing for name, thing in objects.items()
                            if shape[name] in FORMS and "copies" not in thing and not thing.get("hidden")}
    made.tree["render"] = {"shadow": "none", "depth": 1}
    if not made.tree["objects"]:
        raise CannotError("no shape with a formula")
    return complaint(lab.picture(made, "double"), {"Z": nearest(made)})


def program(lab: Lab, scene: Scene, _: Draw) -> str:
    """The program writes the same bytes as the package."""
    scene.write(lab.folder / "scene.yaml")
    lab.picture(scene, save=str(lab.folder / "package.exr"), name="scene.yaml")
    done = subprocess.run([lab.builds["float"] / "kage", "render", "scene.yaml", "-o", "program.exr", "--quiet"],
                          cwd=lab.folder, capture_output=True, text=True, timeout=lab.seconds)
    if done.returncode or (lab.folder / "program.exr").read_bytes() != (lab.folder / "package.exr").read_bytes():
        return f"exit status {done.returncode}, other bytes: {done.stderr}"
    return ""


def precision(lab: Lab, scene: Scene, _: Draw) -> str:
    """float against double. A float's last digit is 6e-8 of a value; bumps and refractions make it larger, but it stays
    below 2 % of the colour on nine pixels of ten. Edges, of objects and of shadows, are on the others."""
    made = plain(scene)
    return complaint(lab.picture(made), lab.picture(made, "double"), ["R", "G", "B", "Z"], 0.02,
                     int(0.1 * np.prod(made.tree["image"]["size"])))


PROPERTIES: dict[str, Property] = {
    found.__name__: found for found in (
        builds, threads, crops, larger, far_objects, reversed_objects, channels, fresh, list_of_copies, brightness,
        deeper, samples, no_height, moves, mirrors, exchanges, lower_plane, quarter_turns, same_view, first_hits,
        program, precision)}


def check(lab: Lab, scene: Scene, name: str, seed: int) -> str | None:
    """What is wrong; empty: nothing; None: the property says nothing of this scene."""
    try:
        return PROPERTIES[name](lab, scene.copy(), Draw(seed))
    except CannotError:
        return None


def chosen(seed: int, few: int) -> list[str]:
    """Some properties for the scene of a seed, each as often as any other; `builds` is for those who have some."""
    others = [name for name in PROPERTIES if name != "builds"]
    return Draw(seed).sample(others, min(few, len(others)))
