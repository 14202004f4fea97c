"""Maps, meshes and scenes, made once for each size and kept in the output's folder.

A file appears whole: it is written under another name, then renamed.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

CAMERA = "camera: {from: [0.2, 4.3, -5.6], at: [0.65, 0.42, 0.15], fov: 37}"
LAMP = "lights:\n  lamp: {at: [-4.4, 5.8, -2.6], color: [1.1, 1.08, 1]}"
CLAY = "materials:\n  clay: {color: [0.82, 0.72, 0.58], ambient: 0.12, diffuse: 0.8}"

SMALL_SCENE = f"""\
{CAMERA}
image: {{size: [64, 64]}}
{LAMP}
{CLAY}
objects:
  ground:
    plane: {{origin: [-6, 0, -6], u: [0, 0, 1], w: [1, 0, 0]}}
    material: clay
  ball:
    sphere: {{center: [0, 1, 0], radius: 0.6}}
    material: clay
"""

MAP_SCENE = f"""\
{CAMERA}
image: {{size: [640, 360]}}
render: {{shadow: 0}}
{LAMP}
{CLAY}
objects:
  ground:
    plane: {{origin: [-6, 0, -6], u: [0, 0, 1], w: [1, 0, 0]}}
    material: clay
    bump: {{map: {{file: FILE}}, size: [12, 12], scale: 0.22, zero: 0.5, sign: up}}
"""

# Camera, light and size are those of bench/limits/embree_mesh.c.
MESH_SCENE = """\
camera: {from: [0, 1.2, -3.2], at: [0, 0, 0], fov: 40}
image: {size: [640, 360]}
render: {shadow: none}
lights:
  lamp: {at: [-4, 5, -4], color: [1, 1, 1]}
materials:
  clay: {color: [0.9, 0.9, 0.9], ambient: 0.1, diffuse: 0.9}
objects:
  ball:
    mesh: {file: FILE}
    material: clay
