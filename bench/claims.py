"""What the paper claims, and what kage claims of itself, judged by the numbers of a report.

Each claim is a function of the report's data (bench/data.py), with its test and bound written out. The paper gives no
numbers: it judged figures 4 to 8 by eye. So the bounds are ours: the constants below, with their reasons. Each claim is
judged case by case, as it may hold for one scene and not for the next.

The verdicts

    of a measured time, which has an interval: "holds" or "does not hold" where all of the interval is on one side of
    the bound, "undecided" where the bound is inside the interval or there were fewer than LEAST_RUNS runs
    of a share or distance, which has no noise: "holds" or "does not hold"
    "not measured" where a number is missing
    of a claim as a whole: see `overall`
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from typing import TypeVar

from bench import data
from bench.data import BUMP_ONLY, Case, Claim, Cost, MaskMetric, Parity, Peer, Quality, Report, Shares, Sweep, Truth
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
TRUTHS: dict[Truth, str] = {"mask": "POV-Ray's displacement", "exact": "kage's exact"}  # the better one first
BUMP_MAP = "POV-Ray, bump_map"
PEER = "POV-Ray, "  # every name of a POV-Ray peer starts so
FLAT_PEERS = (BUMP_MAP, "POV-Ray, smooth, no bumps")  # without displacement; the first that a scene has is the base

# An edge that is off by a pixel on average is seen; one off by less is about as good as pixels can draw it.
SEEN = 1.0  # pixels
# Bump mapping only should not move the edge at all; this allows for the odd pixel that falls on the other side.
STAYS = 0.1  # pixels
WIDTH = 640  # the two above are in pixels of a picture that is so wide; finer masks have smaller pixels
# "Roughly" the shadow that fits the bumps: nearer to that shadow than to the one of the smooth surface.
ROUGHLY = 0.5  # of the distance by bump mapping only
# "Not much different" in cost: at most a tenth.
HARDLY = 10.0  # % over bump only
# "Clearly" cheaper: not by a difference that nobody would notice, however well it is measured.
CLEARLY = 1.0  # % of the time by bump mapping only
# "Enough", and "no great difference" between orders: three quarters of what there is to gain.
MOST = 0.75
# 1 % of a shadow of 200 x 200 pixels, as large as figure 5's at 640x480, is an edge off by half a pixel all around.
RIGHT = 1.0  # % wrong pixels
LARGE_SLOPE = 1.0  # 45 degrees; an order that is right up to here can be used for large amplitudes
# "Costs much": twice as much or more.
EXPENSIVE = 2.0  # times
# kage's own, which the project demands of itself.
FASTER = 40.0  # times
ORDER_0_COST = 8.0  # % over bump only
LEAST_CLOSE = {"self": 99.5, "cast": 99.8}  # % of the pixels within 1/255
MOST_DIFFERENT = 0.1  # % of the shadow's pixels

LEAST_RUNS = 3  # with fewer runs an interval does not show the noise

Methods = Mapping[str, Quality]  # of a scene
Costs = Mapping[str, Cost]


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
    """Of all cases. Cases that are not measured count only where all are.

    If one case fails, the claim holds in part at best, and only where another case holds. If no case fails, one
    undecided case makes the whole undecided.
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


# What a headline may say of a time ------------------------------------------------------------------


def measured_span(value: Interval | None, form: str, unit: str, same: float) -> str:
    """All that the runs bear: the interval, not its middle. `same`: the value that means no difference."""
    if value is None:
        return "not measured"
    if value["n"] < LEAST_RUNS:
        return f"not measured often enough ({value['n']} run{'s' * (value['n'] > 1)})"
    text = f"{span_text(value, form)} {unit}"
    return f"no difference seen ({text})" if value["low"] <= same <= value["high"] else text


def span_text(value: Interval, form: str) -> str:
    low, high = (f"{end:{form}}" for end in (value["low"], value["high"]))
    return low if low == high else f"{low} to {high}"


