"""The report's data, from the results: one dictionary, which report.json holds.

What could not be measured is None, and `incomplete` says why, a line each.
"""

from __future__ import annotations

import importlib
import importlib.metadata
import os
import platform
import shutil
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from bench import cost, programs, quality, stats, sweep, tables
from bench.plan import TITLES, Bench
from bench.programs import TOP
from bench.store import Store

Data = dict[str, Any]
SCHEMA = 1
NOISY = 5.0  # % of the median; above it, small differences of cost can't be told
PACKAGES = {"scikit-image": "skimage.metrics", "flip-evaluator": "flip_evaluator", "OpenEXR": "OpenEXR", "pillow": "PIL",
            "tqdm": "tqdm"}  # that measure, as pip calls them and as Python does
FLOOR = 2.4e-7  # of an error of tau, in scene units: two roundings of a float near 1


class Results:
    """The values of finished jobs, by what the plan calls them now."""

    def __init__(self, store: Store, jobs: Sequence[Any]) -> None:
        self.values: dict[str, Data] = {}
        for job in jobs:
            value = store.get(job.name, job.inputs)
            if value is not None:
                self.values[job.name] = value

    def get(self, *words: object) -> Data | None:
        return self.values.get(" ".join(map(str, words)))

    def rounds(self, *words: object, count: int) -> list[Data]:
        """The values of `words 0`, `words 1` ...; none where one is missing, as they are compared pair by pair."""
        found = [self.get(*words, number) for number in range(count)]
        return [value for value in found if value] if all(found) else []


# Circumstances ------------------------------------------------------------------------------------


def missing_packages() -> list[str]:
    def lacks(module: str) -> bool:
        try:
            importlib.import_module(module)
        except ImportError:
            return True
        return False

    return [name for name, module in PACKAGES.items() if lacks(module)]


def package_version(name: str) -> str | None:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return None


def circumstances(bench: Bench) -> Data:
    describe = programs.commit()
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return {
        "date": datetime.now(UTC).date().isoformat(), "kage": programs.version([bench.kage, "--version"]),
        "commit": describe.removesuffix("-dirty"), "dirty": describe.endswith("-dirty"), "processor": programs.processor(),
        "memory": memory, "system": f"{platform.system()} {platform.release()}",
        "compiler": programs.version(["gcc", "--version"]),
        "povray": programs.version(["povray", "--version"], r"POV-Ray \d\S*") or None,
        "packages": {name: package_version(name) for name in ("numpy", *PACKAGES)}, "load": os.getloadavg(),
        "command": f"make bench BENCH={bench.level.name}",
    }


def incomplete(bench: Bench, failed: dict[str, str]) -> list[str]:
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
        if not any(PACKAGES[package].partition(".")[0] in why for package in packages):  # that is told already
            reasons.setdefault(why, []).append(name)
    return lines + [f"{names[0]}{f' and {len(names) - 1} more' if len(names) > 1 else ''}: {why}"
                    for why, names in reasons.items()]


# Cost ---------------------------------------------------------------------------------------------


def kage_cost(bench: Bench, results: Results, scene: str, method: str, base: list[Data]) -> Data:
    level = bench.level
    times = results.rounds("time", scene, method, count=level.rounds)
    counted, none_counted = results.get("count", scene, method), results.get("count", scene, "none")
    weighed = results.get("memory", scene, method)
    found: Data = {"ns": None, "added": None, "stages": None, "shadow_rays": None, "lookups": None, "instructions": None,
                   "instructions_added": None, "memory": weighed and weighed["memory"], "build_s": 0.0,
                   "command": cost.shown(bench, bench.scenes[scene], method)}
    if times:
        ns = [t["ns"]["render"] for t in times]
        counts = times[0]["counts"]
        stages = [name for name in times[0]["ns"] if name != "render"]
        found |= {"ns": stats.interval(ns), "stages": {name: median([t["ns"][name] for t in times]) for name in stages},
                  "shadow_rays": counts["shadow_rays"] / counts["rays"], "lookups": counts["lookups"] / max(counts["bumped"], 1)}
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
         memory: Data | None) -> Data:
    return {"name": name, "scene": scene, "ns": stats.interval(times) if times else None,
            "build_s": median(build) if build else None, "memory": memory and memory["memory"], "command": command, "note": note}


