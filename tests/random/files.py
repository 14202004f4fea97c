"""The files of random scenes: height maps, a picture, a model, a list of copies."""

from __future__ import annotations

import io
import tempfile
from pathlib import Path
from random import Random

import numpy as np
from PIL import Image


def numbers(r: Random) -> np.random.Generator:
    return np.random.default_rng(r.getrandbits(32))


def png(values: np.ndarray) -> bytes:
    out = io.BytesIO()
    Image.fromarray(values).save(out, "PNG")
    return out.getvalue()


def pixels(data: bytes) -> np.ndarray:
    """Of a PNG."""
    with Image.open(io.BytesIO(data)) as image:
        return np.array(image)


def exr(values: np.ndarray) -> bytes:
    import OpenEXR

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.exr"
        OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage},
                     {"Y": np.ascontiguousarray(values, np.float32)}).write(str(path))
        return path.read_bytes()


def exr_values(data: bytes) -> np.ndarray:
    import OpenEXR

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.exr"
        path.write_bytes(data)
        with OpenEXR.File(str(path), separate_channels=True) as file:
            return file.channels()["Y"].pixels.copy()


def heights(r: Random, name: str) -> bytes:
    """Slow hills from 0 to 1, as 8 or 16 bits or as floats."""
    rows, columns = r.randint(5, 14), r.randint(5, 14)
    y, x = np.mgrid[0:rows, 0:columns]
    hills = 0.5 + 0.3 * np.sin(2 * np.pi * x / columns + 1) * np.cos(2 * np.pi * y / rows)
    hills += numbers(r).uniform(-0.15, 0.15, hills.shape)
    if name.endswith(".exr"):
        return exr(hills)
    if r.random() < 0.5:
        return png((hills * 255).astype(np.uint8))
    return png((hills * 65535).astype(np.uint16))


def picture(r: Random) -> bytes:
    return png(numbers(r).integers(0, 256, (r.randint(3, 9), r.randint(3, 9), 3), np.uint8))


def model(r: Random) -> bytes:
    """An OBJ with texture coordinates: a dented ball, a piece of land, or a few loose triangles."""
    kind, g = r.choice(("ball", "land", "loose")), numbers(r)
    if kind == "loose":
        return loose(g)
    n, m = r.randint(4, 9), r.randint(4, 9)
    w, u = np.mgrid[0:1:(m + 1) * 1j, 0:1:(n + 1) * 1j]
    if kind == "land":
        points = np.stack([1.6 * u - 0.8, g.uniform(-0.2, 0.2, u.shape), 1.6 * w - 0.8], axis=-1)
    else:
        across = 0.02 + 0.96 * w  # not to the poles, where triangles would have no area
        size = 0.6 + 0.08 * np.cos(4 * np.pi * u) * np.sin(np.pi * w)
        points = size[..., None] * np.stack([np.cos(2 * np.pi * u) * np.sin(np.pi * across), np.cos(np.pi * across),
                                             -np.sin(2 * np.pi * u) * np.sin(np.pi * across)], axis=-1)
    lines = [f"v {x:.4f} {y:.4f} {z:.4f}" for x, y, z in points.reshape(-1, 3)]
    lines += [f"vt {a:.4f} {1 - b:.4f}" for a, b in zip(u.ravel(), w.ravel(), strict=True)]
    for j in range(m):
        for i in range(n):
            a, b = j * (n + 1) + i + 1, (j + 1) * (n + 1) + i + 1
            corners = (a, b, b + 1, a + 1)
            lines.append("f " + " ".join(f"{k}/{k}" for k in corners))
    return ("\n".join(lines) + "\n").encode()


def loose(g: np.random.Generator) -> bytes:
    lines = []
    for k in range(int(g.integers(1, 9))):
        middle = g.uniform(-0.6, 0.6, 3)
        lines += ["v {:.4f} {:.4f} {:.4f}".format(*(middle + g.uniform(-0.5, 0.5, 3))) for _ in range(3)]
        lines += [f"vt {a} {b}" for a, b in ((0, 0), (1, 0), (0, 1))]
        lines.append("f " + " ".join(f"{3 * k + c}/{3 * k + c}" for c in (1, 2, 3)))
    return ("\n".join(lines) + "\n").encode()


def list_of_copies(r: Random, materials: list[str]) -> bytes:
    lines = ["x,y,z,scale,rx,ry,rz,material"]
    for _ in range(r.choice((1, 7, 25))):
        place = [round(r.uniform(-2, 2), 3), round(r.uniform(-0.6, 1.2), 3), round(r.uniform(-2, 2), 3)]
        turns = [round(r.uniform(-180, 180), 2) for _ in range(3)]
        lines.append(",".join(map(str, [*place, round(r.uniform(0.3, 0.9), 3), *turns, r.choice(["", *materials])])))
    return ("\n".join(lines) + "\n").encode()
