"""The report's data (bench/data.py), made from the results. report.json holds it.

What could not be measured is None, and `incomplete` says why, in a line for each reason.
"""

from __future__ import annotations

import importlib.metadata
import os
import platform
import shutil
from collections.abc import Callable, Iterable, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any, cast

from bench import claims, cost, images, programs, quality, stats, sweep, tables, whole, whole_tables
from bench.data import (
    BUMP_ONLY,
    Circumstances,
    Claim,
    Cost,
    CostPart,
    MethodPicture,
    OwnShadows,
    Parity,
    Peer,
    Pictures,
    Quality,
    QualityPart,
    ReferencePicture,
    Report,
    SceneCosts,
    ScenePictures,
    Series,
    Shares,
    Slopes,
    Sweep,
    Whole,
    WholePart,
    added_cost,
    times_none,
)
from bench.data import cost as cost_of
from bench.plan import OWN, TITLES, Bench
from bench.runner import Job
from bench.stats import Interval
from bench.store import Store
from reference import references

Data = dict[str, Any]  # the value of a job
SCHEMA = 1
NOISY = 5.0  # % of the median; above it, small differences of cost are not seen
# The packages that are needed to measure: their names for pip and for Python.
PACKAGES = images.PACKAGES | {"OpenEXR": "OpenEXR", "pillow": "PIL", "tqdm": "tqdm"}
FLOOR = 2.4e-7  # of an error of tau, in scene units: two roundings of a float near 1


class Results:
    """The values of finished jobs, by the names that the plan gives them now."""

    def __init__(self, store: Store, jobs: Sequence[Job]) -> None:
        self.values: dict[str, Data] = {}
        for job in jobs:
            value = store.get(job.name, job.inputs)
            if value is not None:
                self.values[job.name] = value

    def get(self, *words: object) -> Data | None:
        return self.values.get(" ".join(map(str, words)))

    def rounds(self, *words: object, count: int) -> list[Data]:
        """The values of `words 0`, `words 1` ...; an empty list where one is missing, as they are compared in pairs."""
        found = [self.get(*words, number) for number in range(count)]
        return [value for value in found if value] if all(found) else []


# Circumstances ------------------------------------------------------------------------------------


def missing_packages() -> list[str]:
    return images.missing(PACKAGES)


def package_version(name: str) -> str | None:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return None


def circumstances(bench: Bench) -> Circumstances:
    describe = programs.commit()
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return {
        "date": datetime.now(UTC).date().isoformat(), "kage": programs.version([bench.kage, "--version"]),
        "commit": describe.removesuffix("-dirty"), "dirty": describe.endswith("-dirty"),
        "processor": programs.processor(), "memory": memory, "system": f"{platform.system()} {platform.release()}",
        "compiler": programs.version(["gcc", "--version"]),
        "povray": programs.version(["povray", "--version"], r"POV-Ray \d\S*") or None,
        "packages": {name: package_version(name) for name in ("numpy", *PACKAGES)}, "load": list(os.getloadavg()),
        "command": f"make bench BENCH={bench.level.name}",
    }


def incomplete(failed: dict[str, str]) -> list[str]:
    """A line for each reason why the report is not whole. `failed`: jobs and why they could not be done."""
    lines = []
    if not programs.has_povray():
        lines.append("POV-Ray is missing: its times are left out (`scripts/bootstrap povray` installs it)")
    packages = missing_packages()
    if packages:
        lines.append(f"Python packages are missing: {', '.join(packages)}; what needs them is left out (`scripts/venv` "
                     "installs them)")
    if not shutil.which("valgrind"):
        lines.append("valgrind is missing: instructions are not counted (Debian: valgrind)")
    reasons: dict[str, list[str]] = {}
    for name, why in failed.items():
        if not any(PACKAGES[package].partition(".")[0] in why for package in packages):  # the line above says that
            reasons.setdefault(why, []).append(name)
    return lines + [f"{names[0]}{f' and {len(names) - 1} more' if len(names) > 1 else ''}: {why}"
                    for why, names in reasons.items()]