def over_all(values: Iterable[Interval | None]) -> Interval | None:
    """From the lowest end to the highest of what was measured in several scenes."""
    known = [value for value in values if value is not None]
    if not known:
        return None
    low, high = min(value["low"] for value in known), max(value["high"] for value in known)
    return {"median": (low + high) / 2, "low": low, "high": high, "n": min(value["n"] for value in known)}


def not_told_apart(costs: Mapping[str, Interval | None]) -> set[str]:
    """The cheapest, and all whose intervals do not show that they are dearer."""
    known = {name: value for name, value in costs.items() if value is not None}
    if not known:
        return set()
    least = min(known.values(), key=lambda value: value["median"])
    return {name for name, value in known.items() if value["low"] <= least["high"]}


# Reading the report ---------------------------------------------------------------------------------


def grain_of(report: Report, scene: str) -> float:
    """How many pixels of the scene's masks are as wide as one of a picture that is WIDTH wide."""
    return report["scenes"][scene]["size"][0] / WIDTH


Value = TypeVar("Value")


def complete(values: Sequence[Value | None]) -> list[Value] | None:
    """The values; None where one is missing."""
    known = [value for value in values if value is not None]
    return known if len(known) == len(values) else None


def mask_metrics(scene: Methods, methods: Sequence[str], truth: Truth, metric: MaskMetric) -> list[float] | None:
    """The metric of each method against a truth; None where one is missing."""
    return complete([data.mask_metric(scene.get(method), truth, metric) for method in methods])


def shadow_error(scene: Methods, methods: Sequence[str], metric: MaskMetric) -> tuple[str, list[float]] | None:
    """The name of the best truth that is known, and the metric of each method against it."""
    for truth, name in TRUTHS.items():
        if (values := mask_metrics(scene, methods, truth, metric)) is not None:
            return name, values
    return None


def added_times(scene: Costs, *methods: str) -> list[Interval] | None:
    """% over bump only, of each method; None where one is missing."""
    return complete([data.added_cost(scene.get(method)) for method in methods])


def peer_of(report: Report, name: str, scene: str) -> Peer | None:
    return next((peer for peer in data.peers(report) if (peer["name"], peer["scene"]) == (name, scene)), None)


def peer_ns(report: Report, name: str, scene: str) -> Interval | None:
    peer = peer_of(report, name, scene)
    return peer["ns"] if peer else None


def peer_times(peer: Peer | None, base: str) -> Interval | None:
    """How many times as long as the base the peer takes, by the rounds' own ratios."""
    return (peer.get("times") or {}).get(base) if peer else None


def ratio(a: Interval, b: Interval) -> Interval:
    """a / b, where the rounds' own ratios are not known. Each end takes the worse ends of both, so this interval is
    wider than theirs."""
    return {"median": a["median"] / b["median"], "low": a["low"] / b["high"], "high": a["high"] / b["low"],
            "n": min(a["n"], b["n"])}


def difference(a: Interval, b: Interval) -> Interval:
    """a - b, with ends as in `ratio`."""
    return {"median": a["median"] - b["median"], "low": a["low"] - b["high"], "high": a["high"] - b["low"],
            "n": min(a["n"], b["n"])}


def interval_text(value: Interval, form: str, unit: str) -> str:
    few = f"; of {value['n']} run{'s' * (value['n'] > 1)}, too few" if value["n"] < LEAST_RUNS else ""
    return f"{value['median']:{form}} {unit} ({value['low']:{form}} to {value['high']:{form}}{few})"


def added_text(value: Interval) -> str:
    return interval_text(value, "+.1f", "%")


# The paper's claims ---------------------------------------------------------------------------------


def detached_case(name: str, scene: Methods, grain: float) -> Case:
    none = scene.get("none")
    edge, error = none and none["edge_moved"], shadow_error(scene, ("none",), "edge_mean")
    if edge is None or error is None:
        return unmeasured(name, "the edge by bump only")
    truth, (away,) = error
    moved, away = edge["mean"] / grain, away / grain
    return {"case": name, "verdict": decided(moved <= STAYS and away >= SEEN),
            "detail": f"{BUMP_ONLY}: edge {moved:.2f} px from that without bumps, {away:.2f} px from that of {truth}"}


