"""Mitsuba 3 traces the rays, kage's formulas move the origins of the shadow rays: figure 5 of the paper in somebody
else's renderer.

    pip install mitsuba pillow
    python mitsuba_shadows.py -o shadows.png

Three pictures side by side: bump mapping alone, where the cube's shadow ignores the bumps; the same with the shift; and
the true displacement, a mesh of two million triangles. The light and the colours are the same in all. The scene is that
of scenes/cube.yaml. What kage does is in the function `corrected`.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from kage import gbuffer
from kage.heights import HeightMap

mi.set_variant("scalar_rgb")

MAP = Path(__file__).resolve().parent.parent / "scenes" / "data" / "bumps.png"
EYE, AT, FOV = [0.2, 4.3, -5.6], [0.65, 0.42, 0.15], 37
LAMP, LIGHT = np.array([-4.4, 5.8, -2.6]), np.array([1.1, 1.08, 1])
COLORS = {"ground": np.array([0.82, 0.72, 0.58]), "cube": np.array([0.15, 0.3, 0.6])}
AMBIENT, DIFFUSE = {"ground": 0.12, "cube": 0.2}, {"ground": 0.8, "cube": 0.7}
BACKGROUND = np.array([0.03, 0.04, 0.06])
TILE = 12.0  # the side of the map in the scene, which repeats; one begins at x = z = -6
HALF = 12.0  # of the ground's side
LAYERS = "Q:position,uv:uv,n:sh_normal,Qu:dp_du,Qw:dp_dv,part:shape_index"
Picture = dict[str, Any]


def height_map() -> HeightMap:
    """The bumps over Mitsuba's uv, which go from 0 to 1 over the ground."""
    samples = np.asarray(Image.open(MAP), np.float64) / 65535
    side, begin = TILE / (2 * HALF), (HALF - TILE / 2) / (2 * HALF)
    return HeightMap(samples, (side, side), offset=(begin, begin), scale=0.22, zero=0.417)


# ---- Mitsuba ----


def cube() -> Any:
    place = mi.ScalarTransform4f().translate([0, 1.15, 0]).scale(0.6)
    return {"type": "cube", "to_world": place}


def ground() -> Any:
    """u along z and w along x, so that Qu x Qw points up."""
    place = mi.ScalarTransform4f([[0, HALF, 0, 0], [0, 0, 1, 0], [HALF, 0, 0, 0], [0, 0, 0, 1]])
    return {"type": "rectangle", "to_world": place}


def displaced(heights: HeightMap, n: int) -> Any:
    """The ground truly displaced, as a mesh of n x n places."""
    u, w = np.meshgrid(*2 * [np.linspace(0, 1, n)], indexing="ij")
    points = np.stack([(2 * w - 1) * HALF, np.asarray(heights(u, w)), (2 * u - 1) * HALF], -1)
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.concatenate([np.stack([corner, corner + n, corner + n + 1], -1),
                            np.stack([corner, corner + n + 1, corner + 1], -1)])
    mesh = mi.Mesh("ground", n * n, len(faces), has_vertex_normals=True)
    values = mi.traverse(mesh)
    values["vertex_positions"] = points.ravel()
    values["faces"] = faces.ravel()
    values.update()
    mesh.recompute_vertex_normals()
    return mesh


def trace(shapes: Picture, width: int, height: int) -> Picture:
    """The layers that Mitsuba sees: a ray through the middle of each pixel."""
    scene = mi.load_dict({"type": "scene", **shapes})
    # scene files have the x axis to the right, Mitsuba's camera has it to the left
    pose = mi.ScalarTransform4f().look_at(origin=EYE, target=AT, up=[0, 1, 0]).scale([-1, 1, 1])
    camera = mi.load_dict({
        "type": "perspective", "fov": FOV, "fov_axis": "x", "to_world": pose,
        "film": {"type": "hdrfilm", "width": width, "height": height, "component_format": "float32",
                 "rfilter": {"type": "box"}},
        "sampler": {"type": "stratified", "sample_count": 1, "jitter": False}})
    film = mi.load_dict({"type": "aov", "aovs": LAYERS})
    image = np.array(mi.render(scene, sensor=camera, integrator=film, spp=1), np.float64)
    widths = {"Q": 3, "uv": 2, "n": 3, "Qu": 3, "Qw": 3, "part": 1}
    out = dict(zip(widths, np.split(image, np.cumsum(list(widths.values()))[:-1], -1), strict=True))
    index = np.rint(out.pop("part")[..., 0]).astype(int)
    return {**out, **{shape.id(): index == k + 1 for k, shape in enumerate(scene.shapes())}}


