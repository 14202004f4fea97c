"""The export to POV-Ray: the same picture there as here, the same functions, and files that POV-Ray reads without a warning.

POV-Ray's EXR is half float, and the pictures are compared in linear light.
"""

from __future__ import annotations

import math
import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from conftest import Kage
from PIL import Image

POVRAY = shutil.which("povray")
STEP = 1 / 255
SIZE = (200, 150)

needs_povray = pytest.mark.skipif(not POVRAY and not os.environ.get("CI"), reason="no povray")

HEAD = """\
camera: {camera}
image: {{size: [200, 150], background: [0.05, 0.1, 0.2]}}
lights: {lights}
materials:
  clay: {{color: [0.82, 0.72, 0.58], ambient: 0.12, diffuse: 0.8}}
  shiny: {{color: [0.15, 0.3, 0.6], ambient: 0.2, diffuse: 0.5, phong: 0.6, phong_size: 30}}
  glaze: {{color: [0.6, 0.2, 0.15], diffuse: 0.6, specular: 0.7, roughness: 0.02}}
objects:
"""
CAMERA = "{from: [0.3, 2.9, -5.2], at: [0, 0.5, 0], fov: 40}"
LIGHTS = "{lamp: {at: [-4.5, 5.2, -2.2], color: [1.1, 1.08, 1]}}"
FLOOR = "  floor: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: clay}\n"
BALL = "  ball: {sphere: {center: [0, 1, 0], radius: 0.8}, material: MATERIAL}\n"
BOX = "  block: {box: {from: [-0.6, 0.55, -0.6], to: [0.6, 1.75, 0.6]}, material: MATERIAL}\n"
SHEET = "  sheet: {rectangle: {origin: [-1, 0.5, 0.2], u: [2, 0.4, 0.3], w: [0.5, 1.2, 0.4]}, material: MATERIAL}\n"
TILTED = "  floor: {plane: {origin: [0, -1, 0], u: [2, 0.5, 0.3], w: [0.4, 0.2, -3]}, material: MATERIAL}\n"
ROUND_ONES = {
    "disc": "disc: {center: [0, 0.9, 0.3], normal: [0.2, 1, -0.8], radius: 1.1}",
    "cylinder": "cylinder: {from: [-0.2, 0.1, 0.2], to: [0.3, 1.4, 0.1], radius: 0.8}",
    "open cylinder": "cylinder: {from: [-0.2, 0.1, 0.2], to: [0.3, 1.4, -0.2], radius: 0.8, open: true}",
    "lying cylinder": "cylinder: {from: [-1, 0.6, 0], to: [1, 0.6, 0], radius: 0.6}",
    "cone": "cone: {from: [-0.2, 0, 0.2], from_radius: 1, to: [0.1, 1.5, 0.1], to_radius: 0.5}",
    "pointed cone": "cone: {from: [-0.2, 0, 0.2], from_radius: 1, to: [0.1, 1.8, 0.1], to_radius: 0}",
    "open cone": "cone: {from: [0.1, 0.1, 0.2], from_radius: 0.4, to: [0.1, 1.2, 0.1], to_radius: 1.1, open: true}",
    "torus": "torus: {center: [0, 0.7, 0], axis: [0.2, 1, -0.3], major: 1, minor: 0.4}",
    "standing torus": "torus: {center: [0, 1, 0], axis: [0.4, 0, 1], major: 0.8, minor: 0.2}",
}
#: Transforms of what is about 1 in size, at the origin.
MOVES = {
    "moved": "[{rotate: [20, 35, -50]}, {scale: 0.8}, {translate: [0.1, 1, 0.2]}]",
    "mirrored": "[{scale: [-0.8, 0.8, 0.8]}, {rotate: [-40, 15, 30]}, {translate: [0.1, 1, 0.2]}]",
    "stretched": "[{scale: [1.3, 0.6, 0.9]}, {rotate: [20, 35, -50]}, {translate: [0.1, 1, 0.2]}]",
    "sheared": "[{rotate: [0, 30, 40]}, {scale: [1.2, 0.7, -0.9]}, {look: {from: [0.1, 1, 0.2], at: [1, 1.5, -2], up: [0.3, 1, 0]}}]",
}
PLAIN = {
    "sphere": "sphere: {center: [0.1, 0.1, -0.1], radius: 1}",
    "box": "box: {from: [-0.8, -0.6, -0.7], to: [0.7, 0.6, 0.8]}",
    "cylinder": "cylinder: {from: [0.1, -0.8, 0], to: [-0.1, 0.8, 0.1], radius: 0.8}",
    "cone": "cone: {from: [0, -0.8, 0], from_radius: 1, to: [0.1, 0.9, 0.1], to_radius: 0.3}",
    "torus": "torus: {center: [0, 0, 0.1], axis: [0.2, 1, 0.1], major: 0.8, minor: 0.35}",
    "rectangle": "rectangle: {origin: [-1, 0, -1], u: [2, 0.3, 0], w: [0.2, 0, 2.1]}",
    "disc": "disc: {center: [0.1, 0, 0], normal: [0.2, 1, 0.3], radius: 1}",
}


def moved(name: str, move: str) -> str:
    return f"{PLAIN[name]}\n    transform: {MOVES[move]}"