def ratios(ns: Sequence[float], bases: dict[str, Sequence[float]]) -> Data:
    """How many times each base is in it: round by round, as what slows the machine hits both."""
    return {base: stats.interval([a / b for a, b in zip(ns, others, strict=True)]) for base, others in bases.items() if ns and others}


def povray_peers(bench: Bench, results: Results) -> list[Data]:
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
        found.append(peer(name, scene, programs.shown(programs.povray_command(path, size)), note, [t["ns"] for t in times],
                          [t["build_s"] for t in times], results.get("memory", scene, name))
                     | {"times": ratios([t["ns"] for t in times], bases)})
    return [p for p in found if p["ns"]]


def limit_peers(bench: Bench, results: Results) -> list[Data]:
    note = "1920 x 1080 pixels, the best of several repeats"
    found = []
    fused = results.rounds("time cube", cost.FUSED, count=bench.level.rounds)
    for order in fused[0]["orders"] if fused else ():
        found.append(peer(f"{cost.FUSED}, {order}", "cube", "bench/limits/fused_kernel.c", note,
                          [t["orders"][order] for t in fused], [], None))
    for name in cost.EMBREE:
        times = results.rounds("time cube", name, count=bench.level.rounds)
        found.append(peer(name, "cube", "bench/limits/embree_loop.c", note, [t["ns"] for t in times],
                          [t["build_s"] for t in times], results.get("memory cube", name)))
    return [p for p in found if p["ns"]]


def costs(bench: Bench, results: Results) -> Data:
    scenes, noise = {}, {}
    for scene in bench.scenes:
        base = results.rounds("time", scene, "none", count=bench.level.rounds)
        scenes[scene] = {"methods": {m: kage_cost(bench, results, scene, m, base) for m in bench.level.methods}}
        noise[scene] = stats.noise([t["ns"]["render"] for t in base]) if base else None
    return {"size": list(bench.level.cost_size), "scenes": scenes, "noise": noise,
            "peers": povray_peers(bench, results) + limit_peers(bench, results)}


def notes(data: Data) -> list[str]:
    return [f"{scene}: repeats of the same render were {noise:.1f} % apart (half the interquartile range): the machine was too "
            "noisy for small differences of cost; instruction counts are not touched by that"
            for scene, noise in data["cost"]["noise"].items() if noise is not None and noise > NOISY]


# Quality ------------------------------------------------------------------------------------------

QUALITY = ("mask", "exact", "tau", "fell_back", "edge_moved", "hybrid", "cast", "self", "command")


def quality_of(bench: Bench, results: Results) -> Data:
    scenes: Data = {}
    parity: Data = {}
    for scene in bench.scenes:
        found = {method: results.get("quality", scene, method) or {} for method in bench.level.methods}
        scenes[scene] = {method: {key: value.get(key) for key in QUALITY} for method, value in found.items()}
        own = found.get("displaced", {})
        if "mask_differs" in own:
            parity[scene] = {"self": own["self_close"], "cast": own["cast_close"], "mask": own["mask"]["wrong"],
                             "mask_differs": own["mask_differs"], "mask_shadow": own["mask_shadow"]}
    return {"truth": povray_of_references(bench), "picture_size": list(quality.picture_size(bench)), "scenes": scenes,
            "parity": parity}


def povray_of_references(bench: Bench) -> str | None:
    from reference import references

    versions = {str(entry.get("povray")) for entry in references.read_manifest(bench.references).values()}
    return ", ".join(sorted(versions)) or None


