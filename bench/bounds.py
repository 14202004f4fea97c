"""What kage demands of "the whole truth at the price of an order": each bound with its figures, as a claim.

The verdicts are those of bench/claims.py. Times are judged by their intervals. `make bench` prints a line for each
case.

All costs are in times that of bump mapping only (`none`), on one thread. Shares of wrong pixels are those of the cast
shadow against kage's exact; shares of pixels that are off by more than 8/255 are those of bench/whole.py, away from the
silhouette.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from bench import claims, data, whole_tables
from bench.claims import at_least, at_most, decided, interval_text, made, unmeasured
from bench.data import BUMP_ONLY, Case, Claim, Report

WHO = "bound"
SOURCE = "docs/method.md"
EXACT_COST, DISPLACED_COST = 6.0, 10.0  # times bump only, on figure 5's scene
EMBREE_MESH = "Embree 3, displaced mesh of 1024 x 1024"
FASTER = 3.0  # times
# Instructions of exact and displaced before, in times those of bump only: commit 7927432, callgrind, 160 x 120 pixels.
BEFORE: Mapping[str, Mapping[str, float]] = {
    "exact": {"cube": 32.1, "sphere": 37.3, "terrain": 46.5, "torus": 28.1, "waves": 78.2},
    "displaced": {"cube": 52.4, "sphere": 92.3, "terrain": 86.4, "torus": 43.4, "waves": 103.6},
}
AUTO = "auto"
AUTO_WRONG = whole_tables.LEAST_WRONG  # % of the shadow's pixels
AUTO_COST = {"waves": 1.4, "cube": 1.4, "sphere": 1.8, "terrain": 2.0}  # times bump only
RELIEF = "relief"
RELIEF_COST = 4.0  # times bump only
RELIEF_OFF = 1.0  # % of the receiver's pixels away from the silhouette


def cost_case(report: Report, scene: str, method: str, bound: float) -> Case:
    name, found = f"{method} on {scene}", data.times_none(data.cost(report, scene, method))
    if found is None:
        return unmeasured(name, "the time")
    return {"case": name, "verdict": at_most(found, bound),
            "detail": f"{interval_text(found, '.2f', f'times {BUMP_ONLY}')}, at most {bound:g}"}


def share_case(name: str, value: float | None, bound: float, what: str) -> Case:
    if value is None:
        return unmeasured(name, what)
    return {"case": name, "verdict": decided(value <= bound), "detail": f"{value:.3g} % {what}, at most {bound:g}"}


def exact_cost(report: Report) -> Claim:
    cube = claims.PAPER_SCENE
    return made("exact-cost", WHO, "To find the true hit is cheap.", SOURCE,
                f"On figure 5's scene exact takes at most {EXACT_COST:g} times the time by {BUMP_ONLY}, and displaced "
                f"with the bumps' own shadows at most {DISPLACED_COST:g} times.",
                [cost_case(report, cube, "exact", EXACT_COST), cost_case(report, cube, "displaced", DISPLACED_COST)])


def embree(report: Report) -> Claim:
    """The peer's `times` are Embree's time over displaced's."""
    found = claims.peer_times(claims.peer_of(report, EMBREE_MESH, claims.PAPER_SCENE), "displaced")
    case: Case = unmeasured("cube", "the time of Embree's loop, or of displaced,") if found is None else {
        "case": "cube", "verdict": at_least(found, 1.0),
        "detail": interval_text(found, ".2f", "times displaced's time is Embree's")}
    return made("embree", WHO, "Displacement is no slower than Embree's own loop on a mesh of 1024 x 1024 cells.",
                SOURCE, "Embree's time a pixel (bench/limits) is at least displaced's, by the rounds' ratios.", [case])


