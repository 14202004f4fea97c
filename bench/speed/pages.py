"""The report: tables as Markdown, HTML and text for a terminal, and the bounds in docs/performance.md."""

from __future__ import annotations

import html
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from bench.data import BUMP_ONLY
from bench.readme import generated, table
from bench.speed.plan import GIB, PARTS
from bench.speed.rounds import Job, Results
from bench.speed.stages import Scene
from bench.speed.verdicts import UNMEASURED, Judged
from bench.stats import Interval

DOCS = "docs/performance.md"
REGION = "speed"  # <!-- bench:speed --> in that file
BYTES = 2.0**20


@dataclass(frozen=True)
class Table:
    """A table with its title and a sentence below it."""

    title: str
    head: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]
    note: str = ""


def number(value: float) -> str:
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"


# What each figure is called, its unit, and what its values are divided by.
FIGURES: dict[str, tuple[str, str, float]] = {
    "ns": ("trace", "ns a pixel", 1), "memory": ("memory, at most", "MiB", BYTES), "seconds": ("whole", "s", 1),
    "whole_s": ("whole process", "s", 1), "build_s": ("build", "s", 1), "output_s": ("writing", "s", 1),
    "file_bytes": ("file", "MiB", BYTES), "pixel_bytes": ("file", "bytes a pixel", 1),
    "read_bytes": ("read", "MiB", BYTES), "written_bytes": ("written", "MiB", BYTES),
    "ready_s": ("ready", "s", 1), "bump_ms": ("look-ups", "ms", 1), "render_ms": ("trace", "ms", 1),
    "sample_bytes": ("memory", "bytes a sample", 1), "s": ("decoded", "s", 1), "ms": ("whole process", "ms", 1),
    "cpu_ms": ("processor time", "ms", 1),
    "pixel_ns": ("whole process", "ns a pixel", 1),
}


def scaled(found: Interval, by: float) -> str:
    middle, low, high = (number(found[end] / by) for end in ("median", "low", "high"))
    return middle if low == high else f"{middle} ({low} to {high})"


def in_unit(judged: Judged) -> tuple[str, str]:
    """The figure, and the bound."""
    bound, found = judged.bound, judged.found
    by, unit = (GIB, "GiB") if bound.unit == "bytes" else (1.0, bound.unit)
    word = "at least" if bound.at_least else "at most"
    return scaled(found, by) if found else "–", f"{word} {bound.limit / by:g} {unit}"


def bounds_table(judged: Sequence[Judged]) -> Table:
    rows = [(f"{one.bound.part}: {one.bound.what}", *in_unit(one), one.verdict) for one in judged]
    return Table("Bounds", ("bound", "figure", "demanded", "verdict"), rows,
                 "Medians, with bootstrap 95 % intervals; met or missed where the whole interval says so.")


# A peer, what of kage is nearest to it, and the figure that both have.
PEERS = (
    ("POV-Ray bump_map", "kage 0, whole", "ns"), ("POV-Ray bump_map", "kage 0, whole", "whole_s"),
    ("POV-Ray smooth", "kage none, whole", "ns"), ("POV-Ray smooth", "kage none, whole", "whole_s"),
    ("POV-Ray height_field", "kage displaced, whole", "ns"),
    ("POV-Ray height_field", "kage displaced, whole", "whole_s"),
    ("Tachyon, smooth", "kage none, whole", "ns"), ("Embree, plane", "kage none, whole", "ns"),
    ("Embree, displaced mesh", "kage displaced, whole", "ns"), ("embree mesh", "mesh", "ns"),
)


def shown(name: str) -> str:
    """A measurement's name, as a reader should see it."""
    return name.replace("kage none", f"kage {BUMP_ONLY}")


def peers_table(results: Results) -> Table:
    """In times kage's time, round by round; those that were not measured are left out."""
    rows = []
    for peer, own, figure in PEERS:
        found = results.ratio(f"{peer}: {figure}", f"{own}: {figure}")
        if found:
            rows.append((peer, FIGURES[figure][0], shown(own).removesuffix(", whole"), scaled(found, 1)))
    return Table("Peers", ("peer", "what", "kage's", "times kage's time"), rows)