#: name: (camera, lights, objects)
SMOOTH = {
    "plane": (CAMERA, LIGHTS, TILTED.replace("MATERIAL", "clay") + BALL.replace("MATERIAL", "clay")),
    "rectangle": (CAMERA, LIGHTS, FLOOR + SHEET.replace("MATERIAL", "clay")),
    "box": (CAMERA, LIGHTS, FLOOR + BOX.replace("MATERIAL", "clay")),
    "sphere": (CAMERA, LIGHTS, FLOOR + BALL.replace("MATERIAL", "clay")),
    "phong plane": (CAMERA, LIGHTS, TILTED.replace("MATERIAL", "shiny")),
    "phong rectangle": (CAMERA, LIGHTS, FLOOR + SHEET.replace("MATERIAL", "shiny")),
    "phong box": (CAMERA, LIGHTS, FLOOR + BOX.replace("MATERIAL", "shiny")),
    "phong sphere": (CAMERA, LIGHTS, FLOOR + BALL.replace("MATERIAL", "shiny")),
    "specular plane": (CAMERA, LIGHTS, TILTED.replace("MATERIAL", "glaze")),
    "specular rectangle": (CAMERA, LIGHTS, FLOOR + SHEET.replace("MATERIAL", "glaze")),
    "specular box": (CAMERA, LIGHTS, FLOOR + BOX.replace("MATERIAL", "glaze")),
    "specular sphere": (CAMERA, LIGHTS, FLOOR + BALL.replace("MATERIAL", "glaze")),
    "three lights": (
        CAMERA,
        "{a: {at: [-4, 5, -2]}, b: {at: [5, 3, -3], color: [0.5, 0.1, 0.1]}, c: {at: [0, 2, 6], color: [0.1, 0.2, 0.7]}}",
        FLOOR + BALL.replace("MATERIAL", "shiny") + SHEET.replace("MATERIAL", "glaze"),
    ),
    "no light": (CAMERA, "{}", FLOOR + BALL.replace("MATERIAL", "shiny")),
    "up tilted": (
        "{from: [2, 2.9, -4], at: [0, 0.5, 0], up: [0.4, 1, -0.3], fov: 45}", LIGHTS, FLOOR + BOX.replace("MATERIAL", "shiny"),
    ),
    "aim off-centre": ("{from: [-1, 1.5, -4], at: [1.5, 0.2, 1], fov: 60}", LIGHTS, FLOOR + BALL.replace("MATERIAL", "glaze")),
    "straight down": ("{from: [0, 6, 0], at: [0, 0, 0], up: [1, 0, 1]}", LIGHTS, FLOOR + BOX.replace("MATERIAL", "clay")),
    "fov 10": ("{from: [3, 9, -20], at: [0, 0.7, 0], fov: 10}", LIGHTS, FLOOR + BALL.replace("MATERIAL", "shiny")),
    "fov 120": ("{from: [0.3, 1.9, -2], at: [0, 0.5, 0], fov: 120}", LIGHTS, FLOOR + BOX.replace("MATERIAL", "glaze")),
    "orthographic": ("{from: [0.3, 2.9, -5.2], at: [0, 0.5, 0], width: 4}", LIGHTS, FLOOR + BALL.replace("MATERIAL", "shiny")),
    "orthographic, tilted": ("{from: [2, 2.9, -4], at: [0, 0.5, 0], up: [0.4, 1, -0.3], width: 6}", LIGHTS,
                             FLOOR + BOX.replace("MATERIAL", "glaze")),
    "orthographic, straight down": ("{from: [0, 6, 0], at: [0, 0, 0], up: [1, 0, 1], width: 5}", LIGHTS,
                                    FLOOR + SHEET.replace("MATERIAL", "shiny")),
    "orthographic, cut": ("{from: [0, 0.4, -1.2], at: [0, 0, 0.1], width: 5}", LIGHTS, FLOOR + BOX.replace("MATERIAL", "shiny")),
    "horizon": ("{from: [0, 1.2, -5], at: [0, 1.2, 0], fov: 70}", LIGHTS, FLOOR + BALL.replace("MATERIAL", "clay")),
    "from below": ("{from: [0, -2, -4], at: [0, 0, 0], fov: 50}", "{a: {at: [1, -6, -3]}}", FLOOR + BALL.replace("MATERIAL", "clay")),
    "spot": (CAMERA, "{a: {at: [-3, 5, -2], spot: {to: [0, 0.5, 0]}}}", FLOOR + BALL.replace("MATERIAL", "shiny")),
    "spot tight": (CAMERA, "{a: {at: [-3, 5, -2], spot: {to: [0, 0, 0], radius: 0, falloff: 35, tightness: 7.5}}}",
                   FLOOR + BOX.replace("MATERIAL", "glaze")),
    "spot hard": (CAMERA, "{a: {at: [-3, 5, -2], spot: {to: [0.3, 0, 0], radius: 18, falloff: 18}}}",
                  FLOOR + BALL.replace("MATERIAL", "clay")),
    "parallel": (CAMERA, "{a: {at: [-3, 5, -2], parallel: {to: [0, 0, 0]}}}",
                 FLOOR + BALL.replace("MATERIAL", "shiny") + SHEET.replace("MATERIAL", "glaze")),
    "parallel from low": (CAMERA, "{a: {at: [-0.9, 0.9, -0.3], parallel: {to: [0, 0, 0]}, fade: {distance: 1.5}}}",
                          FLOOR + BOX.replace("MATERIAL", "shiny")),
    "fading": (CAMERA, "{a: {at: [-1, 3, -2], color: [2, 1, 1], fade: {distance: 2.5, power: 3}}}",
               FLOOR + BALL.replace("MATERIAL", "shiny")),
    "spot fading": (CAMERA, "{a: {at: [-3, 5, -2], spot: {to: [0, 0.5, 0], radius: 5}, fade: {distance: 8, power: 1.5}}}",
                    FLOOR + SHEET.replace("MATERIAL", "glaze")),
    "area": (CAMERA, "{a: {at: [-3, 5, -2], area: {u: [1.5, 0, 0], w: [0, 0, 1], samples: [4, 4]}}}",
             FLOOR + BALL.replace("MATERIAL", "shiny")),
    "area uneven": (CAMERA, "{a: {at: [-3, 5, -2], area: {u: [1.5, 0.2, 0], w: [0, 0.3, 1], samples: [5, 3]}}}",
                    FLOOR + BOX.replace("MATERIAL", "clay")),
    "area row, spot": (CAMERA, "{a: {at: [-3, 5, -2], spot: {to: [0, 0, 0]}, area: {u: [2, 0, 0], w: [0, 0, 1], samples: [6, 1]}}}",
                       FLOOR + BOX.replace("MATERIAL", "glaze") + SHEET.replace("MATERIAL", "clay")),
    **{
        f"{material} {name}".replace("clay ", ""): (CAMERA, LIGHTS, f"{FLOOR}  it: {{{shape}, material: {material}}}\n")
        for name, shape in ROUND_ONES.items()
        for material in ("clay", "shiny", "glaze")
    },
    **{
        f"{move} {name}": (CAMERA, LIGHTS, f"{FLOOR}  it:\n    material: shiny\n    {moved(name, move)}\n")
        for name in PLAIN
        for move in MOVES
    },
    "moved plane": (CAMERA, LIGHTS, f"  it:\n    {TILTED[TILTED.index('plane'):TILTED.index(', mat')]}\n    material: glaze\n"
                                    "    transform: [{scale: [2, 1, -1.5]}, {rotate: [0, 30, 5]}, {translate: [0, -0.5, 0]}]\n"),
    "copies": (CAMERA, LIGHTS, f"{FLOOR}  it:\n    material: shiny\n    {moved('torus', 'moved')}\n"
                               "  it2: {copy: it, transform: [{scale: [1, 0.5, 1]}, {translate: [1.4, 0, 0.5]}]}\n"
                               "  it3: {copy: it2, material: clay, transform: [{scale: [-1, 1, 1]}, {translate: [0, 0, 1]}]}\n"),
    "eye in a cylinder": (
        "{from: [0, 1.1, 0], at: [0.3, 0.4, 1], fov: 90}", "{a: {at: [0.2, 1.2, 0.1]}}",
        f"  it: {{{ROUND_ONES['cylinder']}, material: shiny}}\n",
    ),
    "eye in a torus": (
        "{from: [1, 0.5, 0], at: [1, 0.6, 1], fov: 90}", "{a: {at: [1.1, 0.5, 0.1]}}",
        "  it: {torus: {center: [0, 0.5, 0], axis: [0, 1, 0], major: 1, minor: 0.5}, material: shiny}\n",
    ),
    "through the hole": (
        "{from: [0, 4, 0], at: [0, 0, 0], up: [1, 0, 1], fov: 40}", LIGHTS,
        f"{FLOOR}  it: {{torus: {{center: [0, 1, 0], axis: [0, 1, 0], major: 0.5, minor: 0.45}}, material: clay}}\n",
    ),
    "eye within": ("{from: [0, 1.1, 0], at: [0.3, 0.4, 1], fov: 90}", "{a: {at: [0.2, 1.4, 0.1]}}", BOX.replace("MATERIAL", "shiny")),
}


