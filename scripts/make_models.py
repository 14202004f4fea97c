"""Make the models in scenes/models: each as a program such as Blender exports it, for `kage import`.

    scripts/venv python scripts/make_models.py [-o scenes/models]

    corner.glb       a corner of a room: camera, lamp, PNG and JPEG inside the file, a normal map, metal
    still-life.obj   things on a table: .mtl with images, glass, a mirror, two materials on one object
    garden.gltf      nodes in nodes, one tree many times, mirrored and stretched, a sun and a spotlight, .bin
    tower.dae        COLLADA with z up, camera, lamp, image
    sand-8.png       heights of a dune with 8 bits, for --bump; sand-16.png: the same with 16

The script is the models' source: they carry the licence of kage.
"""

from __future__ import annotations

import argparse
import io
import json
import math
import struct
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from PIL import Image

TOP = Path(__file__).resolve().parent.parent


# Shapes: right-handed, y up; the texture's u to the right and v down as seen from outside ---------------


@dataclass
class Mesh:
    at: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    normal: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    uv: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    face: np.ndarray = field(default_factory=lambda: np.zeros((0, 3), int))

    def __add__(self, other: Mesh) -> Mesh:
        return Mesh(
            np.vstack([self.at, other.at]),
            np.vstack([self.normal, other.normal]),
            np.vstack([self.uv, other.uv]),
            np.vstack([self.face, other.face + len(self.at)]),
        )


def grid(at: np.ndarray, normal: np.ndarray, uv: np.ndarray) -> Mesh:
    """Of rows x columns x 3 places, rows downward and columns to the right."""
    rows, columns = at.shape[:2]
    k = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = (x.ravel() for x in (k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]))
    face = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    flat = at.reshape(-1, 3)
    face = face[[len(np.unique(flat[f], axis=0)) == 3 for f in face]]  # without those at a tip
    return Mesh(flat, normal.reshape(-1, 3), uv.reshape(-1, 2), face)


def quad(corner: list[float], right: list[float], down: list[float], repeat: float = 1) -> Mesh:
    c, r, d = np.array(corner, float), np.array(right, float), np.array(down, float)
    at = np.array([[c, c + r], [c + d, c + d + r]])
    n = np.cross(d, r)
    return grid(
        at, np.broadcast_to(n / np.linalg.norm(n), at.shape), np.array([[[0, 0], [1, 0]], [[0, 1], [1, 1]]]) * repeat
    )


def box(low: list[float], high: list[float]) -> Mesh:
    (a, b, c), (x, y, z) = low, high
    w, h, d = x - a, y - b, z - c
    return (
        quad([a, y, z], [w, 0, 0], [0, -h, 0])
        + quad([x, y, c], [-w, 0, 0], [0, -h, 0])
        + quad([a, y, c], [0, 0, d], [0, -h, 0])
        + quad([x, y, z], [0, 0, -d], [0, -h, 0])
        + quad([a, y, c], [w, 0, 0], [0, 0, d])
        + quad([a, b, z], [w, 0, 0], [0, 0, -d])
    )


def turned(profile: list[tuple[float, float]], around: int = 32) -> Mesh:
    """A profile of (radius, y) from the top down, turned about the y axis."""
    p = np.array(profile, float)
    a = np.linspace(0, 2 * math.pi, around + 1)
    slope = np.gradient(p, axis=0)
    out = np.column_stack([-slope[:, 1], slope[:, 0]])
    out /= np.linalg.norm(out, axis=1, keepdims=True)

    def ring(q: np.ndarray) -> np.ndarray:
        return np.stack([q[:, :1] * np.sin(a), np.repeat(q[:, 1:], len(a), 1), q[:, :1] * np.cos(a)], axis=-1)

    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))])
    uv = np.stack(np.meshgrid(a / (2 * math.pi), along / along[-1]), axis=-1)
    return grid(ring(p), ring(out), uv)


