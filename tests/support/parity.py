"""Scenes that kage and POV-Ray must show alike, and how alike they are: one list for the tests (test_parity.py) and for
the table in docs/povray.md (scripts/parity.py).

POV-Ray's EXR is half float, and the pictures are compared in linear light.
"""

from __future__ import annotations

import math
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenEXR
from PIL import Image

from reference.references import read_exr
from tests.conftest import PROGRAM, TOP

POVRAY = shutil.which("povray")
STEP = 1 / 255
SIZE = (160, 120)

HEAD = """\
camera: {camera}
image: {{size: [160, 120], background: [0.05, 0.1, 0.2]}}
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
    "ellipsoid": "ellipsoid: {center: [0, 0.8, 0], radii: [1.2, 0.6, 0.8]}",
    "standing torus": "torus: {center: [0, 1, 0], axis: [0.4, 0, 1], major: 0.8, minor: 0.2}",
}
#: Transforms of what is about 1 in size, at the origin.
MOVES = {
    "moved": "[{rotate: [20, 35, -50]}, {scale: 0.8}, {translate: [0.1, 1, 0.2]}]",
    "mirrored": "[{scale: [-0.8, 0.8, 0.8]}, {rotate: [-40, 15, 30]}, {translate: [0.1, 1, 0.2]}]",
    "stretched": "[{scale: [1.3, 0.6, 0.9]}, {rotate: [20, 35, -50]}, {translate: [0.1, 1, 0.2]}]",
    "sheared": "[{rotate: [0, 30, 40]}, {scale: [1.2, 0.7, -0.9]}, {look: {from: [0.1, 1, 0.2], at: [1, 1.5, -2], up: "
               "[0.3, 1, 0]}}]",
}
PLAIN = {
    "sphere": "sphere: {center: [0.1, 0.1, -0.1], radius: 1}",
    "box": "box: {from: [-0.8, -0.6, -0.7], to: [0.7, 0.6, 0.8]}",
    "cylinder": "cylinder: {from: [0.1, -0.8, 0], to: [-0.1, 0.8, 0.1], radius: 0.8}",
    "cone": "cone: {from: [0, -0.8, 0], from_radius: 1, to: [0.1, 0.9, 0.1], to_radius: 0.3}",
    "torus": "torus: {center: [0, 0, 0.1], axis: [0.2, 1, 0.1], major: 0.8, minor: 0.35}",
    "ellipsoid": "ellipsoid: {center: [0.1, 0, -0.1], radii: [1, 0.5, 0.7]}",
    "rectangle": "rectangle: {origin: [-1, 0, -1], u: [2, 0.3, 0], w: [0.2, 0, 2.1]}",
    "disc": "disc: {center: [0.1, 0, 0], normal: [0.2, 1, 0.3], radius: 1}",
}


def moved(name: str, move: str) -> str:
    return f"{PLAIN[name]}\n    transform: {MOVES[move]}"


# ---- smooth ----

#: name: (camera, lights, objects)
SURFACES = {
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
    **{
        f"{material} {name}".replace("clay ", ""): (CAMERA, LIGHTS, f"{FLOOR}  it: {{{shape}, material: {material}}}\n")
        for name, shape in ROUND_ONES.items()
        for material in ("clay", "shiny", "glaze")
    },
}

MOVED = {
    **{
        f"{move} {name}": (CAMERA, LIGHTS, f"{FLOOR}  it:\n    material: shiny\n    {moved(name, move)}\n")
        for name in PLAIN
        for move in MOVES
    },
    "moved plane": (CAMERA, LIGHTS,
                    f"  it:\n    {TILTED[TILTED.index('plane'):TILTED.index(', mat')]}\n    material: glaze\n"
                                    "    transform: [{scale: [2, 1, -1.5]}, {rotate: [0, 30, 5]}, {translate: [0, "
                                    "-0.5, 0]}]\n"),
    "copies": (CAMERA, LIGHTS, f"{FLOOR}  it:\n    material: shiny\n    {moved('torus', 'moved')}\n"
                               "  it2: {copy: it, transform: [{scale: [1, 0.5, 1]}, {translate: [1.4, 0, 0.5]}]}\n"
                               "  it3: {copy: it2, material: clay, transform: [{scale: [-1, 1, 1]}, {translate: [0, 0, "
                               "1]}]}\n"),
}

LIGHTINGS = {
    "three lights": (
        CAMERA,
        "{a: {at: [-4, 5, -2]}, b: {at: [5, 3, -3], color: [0.5, 0.1, 0.1]}, c: {at: [0, 2, 6], color: [0.1, 0.2, "
        "0.7]}}",
        FLOOR + BALL.replace("MATERIAL", "shiny") + SHEET.replace("MATERIAL", "glaze"),
    ),
    "no light": (CAMERA, "{}", FLOOR + BALL.replace("MATERIAL", "shiny")),
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
    "spot fading": (CAMERA, "{a: {at: [-3, 5, -2], spot: {to: [0, 0.5, 0], radius: 5}, fade: {distance: 8, power: "
                            "1.5}}}",
                    FLOOR + SHEET.replace("MATERIAL", "glaze")),
    "area": (CAMERA, "{a: {at: [-3, 5, -2], area: {u: [1.5, 0, 0], w: [0, 0, 1], samples: [4, 4]}}}",
             FLOOR + BALL.replace("MATERIAL", "shiny")),
    "area uneven": (CAMERA, "{a: {at: [-3, 5, -2], area: {u: [1.5, 0.2, 0], w: [0, 0.3, 1], samples: [5, 3]}}}",
                    FLOOR + BOX.replace("MATERIAL", "clay")),
    "area row, spot": (CAMERA, "{a: {at: [-3, 5, -2], spot: {to: [0, 0, 0]}, area: {u: [2, 0, 0], w: [0, 0, 1], "
                               "samples: [6, 1]}}}",
                       FLOOR + BOX.replace("MATERIAL", "glaze") + SHEET.replace("MATERIAL", "clay")),
}

CAMERAS = {
    "up tilted": (
        "{from: [2, 2.9, -4], at: [0, 0.5, 0], up: [0.4, 1, -0.3], fov: 45}", LIGHTS,
        FLOOR + BOX.replace("MATERIAL", "shiny"),
    ),
    "aim off-centre": ("{from: [-1, 1.5, -4], at: [1.5, 0.2, 1], fov: 60}", LIGHTS,
                       FLOOR + BALL.replace("MATERIAL", "glaze")),
    "straight down": ("{from: [0, 6, 0], at: [0, 0, 0], up: [1, 0, 1]}", LIGHTS,
                      FLOOR + BOX.replace("MATERIAL", "clay")),
    "fov 10": ("{from: [3, 9, -20], at: [0, 0.7, 0], fov: 10}", LIGHTS, FLOOR + BALL.replace("MATERIAL", "shiny")),
    "fov 120": ("{from: [0.3, 1.9, -2], at: [0, 0.5, 0], fov: 120}", LIGHTS, FLOOR + BOX.replace("MATERIAL", "glaze")),
    "orthographic": ("{from: [0.3, 2.9, -5.2], at: [0, 0.5, 0], width: 4}", LIGHTS,
                     FLOOR + BALL.replace("MATERIAL", "shiny")),
    "orthographic, tilted": ("{from: [2, 2.9, -4], at: [0, 0.5, 0], up: [0.4, 1, -0.3], width: 6}", LIGHTS,
                             FLOOR + BOX.replace("MATERIAL", "glaze")),
    "orthographic, straight down": ("{from: [0, 6, 0], at: [0, 0, 0], up: [1, 0, 1], width: 5}", LIGHTS,
                                    FLOOR + SHEET.replace("MATERIAL", "shiny")),
    "orthographic, cut": ("{from: [0, 0.4, -1.2], at: [0, 0, 0.1], width: 5}", LIGHTS,
                          FLOOR + BOX.replace("MATERIAL", "shiny")),
    "horizon": ("{from: [0, 1.2, -5], at: [0, 1.2, 0], fov: 70}", LIGHTS, FLOOR + BALL.replace("MATERIAL", "clay")),
    "from below": ("{from: [0, -2, -4], at: [0, 0, 0], fov: 50}", "{a: {at: [1, -6, -3]}}",
                   FLOOR + BALL.replace("MATERIAL", "clay")),
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
    "eye within": ("{from: [0, 1.1, 0], at: [0.3, 0.4, 1], fov: 90}", "{a: {at: [0.2, 1.4, 0.1]}}",
                   BOX.replace("MATERIAL", "shiny")),
}

# ---- mirrors, glass and coloured shadows ----

SECOND_HEAD = """\
camera: {camera}
image: {{size: [160, 120], background: [0.1, 0.25, 0.5]}}
render: {{depth: {depth}}}
lights: {lights}
materials:
  clay: {{color: [0.82, 0.72, 0.58], ambient: 0.12, diffuse: 0.8}}
  red: {{color: [0.9, 0.2, 0.1], ambient: 0.2, diffuse: 0.7, phong: 0.5}}
  tiles: {{color: {{checker: {{even: [0.9, 0.85, 0.7], odd: [0.1, 0.2, 0.3], size: [0.5, 0.5]}}}},
    ambient: 0.2, diffuse: 0.7}}
  mirror: {{color: [0.5, 0.5, 0.5], ambient: 0.05, diffuse: 0.1, reflection: 0.8}}
  gold: {{color: [0.5, 0.4, 0.1], ambient: 0.1, diffuse: 0.3, specular: 0.6, roughness: 0.02,
    reflection: [0.8, 0.6, 0.2]}}
  glass: {{color: [0.9, 1, 0.95], ambient: 0, diffuse: 0.05, phong: 0.7, phong_size: 60, reflection: 0.1,
    filter: 0.9, ior: 1.5}}
  clear: {{ambient: 0, diffuse: 0, transmit: 1, ior: 1.5}}
  pane: {{color: [0.9, 0.3, 0.1], ambient: 0.1, diffuse: 0.4, phong: 0.4, filter: 0.6, transmit: 0.2}}
  stained: {{color: {{checker: {{even: [0.9, 0.1, 0.1], odd: [0.1, 0.3, 0.9], size: [0.25, 0.2]}}}},
    ambient: 0.1, filter: 0.7, transmit: 0.1, ior: 1.2}}
  printed: {{color: {{image: {{file: color.png}}}}, ambient: 0.1, filter: 0.5, transmit: 0.3}}
  water: {{color: [0.6, 0.8, 1], ambient: 0, diffuse: 0.1, reflection: 0.2, filter: 0.5, transmit: 0.4, ior: 1.33}}
  air: {{ambient: 0, diffuse: 0, transmit: 1, reflection: 0.1, ior: 1}}