def why_left_out(bench: Bench, results: Results) -> dict[str, str]:
    """Jobs that were done in part."""
    found = {f"quality {scene} {method}": results.get("quality", scene, method) or {}
             for scene in bench.scenes for method in bench.level.methods}
    return {name: str(value["why"]) for name, value in found.items() if "why" in value}


def pictures(bench: Bench) -> Data:
    def relative(path: Path) -> str | None:
        return str(path.relative_to(bench.out)) if path.exists() else None

    scenes: Data = {}
    for scene in bench.scenes:
        methods = {m: {"file": relative(bench.picture(scene, quality.slug(m))),
                       "wrong": relative(bench.picture(scene, f"{quality.slug(m)}.wrong"))} for m in bench.level.methods}
        names = {"cast": "POV-Ray, displaced, only other objects' shadows", "self": "POV-Ray, displaced, all shadows"}
        shown = [{"name": name, "file": relative(bench.picture(scene, f"povray-{kind}"))} for kind, name in names.items()]
        scenes[scene] = {"methods": {m: p for m, p in methods.items() if p["file"]},
                         "references": [p for p in shown if p["file"]]}
    return {"size": list(quality.mask_size(bench)), "scenes": scenes}


# Sweeps and slopes --------------------------------------------------------------------------------


def costs_of(data: Data, scene: str) -> dict[str, float]:
    """By instructions, which are the same each time; by time where they were not counted."""
    methods = data["cost"]["scenes"][scene]["methods"]
    counted = {m: c["instructions"] for m, c in methods.items() if c["instructions"]}
    return counted or {m: c["ns"]["median"] for m, c in methods.items() if c["ns"]}


def cell(value: Data | None) -> Data | None:
    if value is None or value["shadow"] < sweep.LEAST_SHADOW:
        return None
    return {method: 100 * wrong / value["shadow"] for method, wrong in value["wrong"].items()}


def sweeps(bench: Bench, results: Results, data: Data) -> list[Data]:
    found = []
    for one in sweep.sweeps(bench):
        values = [[results.get(sweep.cell_job(bench, one, i, j).name) for i in range(len(one.xs))] for j in range(len(one.ys))]
        found.append({
            "id": f"{one.scene}-{one.id}", "scene": one.scene, "title": sweep.TITLES[one.id], "about": one.about(),
            "x": {"name": one.x, "label": sweep.AXES[one.x], "values": list(one.xs)},
            "y": {"name": one.y, "label": sweep.AXES[one.y], "values": list(one.ys)},
            "by_cost": sweep.by_cost(costs_of(data, one.scene), [m for m in sweep.methods(bench) if not m.endswith(" bare")]),
            "wrong": [[cell(value) for value in row] for row in values],
            "shadow_pixels": [[value and value["shadow"] for value in row] for row in values],
        })
    return found


def slopes(bench: Bench, results: Results) -> Data:
    found: Data = {}
    for scene in sweep.sloped(bench):
        values = [results.get(sweep.amplitude_job(bench, scene, slope).name) for slope in sweep.AMPLITUDES]
        error = {m: [value and value["error"][m] for value in values] for m in sweep.SLOPE_METHODS}
        found[scene.name] = {
            "amplitude": list(sweep.AMPLITUDES), "label": "amplitude, as the slope that 95 % are below", "error": error,
            "floor": FLOOR, "theory": sweep.THEORY[scene.name],
            "fit": {m: stats.fit_exponent(sweep.AMPLITUDES, error[m], FLOOR) for m in sweep.SLOPE_METHODS},
        }
    return found


# The whole ----------------------------------------------------------------------------------------