def ball(radius: float, y: float, around: int = 32) -> Mesh:
    w = np.linspace(0, math.pi, around // 2 + 1)
    return turned([(radius * abs(math.sin(x)), y + radius * math.cos(x)) for x in w], around)


def moved(m: Mesh, by: list[float]) -> Mesh:
    return Mesh(m.at + np.array(by, float), m.normal, m.uv, m.face)


# Images ---------------------------------------------------------------------------------------------


def noise(n: int, cells: int, seed: int) -> np.ndarray:
    """Smooth, periodic, 0..1."""
    r = np.random.default_rng(seed).random((cells, cells))
    x = np.arange(n) / n * cells
    i, f = x.astype(int), x % 1
    f = f * f * (3 - 2 * f)
    rows = r[i] * (1 - f)[:, None] + r[(i + 1) % cells] * f[:, None]
    return np.asarray(rows[:, i] * (1 - f) + rows[:, (i + 1) % cells] * f)


def planks(n: int = 128) -> Image.Image:
    y, x = np.mgrid[0:n, 0:n] / n
    tone = 0.72 + 0.1 * np.sin(40 * (y + 0.05 * noise(n, 4, 1))) + 0.12 * noise(n, 8, 2)
    tone *= np.where((x * 4) % 1 < 0.04, 0.5, 1) * (0.9 + 0.1 * np.floor(x * 4) % 2)
    return Image.fromarray((np.clip(tone[..., None] * [0.85, 0.62, 0.4], 0, 1) * 255).astype(np.uint8))


def tiles(n: int = 128) -> Image.Image:
    y, x = np.mgrid[0:n, 0:n] * 2 / n
    joint = (x % 1 < 0.06) | (y % 1 < 0.06)
    light = (np.floor(x) + np.floor(y)) % 2 == 0
    tone = np.where(joint, 0.35, np.where(light, 0.85, 0.55)) + 0.06 * noise(n, 16, 3)
    return Image.fromarray((np.clip(tone[..., None] * [1, 0.96, 0.9], 0, 1) * 255).astype(np.uint8))


def quarters(n: int = 64) -> Image.Image:
    """Red, green; blue, yellow: whether an image is the right way up."""
    m = np.zeros((n, n, 3), np.uint8)
    h = n // 2
    m[:h, :h], m[:h, h:], m[h:, :h], m[h:, h:] = (220, 30, 30), (30, 180, 40), (40, 60, 220), (230, 210, 40)
    return Image.fromarray(m)


def leaves(n: int = 32) -> Image.Image:
    tone = 0.5 + 0.5 * noise(n, 8, 4)
    return Image.fromarray((tone[..., None] * [160, 220, 110]).astype(np.uint8))


def dune(n: int) -> np.ndarray:
    """Heights from 0 to 1 of long low waves, which tile."""
    y, x = np.mgrid[0:n, 0:n] / n * 2 * math.pi
    bent = x + 0.6 * np.sin(y)
    return np.asarray(0.5 + 0.35 * np.sin(bent) + 0.15 * np.sin(2 * y - x + 1))


def normal_map(n: int = 64) -> Image.Image:
    h = 0.1 * n * noise(n, 8, 5)
    gx, gy = (np.roll(h, -1, 1) - np.roll(h, 1, 1)) / 2, (np.roll(h, -1, 0) - np.roll(h, 1, 0)) / 2
    v = np.stack([-gx, gy, np.ones_like(h)], axis=-1)
    v /= np.linalg.norm(v, axis=-1, keepdims=True)
    return Image.fromarray(np.round((v / 2 + 0.5) * 255).astype(np.uint8))


def packed(image: Image.Image, kind: str) -> bytes:
    to = io.BytesIO()
    image.save(to, kind, **({"quality": 92} if kind == "JPEG" else {"optimize": True}))
    return to.getvalue()


# glTF -----------------------------------------------------------------------------------------------


class Gltf:
    def __init__(self) -> None:
        self.top: dict[str, list[object]] = {}
        self.bytes = b""

    def add(self, kind: str, thing: object) -> int:
        self.top.setdefault(kind, []).append(thing)
        return len(self.top[kind]) - 1

    def view(self, data: bytes, **more: int) -> int:
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        k = self.add("bufferViews", {"buffer": 0, "byteLength": len(data), "byteOffset": len(self.bytes)} | more)
        self.bytes += data
        return k

    def array(self, values: np.ndarray, kind: str) -> int:
        index = kind == "SCALAR"
        about: dict[str, object] = {
            "bufferView": self.view(
                values.astype("<u2" if index else "<f4").tobytes(), target=34963 if index else 34962
            ),
            "componentType": 5123 if index else 5126,
            "count": len(values),
            "type": kind,
        }
        if kind == "VEC3":
            low, high = values.astype("f4").min(0), values.astype("f4").max(0)
            about |= {"max": [float(x) for x in high], "min": [float(x) for x in low]}
        return self.add("accessors", about)

    def mesh(self, name: str, *pairs: tuple[Mesh, int]) -> int:
        return self.add(
            "meshes",
            {
                "name": name,
                "primitives": [
                    {
                        "attributes": {
                            "POSITION": self.array(m.at, "VEC3"),
                            "NORMAL": self.array(m.normal, "VEC3"),
                            "TEXCOORD_0": self.array(m.uv, "VEC2"),
                        },
                        "indices": self.array(m.face.ravel(), "SCALAR"),
                        "material": material,
                    }
                    for m, material in pairs
                ],
            },
        )

    def image(self, name: str, data: bytes, mime: str) -> int:
        source = self.add("images", {"bufferView": self.view(data), "mimeType": mime, "name": name})
        return self.add("textures", {"sampler": 0, "source": source})

    def material(
        self,
        name: str,
        metallic: float = 0,
        roughness: float = 0.5,
        color: list[float] | None = None,
        image: dict[str, object] | None = None,
        **more: object,
    ) -> int:
        pbr: dict[str, object] = {"metallicFactor": metallic, "roughnessFactor": roughness}
        pbr |= {"baseColorFactor": color} if color else {}
        pbr |= {"baseColorTexture": image} if image else {}
        return self.add("materials", {"doubleSided": True, "name": name, "pbrMetallicRoughness": pbr} | more)

    def finish(self, roots: list[int], uri: str | None = None) -> str:
        self.top.setdefault("samplers", [{"magFilter": 9729, "minFilter": 9987}])
        head = {
            "asset": {"generator": "kage scripts/make_models.py, after Khronos glTF Blender I/O", "version": "2.0"},
            "extensionsUsed": ["KHR_lights_punctual", "KHR_texture_transform"],
            "scene": 0,
            "scenes": [{"name": "Scene", "nodes": roots}],
        }
        buffer = {"byteLength": len(self.bytes)} | ({"uri": uri} if uri else {})
        return json.dumps(head | self.top | {"buffers": [buffer]}, separators=(",", ":"))


def turn(axis: list[float], degrees: float) -> list[float]:
    a = np.array(axis, float) / np.linalg.norm(axis) * math.sin(math.radians(degrees) / 2)
    return [*map(float, a), math.cos(math.radians(degrees) / 2)]


def look(eye: list[float], to: list[float]) -> list[float]:
    """The rotation of a camera or lamp that looks along its own -z."""
    z = np.array(eye, float) - np.array(to, float)
    z /= np.linalg.norm(z)
    x = np.cross([0, 1, 0], z)
    x /= np.linalg.norm(x)
    m = np.column_stack([x, np.cross(z, x), z])
    w = math.sqrt(max(1 + m[0, 0] + m[1, 1] + m[2, 2], 0)) / 2
    return [
        float(m[2, 1] - m[1, 2]) / (4 * w),
        float(m[0, 2] - m[2, 0]) / (4 * w),
        float(m[1, 0] - m[0, 1]) / (4 * w),
        w,
    ]


def lamp(g: Gltf, name: str, about: dict[str, object], **node: object) -> int:
    lights = g.top.setdefault("extensions_lights", [])
    lights.append({"name": name} | about)
    return g.add("nodes", {"extensions": {"KHR_lights_punctual": {"light": len(lights) - 1}}, "name": name} | node)


def with_lights(g: Gltf) -> None:
    lights = {"KHR_lights_punctual": {"lights": g.top.pop("extensions_lights")}}
    g.top["extensions"] = lights  # type: ignore[assignment]


def camera(g: Gltf, eye: list[float], to: list[float], yfov: float, aspect: float) -> int:
    k = g.add(
        "cameras",
        {
            "name": "Camera",
            "perspective": {"aspectRatio": aspect, "yfov": math.radians(yfov), "zfar": 100, "znear": 0.1},
            "type": "perspective",
        },
    )
    return g.add("nodes", {"camera": k, "name": "Camera", "rotation": look(eye, to), "translation": eye})


def corner(folder: Path) -> None:
    g = Gltf()
    floor = g.material(
        "Floor tiles",
        image={"index": g.image("tiles", packed(tiles(), "PNG"), "image/png")},
        normalTexture={"index": g.image("tiles normal", packed(normal_map(), "PNG"), "image/png")},
    )
    wall = g.material("Plaster", 0, 0.9, [0.75, 0.7, 0.62, 1])
    wood = g.material("Wood", 0, 0.6, image={"index": g.image("planks", packed(planks(), "JPEG"), "image/jpeg")})
    picture = g.material(
        "Picture", 0, 0.8, image={"index": g.image("quarters", packed(quarters(), "PNG"), "image/png")}
    )
    brass = g.material("Brass", 1, 0.15, [0.9, 0.7, 0.3, 1])
    walls = quad([-2, 2.4, -2], [4, 0, 0], [0, -2.4, 0]) + quad([-2, 2.4, 2], [0, 0, -4], [0, -2.4, 0])
    things = [
        ("Floor", (quad([-2, 0, -2], [4, 0, 0], [0, 0, 4], 2), floor), {}),
        ("Walls", (walls, wall), {}),
        ("Picture", (quad([-0.6, 0.45, 0.02], [1.2, 0, 0], [0, -0.9, 0]), picture), {"translation": [0.3, 1.5, -2]}),
        (
            "Crate",
            (box([-0.4, 0, -0.4], [0.4, 0.8, 0.4]), wood),
            {"rotation": turn([0, 1, 0], 25), "translation": [-0.9, 0, -0.9]},
        ),
        ("Ball", (ball(0.35, 0.35), brass), {"translation": [0.55, 0, -0.2]}),
    ]
    roots = [g.add("nodes", {"mesh": g.mesh(name, pair), "name": name} | node) for name, pair, node in things]
    roots.append(camera(g, [2.6, 1.9, 3.4], [-0.1, 0.8, -0.6], 32, 4 / 3))
    roots.append(
        lamp(
            g,
            "Lamp",
            {"color": [1, 0.95, 0.85], "intensity": 5435.1, "type": "point"},
            translation=[1.4, 2.2, 0.9],
            extras={"export_gltf": 1},
        )
    )
    with_lights(g)
    text = g.finish(roots).encode()
    text += b" " * (-len(text) % 4)
    data = g.bytes + b"\0" * (-len(g.bytes) % 4)
    (folder / "corner.glb").write_bytes(
        struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(data))
        + struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", len(data), b"BIN\0")
        + data
    )