objects:
"""
TILED = "  floor: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: tiles}\n"
BACK = "  back: {rectangle: {origin: [-3, 3, 2], u: [6, 0, 0.5], w: [0, -3, 0]}, material: mirror}\n"
SIDE = "  side: {sphere: {center: [1.2, 0.5, 0.6], radius: 0.5}, material: red}\n"
COLORED = "{lamp: {at: [-4.5, 5.2, -2.2], color: [1.1, 1.08, 1]}, " \
          "area: {at: [2, 4, -3], color: [0.3, 0.4, 0.6], area: {u: [1, 0, 0], w: [0, 0, 1], samples: [4, 4]}}}"

#: name: (camera, lights, depth, objects)
SECONDARY = {
    "mirror plane": (CAMERA, LIGHTS, 5, FLOOR.replace("clay", "mirror") + BALL.replace("MATERIAL", "red")),
    "mirror sphere": (CAMERA, LIGHTS, 5, TILED + BALL.replace("MATERIAL", "mirror") + SIDE),
    "mirror box, gold": (CAMERA, COLORED, 5, TILED + BOX.replace("MATERIAL", "gold") + SIDE),
    **{f"mirror in mirror, depth {depth}": (CAMERA, LIGHTS, depth,
                                            TILED + BALL.replace("MATERIAL", "gold") + BACK + SIDE)
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
        f"  pane{k}: "
        f"{{rectangle: {{origin: [{-1 + 0.1 * k}, 2, {0.3 * k}], u: [1.5, 0, 0], w: [0, -1.5, 0.2]}}, "
        "material: pane}\n"
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
    "eye in glass": ("{from: [0, 1.1, 0], at: [0.3, 0.4, 1], fov: 90}", LIGHTS, 5,
                     TILED + BALL.replace("MATERIAL", "clear") + SIDE),
    "orthographic glass": ("{from: [0.3, 2.9, -5.2], at: [0, 0.5, 0], width: 4}", LIGHTS, 5,
                           TILED + BALL.replace("MATERIAL", "glass") + SIDE),
    "spot through a pane": (CAMERA, "{a: {at: [-3, 5, -2], spot: {to: [0, 0.5, 0]}, fade: {distance: 6}}}", 5,
                            TILED + SHEET.replace("MATERIAL", "stained") + SIDE),
    **{f"{material} {name}": (CAMERA, LIGHTS, 6, f"{TILED}{SIDE}  it: {{{ROUND_ONES[name]}, material: {material}}}\n")
       for material, name in (("mirror", "torus"), ("glass", "torus"), ("clear", "standing torus"),
                              ("glass", "cylinder"), ("glass", "ellipsoid"),
                              ("pane", "open cylinder"), ("mirror", "cone"), ("clear", "pointed cone"),
                              ("gold", "open cone"),
                              ("mirror", "disc"), ("pane", "disc"), ("stained", "cylinder"), ("printed", "torus"))},
    **{f"{material} {name}, {move}": (CAMERA, LIGHTS, 7,
                                      f"{TILED}{SIDE}  it:\n    material: {material}\n    {moved(name, move)}\n")
       for material, name, move in (("glass", "box", "sheared"), ("glass", "sphere", "stretched"),
                                    ("clear", "cylinder", "mirrored"),
                                    ("mirror", "torus", "moved"))},
    "glass copies": (CAMERA, COLORED, 7, f"{TILED}{SIDE}  it:\n    material: glass\n    {moved('box', 'moved')}\n"
                     "  it2: {copy: it, material: mirror, transform: [{scale: [1, 0.5, 1]}, {translate: [1.4, 0, "
                     "0.5]}]}\n"
                     "  it3: {copy: it, transform: [{scale: [-0.6, 1, 1]}, {translate: [-1.6, 0, 0.5]}]}\n"),
    "parallel through glass": (CAMERA, "{a: {at: [-3, 5, -2], parallel: {to: [0, 0, 0]}}}", 5,
                               TILED + BALL.replace("MATERIAL", "glass") + SIDE),
}

# ---- colours ----

#: name: (colour, object)
SPHERE = "sphere: {center: [0.1, 1, 0], radius: 1}"
COLORS = {
    "checker plane": ("{checker: {even: [0.9, 0.8, 0.7], odd: [0.1, 0.2, 0.4], size: [0.7, 0.4], offset: [0.1, 0.05]}}",
                      "plane: {origin: [0, 0, 0], u: [2, 0.1, 0.3], w: [0.4, 0.2, -3]}"),
    "checker rectangle": ("{checker: {even: [0.9, 0.8, 0.7], odd: [0.1, 0.2, 0.4], size: [0.25, 0.2]}}",
                          "rectangle: {origin: [-1, 0.5, 0.2], u: [2, 0.4, 0.3], w: [0.5, 1.2, 0.4]}"),
    "checker box": ("{checker: {even: [0.9, 0.8, 0.7], odd: [0.1, 0.2, 0.4], size: [0.3, 0.5]}}",
                    "box: {from: [-0.6, 0.55, -0.6], to: [0.6, 1.75, 0.6]}"),
    "checker sphere": ("{checker: {even: [0.9, 0.8, 0.7], odd: [0.1, 0.2, 0.4], size: [0.5, 0.3], offset: [0.1, 0]}}",
                       SPHERE),
    "image plane": ("{image: {file: color.png, size: [0.8, 1.1], offset: [0.3, 0.2]}}",
                    "plane: {origin: [0, 0, 0], u: [2, 0.1, 0.3], w: [0.4, 0.2, -3]}"),
    "image rectangle, nearest": ("{image: {file: color.png, interpolation: nearest, wrap: clamp}}",
                                 "rectangle: {origin: [-1, 2.1, 0.2], u: [2, 0.4, 0.3], w: [0.5, -1.2, 0.4]}"),
    "image box": ("{image: {file: color.png, repeat: [2, 1]}}",
                  "box: {from: [-0.6, 0.55, -0.6], to: [0.6, 1.75, 0.6]}"),
    "image sphere": ("{image: {file: color.png}}", SPHERE),
    "image sphere, a seam": ("{image: {file: color.png, size: [2.5, 2], offset: [0.4, 0.3]}}", SPHERE),
    "image, 16 bits, grey": ("{image: {file: grey.png, size: [2, 2]}}",
                             "plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}"),
    "image, linear": ("{image: {file: color.png, encoding: linear, size: [2, 2]}}",
                      "plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}"),
    "image, palette": ("{image: {file: palette.png, size: [2, 2], interpolation: nearest}}",
                       "plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}"),
    "image, EXR": ("{image: {file: color.exr, size: [2, 2]}}",
                   "plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}"),
    **{f"{pattern} {name}": (color, ROUND_ONES[name])
       for pattern, color in (("checker",
                               "{checker: {even: [0.9, 0.8, 0.7], odd: [0.1, 0.2, 0.4], size: [0.5, 0.3], offset: "
                               "[0.1, 0.2]}}"),
                              ("image", "{image: {file: color.png}}"))
       for name in ("disc", "cylinder", "open cylinder", "cone", "pointed cone", "torus")},
    **{f"image, a seam, {name}": ("{image: {file: color.png, size: [2.5, 0.7], offset: [0.4, 0.3]}}", ROUND_ONES[name])
       for name in ("lying cylinder", "open cone", "standing torus")},
    **{f"{pattern} {name}, {move}": (color, moved(name, move))
       for pattern, name, move, color in (
           ("checker", "sphere", "mirrored",
            "{checker: {even: [0.9, 0.8, 0.7], odd: [0.1, 0.2, 0.4], size: [0.5, 0.3], offset: [0.1, 0]}}"),
           ("image", "sphere", "sheared", "{image: {file: color.png, size: [2.5, 2], offset: [0.4, 0.3]}}"),
           ("image", "cylinder", "mirrored", "{image: {file: color.png, size: [2.5, 0.5], offset: [0.4, 0.3]}}"),
           ("checker", "cone", "stretched",
            "{checker: {even: [0.9, 0.8, 0.7], odd: [0.1, 0.2, 0.4], size: [0.5, 0.3]}}"),
           ("image", "torus", "moved", "{image: {file: color.png, repeat: [3, 2]}}"),
           ("image", "box", "sheared", "{image: {file: color.png}}"))},
}

# ---- displaced ----

FUNCTION = "{function: '0.03*(sin(6*u)*cos(5.4*w) + 0.5*sin(10.2*u + 6.6*w))'}"
NOISE = "{function: '0.05*noise(2*u, 2*w)'}"
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
    "terraces": (SKEWED, "{function: '0.03*(smoothstep(0.25, 0.15, abs(u - 0.5)) + smoothstep(0, 0.2, w - 0.3*u))'}",
                 "isosurface"),
    "box": (CUBE, "{function: '0.04*sin(12*u)*sin(10*w)'}", "isosurface"),
    "sphere": (GLOBE, ROUND, "isosurface"),
    "sphere, steep at its poles": (GLOBE, "{function: '0.04*sin(8*u)*sin(6*w)'}", "isosurface"),
    "sphere, torn at its poles": (GLOBE, "{function: '0.02*sin(4*u)'}", "mesh2"),
    "plane, noise": (PLANE, NOISE, "mesh2"),
    "plane, map": (PLANE, MAP, "mesh2"),
    "rectangle, map": (SKEWED, MAP.replace("[2, 2]", "[0.5, 0.4]"), "mesh2"),
    "box, map": (CUBE, MAP.replace("[2, 2]", "[1, 1]"), "mesh2"),
    "sphere, map": (GLOBE, MAP.replace("[2, 2]", "[0.8, 0.7]"), "mesh2"),
    "disc": (ROUND_ONES["disc"], WAVES, "isosurface"),
    "cylinder": (ROUND_ONES["cylinder"], WAVES, "isosurface"),
    "open cylinder": (ROUND_ONES["open cylinder"], WAVES, "isosurface"),
    "pointed cone": (ROUND_ONES["pointed cone"], WAVES.replace("sin(7*w)", "sin(7*w)*min(w, 1)"), "mesh2"),
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
    "moved plane": (f"{PLANE}\n    transform: [{{scale: [2, 1, -1.5]}}, {{rotate: [0, 30, 5]}}, "
                    f"{{translate: [0, -0.2, 0]}}]", FUNCTION,
                    "isosurface"),
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

#: What is rough has a colour of its own: name in COLORS, bump.
ROUGH_COLORS = (
    *((name, "{function: '0.05*sin(8*u)*sin(8*w)*sin(w)^2'}") for name in
      ("checker plane", "checker box", "image box", "image sphere, a seam", "checker cylinder", "image cylinder",
       "image torus",
       "checker torus")),
    *((name, "{function: '0.05*sin(5*u)^2*sin(w)^2 + 0*noise(u,w)'}")
      for name in ("image rectangle, nearest", "image sphere, a seam")),
    *((name, WAVES) for name in ("checker cone", "image, a seam, open cone")),
)

# ---- surfaces by their points alone ----

POT = TOP / "scenes" / "data" / "teapot.txt"
SHEETS = {
    "waves": 'parametric: {x: "u", y: "1 + 0.2*sin(3*u)*cos(2*w)", z: "w", u: [-1, 1], w: [-pi/3, pi/3]}',
    "moebius": 'parametric: {x: "(1 + w*cos(u/2))*cos(u)", y: "0.9 + w*sin(u/2)", z: "(1 + w*cos(u/2))*sin(u)", u: [0, '
               '2*pi], w: [-0.4, 0.4]}',
    "shell": 'parametric: {x: "0.3*exp(0.09*u)*(1.2 + cos(w))*cos(u)", y: "1.9 - 0.3*exp(0.09*u)*(1.7 + sin(w))", '
             'z: "0.3*exp(0.09*u)*(1.2 + cos(w))*sin(u)", u: [-pi, pi], w: [-pi, 0.5]}',
    "saddle": "patches: {points: [[" + ", ".join(f"[{0.8 * i - 1.2}, {1 + 0.5 * (i % 3 == 0) - 0.6 * (j % 3 == 0)}, "
                                                 f"{0.8 * j - 1.2}]"
                                                for j in range(4) for i in range(4)) + "]]}",
    "spout": "patches: {file: spout.txt}\n    transform: [{scale: 0.9}, {rotate: [0, 20, 0]}, {translate: [-2.2, -0.4, "
             "0.6]}]",
    "teapot": f"patches: {{file: {POT}}}\n    transform: [{{scale: 0.5}}, {{rotate: [0, 20, 0]}}]",
}
# about the origin, for MOVES
TABLE = "parametric: {x: \"u\", y: \"0.2*sin(3*u + 1)*cos(2*w)\", z: \"w\", u: [-1, 1], w: [-1, 1]}"
PARALLEL = "{a: {at: [-3, 5, -2], parallel: {to: [0, 0, 0]}}}"
SPOT = "{a: {at: [-3, 5, -2], spot: {to: [0, 0.5, 0]}, fade: {distance: 7}}}"
AREA = "{a: {at: [-3, 5, -2], area: {u: [1.5, 0, 0], w: [0, 0, 1], samples: [3, 3]}}}"

#: name: (sheet, material, lights, camera), on a floor
SHEETS_SMOOTH = {
    **{f"{material} {name}": (SHEETS[name], material, LIGHTS, CAMERA)
       for material, name in (("clay", "waves"), ("glaze", "moebius"), ("shiny", "shell"), ("glaze", "saddle"),
                              ("shiny", "teapot"))},
    "waves, area light": (SHEETS["waves"], "shiny", AREA, CAMERA),
    "moebius, spot": (SHEETS["moebius"], "clay", SPOT, CAMERA),
    "saddle, parallel": (SHEETS["saddle"], "shiny", PARALLEL, CAMERA),
    "shell, no light": (SHEETS["shell"], "clay", "{}", CAMERA),
    "moebius, orthographic": (SHEETS["moebius"], "glaze", LIGHTS,
                              "{from: [0.3, 2.9, -5.2], at: [0, 0.5, 0], width: 4}"),
    "shell, from within": (SHEETS["shell"], "shiny", "{a: {at: [-0.6, 1, 0.2]}}",
                           "{from: [0.05, 1.2, 0], at: [0.8, 0.6, 0.4], fov: 90}"),
    **{f"waves, {move}": (f"{TABLE}\n    transform: {MOVES[move]}", "shiny", LIGHTS, CAMERA) for move in MOVES},
    "saddle, mirrored": (SHEETS["saddle"] + "\n    transform: [{scale: [-1, 0.7, 1]}, {rotate: [0, 30, 0]}]", "glaze",
                         LIGHTS, CAMERA),
    "waves, copies": (
        SHEETS["waves"] + "\n    material: shiny\n"
        "  it2: {copy: it, transform: [{scale: [0.5, 0.5, -0.5]}, {translate: [0.9, 0.1, -1]}]}\n"
        "  it3:\n    copy: it2\n    transform: [{scale: [-1, 1, 1]}, {translate: [0, 0.3, 0]}]", "clay", LIGHTS,
        CAMERA),
}

CHECKER = "{checker: {even: [0.9, 0.8, 0.7], odd: [0.1, 0.2, 0.4], size: [0.25, 0.2]}}"
#: name: (colour, sheet)
SHEETS_COLORS = {
    "checker waves": (CHECKER, SHEETS["waves"]),
    "image waves": ("{image: {file: color.png}}", SHEETS["waves"]),
    "checker ellipsoid": (CHECKER.replace("0.25, 0.2", "0.5, 0.4"), ROUND_ONES["ellipsoid"]),
    "image moebius": ("{image: {file: color.png, size: [2.5, 0.7], offset: [0.4, 0.3]}}", SHEETS["moebius"]),
    "checker shell": (CHECKER.replace("0.25, 0.2", "0.5, 0.4"), SHEETS["shell"]),
    "image saddle, nearest": ("{image: {file: color.png, interpolation: nearest, wrap: clamp}}", SHEETS["saddle"]),
    "checker spout": (CHECKER, SHEETS["spout"]),
    "image waves, sheared": ("{image: {file: color.png, repeat: [2, 1]}}",
                             f"{TABLE}\n    transform: {MOVES['sheared']}"),
}

#: name: (sheet, material), over a tiled floor
SHEETS_SECONDARY = {
    f"{material} {name}": (SHEETS[name], material)
    for material, name in (("mirror", "spout"), ("gold", "waves"), ("pane", "shell"), ("stained", "moebius"),
                           ("glass", "saddle"),
                           ("pane", "spout"), ("printed", "waves"), ("mirror", "moebius"))
}

#: name: (sheet, bump)
SHEETS_DISPLACED = {
    "waves": (SHEETS["waves"], "{function: '0.02*sin(9*u)*sin(9*w)'}"),
    "waves, map": (SHEETS["waves"], MAP.replace("[2, 2]", "[1, 1]").replace("0.1", "0.05")),
    "waves, mirrored": (f"{TABLE}\n    transform: {MOVES['mirrored']}", "{function: '0.02*sin(9*u + 1)*sin(9*w)'}"),
    "moebius": (SHEETS["moebius"], "{function: '0.02*sin(9*u)*sin(9*w)'}"),
    "saddle": (SHEETS["saddle"], "{function: '0.03*sin(18*u)*sin(18*w)'}"),
    "stretched sphere": (moved("sphere", "stretched"), ROUND),
    "ellipsoid": (ROUND_ONES["ellipsoid"], ROUND),
    "moved ellipsoid": (moved("ellipsoid", "moved"), ROUND),
    "sheared torus": (moved("torus", "sheared"), WAVES),
    "stretched open cone": ("cone: {from: [0, -0.8, 0], from_radius: 1, to: [0.1, 0.9, 0.1], to_radius: 0.3, open: "
                            "true}\n"
                            f"    transform: {MOVES['stretched']}", WAVES),
    # 0 where they join
    "teapot": (f"patches: {{file: {POT}}}\n    transform: [{{scale: 0.4}}]",
               "{function: '0.02*sin(3*pi*u)*sin(3*pi*w)'}"),
}

ROUGH = ("plane", "skewed rectangle", "box", "sphere", "rectangle, map")
#: P is 0 at the edges, so that nothing is open between the parts.
CLOSED = {
    "closed box": (CUBE, "{function: '0.64*sin(12*u)*sin(10*w)*u*(1-u)*w*(1-w)'}", "isosurface"),
    "closed cylinder": ("cylinder: {from: [0.1, 0.1, 0], to: [0.1, 1.6, 0], radius: 0.8}",
                        "{function: '0.07*sin(8*u)*sin(7*w)*w*(1.5-w)*(0.64-u^2-w^2)/(0.64+u^2+w^2)'}", "isosurface"),
}
#: Bumps that are large for what they lie on: rays come near to an axis or a middle, where a function of angles is as
#: steep as can be.
TURNING = {
    "cylinder, high": ("cylinder: {from: [-1, 0.6, 0], to: [1, 0.6, 0], radius: 0.3, open: true}",
                       "{function: '0.2*sin(2*u)'}"),
    "torus, high": ("torus: {center: [0, 0.7, 0], axis: [0.2, 1, -0.3], major: 0.6, minor: 0.3}",
                    "{function: '0.1*sin(3*u)*cos(2*w)'}"),
    "sphere, high": ("sphere: {center: [0, 1, 0], radius: 0.5}", "{function: '0.2*sin(3*u)*sin(w)^4'}"),
    "sphere, level": ("sphere: {center: [0, 1, 0], radius: 0.5}", "{function: '0.05'}"),
}

# ---- all of them ----


@dataclass(frozen=True)
class Scene:
    row: str  # in the table: the surface, or what else it is about
    column: str
    name: str
    text: str
    size: tuple[int, int] = SIZE
    options: tuple[str, ...] = ("--surface", "smooth")
    least: float = 0.999  # of the pixels, within 1/255
    plain: bool = False  # what differs lies on edges of objects and shadows alone
    shape: str = ""  # what POV-Ray is given

    def __str__(self) -> str:
        return f"{self.column}: {self.name}"


COLUMNS = ("smooth", "colours", "mirror, glass", "displaced", "own shadows")
ROWS = ("plane", "rectangle", "disc", "box", "sphere", "cylinder", "cone", "torus", "ellipsoid", "parametric",
        "patches", "moved, copied", "lights", "cameras")


def surface_in(text: str) -> str:
    """The last surface that an object's text has: what the scene is about comes after the floor."""
    return max((kind for kind in ROWS[:11] if f"{kind}:" in text), key=lambda kind: text.rindex(f"{kind}:"))