# Cost ---------------------------------------------------------------------------------------------


def kage_cost(bench: Bench, results: Results, scene: str, method: str, base: list[Data]) -> Cost:
    level = bench.level
    times = results.rounds("time", scene, method, count=level.rounds)
    counted, none_counted = results.get("count", scene, method), results.get("count", scene, "none")
    weighed = results.get("memory", scene, method)
    found: Cost = {"ns": None, "added": None, "stages": None, "shadow_rays": None, "lookups": None,
                   "instructions": None, "instructions_added": None, "memory": weighed["memory"] if weighed else None,
                   "build_s": 0.0, "command": cost.shown(bench, bench.scenes[scene], method)}
    if times:
        ns = [t["ns"]["render"] for t in times]
        counts = times[0]["counts"]
        stages = [name for name in times[0]["ns"] if name != "render"]
        found["ns"] = stats.interval(ns)
        found["stages"] = {name: median([t["ns"][name] for t in times]) for name in stages}
        found["shadow_rays"] = counts["shadow_rays"] / counts["rays"]
        found["lookups"] = counts["lookups"] / max(counts["bumped"], 1)
        if base and method != "none":
            found["added"] = stats.paired_interval(ns, [t["ns"]["render"] for t in base])
    if counted:
        found["instructions"] = counted["instructions"]
        if none_counted and method != "none":
            found["instructions_added"] = 100 * (counted["instructions"] / none_counted["instructions"] - 1)
    return found


def median(values: Sequence[float]) -> float:
    return stats.interval(values)["median"]


def peer(name: str, scene: str, command: str, note: str, times: Sequence[float], build: Sequence[float],
         memory: Data | None) -> Peer:
    return {"name": name, "scene": scene, "ns": stats.interval(times) if times else None,
            "build_s": median(build) if build else None, "memory": memory["memory"] if memory else None,
            "command": command, "note": note}


def ratios(ns: Sequence[float], bases: Mapping[str, Sequence[float]]) -> dict[str, Interval]:
    """How many times as long it takes as each base: round by round, as what slows the machine slows both."""
    return {base: stats.interval([a / b for a, b in zip(ns, others, strict=True)])
            for base, others in bases.items() if ns and others}


def povray_peers(bench: Bench, results: Results) -> list[Peer]:
    size, rounds = bench.level.povray_size, bench.level.rounds
    scenes = cost.povray_scenes(bench)
    found = []
    for name, scene, path, made in scenes:
        times = results.rounds("time", scene, name, count=rounds)
        bases = {m: [t["ns"]["render"] for t in results.rounds("time", scene, m, count=rounds)] for m in ("none", "0")}
        bases |= {other: [t["ns"] for t in results.rounds("time", scene, other, count=rounds)]
                  for other, at, *_ in scenes if at == scene and other != name}
        note = f"{size[0]} x {size[1]} pixels; build is its parsing"
        if made and "mesh2" in name and bench.level.mesh_size:
            note += f"; a mesh as fine as {bench.level.mesh_size[0]} x {bench.level.mesh_size[1]} pixels need"
        one = peer(name, scene, programs.shown(programs.povray_command(path, size)), note, [t["ns"] for t in times],
                   [t["build_s"] for t in times], results.get("memory", scene, name))
        one["times"] = ratios([t["ns"] for t in times], bases)
        found.append(one)
    return [p for p in found if p["ns"]]


def limit_peers(bench: Bench, results: Results) -> list[Peer]:
    note = "1920 x 1080 pixels, the best of several repeats"
    found = []
    fused = results.rounds("time cube", cost.FUSED, count=bench.level.rounds)
    for order in fused[0]["orders"] if fused else ():
        found.append(peer(f"{cost.FUSED}, {order}", "cube", "bench/limits/fused_kernel.c", note,
                          [t["orders"][order] for t in fused], [], None))
    for name in cost.EMBREE:
        times = results.rounds("time cube", name, count=bench.level.rounds)
        one = peer(name, "cube", "bench/limits/embree_loop.c", note, [t["ns"] for t in times],
                   [t["build_s"] for t in times], results.get("memory cube", name))
        own = [t["ns"]["render"] for t in results.rounds("time cube displaced", count=bench.level.rounds)]
        one["times"] = ratios([t["ns"] for t in times], {"displaced": own})
        found.append(one)
    return [p for p in found if p["ns"]]