def garden(folder: Path) -> None:
    g = Gltf()
    (folder / "garden leaves.png").write_bytes(packed(leaves(), "PNG"))
    g.add("images", {"mimeType": "image/png", "name": "garden leaves", "uri": "garden%20leaves.png"})
    g.add("textures", {"sampler": 0, "source": 0})
    ground = g.material(
        "Lawn",
        0,
        1,
        [0.6, 0.75, 0.4, 1],
        image={"index": 0, "extensions": {"KHR_texture_transform": {"scale": [6, 6], "offset": [0.25, 0.5]}}},
    )
    leaf = g.material("Leaves", 0, 0.8, [1, 0.55, 0.35, 1], image={"index": 0})
    bark = g.material("Bark", 0, 1, [0.3, 0.2, 0.12, 1])
    tree = g.mesh(
        "Tree",
        (turned([(0.1, 0.5), (0.12, 0.25), (0.16, 0)], 12), bark),
        (turned([(0, 1.8), (0.3, 1.2), (0.5, 0.6), (0.4, 0.5), (0, 0.5)], 16), leaf),
    )
    lawn = g.add("nodes", {"mesh": g.mesh("Lawn", (quad([-4, 0, -4], [8, 0, 0], [0, 0, 8]), ground)), "name": "Lawn"})
    places: list[dict[str, object]] = [
        {"translation": [0, 0, 0]},
        {"translation": [1.6, 0, 0.4], "rotation": turn([0, 1, 0], 70), "scale": [1.2] * 3},
        {"translation": [-1.4, 0, 0.8], "rotation": turn([0.1, 1, 0.2], 200), "scale": [0.7] * 3},
        {"translation": [0.6, 0, -1.5], "scale": [-1, 1, 1]},
        {"translation": [-1.2, 0, -1.3], "scale": [1, 1.6, 0.8]},
    ]
    trees = [
        g.add("nodes", {"mesh": tree, "name": f"Tree.{k:03}" if k else "Tree"} | at) for k, at in enumerate(places)
    ]
    group = g.add(
        "nodes", {"children": trees, "name": "Trees", "rotation": turn([0, 1, 0], 15), "translation": [0, 0, -0.3]}
    )
    eye = [2.5, 2.6, 5.6]
    spot = {"innerConeAngle": 0.25, "outerConeAngle": 0.4}
    roots = [
        lawn,
        group,
        camera(g, eye, [0, 0.7, -0.3], 34, 16 / 9),
        lamp(
            g,
            "Sun",
            {"color": [1, 0.97, 0.9], "intensity": 683 * 3.0, "type": "directional"},
            rotation=look([-3, 5, 4], [0, 0, 0]),
        ),
        lamp(
            g,
            "Spot",
            {"color": [0.6, 0.7, 1], "intensity": 2e5, "spot": spot, "type": "spot"},
            rotation=look([4, 4, 1], [0.6, 0, 0.2]),
            translation=[4, 4, 1],
        ),
    ]
    with_lights(g)
    (folder / "garden.gltf").write_text(g.finish(roots, "garden.bin") + "\n")
    (folder / "garden.bin").write_bytes(g.bytes)