def plain(row: str, name: str, camera: str, lights: str, objects: str) -> Scene:
    return Scene(row or surface_in(objects), "smooth", name, HEAD.format(camera=camera, lights=lights) + objects,
                 plain=True)


def smooth_ones() -> Iterator[Scene]:
    for row, scenes in (("", SURFACES), ("moved, copied", MOVED), ("lights", LIGHTINGS), ("cameras", CAMERAS)):
        for name, (camera, lights, objects) in scenes.items():
            yield plain(row, name, camera, lights, objects)
    for name, (sheet, material, lights, camera) in SHEETS_SMOOTH.items():
        yield plain("", name, camera, lights, f"{FLOOR}  it:\n    {sheet}\n    material: {material}\n")


def colored(color: str, shape: str, more: str = "") -> str:
    own = f"  own: {{color: {color}, ambient: 0.2, phong: 0.3}}\nobjects:\n"
    head = HEAD.format(camera=CAMERA, lights=LIGHTS).replace("objects:\n", own)
    return (head + f"  it:\n    {shape}\n    material: own\n{more}"
            + "  above: {sphere: {center: [-0.9, 2.3, -1], radius: 0.25}, material: shiny}\n")


def colored_ones() -> Iterator[Scene]:
    for name, (color, shape) in {**COLORS, **SHEETS_COLORS}.items():
        yield Scene(surface_in(shape), "colours", name, colored(color, shape))
    for name, bump in ROUGH_COLORS:
        mesh = "noise" in bump or "cone" in name
        yield Scene(surface_in(COLORS[name][1]), "own shadows", f"{name}, {'mesh' if mesh else 'isosurface'}",
                    colored(*COLORS[name], f"    bump: {bump}\n"), (100, 75), ("--surface", "displaced"), 0.995,
                    shape="mesh2" if mesh else "isosurface")
    for name in ("checker waves", "image saddle, nearest"):
        color, shape = SHEETS_COLORS[name]
        bump = "    bump: {function: '0.02*sin(9*u)*sin(9*w)'}\n"
        yield Scene(surface_in(shape), "own shadows", name, colored(color, shape, bump), (80, 60),
                    ("--surface", "displaced"), 0.995, shape="mesh2")


