"""What the paper claims, and what kage claims of itself, judged by the numbers of a report.

Each claim is a function of the report's data (bench/summary.py makes them), with its test and bound written out. The
paper gives no numbers: it judged figures 4 to 8 by eye, so the bounds are ours, the constants below with their reasons.
Each claim is judged case by case, as it may hold for one scene and not for the next.

The verdicts

    of a measured time, which has an interval: "holds" or "does not hold" where all of the interval is on one side of
    the bound, "undecided" where it straddles the bound or comes from fewer than LEAST_RUNS runs
    of a share or distance, which has no noise: "holds" or "does not hold"
    "not measured" where a number is missing
    of a claim as a whole: see `overall`
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from typing import Any, TypedDict

from bench.stats import Interval

HOLDS = "holds"
IN_PART = "holds in part"
FAILS = "does not hold"
UNDECIDED = "undecided"
UNMEASURED = "not measured"

PAPER_SCENE = "cube"  # figures 4 to 7
MERIT_SCENE = "waves"  # function data with slopes below 0.35
ORDERS = ("0", "1", "2")
MERIT = ("none", "0", "1", "2", "2+")  # each better than the one before
TRUTHS = {"mask": "POV-Ray's displacement", "exact": "kage's exact"}  # by a method's key for them, the better one first
BUMP_MAP = "POV-Ray, bump_map"
PEER = "POV-Ray, "  # how the names of all of POV-Ray's ways start
FLAT_PEERS = (BUMP_MAP, "POV-Ray, smooth, no bumps")  # without displacement; the first that a scene has is the base

# An edge that is off by a pixel on average is seen; one off by less is about as good as its grid of pixels can draw it.
SEEN = 1.0  # pixels
# `none` should not move the edge at all; this allows for the odd pixel that falls on the other side.
STAYS = 0.1  # pixels
WIDTH = 640  # of the pictures whose pixels the two above are; those of finer masks are that much smaller
# "Roughly" the shadow that fits the bumps: nearer to that shadow than to the one of the smooth surface.
ROUGHLY = 0.5  # of none's distance
# "Not much different" in cost: at most a tenth.
HARDLY = 10.0  # % over none
# "Clearly" cheaper: not by a difference that nobody would notice, however well it is measured.
CLEARLY = 1.0  # % of none's time
# "Enough", and "no great difference" between orders: the greater part by far of what there is to gain.
MOST = 0.75
# 1 % of a shadow of 200 x 200 pixels, as large as figure 5's at 640x480, is an edge off by half a pixel all around.
RIGHT = 1.0  # % wrong pixels
LARGE_SLOPE = 1.0  # 45 degrees; an order that is right up to here does reach large amplitudes
# "Expensive" is what one would rather not pay: the double.
EXPENSIVE = 2.0  # times
# kage's own, which the project demands of itself.
FASTER = 40.0  # times
ORDER_0_COST = 8.0  # % over none
LEAST_CLOSE = {"self": 99.5, "cast": 99.8}  # % of the pixels within 1/255
MOST_DIFFERENT = {"mask": 0.1}  # % of the shadow's pixels

LEAST_RUNS = 3  # of fewer runs no interval tells the noise

Data = dict[str, Any]


class Case(TypedDict):
    """A claim's verdict on one scene, method or peer, and the numbers it is drawn from."""

    case: str
    verdict: str
    detail: str


class Claim(TypedDict):
    """As it stands in report.json."""

    id: str
    who: str  # paper or kage
    sentence: str
    source: str
    test: str
    verdict: str
    cases: list[Case]


# Verdicts -------------------------------------------------------------------------------------------


def decided(good: bool) -> str:
    return HOLDS if good else FAILS


def at_most(value: Interval, bound: float) -> str:
    if value["n"] < LEAST_RUNS or value["low"] <= bound < value["high"]:
        return UNDECIDED
    return decided(value["high"] <= bound)