def detached(report: Report) -> Claim:
    return made(
        "detached", "paper",
        "With bump mapping alone the bumps do not change the shadow: it seems to float above the surface, and looks "
        "unnatural.",
        "abstract, sections 1, 2 and 5, figure 4",
        f"The edge of the shadow by {BUMP_ONLY} is on average at most {STAYS:g} px from the edge on the surface "
        f"without bumps, and at least {SEEN:g} px from the true one, in pixels of a picture {WIDTH} pixels wide.",
        [detached_case(name, scene, grain_of(report, name)) for name, scene in data.qualities(report).items()])


def follows_case(name: str, scene: Methods, order: str) -> Case:
    found = shadow_error(scene, ("none", order), "edge_mean")
    if found is None:
        return unmeasured(f"{name}, {order}", "the edges' distance")
    truth, (none, ours) = found
    return {"case": f"{name}, {order}", "verdict": decided(ours <= ROUGHLY * none),
            "detail": (f"{ours / none:.2f} times as far from that of {truth}" if none
                       else f"{BUMP_ONLY} has {truth}'s edge")}


def follows(report: Report) -> Claim:
    return made(
        "follows", "paper",
        "With orders 0, 1 and 2 the shadow roughly fits the bumps, and the positions of object and shadow hardly look "
        "wrong.",
        "section 5, figures 5 to 7",
        f"The edge of the order's shadow is on average at most {ROUGHLY:g} times as far from the true one as that by "
        f"{BUMP_ONLY}.",
        [follows_case(name, scene, order) for name, scene in data.qualities(report).items() for order in ORDERS])


def cheap_case(name: str, scene: Costs, order: str) -> Case:
    times, entry = added_times(scene, order), scene.get(order)
    if times is None or entry is None:
        return unmeasured(f"{name}, {order}", "the time")
    # Instruction counts have no noise, but not all instructions are equally slow: they are shown, and do not decide.
    counted = entry["instructions_added"]
    beside = "" if counted is None else f"; instructions {counted:+.1f} %"
    return {"case": f"{name}, {order}", "verdict": at_most(times[0], HARDLY), "detail": added_text(times[0]) + beside}


def cheap(report: Report) -> Claim:
    return made(
        "cheap", "paper",
        "The cost is not much higher than without the shape of the surface.",
        "abstract, section 3",
        f"The order's time in kage is at most {HARDLY:g} % over {BUMP_ONLY}, by the interval of the rounds' "
        "differences. In a renderer whose other work takes longer, the same time is a smaller share.",
        [cheap_case(name, scene, order) for name, scene in data.costs(report).items() for order in ORDERS])


def cheapest_case(name: str, scene: Costs, other: str) -> Case:
    times = added_times(scene, "0", other)
    if times is None:
        return unmeasured(f"{name}, 0 and {other}", "the time")
    zero, higher = times
    return {"case": f"{name}, 0 and {other}", "verdict": at_least(difference(higher, zero), CLEARLY),
            "detail": f"over {BUMP_ONLY}: 0 {added_text(zero)}, {other} {added_text(higher)}"}


def cheapest(report: Report) -> Claim:
    return made(
        "cheapest", "paper", "Order 0 is clearly the cheapest.", "section 5",
        f"Order 0 takes less time than 1 and than 2, by at least {CLEARLY:g} % of the time by {BUMP_ONLY}, for all "
        "values in the intervals.",
        [cheapest_case(name, scene, other) for name, scene in data.costs(report).items() for other in ORDERS[1:]])