def costs(bench: Bench, results: Results) -> CostPart:
    scenes: dict[str, SceneCosts] = {}
    noise: dict[str, float | None] = {}
    for scene in bench.scenes:
        base = results.rounds("time", scene, "none", count=bench.level.rounds)
        scenes[scene] = {"methods": {m: kage_cost(bench, results, scene, m, base) for m in bench.level.timed}}
        noise[scene] = stats.noise([t["ns"]["render"] for t in base]) if base else None
    return {"size": list(bench.level.cost_size), "scenes": scenes, "noise": noise,
            "peers": povray_peers(bench, results) + limit_peers(bench, results)}


def notes(noise: Mapping[str, float | None]) -> list[str]:
    return [f"{scene}: repeats of the same render were {share:.1f} % apart (half the interquartile range): the machine "
            "was too noisy for small differences of time; instruction counts have no such noise"
            for scene, share in noise.items() if share is not None and share > NOISY]


# Quality ------------------------------------------------------------------------------------------


def quality_entry(value: Data) -> Quality:
    """What the report shows of the value of a job of bench/quality.py."""
    return {"mask": value.get("mask"), "exact": value.get("exact"), "tau": value.get("tau"),
            "fell_back": value.get("fell_back"), "edge_moved": value.get("edge_moved"), "hybrid": value.get("hybrid"),
            "cast": value.get("cast"), "self": value.get("self"), "command": value.get("command")}


def quality_of(bench: Bench, results: Results) -> QualityPart:
    scenes: dict[str, dict[str, Quality]] = {}
    parity: dict[str, Parity] = {}
    for scene in bench.scenes:
        found = {method: results.get("quality", scene, method) or {} for method in bench.level.methods}
        scenes[scene] = {method: quality_entry(value) for method, value in found.items()}
        own = found.get("displaced", {})
        if "mask_differs" in own:
            parity[scene] = {"self": own["self_close"], "cast": own["cast_close"], "mask": own["mask"]["wrong"],
                             "mask_differs": own["mask_differs"], "mask_shadow": own["mask_shadow"]}
    return {"truth": povray_of_references(bench), "picture_size": list(quality.picture_size(bench)), "scenes": scenes,
            "parity": parity}


def povray_of_references(bench: Bench) -> str | None:
    versions = {str(entry.get("povray")) for entry in references.read_manifest(bench.references).values()}
    return ", ".join(sorted(versions)) or None


def why_left_out(bench: Bench, results: Results) -> dict[str, str]:
    """By the name of a job that was done in part."""
    found = {f"quality {scene} {method}": results.get("quality", scene, method) or {}
             for scene in bench.scenes for method in bench.level.methods}
    found |= {f"whole {scene} {variant}": results.get("whole", scene, variant) or {}
              for scene in bench.scenes for variant in bench.level.variants}
    return {name: str(value["why"]) for name, value in found.items() if "why" in value}


REFERENCES = {"cast": "POV-Ray, displaced, only other objects' shadows", "self": "POV-Ray, displaced, all shadows"}


def scene_pictures(bench: Bench, scene: str) -> ScenePictures:
    def relative(name: str) -> str | None:
        path = bench.picture(scene, name)
        return str(path.relative_to(bench.out)) if path.exists() else None

    def both(name: str, wrong: str) -> MethodPicture | None:
        file = relative(name)
        return None if file is None else {"file": file, "wrong": relative(wrong)}

    methods = {m: both(quality.slug(m), f"{quality.slug(m)}.wrong") for m in bench.level.methods}
    variants = {v: both(*whole.file_names(v)) for v in ("displaced", *bench.level.variants)}
    shown: list[ReferencePicture] = [{"name": name, "file": file} for kind, name in REFERENCES.items()
                                     if (file := relative(f"povray-{kind}")) is not None]
    return {"methods": {m: picture for m, picture in methods.items() if picture},
            "variants": {v: picture for v, picture in variants.items() if picture}, "references": shown,
            "orders": relative(whole.ORDERS)}


