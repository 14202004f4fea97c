"""The numbers of a report as tables and sentences, for the page and for Markdown alike.

A report is that of bench/data.py; any value in it may be None, where it could not be measured. What is computed here
from the report's numbers (which method is best, on the front, cheapest for a bound, good up to which slope) is computed
nowhere else.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from bench import claims, data, stats
from bench.data import Report, Sweep, Truth, dig
from bench.stats import Interval

MISSING = "–"
TRUE = ("exact", "displaced")  # they find the true hit, so they do not compete for the fewest wrong pixels
BOUNDS = (0.5, 1.0)  # % of wrong pixels that the sweeps' maps allow
RULE_BOUND = 1.0  # the same for the rule of thumb

ABOUT = {
    "none": "the smooth hit, as other renderers with bump mapping do (the option: `none`)",
    "0": "the paper's order 0: a plane at the bump's height",
    "1": "the paper's order 1: the rough surface's tangent plane",
    "1 bare": "order 1 without the guard that falls back to order 0",
    "2": "the paper's order 2: with the pure second derivatives",
    "2 bare": "order 2 without the guard that falls back to order 1",
    "2+": "order 2 with the cross term and the smooth surface's curvature (ours)",
    "auto": "order 0, and a better one where its error is seen: more than a quarter of a pixel (ours)",
    "exact": "the true hit of the rough surface, for the shadow's origin alone (ours)",
    "displaced": "the true hit is also what is seen and shaded (ours)",
}
ABOUT_FAMILY = {
    "iter": "order 0 {n} times, the height looked up again each time (ours)",
    "auto": "order 0, and a better one where its error is seen: more than {n} pixels (ours)",
    "march": "{n} steps through the slab between lowest and highest bump (ours)",
}


@dataclass(frozen=True)
class Cell:
    """A cell of a table: the value, a smaller remark below it, and marks, which need no colour to be seen."""

    text: str
    note: str = ""
    marks: str = ""

    @property
    def missing(self) -> bool:
        return self.text == MISSING


@dataclass(frozen=True)
class Column:
    """Neighbours with the same group stand under one head. `words` are aligned left, numbers right."""

    head: str
    group: str = ""
    words: bool = False


@dataclass(frozen=True)
class Table:
    """The first cell of a row is its head."""

    title: str
    columns: Sequence[Column]
    rows: Sequence[Sequence[Cell]]
    about: str = ""

    @property
    def groups(self) -> list[tuple[str, int]]:
        """The heads above the columns with the number of columns under each; empty where there is none."""
        found: list[tuple[str, int]] = []
        for column in self.columns:
            if found and column.group and found[-1][0] == column.group:
                found[-1] = (column.group, found[-1][1] + 1)
            else:
                found.append((column.group, 1))
        return found if any(name for name, _ in found) else []


# Reading ------------------------------------------------------------------------------------------------------


def scene_title(report: Report, scene: str) -> str:
    return report["scenes"][scene]["title"] if scene in report["scenes"] else scene


def method_name(method: str) -> str:
    """As in a sentence: 0 is `order 0`, `1 bare` is `order 1, bare`, none is `bump only`."""
    return f"order {method.replace(' bare', ', bare')}" if method[:1].isdigit() else data.label(method)


def peer_name(name: str) -> str:
    """The fused loop's methods, too, are named as in a sentence."""
    program, comma, method = name.rpartition(", ")
    return f"{program}, {method_name(method)}" if comma and method in ABOUT else name


def method_about(method: str) -> str:
    family, _, n = method.partition(":")
    return ABOUT.get(method) or ABOUT_FAMILY.get(family, "").format(n=n)


def truth_key(report: Report, scene: str) -> Truth:
    """The truth of a scene's wrong pixels: POV-Ray's mask, or kage's own `exact` where there is no mask."""
    methods = data.qualities(report).get(scene, {})
    return "mask" if any(entry["mask"] for entry in methods.values()) else "exact"


def truth_name(report: Report, scene: str) -> str:
    if truth_key(report, scene) == "exact":
        return "kage's exact"
    return f"{data.truth_version(report) or 'POV-Ray'}'s true displacement"


