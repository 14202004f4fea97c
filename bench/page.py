"""A report as one HTML page that needs nothing beside it: pictures, plots, style and script are inside.

Each picture is in it once, in the contact sheets; the script of the slider takes them from there. Without a script
there is all but the slider.
"""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from bench import plots, tables
from bench.tables import Report, dig, method_name

if TYPE_CHECKING:
    from PIL import Image

TEMPLATES = Path(__file__).resolve().parent / "templates"
QUALITY = 95  # of WebP: no difference to be seen, a tenth of PNG's size

# What the levels of a `wrong` picture are laid over the grey picture as: red, green, blue, opacity.
OVERLAY = (
    (255, 255, 255, 150),  # not counted: faded
    (0, 0, 0, 0),  # right and lit
    (0, 0, 0, 105),  # right and in shadow: darker
    (230, 159, 0, 255),  # wrongly lit: Okabe and Ito's orange
    (0, 114, 178, 255),  # wrongly in shadow: their blue
)

VERDICTS = {  # symbol, class in the style
    "holds": ("✓", "holds"), "holds in part": ("◐", "part"), "does not hold": ("✗", "fails"),
    "undecided": ("?", "open"), "not measured": ("–", "open"),
}


@dataclass(frozen=True)
class Picture:
    """One picture of a contact sheet. `over` are its wrong pixels, to be laid over it."""

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


# Pictures -----------------------------------------------------------------------------------------------------


def data_uri(picture: Image.Image, **how: object) -> str:
    out = io.BytesIO()
    picture.save(out, format="WEBP", **how)
    return "data:image/webp;base64," + base64.b64encode(out.getvalue()).decode()


def embed_picture(path: Path) -> tuple[str, tuple[int, int]]:
    from PIL import Image

    with Image.open(path) as picture:
        return data_uri(picture.convert("RGB"), quality=QUALITY, method=4, use_sharp_yuv=True), picture.size


def embed_wrong(path: Path) -> str:
    """The levels as colours. Lossless, as the pixels are what it is about."""
    import numpy as np
    from PIL import Image

    colours = np.zeros((256, 4), np.uint8)
    colours[:len(OVERLAY)] = OVERLAY
    with Image.open(path) as levels:
        return data_uri(Image.fromarray(colours[np.asarray(levels.convert("L"))]), lossless=True, exact=True)


def method_caption(report: Report, scene: str, method: str) -> str:
    wrong = tables.wrong_pixels(report, scene, method)
    cost = dig(tables.added_cost(report, scene, method), "median")
    parts = [f"{tables.share(wrong)} % wrong"] * (wrong is not None)
    parts += [f"{tables.added(cost)} % time"] * (cost is not None)
    return ", ".join(parts).replace(" %", "\N{NO-BREAK SPACE}%")


def make_sheets(report: Report, folder: Path, missing: Callable[[str], None]) -> list[Sheet]:
    """A sheet for each scene. `missing` is told of what can't be read."""

    def read(embed: Callable, name: str | None) -> object:
        if name is None:
            return None
        try:
            return embed(folder / name)
        except OSError as error:
            missing(f"a picture is left out: {name}: {error.strerror or error}")
            return None

    sheets = []
    for scene, entry in (dig(report, "pictures", "scenes") or {}).items():
        sheet = Sheet(scene, tables.scene_title(report, scene))
        for reference in entry.get("references") or []:
            if found := read(embed_picture, reference["file"]):
                name = reference["name"]
                sheet.references.append(Picture(name, f"{sheet.title}: {name}", *found, None, "reference"))
        for method in report["methods"]:
            files = dig(entry, "methods", method)
            if files and (found := read(embed_picture, files["file"])):
                name, over = method_name(method), read(embed_wrong, files.get("wrong"))
                sheet.methods.append(Picture(name, f"{sheet.title}: {name}", *found, over,
                                             method_caption(report, scene, method)))
        if sheet.references or sheet.methods:
            sheets.append(sheet)
    return sheets


# Plots --------------------------------------------------------------------------------------------------------


@dataclass
class Plots:
    """SVG by scene, or by sweep; empty where matplotlib is missing."""

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


def map_legend(sweep: dict) -> list[tuple[str, str, str]]:
    """Colour, sign and meaning of what is in a sweep's maps."""
    cells = [cell for row in sweep["wrong"] for cell in row if cell is not None]
    used = {tables.cheapest(cell, sweep["by_cost"], bound) for cell in cells for bound in tables.BOUNDS}
    legend = [(plots.cell_colour(m), m, tables.method_about(m)) for m in sweep["by_cost"] if m in used]
    if None in used:
        legend.append((plots.cell_colour(None), "×", "none of these is good enough"))
    return legend


# The page -----------------------------------------------------------------------------------------------------


def sections(report: Report, sheets: list[Sheet]) -> list[tuple[str, str]]:
    """Ids and titles of the parts that there is something to show of."""
    return [(name, title) for name, title, there in (
        ("answer", "The answer", report.get("answer")),
        ("table", "All methods", True),
        ("cost-error", "Cost against error", True),
        ("compare", "Compare two pictures", sheets),
        ("sheets", "Contact sheets", sheets),
        ("sweeps", "Where which method is enough", report.get("sweeps")),
        ("slopes", "How fast the error shrinks", report.get("slopes")),
        ("claims", "The claims", report.get("claims")),
        ("quality", "Quality in detail", dig(report, "quality", "scenes")),
        ("cost", "Cost in detail", dig(report, "cost", "scenes")),
        ("measured", "How it was measured", True),
    ) if there]


def code(text: str) -> str:
    """As HTML, with what stands between backticks as code."""
    from markupsafe import Markup, escape

    return Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", str(escape(text))))


def render(report: Report, folder: Path) -> tuple[str, list[str]]:
    """The page, and a line for each thing that had to be left out of it. Without Jinja2: an ImportError."""
    import jinja2

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
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(TEMPLATES), autoescape=True,
                                     undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters["code"] = code
    environment.globals.update(tables=tables, dig=dig, verdicts=VERDICTS, map_legend=map_legend)
    page = environment.get_template("index.html").render(
        report=report, sheets=sheets, plots=drawn, sections=sections(report, sheets),
        incomplete=[*(report.get("incomplete") or []), *messages])
    return page, messages