def second_case(name: str, errors: Sequence[float], unit: str) -> Case:
    """Of the errors of none, 0 and 2."""
    none, zero, two = errors
    slightly = none - zero >= MOST * (none - two)
    why = "2 is no better" if two >= zero else "" if slightly else "2 is much better"
    detail = f"{BUMP_ONLY} {none:.3g}{unit}, 0 {zero:.3g}{unit}, 2 {two:.3g}{unit}"
    return {"case": name, "verdict": decided(not why), "detail": f"{detail}: {why}" if why else detail}


def flip_of(quality: Quality | None) -> float | None:
    picture = quality and quality["hybrid"]
    return picture and picture["flip"]


def second_cases(name: str, scene: Methods) -> list[Case]:
    methods = ("none", "0", "2")
    found, flips = shadow_error(scene, methods, "wrong"), complete([flip_of(scene.get(method)) for method in methods])
    by_mask, by_eye = f"{name}, wrong pixels", f"{name}, FLIP"
    return [second_case(by_mask, found[1], " %") if found else unmeasured(by_mask, "wrong pixels"),
            second_case(by_eye, flips, "") if flips else unmeasured(by_eye, "FLIP")]


def second_order(report: Report) -> Claim:
    return made(
        "second-order", "paper", "Order 2 is slightly better, but there is no great difference.", "section 5",
        f"2 has a smaller error than 0, and 0 removes at least {MOST:g} of the error that 2 removes. There are two "
        "errors: the share of wrong pixels, and the FLIP of the picture against one with true shadows, as the paper "
        "judged by eye (and only the cube).",
        [case for name, scene in data.qualities(report).items() for case in second_cases(name, scene)])


def enough_wrong_case(name: str, scene: Methods) -> Case:
    name = f"{name}, wrong pixels"
    found = shadow_error(scene, ("none", "0"), "wrong")
    if found is None:
        return unmeasured(name, "wrong pixels")
    truth, (none, zero) = found
    if none == 0:
        return {"case": name, "verdict": UNMEASURED, "detail": f"{BUMP_ONLY} has no wrong pixel against {truth}"}
    gone = 1 - zero / none
    return {"case": name, "verdict": decided(gone >= MOST),
            "detail": f"{BUMP_ONLY} {none:.2f} %, 0 {zero:.2f} %, so {100 * gone:.1f} % of them are gone; "
                      f"against {truth}"}


def enough_edge_case(name: str, scene: Methods, grain: float) -> Case:
    found = shadow_error(scene, ("0",), "edge_mean")
    if found is None:
        return unmeasured(f"{name}, edge", "the edge's distance")
    truth, (away,) = found
    return {"case": f"{name}, edge", "verdict": decided(away / grain < SEEN),
            "detail": f"{away / grain:.2f} px from that of {truth}"}


def enough(report: Report) -> Claim:
    return made(
        "enough", "paper", "Order 0 is enough.", "section 5",
        f"0 corrects at least {MOST:g} of the wrong pixels of {BUMP_ONLY}, and its edge is on average less than "
        f"{SEEN:g} px from the true one, in pixels of a picture {WIDTH} pixels wide.",
        [case for name, scene in data.qualities(report).items()
         for case in (enough_wrong_case(name, scene), enough_edge_case(name, scene, grain_of(report, name)))])


Line = list[tuple[float, Shares]]  # the known cells of a sweep over slopes, from flat to steep


def sweep_lines(sweep: Sweep) -> list[tuple[str, Line]]:
    """A label and a line for each value of the other axis; an empty list where the sweep is not over slopes."""
    if "slope" not in (sweep["x"]["name"], sweep["y"]["name"]):
        return []
    across = sweep["x"]["name"] == "slope"
    table = sweep["wrong"] if across else [list(column) for column in zip(*sweep["wrong"], strict=True)]
    slopes, other = (sweep["x"], sweep["y"]) if across else (sweep["y"], sweep["x"])
    lines = []
    for value, cells in zip(other["values"], table, strict=True):
        known = [(slope, cell) for slope, cell in zip(slopes["values"], cells, strict=True) if cell]
        lines.append((f"{other['name']} {value:g}", sorted(known, key=lambda point: point[0])))
    return lines