def povray(scene: Path, size: tuple[int, int] = SIZE, *options: str) -> tuple[np.ndarray, str]:
    """The picture, and all warnings."""
    assert POVRAY, "povray is not there"
    out, words = scene.with_suffix(".pov.exr"), scene.with_suffix(".words")
    done = subprocess.run(
        [POVRAY, f"+I{scene.name}", f"+O{out.name}", "+FE", f"+W{size[0]}", f"+H{size[1]}", "-D", "-A", "+WT2", "-V",
         f"+GW{words.name}", *options],
        cwd=scene.parent, capture_output=True, text=True, timeout=600,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    with OpenEXR.File(str(out), separate_channels=True) as file:
        channels = file.channels()
        rgb = np.stack([channels[name].pixels.astype(float) for name in "RGB"], axis=-1)
    return rgb, ADVICE.sub("", words.read_text()) if words.exists() else ""


#: A bound can be above what one picture has met of it: this advice is none to follow, and no warning.
ADVICE = re.compile(r"(File: \S+\s+Line: \d+\s*)?Shutdown Warning: The maximum gradient found was[^!]*?faster\s+rendering\s+of\s+the\s+isosurface\.\s*")


def layers(path: Path) -> dict[str, np.ndarray]:
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels.astype(float) for name, channel in file.channels().items()}


def near(mask: np.ndarray) -> np.ndarray:
    """Within one pixel of a pixel of the mask."""
    wide = np.pad(mask, 1)
    rows, columns = mask.shape
    return np.any([wide[y : y + rows, x : x + columns] for y in range(3) for x in range(3)], axis=0)


def edges(of: np.ndarray) -> np.ndarray:
    """Pixels that differ from their neighbour to the right or below, both of each pair."""
    found = np.zeros(of.shape[:2], bool)
    across, down = of[:, 1:] != of[:, :-1], of[1:] != of[:-1]
    found[:, 1:] |= across
    found[:, :-1] |= across
    found[1:] |= down
    found[:-1] |= down
    return found


def borders(kage: Kage, scene: Path, picture: dict[str, np.ndarray]) -> np.ndarray:
    """Within one pixel of silhouettes, of the edges between objects and faces, and of shadows."""
    found = edges(np.isfinite(picture["Z"]) & (picture["Z"] < 1e6))
    normal = np.stack([picture[f"N.{axis}"] for axis in "XYZ"], axis=-1)
    for y, x in ((0, 1), (1, 0)):
        a, b = normal[: normal.shape[0] - y, : normal.shape[1] - x], normal[y:, x:]
        turn = ~(np.sum(a * b, axis=-1) > 0.7)
        found[: turn.shape[0], : turn.shape[1]] |= turn
        found[y:, x:] |= turn
    for name, values in picture.items():
        if name.startswith("visibility"):
            found |= edges(values)
    return near(found)


@needs_povray
def test_smooth_parity(kage: Kage, capsys: pytest.CaptureFixture[str]) -> None:
    table, wrong = [f"{'scene':20} within 1/255   worst   off edges"], []
    for name, (camera, lights, objects) in SMOOTH.items():
        scene = kage.folder / f"{name.replace(' ', '-')}.yaml"
        scene.write_text(HEAD.format(camera=camera, lights=lights) + objects)
        kage.good("pov", scene, "-o", scene.with_suffix(".pov"), "--surface", "smooth")
        kage.good("render", scene, "-o", scene.with_suffix(".exr"), "--quiet")
        picture = layers(scene.with_suffix(".exr"))
        theirs, words = povray(scene.with_suffix(".pov"))
        ours = np.stack([picture[channel] for channel in "RGB"], axis=-1)
        off = np.abs(ours - theirs).max(axis=-1)
        # half float has 11 bits: above 2 its own step counts
        bad = off > np.maximum(STEP, np.abs(theirs).max(axis=-1) * 2.0**-10)
        stray = int((bad & ~borders(kage, scene, picture)).sum())
        share = 1 - bad.mean()
        table.append(f"{name:20} {100 * share:10.4f} % {off.max():8.4f} {stray:6d}")
        if share < 0.999 or stray or words.strip():
            wrong.append((name, share, stray, words))
    with capsys.disabled():
        print("\n" + "\n".join(table))
    assert not wrong


SECOND_HEAD = """\
camera: {camera}
image: {{size: [200, 150], background: [0.1, 0.25, 0.5]}}
render: {{depth: {depth}}}
lights: {lights}
materials:
  clay: {{color: [0.82, 0.72, 0.58], ambient: 0.12, diffuse: 0.8}}
  red: {{color: [0.9, 0.2, 0.1], ambient: 0.2, diffuse: 0.7, phong: 0.5}}
  tiles: {{color: {{checker: {{even: [0.9, 0.85, 0.7], odd: [0.1, 0.2, 0.3], size: [0.5, 0.5]}}}}, ambient: 0.2, diffuse: 0.7}}
  mirror: {{color: [0.5, 0.5, 0.5], ambient: 0.05, diffuse: 0.1, reflection: 0.8}}
  gold: {{color: [0.5, 0.4, 0.1], ambient: 0.1, diffuse: 0.3, specular: 0.6, roughness: 0.02, reflection: [0.8, 0.6, 0.2]}}
  glass: {{color: [0.9, 1, 0.95], ambient: 0, diffuse: 0.05, phong: 0.7, phong_size: 60, reflection: 0.1, filter: 0.9, ior: 1.5}}
  clear: {{ambient: 0, diffuse: 0, transmit: 1, ior: 1.5}}
  pane: {{color: [0.9, 0.3, 0.1], ambient: 0.1, diffuse: 0.4, phong: 0.4, filter: 0.6, transmit: 0.2}}
  stained: {{color: {{checker: {{even: [0.9, 0.1, 0.1], odd: [0.1, 0.3, 0.9], size: [0.25, 0.2]}}}}, ambient: 0.1, filter: 0.7, transmit: 0.1, ior: 1.2}}
  printed: {{color: {{image: {{file: color.png}}}}, ambient: 0.1, filter: 0.5, transmit: 0.3}}
  water: {{color: [0.6, 0.8, 1], ambient: 0, diffuse: 0.1, reflection: 0.2, filter: 0.5, transmit: 0.4, ior: 1.33}}
  air: {{ambient: 0, diffuse: 0, transmit: 1, reflection: 0.1, ior: 1}}
objects:
"""
TILED = "  floor: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: tiles}\n"
BACK = "  back: {rectangle: {origin: [-3, 3, 2], u: [6, 0, 0.5], w: [0, -3, 0]}, material: mirror}\n"
SIDE = "  side: {sphere: {center: [1.2, 0.5, 0.6], radius: 0.5}, material: red}\n"
COLORED = "{lamp: {at: [-4.5, 5.2, -2.2], color: [1.1, 1.08, 1]}, area: {at: [2, 4, -3], color: [0.3, 0.4, 0.6], area: {u: [1, 0, 0], w: [0, 0, 1], samples: [4, 4]}}}"