def at_least(value: Interval, bound: float) -> str:
    if value["n"] < LEAST_RUNS or value["low"] < bound <= value["high"]:
        return UNDECIDED
    return decided(value["low"] >= bound)


def overall(verdicts: Iterable[str]) -> str:
    """Of all cases; those that are not measured don't count while others are.

    One case that fails refutes the claim: what is left is that it holds in part, if in any. Where none fails, one case
    that is undecided leaves the whole undecided.
    """
    found = set(verdicts) - {UNMEASURED}
    if not found:
        return UNMEASURED
    if FAILS in found or IN_PART in found:
        return IN_PART if found & {HOLDS, IN_PART} else FAILS
    return UNDECIDED if UNDECIDED in found else HOLDS


def made(name: str, who: str, sentence: str, source: str, test: str, cases: Sequence[Case]) -> Claim:
    return {"id": name, "who": who, "sentence": sentence, "source": source, "test": test,
            "verdict": overall(case["verdict"] for case in cases), "cases": list(cases)}


def unmeasured(name: str, what: str) -> Case:
    return {"case": name, "verdict": UNMEASURED, "detail": f"{what} not measured"}


# Reading the report ---------------------------------------------------------------------------------


def dig(data: Any, *keys: str) -> Any:
    """What is there under the keys, None where one of them is missing or leads to null."""
    for key in keys:
        if data is None:
            return None
        data = data.get(key)
    return data


def by_scene(report: Data, part: str) -> dict[str, Data]:
    """The scenes of a part, quality or cost, by name: what was measured there, by method."""
    found = dig(report, part, "scenes") or {}
    if part == "cost":
        found = {name: dig(scene, "methods") for name, scene in found.items()}
    return {name: methods for name, methods in found.items() if methods}


def grain_of(report: Data, scene: str) -> float:
    """How many pixels of the scene's masks are as wide as one of a picture that is WIDTH wide."""
    return report["scenes"][scene]["size"][0] / WIDTH


def peers(report: Data) -> list[Data]:
    return dig(report, "cost", "peers") or []


def shadow_error(scene: Data, methods: Sequence[str], key: str) -> tuple[str, list[float]] | None:
    """The name of a truth, POV-Ray's where it is known, and a mask metric of each of the methods against it."""
    for truth, name in TRUTHS.items():
        values = [dig(scene, method, truth, key) for method in methods]
        if None not in values:
            return name, values
    return None


def peer_of(report: Data, name: str, scene: str) -> Data | None:
    return next((peer for peer in peers(report) if (peer["name"], peer["scene"]) == (name, scene)), None)


def peer_ns(report: Data, name: str, scene: str) -> Interval | None:
    return dig(peer_of(report, name, scene), "ns")


def ratio(a: Interval, b: Interval) -> Interval:
    """How many times b is in a, where the rounds' own ratios are not known. The ends are the worst that both can do, so this is
    wider than either."""
    return {"median": a["median"] / b["median"], "low": a["low"] / b["high"], "high": a["high"] / b["low"],
            "n": min(a["n"], b["n"])}


def difference(a: Interval, b: Interval) -> Interval:
    """a - b, with ends as in `ratio`."""
    return {"median": a["median"] - b["median"], "low": a["low"] - b["high"], "high": a["high"] - b["low"],
            "n": min(a["n"], b["n"])}


def over_none(added: Interval) -> Interval:
    """% over none as times none."""
    return {"median": 1 + added["median"] / 100, "low": 1 + added["low"] / 100, "high": 1 + added["high"] / 100,
            "n": added["n"]}


def told(value: Interval, form: str, unit: str) -> str:
    few = f"; of {value['n']} run{'s' * (value['n'] > 1)}, too few" if value["n"] < LEAST_RUNS else ""
    return f"{value['median']:{form}} {unit} ({value['low']:{form}} to {value['high']:{form}}{few})"