def answer(data: Data) -> list[str]:
    """What a reader should take away, in five lines."""
    cube = data["cost"]["scenes"].get("cube", {"methods": {}})["methods"]
    lines = []

    def added(method: str) -> str:
        interval = cube.get(method, {}).get("added")
        return f"{interval['median']:+.0f} %" if interval else "not measured"

    def wrong(scene: str, method: str) -> float | None:
        found = data["quality"]["scenes"].get(scene, {}).get(method, {})
        measure = found.get("mask") or found.get("exact")
        return measure and measure["wrong"]

    lines.append(f"Cost: over bump mapping alone, order 0 takes {added('0')} in figure 5's scene, 1 {added('1')}, "
                 f"2 {added('2')}, march:4 {added('march:4')}; the true hit for the shadow's origin {added('exact')}.")
    shares = {scene: (wrong(scene, "none"), wrong(scene, "0")) for scene in data["scenes"]}
    removed = [100 * (1 - after / before) for before, after in shares.values() if before and after is not None]
    if removed:
        lines.append(f"Quality: order 0 puts {min(removed):.0f} to {max(removed):.0f} % of the wrong shadow pixels right: "
                     + ", ".join(f"{scene} {a:.2g} to {b:.2g} %" for scene, (a, b) in shares.items() if a and b is not None)
                     + ".")
    best = {}
    for scene in data["scenes"]:
        ranked = [(value, m) for m in ("0", "1", "2", "2+") if (value := wrong(scene, m)) is not None]
        if ranked:
            best[scene] = min(ranked)[1]
    if best:
        lines.append("Orders: the fewest wrong pixels of 0, 1, 2 and 2+ has "
                     + ", ".join(f"{m} on {scene}" for scene, m in best.items())
                     + "; on steep samples a higher order is no better, and a few steps of march are.")
    lines.append(rule(data))
    lines.append("Direct intersection: displacing the surface truly takes "
                 + ", ".join(f"{times:.0f} times none on {scene}" for scene, times in displaced_times(data).items())
                 + "." if displaced_times(data) else "Direct intersection: not measured.")
    return lines


def displaced_times(data: Data) -> dict[str, float]:
    found = {}
    for scene, cost_of in data["cost"]["scenes"].items():
        none, own = (cost_of["methods"].get(m, {}).get("ns") for m in ("none", "displaced"))
        if none and own:
            found[scene] = own["median"] / none["median"]
    return found


def rule(data: Data, most: float = 1.0, least_view: float = 30) -> str:
    """The largest slope up to which a method is good enough at every height of the eye from least_view on."""
    for one in data["sweeps"]:
        if (one["x"]["name"], one["y"]["name"]) != ("slope", "view"):
            continue
        rows = [j for j, view in enumerate(one["y"]["values"]) if view >= least_view]
        texts = []
        for method in ("0", "2", "march:4"):
            reached = [tables.reach(one, row, method, most) for row in rows]
            if reached and None not in reached:
                texts.append(f"{method} up to slope {min(reached):g}")
        if texts:
            return (f"When: with the eye {least_view:g} degrees and more above the ground, at most {most:g} % of the shadow is wrong "
                    f"by {', '.join(texts)} ({one['scene']}).")
    return "When: not measured."


def summarise(bench: Bench, store: Store, jobs: Sequence[Any], failed: dict[str, str],
              judge: Callable[[Data], list[Any]]) -> Data:
    """`judge` makes the claims from the rest."""
    results = Results(store, jobs)
    failed = failed | why_left_out(bench, results)
    lines = incomplete(bench, failed)
    data: Data = {
        "schema": SCHEMA, "level": bench.level.name, "complete": not lines, "incomplete": lines,
        "circumstances": circumstances(bench), "methods": list(bench.level.methods),
        "scenes": {name: {"title": TITLES.get(name, name), "slope_median": f.slope_median, "slope_95": f.slope_95,
                          "receiver": f.receiver, "size": list(quality.mask_size(bench)),
                          "shadow_pixels": (results.get("quality", name, "none") or {}).get("mask_shadow")}
                   for name, f in bench.scenes.items()},
        "cost": costs(bench, results), "quality": quality_of(bench, results), "pictures": pictures(bench),
    }
    data["notes"] = notes(data)
    data["sweeps"] = sweeps(bench, results, data)
    data["slopes"] = slopes(bench, results)
    data["claims"] = judge(data)
    data["answer"] = answer(data)
    return data