def secondary_ones() -> Iterator[Scene]:
    for name, (camera, lights, depth, objects) in SECONDARY.items():
        if "spot" in name or "parallel" in name:
            row = "lights"
        elif "eye" in name or "orthographic" in name:
            row = "cameras"
        else:
            row = "moved, copied" if "transform" in objects else surface_in(objects.replace(SIDE, ""))
        yield Scene(row, "mirror, glass", name, SECOND_HEAD.format(camera=camera, lights=lights, depth=depth) + objects)
    for name, (sheet, material) in SHEETS_SECONDARY.items():
        yield Scene(surface_in(sheet), "mirror, glass", name, SECOND_HEAD.format(camera=CAMERA, lights=COLORED, depth=5)
                    + f"{TILED}{SIDE}  it:\n    {sheet}\n    material: {material}\n")


ABOVE = "  above: {sphere: {center: [0.4, 2.4, -0.6], radius: 0.3}, material: %s}\n"


def displaced(name: str, camera: str = CAMERA, lights: str = LIGHTS) -> str:
    shape, bump, _ = DISPLACED[name]
    return (HEAD.format(camera=camera, lights=lights).replace("[160, 120]", "[100, 75]")
            + f"  rough:\n    {shape}\n    material: clay\n    bump: {bump}\n" + ABOVE % "shiny")


