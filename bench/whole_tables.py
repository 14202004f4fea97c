"""The tables of whole pictures, of the bumps' own shadows and of auto, like those of the methods in bench/tables.py."""

from __future__ import annotations

import math
from collections.abc import Mapping

from bench import claims, data, stats
from bench.data import BUMP_ONLY, Report
from bench.stats import Interval
from bench.tables import (
    BEST,
    FRONT,
    MISSING,
    Cell,
    Column,
    Field,
    Table,
    field_table,
    fixed,
    head,
    interval,
    method_name,
    scene_title,
    share,
    short,
    variants,
)

LEAST_WRONG = 0.1  # % of the shadow's pixels: what is as good as exact

WHOLE_ABOUT = (
    "off: pixels of the receiver that differ from true displacement with all shadows by more than 8/255 in red, green "
    f"or blue (linear light), in %, without its silhouette. cost: times that of {BUMP_ONLY}, with its 95 % interval "
    f"below. {FRONT} on the Pareto front: by the medians no other variant is both cheaper and nearer."
)
ERRORS_ABOUT = (
    "off by more than 1, 8 and 32/255: % of the receiver's pixels away from the silhouette; median and 95th percentile "
    "of these pixels' errors, in 255ths. FLIP: of the whole picture, 0 to 1. Silhouette: where the smooth picture and "
    "the displaced one see different things, and the pixels beside; no variant moves it. Of the rest: the share of all "
    "pixels off by more than 8/255 that are there."
)
HEIGHT_ABOUT = "% of the receiver off by more than 8/255, away from the silhouette."
OWN_ABOUT = (
    "Wrong pixels in % of the own shadow's, against {truth}'s mask: the scene without its other objects, the lamp at "
    "some degrees above the horizon, its compass direction and distance as in the scene. The rays start at exact's "
    "place, so that only the own shadow can be wrong. A number is that of steps. {missing}: too little shadow."
)
PARETO_ABOUT = (
    f"The cheapest first, by the medians. {FRONT} no other method beats it in both. Wrong: % of the shadow's "
    f"pixels, against kage's exact. {BEST} at most {LEAST_WRONG:g} % wrong at the least cost, with all that the "
    "intervals do not tell apart from it."
)


def own_name(how: str) -> str:
    """A column's head: `own 8` is `8`."""
    return how.removeprefix("own ")


def times(value: Interval | None) -> Cell:
    return interval(value, fixed(2))


def cost_cell(report: Report, scene: str, method: str) -> Cell:
    return Cell("1", "by definition") if method == "none" else times(data.times_none(data.cost(report, scene, method)))


def cost_times(report: Report, scene: str, method: str) -> float | None:
    return 1.0 if method == "none" else data.median(data.times_none(data.cost(report, scene, method)))


def ahead(costs: Mapping[str, float | None], errors: Mapping[str, float | None]) -> list[str]:
    """The names on the Pareto front, the cheapest first."""
    known = {name: (cost, error) for name, cost in costs.items()
             if cost is not None and (error := errors.get(name)) is not None}
    names = list(known)
    return [names[i] for i in stats.pareto(list(known.values()))]


def off(report: Report, scene: str, variant: str) -> float | None:
    """% of the ground that is off by more than 8/255."""
    found = data.whole(report, scene, variant)
    return found["off_8"] if found else None


def whole_table(report: Report) -> Table:
    """Variants by scenes: what is off and what it costs."""
    names, scenes = variants(report), list(data.wholes(report))
    rows = [[head(name)] for name in names]
    for scene in scenes:
        share_off = {name: off(report, scene, name) for name in names}
        front = ahead({name: cost_times(report, scene, name) for name in names}, share_off)
        for row, name in zip(rows, names, strict=True):
            row.append(Cell(share(share_off[name]), marks=FRONT if name in front else ""))
            row.append(cost_cell(report, scene, name))
    columns = [Column("variant", words=True)]
    for scene in scenes:
        columns += [Column("off", scene), Column("cost", scene)]
    return Table(f"Pixels that are off by more than 8/255, in %, and cost, in times {BUMP_ONLY}", columns, rows,
                 WHOLE_ABOUT)


def error_fields(group: str, *keys: str) -> list[Field]:
    heads = {"off_1": ("> 1", share), "off_8": ("> 8", share), "off_32": ("> 32", share),
             "median": ("median", fixed(2)), "p95": ("95 %", fixed(1)),
             "silhouette_off": ("silhouette > 8, %", fixed(1)), "of_rest": ("of the rest, %", fixed(1))}
    return [(Column(name, group), (*keys, measure), text) for measure, (name, text) in heads.items()]