def told_added(value: Interval) -> str:
    return told(value, "+.1f", "%")


# The paper's claims ---------------------------------------------------------------------------------


def detached_case(name: str, scene: Data, grain: float) -> Case:
    moved, error = dig(scene, "none", "edge_moved", "mean"), shadow_error(scene, ("none",), "edge_mean")
    if moved is None or error is None:
        return unmeasured(name, "the edge of none")
    truth, (away,) = error
    moved, away = moved / grain, away / grain
    return {"case": name, "verdict": decided(moved <= STAYS and away >= SEEN),
            "detail": f"none: edge {moved:.2f} px from that without bumps, {away:.2f} px from that of {truth}"}


def detached(report: Data) -> Claim:
    return made(
        "detached", "paper",
        "With bump mapping alone the roughness has no effect on the shadow: it is made without regard to the bumps, "
        "seems to float, and is unnatural.",
        "abstract, sections 1, 2 and 5 (figure 4)",
        f"The edge of none's shadow is on average at most {STAYS:g} px from that of the surface without bumps, and at "
        f"least {SEEN:g} px from the true one, in pixels of pictures {WIDTH} wide.",
        [detached_case(name, scene, grain_of(report, name)) for name, scene in by_scene(report, "quality").items()])


def follows_case(name: str, scene: Data, order: str) -> Case:
    found = shadow_error(scene, ("none", order), "edge_mean")
    if found is None:
        return unmeasured(f"{name}, {order}", "the edges' distance")
    truth, (none, ours) = found
    return {"case": f"{name}, {order}", "verdict": decided(ours <= ROUGHLY * none),
            "detail": f"{ours / none:.2f} times as far from that of {truth}" if none else f"none has {truth}'s edge"}


def follows(report: Data) -> Claim:
    return made(
        "follows", "paper",
        "By order 0, 1 and 2 the shadow roughly fits the bumps, and hardly anything seems wrong with where object and "
        "shadow are.",
        "section 5 (figures 5 to 7)",
        f"The edge of the order's shadow is on average at most {ROUGHLY:g} times as far from the true one as none's.",
        [follows_case(name, scene, order) for name, scene in by_scene(report, "quality").items() for order in ORDERS])


def cheap_case(name: str, scene: Data, order: str) -> Case:
    added, counted = dig(scene, order, "added"), dig(scene, order, "instructions_added")
    if added is None:
        return unmeasured(f"{name}, {order}", "the time")
    # Noise can't touch instructions, but one is not as slow as another: they stand beside, and do not decide.
    beside = "" if counted is None else f"; instructions {counted:+.1f} %"
    return {"case": f"{name}, {order}", "verdict": at_most(added, HARDLY), "detail": told_added(added) + beside}


def cheap(report: Data) -> Claim:
    return made(
        "cheap", "paper",
        "The cost is not much different from that without regard to the surface's shape.",
        "abstract, section 3",
        f"The order's time in kage is at most {HARDLY:g} % over none's, by the interval of the rounds' differences. In "
        "a renderer whose other work takes longer, the same time is a smaller share.",
        [cheap_case(name, scene, order) for name, scene in by_scene(report, "cost").items() for order in ORDERS])


def cheapest_case(name: str, scene: Data, other: str) -> Case:
    zero, dear = (dig(scene, order, "added") for order in ("0", other))
    if zero is None or dear is None:
        return unmeasured(f"{name}, 0 and {other}", "the time")
    return {"case": f"{name}, 0 and {other}", "verdict": at_least(difference(dear, zero), CLEARLY),
            "detail": f"over none: 0 {told_added(zero)}, {other} {told_added(dear)}"}


def cheapest(report: Data) -> Claim:
    return made(
        "cheapest", "paper", "As to the cost, order 0 is clearly the best.", "section 5",
        f"Order 0 takes less time than 1 and than 2, by at least {CLEARLY:g} % of none's and beyond both intervals.",
        [cheapest_case(name, scene, other)
         for name, scene in by_scene(report, "cost").items() for other in ORDERS[1:]])


