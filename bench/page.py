"""A report as one HTML page that needs no other file: pictures, plots, style and script are inside.

Each picture is in it once, in the contact sheets; the slider's script takes them from there. Without scripts the page
lacks only the slider.
"""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from bench import claims, data, plots, tables, whole_tables
from bench.data import MethodPicture, Report, Sweep, dig
from bench.stats import Interval
from bench.tables import method_name

if TYPE_CHECKING:
    import jinja2
    from PIL import Image

TEMPLATES = Path(__file__).resolve().parent / "templates"
QUALITY = 95  # of WebP: no visible difference, a tenth of PNG's size

# The colour of each level of a `wrong` picture, over the grey picture: red, green, blue, opacity.
OVERLAY = (
    (255, 255, 255, 150),  # not counted: faded
    (0, 0, 0, 0),  # right and lit
    (0, 0, 0, 105),  # right and in shadow: darker
    (230, 159, 0, 255),  # wrongly lit: Okabe and Ito's orange
    (0, 114, 178, 255),  # wrongly in shadow: their blue
)

# The colour of each method that auto may need, by the level of its picture: one above the layer `order`.
ORDER_COLOURS: dict[int, tuple[str, tuple[int, int, int]]] = {
    0: ("not the receiver", (232, 232, 232)), 1: ("order 0", (0, 114, 178)), 2: ("order 1", (86, 180, 233)),
    3: ("order 2", (86, 180, 233)), 4: ("2+", (204, 121, 167)), 5: ("iter", (0, 158, 115)),
    6: ("march", (240, 228, 66)), 7: ("exact", (213, 94, 0)),
}

VERDICTS = {  # symbol, class in the style
    "holds": ("✓", "holds"), "holds in part": ("◐", "part"), "does not hold": ("✗", "fails"),
    "undecided": ("?", "open"), "not measured": ("–", "open"),
}


@dataclass(frozen=True)
class Picture:
    """One picture of a contact sheet. `over` shows its wrong pixels; the page draws that over it."""

    name: str
    alt: str
    uri: str
    size: tuple[int, int]
    over: str | None
    caption: str


@dataclass
class Sheet:
    """A scene's pictures: the truth, and what the methods make of it."""

    scene: str
    title: str
    references: list[Picture] = field(default_factory=list)
    methods: list[Picture] = field(default_factory=list)
    variants: list[Picture] = field(default_factory=list)  # with all shadows
    orders: Picture | None = None  # what auto needed


# Pictures -----------------------------------------------------------------------------------------------------


def data_uri(picture: Image.Image, **options: bool | int) -> str:
    """The picture as WebP; the options are Pillow's."""
    out = io.BytesIO()
    picture.save(out, format="WEBP", **options)
    return "data:image/webp;base64," + base64.b64encode(out.getvalue()).decode()


def embed_picture(path: Path) -> tuple[str, tuple[int, int]]:
    from PIL import Image

    with Image.open(path) as picture:
        return data_uri(picture.convert("RGB"), quality=QUALITY, method=4, use_sharp_yuv=True), picture.size


def embed_levels(path: Path, colours: Mapping[int, tuple[int, ...]]) -> tuple[str, tuple[int, int]]:
    """The levels as colours, with opacity or without. Lossless, as each pixel counts."""
    import numpy as np
    from PIL import Image

    table = np.zeros((256, len(next(iter(colours.values())))), np.uint8)
    for level, colour in colours.items():
        table[level] = colour
    with Image.open(path) as levels:
        return data_uri(Image.fromarray(table[np.asarray(levels.convert("L"))]), lossless=True, exact=True), levels.size


def embed_wrong(path: Path) -> str:
    return embed_levels(path, dict(enumerate(OVERLAY)))[0]


def embed_orders(path: Path) -> tuple[str, tuple[int, int]]:
    return embed_levels(path, {level: colour for level, (_, colour) in ORDER_COLOURS.items()})


def time_over(value: Interval | None, form: str, unit: str, same: float) -> str | None:
    return value and claims.measured_span(value, form, unit, same)


def method_caption(report: Report, scene: str, method: str) -> str:
    """The method's wrong pixels and added time, where they are known."""
    wrong = tables.wrong_pixels(report, scene, method)
    added = time_over(tables.added_cost(report, scene, method), "+.0f", "%", 0.0)
    parts = [f"{tables.share(wrong)} % wrong"] if wrong is not None else []
    parts += [f"time {added}"] if added is not None else []
    return ", ".join(parts).replace(" %", "\N{NO-BREAK SPACE}%")


def variant_caption(report: Report, scene: str, variant: str) -> str:
    """What is off, and the cost, where they are known."""
    off = whole_tables.off(report, scene, variant)
    cost = time_over(data.times_none(data.cost(report, scene, variant)), ".1f", "times", 1.0)
    parts = [f"{tables.share(off)} % off"] if off is not None else []
    parts += [f"time {cost}"] if cost is not None else []
    return ", ".join(parts).replace(" %", "\N{NO-BREAK SPACE}%")


def all_shadows(variant: str) -> str:
    return f"{method_name(variant)}, all shadows"


Embedded = TypeVar("Embedded")