def reach(line: Line, method: str) -> tuple[str, str]:
    """Whether large slopes are out of the method's reach, and the largest slope before it goes wrong."""
    wrong = [(slope, share) for slope, cell in line if (share := cell.get(method)) is not None]
    if not wrong:
        return UNMEASURED, UNMEASURED
    right = [slope for slope, _ in itertools.takewhile(lambda point: point[1] <= RIGHT, wrong)]
    last = f"to {right[-1]:g}" if right else "at no slope"
    if right and right[-1] >= LARGE_SLOPE:
        return FAILS, last
    if len(right) < len(wrong):
        return HOLDS, last
    return UNMEASURED, f"{last}, steeper ones not measured"


def amplitude_case(sweep: Sweep, order: str) -> Case:
    found = [(label, *reach(line, order)) for label, line in sweep_lines(sweep)]
    return {"case": f"{sweep['id']}, {order}", "verdict": overall(verdict for _, verdict, _ in found),
            "detail": "; ".join(f"{label}: {text}" for label, _, text in found)}


def amplitude(report: Report) -> Claim:
    sweeps = [sweep for sweep in report.get("sweeps") or [] if sweep_lines(sweep)]
    return made(
        "amplitude", "paper", "The method is difficult to use where the bumps are high.", "section 7",
        f"The order has more than {RIGHT:g} % wrong pixels (against kage's exact) at a slope below {LARGE_SLOPE:g}, 45 "
        "degrees. The cases give the largest slope before that.",
        [amplitude_case(sweep, order) for sweep in sweeps for order in ORDERS])


def intersection_case(name: str, scene: Costs, method: str) -> Case:
    name = f"{name}, {method}"
    zero, other = (data.times_none(scene.get(m)) for m in ("0", method))
    if zero is None or other is None:
        return unmeasured(name, "the time")
    found = ratio(other, zero)
    return {"case": name, "verdict": at_least(found, EXPENSIVE), "detail": interval_text(found, ".1f", "times order 0")}


def intersection_peer_case(report: Report, displaced: Peer) -> Case:
    name, ours = f"{displaced['scene']}, {displaced['name']}", displaced["ns"]
    bases = [(base, ns) for base in FLAT_PEERS if (ns := peer_ns(report, base, displaced["scene"])) is not None]
    if ours is None or not bases:
        return unmeasured(name, "the time")
    base, ns = bases[0]
    found = peer_times(displaced, base) or ratio(ours, ns)
    return {"case": name, "verdict": at_least(found, EXPENSIVE),
            "detail": interval_text(found, ".1f", f"times {base.removeprefix(PEER)}")}


def intersection(report: Report) -> Claim:
    displaced = [peer for peer in data.peers(report)
                 if peer["name"].startswith(PEER) and peer["name"] not in FLAT_PEERS]
    return made(
        "intersection", "paper", "To intersect rays with the rough surface itself is expensive in general.",
        "Japanese abstract, sections 1 and 2",
        f"In kage at least {EXPENSIVE:g} times order 0's time, by exact, which intersects it only for the start of the "
        f"shadow ray, and by displaced, which intersects it for every ray. In POV-Ray at least {EXPENSIVE:g} times "
        "bump_map's time (without one: the smooth surface's), by each of its ways to displace.",
        [*(intersection_case(name, scene, method)
           for name, scene in data.costs(report).items() for method in ("exact", "displaced")),
         *(intersection_peer_case(report, peer) for peer in displaced)])


# kage's own -----------------------------------------------------------------------------------------


def speed_case(report: Report, method: str) -> Case:
    name = BUMP_ONLY if method == "none" else f"order {method}"
    entry, theirs = data.cost(report, PAPER_SCENE, method), peer_ns(report, BUMP_MAP, PAPER_SCENE)
    ours = entry and entry["ns"]
    if ours is None or theirs is None:
        return unmeasured(name, "POV-Ray's time" if theirs is None else "the time")
    found = peer_times(peer_of(report, BUMP_MAP, PAPER_SCENE), method) or ratio(theirs, ours)
    return {"case": name, "verdict": at_least(found, FASTER), "detail": interval_text(found, ".1f", "times as fast")}


