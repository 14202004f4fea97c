"""Models for the tests, and the files that they come in. Right-handed and y up, v upward, as files have them; corners
counterclockwise."""

from __future__ import annotations

import base64
import json
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass
class Model:
    at: np.ndarray  # n x 3
    normal: np.ndarray  # n x 3
    uv: np.ndarray  # n x 2
    face: np.ndarray  # m x 3


def ball(around: int, down: int) -> Model:
    """A sphere with u around it and v upward, seen from outside u to the right."""
    i, j = np.meshgrid(np.arange(around + 1), np.arange(down + 1))
    turn, slant = 2 * np.pi * i.ravel() / around, np.pi * j.ravel() / down
    # the seam, and the poles, are at the same place to the last digit
    turn[i.ravel() == around] = 0
    ring = np.where((j.ravel() == 0) | (j.ravel() == down), 0, np.sin(slant))
    at = np.stack([ring * np.sin(turn), np.cos(slant), ring * np.cos(turn)], axis=1)
    uv = np.stack([i.ravel() / around, 1 - j.ravel() / down], axis=1)
    a = (np.arange(around)[None, :] + (around + 1) * np.arange(down)[:, None]).ravel()
    b, c, d = a + 1, a + around + 1, a + around + 2
    first, second = np.stack([a, c, b], axis=1)[around:], np.stack([b, c, d], axis=1)[:-around]
    return Model(at, at.copy(), uv, np.concatenate([first, second]))


def grid(n: int) -> Model:
    """2 x 2 units of the plane y = 0, n x n cells."""
    i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1))
    x, z = 2 * i.ravel() / n - 1, 2 * j.ravel() / n - 1
    at = np.stack([x, 0 * x, z], axis=1)
    a = (np.arange(n)[None, :] + (n + 1) * np.arange(n)[:, None]).ravel()
    b, c, d = a + 1, a + n + 1, a + n + 2
    face = np.concatenate([np.stack([a, c, b], axis=1), np.stack([b, c, d], axis=1)])
    return Model(at, np.tile([0.0, 1.0, 0.0], (len(at), 1)), np.stack([(x + 1) / 2, (1 - z) / 2], axis=1), face)


def rows(form: str, values: np.ndarray) -> str:
    return "".join(form % tuple(row) for row in values)


def obj(path: Path, m: Model, *, normals: bool = True, texture: bool = True) -> None:
    text = rows("v %.9g %.9g %.9g\n", m.at)
    text += rows("vt %.9g %.9g\n", m.uv) if texture else ""
    text += rows("vn %.9g %.9g %.9g\n", m.normal) if normals else ""
    corner = "%d/" + ("%d" if texture else "") + ("/%d" if normals else "")
    each = 1 + texture + normals
    path.write_text(text + rows("f " + " ".join([corner] * 3) + "\n", np.repeat(m.face + 1, each, axis=1)))


def ply(path: Path, m: Model, *, binary: bool) -> None:
    names = ["x", "y", "z", "nx", "ny", "nz", "s", "t"]
    head = ["ply", f"format {'binary_little_endian' if binary else 'ascii'} 1.0", f"element vertex {len(m.at)}"]
    head += [f"property float {name}" for name in names]
    head += [f"element face {len(m.face)}", "property list uchar int vertex_indices", "end_header", ""]
    vertices = np.concatenate([m.at, m.normal, m.uv], axis=1)
    if binary:
        faces = np.zeros(len(m.face), dtype=[("n", "u1"), ("k", "<i4", 3)])
        faces["n"], faces["k"] = 3, m.face
        path.write_bytes("\n".join(head).encode() + vertices.astype("<f4").tobytes() + faces.tobytes())
    else:
        path.write_text("\n".join(head) + rows(" ".join(["%.9g"] * 8) + "\n", vertices) + rows("3 %d %d %d\n", m.face))


def stl(path: Path, m: Model, *, binary: bool) -> None:
    p = m.at[m.face].astype("<f4")
    n = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    if binary:
        facets = np.zeros(len(p), dtype=[("n", "<f4", 3), ("p", "<f4", (3, 3)), ("attributes", "<u2")])
        facets["n"], facets["p"] = n, p
        path.write_bytes(bytes(80) + struct.pack("<I", len(p)) + facets.tobytes())
    else:
        form = "facet normal %.9g %.9g %.9g\nouter loop\n" + "vertex %.9g %.9g %.9g\n" * 3 + "endloop\nendfacet\n"
        path.write_text("solid it\n" + rows(form, np.concatenate([n, p.reshape(-1, 9)], axis=1)) + "endsolid it\n")


def off(path: Path, m: Model) -> None:
    path.write_text(f"OFF\n{len(m.at)} {len(m.face)} 0\n" + rows("%.9g %.9g %.9g\n",
                                                                 m.at) + rows("3 %d %d %d\n", m.face))


def gltf(path: Path, m: Model, matrix: list[float] | None = None, buffer: str = "") -> None:
    """glTF, with its numbers in a file beside it where that has a name, or, by the name, GLB; v goes down in these."""
    arrays = [m.at.astype("<f4"), m.normal.astype("<f4"), (m.uv * (1, -1) + (0, 1)).astype("<f4"),
              m.face.astype("<u4").ravel()]
    kinds = [("VEC3", 5126), ("VEC3", 5126), ("VEC2", 5126), ("SCALAR", 5125)]
    blob, views, accessors = b"", [], []
    for k, (array, (kind, component)) in enumerate(zip(arrays, kinds, strict=True)):
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": array.nbytes})
        accessors.append({"bufferView": k, "componentType": component, "count": len(array), "type": kind})
        blob += array.tobytes()
    accessors[0] |= {"min": arrays[0].min(axis=0).tolist(), "max": arrays[0].max(axis=0).tolist()}
    binary = path.suffix == ".glb"
    numbers: dict[str, object] = {"byteLength": len(blob)}
    if buffer:
        numbers["uri"] = buffer
        (path.parent / buffer).write_bytes(blob)
    elif not binary:
        numbers["uri"] = "data:application/octet-stream;base64," + base64.b64encode(blob).decode()
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0} | ({"matrix": matrix} if matrix else {})],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3}]}],
        "buffers": [numbers], "bufferViews": views, "accessors": accessors,
    }
    text = json.dumps(document).encode()
    if not binary:
        path.write_bytes(text)
        return
    text += b" " * (-len(text) % 4)
    blob += b"\0" * (-len(blob) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


def write_all(folder: Path, m: Model) -> list[Path]:
    """The same model in every format."""
    names = ["a.obj", "a.ply", "b.ply", "a.stl", "b.stl", "a.gltf", "a.glb", "a.off"]
    paths = [folder / name for name in names]
    obj(paths[0], m)
    ply(paths[1], m, binary=False)
    ply(paths[2], m, binary=True)
    stl(paths[3], m, binary=False)
    stl(paths[4], m, binary=True)
    gltf(paths[5], m)
    gltf(paths[6], m)
    off(paths[7], m)
    return paths