#: name: (camera, lights, depth, objects)
SECONDARY = {
    "mirror plane": (CAMERA, LIGHTS, 5, FLOOR.replace("clay", "mirror") + BALL.replace("MATERIAL", "red")),
    "mirror sphere": (CAMERA, LIGHTS, 5, TILED + BALL.replace("MATERIAL", "mirror") + SIDE),
    "mirror box, gold": (CAMERA, COLORED, 5, TILED + BOX.replace("MATERIAL", "gold") + SIDE),
    **{f"mirror in mirror, depth {depth}": (CAMERA, LIGHTS, depth, TILED + BALL.replace("MATERIAL", "gold") + BACK + SIDE)
       for depth in (1, 2, 3, 5, 12)},
    "glass sphere": (CAMERA, LIGHTS, 5, TILED + BALL.replace("MATERIAL", "glass") + SIDE),
    "glass box": (CAMERA, LIGHTS, 7, TILED + BOX.replace("MATERIAL", "glass") + SIDE),
    "clear sphere": (CAMERA, LIGHTS, 4, TILED + BALL.replace("MATERIAL", "clear") + SIDE),
    "total reflection": ("{from: [0.2, 0.6, -3], at: [0, 1.2, 0], fov: 45}", LIGHTS, 9, TILED + SIDE
                         + "  block: {box: {from: [-0.9, 0.2, -0.9], to: [0.9, 1.75, 0.8]}, material: clear}\n"),
    "under water": ("{from: [0.2, 0.3, -3], at: [0, 0.8, 0], fov: 70}", LIGHTS, 6, TILED + SIDE
                    + "  water: {plane: {origin: [0, 1.3, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: water}\n"
                    + "  above: {sphere: {center: [-0.5, 1.8, 0], radius: 0.3}, material: red}\n"),
    "water": (CAMERA, COLORED, 6, TILED + SIDE + BALL.replace("MATERIAL", "red")
              + "  water: {plane: {origin: [0, 0.7, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: water}\n"),
    "panes": (CAMERA, COLORED, 3, TILED + SHEET.replace("MATERIAL", "pane") + SIDE
              + "  second: {rectangle: {origin: [-1.5, 2, -1], u: [2, 0, 0], w: [0, 0.5, 1]}, material: pane}\n"),
    "pane behind pane": ("{from: [0.3, 2.4, -5.2], at: [0, 1, 0], fov: 40}", LIGHTS, 2, TILED + "".join(
        f"  pane{k}: {{rectangle: {{origin: [{-1 + 0.1 * k}, 2, {0.3 * k}], u: [1.5, 0, 0], w: [0, -1.5, 0.2]}}, material: pane}}\n"
        for k in range(5))),
    "filter sphere": (CAMERA, COLORED, 5, TILED + BALL.replace("MATERIAL", "pane") + SIDE),
    "filter box": (CAMERA, LIGHTS, 5, TILED + BOX.replace("MATERIAL", "pane") + SIDE),
    "stained sheet": (CAMERA, COLORED, 5, TILED + SHEET.replace("MATERIAL", "stained") + SIDE),
    "stained box": (CAMERA, LIGHTS, 5, TILED + BOX.replace("MATERIAL", "stained") + SIDE),
    "stained sphere": (CAMERA, LIGHTS, 5, TILED + BALL.replace("MATERIAL", "stained") + SIDE),
    "printed sheet": (CAMERA, LIGHTS, 5, TILED + SHEET.replace("MATERIAL", "printed") + SIDE),
    "ball in a ball": (CAMERA, LIGHTS, 6, TILED + BALL.replace("MATERIAL", "glass") + SIDE
                       + "  inner: {sphere: {center: [0.1, 1, -0.1], radius: 0.4}, material: water}\n"),
    "bubble in glass": (CAMERA, LIGHTS, 6, TILED + BALL.replace("MATERIAL", "clear") + SIDE
                        + "  inner: {sphere: {center: [0.1, 1, -0.1], radius: 0.4}, material: air}\n"),
    "half in water": (CAMERA, LIGHTS, 6, TILED + BALL.replace("MATERIAL", "clear") + SIDE
                      + "  water: {plane: {origin: [0, 0.7, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: water}\n"),
    "overlapping": (CAMERA, LIGHTS, 8, TILED + BALL.replace("MATERIAL", "clear") + SIDE
                    + "  other: {box: {from: [-0.9, 0.3, -0.7], to: [0.1, 1.2, 0.7]}, material: water}\n"),
    "eye in glass": ("{from: [0, 1.1, 0], at: [0.3, 0.4, 1], fov: 90}", LIGHTS, 5, TILED + BALL.replace("MATERIAL", "clear") + SIDE),
    "orthographic glass": ("{from: [0.3, 2.9, -5.2], at: [0, 0.5, 0], width: 4}", LIGHTS, 5, TILED + BALL.replace("MATERIAL", "glass") + SIDE),
    "spot through a pane": (CAMERA, "{a: {at: [-3, 5, -2], spot: {to: [0, 0.5, 0]}, fade: {distance: 6}}}", 5,
                            TILED + SHEET.replace("MATERIAL", "stained") + SIDE),
    **{f"{material} {name}": (CAMERA, LIGHTS, 6, f"{TILED}{SIDE}  it: {{{ROUND_ONES[name]}, material: {material}}}\n")
       for material, name in (("mirror", "torus"), ("glass", "torus"), ("clear", "standing torus"), ("glass", "cylinder"),
                              ("pane", "open cylinder"), ("mirror", "cone"), ("clear", "pointed cone"), ("gold", "open cone"),
                              ("mirror", "disc"), ("pane", "disc"))},
    **{f"{material} {name}, {move}": (CAMERA, LIGHTS, 7, f"{TILED}{SIDE}  it:\n    material: {material}\n    {moved(name, move)}\n")
       for material, name, move in (("glass", "box", "sheared"), ("glass", "sphere", "stretched"), ("clear", "cylinder", "mirrored"),
                                    ("mirror", "torus", "moved"))},
    "glass copies": (CAMERA, COLORED, 7, f"{TILED}{SIDE}  it:\n    material: glass\n    {moved('box', 'moved')}\n"
                     "  it2: {copy: it, material: mirror, transform: [{scale: [1, 0.5, 1]}, {translate: [1.4, 0, 0.5]}]}\n"
                     "  it3: {copy: it, transform: [{scale: [-0.6, 1, 1]}, {translate: [-1.6, 0, 0.5]}]}\n"),
    "parallel through glass": (CAMERA, "{a: {at: [-3, 5, -2], parallel: {to: [0, 0, 0]}}}", 5, TILED + BALL.replace("MATERIAL", "glass") + SIDE),
}


