"""A report's files: a page, the same in Markdown, and tables for other programs.

    index.html      everything, in one file that needs no network (bench/page.py; needs Jinja2 and matplotlib)
    report.md       answer, tables and claims
    cost.csv        a line for each scene and method, and for each other program
    quality.csv     a line for each scene and method
    whole.csv       a line for each scene and variant
    series.csv      a line for each scene, variant, and height of the lamp or slope of the bumps
    own.csv         a line for each scene, height of the lamp, and way to find the own shadow
    sweeps.csv      a line for each sweep, cell and method
    slopes.csv      a line for each scene, method and amplitude

In the CSV files a cell is empty where nothing was measured; units are those of report.json: %, ns, pixels, bytes, scene
units.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from bench import data, tables, whole_tables
from bench.data import Report
from bench.tables import Cell, Table

Row = dict[str, object]


# CSV ----------------------------------------------------------------------------------------------------------


def flat(value: Mapping[str, object], prefix: str = "") -> Row:
    """Nested dicts as one, the keys joined by _."""
    row: Row = {}
    for key, inner in value.items():
        row |= flat(inner, f"{prefix}{key}_") if isinstance(inner, Mapping) else {f"{prefix}{key}": inner}
    return row


def cost_rows(report: Report) -> Iterator[Row]:
    for scene, methods in data.costs(report).items():
        for method, values in methods.items():
            yield {"scene": scene, "program": "kage", "method": method} | flat(values)
    for peer in data.peers(report):
        yield {"scene": peer["scene"], "program": peer["name"], "method": None} | flat(
            {key: value for key, value in peer.items() if key not in ("name", "scene")})


def quality_rows(report: Report) -> Iterator[Row]:
    for scene, methods in data.qualities(report).items():
        for method, values in methods.items():
            yield {"scene": scene, "method": method} | flat(values)


def whole_rows(report: Report) -> Iterator[Row]:
    for scene, variants in data.wholes(report).items():
        for variant, values in variants.items():
            yield {"scene": scene, "variant": variant} | flat(values)


def series_rows(report: Report) -> Iterator[Row]:
    part = data.whole_part(report)
    for over, found in (("light", part.get("lamps") or {}), ("slope", part.get("slopes") or {})):
        for scene, series in found.items():
            for variant, shares in series["off"].items():
                for value, share in zip(series["values"], shares, strict=True):
                    yield {"scene": scene, "over": over, "value": value, "variant": variant, "off": share}


def own_rows(report: Report) -> Iterator[Row]:
    for scene, found in (data.whole_part(report).get("own") or {}).items():
        for how, shares in found["wrong"].items():
            for height, pixels, share in zip(found["values"], found["shadow"], shares, strict=True):
                yield {"scene": scene, "light": height, "shadow_pixels": pixels, "how": how, "wrong": share}


def sweep_rows(report: Report) -> Iterator[Row]:
    for sweep in report.get("sweeps") or []:
        for j, y in enumerate(sweep["y"]["values"]):
            for i, x in enumerate(sweep["x"]["values"]):
                cell: Row = {"sweep": sweep["id"], "scene": sweep["scene"], "x_name": sweep["x"]["name"], "x": x,
                             "y_name": sweep["y"]["name"], "y": y, "shadow_pixels": sweep["shadow_pixels"][j][i]}
                wrong = sweep["wrong"][j][i] or {}
                for method in sweep["by_cost"]:
                    yield cell | {"method": method, "wrong": wrong.get(method)}


def slope_rows(report: Report) -> Iterator[Row]:
    for scene, slopes in (report.get("slopes") or {}).items():
        for method, errors in slopes["error"].items():
            for amplitude, error in zip(slopes["amplitude"], errors, strict=True):
                yield {"scene": scene, "method": method, "amplitude": amplitude, "error": error,
                       "fit": slopes["fit"].get(method), "theory": slopes["theory"].get(method),
                       "floor": slopes["floor"]}


def csv_text(rows: Iterator[Row]) -> str:
    """With a column for every key of any row; numbers in full."""
    found = list(rows)
    columns = list(dict.fromkeys(key for row in found for key in row))
    out = io.StringIO()
    writer = csv.DictWriter(out, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(found)
    return out.getvalue()


# Markdown -----------------------------------------------------------------------------------------------------


def md_escape(text: str) -> str:
    """As text in a line or a cell: no HTML, no new column, no new line. Text between backticks stays code."""
    parts = re.split(r"(`[^`]+`)", " ".join(text.split()))
    parts[::2] = (re.sub(r"([\\*_`])", r"\\\1", part).replace("&", "&amp;").replace("<", "&lt;") for part in parts[::2])
    return "".join(parts).replace("|", "\\|")


def md_cell(cell: Cell) -> str:
    note = f" ({cell.note})" if cell.note else ""
    return md_escape(f"{cell.text}{note} {cell.marks}".rstrip())


def md_table(table: Table) -> str:
    heads = [md_escape(f"{column.group}: {column.head}" if column.group else column.head) for column in table.columns]
    lines = [heads, ["---" if column.words else "---:" for column in table.columns]]
    lines += [[md_cell(cell) for cell in row] for row in table.rows]
    text = "\n".join(f"| {' | '.join(line)} |" for line in lines)
    return f"{text}\n\n{md_escape(table.about)}" if table.about else text


def md_claims(report: Report) -> Iterator[str]:
    yield "## The claims"
    for claim in report["claims"]:
        yield (f"**{md_escape(claim['verdict'])}**: {md_escape(claim['sentence'])} "
               f"({claim['who']}, {md_escape(claim['source'])})")
        yield f"Test: {md_escape(claim['test'])}"
        yield "\n".join(f"- {md_escape(case['case'])}: {md_escape(case['verdict'])}; {md_escape(case['detail'])}"
                        for case in claim["cases"])


def md_whole(report: Report) -> Iterator[str]:
    """Whole pictures, own shadows, and auto."""
    if data.wholes(report):
        yield "## The whole picture"
        yield md_table(whole_tables.whole_table(report))
    for scene in data.wholes(report):
        table = whole_tables.whole_scene_table(report, scene)
        yield f"### {md_escape(table.title)}"
        yield md_table(table)
        for table in whole_tables.series_tables(report, scene):
            yield f"### {md_escape(table.title)}: {scene}"
            yield md_table(table)
    if own := whole_tables.own_table(report):
        yield f"## {md_escape(own.title)}"
        yield md_table(own)
    if "auto" in report["methods"]:
        yield "## What auto costs and needs"
        yield md_escape(whole_tables.PARETO_ABOUT)
        for scene in report["scenes"]:
            table = whole_tables.pareto_table(report, scene)
            yield f"### {md_escape(table.title)}"
            yield md_table(table)
    if orders := whole_tables.order_table(report):
        yield f"### {md_escape(orders.title)}"
        yield md_table(orders)


def md_parts(report: Report) -> Iterator[str]:
    yield "# Shadows on bump-mapped surfaces: what each method costs, and how wrong it is"
    if report.get("incomplete"):
        yield "**Incomplete:**"
        yield md_list(report["incomplete"])
    if report.get("answer"):
        yield md_list(report["answer"])
    yield "## All methods"
    yield md_list([f"{scene}: {tables.scene_title(report, scene)}, against {tables.truth_name(report, scene)}"
                   for scene in report["scenes"]])
    yield md_table(tables.main_table(report))
    yield from md_whole(report)
    for sweep in report.get("sweeps") or []:
        yield f"## {md_escape(sweep['title'])}: {sweep['scene']}"
        yield md_escape(sweep["about"])
        yield f"Each method with its largest {md_escape(sweep['x']['label'])}, at most {tables.RULE_BOUND:g} % wrong:"
        yield md_list([f"{sweep['y']['label']} {y}: {rule}" for y, rule in tables.rules(sweep)])
    if report.get("claims"):
        yield from md_claims(report)
    for scene in data.qualities(report):
        yield f"## Quality: {md_escape(tables.scene_title(report, scene))}"
        for table in tables.quality_tables(report, scene):
            yield f"### {table.title}"
            yield md_table(table)
    if parity := tables.parity_table(report):
        yield f"## {parity.title}"
        yield md_table(parity)
    for scene in data.costs(report):
        yield f"## Cost: {md_escape(tables.scene_title(report, scene))}"
        yield md_table(tables.cost_table(report, scene))
        yield md_table(tables.stage_table(report, scene))
    if peers := tables.peer_table(report):
        yield f"## {peers.title}"
        yield md_table(peers)
    yield "## The machine and the programs"
    yield md_table(tables.circumstance_table(report))
    if report.get("notes"):
        yield md_list(report["notes"])


def md_list(lines: Sequence[str]) -> str:
    return "\n".join(f"- {md_escape(line)}" for line in lines)


# Writing ------------------------------------------------------------------------------------------------------


def write_all(folder: Path, texts: Mapping[str, str]) -> None:
    """All of them or none: an interruption leaves the old files whole, unless it comes while new ones are renamed."""
    aside = {folder / name: folder / f".{name}.new" for name in texts}
    try:
        for path, new in aside.items():
            new.write_text(texts[path.name], encoding="utf-8")
        for path, new in aside.items():
            new.replace(path)
    finally:
        for new in aside.values():
            new.unlink(missing_ok=True)


def write(report: Report, folder: Path) -> list[str]:
    """Write the report's files into the folder of its pictures. Returns a line for each thing that is left out."""
    texts = {
        "cost.csv": csv_text(cost_rows(report)),
        "quality.csv": csv_text(quality_rows(report)),
        "whole.csv": csv_text(whole_rows(report)),
        "series.csv": csv_text(series_rows(report)),
        "own.csv": csv_text(own_rows(report)),
        "sweeps.csv": csv_text(sweep_rows(report)),
        "slopes.csv": csv_text(slope_rows(report)),
        "report.md": "\n\n".join(part for part in md_parts(report) if part) + "\n",
    }
    try:
        from bench import page

        texts["index.html"], messages = page.render(report, folder)
    except ImportError:
        messages = ["Jinja2 is missing: index.html is left out (scripts/venv)"]
        (folder / "index.html").unlink(missing_ok=True)  # an old page would show another result
    folder.mkdir(parents=True, exist_ok=True)
    write_all(folder, texts)
    return messages
