"""A report as one HTML page that needs no other file: pictures, plots, style and script are inside.

Each picture is in it once, in the contact sheets; the slider's script takes them from there. Without scripts the page
lacks only the slider.
"""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from bench import data, plots, tables
from bench.data import Report, Sweep, dig
from bench.tables import method_name

if TYPE_CHECKING:
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


def embed_wrong(path: Path) -> str:
    """The levels as colours. Lossless, as each pixel counts."""
    import numpy as np
    from PIL import Image

    colours = np.zeros((256, 4), np.uint8)
    colours[:len(OVERLAY)] = OVERLAY
    with Image.open(path) as levels:
        return data_uri(Image.fromarray(colours[np.asarray(levels.convert("L"))]), lossless=True, exact=True)


def method_caption(report: Report, scene: str, method: str) -> str:
    """The method's wrong pixels and added time, where they are known."""
    wrong = tables.wrong_pixels(report, scene, method)
    added = data.median(tables.added_cost(report, scene, method))
    parts = [f"{tables.share(wrong)} % wrong"] if wrong is not None else []
    parts += [f"{tables.added(added)} % time"] if added is not None else []
    return ", ".join(parts).replace(" %", "\N{NO-BREAK SPACE}%")


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

    sheets = []
    for scene, entry in report["pictures"]["scenes"].items():
        sheet = Sheet(scene, tables.scene_title(report, scene))
        for reference in entry["references"]:
            if found := read(embed_picture, reference["file"]):
                name = reference["name"]
                sheet.references.append(Picture(name, f"{sheet.title}: {name}", *found, None, "reference"))
        for method, files in tables.in_order(report, entry["methods"]).items():
            if found := read(embed_picture, files["file"]):
                name, over = method_name(method), read(embed_wrong, files["wrong"])
                sheet.methods.append(Picture(name, f"{sheet.title}: {name}", *found, over,
                                             method_caption(report, scene, method)))
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
    legend = [(plots.cell_colour(m), m, tables.method_about(m)) for m in sweep["by_cost"] if m in used]
    if None in used:
        legend.append((plots.cell_colour(None), "×", "none of these is good enough"))
    return legend


# The page -----------------------------------------------------------------------------------------------------


def sections(report: Report, sheets: list[Sheet]) -> list[tuple[str, str]]:
    """Ids and titles of the parts that have something to show."""
    parts: tuple[tuple[str, str, object], ...] = (
        ("answer", "The answer", report.get("answer")),
        ("table", "All methods", True),
        ("cost-error", "Cost against error", True),
        ("compare", "Compare two pictures", sheets),
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


def render(report: Report, folder: Path) -> tuple[str, list[str]]:
    """The page, and a line for each thing that is left out of it. Without Jinja2: an ImportError."""
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