def pictures(bench: Bench) -> Pictures:
    scenes = {scene: scene_pictures(bench, scene) for scene in bench.scenes}
    return {"size": list(quality.mask_size(bench)), "scenes": scenes}


# Whole pictures -----------------------------------------------------------------------------------


def series(bench: Bench, values: Sequence[float], found: Sequence[Data | None]) -> Series:
    """`found` has a value of whole.measure_setting for each of the values."""
    return {"values": list(values),
            "off": {v: [one["off"].get(v) if one else None for one in found] for v in bench.level.variants}}


def over_settings(bench: Bench, results: Results, scene: str, settings: Mapping[Any, whole.Setting]) -> Series:
    return series(bench, list(settings), [results.get("whole", scene, one.name) for one in settings.values()])


def own_shadows(results: Results, scene: str) -> OwnShadows:
    found = [results.get("own", scene, height) for height in whole.HEIGHTS]
    wrong: dict[str, list[float | None]] = {
        how: [100 * one["wrong"][how] / one["shadow"] if one and one["shadow"] >= sweep.LEAST_SHADOW else None
              for one in found] for how in OWN}
    return {"values": list(whole.HEIGHTS), "shadow": [one["shadow"] if one else None for one in found], "wrong": wrong}


def whole_entry(value: Data) -> Whole:
    found = {key: value[key] for key in value if key != "why"}
    return cast(Whole, found)


def whole_of(bench: Bench, results: Results) -> WholePart:
    scenes = bench.scenes
    values = {name: {v: results.get("whole", name, v) for v in bench.level.variants} for name in scenes}
    orders = {name: value["orders"] for name in scenes if (value := results.get("orders", name))}
    return {
        "scenes": {name: {v: whole_entry(value) for v, value in found.items() if value}
                   for name, found in values.items()},
        "lamps": {name: over_settings(bench, results, name, whole.lamps(bench, s)) for name, s in scenes.items()},
        "slopes": {name: over_settings(bench, results, name, whole.slopes(bench, s)) for name, s in scenes.items()},
        "own": {name: own_shadows(results, name) for name in scenes}, "orders": orders,
    }


# Sweeps and slopes --------------------------------------------------------------------------------


def costs_of(methods: Mapping[str, Cost]) -> dict[str, float]:
    """By instructions, which are the same each time; by time where they were not counted."""
    counted = {m: c["instructions"] for m, c in methods.items() if c["instructions"]}
    return counted or {m: c["ns"]["median"] for m, c in methods.items() if c["ns"]}


def cell(value: Data | None) -> Shares | None:
    if value is None or value["shadow"] < sweep.LEAST_SHADOW:
        return None
    return {method: 100 * wrong / value["shadow"] for method, wrong in value["wrong"].items()}


def sweeps(bench: Bench, results: Results, costs: Mapping[str, SceneCosts]) -> list[Sweep]:
    found: list[Sweep] = []
    compared = [m for m in sweep.methods(bench) if not m.endswith(" bare")]
    for one in sweep.sweeps(bench):
        values = [[results.get(sweep.cell_job(bench, one, i, j).name) for i in range(len(one.xs))]
                  for j in range(len(one.ys))]
        found.append({
            "id": f"{one.scene}-{one.id}", "scene": one.scene, "title": sweep.TITLES[one.id], "about": one.about(),
            "x": {"name": one.x, "label": sweep.AXES[one.x], "values": list(one.xs)},
            "y": {"name": one.y, "label": sweep.AXES[one.y], "values": list(one.ys)},
            "by_cost": sweep.by_cost(costs_of(costs[one.scene]["methods"]), compared),
            "wrong": [[cell(value) for value in row] for row in values],
            "shadow_pixels": [[value["shadow"] if value else None for value in row] for row in values],
        })
    return found


