"""Each bound's figure with its interval, and whether it is met.

A bound is met where all of the interval is within it, missed where none is, otherwise undecided.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from bench.speed.plan import Bound
from bench.speed.rounds import Results
from bench.stats import Interval

MET, MISSED, UNDECIDED, UNMEASURED = "met", "missed", "undecided", "not measured"


@dataclass(frozen=True)
class Judged:
    """A bound, its figure and its verdict."""

    bound: Bound
    found: Interval | None
    verdict: str


def verdict(found: Interval | None, bound: Bound) -> str:
    if found is None:
        return UNMEASURED
    best, worst = (found["high"], found["low"]) if bound.at_least else (found["low"], found["high"])
    if bound.at_least:
        return MET if worst >= bound.limit else MISSED if best < bound.limit else UNDECIDED
    return MET if worst <= bound.limit else MISSED if best > bound.limit else UNDECIDED


def figure(results: Results, bound: Bound) -> Interval | None:
    """Ratios are taken round by round."""
    if bound.under is None:
        return results.interval(bound.over)
    return results.ratio(bound.over, bound.under)


def judge(results: Results, bounds: Sequence[Bound]) -> list[Judged]:
    found = [(bound, figure(results, bound)) for bound in bounds]
    return [Judged(bound, interval, verdict(interval, bound)) for bound, interval in found]