def rough_second(shape: str, bump: str, material: str, more: str = "") -> str:
    return (SECOND_HEAD.format(camera=CAMERA, lights=LIGHTS,
                               depth=5) + f"  rough:\n    {shape}\n    material: {material}\n    bump: {bump}\n" + more
            + "  ground: {plane: {origin: [0, -1, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: tiles}\n")


def displaced_ones() -> Iterator[Scene]:
    for name, (shape, _, made) in DISPLACED.items():
        row = "moved, copied" if "transform" in shape else surface_in(shape)
        size = (60, 45) if name == "plane, noise" else (100, 75)  # that mesh is large
        for column, least in (("displaced", 0.998), ("own shadows", 0.995)):
            # a mesh without them shows nothing more
            if column == "own shadows" or made == "isosurface" or name == "plane, map":
                yield Scene(row, column, name, displaced(name), size,
                            ("--surface", "displaced", *(["--no-self-shadow"] if column == "displaced" else [])), least,
                            shape=made)
    for name, (shape, bump) in SHEETS_DISPLACED.items():
        size = (48, 36) if name in ("stretched sphere", "ellipsoid", "moved ellipsoid") else (80, 60)  # that is slow
        yield Scene(surface_in(shape), "own shadows", name, HEAD.format(camera=CAMERA, lights=LIGHTS)
                    + f"{FLOOR}  rough:\n    {shape}\n    material: shiny\n    bump: {bump}\n", size,
                    ("--surface", "displaced"), 0.995,
                    shape="mesh2")
    for name in ("plane", "plane, map"):
        for light, lights in (("parallel", "{a: {at: [-0.3, 1, -0.2], parallel: {to: [0, 0, 0]}}}"),
                              ("area", "{a: {at: [-4.5, 5.2, -2.2], area: {u: [2, 0, 0], w: [0, 0, 2], samples: [2, "
                                       "2]}, spot: {to: [0, 0, 0]}}}")):
            yield Scene("lights", "own shadows", f"{name}, {light}", displaced(name, lights=lights), (100, 75),
                        ("--surface", "displaced"), 0.995)
        for camera in ("{from: [0, 2, -3], at: [0.5, 0, 0], up: [0.3, 1, 0], width: 3}",
                       "{from: [0, 9, -1], at: [0.5, 0, 0], width: 6}"):
            yield Scene("cameras", "own shadows", f"{name}, orthographic {camera[-2]}", displaced(name, camera),
                        (100, 75),
                        ("--surface", "displaced"), 0.995)
    for material, names, least in (("mirror", ROUGH, 0.998), ("glass", ROUGH, 0.995),
                                   ("clear", ("torus", "standing torus, thin", *CLOSED), 0.998)):
        for name in names:
            shape, bump, _ = {**DISPLACED, **CLOSED}[name]
            yield Scene(surface_in(shape), "own shadows", f"{material} {name}",
                        rough_second(shape, bump, material, ABOVE % "red"), (100, 75),
                        ("--surface", "displaced"), least)
    for name, (shape, bump) in TURNING.items():
        yield Scene(surface_in(shape), "own shadows", f"glass, {name}", rough_second(shape, bump, "glass"), (100, 75),
                    ("--surface", "displaced"),
                    0.998, shape="isosurface")