def faster_cases(report: Report) -> Iterator[Case]:
    for method, before in BEFORE.items():
        for scene in data.costs(report):
            name, cost = f"{method} on {scene}", data.cost(report, scene, method)
            added = cost and cost["instructions_added"]
            if added is None or scene not in before:
                yield unmeasured(name, "the count of instructions")
                continue
            now = 1 + added / 100
            gain = before[scene] / now
            yield {"case": name, "verdict": decided(gain >= FASTER),
                   "detail": f"{now:.1f} times the instructions of {BUMP_ONLY}, {before[scene]:g} before: "
                             f"{gain:.1f} times as fast"}


def faster(report: Report) -> Claim:
    return made("faster", WHO, f"exact and displaced are at least {FASTER:g} times as fast as before.", SOURCE,
                "By the instructions of the render, which are the same on any processor: those before over those now, "
                f"both in times those of {BUMP_ONLY}.", list(faster_cases(report)))


def auto_wrong(report: Report) -> Claim:
    shares = {scene: whole_tables.exact_wrong(report, scene, AUTO) for scene in data.qualities(report)}
    cases = [share_case(scene, share, AUTO_WRONG, "of the shadow's pixels wrong") for scene, share in shares.items()]
    return made("auto-wrong", WHO, "auto is as good as exact.", SOURCE,
                f"By auto, at a quarter of a pixel, at most {AUTO_WRONG:g} % of the shadow's pixels are wrong.", cases)


def least_cost_case(report: Report, scene: str) -> Case:
    """The cheapest auto beside the cheapest of the others."""
    costs = [(method, cost) for method in whole_tables.good_enough(report, scene)
             if (cost := data.times_none(data.cost(report, scene, method))) is not None]
    ours, others = ([item for item in costs if (item[0].partition(":")[0] == AUTO) is own] for own in (True, False))
    if not costs:
        return unmeasured(scene, "cost or quality")
    detail = ", ".join(f"{method} {interval_text(cost, '.2f', 'times')}" for method, cost in costs)
    verdict = at_least(claims.ratio(others[0][1], ours[0][1]), 1.0) if ours and others else decided(bool(ours))
    return {"case": scene, "verdict": verdict, "detail": f"{detail} {BUMP_ONLY}"}


def auto_least(report: Report) -> Claim:
    return made("auto-least", WHO, "No other method is as good for less.", SOURCE,
                f"Of all methods with at most {AUTO_WRONG:g} % wrong pixels auto has the least cost, by the intervals "
                "of the medians.",
                [least_cost_case(report, scene) for scene in data.qualities(report)])


def auto_cost(report: Report) -> Claim:
    limits = ", ".join(f"{scene} {bound:g}" for scene, bound in AUTO_COST.items())
    return made("auto-cost", WHO, "auto costs little.", SOURCE, f"At most, in times {BUMP_ONLY}: {limits}.",
                [cost_case(report, scene, AUTO, bound) for scene, bound in AUTO_COST.items()])


def relief(report: Report) -> Claim:
    scenes: Sequence[str] = list(data.wholes(report)) or [claims.PAPER_SCENE]
    cases = [cost_case(report, scene, RELIEF, RELIEF_COST) for scene in scenes]
    cases += [share_case(f"off, {scene}", whole_tables.off(report, scene, RELIEF), RELIEF_OFF,
                         "of the pixels off by more than 8/255") for scene in scenes]
    return made("relief", WHO, "`--relief` is true displacement to the eye, at the price of a few look-ups.", SOURCE,
                f"It takes at most {RELIEF_COST:g} times the time by {BUMP_ONLY}, and at most {RELIEF_OFF:g} % of the "
                "receiver's pixels, away from the silhouette, are off by more than 8/255 from displaced with all "
                "shadows.", cases)


ALL = (exact_cost, embree, faster, auto_wrong, auto_least, auto_cost, relief)


def bounds(report: Report) -> list[Claim]:
    """All bounds, judged by the data of a report. Any part of it may be missing."""
    return [judge(report) for judge in ALL]


def lines(judged: Sequence[Claim]) -> list[str]:
    """For a terminal: a line for each case of each bound."""
    return [f"bound {claim['id']}: {case['case']}: {case['detail']}: {case['verdict']}"
            for claim in judged if claim["who"] == WHO for case in claim["cases"]]