def second_case(name: str, none: float, zero: float, two: float, unit: str) -> Case:
    """Of an error, of which less is better."""
    slightly = none - zero >= MOST * (none - two)
    why = "2 is no better" if two >= zero else "" if slightly else "2 is much better"
    detail = f"none {none:.3g}{unit}, 0 {zero:.3g}{unit}, 2 {two:.3g}{unit}"
    return {"case": name, "verdict": decided(not why), "detail": f"{detail}: {why}" if why else detail}


def second_cases(name: str, scene: Data) -> list[Case]:
    methods = ("none", "0", "2")
    found, flips = shadow_error(scene, methods, "wrong"), [dig(scene, method, "hybrid", "flip") for method in methods]
    by_mask, by_eye = f"{name}, wrong pixels", f"{name}, FLIP"
    return [second_case(by_mask, *found[1], " %") if found else unmeasured(by_mask, "wrong pixels"),
            unmeasured(by_eye, "FLIP") if None in flips else second_case(by_eye, *flips, "")]


def second_order(report: Data) -> Claim:
    return made(
        "second-order", "paper", "Order 2 is slightly better, but there is no great difference.", "section 5",
        f"2 has a smaller error than 0, and 0 already takes away at least {MOST:g} of what 2 takes away of none's. The "
        "error is the share of wrong pixels, and the FLIP of the picture against one with true shadows, as the paper "
        "judged by eye (and saw the cube alone).",
        [case for name, scene in by_scene(report, "quality").items() for case in second_cases(name, scene)])


def enough_wrong_case(name: str, scene: Data) -> Case:
    name = f"{name}, wrong pixels"
    found = shadow_error(scene, ("none", "0"), "wrong")
    if found is None:
        return unmeasured(name, "wrong pixels")
    truth, (none, zero) = found
    if none == 0:
        return {"case": name, "verdict": UNMEASURED, "detail": f"none has no wrong pixel against {truth}"}
    gone = 1 - zero / none
    return {"case": name, "verdict": decided(gone >= MOST),
            "detail": f"none {none:.2f} %, 0 {zero:.2f} %, so {100 * gone:.1f} % of them are gone; against {truth}"}


def enough_edge_case(name: str, scene: Data, grain: float) -> Case:
    found = shadow_error(scene, ("0",), "edge_mean")
    if found is None:
        return unmeasured(f"{name}, edge", "the edge's distance")
    truth, (away,) = found
    return {"case": f"{name}, edge", "verdict": decided(away / grain < SEEN),
            "detail": f"{away / grain:.2f} px from that of {truth}"}


def enough(report: Data) -> Claim:
    return made(
        "enough", "paper", "Order 0 is enough.", "section 5",
        f"0 takes away at least {MOST:g} of none's wrong pixels, and leaves the edge on average less than {SEEN:g} px "
        f"from the true one, in pixels of pictures {WIDTH} wide.",
        [case for name, scene in by_scene(report, "quality").items()
         for case in (enough_wrong_case(name, scene), enough_edge_case(name, scene, grain_of(report, name)))])


def sweep_lines(sweep: Data) -> list[tuple[str, list[tuple[float, Data]]]]:
    """For each value of the other axis its label, and the known cells by slope, from flat to steep; nothing where the
    sweep is not over slopes."""
    axes = {sweep[axis]["name"]: sweep[axis]["values"] for axis in "xy"}
    if "slope" not in axes:
        return []
    across = sweep["x"]["name"] == "slope"
    table = sweep["wrong"] if across else zip(*sweep["wrong"], strict=True)
    other = sweep["y" if across else "x"]
    lines = []
    for value, cells in zip(other["values"], table, strict=True):
        known = [(slope, cell) for slope, cell in zip(axes["slope"], cells, strict=True) if cell]
        lines.append((f"{other['name']} {value:g}", sorted(known, key=lambda point: point[0])))
    return lines


