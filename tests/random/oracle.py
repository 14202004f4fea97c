"""What a ray meets first, by numpy in double and one formula a shape: an opinion that shares nothing with kage."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.random.change import turn
from tests.random.draw import Scene, Tree, shape_of

FORMS = ("plane", "rectangle", "disc", "box", "sphere", "cylinder", "cone", "torus", "ellipsoid")
Rays = tuple[np.ndarray, np.ndarray]  # r and s: n x 3
FAR = 1e30


def unit(v: Any) -> np.ndarray:
    return np.asarray(v, float) / np.linalg.norm(v)


def camera_rays(tree: Tree) -> Rays:
    """Through the middles of all pixels, row by row; s goes one unit ahead, so that t is the depth."""
    view, (width, height) = tree["camera"], tree["image"]["size"]
    eye = np.array(view["from"], float)
    ahead = unit(np.array(view["at"], float) - eye)
    right = unit(np.cross(view.get("up", [0, 1, 0]), ahead))
    up = np.cross(ahead, right)
    half = view["width"] / 2 if "width" in view else np.tan(np.radians(view["fov"]) / 2)
    y, x = np.mgrid[0:height, 0:width]
    a = ((2 * x.ravel() + 1) / width - 1) * half
    b = (1 - (2 * y.ravel() + 1) / height) * half * height / width
    across = a[:, None] * right + b[:, None] * up
    if "width" in view:
        return eye + across, np.tile(ahead, (len(a), 1))
    return np.tile(eye, (len(a), 1)), ahead + across


def matrix(steps: list[Tree]) -> tuple[np.ndarray, np.ndarray]:
    """p -> m p + v."""
    m, v = np.eye(3), np.zeros(3)
    for step in steps:
        (kind, value), = step.items()
        if kind == "translate":
            v = v + value
            continue
        by = turn(value) if kind == "rotate" else np.diag(np.ones(3) * value)
        m, v = by @ m, by @ v
    return m, v


def first(*ts: np.ndarray) -> np.ndarray:
    """The least t above 0; NaN: none."""
    return np.min([np.where(t > 1e-9, t, FAR) for t in ts], axis=0)


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.einsum("ij,ij->i", a, np.broadcast_to(b, a.shape))


def roots(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of a t² + 2 b t + c; NaN: none."""
    d = np.sqrt(b * b - a * c)
    return (-b - d) / a, (-b + d) / a


def flat(rays: Rays, origin: Any, u: Any, w: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """t, and (u,w) there."""
    n = np.cross(u, w)
    t = dot(np.array(origin) - rays[0], n) / dot(rays[1], n)
    at = rays[0] + t[:, None] * rays[1] - np.array(origin)
    return t, dot(at, np.cross(w, n) / dot(n[None], n)), dot(at, np.cross(n, u) / dot(n[None], n))


def disc(rays: Rays, centre: Any, normal: Any, radius: float) -> np.ndarray:
    n = unit(normal)
    t = dot(np.array(centre) - rays[0], n) / dot(rays[1], n)
    at = rays[0] + t[:, None] * rays[1] - np.array(centre)
    return np.where(dot(at, at) <= radius**2, t, FAR)


def turned(rays: Rays, base: Any, radius: float, top: Any, top_radius: float, is_open: bool) -> np.ndarray:
    """A cylinder or a cone."""
    length = float(np.linalg.norm(np.array(top) - base))
    axis = unit(np.array(top) - base)
    slope = (top_radius - radius) / length
    from_base = rays[0] - np.array(base)
    h, dh = dot(from_base, axis), dot(rays[1], axis)
    p, s = from_base - h[:, None] * axis, rays[1] - dh[:, None] * axis
    k = radius + slope * h  # the radius at the ray's height
    ts = roots(dot(s, s) - (slope * dh) ** 2, dot(p, s) - k * slope * dh, dot(p, p) - k * k)
    sides = [np.where((h + t * dh >= 0) & (h + t * dh <= length), t, FAR) for t in ts]
    caps = [] if is_open else [disc(rays, base, axis, radius), disc(rays, top, axis, top_radius)]
    return first(*sides, *caps)


def torus(rays: Rays, centre: Any, axis: Any, major: float, minor: float) -> np.ndarray:
    y, found = unit(axis), np.full(len(rays[0]), FAR)
    for i, (r, s) in enumerate(zip(rays[0] - np.array(centre), rays[1], strict=True)):
        size = float(s @ s)
        p = np.polynomial.Polynomial([r @ r + major**2 - minor**2, 2 * (r @ s), size])
        h = np.polynomial.Polynomial([r @ y, s @ y])
        q = p**2 - 4 * major**2 * (np.polynomial.Polynomial([r @ r, 2 * (r @ s), size]) - h**2)
        t = q.roots()
        real = t.real[(np.abs(t.imag) < 1e-9) & (t.real > 1e-9)]
        found[i] = real.min() if len(real) else FAR
    return found


def meet(rays: Rays, kind: str, it: Tree) -> np.ndarray:
    """t of the first hit of a shape; infinite: none."""
    if kind in ("plane", "rectangle"):
        t, u, w = flat(rays, it["origin"], it["u"], it["w"])
        return t if kind == "plane" else np.where((u >= 0) & (u <= 1) & (w >= 0) & (w <= 1), t, FAR)
    if kind == "disc":
        return disc(rays, it["center"], it["normal"], it["radius"])
    if kind == "box":
        lo, hi = np.minimum(it["from"], it["to"]), np.maximum(it["from"], it["to"])
        a, b = (lo - rays[0]) / rays[1], (hi - rays[0]) / rays[1]
        enter, leave = np.minimum(a, b).max(1), np.maximum(a, b).min(1)
        return np.where(enter <= leave, first(enter, leave), FAR)
    if kind in ("sphere", "ellipsoid"):
        radii = np.ones(3) * (it["radii"] if "radii" in it else it["radius"])
        p, s = (rays[0] - np.array(it["center"])) / radii, rays[1] / radii
        return first(*roots(dot(s, s), dot(p, s), dot(p, p) - 1))
    if kind == "torus":
        return torus(rays, it["center"], it["axis"], it["major"], it["minor"])
    a, b = (it["radius"],) * 2 if kind == "cylinder" else (it["from_radius"], it["to_radius"])
    return turned(rays, it["from"], a, it["to"], b, it["open"])


def nearest(scene: Scene) -> np.ndarray:
    """The depth of what each pixel shows, of the shapes above."""
    tree = scene.tree
    rays, found = camera_rays(tree), []
    for thing in tree["objects"].values():
        of, steps = thing, list(thing.get("transform", []))
        while "copy" in of:
            of = tree["objects"][of["copy"]]
            steps = [*of.get("transform", []), *steps]
        m, v = matrix(steps)
        back = np.linalg.inv(m)
        with np.errstate(invalid="ignore", divide="ignore"):
            t = first(meet(((rays[0] - v) @ back.T, rays[1] @ back.T), shape_of(of), of[shape_of(of)]))
        found.append(np.where(np.isnan(t), FAR, t))
    width, height = tree["image"]["size"]
    return np.min(found, axis=0).reshape(height, width)