@needs_povray
@pytest.mark.parametrize("name", SECONDARY)
def test_secondary_parity(kage: Kage, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Mirrors, glass and coloured shadows."""
    write_images(kage.folder)
    scene = kage.folder / "second.yaml"
    camera, lights, depth, objects = SECONDARY[name]
    scene.write_text(SECOND_HEAD.format(camera=camera, lights=lights, depth=depth) + objects)
    kage.good("pov", scene, "-o", "second.pov", "--surface", "smooth")
    kage.good("render", scene, "-o", "second.exr", "--quiet")
    picture = layers(kage.folder / "second.exr")
    theirs, words = povray(kage.folder / "second.pov")
    off = np.abs(np.stack([picture[channel] for channel in "RGB"], axis=-1) - theirs).max(axis=-1)
    close = float((off <= np.maximum(STEP, np.abs(theirs).max(axis=-1) * 2.0**-10)).mean())
    with capsys.disabled():
        print(f"{name:28} {100 * close:9.4f} % {off.max():8.4f}")
    assert not words.strip()
    assert close >= 0.999, f"{100 * close:.3f} %"


#: name: (colour, object)
SPHERE = "sphere: {center: [0.1, 1, 0], radius: 1}"
COLORS = {
    "checker plane": ("{checker: {even: [0.9, 0.8, 0.7], odd: [0.1, 0.2, 0.4], size: [0.7, 0.4], offset: [0.1, 0.05]}}",
                      "plane: {origin: [0, 0, 0], u: [2, 0.1, 0.3], w: [0.4, 0.2, -3]}"),
    "checker rectangle": ("{checker: {even: [0.9, 0.8, 0.7], odd: [0.1, 0.2, 0.4], size: [0.25, 0.2]}}",
                          "rectangle: {origin: [-1, 0.5, 0.2], u: [2, 0.4, 0.3], w: [0.5, 1.2, 0.4]}"),
    "checker box": ("{checker: {even: [0.9, 0.8, 0.7], odd: [0.1, 0.2, 0.4], size: [0.3, 0.5]}}",
                    "box: {from: [-0.6, 0.55, -0.6], to: [0.6, 1.75, 0.6]}"),
    "checker sphere": ("{checker: {even: [0.9, 0.8, 0.7], odd: [0.1, 0.2, 0.4], size: [0.5, 0.3], offset: [0.1, 0]}}", SPHERE),
    "image plane": ("{image: {file: color.png, size: [0.8, 1.1], offset: [0.3, 0.2]}}",
                    "plane: {origin: [0, 0, 0], u: [2, 0.1, 0.3], w: [0.4, 0.2, -3]}"),
    "image rectangle, nearest": ("{image: {file: color.png, interpolation: nearest, wrap: clamp}}",
                                 "rectangle: {origin: [-1, 2.1, 0.2], u: [2, 0.4, 0.3], w: [0.5, -1.2, 0.4]}"),
    "image box": ("{image: {file: color.png, repeat: [2, 1]}}", "box: {from: [-0.6, 0.55, -0.6], to: [0.6, 1.75, 0.6]}"),
    "image sphere": ("{image: {file: color.png}}", SPHERE),
    "image sphere, a seam": ("{image: {file: color.png, size: [2.5, 2], offset: [0.4, 0.3]}}", SPHERE),
    "image, 16 bits, grey": ("{image: {file: grey.png, size: [2, 2]}}", "plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}"),
    "image, linear": ("{image: {file: color.png, encoding: linear, size: [2, 2]}}",
                      "plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}"),
    "image, palette": ("{image: {file: palette.png, size: [2, 2], interpolation: nearest}}",
                       "plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}"),
    "image, EXR": ("{image: {file: color.exr, size: [2, 2]}}", "plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}"),
}


def write_images(folder: Path) -> None:
    x, y = np.meshgrid(np.arange(24), np.arange(16))
    red, green, blue = 127 + 120 * np.sin(x / 3), 127 + 120 * np.cos(y / 2 + x / 5), 255 * (x + y) / 38
    rgb = np.stack([red, green, blue], axis=-1)
    rgb[:4, :4] = 255, 0, 0  # which corner is which
    rgb[-4:, :4] = 0, 255, 0
    picture = Image.fromarray(rgb.astype(np.uint8))
    picture.save(folder / "color.png")
    picture.quantize(16).save(folder / "palette.png")
    Image.fromarray((257 * red).astype(np.uint16)).save(folder / "grey.png")
    channels = {name: (rgb[..., k] / 200).astype(np.float32) for k, name in enumerate("RGB")}
    OpenEXR.File({"type": OpenEXR.scanlineimage}, channels).write(str(folder / "color.exr"))


def write_colored(kage: Kage, color: str, shape: str, more: str = "") -> Path:
    write_images(kage.folder)
    scene = kage.folder / "color.yaml"
    head = HEAD.format(camera=CAMERA, lights=LIGHTS).replace("objects:\n", f"  own: {{color: {color}, ambient: 0.2, phong: 0.3}}\nobjects:\n")
    scene.write_text(head + f"  it:\n    {shape}\n    material: own\n{more}" + "  above: {sphere: {center: [-0.9, 2.3, -1], radius: 0.25}, material: shiny}\n")
    return scene


@needs_povray
@pytest.mark.parametrize("name", COLORS)
def test_color_parity(kage: Kage, name: str) -> None:
    scene = write_colored(kage, *COLORS[name])
    kage.good("pov", scene, "-o", "color.pov", "--surface", "smooth")
    kage.good("render", scene, "-o", "picture.exr", "--quiet")
    picture = layers(kage.folder / "picture.exr")
    theirs, words = povray(kage.folder / "color.pov")
    off = np.abs(np.stack([picture[channel] for channel in "RGB"], axis=-1) - theirs).max(axis=-1)
    close = float((off <= np.maximum(STEP, np.abs(theirs).max(axis=-1) * 2.0**-10)).mean())
    assert not words.strip()
    assert close >= 0.999, f"{100 * close:.3f} %"
    assert theirs.std() > 0.05


@needs_povray
@pytest.mark.parametrize(("name", "bump"), [
    *((name, "{function: '0.05*sin(8*u)*sin(8*w)*sin(w)^2'}") for name in ("checker plane", "checker box", "image box", "image sphere, a seam")),
    *((name, "{function: '0.05*sin(5*u)^2*sin(w)^2 + 0*noise(u,w)'}") for name in ("image box", "image sphere, a seam")),
], ids=lambda value: "mesh" if "noise" in value else "isosurface" if value[0] == "{" else value)
def test_displaced_color_parity(kage: Kage, name: str, bump: str) -> None:
    """Colours lie on the truly rough surface where they lie on the smooth one."""
    scene = write_colored(kage, *COLORS[name], more=f"    bump: {bump}\n")
    kage.good("pov", scene, "-o", "color.pov", "--surface", "displaced", "--size", "100x75")
    kage.good("render", scene, "-o", "picture.exr", "--quiet", "--surface", "displaced", "--size", "100x75")
    assert ("mesh2 {" in (kage.folder / "color.pov").read_text()) == ("noise" in bump)
    picture = layers(kage.folder / "picture.exr")
    theirs, words = povray(kage.folder / "color.pov", (100, 75))
    off = np.abs(np.stack([picture[channel] for channel in "RGB"], axis=-1) - theirs).max(axis=-1)
    assert not words.strip()
    assert (off <= STEP).mean() > 0.99


@pytest.mark.parametrize("color", ["{image: {file: color.png, wrap: clamp}}", "{image: {file: color.png, wrap: mirror}}",
                                   "{image: {file: color.png, wrap: clamp, interpolation: nearest, size: [0.5, 1]}}"])
def test_image_that_povray_has_not(kage: Kage, color: str) -> None:
    scene = write_colored(kage, color, "rectangle: {origin: [-1, 2.1, 0.2], u: [2, 0.4, 0.3], w: [0.5, -1.2, 0.4]}")
    done = kage("pov", scene, "-o", "color.pov")
    assert done.returncode == 2 and "object it: POV-Ray's images repeat and do nothing else, expected 'wrap: repeat'" in done.stderr
    assert not (kage.folder / "color.pov").exists()
    kage.good("render", scene, "-o", "color.exr", "--quiet")


@needs_povray
def test_area_light_as_adaptive_0(kage: Kage) -> None:
    """POV-Ray's usual way leaves samples out where the four around them agree: no picture of its own, but close."""
    camera, lights, objects = SMOOTH["area uneven"]
    scene = kage.folder / "area.yaml"
    scene.write_text(HEAD.format(camera=camera, lights=lights) + objects)
    kage.good("pov", scene, "-o", "area.pov", "--surface", "smooth")
    kage.good("render", scene, "-o", "area.exr", "--quiet")
    text = (kage.folder / "area.pov").read_text()
    assert "5, 3 adaptive 16 }" in text
    (kage.folder / "area.pov").write_text(text.replace("adaptive 16", "adaptive 0"))
    theirs, words = povray(kage.folder / "area.pov")
    picture = layers(kage.folder / "area.exr")
    ours = np.stack([picture[channel] for channel in "RGB"], axis=-1)
    assert not words.strip()
    assert np.abs(ours - theirs).mean() < 0.5 * STEP
    visible = picture["visibility.a"]
    assert 0.01 < ((visible > 0) & (visible < 1)).mean() < 0.5


@needs_povray
@pytest.mark.parametrize("name", ["box", "three lights", "area", "specular sphere"])
def test_adaptive_samples(kage: Kage, name: str) -> None:
    """POV-Ray compares other neighbours, in a gamma of 2.5, so this is not the same picture, but close."""
    camera, lights, objects = SMOOTH[name]
    scene = kage.folder / "adaptive.yaml"
    scene.write_text(HEAD.format(camera=camera, lights=lights) + objects)
    some = ["--set", "render={aa: 4, aa_threshold: 0.1}"]
    kage.good("pov", scene, "-o", "adaptive.pov", "--surface", "smooth", *some)
    found = re.search(r"// render:.* \+A0\.1 \+AM1 \+R4 -J -D$", (kage.folder / "adaptive.pov").read_text(), re.MULTILINE)
    assert found
    theirs, words = povray(kage.folder / "adaptive.pov", SIZE, "+A0.1", "+AM1", "+R4", "-J")
    pictures = {}
    for file, options in {"one": [], "adaptive": some}.items():
        kage.good("render", scene, "-o", f"{file}.exr", "--quiet", *options)
        picture = layers(kage.folder / f"{file}.exr")
        pictures[file] = np.abs(np.stack([picture[channel] for channel in "RGB"], axis=-1) - theirs).mean()
    assert not words.strip()
    assert pictures["adaptive"] < 0.5 * STEP and pictures["adaptive"] < 0.5 * pictures["one"], pictures


# ---- displaced ----

FUNCTION = "{function: '0.03*(sin(6*u)*cos(5.4*w) + 0.5*sin(10.2*u + 6.6*w))'}"
NOISE = "{function: '0.05*noise(4*u, 4*w)'}"
ROUND = "{function: '0.05*sin(8*u)*sin(8*w)*sin(w)^2'}"
WAVES = "{function: '0.04*sin(8*u)*sin(7*w)'}"
MAP = "{map: {file: map.png}, scale: 0.1, zero: 0.5, sign: up, size: [2, 2]}"
PLANE = "plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}"
SKEWED = "rectangle: {origin: [-2, 0.1, -2], u: [4, 0.4, 0], w: [1, 0, 5]}"
GLOBE = "sphere: {center: [0.1, 1, 0], radius: 1}"
CUBE = "box: {from: [-1, 0, -1], to: [1, 1.2, 1]}"

DISPLACED = {
    "plane": (PLANE, FUNCTION, "isosurface"),
    "skewed rectangle": (SKEWED, "{function: '0.1*sin(9*u)*sin(11*w)', scale: -0.8}", "isosurface"),
    "box": (CUBE, "{function: '0.04*sin(12*u)*sin(10*w)'}", "isosurface"),
    "sphere": (GLOBE, ROUND, "isosurface"),
    "sphere, steep at its poles": (GLOBE, "{function: '0.04*sin(8*u)*sin(6*w)'}", "isosurface"),
    "sphere, torn at its poles": (GLOBE, "{function: '0.04*sin(8*u)'}", "mesh2"),
    "plane, noise": (PLANE, NOISE, "mesh2"),
    "plane, map": (PLANE, MAP, "mesh2"),
    "rectangle, map": (SKEWED, MAP.replace("[2, 2]", "[0.5, 0.4]"), "mesh2"),
    "box, map": (CUBE, MAP.replace("[2, 2]", "[1, 1]"), "mesh2"),
    "sphere, map": (GLOBE, MAP.replace("[2, 2]", "[0.8, 0.7]"), "mesh2"),
    "disc": (ROUND_ONES["disc"], WAVES, "isosurface"),
    "cylinder": (ROUND_ONES["cylinder"], WAVES, "isosurface"),
    "open cylinder": (ROUND_ONES["open cylinder"], WAVES, "isosurface"),
    "cone": (ROUND_ONES["cone"], WAVES, "mesh2"),
    "pointed cone": (ROUND_ONES["pointed cone"], WAVES.replace("sin(7*w)", "sin(7*w)*min(w, 1)"), "mesh2"),
    "open cone": (ROUND_ONES["open cone"], WAVES, "mesh2"),
    "torus": (ROUND_ONES["torus"], WAVES, "isosurface"),
    "standing torus, thin": (ROUND_ONES["standing torus"], WAVES.replace("0.04", "-0.03"), "isosurface"),
    "disc, map": (ROUND_ONES["disc"], MAP.replace("[2, 2]", "[1, 1]"), "mesh2"),
    "cylinder, map": (ROUND_ONES["cylinder"], MAP.replace("size: [2, 2]", "repeat: [8, 2]"), "mesh2"),
    "cone, map": (ROUND_ONES["cone"], MAP.replace("size: [2, 2]", "repeat: [8, 2]"), "mesh2"),
    "torus, map": (ROUND_ONES["torus"], MAP.replace("size: [2, 2]", "repeat: [8, 4]"), "mesh2"),
    "moved sphere": (moved("sphere", "moved"), ROUND, "isosurface"),
    "moved box": (moved("box", "moved"), WAVES, "isosurface"),
    "moved cylinder": (moved("cylinder", "moved"), "{function: '0.04*sin(7*w + u)'}", "isosurface"),
    "moved cone": (moved("cone", "moved"), WAVES, "mesh2"),
    "moved torus": (moved("torus", "moved"), WAVES, "isosurface"),
    "moved rectangle": (moved("rectangle", "moved"), WAVES, "isosurface"),
    "moved plane": (f"{PLANE}\n    transform: [{{scale: [2, 1, -1.5]}}, {{rotate: [0, 30, 5]}}, {{translate: [0, -0.2, 0]}}]", FUNCTION,
                    "isosurface"),
    "moved plane, noise": (f"{PLANE}\n    transform: [{{scale: 1.5}}, {{rotate: [0, 30, 5]}}]", NOISE, "mesh2"),
    "mirrored sphere": (moved("sphere", "mirrored"), ROUND.replace("8*u", "8*u+1"), "isosurface"),
    "mirrored cylinder": (moved("cylinder", "mirrored"), WAVES.replace("8*u", "8*u+1"), "isosurface"),
    "mirrored torus, map": (moved("torus", "mirrored"), MAP.replace("size: [2, 2]", "repeat: [8, 4]"), "mesh2"),
    "mirrored rectangle": (moved("rectangle", "mirrored"), "{function: '0.04*sin(18*u+1)*sin(17*w)'}", "isosurface"),
    "stretched box": (moved("box", "stretched"), "{function: '0.04*sin(18*u)*sin(17*w)'}", "isosurface"),
    "sheared box": (moved("box", "sheared"), "{function: '0.04*sin(9*u+1)*sin(7*w)'}", "isosurface"),
    "sheared box, map": (moved("box", "sheared"), MAP.replace("[2, 2]", "[1, 1]"), "mesh2"),
    "sheared disc": (moved("disc", "sheared"), WAVES.replace("8*u", "8*u+1"), "isosurface"),
    "stretched disc, map": (moved("disc", "stretched"), MAP.replace("[2, 2]", "[1, 1]"), "mesh2"),
}

#: P is 0 at the edges, so that nothing is open between the parts.
CLOSED = {
    "closed box": (CUBE, "{function: '0.64*sin(12*u)*sin(10*w)*u*(1-u)*w*(1-w)'}", "isosurface"),
    "closed cylinder": ("cylinder: {from: [0.1, 0.1, 0], to: [0.1, 1.6, 0], radius: 0.8}",
                        "{function: '0.07*sin(8*u)*sin(7*w)*w*(1.5-w)*(0.64-u^2-w^2)/(0.64+u^2+w^2)'}", "isosurface"),
}


def write_displaced(kage: Kage, name: str, camera: str = CAMERA) -> Path:
    shape, bump, _ = {**DISPLACED, **CLOSED}[name]
    scene = kage.folder / "rough.yaml"
    scene.write_text(
        HEAD.format(camera=camera, lights=LIGHTS).replace("[200, 150]", "[100, 75]")
        + f"  rough:\n    {shape}\n    material: clay\n    bump: {bump}\n"
        + "  above: {sphere: {center: [0.4, 2.4, -0.6], radius: 0.3}, material: shiny}\n"
    )
    x, y = np.meshgrid(np.arange(16), np.arange(16))
    heights = 32768 + 20000 * np.sin(x * math.pi / 4) * np.cos(y * math.pi / 8)
    Image.fromarray(heights.astype(np.uint16)).save(kage.folder / "map.png")
    return scene


@needs_povray
@pytest.mark.parametrize("name", DISPLACED)
def test_displaced_without_warnings(kage: Kage, name: str) -> None:
    """Not one about a gradient, above all: that would be holes."""
    scene = write_displaced(kage, name)
    kage.good("pov", scene, "-o", "rough.pov", "--surface", "displaced")
    assert DISPLACED[name][2] + " {" in (kage.folder / "rough.pov").read_text()
    picture, words = povray(kage.folder / "rough.pov", (100, 75))
    assert not words.strip()
    assert picture.std() > 0.02


@needs_povray
def test_a_warning_of_holes_is_seen(kage: Kage) -> None:
    """The test above can fail."""
    scene = write_displaced(kage, "plane")
    kage.good("pov", scene, "-o", "rough.pov", "--surface", "displaced")
    text = (kage.folder / "rough.pov").read_text()
    (kage.folder / "low.pov").write_text(re.sub(r"max_gradient \S+", "max_gradient 0.5", text))
    assert "holes" in povray(kage.folder / "low.pov", (100, 75))[1]


@needs_povray
@pytest.mark.parametrize("camera", ["{from: [0, 2, -3], at: [0.5, 0, 0], up: [0.3, 1, 0], width: 3}",
                                    "{from: [0, 9, -1], at: [0.5, 0, 0], width: 6}"])
@pytest.mark.parametrize("name", ["plane", "plane, map"])
def test_displaced_orthographic(kage: Kage, name: str, camera: str) -> None:
    scene = write_displaced(kage, name, camera)
    more = ["--surface", "displaced", "--set", "image.background=[0, 0, 9]"]
    kage.good("pov", scene, "-o", "rough.pov", *more)
    kage.good("render", scene, "-o", "rough.exr", "--quiet", *more)
    picture = layers(kage.folder / "rough.exr")
    theirs, words = povray(kage.folder / "rough.pov", (100, 75))
    off = np.abs(np.stack([picture[channel] for channel in "RGB"], axis=-1) - theirs).max(axis=-1)
    assert not words.strip()
    assert theirs[..., 2].max() < 2
    assert (off <= STEP).mean() > PARITY[True]


@needs_povray
@pytest.mark.parametrize("name", ["plane", "plane, map", "plane, noise"])
def test_a_plane_reaches_the_edges_of_the_picture(kage: Kage, name: str) -> None:
    """Where the plane was cut too short the background (blue) would be seen."""
    scene = write_displaced(kage, name, "{from: [0, 2, -3], at: [0.5, 0, 0], up: [0.3, 1, 0], fov: 50}")
    kage.good("pov", scene, "-o", "rough.pov", "--surface", "displaced", "--set", "image.background=[0, 0, 9]")
    picture, _ = povray(kage.folder / "rough.pov", (100, 75))
    assert picture[..., 2].max() < 2


def test_horizon(kage: Kage) -> None:
    """An unbounded plane up to the horizon is a file of a bearable size."""
    scene = write_displaced(kage, "plane, map", "{from: [0, 1.2, -5], at: [0, 1.2, 0], fov: 70}")
    kage("pov", scene, "-o", "rough.pov", "--surface", "displaced")
    assert 1e5 < (kage.folder / "rough.pov").stat().st_size < 4e8


#: The least share of pixels within 1/255 of POV-Ray's, without and with the bumps' own shadows.
PARITY = {False: 0.998, True: 0.995}


@needs_povray
def test_displaced_parity(kage: Kage, capsys: pytest.CaptureFixture[str]) -> None:
    """kage's own true displacement against POV-Ray's."""
    size = (120, 90)
    table, wrong = [f"{'displaced':28} without  with own shadows"], []
    for name in DISPLACED:
        scene, row = write_displaced(kage, name), []
        for self_shadow in (False, True):
            options = ["--surface", "displaced", "--size", "120x90", *([] if self_shadow else ["--no-self-shadow"])]
            kage.good("pov", scene, "-o", "rough.pov", *options)
            kage.good("render", scene, "-o", "rough.exr", "--quiet", *options)
            picture = layers(kage.folder / "rough.exr")
            theirs, words = povray(kage.folder / "rough.pov", size)
            off = np.abs(np.stack([picture[channel] for channel in "RGB"], axis=-1) - theirs).max(axis=-1)
            row.append(float((off <= np.maximum(STEP, np.abs(theirs).max(axis=-1) * 2.0**-10)).mean()))
            if words.strip() or row[-1] < PARITY[self_shadow]:
                wrong.append((name, self_shadow, row[-1], words))
        table.append(f"{name:28} {100 * row[0]:.3f} %  {100 * row[1]:.3f} %")
    with capsys.disabled():
        print("\n" + "\n".join(table))
    assert not wrong


@needs_povray
@pytest.mark.parametrize(("name", "material"), [
    *((name, material) for name in ("plane", "skewed rectangle", "box", "sphere", "rectangle, map") for material in ("mirror", "glass")),
    *((name, "clear") for name in ("torus", "standing torus, thin", *CLOSED)),
])
def test_displaced_secondary(kage: Kage, name: str, material: str) -> None:
    """Rough mirrors, and rough glass: rays that start on a rough surface, and on its far side from within."""
    scene, (shape, bump, _) = write_displaced(kage, name), {**DISPLACED, **CLOSED}[name]
    scene.write_text(SECOND_HEAD.format(camera=CAMERA, lights=LIGHTS, depth=5).replace("[200, 150]", "[100, 75]")
                     + f"  rough:\n    {shape}\n    material: {material}\n    bump: {bump}\n"
                     + "  above: {sphere: {center: [0.4, 2.4, -0.6], radius: 0.3}, material: red}\n"
                     + "  ground: {plane: {origin: [0, -1, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: tiles}\n")
    write_images(kage.folder)
    kage.good("pov", scene, "-o", "rough.pov", "--surface", "displaced")
    kage.good("render", scene, "-o", "rough.exr", "--quiet", "--surface", "displaced")
    picture = layers(kage.folder / "rough.exr")
    theirs, words = povray(kage.folder / "rough.pov", (100, 75))
    off = np.abs(np.stack([picture[channel] for channel in "RGB"], axis=-1) - theirs).max(axis=-1)
    assert not words.strip()
    # where a box's faces do not meet, POV-Ray goes by what a ray was in, and kage by the normal
    assert (off <= STEP).mean() > (PARITY[False] if material != "glass" else 0.99 if name == "box" else 0.995)


@needs_povray
@pytest.mark.parametrize(("shape", "bump"), [
    ("cylinder: {from: [-1, 0.6, 0], to: [1, 0.6, 0], radius: 0.3, open: true}", "0.2*sin(2*u)"),
    ("torus: {center: [0, 0.7, 0], axis: [0.2, 1, -0.3], major: 0.6, minor: 0.3}", "0.1*sin(3*u)*cos(2*w)"),
    ("sphere: {center: [0, 1, 0], radius: 0.5}", "0.2*sin(3*u)*sin(w)^4"),
    ("sphere: {center: [0, 1, 0], radius: 0.5}", "0.05"),
], ids=["cylinder", "torus", "sphere", "level"])
def test_glass_where_angles_turn(kage: Kage, shape: str, bump: str) -> None:
    """Bumps that are large for what they lie on: rays come near to an axis or a middle, where a function of angles is as steep as can be."""
    scene = kage.folder / "rough.yaml"
    scene.write_text(SECOND_HEAD.format(camera=CAMERA, lights=LIGHTS, depth=5).replace("[200, 150]", "[100, 75]") + TILED.replace("[0, 0, 0]", "[0, -1, 0]")
                     + f"  rough:\n    {shape}\n    material: glass\n    bump: {{function: {bump}}}\n")
    write_images(kage.folder)
    kage.good("pov", scene, "-o", "rough.pov", "--surface", "displaced")
    kage.good("render", scene, "-o", "rough.exr", "--quiet", "--surface", "displaced")
    assert "isosurface {" in (kage.folder / "rough.pov").read_text()
    picture = layers(kage.folder / "rough.exr")
    theirs, words = povray(kage.folder / "rough.pov", (100, 75))
    off = np.abs(np.stack([picture[channel] for channel in "RGB"], axis=-1) - theirs).max(axis=-1)
    assert not words.strip()
    assert (off <= STEP).mean() > PARITY[False]


@needs_povray
@pytest.mark.parametrize("lights", [
    "{a: {at: [-0.3, 1, -0.2], parallel: {to: [0, 0, 0]}}}",
    "{a: {at: [-4.5, 5.2, -2.2], area: {u: [2, 0, 0], w: [0, 0, 2], samples: [2, 2]}, spot: {to: [0, 0, 0]}}}",
], ids=["parallel", "area"])
@pytest.mark.parametrize("name", ["plane", "plane, map"])
def test_displaced_lights(kage: Kage, name: str, lights: str) -> None:
    """Lights other than points on rough surfaces, which a mesh must be large enough for."""
    scene = write_displaced(kage, name)
    scene.write_text(scene.read_text().replace(LIGHTS, lights))
    kage.good("pov", scene, "-o", "rough.pov", "--surface", "displaced")
    kage.good("render", scene, "-o", "rough.exr", "--quiet", "--surface", "displaced")
    picture = layers(kage.folder / "rough.exr")
    theirs, words = povray(kage.folder / "rough.pov", (100, 75))
    off = np.abs(np.stack([picture[channel] for channel in "RGB"], axis=-1) - theirs).max(axis=-1)
    assert not words.strip()
    assert (off <= STEP).mean() > PARITY[True]


# ---- the file ----


def test_file(kage: Kage) -> None:
    scene = write_displaced(kage, "plane")
    kage.good("pov", scene, "-o", "a.pov", "--surface", "displaced", "--set", "objects.rough.bump.scale=0.5")
    text = (kage.folder / "a.pov").read_text()
    lines = text.splitlines()
    assert lines[0] == "// rough.yaml, with its bumps truly displaced, for POV-Ray 3.7"
    assert lines[1].startswith("// made by: kage pov rough.yaml --set 'render.surface=displaced'")
    assert str(kage.folder) not in text and "\t" not in text
    assert "#version 3.7;\nglobal_settings { assumed_gamma 1" in text
    assert "#declare P_rough = function(u, w) { 0.5*(0.03*(sin(6*u)*cos(5.4*w) + 0.5*sin(10.2*u + 6.6*w))) }" in text
    assert "#declare Material_clay = texture {" in text
    kage.good("pov", scene, "-o", "b.pov", "--surface", "displaced", "--set", "objects.rough.bump.scale=0.5")
    assert (kage.folder / "b.pov").read_text() == text
    assert kage.files() == {"rough.yaml", "map.png", "a.pov", "b.pov"}


def test_shadows(kage: Kage) -> None:
    scene = write_displaced(kage, "plane")

    def without(*options: str) -> list[bool]:
        kage.good("pov", scene, "-o", "a.pov", *options)
        parts = (kage.folder / "a.pov").read_text().split("// object ")[1:]
        return ["no_shadow" in part for part in parts]

    assert without("--surface", "displaced") == [False, False]
    assert without("--surface", "displaced", "--no-self-shadow") == [True, False]
    assert without("--surface", "displaced", "--no-cast") == [False, True]
    assert without("--surface", "smooth", "--no-self-shadow") == [True, False]
    assert without("--surface", "smooth", "--no-cast") == [False, True]


def test_names(kage: Kage) -> None:
    """POV-Ray has no '-' in names, and two names must not become one."""
    scene = write_displaced(kage, "plane")
    text = scene.read_text().replace("  clay:", "  a-b: {}\n  a_b: {}\n  clay:")
    scene.write_text(text.replace("rough:", "rough-one:").replace("material: shiny", "material: a-b"))
    kage.good("pov", scene, "-o", "a.pov", "--surface", "displaced")
    text = (kage.folder / "a.pov").read_text()
    names = re.findall(r"#declare (\S+) =", text)
    assert len(set(names)) == len(names) == 6 and not any("-" in name for name in names)
    if POVRAY:
        povray(kage.folder / "a.pov", (40, 30))


@pytest.mark.parametrize(
    ("arguments", "message", "status"),
    [
        (["pov", "rough.yaml"], "kage: 'kage pov' lacks -o FILE.pov; see kage --help\n", 2),
        (["pov", "rough.yaml", "-o", "a.png"], "kage: -o a.png: expected a name that ends in .pov\n", 2),
        (["pov", "rough.yaml", "-o", "a.pov", "-o", "b.pov"], "kage: -o b.pov: a second output, expected one\n", 2),
        (["pov", "rough.yaml", "-o", "a.pov", "--surface", "rough"], "kage: --surface rough: expected smooth or displaced\n", 2),
        (["pov", "rough.yaml", "-o", "a.pov", "--aa", "2"], "kage: --aa: no option of 'kage pov'; see kage --help\n", 2),
        (["pov", "-o", "a.pov"], "kage: 'kage pov' lacks a scene; see kage --help\n", 2),
        (["pov", "rough.yaml", "-o", "none/a.pov"], "No such file or directory", 1),
        (["pov", "rough.yaml", "-o", "/dev/full/a.pov"], "Not a directory", 1),
        (["pov", "rough.yaml", "-o", "folder.pov"], "Is a directory", 1),
        (["pov", "none.yaml", "-o", "a.pov"], "none.yaml", 2),
    ],
)
def test_errors(kage: Kage, arguments: list[str], message: str, status: int) -> None:
    write_displaced(kage, "plane")
    (kage.folder / "folder.pov").mkdir()
    before = kage.files()
    done = kage(*arguments)
    assert done.returncode == status and message in done.stderr and not done.stdout
    assert kage.files() == before


def test_without_bounds(kage: Kage) -> None:
    scene = write_displaced(kage, "plane")
    done = kage("pov", scene, "-o", "a.pov", "--surface", "displaced", "--set", "objects.rough.bump.function='0.1*floor(u)'")
    assert done.returncode == 2 and "no bounds" in done.stderr
    assert not (kage.folder / "a.pov").exists()
    kage.good("pov", scene, "-o", "a.pov", "--surface", "smooth", "--set", "objects.rough.bump.function='0.1*floor(u)'")