def make_sheets(report: Report, folder: Path, missing: Callable[[str], None]) -> list[Sheet]:
    """A sheet for each scene. `missing` gets a line for each picture that can't be read."""

    def read(embed: Callable[[Path], Embedded], name: str | None) -> Embedded | None:
        if name is None:
            return None
        try:
            return embed(folder / name)
        except OSError as error:
            missing(f"a picture is left out: {name}: {error.strerror or error}")
            return None

    def shown(sheet: Sheet, name: str, files: MethodPicture, caption: str) -> list[Picture]:
        found = read(embed_picture, files["file"])
        if found is None:
            return []
        return [Picture(name, f"{sheet.title}: {name}", *found, read(embed_wrong, files["wrong"]), caption)]

    sheets = []
    for scene, entry in report["pictures"]["scenes"].items():
        sheet = Sheet(scene, tables.scene_title(report, scene))
        for reference in entry["references"]:
            if found := read(embed_picture, reference["file"]):
                name = reference["name"]
                sheet.references.append(Picture(name, f"{sheet.title}: {name}", *found, None, "reference"))
        for method, files in tables.in_order(report, entry["methods"]).items():
            sheet.methods += shown(sheet, method_name(method), files, method_caption(report, scene, method))
        for variant, files in (entry.get("variants") or {}).items():
            sheet.variants += shown(sheet, all_shadows(variant), files, variant_caption(report, scene, variant))
        if found := read(embed_orders, entry.get("orders")):
            sheet.orders = Picture("what auto needed", f"{sheet.title}: what auto needed", *found, None, "")
        if sheet.references or sheet.methods:
            sheets.append(sheet)
    return sheets


# Plots --------------------------------------------------------------------------------------------------------


@dataclass
class Plots:
    """SVG texts, by scene; maps by sweep, with their bounds. Empty where matplotlib is missing."""

    cost_error: dict[str, str] = field(default_factory=dict)
    stages: dict[str, str] = field(default_factory=dict)
    maps: dict[str, list[tuple[float, str]]] = field(default_factory=dict)
    slopes: dict[str, str] = field(default_factory=dict)


def make_plots(report: Report) -> Plots:
    found = Plots()
    for scene in report["scenes"]:
        if plot := plots.cost_error(report, scene):
            found.cost_error[scene] = plot
        if plot := plots.stage_bars(report, scene):
            found.stages[scene] = plot
    for sweep in report.get("sweeps") or []:
        found.maps[sweep["id"]] = [(bound, plots.sweep_map(sweep, bound)) for bound in tables.BOUNDS]
    for scene in report.get("slopes") or {}:
        if plot := plots.error_slopes(report, scene):
            found.slopes[scene] = plot
    return found


def map_legend(sweep: Sweep) -> list[tuple[str, str, str]]:
    """The colour, sign and meaning of each kind of cell in a sweep's maps."""
    cells = [cell for row in sweep["wrong"] for cell in row if cell is not None]
    used = {tables.cheapest(cell, sweep["by_cost"], bound) for cell in cells for bound in tables.BOUNDS}
    legend = [(plots.cell_colour(m), data.label(m), tables.method_about(m)) for m in sweep["by_cost"] if m in used]
    if None in used:
        legend.append((plots.cell_colour(None), "×", "none of these is good enough"))
    return legend


def order_legend(report: Report) -> list[tuple[str, str]]:
    """The colour and name of what auto needed anywhere, and of what it does not see."""
    needed = {name for found in (data.whole_part(report).get("orders") or {}).values() for name in found}
    return [(f"rgb{colour}", text) for level, (text, colour) in ORDER_COLOURS.items()
            if level == 0 or text.removeprefix("order ") in needed]


# The page -----------------------------------------------------------------------------------------------------


def sections(report: Report, sheets: list[Sheet]) -> list[tuple[str, str]]:
    """Ids and titles of the parts that have something to show."""
    parts: tuple[tuple[str, str, object], ...] = (
        ("answer", "The answer", report.get("answer")),
        ("bounds", "The bounds", [c for c in report.get("claims") or [] if c["who"] == "bound"]),
        ("whole", "The whole picture", data.wholes(report)),
        ("own", "The bumps' own shadows", whole_tables.own_table(report)),
        ("table", "All methods", True),
        ("cost-error", "Cost against error", True),
        ("auto", "What auto costs and needs", "auto" in report["methods"]),
        ("sheets", "Contact sheets", sheets),
        ("sweeps", "Where which method is enough", report.get("sweeps")),
        ("slopes", "How fast the error shrinks", report.get("slopes")),
        ("claims", "The claims", report.get("claims")),
        ("quality", "Quality in detail", data.qualities(report)),
        ("cost", "Cost in detail", data.costs(report)),
        ("measured", "How it was measured", True),
    )
    return [(name, title) for name, title, there in parts if there]


def code(text: str) -> str:
    """As HTML, with text between backticks as code."""
    from markupsafe import Markup, escape

    return Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", str(escape(text))))  # noqa: S704 - escaped just here


def templates() -> jinja2.Environment:
    """What pages are made from, the report's and others. Without Jinja2: an ImportError."""
    import jinja2

    return jinja2.Environment(loader=jinja2.FileSystemLoader(TEMPLATES), autoescape=True,
                              undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)


def render(report: Report, folder: Path) -> tuple[str, list[str]]:
    """The page, and a line for each thing that is left out of it. Without Jinja2: an ImportError."""
    environment = templates()
    messages: list[str] = []
    try:
        sheets = make_sheets(report, folder, messages.append)
    except ImportError:
        sheets = []
        messages.append("Pillow is missing: the page has no pictures (scripts/venv)")
    try:
        drawn = make_plots(report)
    except ImportError:
        drawn = Plots()
        messages.append("matplotlib is missing: the page has no plots (scripts/venv)")
    environment.filters["code"] = code
    environment.globals.update(tables=tables, whole_tables=whole_tables, dig=dig, verdicts=VERDICTS,
                               map_legend=map_legend, order_legend=order_legend)
    page = environment.get_template("index.html").render(
        report=report, sheets=sheets, plots=drawn, sections=sections(report, sheets),
        incomplete=[*(report.get("incomplete") or []), *messages])
    return page, messages