def whole_scene_table(report: Report, scene: str) -> Table:
    truth = data.truth_version(report) or "POV-Ray"
    fields = [*error_fields("against kage's displaced", ), (Column("FLIP"), ("flip",), fixed(4)),
              *error_fields(f"against {truth}'s", "povray")]
    found = data.wholes(report).get(scene, {})
    entries = {name: found[name] for name in variants(report) if name in found}
    edge = next((entry["silhouette"] for entry in entries.values()), None)
    return field_table(f"{scene_title(report, scene)}: {share(edge)} % of the receiver is at the silhouette",
                       ERRORS_ABOUT, entries, fields)


def series_table(title: str, series: data.Series, unit: str) -> Table:
    rows = [[head(name), *(Cell(share(value)) for value in values)] for name, values in series["off"].items()]
    return Table(title, [Column("variant", words=True), *(Column(f"{short(v)}{unit}") for v in series["values"])], rows,
                 HEIGHT_ABOUT)


def series_tables(report: Report, scene: str) -> list[Table]:
    """Over the lamp's height, and over the slope of the bumps."""
    part = data.whole_part(report)
    lamps, slopes = (part.get("lamps") or {}).get(scene), (part.get("slopes") or {}).get(scene)
    found = [series_table("Over the height of the lamp", lamps, "°")] if lamps else []
    return found + ([series_table("Over the slope of the bumps (95 % are below)", slopes, "")] if slopes else [])


def whole_number(value: int | None) -> str:
    return MISSING if value is None else str(value)


def own_table(report: Report) -> Table | None:
    """Scenes and heights of the lamp by ways to find the own shadow."""
    part = data.whole_part(report).get("own") or {}
    ways = list(dict.fromkeys(how for found in part.values() for how in found["wrong"]))
    rows = [[Cell(f"{scene}, {short(height)}°"), Cell(whole_number(found["shadow"][i])),
             *(Cell(share(found["wrong"][how][i])) for how in ways)]
            for scene, found in part.items() for i, height in enumerate(found["values"])]
    if not rows:
        return None
    columns = [Column("scene, lamp", words=True), Column("shadow pixels"),
               *(Column(own_name(how), "wrong, %") for how in ways)]
    about = OWN_ABOUT.format(truth=data.truth_version(report) or "POV-Ray", missing=MISSING)
    return Table("Wrong pixels of the bumps' own shadows", columns, rows, about)


def exact_wrong(report: Report, scene: str, method: str) -> float | None:
    return data.mask_metric(data.quality(report, scene, method), "exact", "wrong")


def good_enough(report: Report, scene: str) -> list[str]:
    """The methods with at most LEAST_WRONG % wrong pixels whose cost is known, the cheapest first."""
    found = [(cost, method) for method in report["methods"] if method != "displaced"
             and (wrong := exact_wrong(report, scene, method)) is not None and wrong <= LEAST_WRONG
             and (cost := cost_times(report, scene, method)) is not None]
    return [method for _, method in sorted(found)]


def pareto_table(report: Report, scene: str) -> Table:
    names = [method for method in report["methods"] if method != "displaced"]
    costs = {name: cost_times(report, scene, name) for name in names}
    wrong = {name: exact_wrong(report, scene, name) for name in names}
    front = ahead(costs, wrong)
    good = claims.not_told_apart({name: data.times_none(data.cost(report, scene, name))
                                  for name in good_enough(report, scene)})
    names.sort(key=lambda name: math.inf if costs[name] is None else costs[name] or 0.0)
    rows = [[head(name), cost_cell(report, scene, name),
             Cell(short(wrong[name]), marks=(BEST if name in good else "") + (FRONT if name in front else ""))]
            for name in names]
    return Table(scene_title(report, scene), [Column("method", words=True), Column(f"cost, times {BUMP_ONLY}"),
                                              Column("wrong, %")], rows)


def order_table(report: Report) -> Table | None:
    """What auto needed."""
    part = data.whole_part(report).get("orders") or {}
    names = list(dict.fromkeys(name for found in part.values() for name in found))
    rows = [[Cell(scene), *(Cell(share(found.get(name))) for name in names)] for scene, found in part.items()]
    return Table("What auto needed, % of the receiver's pixels",
                 [Column("scene", words=True), *(Column(method_name(name)) for name in names)], rows) if rows else None