def wrong_pixels(report: Report, scene: str, method: str) -> float | None:
    return data.mask_metric(data.quality(report, scene, method), truth_key(report, scene), "wrong")


def added_cost(report: Report, scene: str, method: str) -> Interval | None:
    return data.added_cost(data.cost(report, scene, method))


def points(report: Report, scene: str) -> dict[str, tuple[float, float]]:
    """Cost (% over bump only) and wrong pixels (%) of the methods that have both, in the report's order."""
    found = {}
    for method in report["methods"]:
        cost = 0.0 if method == "none" else data.median(added_cost(report, scene, method))
        wrong = wrong_pixels(report, scene, method)
        if cost is not None and wrong is not None:
            found[method] = (cost, wrong)
    return found


def front(report: Report, scene: str) -> list[str]:
    """The methods that no other one beats in cost and error, the cheapest first."""
    found = points(report, scene)
    names = list(found)
    return [names[i] for i in stats.pareto(list(found.values()))]


# Sweeps -------------------------------------------------------------------------------------------------------


def cheapest(wrong: Mapping[str, float | None] | None, by_cost: Sequence[str], bound: float) -> str | None:
    """The first method in `by_cost` with at most `bound` % wrong; None where no method is good enough."""
    known = wrong or {}
    return next((m for m in by_cost if (value := known.get(m)) is not None and value <= bound), None)


def reach(sweep: Sweep, row: int, method: str, bound: float) -> float | None:
    """The largest x up to which the method stays within `bound`, over the cells of that row that were measured."""
    last = None
    for x, cell in sorted(zip(sweep["x"]["values"], sweep["wrong"][row], strict=True), key=lambda pair: pair[0]):
        value = cell.get(method) if cell else None
        if value is not None and value > bound:
            break
        last = x if value is not None else last
    return last


def rule_of_thumb(sweep: Sweep, row: int, bound: float = RULE_BOUND) -> str:
    """Each method with the largest x it is good for, the cheapest first, without those that reach no further than a
    cheaper one."""
    measured = [x for x, cell in zip(sweep["x"]["values"], sweep["wrong"][row], strict=True) if cell is not None]
    if not measured:
        return "nothing measured"
    parts: list[str] = []
    best = -math.inf
    for method in sweep["by_cost"]:
        limit = reach(sweep, row, method, bound)
        if limit is not None and limit > best:
            parts.append(f"{method_name(method)} to {short(limit)}")
            best = limit
        if best == max(measured):
            return ", ".join([*parts[:-1], f"{method_name(method)} to the end ({short(best)})"])
    return ", ".join(parts) + ("; beyond, none of these" if parts else "none of these is good enough")


def rules(sweep: Sweep) -> list[tuple[str, str]]:
    """A rule of thumb for each y."""
    return [(short(y), rule_of_thumb(sweep, row)) for row, y in enumerate(sweep["y"]["values"])]


# Numbers ------------------------------------------------------------------------------------------------------

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def minus(text: str) -> str:
    return text.replace("-", "−")


def share(value: float | None) -> str:
    """In %, with two decimals, which is about a pixel of a shadow; a smaller value that is not 0 is `<0.01`."""
    if value is None:
        return MISSING
    return "<0.01" if 0 < value < 0.005 else f"{value:.2f}"


def added(value: float | None) -> str:
    """In %, with its sign."""
    if value is None:
        return MISSING
    digits = 0 if abs(value) >= 99.95 else 1
    return minus(f"{value:+.{digits}f}")


def short(value: float | None) -> str:
    """Three digits; powers of ten only for what is very small or large."""
    if value is None:
        return MISSING
    if value == 0:
        return "0"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    if not 1e-3 <= abs(value) < 1e6:
        mantissa, exponent = f"{value:.1e}".split("e")
        return minus(mantissa) + "·10" + str(int(exponent)).translate(SUPERSCRIPTS)
    digits = max(2 - math.floor(math.log10(abs(value))), 0)
    text = f"{value:.{digits}f}"
    return minus(text.rstrip("0").rstrip(".") if "." in text else text)


