"""Bad input: what the program says of it, where, and that it says nothing else.

Most cases replace one part of conftest.SCENE; the message must be the first line on stderr, exactly, and the line and
the caret below it must be those of the place it names.
"""

from __future__ import annotations

import itertools
import re
import struct
import subprocess
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from PIL import Image

from tests.conftest import PROGRAM, SCENE, TOP, Kage

BALL = "sphere: {center: [1, 1, 0], radius: 0.5}"

#: What replaces what in the scene, and the message: line:column: what is wrong.
REPLACED = [
    ("scene-key", "render:", "rendr:", "3:1: the scene has no 'rendr', did you mean 'render'?"),
    ("camera-key", "fov: 40", "fvo: 40", "1:58: camera has no 'fvo', did you mean 'fov'?"),
    ("camera-key-far", "fov: 40", "lens: 40", "1:58: camera has no 'lens', expected one of: from at up fov width"),
    ("image-key", "size: [40, 30]", "sise: [40, 30]", "2:9: image has no 'sise', did you mean 'size'?"),
    ("render-key", "aa: 1", "antialias: 1",
     "3:34: render has no 'antialias', expected one of: shadow guard shade bump_shadow aa aa_threshold "
     "depth surface self_shadow"),
    ("light-key", "color: [1, 1, 1]", "colour: [1, 1, 1]", "5:27: a light has no 'colour', did you mean 'color'?"),
    ("spot-key", "color: [1, 1, 1]", "spot: {to: [0, 0, 0], angle: 3}",
     "5:49: spot has no 'angle', expected one of: to radius falloff tightness"),
    ("spot-no-to", "color: [1, 1, 1]", "spot: {radius: 3}", "5:33: spot lacks its 'to'"),
    ("spot-itself", "color: [1, 1, 1]", "spot: {to: [-4, 5, -2]}",
     "5:38: the light points at its own place, expected 'to' apart from 'at'"),
    ("spot-radius", "color: [1, 1, 1]", "spot: {to: [0, 0, 0], radius: 50}",
     "5:57: a radius of 50 and a falloff of 45 degrees, expected a radius no larger than the falloff"),
    ("spot-falloff", "color: [1, 1, 1]", "spot: {to: [0, 0, 0], falloff: 20}",
     "5:58: a radius of 30 and a falloff of 20 degrees, expected a radius no larger than the falloff"),
    ("spot-wide", "color: [1, 1, 1]", "spot: {to: [0, 0, 0], falloff: 91}",
     "5:58: 91 is more than 90, expected degrees from the axis to the end of all light, above 0 and up to 90"),
    ("spot-tightness", "color: [1, 1, 1]", "spot: {to: [0, 0, 0], tightness: -1}",
     "5:60: -1 is less than 0, expected an exponent, 0 or more"),
    ("spot-parallel", "color: [1, 1, 1]", "spot: {to: [0, 0, 0]}, parallel: {to: [0, 0, 0]}",
     "5:60: a second kind, 'parallel' beside 'spot', expected one"),
    ("parallel-true", "color: [1, 1, 1]", "parallel: true", "5:37: parallel is a single value, expected a map"),
    ("parallel-no-to", "color: [1, 1, 1]", "parallel: {}", "5:37: parallel lacks its 'to'"),
    ("fade-no-distance", "color: [1, 1, 1]", "fade: {power: 2}", "5:33: fade lacks its 'distance'"),
    ("fade-distance", "color: [1, 1, 1]", "fade: {distance: 0}",
     "5:44: 0 is less than 1e-06, expected the distance at which the light has its colour, from 1e-6 to 1e6"),
    ("fade-power", "color: [1, 1, 1]", "fade: {distance: 1, power: 0}",
     "5:54: 0 is too small, expected an exponent above 0, at most 100"),
    ("area-no-samples", "color: [1, 1, 1]", "area: {u: [1, 0, 0], w: [0, 0, 1]}", "5:33: area lacks its 'samples'"),
    ("area-samples", "color: [1, 1, 1]", "area: {u: [1, 0, 0], w: [0, 0, 1], samples: [4, 65]}",
     "5:75: 65 is more than 64, expected how many samples [along u, along w], 1 to 64 each"),
    ("area-samples-half", "color: [1, 1, 1]", "area: {u: [1, 0, 0], w: [0, 0, 1], samples: [4, 2.5]}",
     "5:71: no whole numbers, expected how many samples [along u, along w], 1 to 64 each"),
    ("area-one-number", "color: [1, 1, 1]", "area: {u: 1, w: [0, 0, 1], samples: [4, 4]}",
     "5:37: a single value, expected one side of the area, [x, y, z]"),
    ("area-parallel", "color: [1, 1, 1]",
     "parallel: {to: [0, 0, 0]}, area: {u: [1, 0, 0], w: [0, 0, 1], samples: [4, 4]}",
     "5:60: a parallel light has no area, expected 'area' only in a point light or a spot"),
    ("material-key", "diffuse: 0.8", "difuse: 0.8", "7:48: a material has no 'difuse', did you mean 'diffuse'?"),
    ("object-key", "    box: {", "    brick: {",
     "19:5: an object has no 'brick', expected one of: plane rectangle disc box sphere cylinder cone torus ellipsoid "
     "parametric patches mesh material bump transform copy copies hidden"),
    ("plane-key", "u: [0, 0, 1]", "U: [0, 0, 1]", "10:32: plane has no 'U', did you mean 'u'?"),
    ("box-key", "to: [0, 1.5", "too: [0, 1.5", "19:32: box has no 'too', did you mean 'to'?"),
    ("sphere-key", "radius: 0.5", "r: 0.5", "22:33: sphere has no 'r', expected one of: center radius"),
    ("bump-map-key", "sign: up", "sing: up", "17:57: a bump with a map has no 'sing', did you mean 'sign'?"),
    ("bump-function-key", 'function: "0.1 * sin(u)"', 'function: "0.1 * sin(u)"\n      zero: 1',
     "14:7: a bump with a function has no 'zero', expected one of: function scale"),
    ("map-key", "file: map.png", "fil: map.png", "17:18: map has no 'fil', did you mean 'file'?"),
    ("camera-twice", "fov: 40}", "fov: 40, at: [0, 0, 1]}", "1:67: a second 'at' in camera, expected one"),
    ("name-twice", "  cube:", "  wall:", "18:3: a second 'wall', expected each name once"),
    ("light-name", "  lamp:", "  the lamp:",
     "5:3: 'the lamp' can't be a name, expected up to 59 letters, digits, _ and -"),
    ("long-name", "  cube:", "  cccccccccccccccccccccccccccccccccccccccccccccccccccccccccccc:",
     "18:3: 'cccccccccccccccccccccccccccccccccccccccccccccccccccccccccccc' can't be a name, expected up to 59 "
     "letters, digits, _ and -"),
    ("list-as-key", "  cube:", "  ? [cube]\n  :", "18:5: a list, expected a name"),
    ("camera-list", "{from: [0, 3, -5], at: [0, 0, 0], up: [0, 1, 0], fov: 40}", "[1, 2]",
     "1:9: camera is a list, expected a map"),
    ("camera-empty", "camera: {from: [0, 3, -5], at: [0, 0, 0], up: [0, 1, 0], fov: 40}", "camera:",
     "1:1: camera is empty, expected a map"),
    ("objects-text", "objects:\n", "objects: none\nx:\n",
     "9:1: the scene has no 'x', expected one of: camera image render lights materials objects"),
    ("light-number", "{at: [-4, 5, -2], color: [1, 1, 1]}", "5", "5:9: a light is a single value, expected a map"),
    ("material-null", "  clay: {color: [0.8, 0.7, 0.6], ambient: 0.1, diffuse: 0.8}", "  clay:",
     "7:3: a material is empty, expected a map"),
    ("vector-number", "from: [0, 3, -5]", "from: 3", "1:16: a single value, expected the eye's place [x, y, z]"),
    ("vector-map", "from: [0, 3, -5]", "from: {x: 0, y: 3, z: -5}",
     "1:16: a map, expected the eye's place [x, y, z]"),
    ("vector-two", "from: [0, 3, -5]", "from: [0, 3]", "1:16: 2 values, expected the eye's place [x, y, z]"),
    ("vector-one", "from: [0, 3, -5]", "from: [0]", "1:16: 1 value, expected the eye's place [x, y, z]"),
    ("vector-text", "from: [0, 3, -5]", "from: [0, up, -5]",
     "1:20: 'up' is no number, expected the eye's place [x, y, z]"),
    ("vector-list", "from: [0, 3, -5]", "from: [0, [3], -5]", "1:20: a list, expected the eye's place [x, y, z]"),
    ("vector-empty", "from: [0, 3, -5]", "from: [0, '', -5]",
     "1:21: nothing here, expected the eye's place [x, y, z]"),
    ("fov-map", "fov: 40", "fov: {}",
     "1:63: a map, expected the horizontal angle in degrees, above 0 and up to 175"),
    ("fov-list", "fov: 40", "fov: [40]",
     "1:63: a list, expected the horizontal angle in degrees, above 0 and up to 175"),
    ("fov-text", "fov: 40", "fov: wide",
     "1:63: 'wide' is no number, expected the horizontal angle in degrees, above 0 and up to 175"),
    ("fov-unit", "fov: 40", "fov: 40 deg",
     "1:63: '40 deg' is no number, expected the horizontal angle in degrees, above 0 and up to 175"),
    ("fov-empty", "fov: 40", "fov: ''",
     "1:64: nothing here, expected the horizontal angle in degrees, above 0 and up to 175"),
    ("fov-null", "fov: 40", "fov:",
     "1:58: nothing here, expected the horizontal angle in degrees, above 0 and up to 175"),
    ("fov-zero", "fov: 40", "fov: 0",
     "1:63: 0 is too small, expected the horizontal angle in degrees, above 0 and up to 175"),
    ("fov-180", "fov: 40", "fov: 180",
     "1:63: 180 is more than 175, expected the horizontal angle in degrees, above 0 and up to 175"),
    ("fov-negative", "fov: 40", "fov: -40",
     "1:63: -40 is less than 0, expected the horizontal angle in degrees, above 0 and up to 175"),
    ("nan", "fov: 40", "fov: nan",
     "1:63: 'nan' is no number, expected the horizontal angle in degrees, above 0 and up to 175"),
    ("yaml-nan", "fov: 40", "fov: .nan",
     "1:63: '.nan' is no number, expected the horizontal angle in degrees, above 0 and up to 175"),
    ("yaml-inf", "fov: 40", "fov: .inf",
     "1:63: '.inf' is no number, expected the horizontal angle in degrees, above 0 and up to 175"),
    ("inf", "radius: 0.5", "radius: inf", "22:41: 'inf' is no number, expected a length from 1e-6 to 1e6"),
    ("overflow", "radius: 0.5", "radius: 1e999", "22:41: '1e999' is no number, expected a length from 1e-6 to 1e6"),
    ("hex", "radius: 0.5", "radius: 0x10", "22:41: '0x10' is no number, expected a length from 1e-6 to 1e6"),
    ("underscore", "radius: 0.5", "radius: 1_000",
     "22:41: '1_000' is no number, expected a length from 1e-6 to 1e6"),
    ("comma", "radius: 0.5", "radius: '0,5'", "22:42: '0,5' is no number, expected a length from 1e-6 to 1e6"),
    ("width-and-fov", "fov: 40", "fov: 40, width: 5",
     "1:74: both 'width' and 'fov', expected the one for an orthographic camera or the other for a pinhole"),
    ("width-zero", "fov: 40", "width: 0",
     "1:65: 0 is less than 1e-06, expected the width of an orthographic picture in scene units, from 1e-6 to 1e6"),
    ("radius-zero", "radius: 0.5", "radius: 0", "22:41: 0 is less than 1e-06, expected a length from 1e-6 to 1e6"),
    ("radius-negative", "radius: 0.5", "radius: -0.5",
     "22:41: -0.5 is less than 1e-06, expected a length from 1e-6 to 1e6"),
    ("radius-huge", "radius: 0.5", "radius: 1e7",
     "22:41: 1e7 is more than 1000000, expected a length from 1e-6 to 1e6"),
    ("far", "center: [1, 1, 0]", "center: [1, 1e7, 0]",
     "22:26: 1e7 is more than 1000000, expected a place [x, y, z]"),
    ("color-negative", "color: [0.8, 0.7, 0.6]", "color: [0.8, -0.7, 0.6]",
     "7:23: -0.7 is less than 0, expected a linear colour [red, green, blue], 0 or more each"),
    ("color-name", "color: [0.8, 0.7, 0.6]", "color: red",
     "7:17: a single value, expected a linear colour [red, green, blue], 0 or more each"),
    ("color-kind", "color: [0.8, 0.7, 0.6]", "color: {cheker: {}}",
     "7:18: color has no 'cheker', did you mean 'checker'?"),
    ("color-neither", "color: [0.8, 0.7, 0.6]", "color: {}",
     "7:17: a color with neither checker nor image, expected either 'checker' or 'image'"),
    ("color-both", "color: [0.8, 0.7, 0.6]",
     "color: {checker: {even: [1, 1, 1], odd: [0, 0, 0]}, image: {file: color.png}}",
     "7:17: a color with both checker and image, expected either 'checker' or 'image'"),
    ("checker-no-odd", "color: [0.8, 0.7, 0.6]", "color: {checker: {even: [1, 1, 1]}}",
     "7:27: checker lacks its 'odd'"),
    ("checker-key", "color: [0.8, 0.7, 0.6]", "color: {checker: {even: [1, 1, 1], odd: [0, 0, 0], scale: 2}}",
     "7:61: checker has no 'scale', expected one of: even odd size offset"),
    ("checker-color", "color: [0.8, 0.7, 0.6]", "color: {checker: {even: white, odd: [0, 0, 0]}}",
     "7:34: a single value, expected a linear colour [red, green, blue], 0 or more each"),
    ("checker-size", "color: [0.8, 0.7, 0.6]", "color: {checker: {even: [1, 1, 1], odd: [0, 0, 0], size: [1, 0]}}",
     "7:71: 0 is less than 1e-06, expected the size of a field [in u, in w], 1e-6 or more"),
    ("image-no-file", "color: [0.8, 0.7, 0.6]", "color: {image: {wrap: repeat}}", "7:25: image lacks its 'file'"),
    ("image-color-key", "color: [0.8, 0.7, 0.6]", "color: {image: {file: color.png, gamma: 2}}",
     "7:43: image has no 'gamma', expected one of: file encoding size repeat offset wrap interpolation"),
    ("image-missing", "color: [0.8, 0.7, 0.6]", "color: {image: {file: none.png, size: [1, 1]}}",
     "7:32: 'none.png' can't be used: No such file or directory"),
    ("image-one", "color: [0.8, 0.7, 0.6]", "color: {image: {file: one.png, size: [1, 1]}}",
     "7:32: 'one.png' has 1 x 1 pixels, expected at least 2 x 2"),
    ("image-cut", "color: [0.8, 0.7, 0.6]", "color: {image: {file: cut.png, size: [1, 1]}}",
     "7:32: 'cut.png' can't be used: libpng: the file ends too early"),
    ("image-alpha", "color: [0.8, 0.7, 0.6]", "color: {image: {file: alpha.png, size: [1, 1]}}",
     "7:32: 'alpha.png' can't be used: the pixel in column 3 of row 2 (both from 0) is transparent; an opaque image is "
     "expected"),
    ("image-exr-channels", "color: [0.8, 0.7, 0.6]", "color: {image: {file: two.exr, size: [1, 1]}}",
     "7:32: 'two.exr' can't be used: there is no channel 'Y'; the file has a, b"),
    ("image-exr-nan", "color: [0.8, 0.7, 0.6]", "color: {image: {file: nan.exr, size: [1, 1]}}",
     "7:32: 'nan.exr' can't be used: the sample in column 2 of row 1 (both from 0) is NaN"),
    ("image-exr-srgb", "color: [0.8, 0.7, 0.6]", "color: {image: {file: rgb.exr, encoding: srgb, size: [1, 1]}}",
     "7:32: 'rgb.exr' can't be used: an OpenEXR file is linear; srgb is for PNG"),
    ("image-exr-rg", "color: [0.8, 0.7, 0.6]", "color: {image: {file: rg.exr, size: [1, 1]}}",
     "7:32: 'rg.exr' can't be used: not all of the channels R, G and B are there"),
    ("image-encoding", "color: [0.8, 0.7, 0.6]", "color: {image: {file: color.png, encoding: sRGB, size: [1, 1]}}",
     "7:53: 'sRGB' is unknown, expected srgb or linear; did you mean 'srgb'?"),
    ("image-interpolation", "color: [0.8, 0.7, 0.6]",
     "color: {image: {file: color.png, interpolation: cubic, size: [1, 1]}}",
     "7:58: 'cubic' is unknown, expected bilinear or nearest"),
    ("image-wrap", "color: [0.8, 0.7, 0.6]", "color: {image: {file: color.png, wrap: once, size: [1, 1]}}",
     "7:49: 'once' is unknown, expected repeat, clamp or mirror"),
    ("image-on-plane", "color: [0.8, 0.7, 0.6]", "color: {image: {file: color.png}}",
     "11:15: the image of 'clay' has no 'size', expected one for a surface without ends"),
    ("ambient-negative", "ambient: 0.1", "ambient: -0.1",
     "7:43: -0.1 is less than 0, expected a share of light, 0 or more"),
    ("roughness", "diffuse: 0.8", "roughness: 0",
     "7:59: 0 is less than 1e-06, expected a number of 1e-6 or more; small is sharp"),
    ("phong-size", "diffuse: 0.8", "phong_size: 0", "7:60: 0 is too small, expected an exponent above 0"),
    ("size-zero", "size: [40, 30]", "size: [0, 30]",
     "2:16: 0 is less than 1, expected [width, height] in pixels, from 1 to 32768"),
    ("size-negative", "size: [40, 30]", "size: [40, -30]",
     "2:20: -30 is less than 1, expected [width, height] in pixels, from 1 to 32768"),
    ("size-fraction", "size: [40, 30]", "size: [40.5, 30]",
     "2:15: no whole numbers, expected [width, height] in pixels, from 1 to 32768"),
    ("size-side", "size: [40, 30]", "size: [40, 32769]",
     "2:20: 32769 is more than 32768, expected [width, height] in pixels, from 1 to 32768"),
    ("size-one", "size: [40, 30]", "size: 40",
     "2:15: a single value, expected [width, height] in pixels, from 1 to 32768"),
    ("shadow", "shadow: 0", "shadow: 3",
     "3:18: '3' is no method, expected none, 0, 1, 2, 2+, iter:K, march:N (K and N: 1 to 1024), exact "
     "or auto[:E]"),
    ("shadow-iter", "shadow: 0", "shadow: 'iter:0'",
     "3:19: 'iter:0' is no method, expected none, 0, 1, 2, 2+, iter:K, march:N (K and N: 1 to 1024), exact "
     "or auto[:E]"),
    ("surface", "shadow: 0", "shadow: 0, surface: rough", "3:30: 'rough' is unknown, expected smooth or displaced"),
    ("self-shadow", "shadow: 0", "shadow: 0, self_shadow: 1", "3:34: '1' is unknown, expected true or false"),
    ("guard", "guard: true", "guard: yes", "3:28: 'yes' is unknown, expected true or false"),
    ("depth-zero", "aa: 1", "depth: 0", "3:41: 0 is less than 1, expected how many rays follow one another, 1 to 32"),
    ("depth-deep", "aa: 1", "depth: 33",
     "3:41: 33 is more than 32, expected how many rays follow one another, 1 to 32"),
    ("depth-half", "aa: 1", "depth: 2.5",
     "3:41: 2.5 is no whole number, expected how many rays follow one another, 1 to 32"),
    ("reflection", "diffuse: 0.8", "reflection: 1.1",
     "7:60: 1.1 is more than 1, expected a share of light, or one each of red, green and blue, 0 to 1"),
    ("reflection-negative", "diffuse: 0.8", "reflection: -0.1",
     "7:60: -0.1 is less than 0, expected a share of light, or one each of red, green and blue, 0 to 1"),
    ("reflection-color", "diffuse: 0.8", "reflection: [0, 2, 0]",
     "7:64: 2 is more than 1, expected a share of light, or one each of red, green and blue, 0 to 1"),
    ("reflection-two", "diffuse: 0.8", "reflection: [0, 1]",
     "7:60: 2 values, expected a share of light, or one each of red, green and blue, 0 to 1"),
    ("reflection-text", "diffuse: 0.8", "reflection: full",
     "7:60: 'full' is no number, expected a share of light, or one each of red, green and blue, 0 to 1"),
    ("reflection-map", "diffuse: 0.8", "reflection: {}",
     "7:60: a map, expected a share of light, or one each of red, green and blue, 0 to 1"),
    ("filter", "diffuse: 0.8", "filter: 1.5",
     "7:56: 1.5 is more than 1, expected the share of light that it lets through in its colour, 0 to 1"),
    ("transmit", "diffuse: 0.8", "transmit: -1",
     "7:58: -1 is less than 0, expected the share of light that it lets through unchanged, 0 to 1"),
    ("filter-and-transmit", "diffuse: 0.8", "filter: 0.7, transmit: 0.5",
     "7:71: a filter of 0.7 and a transmit of 0.5, expected no more than 1 together"),
    ("ior-zero", "diffuse: 0.8", "ior: 0",
     "7:53: 0 is too small, expected an index of refraction above 0, at most 100"),
    ("ior-negative", "diffuse: 0.8", "ior: -1.5",
     "7:53: -1.5 is less than 0, expected an index of refraction above 0, at most 100"),
    ("aa-zero", "aa: 1", "aa: 0", "3:38: 0 is less than 1, expected samples along a pixel's side, 1 to 16"),
    ("aa-fraction", "aa: 1", "aa: 1.5",
     "3:38: 1.5 is no whole number, expected samples along a pixel's side, 1 to 16"),
    ("aa-large", "aa: 1", "aa: 17", "3:38: 17 is more than 16, expected samples along a pixel's side, 1 to 16"),
    ("aa-threshold", "aa: 1", "aa: 4, aa_threshold: 3.5",
     "3:55: 3.5 is more than 3, expected how much two pixels may differ, red, green and blue together, 0 to 3"),
    ("looks-at-itself", "at: [0, 0, 0]", "at: [0, 3, -5]",
     "1:32: the camera looks at its own place, expected 'at' apart from 'from'"),
    ("up-zero", "up: [0, 1, 0]", "up: [0, 0, 0]", "1:47: no direction, expected a vector with a length"),
    ("up-along", "up: [0, 1, 0]", "up: [0, -3, 5]", "1:47: 'up' is along the view, expected a direction across it"),
    ("up-default", "at: [0, 0, 0], up: [0, 1, 0]", "at: [0, 0, -5]",
     "1:9: 'up' is along the view, expected a direction across it (it is [0, 1, 0])"),
    ("edge-zero", "u: [0, 0, 1]", "u: [0, 0, 0]", "10:35: no direction, expected an edge with a length"),
    ("edge-zero-w", "w: [0, -1, 0]", "w: [0, 0, 0]", "15:53: no direction, expected an edge with a length"),
    ("edges-parallel", "w: [1, 0, 0]", "w: [0, 0, -2]", "10:12: u and w are parallel, expected two directions"),
    ("box-thin", "to: [0, 1.5, 0]", "to: [0, 0.5, 0]",
     "19:36: a box without thickness, expected 'to' apart from 'from' along x, y and z"),
    ("disc-key", BALL, "disc: {center: [1, 1, 0], normal: [0, 1, 0], radius: 1, hole: 0.5}",
     "22:61: disc has no 'hole', expected one of: center normal radius"),
    ("disc-no-normal", BALL, "disc: {center: [1, 1, 0], radius: 1}",
     "22:11: disc lacks its 'normal'"),
    ("disc-normal", BALL, "disc: {center: [1, 1, 0], normal: [0, 0, 0], radius: 1}",
     "22:39: no direction, expected a vector with a length"),
    ("disc-radius", BALL, "disc: {center: [1, 1, 0], normal: [0, 1, 0], radius: 0}",
     "22:58: 0 is less than 1e-06, expected a length from 1e-6 to 1e6"),
    ("cylinder-key", BALL, "cylinder: {from: [0, 0, 0], to: [0, 1, 0], radios: 1}",
     "22:48: cylinder has no 'radios', did you mean 'radius'?"),
    ("cylinder-no-to", BALL, "cylinder: {from: [0, 0, 0], radius: 1}",
     "22:15: cylinder lacks its 'to'"),
    ("cylinder-flat", BALL, "cylinder: {from: [0, 1, 0], to: [0, 1, 0], radius: 1}",
     "22:37: a cylinder without length, expected 'to' apart from 'from'"),
    ("cylinder-open", BALL, "cylinder: {from: [0, 0, 0], to: [0, 1, 0], radius: 1, open: yes}",
     "22:65: 'yes' is unknown, expected true or false"),
    ("cylinder-place", BALL, "cylinder: {from: 0, to: [0, 1, 0], radius: 1}",
     "22:22: a single value, expected the middle of one end [x, y, z]"),
    ("cone-key", BALL, "cone: {from: [0, 0, 0], from_radius: 1, to: [0, 1, 0], radius: 1}",
     "22:60: cone has no 'radius', expected one of: from from_radius to to_radius open"),
    ("cone-no-radius", BALL, "cone: {from: [0, 0, 0], from_radius: 1, to: [0, 1, 0]}",
     "22:11: cone lacks its 'to_radius'"),
    ("cone-radius", BALL, "cone: {from: [0, 0, 0], from_radius: -1, to: [0, 1, 0], to_radius: 1}",
     "22:42: -1 is less than 0, expected a length from 0 to 1e6"),
    ("cone-thin", BALL, "cone: {from: [0, 0, 0], from_radius: 0, to: [0, 1, 0], to_radius: 0}",
     "22:11: a cone without thickness, expected a radius of 1e-6 or more at one end"),
    ("cone-flat", BALL, "cone: {from: [0, 0, 0], from_radius: 1, to: [0, 0, 0], to_radius: 0}",
     "22:49: a cone without length, expected 'to' apart from 'from'"),
    ("ellipsoid-flat", BALL, "ellipsoid: {center: [0, 0, 0], radii: [1, 0, 2]}",
     "22:43: a radius that is not above 0, expected three of 1e-6 to 1e6"),
    ("ellipsoid-radii", BALL, "ellipsoid: {center: [0, 0, 0], radii: 2}",
     "22:43: a single value, expected the radii along x, y and z"),
    ("torus-key", BALL, "torus: {center: [0, 0, 0], axis: [0, 1, 0], mayor: 1, minor: 0.5}",
     "22:49: torus has no 'mayor', did you mean 'major'?"),
    ("torus-no-axis", BALL, "torus: {center: [0, 0, 0], major: 1, minor: 0.5}",
     "22:12: torus lacks its 'axis'"),
    ("torus-axis", BALL, "torus: {center: [0, 0, 0], axis: [0, 0, 0], major: 1, minor: 0.5}",
     "22:38: no direction, expected a vector with a length"),
    ("torus-fat", BALL, "torus: {center: [0, 0, 0], axis: [0, 1, 0], major: 1, minor: 1}",
     "22:66: a tube that closes the hole, expected 'minor' below 'major'"),
    ("torus-minor", BALL, "torus: {center: [0, 0, 0], axis: [0, 1, 0], major: 1, minor: 0}",
     "22:66: 0 is less than 1e-06, expected a length from 1e-6 to 1e6"),
    ("transform-map", BALL, f"{BALL}\n    transform: {{scale: 2}}",
     "23:16: a map, expected a list of steps, such as [{rotate: [0, 45, 0]}, {translate: [1, 0, 0]}]"),
    ("transform-step", BALL, f"{BALL}\n    transform: [{{rotate: [0, 1, 2]}}, {{scal: 2}}]",
     "23:39: a step has no 'scal', did you mean 'scale'?"),
    ("transform-step-far", BALL, f"{BALL}\n    transform: [{{shear: 2}}]",
     "23:18: a step has no 'shear', expected one of: translate rotate scale look"),
    ("transform-word", BALL, f"{BALL}\n    transform: [scale]", "23:17: a step is a single value, expected a map"),
    ("transform-two", BALL, f"{BALL}\n    transform: [{{scale: 2, rotate: [0, 1, 2]}}]",
     "23:17: a step with 2 keys, expected one, since the order matters"),
    ("transform-none", BALL, f"{BALL}\n    transform: [{{}}]",
     "23:17: a step with 0 keys, expected one, since the order matters"),
    ("rotate-number", BALL, f"{BALL}\n    transform: [{{rotate: 45}}]",
     "23:26: a single value, expected angles in degrees about the axes, [x, y, z]"),
    ("translate-text", BALL, f"{BALL}\n    transform: [{{translate: [0, up, 0]}}]",
     "23:33: 'up' is no number, expected how far along x, y and z, [x, y, z]"),
    ("scale-zero", BALL, f"{BALL}\n    transform: [{{scale: 0}}]",
     "23:25: a scale of 0 has no extent, expected a factor or [x, y, z], each 1e-6 to 1e6 or -1e6 to -1e-6"),
    ("scale-zero-y", BALL, f"{BALL}\n    transform: [{{scale: [1, 0, 1]}}]",
     "23:29: a scale of 0 has no extent, expected a factor or [x, y, z], each 1e-6 to 1e6 or -1e6 to -1e-6"),
    ("scale-two", BALL, f"{BALL}\n    transform: [{{scale: [1, 2]}}]",
     "23:25: 2 values, expected a factor or [x, y, z], each 1e-6 to 1e6 or -1e6 to -1e-6"),
    ("scale-stretch", BALL, f"{BALL}\n    transform: [{{scale: [1e3, 1e-2, 1]}}]",
     "23:16: one direction is scaled more than 10000 times as much as another, expected less"),
    ("scale-tiny", BALL, f"{BALL}\n    transform: [{{scale: 1e-4}}, {{scale: 1e-4}}]",
     "23:16: an edge or a radius of 5e-09 scene units after the transform, expected 1e-6 to 1e6"),
    ("scale-far", BALL, f"{BALL}\n    transform: [{{translate: [1e4, 0, 0]}}, {{scale: 1e3}}]",
     "23:16: a coordinate of 1e+07 scene units after the transform, expected at most 1000000"),
    ("look-no-at", BALL, f"{BALL}\n    transform: [{{look: {{from: [0, 1, 0]}}}}]", "23:24: look lacks its 'at'"),
    ("look-itself", BALL, f"{BALL}\n    transform: [{{look: {{from: [0, 1, 0], at: [0, 1, 0]}}}}]",
     "23:46: it looks at its own place, expected 'at' apart from 'from'"),
    ("look-up", BALL, f"{BALL}\n    transform: [{{look: {{from: [0, 1, 0], at: [0, 2, 0]}}}}]",
     "23:24: 'up' is along the view, expected a direction across it (it is [0, 1, 0])"),
    ("look-up-zero", BALL, f"{BALL}\n    transform: [{{look: {{from: [0, 1, 0], at: [0, 2, 0], up: [0, 0, 0]}}}}]",
     "23:61: no direction, expected a vector with a length"),
    ("copy-unknown", BALL, "copy: cubes", "22:11: no object 'cubes', did you mean 'cube'?"),
    ("copy-far", BALL, "copy: elephant", "22:11: no object 'elephant', expected one of those under 'objects'"),
    ("copy-itself", BALL, "copy: ball", "22:11: 'ball' copies itself, expected another object"),
    ("copy-cycle", f"box: {{from: [-1, 0.5, -1], to: [0, 1.5, 0]}}\n    material: clay\n  ball:\n    {BALL}",
     "copy: egg\n  ball:\n    copy: cube\n  egg: {copy: ball}\n  disc:\n    copy: cube",
     "21:11: 'cube' is itself a copy of this object, expected one that is not"),
    ("copy-list", BALL, "copy: [cube]", "22:11: a list, expected the name of an object"),
    ("copy-shape", BALL, f"copy: cube\n    {BALL}", "23:13: a shape, 'sphere', beside 'copy', expected one of them"),
    ("copy-material", f"{BALL}\n    material: clay", "copy: cube\n    material: caly",
     "23:15: no material 'caly', did you mean 'clay'?"),
    ("no-camera", "camera: {from: [0, 3, -5], at: [0, 0, 0], up: [0, 1, 0], fov: 40}\n", "",
     "1:1: the scene lacks its 'camera'"),
    ("no-from", "from: [0, 3, -5], ", "", "1:9: camera lacks its 'from'"),
    ("no-at", "at: [0, 0, 0], ", "", "1:9: camera lacks its 'at'"),
    ("no-light-at", "at: [-4, 5, -2], ", "", "5:9: a light lacks its 'at'"),
    ("no-lights", "lights:\n  lamp: {at: [-4, 5, -2], color: [1, 1, 1]}\n", "",
     "1:1: the scene lacks its 'lights'"),
    ("v-for-w", "u: [1, 0, 0], w: [0, -1, 0]}", "u: [1, 0, 0], v: [0, -1, 0]}",
     "15:50: rectangle has no 'v', did you mean 'w'?"),
    ("no-origin", "origin: [0, 0, 0], ", "", "10:12: plane lacks its 'origin'"),
    ("no-to", ", to: [0, 1.5, 0]", "", "19:10: box lacks its 'to'"),
    ("no-radius", ", radius: 0.5", "", "22:13: sphere lacks its 'radius'"),
    ("no-material", "    sphere: {center: [1, 1, 0], radius: 0.5}\n    material: clay",
     "    sphere: {center: [1, 1, 0], radius: 0.5}",
     "22:5: an object lacks its 'material'"),
    ("no-shape", "    sphere: {center: [1, 1, 0], radius: 0.5}\n", "",
     "22:5: an object lacks its shape, expected one of: plane rectangle disc box sphere cylinder cone torus ellipsoid "
     "parametric patches mesh"),
    ("two-shapes", "    sphere: {", "    box: {from: [0, 0, 0], to: [1, 1, 1]}\n    sphere: {",
     "23:13: a second shape, 'sphere' beside 'box', expected one"),
    ("unknown-material", "radius: 0.5}\n    material: clay", "radius: 0.5}\n    material: caly",
     "23:15: no material 'caly', did you mean 'clay'?"),
    ("unknown-material-far", "radius: 0.5}\n    material: clay", "radius: 0.5}\n    material: chrome",
     "23:15: no material 'chrome', expected one of those under 'materials'"),
    ("material-list", "radius: 0.5}\n    material: clay", "radius: 0.5}\n    material: [clay]",
     "23:15: a list, expected the name of a material"),
    ("bump-both", "map: {file: map.png}", "map: {file: map.png}, function: u",
     "17:11: a bump with both map and function, expected either 'map' or 'function'"),
    ("bump-neither", 'function: "0.1 * sin(u)"', "scale: 1",
     "13:7: a bump with neither map nor function, expected either 'map' or 'function'"),
    ("bump-text", "{map: {file: map.png}, scale: 0.1, zero: 0.5, sign: up}", "map.png",
     "17:11: bump is a single value, expected a map"),
    ("map-text", "map: {file: map.png}", "map: map.png", "17:17: map is a single value, expected a map"),
    ("map-missing", "file: map.png", "file: none.png",
     "17:24: 'none.png' can't be used: No such file or directory"),
    ("map-folder", "file: map.png", "file: .", "17:24: '.' can't be used: Is a directory"),
    ("map-no-image", "file: map.png", "file: scene.yaml",
     "17:24: 'scene.yaml' can't be used: its first bytes are those of neither a PNG nor an OpenEXR file"),
    ("map-empty", "file: map.png", "file: empty.png", "17:24: 'empty.png' can't be used: the file is empty"),
    ("map-color", "file: map.png", "file: color.png",
     "17:24: 'color.png' can't be used: the PNG is in colour; a grey one is expected, of 8 or 16 bits: "
     "save it in grey, if bright means high"),
    ("map-normals", "file: map.png", "file: normals.png",
     "17:24: 'normals.png' can't be used: the PNG is a normal map, which has slopes but no heights; a grey height map "
     "is expected, and docs/models.md tells how to make one"),
    ("map-jpeg", "file: map.png", "file: map.jpg",
     "17:24: 'map.jpg' can't be used: it is a JPEG, expected a PNG or an OpenEXR file; save it again as a PNG"),
    ("map-cut", "file: map.png", "file: cut.png",
     "17:24: 'cut.png' can't be used: libpng: the file ends too early"),
    ("map-one", "file: map.png", "file: one.png", "17:24: 'one.png' has 1 x 1 samples, expected at least 2 x 2"),
    ("map-png-channel", "file: map.png", "file: map.png, channel: Y",
     "17:24: 'map.png' can't be used: there is no channel 'Y': a PNG file has no named channels"),
    ("map-exr-two", "file: map.png", "file: two.exr",
     "17:24: 'two.exr' can't be used: which channel is meant? The file has a, b"),
    ("map-exr-channel", "file: map.png", "file: two.exr, channel: c",
     "17:24: 'two.exr' can't be used: there is no channel 'c'; the file has a, b"),
    ("map-exr-nan", "file: map.png", "file: nan.exr",
     "17:24: 'nan.exr' can't be used: the sample in column 2 of row 1 (both from 0) is NaN"),
    ("map-exr-cut", "file: map.png", "file: cut.exr, channel: a",
     "17:24: 'cut.exr' can't be used: OpenEXR: Preparing to read scanline 0 (chunk 0), found corrupt leader: "
     "packed size 142, file size 400"),
    ("map-exr-tiles", "file: map.png", "file: tiles.exr",
     "17:24: 'tiles.exr' can't be used: OpenEXR: the file is shorter than its table of chunks"),
    ("map-file-empty", "file: map.png", "file: ''", "17:25: nothing here, expected the file of a height map"),
    ("map-no-scale", "scale: 0.1, ", "", "17:11: a bump with a map lacks its 'scale', expected the "
     "height of white above black in scene units, such as scale: 0.1"),
    ("map-no-zero", "zero: 0.5, ", "", "17:11: a bump with a map lacks its 'zero', expected the "
     "map's value whose height is 0, such as zero: 0.5"),
    ("map-no-sign", ", sign: up", "", "17:11: a bump with a map lacks its 'sign', expected up (higher "
     "values are higher) or down"),
    ("map-scale-negative", "scale: 0.1", "scale: -0.1",
     "17:41: -0.1 is less than 0, expected scene units for one unit of the map, 0 or more"),
    ("map-scale-huge", "scale: 0.1, zero: 0.5", "scale: 1e6, zero: 100",
     "17:41: heights from -1e+08 to -9.908e+07, expected them within 1000000 scene units"),
    ("map-sign", "sign: up", "sign: upp",
     "17:63: 'upp' is unknown, expected up (higher values are higher) or down; did you mean 'up'?"),
    ("map-size-and-repeat", "sign: up", "sign: up, size: [1, 1], repeat: [2, 2]",
     "17:89: both 'size' and 'repeat', expected one of them"),
    ("map-size", "sign: up", "sign: up, size: [0, 1]",
     "17:74: 0 is less than 1e-06, expected the size of the map [in u, in w], 1e-6 or more"),
    ("map-repeat", "sign: up", "sign: up, repeat: [-1, 1]",
     "17:76: -1 is less than 1e-06, expected how often the map goes into the surface [in u, in w], 1e-6 or more"),
    ("map-wrap", "sign: up", "sign: up, wrap: tile", "17:73: 'tile' is unknown, expected repeat, clamp or mirror"),
    ("map-wrap-near", "sign: up", "sign: up, wrap: clmap",
     "17:73: 'clmap' is unknown, expected repeat, clamp or mirror; did you mean 'clamp'?"),
    ("map-samples", "sign: up", "sign: up, samples: centers",
     "17:76: 'centers' is unknown, expected cells or corners; did you mean 'corners'?"),
    ("map-offset", "sign: up", "sign: up, offset: 1",
     "17:75: a single value, expected where the map begins [in u, in w]"),
    ("map-on-plane", 'function: "0.1 * sin(u)"',
     "map: {file: map.png}\n      scale: 0.1\n      zero: 0.5\n      sign: up",
     "13:7: a map on an unbounded surface, expected 'size: [in u, in w]'"),
    ("function-name", "sin(u)", "sinn(u)", "13:24: unknown function 'sinn', did you mean 'sin'?"),
    ("function-variable", "sin(u)", "sin(v)", "13:28: unknown name 'v', expected u, w, pi or a function"),
    ("function-bracket", "sin(u)", "sin(u", "13:29: found the end, expected an operator, ',' or ')'"),
    ("function-operator", "sin(u)", "sin(u) 2",
     "13:31: missing operator before '2': a product is written with '*'"),
    ("function-arguments", "sin(u)", "atan2(u)", "13:24: 'atan2' takes 2 arguments, found 1"),
    ("function-empty", '"0.1 * sin(u)"', '""', "13:18: nothing here, expected a function of u and w"),
    ("function-blank", '"0.1 * sin(u)"', '" "', "13:19: empty expression, expected a function of u and w"),
    ("function-number", '"0.1 * sin(u)"', "[1]", "13:17: a list, expected a function of u and w"),
    ("function-escape", '"0.1 * sin(u)"', '"\\x30.1 * \\u0073in(v)"',
     "13:36: unknown name 'v', expected u, w, pi or a function"),
    ("function-single", '"0.1 * sin(u)"', "'0.1 * sin(v)'",
     "13:28: unknown name 'v', expected u, w, pi or a function"),
    ("function-quote", '"0.1 * sin(u)"', "'0.1 '' sin(u)'", "13:22: found ''', expected an operator or the end"),
    ("function-plain", '"0.1 * sin(u)"', "0.1 *\n\n        sin(v)",
     "15:13: unknown name 'v', expected u, w, pi or a function"),
    ("function-lines", '"0.1 * sin(u)"', '"0.1 *\n        sin(v)"',
     "14:13: unknown name 'v', expected u, w, pi or a function"),
    ("function-continued", '"0.1 * sin(u)"', '"0.1 * \\\n        sin(v)"',
     "14:13: unknown name 'v', expected u, w, pi or a function"),
    ("function-literal", '"0.1 * sin(u)"', "|\n        0.1 *\n        sin(v)",
     "15:13: unknown name 'v', expected u, w, pi or a function"),
    ("function-folded", '"0.1 * sin(u)"', ">\n        0.1 *\n        sin(v)\n        + 2",
     "15:13: unknown name 'v', expected u, w, pi or a function"),
    ("function-folded-gap", '"0.1 * sin(u)"', ">-\n\n        0.1 *\n\n\n        sin(v)",
     "18:13: unknown name 'v', expected u, w, pi or a function"),
    ("function-utf8", '"0.1 * sin(u)"', '"0.1 · sin(u)"',
     "13:22: found the byte 0xC2, expected an operator or the end"),
    ("alias", "at: [0, 0, 0]", "at: *there",
     "1:33: an alias, which kage does not take, expected the place looked at [x, y, z]"),
    ("cycle", "camera: {from: [0, 3, -5], at: [0, 0, 0]", "camera: &c {from: [0, 3, -5], at: *c",
     "1:36: an alias, which kage does not take, expected the place looked at [x, y, z]"),
    ("merge-key", "fov: 40", "<<: {fov: 40}", "1:58: camera has no '<<', expected one of: from at up fov width"),
    ("tag", "fov: 40", "fov: !!float wide",
     "1:71: 'wide' is no number, expected the horizontal angle in degrees, above 0 and up to 175"),
    ("escape", "fov: 40", '"\\e[2J": 40', "1:59: camera has no '?[2J', expected one of: from at up fov width"),
    ("utf8-column", "lamp: {at: [-4, 5, -2]", "lamp: {ä: 'ö', at: [-4, 5]",
     "5:10: a light has no 'ä', expected one of: at color spot parallel fade area"),
    ("tab-column", "image: {", "image:\t{sise: 1, ", "2:9: image has no 'sise', did you mean 'size'?"),
    ("second-document", "objects:\n", "---\nobjects:\n", "9:1: a second document, expected one scene a file"),
]