# OBJ ------------------------------------------------------------------------------------------------

MATERIALS = """# Made by scripts/make_models.py, after Blender's MTL File
newmtl Wood
Ns 60.0
Ka 1.0 1.0 1.0
Kd 0.8 0.8 0.8
Ks 0.1 0.1 0.1
Ni 1.45
d 1.0
illum 2
map_Kd still-life-planks.jpg

newmtl Card
Ns 10.0
Kd 1.0 1.0 1.0
Ks 0.0 0.0 0.0
d 1.0
illum 1
map_Kd still-life-quarters.png

newmtl Clay
Ns 20.0
Kd 0.7 0.35 0.2
Ks 0.05 0.05 0.05
d 1.0
illum 2

newmtl Glaze
Ns 400.0
Kd 0.1 0.25 0.5
Ks 0.6 0.6 0.6
d 1.0
illum 2

newmtl Glass
Ns 900.0
Kd 0.8 0.9 0.85
Ks 0.5 0.5 0.5
Ni 1.5
d 0.3
illum 4

newmtl Chrome
Ns 900.0
Kd 0.1 0.1 0.1
Ks 0.8 0.8 0.8
d 1.0
illum 3
"""


def still_life(folder: Path) -> None:
    vase = [(0.16, 1.0), (0.12, 0.85), (0.3, 0.5), (0.26, 0.2), (0.16, 0.0)]
    parts: list[tuple[str, list[tuple[str, Mesh]]]] = [
        ("Table", [("Wood", quad([-1.5, 0, -1.2], [3, 0, 0], [0, 0, 2.4]))]),
        ("Card", [("Card", quad([-1.1, 0.7, -0.75], [0.9, 0, 0.2], [0, -0.7, 0]))]),
        (
            "Vase",
            [("Glaze", moved(turned(vase[:3]), [0.35, 0, -0.4])), ("Clay", moved(turned(vase[2:]), [0.35, 0, -0.4]))],
        ),
        ("Tumbler", [("Glass", moved(turned([(0.18, 0.5), (0.15, 0.01)], 24), [-0.15, 0, 0.35]))]),
        ("Ball", [("Chrome", moved(ball(0.22, 0.22, 48), [0.85, 0, 0.3]))]),
    ]
    lines, first = ["# Made by scripts/make_models.py, after Blender's OBJ File", "mtllib still-life.mtl"], 1
    for name, pieces in parts:
        lines.append(f"o {name}")
        for material, m in pieces:
            lines += [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in m.at]
            lines += [f"vt {u:.6f} {1 - v:.6f}" for u, v in m.uv] + [
                f"vn {x:.4f} {y:.4f} {z:.4f}" for x, y, z in m.normal
            ]
            lines += ["s 1", f"usemtl {material}"]
            lines += ["f " + " ".join(f"{first + k}/{first + k}/{first + k}" for k in f) for f in m.face]
            first += len(m.at)
    (folder / "still-life.obj").write_text("\n".join(lines) + "\n")
    (folder / "still-life.mtl").write_text(MATERIALS)
    (folder / "still-life-planks.jpg").write_bytes(packed(planks(), "JPEG"))
    (folder / "still-life-quarters.png").write_bytes(packed(quarters(), "PNG"))