def slopes(bench: Bench, results: Results) -> dict[str, Slopes]:
    found: dict[str, Slopes] = {}
    for scene in sweep.sloped(bench):
        values = [results.get(sweep.amplitude_job(bench, scene, slope).name) for slope in sweep.AMPLITUDES]
        error: dict[str, list[float | None]] = {
            m: [value["error"][m] if value else None for value in values] for m in sweep.SLOPE_METHODS}
        found[scene.name] = {
            "amplitude": list(sweep.AMPLITUDES), "label": "amplitude, as the slope that 95 % are below", "error": error,
            "floor": FLOOR, "theory": dict(sweep.THEORY[scene.name]),
            "fit": {m: stats.fit_exponent(sweep.AMPLITUDES, error[m], FLOOR) for m in sweep.SLOPE_METHODS},
        }
    return found


# The whole ----------------------------------------------------------------------------------------


def answer(data: Report) -> list[str]:
    """What a reader should take away: a line each for cost, quality, orders, slopes and displacement."""
    lines = [cost_line(data)]
    shares = {scene: (tables.wrong_pixels(data, scene, "none"), tables.wrong_pixels(data, scene, "0"))
              for scene in data["scenes"]}
    known = {scene: (before, after) for scene, (before, after) in shares.items() if before and after is not None}
    if known:
        removed = [100 * (1 - after / before) for before, after in known.values()]
        lines.append(f"Quality: order 0 corrects {min(removed):.0f} to {max(removed):.0f} % of the wrong pixels: "
                     + ", ".join(f"{scene} {a:.2g} to {b:.2g} %" for scene, (a, b) in known.items()) + ".")
    return [*lines, *order_line(data), *auto_line(data), *relief_line(data), rule(data["sweeps"]), displaced_line(data)]


ORDERS = ("0", "1", "2", "2+")


