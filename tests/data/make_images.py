#!/usr/bin/env python3
"""Make the OpenEXR files that tests/unit/image/test_image.c reads, of kinds that kage itself does not write.

Needs the packages OpenEXR (3.4 or later) and numpy. All hold, at column x of row y of the data window,
((7 x + 13 y) mod 64) / 64, which every sample type but uint holds exactly (uint: without the division).
"""
import os

import numpy
import OpenEXR

WIDTH, HEIGHT = 37, 23
here = os.path.dirname(os.path.abspath(__file__))

y, x = numpy.mgrid[0:HEIGHT, 0:WIDTH]
numbers = ((7 * x + 13 * y) % 64).astype(numpy.uint32)
half = (numbers / 64).astype(numpy.float16)
single = (numbers / 64).astype(numpy.float32)


def box(x0, y0, x1, y1):
    return numpy.array([x0, y0], numpy.int32), numpy.array([x1, y1], numpy.int32)


def write(name, channels, compression=OpenEXR.ZIP_COMPRESSION, **header):
    header = {"compression": compression, "type": OpenEXR.scanlineimage, **header}
    OpenEXR.File(header, channels).write(os.path.join(here, name))


def tiles(size, mode=OpenEXR.ONE_LEVEL):
    description = OpenEXR.TileDescription()
    description.xSize = description.ySize = size
    description.mode = mode
    return {"type": OpenEXR.tiledimage, "tiles": description}


# DWA is left out: the C library of 3.1 cannot decode it, and says so.
for kind in ["NO", "RLE", "ZIPS", "PIZ", "PXR24", "B44", "B44A"]:
    write(f"half-{kind.lower()}.exr", {"Y": half}, getattr(OpenEXR, kind + "_COMPRESSION"))
write("float-piz.exr", {"Y": single}, OpenEXR.PIZ_COMPRESSION)
write("uint.exr", {"count": numbers})
write("mixed.exr", {"A": half * 0, "Y": half, "Z": single + 1, "id": numbers})
write("tiled.exr", {"Y": half, "Z": single + 1}, **tiles(16))
# The data window is partly outside the display window, and begins below zero.
write("window.exr", {"Y": half}, dataWindow=box(-5, -3, WIDTH - 6, HEIGHT - 4), displayWindow=box(0, 0, 15, 99))
write("window-tiled.exr", {"Y": half}, dataWindow=box(-5, -3, WIDTH - 6, HEIGHT - 4),
      displayWindow=box(0, 0, 15, 99), **tiles(8))
write("upwards.exr", {"Y": half}, lineOrder=OpenEXR.DECREASING_Y)
bad = single.copy()
bad[5, 3] = numpy.nan
bad[6, 1] = numpy.inf
write("nan.exr", {"Y": bad})
OpenEXR.File([OpenEXR.Part({"type": OpenEXR.scanlineimage}, {"Y": half}, "one"),
              OpenEXR.Part({"type": OpenEXR.scanlineimage}, {"Y": half}, "two")]).write(
                  os.path.join(here, "parts.exr"))
deep = numpy.empty((HEIGHT, WIDTH), dtype=object)
for j in range(HEIGHT):
    for i in range(WIDTH):
        deep[j, i] = single[j, i:i + 1]
OpenEXR.File({"compression": OpenEXR.ZIPS_COMPRESSION, "type": OpenEXR.deepscanline}, {"Z": deep}).write(
    os.path.join(here, "deep.exr"))
