"""A scene file as numbers for the page docs/live/: what its shaders know, and nothing else.

The page knows a bumped plane, rectangle or sphere with a map, and over it a plain box or sphere, under one point light.
Anything else in a scene is an error here, so that the page cannot quietly draw something else than kage.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import yaml
from numpy.typing import NDArray
from PIL import Image

SCENES = ("cube", "sphere", "terrain")
BEFORE, BEHIND = 1, 2  # rows and columns of a table around its cells, as in src/texture/heights.h

Json = dict[str, Any]
Heights = NDArray[np.int64]


class SceneError(Exception):
    """A scene that the page cannot draw."""


@dataclass
class Map:
    """Samples as whole numbers, with those around them that a look-up needs; `unit` of the file's values each."""

    table: Heights
    unit: float
    cells: tuple[int, int]
    size: tuple[int, int]

    def header(self) -> Json:
        rows, columns = self.table.shape
        return {"columns": columns, "rows": rows, "unit": self.unit,
                "low": int(self.table.min()), "high": int(self.table.max())}


def only(at: Json, allowed: str, where: str) -> Json:
    extra = set(at) - set(allowed.split())
    if extra:
        raise SceneError(f"{where}: the page does not know {', '.join(sorted(extra))}")
    return at


def one(at: Json, where: str) -> Json:
    if len(at) != 1:
        raise SceneError(f"{where}: the page takes one, not {len(at)}")
    return next(iter(at.values()))


# Maps -----------------------------------------------------------------------------------------------------------


def read_samples(path: Path, channel: str | None) -> tuple[Heights, float]:
    if channel:
        v = OpenEXR.File(str(path)).channels()[channel].pixels.astype(float)
        whole = np.rint(v).astype(np.int64)
        if not (whole == v).all() or whole.min() < 0 or whole.max() > 0xFFFF:
            raise SceneError(f"{path.name}: the page takes whole numbers of 16 bits")
        return whole, 1.0
    with Image.open(path) as image:
        if not image.mode.startswith("I"):
            raise SceneError(f"{path.name}: a picture of mode {image.mode}, the page takes one of 16 bits")
        return np.asarray(image).astype(np.int64), 1 / 0xFFFF


def read_map(path: Path, channel: str | None, repeats: bool, corners: bool) -> Map:
    v, unit = read_samples(path, channel)
    if repeats == corners:
        raise SceneError("the page takes maps that repeat by cells, or are clamped by corners")
    rows, columns = (n - corners for n in v.shape)
    behind = BEHIND - corners
    table = np.pad(v, ((BEFORE, behind), (BEFORE, behind)), mode="wrap" if repeats else "edge")
    return Map(table, unit, (columns, rows), (v.shape[1], v.shape[0]))


def read_bump(bump: Json, extent: list[list[float]] | None, folder: Path, maps: dict[str, Map]) -> Json:
    """extent: that of the surface's u and w; None: it has no end."""
    only(bump, "map size repeat scale zero sign samples wrap", "bump")
    source = only(bump["map"], "file channel", "map")
    name = Path(source["file"]).stem
    repeats, corners = bump.get("wrap", "repeat") == "repeat", bump.get("samples", "cells") == "corners"
    if name not in maps:
        maps[name] = read_map(folder / source["file"], source.get("channel"), repeats, corners)
    m = maps[name]
    start = np.array([e[0] for e in extent]) if extent else np.zeros(2)
    size = np.array(bump["size"]) if "size" in bump else np.ptp(np.array(extent), axis=1) / bump.get("repeat", [1, 1])
    k = (np.array(m.size) - corners) / size
    o = -start * k - (0 if corners else 0.5)
    if bump["sign"] not in ("up", "down"):
        raise SceneError(f"sign: {bump['sign']}")
    return {"map": name, "repeats": repeats, "k": k.tolist(), "o": o.tolist(), "cells": list(m.cells),
            "scale": bump["scale"] * (1 if bump["sign"] == "up" else -1), "zero": bump["zero"]}


# Objects --------------------------------------------------------------------------------------------------------


def read_flat(kind: str, at: Json) -> Json:
    origin, u, w = (np.array(at[key], dtype=float) for key in ("origin", "u", "w"))
    n = np.cross(u, w)
    vectors = {"O": origin, "U": u, "W": w, "Du": np.cross(w, n) / (n @ n), "Dw": np.cross(n, u) / (n @ n),
               "N": n / np.linalg.norm(n)}
    return {"kind": kind, "unit": [float(np.linalg.norm(x)) for x in (u, w)]} | {
        key: x.tolist() for key, x in vectors.items()}


def read_ground(at: Json, folder: Path, maps: dict[str, Map]) -> Json:
    kind = next((k for k in ("plane", "rectangle", "sphere") if k in at), None)
    if not kind:
        raise SceneError("the bumped object: the page takes a plane, a rectangle or a sphere")
    only(at, f"{kind} material bump", "the bumped object")
    if kind == "sphere":
        radius = at[kind]["radius"]
        surface: Json = {"kind": kind, "centre": at[kind]["center"], "radius": radius, "unit": [radius, radius]}
        extent: list[list[float]] | None = [[-np.pi, np.pi], [0, np.pi]]
    else:
        surface = read_flat(kind, at[kind])
        extent = [[0, 1], [0, 1]] if kind == "rectangle" else None
    bump = read_bump(at["bump"], extent, folder, maps)
    width = min(unit / abs(k) for unit, k in zip(surface["unit"], bump["k"], strict=True))
    return surface | {"bump": bump, "sample_width": width}


def read_caster(at: Json) -> Json:
    kind = next((k for k in ("box", "sphere") if k in at), None)
    if not kind:
        raise SceneError("the plain object: the page takes a box or a sphere")
    only(at, f"{kind} material", "the plain object")
    if kind == "sphere":
        return {"kind": kind, "centre": at[kind]["center"], "radius": at[kind]["radius"]}
    ends = np.array([at[kind]["from"], at[kind]["to"]])
    return {"kind": kind, "lo": ends.min(axis=0).tolist(), "hi": ends.max(axis=0).tolist()}


def read_material(at: Json) -> Json:
    only(at, "color ambient diffuse phong phong_size", "a material")
    return {"color": at["color"], "ambient": at["ambient"], "diffuse": at["diffuse"], "phong": at.get("phong", 0),
            "phong_size": at.get("phong_size", 1)}


def read_scene(path: Path, maps: dict[str, Map]) -> Json:
    s = yaml.safe_load(path.read_text(encoding="utf-8"))
    only(s, "camera image render lights materials objects", path.name)
    bumped = [o for o in s["objects"].values() if "bump" in o]
    plain = [o for o in s["objects"].values() if "bump" not in o]
    if len(bumped) != 1 or len(plain) != 1:
        raise SceneError(f"{path.name}: the page takes one bumped object and a plain one")
    light = only(one(s["lights"], "lights"), "at color", "the light")
    only(s["camera"], "from at fov", "camera")
    return {"camera": s["camera"], "size": s["image"]["size"], "background": s["image"]["background"], "light": light,
            "materials": [read_material(s["materials"][o["material"]]) for o in (bumped[0], plain[0])],
            "ground": read_ground(bumped[0], path.parent, maps), "caster": read_caster(plain[0])}