def figure_table(part: str, jobs: Sequence[Job], results: Results) -> Table:
    rows = []
    for job in jobs:
        for key, values in results.values.items():
            name, _, figure = key.rpartition(": ")
            found = results.interval(key)
            if name == job.name and found:
                what, unit, by = FIGURES.get(figure, (figure, "ns a pixel", 1))
                rows.append((shown(job.name), what, scaled(found, by), unit, str(len(values))))
    return Table(part, ("", "what", "median (interval)", "unit", "rounds"), rows)


def stage_table(scene: Scene) -> Table:
    named = f"share of {scene.event}" if scene.event else "share"
    rows = [(row.stage, number(row.instructions), number(row.accesses), f"{row.first_misses:.3f}",
             f"{row.last_misses:.4f}", "–" if row.share is None else f"{100 * row.share:.1f} %") for row in scene.rows]
    return Table(f"Stages: {scene.name}", ("stage, or library", "instructions a pixel", "reads and writes",
                                           "misses of the first cache", "of the last", named), rows,
                 "Counts by callgrind, of the render alone. Shares by perf, of a run at full size"
                 f"{'; this machine counts no cycles' if scene.event == 'cpu-clock' else ''}." if scene.event else
                 "Counts by callgrind, of the render alone. perf is missing, or may not sample here.")


def tables(judged: Sequence[Judged], jobs: Sequence[Job], results: Results, scenes: Sequence[Scene]) -> list[Table]:
    found = [one for one in (bounds_table(judged), peers_table(results)) if one.rows]
    for part in PARTS:
        mine = [job for job in jobs if job.part == part]
        if mine:
            found.append(figure_table(part, mine, results))
    return found + [stage_table(scene) for scene in scenes]


def markdown(title: str, about: str, found: Sequence[Table]) -> str:
    parts = [f"# {title}\n\n{about}\n"]
    for one in found:
        parts.append(f"## {one.title}\n\n{table(one.head, one.rows)}\n" + (f"\n{one.note}\n" if one.note else ""))
    return "\n".join(parts)


STYLE = "body{font:15px/1.5 sans-serif;max-width:75em;margin:2em auto;padding:0 1em}table{border-collapse:collapse}" \
        "td,th{padding:.1em .8em;text-align:right;border-bottom:1px solid #8884}td:first-child,th:first-child" \
        "{text-align:left}.met{color:#080}.missed{color:#c00}@media(prefers-color-scheme:dark){" \
        "body{background:#181818;color:#ddd}.met{color:#6c6}.missed{color:#f77}}"


def cell(tag: str, text: str) -> str:
    kind = f' class="{text}"' if text in ("met", "missed") else ""
    return f"<{tag}{kind}>{html.escape(text)}</{tag}>"


def page(title: str, about: str, found: Sequence[Table]) -> str:
    """One HTML file that needs no other."""
    parts = [f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{html.escape(title)}</title>'
             f"<style>{STYLE}</style><h1>{html.escape(title)}</h1><p>{html.escape(about)}</p>"]
    for one in found:
        lines = ["".join(cell("th", word) for word in one.head)]
        lines += ["".join(cell("td", word) for word in row) for row in one.rows]
        parts.append(f"<h2>{html.escape(one.title)}</h2><table>" + "".join(f"<tr>{line}</tr>" for line in lines)
                     + f"</table><p>{html.escape(one.note)}</p>")
    return "\n".join(parts) + "\n"


def columns(one: Table) -> Iterator[str]:
    """For a terminal."""
    lines = [one.head, *one.rows]
    widths = [max(len(line[k]) for line in lines) for k in range(len(one.head))]
    for line in lines:
        yield "  ".join(f"{word:{width}}" for word, width in zip(line, widths, strict=True)).rstrip()


def docs(text: str, about: str, judged: Sequence[Judged]) -> str:
    """docs/performance.md with the bounds of this run; those that were not measured are left as they are said."""
    one = bounds_table(judged)
    return generated(text, REGION, f"{about}\n\n{table(one.head, one.rows)}\n\n{one.note}")


def unmeasured(judged: Sequence[Judged]) -> list[str]:
    return [f"{one.bound.part}: {one.bound.what}" for one in judged if one.verdict == UNMEASURED]