# COLLADA --------------------------------------------------------------------------------------------


def source(name: str, values: np.ndarray, axes: str) -> str:
    text = " ".join(f"{x:.6g}" for x in values.ravel())
    params = "".join(f'<param name="{a}" type="float"/>' for a in axes)
    return (
        f'<source id="{name}"><float_array id="{name}-array" count="{values.size}">{text}</float_array>'
        f'<technique_common><accessor source="#{name}-array" count="{len(values)}" stride="{len(axes)}">'
        f"{params}</accessor>"
        "</technique_common></source>\n"
    )


def geometry(name: str, m: Mesh, material: str) -> str:
    """With z up: (x, y, z) becomes (x, -z, y)."""
    up = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    faces = " ".join(f"{k}" for k in m.face.ravel())
    return (
        f'<geometry id="{name}-mesh" name="{name}"><mesh>'
        + source(f"{name}-at", m.at @ up, "XYZ")
        + source(f"{name}-normal", m.normal @ up, "XYZ")
        + source(f"{name}-uv", np.column_stack([m.uv[:, 0], 1 - m.uv[:, 1]]), "ST")
        + f'<vertices id="{name}-v"><input semantic="POSITION" source="#{name}-at"/></vertices>'
        f'<triangles material="{material}" count="{len(m.face)}">'
        f'<input semantic="VERTEX" source="#{name}-v" offset="0"/>'
        f'<input semantic="NORMAL" source="#{name}-normal" offset="0"/>'
        f'<input semantic="TEXCOORD" source="#{name}-uv" offset="0" set="0"/><p>{faces}</p>'
        "</triangles></mesh></geometry>\n"
    )