def fixed(digits: int) -> Callable[[float | None], str]:
    """A format with so many decimals, so that the values of a column can be compared."""

    def text(value: float | None) -> str:
        if value is None:
            return MISSING
        return "∞" if math.isinf(value) else minus(f"{value:.{digits}f}")

    return text


def memory(value: float | None) -> str:
    return MISSING if value is None else f"{value / 2**20:.1f}"


def interval(value: Interval | None, text: Callable[[float], str]) -> Cell:
    """The median, and the interval as a remark."""
    if value is None:
        return Cell(MISSING)
    return Cell(text(value["median"]), f"{text(value['low'])} to {text(value['high'])}")


# Tables -------------------------------------------------------------------------------------------------------

BEST, FRONT = "★", "◆"
MAIN_ABOUT = (
    "wrong: pixels of the cast shadow that are lit or dark by mistake, in % of the shadow. added: the time above that "
    f"by {data.BUMP_ONLY}, in %, with its 95 % interval below. {BEST} the fewest wrong pixels of the methods that do "
    f"not find the true hit, and the least added time of all except {data.BUMP_ONLY}, with all that the intervals do "
    f"not tell apart from it. {FRONT} on the Pareto front: by the medians no other method is both cheaper and better. "
    f"{MISSING} not measured."
)


def head(method: str) -> Cell:
    return Cell(method_name(method))


def least(values: Iterable[tuple[str, float | None]], without: Sequence[str], text: Callable[[float], str]) -> set[str]:
    """The methods with the smallest value; values that look the same in the table are equally good."""
    known = [(method, value) for method, value in values if value is not None and method not in without]
    if not known:
        return set()
    smallest = text(min(value for _, value in known))
    return {method for method, value in known if text(value) == smallest}


def main_table(report: Report) -> Table:
    """Methods by scenes: what is wrong and what it costs."""
    methods, scenes = report["methods"], list(report["scenes"])
    rows = [[head(method)] for method in methods]
    for scene in scenes:
        wrong = {m: wrong_pixels(report, scene, m) for m in methods}
        cost = {m: added_cost(report, scene, m) for m in methods}
        fewest = least(wrong.items(), TRUE, share)
        cheap = claims.not_told_apart({m: c for m, c in cost.items() if m != "none"})
        ahead = front(report, scene)
        for row, method in zip(rows, methods, strict=True):
            marks = (BEST if method in fewest else "") + (FRONT if method in ahead else "")
            row.append(Cell(share(wrong[method]), marks=marks))
            cell = Cell("0", "by definition") if method == "none" else interval(cost[method], added)
            row.append(Cell(cell.text, cell.note, BEST if method in cheap else ""))
    columns = [Column("method", words=True)]
    for scene in scenes:
        columns += [Column("wrong", scene), Column("added", scene)]
    return Table("Wrong pixels and added cost, in %", columns, rows, MAIN_ABOUT)


Field = tuple[Column, Sequence[str], Callable[[float | None], str]]  # a column, the keys of its value, its format


def field_table(title: str, about: str, entries: Mapping[str, object], fields: Sequence[Field]) -> Table:
    """Methods by fields, without the columns where nothing is known."""
    known = [field for field in fields if any(dig(entry, *field[1]) is not None for entry in entries.values())]
    rows = [[head(m), *(Cell(text(dig(entry, *keys))) for _, keys, text in known)] for m, entry in entries.items()]
    return Table(title, [Column("method", words=True), *(column for column, _, _ in known)], rows, about)


def mask_fields(group: str, key: str) -> list[Field]:
    heads = {"wrong": ("wrong, %", share), "iou": ("IoU", fixed(4)), "edge_mean": ("edge, mean", fixed(2)),
             "edge_95": ("edge, 95 %", fixed(1)), "edge_hausdorff": ("edge, worst", fixed(1))}
    return [(Column(name, group), (key, measure), text) for measure, (name, text) in heads.items()]


def image_fields(group: str, key: str) -> list[Field]:
    heads = {"rmse": ("RMSE", fixed(4)), "psnr": ("PSNR", fixed(1)), "ssim": ("SSIM", fixed(4)),
             "flip": ("FLIP", fixed(4))}
    return [(Column(name, group), (key, measure), text) for measure, (name, text) in heads.items()]


