"""Height maps: P and its partials from samples, as kage looks them up (section 4.1 of the paper)."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from kage.methods import Bump, Like, Real


class HeightMap:
    """P(u,w) = scale (sample - zero), from a 2-D array: columns go along u, rows along w, the first at `offset`.

    size: of the map in u and w. wrap: "repeat" or "clamp". lie: where the samples are, in the middles of "cells",
    like pixels, or at the "corners" of a grid, the outermost at the map's edges; docs/scene.md has more about it.
    Integers are taken as they are: divide the samples of a PNG by 255 or 65535.

    A HeightMap is a Height of kage.methods: called with u and w it gives P. `bump` gives the partials, too: central
    differences at the samples; between samples each is interpolated bilinearly.
    """

    def __init__(self, samples: Like, size: tuple[float, float], *, scale: float = 1.0, zero: float = 0.0,
                 offset: tuple[float, float] = (0.0, 0.0), wrap: str = "repeat", lie: str = "cells") -> None:
        heights = np.asarray(samples, np.float64)
        if heights.ndim != 2 or min(heights.shape) < 2:
            raise ValueError(f"samples: expected an array of 2 x 2 or more, not {heights.shape}")
        if wrap not in ("repeat", "clamp") or lie not in ("cells", "corners"):
            raise ValueError(f'wrap={wrap!r}, lie={lie!r}: expected "repeat" or "clamp", "cells" or "corners"')
        if not min(size) > 0:
            raise ValueError(f"size={size}: expected two lengths above 0")
        self._clamp = wrap == "clamp"
        corners = lie == "corners"
        rows, columns = np.array(heights.shape) - corners
        self._per_unit = (columns / size[0], rows / size[1])  # samples per u and per w
        self._start = (offset[0] * self._per_unit[0] + (0 if corners else 0.5),
                       offset[1] * self._per_unit[1] + (0 if corners else 0.5))
        if corners and not self._clamp:
            heights = heights[:-1, :-1]  # the last sample is the first of the next copy
        self._planes = _differences(scale * (heights - zero), self._per_unit, self._clamp)

    @property
    def bounds(self) -> tuple[float, float]:
        """The lowest and the highest P."""
        return float(self._planes[0].min()), float(self._planes[0].max())

    def __call__(self, u: Like, w: Like) -> Real:
        """P at (u,w), in their precision."""
        cell = self._cell(np.asarray(u), np.asarray(w))
        return _bilinear(self._planes[0], cell)

    def bump(self, u: Like, w: Like) -> Bump:
        """P and its partials at (u,w)."""
        u, w = np.asarray(u), np.asarray(w)
        cell = self._cell(u, w)
        values = [_bilinear(plane, cell) for plane in self._planes]
        if self._clamp:
            rows, columns = self._planes[0].shape
            x, y = (z * k - o for z, k, o in zip((u, w), self._per_unit, self._start, strict=True))
            in_u, in_w = (x >= 0) & (x <= columns - 1), (y >= 0) & (y <= rows - 1)
            values = [v * inside for v, inside in zip(values, (1, in_u, in_w, in_u, in_u & in_w, in_w), strict=True)]
        return Bump(*values)

    def _cell(self, u: npt.NDArray[Any], w: npt.NDArray[Any]) -> tuple[Any, ...]:
        """The four samples around a place, and where it lies between them."""
        out: list[Any] = []
        for z, k, o, n in zip((u, w), self._per_unit, self._start, self._planes[0].shape[::-1], strict=True):
            x = np.asarray(z, np.float64) * k - o
            x = np.clip(x, 0, n - 1) if self._clamp else x
            first = np.floor(x)
            low = first.astype(np.int64)
            last = np.minimum(low + 1, n - 1) if self._clamp else (low + 1) % n
            out += [low if self._clamp else low % n, last, (x - first).astype(np.result_type(z, np.float32))]
        return tuple(out)


def _bilinear(plane: npt.NDArray[Any], cell: tuple[Any, ...]) -> Real:
    left, right, x, above, below, y = cell
    plane = plane.astype(np.result_type(x, y), copy=False)
    top = plane[above, left] + (plane[above, right] - plane[above, left]) * x
    bottom = plane[below, left] + (plane[below, right] - plane[below, left]) * x
    return top + (bottom - top) * y  # type: ignore[no-any-return]


def _differences(P: npt.NDArray[Any], per_unit: tuple[float, float], clamp: bool) -> tuple[npt.NDArray[Any], ...]:
    """P, Pu, Pw, Puu, Puw, Pww at the samples."""
    wide = np.pad(P, 1, mode="edge" if clamp else "wrap")
    ku, kw = per_unit
    here = slice(1, -1)
    along_u = (wide[:, 2:] - wide[:, :-2]) * (ku / 2)
    along_w = (wide[2:, here] - wide[:-2, here]) * (kw / 2)
    bend_u = (wide[here, 2:] - 2 * P + wide[here, :-2]) * ku**2
    bend_w = (wide[2:, here] - 2 * P + wide[:-2, here]) * kw**2
    twist = (along_u[2:] - along_u[:-2]) * (kw / 2)
    return P, along_u[here], along_w, bend_u, twist, bend_w
