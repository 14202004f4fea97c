#!/usr/bin/env python3
"""Make scenes/data/jacksboro.exr from matplotlib's sample elevation model.

The elevations are whole metres from 236 to 1076. OpenEXR's half holds whole numbers up to 2048 exactly,
so the map keeps every sample in metres and needs no scale. As PIZ-compressed half it is also smaller
than a 16-bit PNG. See scenes/data/README.md for the origin and the units.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import OpenEXR
from matplotlib.cbook import get_sample_data

DATA = Path(__file__).resolve().parent.parent / "scenes" / "data"
CHANNEL = "elevation"


def elevation() -> np.ndarray:
    """The elevations in metres as half floats: first row north, first column west."""
    with np.load(get_sample_data("jacksboro_fault_dem.npz", asfileobj=False)) as dem:
        metres = dem["elevation"]
    half: np.ndarray = metres.astype(np.float16)
    if not np.array_equal(half, metres):
        raise SystemExit("make_dem: these elevations are not exact in half floats")
    return half


def main() -> None:
    parser = argparse.ArgumentParser(description="Make the elevation map (OpenEXR, one half channel, metres).")
    parser.add_argument("-o", "--output", type=Path, default=DATA / "jacksboro.exr", help="default: %(default)s")
    output = parser.parse_args().output
    output.parent.mkdir(parents=True, exist_ok=True)
    header = {
        "type": OpenEXR.scanlineimage,
        "compression": OpenEXR.PIZ_COMPRESSION,
        "comments": "Elevation in metres near Jacksboro, Tennessee; SRTM, public domain",
    }
    OpenEXR.File(header, {CHANNEL: elevation()}).write(str(output))


if __name__ == "__main__":
    main()