SHADOW_ABOUT = ("IoU: pixels in both shadows over pixels in either. Edges: the distance between the shadows' edges, in "
                "pixels.")
OFFSET_ABOUT = ("τ: how far along the viewing ray the shadow ray starts from the smooth hit; its error is the "
                "difference from exact's. Fell back: the guard chose a lower order. Edge moved: the distance from the "
                "edge without bumps.")
IMAGE_ABOUT = ("Hybrid: smooth shading with true shadows; judge a method by this one. Cast and self: the truly "
               "displaced surface without and with its own shadows; most of that error is shading, which no method "
               "here changes. RMSE, SSIM and FLIP from 0 to 1, PSNR in dB.")


def quality_tables(report: Report, scene: str) -> list[Table]:
    entries = in_order(report, data.qualities(report).get(scene, {}))
    truth = data.truth_version(report) or "POV-Ray"
    shadow = [*mask_fields(f"against {truth}", "mask"), *mask_fields("against kage's exact", "exact")]
    offset = [
        (Column("median", "error of τ, scene units"), ("tau", "median"), short),
        (Column("95 % below", "error of τ, scene units"), ("tau", "p95"), short),
        (Column("fell back, %"), ("fell_back",), share),
        (Column("mean", "edge moved, px"), ("edge_moved", "mean"), fixed(2)),
        (Column("most", "edge moved, px"), ("edge_moved", "hausdorff"), fixed(1)),
    ]
    image = [*image_fields("hybrid: kage's exact", "hybrid"), *image_fields(f"cast: {truth}", "cast"),
             *image_fields(f"self: {truth}", "self")]
    return [
        field_table("The shadow", SHADOW_ABOUT, entries, shadow),
        field_table("The offset", OFFSET_ABOUT, entries, offset),
        field_table("The whole image", IMAGE_ABOUT, entries, image),
    ]


Value = TypeVar("Value")


def in_order(report: Report, found: Mapping[str, Value]) -> dict[str, Value]:
    """What was found by method, in the report's order."""
    return {method: found[method] for method in report["methods"] if method in found}


def parity_table(report: Report) -> Table | None:
    """How far the truth can be trusted: kage's own displacement against POV-Ray's."""
    parity = data.parities(report)
    if not parity:
        return None
    rows = [[Cell(scene), Cell(share(p["self"])), Cell(share(p["cast"])),
             Cell(f"{p['mask_differs']} of {p['mask_shadow']}" if p["mask_shadow"] else MISSING)]
            for scene, p in parity.items()]
    return Table("kage's own displacement against POV-Ray's",
                 [Column("scene", words=True), Column("with own shadows", "pixels within 1/255, %"),
                  Column("without", "pixels within 1/255, %"), Column("shadow pixels that differ")], rows,
                 "The two programs share no code: where they agree, the reference can be trusted.")


def variants(report: Report) -> list[str]:
    return report.get("variants") or []


def timed(report: Report, scene: str) -> dict[str, data.Cost]:
    """The costs of the methods, then of the variants that are no methods."""
    found = data.costs(report).get(scene, {})
    return {name: found[name] for name in (*report["methods"], *variants(report)) if name in found}


def cost_table(report: Report, scene: str) -> Table:
    """Of all that was timed: the methods, then the variants."""
    rows = []
    for method, entry in timed(report, scene).items():
        rows.append([
            head(method), interval(entry["ns"], fixed(1)), interval(entry["added"], added),
            Cell(fixed(0)(entry["instructions"])), Cell(added(entry["instructions_added"])),
            Cell(fixed(2)(entry["shadow_rays"])), Cell(fixed(2)(entry["lookups"])),
            Cell(memory(entry["memory"])), Cell(fixed(2)(entry["build_s"]))])
    columns = [Column("method", words=True), Column("ns", "time a pixel"), Column("added, %", "time a pixel"),
               Column("a pixel", "instructions"), Column("added, %", "instructions"), Column("shadow rays"),
               Column("look-ups"), Column("memory, MB"), Column("build, s")]
    return Table("Time, instructions, memory", columns, rows,
                 "Medians with their 95 % intervals. Shadow rays: per pixel. Look-ups: of the height, per bumped "
                 "sample. Memory: the peak of the whole program. Build: the time before the first ray.")