SCENES = (*smooth_ones(), *colored_ones(), *secondary_ones(), *displaced_ones())

# ---- comparing ----


def write_images(folder: Path) -> None:
    """What the scenes' colours, bumps and patches are read from."""
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
    x, y = np.meshgrid(np.arange(16), np.arange(16))
    heights = 32768 + 20000 * np.sin(x * math.pi / 4) * np.cos(y * math.pi / 8)
    Image.fromarray(heights.astype(np.uint16)).save(folder / "map.png")
    pot = POT.read_text()
    (folder / "spout.txt").write_text(pot[pot.index("# lower spout"):])


def povray(scene: Path, size: tuple[int, int] = SIZE, *options: str) -> tuple[np.ndarray, str]:
    """The picture, and all warnings."""
    assert POVRAY, "povray is not there"
    out, words = scene.with_suffix(".pov.exr"), scene.with_suffix(".words")
    done = subprocess.run(
        [POVRAY, f"+I{scene.name}", f"+O{out.name}", "+FE", f"+W{size[0]}", f"+H{size[1]}", "-D", "-A", "+WT1", "-V",
         f"+GW{words.name}", *options],
        cwd=scene.parent, capture_output=True, text=True, timeout=600,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return rgb(read_exr(out)), ADVICE.sub("", words.read_text()) if words.exists() else ""


#: A bound can be above what one picture has met of it: this advice is none to follow, and no warning.
ADVICE = re.compile(r"(File: \S+\s+Line: \d+\s*)?Shutdown Warning: The maximum gradient found "
                    r"was[^!]*?faster\s+rendering\s+of\s+the\s+isosurface\.\s*")


def layers(path: Path) -> dict[str, np.ndarray]:
    return {name: plane.astype(float) for name, plane in read_exr(path).items()}


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


def borders(picture: dict[str, np.ndarray]) -> np.ndarray:
    """Within one pixel of silhouettes, of the edges between objects and faces, and of shadows."""
    found = edges(picture["Z"] < 1e6)
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


def rgb(picture: dict[str, np.ndarray]) -> np.ndarray:
    return np.stack([picture[channel] for channel in "RGB"], axis=-1).astype(float)


def difference(ours: np.ndarray, theirs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Each pixel's, in its worst channel; and whether it is more than 1/255. Half float has 11 bits: above 2 its own
    step counts."""
    off = np.abs(ours - theirs).max(axis=-1)
    return off, off > np.maximum(STEP, np.abs(theirs).max(axis=-1) * 2.0**-10)


@dataclass(frozen=True)
class Found:
    share: float  # of the pixels, within 1/255
    mean: float  # difference
    worst: float
    stray: int  # pixels beyond 1/255 that are on no edge
    contrast: float  # of the picture: something is to be seen
    warnings: str
    export: str  # how the export begins, without its meshes


def compare(folder: Path, scene: Scene) -> Found:
    """`folder` has the images, and gets nothing that stays."""
    here = Path(tempfile.mkdtemp(dir=folder))
    for image in folder.iterdir():
        if image.is_file():
            (here / image.name).symlink_to(image)
    (here / "scene.yaml").write_text(scene.text)
    size = "x".join(map(str, scene.size))
    for command in (["pov", "scene.yaml", "-o", "scene.pov"], ["render", "scene.yaml", "-o", "scene.exr", "--quiet"]):
        subprocess.run([PROGRAM, *command, *scene.options, "--size", size], cwd=here, check=True, timeout=300)
    picture = layers(here / "scene.exr")
    theirs, warnings = povray(here / "scene.pov", scene.size)
    off, bad = difference(rgb(picture), theirs)
    with (here / "scene.pov").open() as file:
        export = "".join(line for line in file if line[0] not in ",<")
    shutil.rmtree(here)
    return Found(1 - float(bad.mean()), float(off.mean()), float(off.max()), int((bad & ~borders(picture)).sum()),
                 float(theirs.std()),
                 warnings.strip(), export)


def compare_all(folder: Path, scenes: Iterable[Scene]) -> dict[Scene, Future[Found]]:
    """Some at a time: POV-Ray sleeps for most of a small picture's time."""
    write_images(folder)
    pool = ThreadPoolExecutor(4)
    return {scene: pool.submit(compare, folder, scene) for scene in scenes}