def speed(report: Report) -> Claim:
    return made(
        "speed", "kage",
        f"On figure 5's scene kage by {BUMP_ONLY}, and by order 0, is at least {FASTER:g} times as fast as POV-Ray's "
        "bump_map.",
        "docs/accuracy.md, docs/design.md",
        f"POV-Ray's time is at least {FASTER:g} times kage's, by the interval of the rounds' ratios; one thread each.",
        [speed_case(report, method) for method in ("none", "0")])


def order_0(report: Report) -> Claim:
    added = data.added_cost(data.cost(report, PAPER_SCENE, "0"))
    case: Case = (unmeasured(PAPER_SCENE, "the time") if added is None else
                  {"case": PAPER_SCENE, "verdict": at_most(added, ORDER_0_COST), "detail": added_text(added)})
    return made("order-0", "kage", f"On figure 5's scene order 0 costs at most {ORDER_0_COST:g} % over {BUMP_ONLY}.",
                "docs/accuracy.md, docs/design.md",
                f"At most {ORDER_0_COST:g} % over the time by {BUMP_ONLY}, by the interval of the rounds' differences.",
                [case])


def merit_case(report: Report, truth: Truth) -> Case:
    name = f"against {TRUTHS[truth]}"
    wrong = mask_metrics(data.qualities(report).get(MERIT_SCENE, {}), MERIT, truth, "wrong")
    if wrong is None:
        return unmeasured(name, "wrong pixels")
    shares = zip(MERIT, wrong, strict=True)
    return {"case": name, "verdict": decided(all(a > b for a, b in itertools.pairwise(wrong))),
            "detail": ", ".join(f"{data.label(method)} {share:.3f} %" for method, share in shares)}


def merit(report: Report) -> Claim:
    names = ", ".join(map(data.label, MERIT))
    return made(
        "merit", "kage",
        f"On function data ({MERIT_SCENE}) each method is better than the one before: {names}.", "docs/method.md",
        f"Each of {names} has fewer wrong pixels on {MERIT_SCENE} than the one before.",
        [merit_case(report, truth) for truth in TRUTHS])


def parity_cases(scene: str, found: Parity) -> list[Case]:
    cases: list[Case] = []
    for kind, close in (("self", found["self"]), ("cast", found["cast"])):
        name = f"{scene}, {kind}"
        cases.append(unmeasured(name, "the agreement") if close is None else {
            "case": name, "verdict": decided(close >= LEAST_CLOSE[kind]),
            "detail": f"{close:.2f} % of the pixels within 1/255"})
    name, wrong = f"{scene}, mask", found["mask"]
    cases.append(unmeasured(name, "the agreement") if wrong is None else {
        "case": name, "verdict": decided(wrong <= MOST_DIFFERENT),
        "detail": f"{wrong:.3f} % of the shadow's pixels differ"})
    return cases


def parity(report: Report) -> Claim:
    return made(
        "parity", "kage", "kage's own displacement looks like POV-Ray's.", "docs/accuracy.md",
        f"At least {LEAST_CLOSE['self']:g} % of the pixels are within 1/255 where rough surfaces also cast shadows "
        f"(self), and at least {LEAST_CLOSE['cast']:g} % where only other objects do (cast). "
        f"At most {MOST_DIFFERENT:g} % of the shadow's pixels differ (mask).",
        [case for scene, found in data.parities(report).items() if found for case in parity_cases(scene, found)])


ALL = (detached, follows, cheap, cheapest, second_order, enough, amplitude, intersection, speed, order_0, merit, parity)


def claims(report: Report) -> list[Claim]:
    """The paper's claims, then kage's, judged by the data of a report. Any part of it may be missing."""
    return [judge(report) for judge in ALL]
