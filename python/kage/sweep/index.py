"""What a sweep leaves beside the pictures: index.csv and index.json for programs, index.html for people."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jinja2

from kage.sweep import records
from kage.sweep.axes import short
from kage.sweep.inputs import VERSION
from kage.sweep.plan import Picture, Plan

if TYPE_CHECKING:
    from kage.sweep.run import Done

#: Counts of kage.Picture.stats that have a column.
COUNTS = ("camera_rays", "shadow_rays", "secondary_rays", "height_lookups", "bumped", "fell_back", "unconfirmed")


def write(plan: Plan, done: Done) -> None:
    """Of the pictures that are there. The files are replaced whole."""
    rows = [row(picture, done) for picture in plan.pictures]
    records.replace(done.folder / "index.csv", table([one for one in rows if one["done"]], plan).encode())
    about = {"scene": plan.inputs.name, "version": VERSION, "inputs": plan.inputs.digest,
             "axes": [asdict(axis) for axis in plan.axes], "pictures": rows}
    records.replace(done.folder / "index.json", (json.dumps(about, indent=1) + "\n").encode())
    records.replace(done.folder / "index.html", page(plan, rows).encode())


def row(picture: Picture, done: Done) -> dict[str, Any]:
    record = done.records.get(picture.whole.file)
    found: dict[str, Any] = {"file": picture.whole.file, "values": dict(picture.whole.values),
                             "sets": dict(picture.whole.sets), "done": record is not None}
    if record:
        found |= {"seconds": record.seconds, "stats": record.stats, "bytes": record.size, "sha256": record.digest}
    return found


def table(rows: list[dict[str, Any]], plan: Plan) -> str:
    """A line for each picture that is done."""
    paths = [axis.path for axis in plan.axes]
    to = io.StringIO()
    writer = csv.writer(to, lineterminator="\n")
    writer.writerow(["file", *paths, "seconds", *COUNTS, "bytes", "sha256"])
    for one in rows:
        writer.writerow([one["file"], *(one["values"][path] for path in paths), one["seconds"],
                         *(one["stats"][name] for name in COUNTS), one["bytes"], one["sha256"]])
    return to.getvalue()


def page(plan: Plan, rows: list[dict[str, Any]]) -> str:
    """A contact sheet: the last axis from left to right, the one before it down, a table for each of the others."""
    columns = plan.axes[-1] if plan.axes else None
    lines = plan.axes[-2] if len(plan.axes) > 1 else None
    width = len(columns.values) if columns else 1
    height = len(lines.values) if lines else 1
    strips = [rows[k : k + width] for k in range(0, len(rows), width)]
    sheets = [strips[k : k + height] for k in range(0, len(strips), height)]
    template = Path(__file__).with_name("index.html.jinja").read_text(encoding="utf-8")
    made = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    made.filters["short"] = short
    return made.from_string(template).render(
        scene=plan.inputs.name, version=VERSION, columns=columns, lines=lines, others=plan.axes[:-2], sheets=sheets,
        shown=plan.output.kind == "png", done=sum(one["done"] for one in rows), count=len(rows),
    )