def write_exr(path: Path, **channels: np.ndarray) -> None:
    OpenEXR.File({"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}, channels).write(str(path))


def write_many_tiles(path: Path) -> None:
    """The header of 2^28 tiles, and none of them."""
    def attribute(name: str, kind: str, value: bytes) -> bytes:
        return f"{name}\0{kind}\0".encode() + struct.pack("<i", len(value)) + value

    window = struct.pack("<4i", 0, 0, 16383, 16383)
    path.write_bytes(b"\x76\x2f\x31\x01" + struct.pack("<i", 0x202) +
                     attribute("channels", "chlist", b"Y\0" + struct.pack("<4i", 2, 0, 1, 1) + b"\0") +
                     attribute("compression", "compression", b"\3") + attribute("dataWindow", "box2i", window) +
                     attribute("displayWindow", "box2i", window) + attribute("lineOrder", "lineOrder", b"\0") +
                     attribute("pixelAspectRatio", "float", struct.pack("<f", 1)) +
                     attribute("screenWindowCenter", "v2f", bytes(8)) +
                     attribute("screenWindowWidth", "float", struct.pack("<f", 1)) +
                     attribute("tiles", "tiledesc", struct.pack("<iib", 1, 1, 0)) + bytes(65))


@pytest.fixture(scope="session")
def images(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Height maps, good and bad."""
    folder = tmp_path_factory.mktemp("images")
    grey = (np.arange(48).reshape(6, 8) * 5).astype(np.uint8)
    Image.fromarray(grey).save(folder / "map.png")
    Image.fromarray(np.stack([grey, grey, 255 - grey], -1)).save(folder / "color.png")
    Image.fromarray(np.stack([grey // 2 + 64, grey // 4 + 96, 0 * grey + 245], -1)).save(folder / "normals.png")
    Image.fromarray(grey).save(folder / "map.jpg")
    Image.fromarray(grey).convert("P").save(folder / "palette.png")
    Image.fromarray(grey[:1, :1]).save(folder / "one.png")
    colors = np.stack([grey] * 4, -1)
    colors[..., 3] = 255
    Image.fromarray(colors).save(folder / "opaque.png")
    colors[2, 3, 3] = 254
    Image.fromarray(colors).save(folder / "alpha.png")
    (folder / "empty.png").touch()
    (folder / "cut.png").write_bytes((folder / "map.png").read_bytes()[:60])
    heights = grey.astype(np.float32)
    write_exr(folder / "two.exr", a=heights, b=heights)
    write_exr(folder / "rgb.exr", R=heights, G=heights, B=heights)
    write_exr(folder / "rg.exr", R=heights, G=heights)
    (folder / "cut.exr").write_bytes((folder / "two.exr").read_bytes()[:400])
    write_many_tiles(folder / "tiles.exr")
    heights[1, 2] = np.nan
    write_exr(folder / "nan.exr", Y=heights)
    return folder


@pytest.fixture
def bench(kage: Kage, images: Path) -> Kage:
    """A folder with the maps, and the program."""
    for path in images.iterdir():
        (kage.folder / path.name).symlink_to(path)
    return kage


def refused(kage: Kage, *arguments: object, timeout: float = 60) -> list[str]:
    """Run what must be refused as bad input; the lines on stderr."""
    before = kage.files()
    done = kage(*arguments, timeout=timeout)
    assert done.returncode == 2, f"status {done.returncode}: {done.stderr[:2000]}"
    assert done.stdout == ""
    assert kage.files() == before
    assert done.stderr.endswith("\n")
    return done.stderr[:-1].split("\n")


def refused_scene(kage: Kage, text: str | bytes, *arguments: object, timeout: float = 60) -> list[str]:
    data = text if isinstance(text, bytes) else text.encode()
    (kage.folder / "scene.yaml").write_bytes(data)
    return refused(kage, "render", "scene.yaml", "-o", "out.png", *arguments, timeout=timeout)


def check_caret(lines: list[str], text: str) -> None:
    """The two lines below a message: those of its place in the text, whole where that is short."""
    match = re.match(r".*?:(\d+):(\d+): ", lines[0])
    assert match
    line, column = int(match[1]), int(match[2])
    source = text.split("\n")[line - 1]
    assert lines[1] == f"{line:5} | {source}"
    assert lines[2] == "      | " + re.sub(r"[^\t]", " ", source[: column - 1]) + "^"


def errors_in(lines: list[str]) -> list[str]:
    return [line for line in lines if re.match(r"(scene\.yaml|--set)[: ]", line)]


def test_scene_without_a_mistake(bench: Kage) -> None:
    (bench.folder / "scene.yaml").write_text(SCENE)
    assert "object ball: sphere" in bench.good("check", "scene.yaml")


def test_opaque_images(bench: Kage) -> None:
    """An alpha channel is no harm where it is 1; and grey, palette, PNG and EXR are all colours."""
    for file in ("opaque.png", "color.png", "map.png", "palette.png", "rgb.exr"):
        (bench.folder / "scene.yaml").write_text(
            SCENE.replace("color: [0.8, 0.7, 0.6]", f"color: {{image: {{file: {file}, size: [1, 1]}}}}"))
        bench.good("check", "scene.yaml")


@pytest.mark.parametrize(("old", "new", "message"), [case[1:] for case in REPLACED], ids=[case[0] for case in REPLACED])
def test_replaced(bench: Kage, old: str, new: str, message: str) -> None:
    assert old in SCENE
    text = SCENE.replace(old, new, 1)
    lines = refused_scene(bench, text)
    assert lines[0] == f"scene.yaml:{message}"
    check_caret(lines, text)
    count = len(errors_in(lines))
    assert len(lines) == 3 * count + (count > 1)


def test_the_errors_of_a_bump_come_with_its_shapes(bench: Kage) -> None:
    lines = refused_scene(bench, SCENE.replace("box: {", "bump: {function: sin(q)}\n    box: {far: 1, "))
    assert [line for line in lines if line.startswith("scene.yaml:")] == [
        "scene.yaml:20:11: box has no 'far', expected one of: from to",
        "scene.yaml:19:26: unknown name 'q', expected u, w, pi or a function"]


# ---- the file as a whole ----

WHOLE = [
    ("empty", b"", ":1:1: an empty file, expected a map with camera, lights, materials and objects"),
    ("blank", b" \n\n", ":1:1: an empty file, expected a map with camera, lights, materials and objects"),
    ("comments", b"# none\n", ":1:1: no scene here, only comments"),
    ("list", b"- camera\n", ":1:1: no scene here, expected a map with camera, lights, materials and objects"),
    ("scalar", b"camera\n", ":1:1: no scene here, expected a map with camera, lights, materials and objects"),
    ("latin-1", b"camera: 1\n# gr\xfcn\n", ":2:5: the byte 0xFC, expected a text in UTF-8"),
    ("overlong", b"# \xc0\xaf\n", ":1:3: the byte 0xC0, expected a text in UTF-8"),
    ("surrogate", b"# \xed\xa0\x80\n", ":1:3: the byte 0xED, expected a text in UTF-8"),
    ("utf-16", "camera: 1\n".encode("utf-16"), ":1:1: the byte 0xFF, expected a text in UTF-8"),
    ("nul", b"camera: 1\nli\0ghts: 2\n", ":2:3: the byte 0x00, expected a text in UTF-8"),
    ("too-large", b"#" * ((1 << 26) + 1), ": the scene is too large, expected at most 67108864 bytes"),
    ("anchors", b"".join(b"k%d: &a%d 1\n" % (i, i) for i in range(100000)),
     ": 100000 times '&', expected at most 1000: kage takes no anchors"),
]


@pytest.mark.parametrize(("data", "message"), [case[1:] for case in WHOLE], ids=[case[0] for case in WHOLE])
def test_whole_file(bench: Kage, data: bytes, message: str) -> None:
    assert refused_scene(bench, data)[0] == "scene.yaml" + message


#: Syntax: libfyaml's words differ with its version, so only the place is compared.
SYNTAX = [
    ("tab", "camera:\n\timage: 2\n", 2),
    ("open-list", "camera: {from: [0, 1", 1),
    ("open-map", "camera: {from: 1\n", 1),
    ("open-quote", 'camera: "x\n', 1),
    ("closing", "camera: ]\n", 1),
    ("no-colon", "camera: {}\nimage\nlights: {}\n", 2),
    ("indentation", "camera:\n  from: [0, 0, 0]\n at: [1, 1, 1]\n", 3),
    ("two-values", "camera: 'a' 'b'\n", 1),
    ("directive", "%YAML 9.9\n---\ncamera: {}\n", 1),
    ("escape", 'camera: "\\q"\n', 1),
    ("deep-lists", "camera: " + "[" * 5000 + "]" * 5000, 1),
    ("deep-open", "camera: " + "[" * 100000, 1),
    ("deep-maps", "{a: " * 5000 + "1" + "}" * 5000, 1),
    ("deep-block", "\n".join(" " * i + "a:" for i in range(2000)), 64),
    ("deep-dashes", "- " * 5000, 1),
    ("quotes", '"' * 500000, 1),
    ("anchor-alone", "camera: &\n", 1),
]


@pytest.mark.parametrize(("text", "line"), [case[1:] for case in SYNTAX], ids=[case[0] for case in SYNTAX])
def test_syntax(bench: Kage, text: str, line: int) -> None:
    lines = refused_scene(bench, text)
    assert re.match(rf"scene\.yaml:{line}:\d+: [^\n]+$", lines[0]), lines[0]
    assert len(lines[1]) <= 8 + 150
    assert lines[2].endswith("^")


#: Aliases are refused, so nothing grows from them; much of the same is refused in seconds.
HOSTILE = [
    ("billion-laughs", "a: &a [x, x]\n" + "".join(
        f"{b}: &{b} [*{a}, *{a}]\n" for a, b in itertools.pairwise("abcdefghijk"))),
    ("cycle", "camera: &a {from: *a, at: *a}\nlights: *a\nmaterials: *a\nobjects: *a\n"),
    ("many-keys", "".join(f"k{i}: 1\n" for i in range(100000))),
    ("many-times-one-key", "camera: 1\n" * 100000),
    ("many-objects", SCENE + "".join(f"  o{i}: 1\n" for i in range(100000))),
    ("long-list", SCENE.replace("[0, 3, -5]", "[" + "1," * 500000 + "]")),
    ("long-key", "k" * 4000000 + ": 1\n"),
    ("long-value", "camera: " + "k" * 4000000 + "\n"),
    ("long-line", "camera: {from: [" + " " * 4000000 + "x]}\n"),
    ("long-function", SCENE.replace("sin(u)", "+".join(["u"] * 100000))),
    ("deep-function", SCENE.replace("sin(u)", "(" * 3000 + "u" + ")" * 3000)),
]


@pytest.mark.parametrize("text", [case[1] for case in HOSTILE], ids=[case[0] for case in HOSTILE])
def test_hostile(bench: Kage, text: str) -> None:
    lines = refused_scene(bench, text)
    assert len(lines) <= 3 * 50 + 1
    assert max(map(len, lines)) < 1000


def test_all_errors_at_once(bench: Kage) -> None:
    text = SCENE.replace("fov: 40", "fov: 0").replace("color: [1, 1, 1]",
                                                      "color: 1").replace("radius: 0.5", "radius: x")
    text = text.replace("sin(u)", "sin(v)").replace("map.png", "none.png").replace("aa: 1", "ab: 1")
    lines = refused_scene(bench, text)
    assert [re.findall(r"^scene.yaml:(\d+):", line)[0] for line in errors_in(lines)] == ["1", "3", "5", "13", "17",
                                                                                         "22"]
    assert lines[-1] == "6 errors"
    for k in range(6):
        check_caret(lines[3 * k :], text)


def test_errors_beyond_the_fiftieth_are_counted(bench: Kage) -> None:
    lines = refused_scene(bench, SCENE + "".join(f"k{i}: 1\n" for i in range(60)))
    assert len(errors_in(lines)) == 50
    assert lines[-1] == "60 errors, the first of them above"


def test_control_characters_stay_off_the_terminal(bench: Kage) -> None:
    text = SCENE + '"\\e[2J\\a\\u009b": "\x1b[31m\u009b"\n'
    done = bench.folder / "scene.yaml"
    done.write_text(text)
    raw = subprocess.run([PROGRAM, "check", done], capture_output=True, check=False).stderr
    assert b"\x1b" not in raw and b"\x07" not in raw and b"\xc2\x9b" not in raw
    assert raw.count(b"\n") >= 1


@pytest.mark.parametrize("end", ["\r\n", "\r", "\n"], ids=["crlf", "cr", "lf"])
def test_line_ends(bench: Kage, end: str) -> None:
    scene = bench.folder / "scene.yaml"
    scene.write_bytes(SCENE.replace("\n", end).encode())
    assert "object ball: sphere" in bench.good("check", "scene.yaml")
    lines = refused_scene(bench, SCENE.replace("radius: 0.5", "radius: 0").replace("\n", end))
    assert lines[0].startswith("scene.yaml:22:41: ")
    assert lines[1] == "   22 |     sphere: {center: [1, 1, 0], radius: 0}"


def test_byte_order_mark(bench: Kage) -> None:
    scene = bench.folder / "scene.yaml"
    scene.write_bytes(b"\xef\xbb\xbf" + SCENE.encode())
    assert "object ball: sphere" in bench.good("check", "scene.yaml")
    lines = refused_scene(bench, b"\xef\xbb\xbf" + SCENE.replace("camera", "camra").encode())
    assert lines[0] == "scene.yaml:1:1: the scene has no 'camra', did you mean 'camera'?"
    assert lines[2] == "      | ^"


def test_excerpt_of_a_long_line(bench: Kage) -> None:
    lines = refused_scene(bench, "camera: {from: [0, 0, 0], " + "ü" * 300 + ": 1, fvo: 2}\n")
    message = next(k for k, line in enumerate(lines) if "'fvo'" in line)
    assert lines[message].startswith("scene.yaml:1:332: ")
    assert lines[message + 1][lines[message + 2].index("^") :].startswith("fvo: 2}")


#: What a key at the top may hold instead of what it should; None: it is not there.
MISFITS = {"missing": None, "empty": "", "no-items": " {}", "list": " [1]", "no-list": " []", "number": " 3",
           "empty-item": " {a: }"}


@pytest.mark.parametrize("what", MISFITS)
@pytest.mark.parametrize("key", ["camera", "image", "render", "lights", "materials", "objects"])
def test_any_key_at_the_top(bench: Kage, key: str, what: str) -> None:
    kept = [part for part in re.split(r"(?m)^(?=\w)", SCENE) if part and not part.startswith(f"{key}:")]
    assert len(kept) == 5
    (bench.folder / "scene.yaml").write_text("".join(kept) + ("" if MISFITS[what] is None
                                                              else f"{key}:{MISFITS[what]}\n"))
    for command, *options in (["check"], ["pixel", "3,3"], ["render", "-o", "out.png"], ["pov", "-o", "out.pov"]):
        done = bench(command, "scene.yaml", *options)
        assert done.returncode in (0, 2), done.stderr
        placed = re.match(r"scene\.yaml:\d+:\d+: .", done.stderr)
        assert bool(placed) == (done.returncode == 2), done.stderr


def test_scene_that_cannot_be_read(kage: Kage) -> None:
    assert refused(kage, "check", "none.yaml") == ["none.yaml: can't read the scene: No such file or directory"]
    assert refused(kage, "check", ".") == [".: can't read the scene: Is a directory"]
    assert refused(kage, "check", "") == [": can't read the scene: No such file or directory"]


# ---- --set ----

SET = [
    ("path-top", "objcts.ground.bump.scale=1", "1:1: the scene has no 'objcts' here, did you mean 'objects'?"),
    ("path-middle", "objects.grond.bump.scale=1", "1:9: the scene has no 'grond' here, did you mean 'ground'?"),
    ("path-far", "objects.sea.bump.scale=1",
     "1:9: the scene has no 'sea' here, expected one of: ground wall cube ball"),
    ("path-below", "camera.fov.x=1",
     "1:12: no 'x' here: what stands before it is a single value, expected a map or a list"),
    ("path-dots", "camera..fov=1",
     "1:8: no name here, expected names of letters, digits, _ and - with dots between them"),
    ("path-end", "camera.=1", "1:8: no name here, expected names of letters, digits, _ and - with dots between them"),
    ("path-blank", "camera. fov=1",
     "1:8: no name here, expected names of letters, digits, _ and - with dots between them"),
    ("key", "camera.fvo=1", "1:8: camera has no 'fvo', did you mean 'fov'?"),
    ("key-top", "camra=1", "1:1: the scene has no 'camra', did you mean 'camera'?"),
    ("index", "camera.from.3=1", "1:13: no item '3' in this list, expected a number from 0 to 2"),
    ("index-negative", "camera.from.-1=1", "1:13: no item '-1' in this list, expected a number from 0 to 2"),
    ("index-name", "camera.from.x=1", "1:13: no item 'x' in this list, expected a number from 0 to 2"),
    ("index-type", "camera.from.1=up", "1:15: 'up' is no number, expected the eye's place [x, y, z]"),
    ("type", "camera.from=1", "1:13: a single value, expected the eye's place [x, y, z]"),
    ("type-map", "camera=wide", "1:8: camera is a single value, expected a map"),
    ("nothing", "camera.fov=", "1:12: no value, expected one after '='"),
    ("range", "camera.fov=180",
     "1:12: 180 is more than 175, expected the horizontal angle in degrees, above 0 and up to 175"),
    ("inside", "camera={from: [0, 0, 0], at: [1]}", "1:30: 1 value, expected the place looked at [x, y, z]"),
    ("lacking", "camera={from: [0, 0, 0]}", "1:8: camera lacks its 'at'"),
    ("function", "objects.ground.bump.function=0.1 * sinn(u)", "1:36: unknown function 'sinn', did you mean 'sin'?"),
    ("function-quoted", "objects.ground.bump.function='0.1 * sinn(u)'",
     "1:37: unknown function 'sinn', did you mean 'sin'?"),
    ("lines", "camera={from: [0, 0, 0],\nat: [1]}", "1:25: a line break, expected the change on one line"),
    ("alias", "camera.fov=*x",
     "1:13: an alias, which kage does not take, expected the horizontal angle in degrees, above 0 and "
     "up to 175"),
]


@pytest.mark.parametrize(("change", "message"), [case[1:] for case in SET], ids=[case[0] for case in SET])
def test_set(bench: Kage, change: str, message: str) -> None:
    lines = refused_scene(bench, SCENE, "--set", "image.size=[20, 20]", "--set", change)
    assert lines[0] == f"--set:{message}"
    check_caret(lines, change)


@pytest.mark.parametrize("value", ["[1, 2", "{", '"', "]", "'a' b", "a: b: c"])
def test_set_syntax(bench: Kage, value: str) -> None:
    change = f"camera.from={value}"
    lines = refused_scene(bench, SCENE, "--set", change)
    assert re.match(r"--set:1:\d+: ", lines[0])
    check_caret(lines, change)


def test_set_in_a_map_that_the_scene_lacks(bench: Kage) -> None:
    text = re.sub(r"(image|render): .*\n", "", SCENE)
    lines = refused_scene(bench, text, "--set", "render.foo=1", "--set", "image.size=3", "--set", "image.size.0=3")
    assert errors_in(lines) == [
        "--set:1:12: no '0' here: what stands before it is a single value, expected a map or a list",
        "--set:1:12: a single value, expected [width, height] in pixels, from 1 to 32768",
        "--set:1:8: render has no 'foo', expected one of: shadow guard shade bump_shadow aa "
        "aa_threshold depth surface self_shadow",
    ]
    assert lines[-1] == "3 errors"


@pytest.mark.parametrize("setting", ["render.shadow=exact", "render.surface=displaced"])
@pytest.mark.parametrize("function", ["u", "floor(u)", "1/u"])
def test_truth_needs_bounds(bench: Kage, setting: str, function: str) -> None:
    lines = refused_scene(bench, SCENE.replace("0.1 * sin(u)", function), "--set", setting)
    assert lines[0] == (
        "scene.yaml:13:7: no bounds of P or of its slope are known, expected them for "
        f"{setting.split('.')[1].replace('=', ' ')}: a function that is bounded, without jumps, over the whole surface"
    )


def test_set_mistakes_are_told_one_by_one(bench: Kage) -> None:
    lines = refused_scene(bench, SCENE, "--set", "camera.from=[1", "--set", "camera.at={", "--set", "a.b=1")
    assert [line.split(" | ")[1] for line in lines[1::3]] == ["camera.from=[1", "camera.at={", "a.b=1"]


def test_set_bytes(bench: Kage) -> None:
    (bench.folder / "scene.yaml").write_text(SCENE)
    command = [bytes(PROGRAM), b"check", b"scene.yaml", b"--set", b"camera.fov=\xff"]
    done = subprocess.run(command, cwd=bench.folder, capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (2, b"--set: a byte that is no UTF-8\n")


# ---- the command line ----

COMMAND = [
    ("command", ["rendr"],
     "no command 'rendr', did you mean 'render'? See kage --help"),
    ("command-far", ["draw"],
     "no command 'draw', expected one of: render view check pixel pov import methods help; see kage --help"),
    ("no-scene", ["render"], "'kage render' lacks its SCENE; see kage render --help"),
    ("no-scene-check", ["check"], "'kage check' lacks its SCENE; see kage check --help"),
    ("no-pixel", ["pixel", "scene.yaml"], "'kage pixel' lacks its X,Y; see kage pixel --help"),
    ("two-scenes", ["render", "scene.yaml", "b.yaml"], "b.yaml: one argument too many; see kage render --help"),
    ("option", ["render", "scene.yaml", "--fast"], "--fast: no option of 'kage render'; see kage render --help"),
    ("option-short", ["render", "scene.yaml", "-x"], "-x: no option of 'kage render'; see kage render --help"),
    ("option-near", ["render", "scene.yaml", "--shadows", "2"],
     "--shadows: no option of 'kage render', did you mean '--shadow'? See kage render --help"),
    ("option-near-value", ["render", "scene.yaml", "--treads=2"],
     "--treads: no option of 'kage render', did you mean '--threads'? See kage render --help"),
    ("option-of-another", ["check", "scene.yaml", "--crop", "0,0,1,1"],
     "--crop: no option of 'kage check'; see kage check --help"),
    ("flag-value", ["render", "scene.yaml", "--quiet=1"], "--quiet takes no value; see kage render --help"),
    *[(f"lacks{name}", ["render", "scene.yaml", name], f"{name} lacks its value; see kage render --help")
      for name in ("-o", "--shadow", "--size", "--aa", "--aa-threshold", "--crop", "--threads", "--bits", "--set")],
    ("ending", ["render", "scene.yaml", "-o", "out.jpg"],
     "-o out.jpg: no such kind of picture, expected a name that ends in .png or .exr, or - for a PNG to standard "
     "output"),
    ("ending-none", ["render", "scene.yaml", "-o", "out"],
     "-o out: no such kind of picture, expected a name that ends in .png or .exr, or - for a PNG to standard "
     "output"),
    ("ending-alone", ["render", "scene.yaml", "-o", ".png"],
     "-o .png: no such kind of picture, expected a name that ends in .png or .exr, or - for a PNG to standard "
     "output"),
    ("shadow", ["render", "scene.yaml", "--shadow", "3"],
     "--shadow 3: no such method, expected none, 0, 1, 2, 2+, iter:K, march:N, exact or auto[:E]"),
    ("shadow-steps", ["render", "scene.yaml", "--shadow", "march:0"],
     "--shadow march:0: expected a whole number from 1 to 1024 after march:"),
    *[(f"size-{size}", ["render", "scene.yaml", "--size", size],
       f"--size {size}: expected WIDTHxHEIGHT, each from 1 to 32768")
      for size in ("640", "640x", "640x480x2", "0x480", "-1x5", "640X480", "1e2x5", "32769x1", "99999999999x1", "")],
    *[(f"aa-threshold-{t}", ["render", "scene.yaml", "--aa-threshold", t],
       f"--aa-threshold {t}: expected how much two pixels may differ, 0 to 3")
      for t in ("x", "-1", "3.1", "1e-3", "0.1.2", "")],
    *[(f"aa-{aa}", ["render", "scene.yaml", "--aa", aa],
       f"--aa {aa}: expected the samples along a pixel's side, 1 to 16")
      for aa in ("0", "17", "two", "1.5")],
    *[(f"threads-{n}", ["render", "scene.yaml", "--threads", n], f"--threads {n}: expected a number from 1 to 1024")
      for n in ("0", "-1", "1025", "all")],
    *[(f"crop-{crop}", ["render", "scene.yaml", "--crop", crop],
       f"--crop {crop}: expected X0,Y0,X1,Y1 in pixels, with X0 < X1 and Y0 < Y1")
      for crop in ("1,2,3", "5,0,5,9", "0,9,9,0", "0,0,1,1,1", "a,0,1,1")],
    ("crop-outside", ["render", "scene.yaml", "--crop", "0,0,41,30"],
     "--crop 0,0,41,30: the picture is 40 x 30 pixels"),
    ("bits", ["render", "scene.yaml", "--bits", "12"], "--bits 12: expected 8 or 16"),
    ("set-no-value", ["render", "scene.yaml", "--set", "camera.fov"],
     "--set camera.fov: expected PATH=VALUE, as objects.ground.bump.scale=0.1"),
    ("set-no-path", ["render", "scene.yaml", "--set", "=1"],
     "--set =1: expected PATH=VALUE, as objects.ground.bump.scale=0.1"),
    ("set-many", ["render", "scene.yaml", *["--set", "camera.fov=20"] * 257], "more than 256 changes of the scene"),
    ("outputs-many", ["render", "scene.yaml", *["-o", "a.png"] * 17], "more than 16 outputs"),
    *[(f"pixel-{xy}", ["pixel", "scene.yaml", xy], f"{xy}: expected a pixel X,Y, from the top left")
      for xy in ("1", "1,", "1,2,3", "x,y", "1;2", "")],
    ("pixel-negative", ["pixel", "scene.yaml", "-1,0"], "-1,0: no option of 'kage pixel'; see kage pixel --help"),
    ("pixel-outside", ["pixel", "scene.yaml", "40,0"], "40,0: the picture is 40 x 30 pixels, expected 0,0 to 39,29"),
]


@pytest.mark.parametrize(("command", "message"), [case[1:] for case in COMMAND], ids=[case[0] for case in COMMAND])
def test_command_line(bench: Kage, command: list[str], message: str) -> None:
    (bench.folder / "scene.yaml").write_text(SCENE)
    assert refused(bench, *command) == [f"kage: {message}"]


def test_no_arguments_give_the_help(kage: Kage) -> None:
    lines = refused(kage)
    assert any("Usage: kage COMMAND" in line for line in lines)


# ---- the reference page ----

PAGE = TOP / "docs" / "scene.md"


def yaml_blocks() -> list[tuple[int, str]]:
    """The page's examples, with the lines they begin at."""
    text = PAGE.read_text()
    return [(text[: match.start()].count("\n") + 1, match[1])
            for match in re.finditer(r"```yaml\n(.*?)```", text, re.DOTALL)]


def completed(fragment: str) -> str:
    """A whole scene around a fragment: what it lacks at the top comes from a plain scene; a bump lies on a sphere."""
    plain = {
        "camera": "camera: {from: [0, 3, -5], at: [0, 0, 0]}\n",
        "lights": "lights:\n  lamp: {at: [-4, 5, -2]}\n",
        "materials": "materials:\n  clay: {color: [0.8, 0.7, 0.6]}\n",
        "objects": "objects: {}\n",
    }
    if fragment.startswith("bump:"):
        bump = "".join("    " + line + "\n" for line in fragment.splitlines())
        fragment = "objects:\n  it:\n    sphere: {center: [0, 0, 0], radius: 1}\n    material: clay\n" + bump
    missing = [text for key, text in plain.items() if not re.search(rf"^{key}:", fragment, re.MULTILINE)]
    return fragment + "".join(missing)


@pytest.mark.parametrize("block", yaml_blocks(), ids=lambda block: f"line-{block[0]}")
def test_examples_of_the_page(kage: Kage, images: Path, block: tuple[int, str]) -> None:
    (kage.folder / "scene.yaml").write_text(completed(block[1]))
    (kage.folder / "bumps.png").symlink_to(images / "map.png")
    (kage.folder / "heights.exr").symlink_to(images / "two.exr")
    (kage.folder / "wood.png").symlink_to(images / "color.png")
    (kage.folder / "pebbles.csv").write_text("x,y,z,scale\n0,1,0,0.1\n")
    assert "warning" in kage.good("check", "scene.yaml")


def test_the_page_names_every_key() -> None:
    """Every key that the reader takes stands in the page as code."""
    source = "".join(path.read_text() for path in (TOP / "src" / "read").glob("*.c"))
    keys = {key for words in re.findall(r'yaml_map\([^;]*?"([a-z_ ]+)"\)', source) for key in words.split()}
    assert {"camera", "fov", "phong_size", "samples", "tightness", "encoding"} <= keys
    text = PAGE.read_text()
    assert not [key for key in sorted(keys) if not re.search(rf"`{key}[`:]|^\s*{key}:|[{{ ]{key}:", text, re.MULTILINE)]


STRETCHED = SCENE.replace(
    "radius: 0.5}\n", "radius: 0.5}\n    bump: {function: 0.1 * sin(u)}\n    transform: [{scale: [1, 2, 1]}]\n"
)


@pytest.mark.parametrize(("change", "what"),
                         [("render.surface=displaced", "surface displaced"), ("render.shadow=exact", "shadow exact")])
def test_stretched_and_displaced(bench: Kage, change: str, what: str) -> None:
    """No foot is known of what a stretched cylinder becomes, and with caps it is no one sheet; without a need for one
    it serves, and open, and an ellipsoid."""
    drum = "cylinder: {from: [1, 1, 0], to: [1, 2, 0], radius: 0.5}"
    message = ("a cylinder with caps and a bump is scaled differently along its axes, expected equal scales, or "
               f"'open: true', for {what}")
    ball = "sphere: {center: [1, 1, 0], radius: 0.5}"
    assert refused_scene(bench, STRETCHED.replace(ball, drum), "--set", change)[0] == f"scene.yaml:24:16: {message}"
    egg = "  egg: {copy: ball, transform: [{scale: [1, 2, 1]}]}\n"
    copied = SCENE.replace(ball, drum) + "    bump: {function: 0.1 * sin(u)}\n" + egg
    assert refused_scene(bench, copied, "--set", change)[0] == f"scene.yaml:25:32: {message}"
    (bench.folder / "scene.yaml").write_text(STRETCHED.replace(ball, drum))
    bench.good("render", "scene.yaml", "-o", "out.png", "--quiet", "--shadow", "march:4")
    for shape in (ball, drum.replace("}", ", open: true}"), "box: {from: [1, 1, 0], to: [2, 2, 1]}"):
        (bench.folder / "scene.yaml").write_text(STRETCHED.replace(ball, shape))
        bench.good("render", "scene.yaml", "-o", "out.png", "--quiet", "--set", change)


def test_copies(bench: Kage) -> None:
    """A copy that moves nothing is the object itself, whatever the order; what it says itself comes on top."""
    copies = SCENE.replace("objects:\n", "objects:\n  early: {copy: late}\n") + (
        "  late: {copy: wall, material: clay, transform: [{translate: [0, 1, 0]}]}\n"
        "  plain: {copy: late, bump: {function: 0.2 * u}}\n"
    )
    (bench.folder / "scene.yaml").write_text(copies)
    told = bench.good("check", "scene.yaml")
    assert "object early: rectangle, copy of wall, transformed, material clay, bump by map" in told
    assert "object late: rectangle, copy of wall, transformed, material clay, bump by map" in told
    assert "object plain: rectangle, copy of wall, transformed, material clay, bump by function" in told
    assert "object wall: rectangle, material clay, bump by map" in told


def test_a_transform_as_said_otherwise(bench: Kage) -> None:
    """The same picture by a transform and without it, to the last digit where the numbers bear it; --set reaches into
    transforms."""
    (bench.folder / "scene.yaml").write_text(SCENE)
    moves = "[{rotate: [0, 90, 0]}, {scale: 2}, {translate: [0, 0.5, 0]}]"
    for name, shape in (
        ("plane", "{origin: [0, 0.5, 0], u: [2, 0, 0], w: [0, 0, -2]}"),
        ("box", "{from: [-2, 1.5, 0], to: [0, 3.5, 2]}"),
    ):
        thing = {"plane": "ground", "box": "cube"}[name]
        bench.good("render", "scene.yaml", "-o", "a.png", "--quiet", "--set", f"objects.{thing}.transform={moves}")
        bench.good("render", "scene.yaml", "-o", "b.png", "--quiet", "--set", f"objects.{thing}.{name}={shape}")
        a, b = (np.asarray(Image.open(bench.folder / file)).astype(int) for file in ("a.png", "b.png"))
        assert np.mean(np.abs(a - b) > 1) < 0.005
    # from far away
    for file, center, way in (("a.png", "[0.25, 1, 0]", "[0, 0, 0]"), ("b.png", "[2e5, 1, 0]", "[-199999.75, 0, 0]")):
        ball = (f"{{sphere: {{center: {center}, radius: 1}}, material: clay, "
                "bump: {function: 0.03*sin(9*u)*sin(9*w)}, "
                f"transform: [{{translate: {way}}}, {{rotate: [0, 0, 0]}}]}}")
        bench.good("render", "scene.yaml", "-o", file, "--quiet", "--surface", "displaced", "--set",
                   f"objects.ball={ball}")
    a, b = (np.asarray(Image.open(bench.folder / file)) for file in ("a.png", "b.png"))
    assert np.array_equal(a, b)
    bench.good("render", "scene.yaml", "-o", "a.png", "--quiet", "--set", f"objects.cube.transform={moves}", "--set",
               "objects.cube.transform.1.scale=[1, 1, 1]")
