"""From a renderer's layers to its shadow rays: the method on pictures that another program traced.

    layers = gbuffer.layers(eye, position, uv, part=object_index)
    c = gbuffer.correct(layers, HeightMap(samples, size=(1, 1), scale=0.1), method="2")
    # shade with c.normal; test shadows of OTHER objects from c.origin along c.toward(light), up to 1 of its length

What is needed of each pixel is where the viewing ray meets the smooth surface, and (u,w) there. The rest follows from
differences between neighbours, or is taken from the renderer where it has it: tangents and smooth normals are better
than differences. docs/gbuffer.md is the guide. Layers have shape (height, width, ...); without differences any shape
will do. Symbols are those of docs/method.md.

The receiver itself must not be tested from c.origin: that may lie below its own smooth surface. Test it from the smooth
hit as before, or not at all where it is flat; `own_shadow` has the shadows of its bumps.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from kage import methods
from kage.methods import Bump, Like, Real

Mask = npt.NDArray[np.bool_]
MISS = 1e29  # farther positions are misses: kage's Z is 1e30 there, of which a component is more than half


class Heights(Protocol):
    """P over (u,w), which may be looked up anywhere. A kage.heights.HeightMap is one."""

    @property
    def bounds(self) -> tuple[float, float]:
        """The lowest and the highest P; infinite where there is none."""

    def __call__(self, u: Real, w: Real, /) -> Like:
        """P at (u,w)."""

    def bump(self, u: Real, w: Real, /) -> Bump:
        """P and its partials at (u,w)."""


@dataclass(frozen=True)
class Layers:
    """The smooth surface under each pixel. The viewing ray is eye + s t with s = position - eye, and meets it at 1."""

    eye: Real  # (3) or (..., 3)
    position: Real  # (..., 3): Q
    u: Real
    w: Real
    Qu: Real  # (..., 3); where the texture is mirrored, by -u, so that Qu x Qw is on the side of +P
    Qw: Real
    second: tuple[Real, Real, Real] | None  # Quu, Quw, Qww; None: taken as 0
    sign: Real  # (...): -1 where the texture is mirrored, 1 elsewhere
    there: Mask  # (...): the ray meets a surface of which all this is known

    @property
    def s(self) -> Real:
        return self.position - self.eye


@dataclass(frozen=True)
class Corrected:
    """What shading a pixel needs. Where nothing could be corrected the origin is the smooth hit."""

    origin: Real  # (..., 3): where rays to the lights start, for all objects but the receiver itself
    normal: Real  # (..., 3): n', of length 1
    tau: Real  # (...): the origin is position + s tau
    order: npt.NDArray[np.int32]  # as in kage's layer: -1 none, 0, 1, 2, 3 for 2+, 4 iter, 5 march
    fell_back: Mask  # another order than asked for
    u: Real  # the place under the origin, to shade by
    w: Real

    def toward(self, light: Like) -> Real:
        """From the origins to a light at a point, which is 1 of this away."""
        return np.asarray(light) - self.origin


# ---- layers ----


def layers(eye: Like, position: Like, uv: Like, *, normal: Like | None = None,
           tangents: tuple[Like, Like] | None = None, there: Like | None = None, part: Like | None = None) -> Layers:
    """The layers of a picture.

    eye: of the camera, or of each ray. position: smooth hits, not finite or beyond 1e29 where there is none; from a
    depth along rays of unit length it is eye + directions * depth[..., None]. uv: (..., 2), the coordinates of the
    bump. normal: of the smooth surface, on the side of +P, (3) or (..., 3); without it Qu x Qw must be. tangents: Qu
    and Qw, what position changes by for 1 of u and of w; without them they come from differences between neighbouring
    pixels. there: which pixels have the bump. part: an integer for each pixel; differences are taken within a part,
    such as an object.
    """
    position, uv = np.asarray(position), np.asarray(uv)
    if position.shape[-1:] != (3,) or uv.shape != (*position.shape[:-1], 2):
        raise ValueError(f"position, uv: expected shapes (..., 3) and (..., 2), not {position.shape} and {uv.shape}")
    known = np.ones(position.shape[:-1], np.bool_) if there is None else np.asarray(there, np.bool_)
    known = known & (np.abs(position) < MISS).all(-1) & np.isfinite(uv).all(-1)
    parts = np.where(known, 0 if part is None else np.asarray(part, np.int64), np.iinfo(np.int64).min)
    if tangents is None:
        Qu, Qw = partials(position, uv, parts)
    else:
        Qu, Qw = (np.asarray(x) for x in tangents)
    second, sign = None, np.ones(known.shape, position.dtype)
    if normal is not None:
        N = _unit(np.asarray(normal))
        sign = np.where(_dot(methods.normal(Qu, Qw), N) < 0, -sign, sign)
        Qu, Qw = (x - N * _dot(x, N)[..., None] for x in (Qu * sign[..., None], Qw))
        second = _bend(N, uv * np.stack([sign, np.ones_like(sign)], -1), parts, Qu, Qw) if N.ndim == 3 else None
    return Layers(np.asarray(eye), position, uv[..., 0], uv[..., 1], Qu, Qw, second, sign, known)


def partials(layer: Like, uv: Like, part: Like | None = None) -> tuple[Real, Real]:
    """What a layer (height, width, k) changes by for 1 of u and for 1 of w, from differences between pixels.

    Across the border of two parts, and where uv jumps, the pixels on the other side are taken. NaN where none are left.
    """
    x, uv = np.asarray(layer), np.asarray(uv)
    if x.ndim != 3 or uv.shape != (*x.shape[:2], 2):
        raise ValueError(f"expected shapes (height, width, k) and (height, width, 2), not {x.shape} and {uv.shape}")
    parts = np.zeros(x.shape[:2], np.int64) if part is None else np.asarray(part)
    both = np.concatenate([x, uv], -1)
    (along_x, along_y) = (_difference(both, parts, axis) for axis in (1, 0))
    (ux, wx), (uy, wy) = np.moveaxis(along_x[..., -2:], -1, 0), np.moveaxis(along_y[..., -2:], -1, 0)
    determinant = ux * wy - wx * uy
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = (1 / np.where(determinant == 0, np.nan, determinant))[..., None]
        by_u = (along_x[..., :-2] * wy[..., None] - along_y[..., :-2] * wx[..., None]) * scale
        by_w = (along_y[..., :-2] * ux[..., None] - along_x[..., :-2] * uy[..., None]) * scale
    return by_u, by_w


def _difference(x: npt.NDArray[Any], parts: npt.NDArray[Any], axis: int) -> npt.NDArray[Any]:
    """Along an axis: the mean of the steps to both neighbours, or the one that does not leave the part or jump."""
    x, parts = np.moveaxis(x, axis, 0), np.moveaxis(parts, axis, 0)
    step = np.where((parts[1:] == parts[:-1])[..., None], x[1:] - x[:-1], np.nan)
    none = np.full_like(x[:1], np.nan)
    before, after = np.concatenate([none, step]), np.concatenate([step, none])
    size = [np.nan_to_num(np.abs(d[..., -2:]).max(-1, keepdims=True), nan=np.inf) for d in (before, after)]
    mean = (before + after) / 2
    smaller = np.where(size[0] < size[1], before, after)
    like = np.maximum(*size) < 2 * np.minimum(*size)
    return np.moveaxis(np.where(like, mean, smaller), 0, axis)


def _bend(N: Real, uv: Real, parts: Real, Qu: Real, Qw: Real) -> tuple[Real, Real, Real]:
    """The second partials along N that its changes tell: L = -Nu.Qu and so on, as on a mesh (docs/method.md)."""
    Nu, Nw = (np.nan_to_num(x) for x in partials(N, uv, parts))
    L, M, K = -_dot(Nu, Qu), -(_dot(Nu, Qw) + _dot(Nw, Qu)) / 2, -_dot(Nw, Qw)
    return N * L[..., None], N * M[..., None], N * K[..., None]


# ---- the correction ----


def correct(a: Layers, heights: Heights | Bump, method: str = "1", *, guard: bool = True,
            bounds: tuple[float, float] | None = None, shade: str = "smooth") -> Corrected:
    """n', and where the shadow rays start.

    heights: a height map or function, or a Bump with the layers P, Pu, Pw, ... of each pixel; then iter, march and
    `shifted` cannot look P up elsewhere. method: none (or bump), 0, 1, 2, 2+, iter:K or march:N, as kage's. bounds:
    the lowest and the highest P, for the guard and march; those of `heights` if not given, and of the layer P of a
    Bump. shade: n' is that at the smooth hit, or at the place under the origin, "shifted".
    """
    word, _, number = ("none" if method == "bump" else method).partition(":")
    if word not in ORDERS or bool(number) != (word in ("iter", "march")) or (number and not number.isdigit()):
        raise ValueError(f"method {method!r}: expected none, 0, 1, 2, 2+, iter:K or march:N")
    if shade not in ("smooth", "shifted"):
        raise ValueError(f'shade {shade!r}: expected "smooth" or "shifted"')
    if isinstance(heights, Bump) and (number or shade == "shifted"):
        raise ValueError(f"method {method}, shade {shade}: heights must be a map or a function, not a Bump")
    lowest, highest = bounds or (_range(heights) if isinstance(heights, Bump) else heights.bounds)
    around = None if isinstance(heights, Bump) else _Turned(heights, a.sign)
    u0, w0 = a.u * a.sign, a.w
    with np.errstate(invalid="ignore", divide="ignore"):
        n = methods.normal(a.Qu, a.Qw)
        good = a.there & methods.regular(n, a.Qu, a.Qw) & np.isfinite(n).all(-1)
        p = _turned(heights, a.sign) if isinstance(heights, Bump) else _Turned(heights, a.sign).bump(u0, w0)
        v = methods.view(a.s, n, a.Qu, a.Qw)
        slab = methods.slab(v, lowest, highest)
        bend = methods.curvature(v, n, *a.second) if a.second else 0.0
        if word == "iter" and around:
            found = methods.iterate(v, around, u0, w0, int(number))
        elif word == "march" and around:
            found = methods.march(v, around, u0, w0, slab, int(number), curvature=bend)
        else:
            found = methods.shift(max(ORDERS[word], 0), v, p, slab, curvature=bend, guard=guard)
        moved = good & np.isfinite(found.tau) & (word != "none")
        tau = np.maximum(np.where(moved, found.tau, 0), -1)  # not before the eye
        order = np.where(moved, found.order, np.int32(-1))
        at = methods.place(v, u0, w0, tau)
        u, w = np.where(moved, at.u, u0), np.where(moved, at.w, w0)
        partials_there = methods.Offset(a.Qu, a.Qw)
        if shade == "shifted" and around:
            p = around.bump(u, w)
            partials_there = _rough(a, n, p.P)
        turned = methods.perturbed_normal(methods.normal(*partials_there), *partials_there, p.Pu, p.Pw)
    return Corrected(origin=a.position + a.s * tau[..., None],
                     normal=np.where(good[..., None], _unit(turned), _unit(n)), tau=tau, order=order,
                     fell_back=a.there & (order != ORDERS[word]), u=u * a.sign, w=w)


#: What kage's layer `order` has for a method.
ORDERS = {"none": -1, "0": 0, "1": 1, "2": 2, "2+": 3, "iter": 4, "march": 5}


class _Turned:
    """Heights over (-u,w) where the texture is mirrored."""

    def __init__(self, heights: Heights, sign: Real) -> None:
        self._heights, self._sign = heights, sign

    def __call__(self, u: Real, w: Real) -> Like:
        return self._heights(u * self._sign, w)

    def bump(self, u: Real, w: Real) -> Bump:
        return _turned(self._heights.bump(u * self._sign, w), self._sign)


def _turned(p: Bump, sign: Real) -> Bump:
    return p._replace(Pu=p.Pu * sign, Puw=p.Puw * sign)


def _rough(a: Layers, n: Real, P: Like) -> methods.Offset:
    """The partials of the surface at height P."""
    return methods.offset(n, a.Qu, a.Qw, *a.second, P) if a.second else methods.Offset(a.Qu, a.Qw)


# ---- lights ----


def own_shadow(a: Layers, c: Corrected, heights: Heights, light: Like, steps: int = 16) -> Mask:
    """Whether the surface's own bumps hide a light at a point from the place under the origin: bs_way of bumpshadow.h.

    Also True where n' or the way itself is turned away from the light at the start.
    """
    around, u, w = _Turned(heights, a.sign), c.u * a.sign, c.w
    with np.errstate(invalid="ignore", divide="ignore"):
        n = methods.normal(a.Qu, a.Qw)
        P = np.asarray(around(u, w))
        toward = c.toward(light)
        d = methods.view(toward, n, *_rough(a, n, P))
        bend = methods.curvature(d, n, *a.second) if a.second else 0.0
        turn = methods.turn(d, n, a.Qu, a.Qw, *a.second) if a.second else None
        side = np.where(_dot(a.s, n) < 0, 1, -1).astype(P.dtype)
        y = methods.way(side, d, bend, P, *heights.bounds)
        dark = (side * _dot(c.normal, toward) <= 0) | methods.own_shadow(y, around, u, w, steps, turn=turn)
    return np.asarray(dark & (c.order >= 0))


def _dot(a: Real, b: Real) -> Real:
    return np.einsum("...i,...i->...", a, b)  # type: ignore[no-any-return]


def _unit(a: Real) -> Real:
    with np.errstate(invalid="ignore", divide="ignore"):
        return a / np.sqrt(_dot(a, a))[..., None]


def _range(p: Bump) -> tuple[float, float]:
    return float(np.nanmin(p.P)), float(np.nanmax(p.P))
