"""Statistics of repeated measurements: intervals, noise, Pareto fronts, exponents.

Times on a machine that does other things too have a long tail on one side, so everything here uses medians and ranks,
and assumes no distribution.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypedDict

import numpy as np

RESAMPLES = 10_000
SEED = 1990
CLEARANCE = 10.0  # times the floor: nearer to the floor, a fitted slope is too wrong


class Interval(TypedDict):
    """A median and the interval around it, in the unit of the values."""

    median: float
    low: float
    high: float
    n: int


def finite(values: Sequence[float]) -> np.ndarray:
    found = np.asarray(values, dtype=float)
    if found.ndim != 1 or found.size == 0 or not np.isfinite(found).all():
        raise ValueError(f"expected one or more finite numbers, got {values!r:.200}")
    return found


def interval(values: Sequence[float], confidence: float = 0.95, seed: int = SEED) -> Interval:
    """The median and its bootstrap percentile interval; the same for the same values in any order, as the seed is kept.

    `confidence` is between 0 and 1, exclusive. Few values make the interval narrower than its name says, as percentile
    bootstraps do: for an odd n its ends are order statistics, and of 7 values they are the 2nd and the 6th, which hold
    the true median in 1 - 2 (1 + 7) / 2^7 = 87.5 % of all cases, whatever the distribution. Of 3 values they are the
    outermost (75 %), as of 5 (93.8 %); of 11 the 3rd and the 9th (93.5 %), of 41 the 15th and the 27th (94.0 %). The
    interval of one value has no width, and no meaning.
    """
    if not 0 < confidence < 1:
        raise ValueError(f"a confidence is between 0 and 1, not {confidence}")
    found = np.sort(finite(values))
    drawn = np.random.default_rng(seed).integers(found.size, size=(RESAMPLES, found.size))
    medians = np.median(found[drawn], axis=1)
    low, high = np.quantile(medians, ((1 - confidence) / 2, (1 + confidence) / 2))
    return {"median": float(np.median(found)), "low": float(low), "high": float(high), "n": int(found.size)}


def paired_interval(values: Sequence[float], base: Sequence[float]) -> Interval:
    """By how many % the values are above their bases, pair by pair: what slows both of a pair alike has no effect."""
    a, b = finite(values), finite(base)
    if a.size != b.size:
        raise ValueError(f"{a.size} values can't be paired with {b.size}")
    if (b <= 0).any():
        raise ValueError("a base must be above 0")
    return interval(100 * (a / b - 1))


def apart(a: Interval, b: Interval) -> bool:
    """Whether two intervals have no value in common."""
    return a["high"] < b["low"] or b["high"] < a["low"]


def noise(values: Sequence[float]) -> float:
    """Half the interquartile range, in % of the median, which must be above 0."""
    low, middle, high = np.percentile(finite(values), (25, 50, 75))
    if middle <= 0:
        raise ValueError(f"noise is in % of a median above 0, this one is {middle:g}")
    return float(100 * (high - low) / 2 / middle)


def pareto(points: Sequence[tuple[float, float]]) -> list[int]:
    """The indices of the points (cost, error) that no other one dominates, the cheapest first.

    A point is dominated by one that is smaller in one of the two, and not larger in the other. So two equal points do
    not dominate each other.
    """
    found = np.asarray(points, dtype=float).reshape(-1, 2)
    if np.isnan(found).any():
        raise ValueError("a point is not a number")
    not_larger = (found[:, None] <= found[None]).all(axis=2)  # [i, j]: i is not larger than j in either
    smaller = (found[:, None] < found[None]).any(axis=2)
    dominated = np.atleast_1d((not_larger & smaller).any(axis=0))
    order = np.lexsort((found[:, 1], found[:, 0]))
    return [int(i) for i in order if not dominated[i]]


def fit_exponent(x: Sequence[float], y: Sequence[float | None], floor: float) -> float | None:
    """k of y = c x^k: the slope of log y over log x by least squares.

    A point counts only where y is known and more than CLEARANCE times the floor. The floor is the error of rounding, or
    of the truth itself; 0 or more. None where fewer than 3 different x are left.
    """
    pairs = [(a, b) for a, b in zip(x, y, strict=True) if b is not None and b > CLEARANCE * floor and math.isfinite(b)]
    if any(a <= 0 for a, _ in pairs):
        raise ValueError("a power is fitted to x above 0")
    if len({a for a, _ in pairs}) < 3:
        return None
    log_x, log_y = np.log(np.array(pairs)).T
    return float(np.polynomial.polynomial.polyfit(log_x, log_y, 1)[1])
