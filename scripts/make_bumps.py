#!/usr/bin/env python3
"""Make scenes/data/bumps.png, the height map of the paper's figures.

The map shows 288 soft, rounded bumps. On a ground of 12 x 12 units they are 0.4 to 0.5 wide and
0.75 apart: about a third of a cube of 1.2, so that several of them meet each edge of its shadow.
The method needs a map with these properties:

- Smooth, as its first and second derivatives come from central differences: a sum of Gaussians,
  each some 30 samples wide, without noise.
- Even slopes. At a steep place orders 1 and 2 fall back (or fail, without the guard), and such a
  place would dominate the picture. So the bumps are on a jittered lattice; filtered noise has a
  few very steep places.
- Periodic, so that it can be repeated without a seam: distances are taken around the torus.
- All 65536 levels in use, so that the samples' rounding stays far below the bumps' curvature.

The same bytes come out of every run: the seed is fixed.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from PIL import Image

DATA = Path(__file__).resolve().parent.parent / "scenes" / "data"

SIZE = 512  # samples a side
COLUMNS, ROWS = 16, 18  # of bumps; 18/16 is near 2/sqrt(3): a lattice of equilateral triangles
JITTER = 0.22  # how far a bump may stand from its lattice point, in lattice steps
RADIUS = 0.28 / COLUMNS  # standard deviation of a bump, in widths of the map
UNEVEN = 0.3  # the lowest bump is this share lower than the highest
SEED = 1991


def profile(centres: np.ndarray) -> np.ndarray:
    """One Gaussian per centre (rows), at the middles of SIZE samples (columns) around a circle of length 1."""
    distance = (np.arange(SIZE) + 0.5) / SIZE - centres[:, None]
    distance -= np.rint(distance)
    heights: np.ndarray = np.exp(-0.5 * (distance / RADIUS) ** 2)
    return heights


def bumps() -> np.ndarray:
    """The heights, SIZE x SIZE, stretched to 0..65535."""
    random = np.random.default_rng(SEED)
    row, column = np.mgrid[0:ROWS, 0:COLUMNS]
    shift_x, shift_y = random.uniform(-JITTER, JITTER, (2, ROWS, COLUMNS))
    x = ((column + 0.5 * (row % 2) + shift_x) / COLUMNS).ravel()
    y = ((row + shift_y) / ROWS).ravel()
    weight = random.uniform(1.0 - UNEVEN, 1.0, ROWS * COLUMNS)
    # A Gaussian of two variables is a product, so the sum over the bumps is one matrix product.
    height: np.ndarray = (profile(y) * weight[:, None]).T @ profile(x)
    height = (height - height.min()) / (height.max() - height.min())
    levels: np.ndarray = np.rint(height * 65535.0).astype(np.uint16)
    return levels


def main() -> None:
    parser = argparse.ArgumentParser(description="Make the height map of the paper's figures (16-bit grey PNG).")
    parser.add_argument("-o", "--output", type=Path, default=DATA / "bumps.png", help="default: %(default)s")
    output = parser.parse_args().output
    output.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(bumps()).save(output, optimize=True)


if __name__ == "__main__":
    main()