"""

# Of figure 5's scene, without bumps. Tachyon's zoom of 1 shows half a unit up at a distance of 1.
TACHYON_SCENE = """\
BEGIN_SCENE
RESOLUTION 640 360
CAMERA
ZOOM 2.657
ASPECTRATIO 1
ANTIALIASING 0
RAYDEPTH 1
CENTER 0.2 4.3 -5.6
VIEWDIR 0.45 -3.88 5.75
UPDIR 0 1 0
END_CAMERA
BACKGROUND 0.03 0.04 0.06
LIGHT CENTER -4.4 5.8 -2.6 RAD 0.01 COLOR 1.1 1.08 1
PLANE CENTER 0 0 0 NORMAL 0 1 0
TEXTURE AMBIENT 0.12 DIFFUSE 0.8 SPECULAR 0 OPACITY 1 COLOR 0.82 0.72 0.58 TEXFUNC 0
BOX MIN -0.6 0.55 -0.6 MAX 0.6 1.75 0.6
TEXTURE AMBIENT 0.2 DIFFUSE 0.7 SPECULAR 0 OPACITY 1 COLOR 0.15 0.3 0.6 TEXFUNC 0
END_SCENE
"""


def made(path: Path, write: Callable[[Path], None]) -> Path:
    """The file, which `write` makes where it is not there yet."""
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        aside = path.with_name(f"new-{path.name}")
        write(aside)
        aside.replace(path)
    return path


def write_text(path: Path, text: str) -> None:
    path.write_text(text)


def text_file(path: Path, text: str) -> Path:
    """A small file, written anew where its text has changed."""
    if path.exists() and path.read_text() != text:
        path.unlink()
    return made(path, lambda to: write_text(to, text))


# Maps ---------------------------------------------------------------------------------------------


def heights(size: int) -> np.ndarray:
    """Hills with detail down to the samples, which repeat; from 0 to 1. As hard to compress as measured heights."""
    x = np.arange(size, dtype=np.float32) * np.float32(2 * np.pi / size)
    sums = np.full((size, size), 0.5, np.float32)
    for waves, strength in ((3, 0.2), (7, 0.1), (19, 0.05), (53, 0.02)):
        sums += np.float32(strength) * np.sin(waves * x)[:, None] * np.cos((waves + 1) * x)[None, :]
    sums += np.random.default_rng(1990).random((size, size), np.float32) * np.float32(0.004)
    return np.clip(sums, 0, 1, out=sums)


def write_png(path: Path, size: int) -> None:
    from PIL import Image

    Image.fromarray((heights(size) * 65535).astype(np.uint16)).save(path, "PNG")


def write_exr(path: Path, size: int) -> None:
    import OpenEXR

    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"Y": heights(size)}).write(str(path))


def map_scene(folder: Path, size: int, ending: str) -> Path:
    """The scene with a map of size x size samples; `ending` is png or exr."""
    found = folder / f"map{size}.{ending}"
    made(found, lambda to: (write_png if ending == "png" else write_exr)(to, size))
    return text_file(folder / f"map{size}-{ending}.yaml", MAP_SCENE.replace("FILE", found.name))


# Meshes -------------------------------------------------------------------------------------------


def write_ply(path: Path, columns: int, rows: int) -> None:
    """A bumpy sphere of columns x rows quads, each of two triangles, as binary PLY."""
    u, w = np.linspace(0, 2 * np.pi, columns, endpoint=False), np.linspace(0, np.pi, rows + 1)
    radius = 1 + 0.05 * np.sin(9 * u)[None, :] * np.sin(9 * w)[:, None]
    ring = radius * np.sin(w)[:, None]
    points = np.stack([ring * np.cos(u), radius * np.cos(w)[:, None] + 0 * ring, ring * np.sin(u)], axis=-1)
    corner = np.arange(rows * columns, dtype=np.int32).reshape(rows, columns)
    right = np.roll(corner, -1, axis=1)
    below, across = corner + columns, right + columns
    triangles = np.stack([corner, right, below, right, across, below], axis=-1).reshape(-1, 3)
    faces = np.empty(len(triangles), dtype=[("count", "u1"), ("index", "<i4", 3)])
    faces["count"], faces["index"] = 3, triangles
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {points[..., 0].size}\n"
            "property float x\nproperty float y\nproperty float z\n"
            f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    path.write_bytes(head.encode() + points.astype("<f4").tobytes() + faces.tobytes())


def mesh(folder: Path, quads: tuple[int, int]) -> Path:
    path = folder / f"ball{quads[0]}x{quads[1]}.ply"
    return made(path, lambda to: write_ply(to, *quads))


def mesh_scene(folder: Path, quads: tuple[int, int]) -> Path:
    found = mesh(folder, quads)
    return text_file(folder / f"{found.stem}.yaml", MESH_SCENE.replace("FILE", found.name))


# Objects ------------------------------------------------------------------------------------------

MOST_LISTED = 1000
OBJECTS_HEAD = f"""\
camera: {{from: [0, 9, -9], at: [0, 0, 0], fov: 40}}
image: {{size: [640, 360]}}
render: {{shadow: none}}
{LAMP}
{CLAY}
objects:
"""


def spheres(count: int) -> np.ndarray:
    """x, y, z and radius of spheres in a layer that fills the picture; the more there are, the smaller they are."""
    random = np.random.default_rng(1990)
    places = random.random((count, 3)) * (16, 1, 12) - (8, 0.5, 6)
    return np.column_stack([places, np.full(count, 9 / count**0.5)])


def listed(count: int) -> str:
    """Each as an object of its own."""
    lines = [f"  s{k}: {{sphere: {{center: [{x:.5f}, {y:.5f}, {z:.5f}], radius: {radius:.5f}}}, material: clay}}\n"
             for k, (x, y, z, radius) in enumerate(spheres(count))]
    return OBJECTS_HEAD + "".join(lines)


def write_csv(path: Path, count: int) -> None:
    np.savetxt(path, spheres(count), fmt="%.6f", delimiter=",", header="x,y,z,scale", comments="")


COPIES = """\
  one: {sphere: {center: [0, 0, 0], radius: 1}, material: clay, hidden: true}
  all: {copies: {of: one, file: FILE}}
"""


def objects_scene(folder: Path, count: int, written_out: bool) -> Path:
    """Spheres, each an object, or a list of copies."""
    path = folder / f"{'spheres' if written_out else 'copies'}{count}.yaml"
    if written_out:
        return text_file(path, listed(count))
    places = made(folder / f"spheres{count}.csv", lambda to: write_csv(to, count))
    return text_file(path, OBJECTS_HEAD + COPIES.replace("FILE", places.name))