def reach(line: Sequence[tuple[float, Data]], method: str) -> tuple[str, str]:
    """Whether large slopes are out of the method's reach on a line of cells, and the last one before it goes wrong."""
    wrong = [(slope, cell[method]) for slope, cell in line if cell.get(method) is not None]
    if not wrong:
        return UNMEASURED, UNMEASURED
    right = [slope for slope, _ in itertools.takewhile(lambda point: point[1] <= RIGHT, wrong)]
    last = f"to {right[-1]:g}" if right else "at no slope"
    if right and right[-1] >= LARGE_SLOPE:
        return FAILS, last
    if len(right) < len(wrong):
        return HOLDS, last
    return UNMEASURED, f"{last}, steeper ones not measured"


def amplitude_case(sweep: Data, order: str) -> Case:
    found = [(label, *reach(line, order)) for label, line in sweep_lines(sweep)]
    return {"case": f"{sweep['id']}, {order}", "verdict": overall(verdict for _, verdict, _ in found),
            "detail": "; ".join(f"{label}: {text}" for label, _, text in found)}


def amplitude(report: Data) -> Claim:
    sweeps = [sweep for sweep in report.get("sweeps") or [] if sweep_lines(sweep)]
    return made(
        "amplitude", "paper", "The method is difficult to apply where the relief is large.", "section 7",
        f"The order exceeds {RIGHT:g} % wrong pixels (against kage's exact) before slopes of {LARGE_SLOPE:g}, 45 "
        "degrees. Told is the largest slope before it does.",
        [amplitude_case(sweep, order) for sweep in sweeps for order in ORDERS])


def intersection_case(name: str, scene: Data, dear: str) -> Case:
    name = f"{name}, {dear}"
    times = [dig(scene, method, "added") for method in ("0", dear)]
    if None in times:
        return unmeasured(name, "the time")
    zero, other = map(over_none, times)
    found = ratio(other, zero)
    return {"case": name, "verdict": at_least(found, EXPENSIVE), "detail": told(found, ".1f", "times order 0")}


def intersection_peer_case(report: Data, displaced: Data) -> Case:
    name, ours = f"{displaced['scene']}, {displaced['name']}", dig(displaced, "ns")
    bases = [(base, ns) for base in FLAT_PEERS if (ns := peer_ns(report, base, displaced["scene"])) is not None]
    if ours is None or not bases:
        return unmeasured(name, "the time")
    base, ns = bases[0]
    found = dig(displaced, "times", base) or ratio(ours, ns)
    return {"case": name, "verdict": at_least(found, EXPENSIVE),
            "detail": told(found, ".1f", f"times {base.removeprefix(PEER)}")}


def intersection(report: Data) -> Claim:
    displaced = [peer for peer in peers(report) if peer["name"].startswith(PEER) and peer["name"] not in FLAT_PEERS]
    return made(
        "intersection", "paper", "To intersect the rough surface itself costs much, in general.",
        "Japanese abstract, sections 1 and 2",
        f"At least {EXPENSIVE:g} times order 0's time in kage, where exact intersects it for the shadow ray's start "
        "alone and displaced for every ray; and in POV-Ray, by its every way to displace, that many times what "
        "bump_map takes (where the scene has none: the smooth surface).",
        [*(intersection_case(name, scene, dear)
           for name, scene in by_scene(report, "cost").items() for dear in ("exact", "displaced")),
         *(intersection_peer_case(report, peer) for peer in displaced)])


# kage's own -----------------------------------------------------------------------------------------