def joined(words: Sequence[str]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def order_line(data: Report) -> list[str]:
    """The best order of each scene, and where a higher one is no better than order 0."""
    wrong = {scene: {m: value for m in (*ORDERS, "march:4")
                     if (value := tables.wrong_pixels(data, scene, m)) is not None} for scene in data["scenes"]}
    best: dict[str, list[str]] = {}
    for scene, found in wrong.items():
        if known := [(found[m], m) for m in ORDERS if m in found]:
            best.setdefault(min(known)[1], []).append(f"the {scene}")
    if not best:
        return []
    line = "Best: " + "; ".join(f"{tables.method_name(m)} on {joined(scenes)}" for m, scenes in best.items()) + "."
    for scene, found in wrong.items():
        if all(m in found for m in (*ORDERS, "march:4")) and found["march:4"] < min(found[m] for m in ORDERS) \
                and found["0"] <= min(found[m] for m in ORDERS):
            line += (f" On the {scene} no higher order is better than order 0 ({found['0']:.2g} % wrong), but a few "
                     f"steps are: march:4 ({found['march:4']:.2g} %).")
    return [line]


def span(values: Iterable[float | None], form: str = ".2g") -> str | None:
    """From the least to the largest of those that are known."""
    known = [value for value in values if value is not None]
    if not known:
        return None
    low, high = (f"{value:{form}}" for value in (min(known), max(known)))
    return low if low == high else f"{low} to {high}"


def auto_line(data: Report) -> list[str]:
    wrong = span(whole_tables.exact_wrong(data, scene, "auto") for scene in data["scenes"])
    times = time_span(data, "auto")
    if wrong is None or times is None:
        return []
    return [f"Good enough: auto leaves {wrong} % of the shadow's pixels wrong. It takes {times}."]


def relief_line(data: Report) -> list[str]:
    before, after = (span(whole_tables.off(data, scene, v) for scene in data["scenes"]) for v in ("none", "relief"))
    times = time_span(data, "relief")
    if before is None or after is None or times is None:
        return []
    return [f"Whole picture: by bump mapping alone {before} % of the receiver's pixels differ from true displacement "
            f"by more than 8/255, by `--relief` {after} %, silhouettes apart. It takes {times}."]


def time_span(data: Report, method: str) -> str | None:
    """Over all scenes, with the intervals; None where nothing was measured."""
    found = claims.over_all(times_none(cost_of(data, scene, method)) for scene in data["scenes"])
    return found and f"{claims.span_text(found, '.1f')} times the time by {BUMP_ONLY}"


def cost_line(data: Report) -> str:
    """Time by its interval; beside it the count of instructions, which has no noise."""
    def added(method: str) -> str:
        cost = cost_of(data, "cube", method)
        time = claims.measured_span(added_cost(cost), "+.0f", "%", 0.0)
        counted = cost and cost["instructions_added"]
        return f"{tables.method_name(method)} {time}" + ("" if counted is None else f" ({counted:+.0f} % instructions)")

    costs = ", ".join(added(method) for method in ("0", "1", "2", "march:4", "exact"))
    return f"Cost in figure 5's scene, over {BUMP_ONLY}, as 95 % intervals of the time: {costs}."


def displaced_line(data: Report) -> str:
    found = {scene: times for scene in data["scenes"] if (times := times_none(cost_of(data, scene, "displaced")))}
    spans = ", ".join(f"{claims.span_text(times, '.0f')} on the {scene}" for scene, times in found.items())
    return (f"Direct intersection: to render the displaced surface takes, in times {BUMP_ONLY}, {spans}." if found
            else "Direct intersection: not measured.")


def rule(sweeps: Sequence[Sweep], most: float = 1.0, least_view: float = 30) -> str:
    """The largest slope up to which a method is good enough, wherever the eye is least_view degrees high or higher."""
    for one in sweeps:
        if (one["x"]["name"], one["y"]["name"]) != ("slope", "view"):
            continue
        rows = [j for j, view in enumerate(one["y"]["values"]) if view >= least_view]
        texts = []
        for method in ("0", "2", "march:4"):
            reached = [tables.reach(one, row, method, most) for row in rows]
            known = [slope for slope in reached if slope is not None]
            if known and len(known) == len(reached):
                texts.append(f"{method} up to slope {min(known):g}")
        if texts:
            return (f"When: if the eye is {least_view:g} degrees above the ground or higher, at most {most:g} % of the "
                    f"shadow is wrong by {', '.join(texts)} ({one['scene']}).")
    return "When: not measured."


def summarise(bench: Bench, store: Store, jobs: Sequence[Job], failed: dict[str, str],
              judge: Callable[[Report], list[Claim]]) -> Report:
    """`judge` makes the claims from the rest."""
    results = Results(store, jobs)
    lines = incomplete(failed | why_left_out(bench, results))
    cost_part = costs(bench, results)
    data: Report = {
        "schema": SCHEMA, "level": bench.level.name, "complete": not lines, "incomplete": lines,
        "notes": notes(cost_part["noise"]),
        "circumstances": circumstances(bench), "methods": list(bench.level.methods),
        "variants": list(bench.level.variants),
        "scenes": {name: {"title": TITLES.get(name, name), "slope_median": f.slope_median, "slope_95": f.slope_95,
                          "receiver": f.receiver, "size": list(quality.mask_size(bench)),
                          "shadow_pixels": (results.get("quality", name, "none") or {}).get("mask_shadow")}
                   for name, f in bench.scenes.items()},
        "cost": cost_part, "quality": quality_of(bench, results), "whole": whole_of(bench, results),
        "pictures": pictures(bench),
        "sweeps": sweeps(bench, results, cost_part["scenes"]), "slopes": slopes(bench, results),
    }
    data["claims"] = judge(data)
    data["answer"] = answer(data)
    return data