def is_lit(shape: Any, origins: np.ndarray, asked: np.ndarray) -> np.ndarray:
    """Mitsuba's shadow test from each place that is asked for: does the lamp reach it past the shape?"""
    scene = mi.load_dict({"type": "scene", "caster": shape})
    lit = np.zeros(asked.shape, bool)
    for at in np.argwhere(asked):
        start = origins[tuple(at)]
        ray = mi.Ray3f(start, LAMP - start, 1.0, 0.0, [])
        lit[tuple(at)] = not scene.ray_test(ray)
    return lit


# ---- kage ----


def corrected(image: Picture, heights: HeightMap, method: str) -> gbuffer.Corrected:
    """n', and the places from which Mitsuba is to test shadows."""
    layers = gbuffer.layers(EYE, image["Q"], image["uv"], normal=image["n"], tangents=(image["Qu"], image["Qw"]),
                            there=image["ground"])
    return gbuffer.correct(layers, heights, method)


# ---- pictures ----


def shade(image: Picture, normals: np.ndarray, lit: np.ndarray) -> np.ndarray:
    """Lambert's law, in linear light. normals and lit are those of the ground; of the cube the light is not hidden."""
    out = np.broadcast_to(BACKGROUND, (*lit.shape, 3)).copy()
    for name, color in COLORS.items():
        n = normals if name == "ground" else image["n"]
        toward = LAMP - image["Q"]
        cosine = np.maximum((n * toward).sum(-1) / np.linalg.norm(toward, axis=-1), 0)
        seen = lit if name == "ground" else np.ones_like(lit)
        light = AMBIENT[name] + DIFFUSE[name] * (cosine * seen)[..., None] * LIGHT
        out = np.where(image[name][..., None], color * light, out)
    return out


def pictures(size: tuple[int, int], method: str, fineness: int) -> dict[str, tuple[np.ndarray, ...]]:
    """The linear picture, the ground's pixels and which of these see the lamp: without the shift, with it, in truth."""
    heights = height_map()
    smooth = trace({"cube": cube(), "ground": ground()}, *size)
    rough = trace({"cube": cube(), "ground": displaced(heights, fineness)}, *size)
    made = {}
    for name, image, how in (("none", smooth, "none"), (method, smooth, method), ("displaced", rough, "")):
        found = corrected(image, heights, how) if how else None
        origins, normals = (found.origin, found.normal) if found else (image["Q"], image["n"])
        lit = is_lit(cube(), origins, image["ground"])
        made[name] = shade(image, normals, lit), image["ground"], lit
    return made


def side_by_side(panels: dict[str, np.ndarray]) -> Image.Image:
    """Pictures in sRGB with labels over them."""
    high, wide = next(iter(panels.values())).shape[:2]
    size, gap = max(12, wide // 24), max(4, wide // 100)
    sheet = Image.new("RGB", (len(panels) * (wide + gap) - gap, high + 2 * size), "white")
    draw = ImageDraw.Draw(sheet)
    for k, (label, linear) in enumerate(panels.items()):
        x = np.clip(linear, 0, 1)
        srgb = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
        left = k * (wide + gap)
        sheet.paste(Image.fromarray(np.rint(255 * srgb).astype(np.uint8)), (left, 2 * size))
        draw.text((left + wide // 2, size), label, "black", ImageFont.load_default(size), anchor="mm")
    return sheet


def main() -> None:
    options = argparse.ArgumentParser(description="kage's shift in Mitsuba's picture")
    options.add_argument("-o", default="mitsuba_shadows.png", help="the PNG to write")
    options.add_argument("--method", default="2", help="none, 0, 1, 2, 2+, iter:K or march:N")
    options.add_argument("--size", type=int, nargs=2, default=(480, 360), metavar=("WIDTH", "HEIGHT"))
    options.add_argument("--mesh", type=int, default=1024, metavar="N", help="the displaced mesh has N x N places")
    given = options.parse_args()
    made = pictures(given.size, given.method, given.mesh)
    truth = made["displaced"][2]
    panels = {}
    for name, (linear, ground_seen, lit) in made.items():
        asked = ground_seen & made["displaced"][1]
        wrong = 100 * (lit != truth)[asked].sum() / (asked & ~truth).sum()
        print(f"{name}: {wrong:.2f} % of the shadow's pixels are wrong")
        label = {"none": "bump mapping alone", "displaced": "true displacement"}.get(name, f"with order {name}")
        panels[label] = linear
    side_by_side(panels).save(given.o)


if __name__ == "__main__":
    main()