def speed_case(report: Data, method: str) -> Case:
    ours, theirs = dig(by_scene(report, "cost"), PAPER_SCENE, method, "ns"), peer_ns(report, BUMP_MAP, PAPER_SCENE)
    if ours is None or theirs is None:
        return unmeasured(method, "POV-Ray's time" if theirs is None else "the time")
    found = dig(peer_of(report, BUMP_MAP, PAPER_SCENE), "times", method) or ratio(theirs, ours)
    return {"case": method, "verdict": at_least(found, FASTER), "detail": told(found, ".1f", "times as fast")}


def speed(report: Data) -> Claim:
    return made(
        "speed", "kage",
        f"On figure 5's scene none and order 0 are at least {FASTER:g} times as fast as POV-Ray's bump_map.",
        "README.md, docs/design.md",
        f"POV-Ray's time is at least {FASTER:g} times kage's; one thread each, the median of the rounds' ratios.",
        [speed_case(report, method) for method in ("none", "0")])


def order_0(report: Data) -> Claim:
    added = dig(by_scene(report, "cost"), PAPER_SCENE, "0", "added")
    case: Case = (unmeasured(PAPER_SCENE, "the time") if added is None else
                  {"case": PAPER_SCENE, "verdict": at_most(added, ORDER_0_COST), "detail": told_added(added)})
    return made("order-0", "kage", f"On figure 5's scene order 0 costs at most {ORDER_0_COST:g} % over none.",
                "README.md, docs/design.md",
                f"At most {ORDER_0_COST:g} % over none's time, by the interval of the rounds' differences.", [case])


def merit_case(report: Data, truth: str) -> Case:
    name = f"against {TRUTHS[truth]}"
    wrong = [dig(by_scene(report, "quality"), MERIT_SCENE, method, truth, "wrong") for method in MERIT]
    if None in wrong:
        return unmeasured(name, "wrong pixels")
    shares = zip(MERIT, wrong, strict=True)
    return {"case": name, "verdict": decided(all(a > b for a, b in zip(wrong, wrong[1:], strict=False))),
            "detail": ", ".join(f"{method} {share:.3f} %" for method, share in shares)}


def merit(report: Data) -> Claim:
    return made(
        "merit", "kage", f"On function data ({MERIT_SCENE}) each is better than the one before: {', '.join(MERIT)}.",
        "docs/method.md", f"Fewer and fewer wrong pixels on {MERIT_SCENE}, from {MERIT[0]} to {MERIT[-1]}.",
        [merit_case(report, truth) for truth in TRUTHS])


def parity_case(scene: str, found: Data, kind: str) -> Case:
    name, value = f"{scene}, {kind}", found.get(kind)
    if value is None:
        return unmeasured(name, "the agreement")
    if kind in LEAST_CLOSE:
        return {"case": name, "verdict": decided(value >= LEAST_CLOSE[kind]),
                "detail": f"{value:.2f} % of the pixels within 1/255"}
    return {"case": name, "verdict": decided(value <= MOST_DIFFERENT[kind]),
            "detail": f"{value:.3f} % of the shadow's pixels differ"}


def parity(report: Data) -> Claim:
    parities = dig(report, "quality", "parity") or {}
    return made(
        "parity", "kage", "kage's own displacement shows what POV-Ray's does.", "README.md",
        f"Within 1/255 at least {LEAST_CLOSE['self']:g} % of the pixels where rough surfaces cast shadows too (self), "
        f"and {LEAST_CLOSE['cast']:g} % where only other objects do (cast); of the shadow's pixels at most "
        f"{MOST_DIFFERENT['mask']:g} % differ (mask).",
        [parity_case(scene, found, kind)
         for scene, found in parities.items() if found for kind in (*LEAST_CLOSE, *MOST_DIFFERENT)])


ALL = (detached, follows, cheap, cheapest, second_order, enough, amplitude, intersection, speed, order_0, merit, parity)


def claims(report: Data) -> list[Claim]:
    """All claims, the paper's first, judged by the data of a report, of which any part may be null."""
    return [judge(report) for judge in ALL]