def matrix(m: np.ndarray) -> str:
    return '<matrix sid="transform">' + " ".join(f"{x:.6g}" for x in m.ravel()) + "</matrix>"


def looking(eye: list[float], to: list[float]) -> np.ndarray:
    """With z up: a node at `eye` whose -z looks to `to`."""
    z = np.array(eye, float) - np.array(to, float)
    z /= np.linalg.norm(z)
    x = np.cross([0, 0, 1], z)
    x /= np.linalg.norm(x)
    m = np.eye(4)
    m[:3, :3], m[:3, 3] = np.column_stack([x, np.cross(z, x), z]), eye
    return m


def effect(name: str, color: str) -> str:
    image = (
        f'<newparam sid="{name}-surface"><surface type="2D"><init_from>{name}-image</init_from></surface></newparam>'
        f'<newparam sid="{name}-sampler"><sampler2D><source>{name}-surface</source></sampler2D></newparam>'
    )
    return (
        f'<effect id="{name}-effect"><profile_COMMON>{image if "texture" in color else ""}<technique sid="common">'
        f"<lambert><diffuse>{color}</diffuse></lambert></technique></profile_COMMON></effect>\n"
    )


def tower(folder: Path) -> None:
    (folder / "tower-bricks.png").write_bytes(packed(tiles(64), "PNG"))
    meshes = [
        ("Tower", turned([(0.62, 1.9), (0.62, 1.6), (0.5, 1.55), (0.55, 0)], 32), "Bricks"),
        ("Sign", quad([-0.25, 1.35, 0.56], [0.5, 0, 0], [0, -0.5, 0]), "Bricks"),
        ("Ground", quad([-3, 0, -3], [6, 0, 0], [0, 0, 6]), "Sand"),
    ]
    nodes = "".join(
        f'<node id="{n}" name="{n}" type="NODE">{matrix(np.eye(4))}<instance_geometry url="#{n}-mesh">'
        f'<bind_material><technique_common><instance_material symbol="{k}" target="#{k}-material">'
        f'<bind_vertex_input semantic="UVMap" input_semantic="TEXCOORD" input_set="0"/></instance_material>'
        f"</technique_common></bind_material></instance_geometry></node>\n"
        for n, _, k in meshes
    )
    at = np.eye(4)
    at[:3, 3] = [2.5, -2.2, 3.2]
    nodes += f'<node id="Camera" name="Camera">{matrix(looking([2.2, -4.6, 2], [0, 0, 0.85]))}'
    nodes += '<instance_camera url="#Camera-camera"/></node>\n'
    nodes += f'<node id="Lamp" name="Lamp">{matrix(at)}<instance_light url="#Lamp-light"/></node>\n'
    texture = '<texture texture="Bricks-sampler" texcoord="UVMap"/>'
    (folder / "tower.dae").write_text(
        '<?xml version="1.0" encoding="utf-8"?>\n'
        '<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">\n'
        "<asset><contributor><authoring_tool>kage scripts/make_models.py, after Blender</authoring_tool></contributor>"
        '<unit name="meter" meter="1"/><up_axis>Z_UP</up_axis></asset>\n'
        '<library_cameras><camera id="Camera-camera" name="Camera"><optics><technique_common><perspective>'
        '<xfov sid="xfov">40</xfov><aspect_ratio>1.25</aspect_ratio><znear>0.1</znear><zfar>100</zfar></perspective>'
        "</technique_common></optics></camera></library_cameras>\n"
        '<library_lights><light id="Lamp-light" name="Lamp"><technique_common><point><color>300 300 280</color>'
        "<constant_attenuation>0</constant_attenuation><linear_attenuation>0</linear_attenuation>"
        "<quadratic_attenuation>1</quadratic_attenuation></point></technique_common></light></library_lights>\n"
        '<library_images><image id="Bricks-image" name="Bricks"><init_from>tower-bricks.png</init_from></image>'
        "</library_images>\n<library_effects>"
        + effect("Bricks", texture)
        + effect("Sand", "<color>0.7 0.6 0.4 1</color>")
        + "</library_effects>\n<library_materials>"
        + "".join(
            f'<material id="{k}-material" name="{k}"><instance_effect url="#{k}-effect"/></material>'
            for k in ("Bricks", "Sand")
        )
        + "</library_materials>\n<library_geometries>"
        + "".join(geometry(*m) for m in meshes)
        + '</library_geometries>\n<library_visual_scenes><visual_scene id="Scene" name="Scene">\n'
        + nodes
        + '</visual_scene></library_visual_scenes>\n<scene><instance_visual_scene url="#Scene"/></scene>\n</COLLADA>\n'
    )


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("-o", type=Path, default=TOP / "scenes/models", metavar="DIR", dest="folder")
    folder = p.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    for make in (corner, garden, still_life, tower):
        make(folder)
    heights = dune(256)
    Image.fromarray(np.round(heights * 255).astype(np.uint8)).save(folder / "sand-8.png", optimize=True)
    Image.fromarray(np.round(heights * 65535).astype(np.uint16)).save(folder / "sand-16.png", optimize=True)


if __name__ == "__main__":
    main()