def stage_times(report: Report, scene: str) -> dict[str, dict[str, float]]:
    """By method and stage, of the methods whose stages were timed, in the report's order."""
    return {method: entry["stages"] for method, entry in timed(report, scene).items() if entry["stages"]}


def stages(report: Report, scene: str) -> list[str]:
    """The names of all methods' stages, in kage's order."""
    return list(dict.fromkeys(stage for times in stage_times(report, scene).values() for stage in times))


def stage_table(report: Report, scene: str) -> Table:
    names = stages(report, scene)
    rows = [[head(method), *(Cell(fixed(2)(times.get(name))) for name in names)]
            for method, times in stage_times(report, scene).items()]
    return Table("Stages, ns a pixel", [Column("method", words=True), *(Column(name) for name in names)], rows)


FUSED_ABOUT = ("Fused loop: figure 5's scene written by hand as one loop that can render nothing else "
               "(bench/limits/fused_kernel.c); no general ray tracer can be much faster.")


def peer_table(report: Report) -> Table | None:
    """Other programs, and kage by bump mapping only on the same scenes."""
    peers = data.peers(report)
    if not peers:
        return None
    rows = []
    for peer in peers:
        none = data.cost(report, peer["scene"], "none")
        base, ns = data.median(none and none["ns"]), data.median(peer["ns"])
        times = f"{short(ns / base)}×" if ns and base else MISSING
        rows.append([
            Cell(peer_name(peer["name"])), Cell(peer["scene"]), interval(peer["ns"], fixed(1)), Cell(times),
            Cell(fixed(2)(peer["build_s"])), Cell(memory(peer["memory"])), Cell(peer.get("note") or "")])
    return Table("Other programs on the same scenes",
                 [Column("program", words=True), Column("scene", words=True), Column("ns a pixel"),
                  Column(f"of kage, {data.BUMP_ONLY}"), Column("build, s"), Column("memory, MB"),
                  Column("note", words=True)], rows,
                 "Renderers differ in too much for these times to judge a method: they show the order of magnitude. "
                 + FUSED_ABOUT)


def method_table(report: Report) -> Table:
    return Table("The methods", [Column("method", words=True), Column("the shadow ray starts", words=True)],
                 [[head(m), Cell(method_about(m))] for m in report["methods"]])


def command_table(report: Report, scene: str) -> Table:
    """What to type for a scene's pictures and times."""
    rows = []
    for method in report["methods"]:
        picture, time = data.quality(report, scene, method), data.cost(report, scene, method)
        for what, command in (("picture", picture and picture["command"]), ("time", time and time["command"])):
            if command:
                rows.append([head(method), Cell(what), Cell(command)])
    for variant in variants(report):
        whole = data.whole(report, scene, variant)
        if whole and (command := whole.get("command")):
            rows.append([head(variant), Cell("whole picture"), Cell(command)])
    columns = [Column("method", words=True), Column("for", words=True), Column("command", words=True)]
    return Table(f"{scene}: commands", columns, rows)


def circumstance_table(report: Report) -> Table:
    about = report["circumstances"]
    packages = ", ".join(f"{name} {version or 'missing'}" for name, version in (about["packages"] or {}).items())
    load = ", ".join(short(value) for value in about["load"] or [])
    ram = about["memory"]
    commit = f"{about['commit']}{' with changes not committed' if about['dirty'] else ''}"
    values = {
        "date": about["date"], "command": about["command"], "level": report["level"], "kage": about["kage"],
        "commit": commit if about["commit"] else None, "processor": about["processor"],
        "memory": f"{ram / 2**30:.1f} GB" if ram else None, "system": about["system"],
        "compiler": about["compiler"], "POV-Ray": about["povray"],
        "packages": packages, "load when the report was made": load,
    }
    rows = [[Cell(name), Cell(str(value or MISSING))] for name, value in values.items()]
    return Table("The machine and the programs", [Column("", words=True), Column("", words=True)], rows)
