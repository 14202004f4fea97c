"""A report's plots, as SVG inside the page.

The same data give the same bytes: no date, and ids from a fixed salt. Text stays text, in the page's own font. Its
place is computed for DejaVu Sans, which is wider than most fonts, so text that has room here has room on the page.
Colours are names of the page's CSS (`var(--orders)`), the ink is `currentColor`: one plot serves the dark page and the
light one.

Units are points of 1/72 inch, which are the SVG's user units too.
"""

from __future__ import annotations

import functools
import io
import itertools
import math
import re
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ParamSpec, TypedDict, TypeVar

import numpy as np

from bench import data, images, tables
from bench.data import Report, Slopes, Sweep
from bench.tables import MISSING, cheapest, method_name

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.patches import Rectangle
    from matplotlib.ticker import Locator

# Okabe and Ito's colours, and their names in the page's CSS. Ink and page are colours that nothing else has, so that
# they can be found and replaced.
INK, PAGE = "#0a0b0c", "#fdfeff"
NAMED = {INK: "currentColor", PAGE: "var(--page)"}
BLUE, GREEN, VERMILLION, PURPLE, GREY = "#0072b2", "#009e73", "#d55e00", "#cc79a7", "#999999"
GOLD = "#8f7200"
FAMILIES = {  # colour, marker, the colour's name in CSS
    "none": (INK, "o", ""), "orders": (BLUE, "s", "--orders"), "2+": (PURPLE, "D", "--full"),
    "iter": (GREEN, "^", "--iter"), "march": (VERMILLION, "v", "--march"), "auto": (GOLD, "P", "--auto"),
    "true": (INK, "*", ""),
}
NAMED |= {colour: f"var({name})" for colour, _, name in FAMILIES.values() if name}

CELLS = {  # of the sweeps' maps, the same on the dark page and the light one: the text in them says the same
    "none": "#e4e4e4", "0": "#b9dff5", "1": "#6fbdea", "1 bare": "#a3bccb", "2": "#2b86bd", "2 bare": "#7596ab",
    "2+": "#dba3c3", "iter:2": "#9fdcc8", "iter:4": "#2fae8a", "march:2": "#fbdc94", "march:4": "#eeac2b",
    "march:8": "#de7a2a", "auto": "#cfe07a", "auto:1": "#e3edb0", "exact": "#f0e442", "displaced": "#c2b280",
}
CELL_FAMILY = {"iter": "#2fae8a", "march": "#de7a2a", "auto": "#cfe07a"}
CELL_NONE_GOOD = "#4a4a4a"
CELL_DARK, CELL_LIGHT = "#010203", "#fafbfc"  # text in a cell

# Of the stages' bars, the same on both pages too. Each differs by one from the colours above, which the page's CSS may
# change.
STAGES = ("#c8c8c8", "#e69f01", "#f0e443", "#8c6d46", "#56b4ea", "#cc79a8", "#d55e01", "#0072b3", "#009e74", "#6b6b6b",
          "#8b5fbf")

SETTINGS: dict[Any, object] = {  # the keys are matplotlib's
    "svg.fonttype": "none", "svg.hashsalt": "kage", "font.family": "DejaVu Sans", "font.size": 9.5, "text.color": INK,
    "axes.edgecolor": INK, "axes.labelcolor": INK, "xtick.color": INK, "ytick.color": INK, "axes.spines.top": False,
    "axes.spines.right": False, "axes.linewidth": 0.7, "xtick.major.width": 0.7, "ytick.major.width": 0.7,
    "grid.color": INK, "grid.alpha": 0.13, "grid.linewidth": 0.6, "axes.axisbelow": True,
    "hatch.color": INK, "hatch.linewidth": 0.5,
    "figure.facecolor": "none", "axes.facecolor": "none", "savefig.facecolor": "none", "legend.frameon": False,
}
SCALES = (0.85, 1.4)  # pixels a point, least and most; a narrower page scrolls a plot in its frame
FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', 'Noto Sans', 'DejaVu Sans', sans-serif"


def family(method: str) -> str:
    if method in ("none", "2+"):
        return method
    if method in tables.TRUE:
        return "true"
    return "orders" if method[:1].isdigit() else method.partition(":")[0]


def look(method: str) -> tuple[str, str, bool]:
    """Colour, marker, and whether it is filled: bare orders and `displaced` are not."""
    colour, marker, _ = FAMILIES.get(family(method), (GREY, "o", ""))
    return colour, marker, not (method.endswith(" bare") or method == "displaced")


def cell_name(method: str) -> str:
    """As short as a cell of a map needs it: the other name of `none`."""
    return "bump" if method == "none" else method


def cell_colour(method: str | None) -> str:
    if method is None:
        return CELL_NONE_GOOD
    return CELLS.get(method) or CELL_FAMILY.get(family(method), GREY)


# From matplotlib to the page ----------------------------------------------------------------------------------


Arguments = ParamSpec("Arguments")
Drawn = TypeVar("Drawn")


def styled(plot: Callable[Arguments, Drawn]) -> Callable[Arguments, Drawn]:
    """Draw with the settings above and matplotlib's own defaults, whatever the user's are."""

    @functools.wraps(plot)
    def draw(*arguments: Arguments.args, **named: Arguments.kwargs) -> Drawn:
        import matplotlib

        with matplotlib.rc_context():
            matplotlib.rcdefaults()
            matplotlib.rcParams.update(SETTINGS)
            return plot(*arguments, **named)

    return draw


def new_figure(width: float, height: float) -> tuple[Figure, Axes]:
    """A figure of that many points with one pair of axes, which the caller lays out."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width / 72, height / 72), dpi=72)
    FigureCanvasAgg(figure)  # measures text
    return figure, figure.add_subplot()


def place(figure: Figure, axes: Axes, left: float, bottom: float, right: float, top: float) -> None:
    """Leave these margins, in points."""
    width, height = figure.get_size_inches() * 72
    axes.set_position((left / width, bottom / height, (width - left - right) / width, (height - bottom - top) / height))


def svg(figure: Figure, key: str, label: str) -> str:
    """The figure as an HTML element. `key` makes its ids differ from those of the page's other plots."""
    out = io.StringIO()
    figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    text = out.getvalue()
    text = text[text.index("<svg"):]
    text = re.sub(r"<metadata>.*?</metadata>|<style type=.text/css.>.*?</style>|<!--.*?-->", "", text, flags=re.DOTALL)
    used = set(re.findall(r"href=\"#([^\"]+)\"|url\(#([^)]+)\)", text))
    kept = {name for pair in used for name in pair if name}
    text = re.sub(r" id=\"([^\"]+)\"", lambda m: f' id="{key}-{m[1]}"' if m[1] in kept else "", text)
    text = re.sub(r"xlink:href=\"#|href=\"#", f'href="#{key}-', text)
    text = text.replace("url(#", f"url(#{key}-")
    text = re.sub(r"(font: [^;\"]*?)'DejaVu Sans'", lambda m: m[1] + FONT, text)
    for colour, name in NAMED.items():
        text = text.replace(colour, name)
    (box,) = re.findall(r"viewBox=\"[^\"]*\"", text)
    escaped = label.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    least, most = (figure.get_size_inches()[0] * 72 * scale for scale in SCALES)
    head = (f'<svg xmlns="http://www.w3.org/2000/svg" {box} style="min-width:{least:.0f}px;max-width:{most:.0f}px" '
            f'role="img" aria-label="{escaped}">')
    return re.sub(r"^<svg[^>]*>", lambda _: head, text, count=1).strip()


# Labels that do not overlap -----------------------------------------------------------------------------------


CHOICES, PASSES = 40, 6  # places that a label may have, and how often all labels may choose again


@dataclass(frozen=True)
class Box:
    """A rectangle along the axes."""

    x0: float
    y0: float
    x1: float
    y1: float

    def overlap(self, other: Box) -> float:
        width = min(self.x1, other.x1) - max(self.x0, other.x0)
        height = min(self.y1, other.y1) - max(self.y0, other.y0)
        return max(width, 0) * max(height, 0)

    def outside(self, other: Box) -> float:
        """How far it sticks out of the other."""
        return (max(other.x0 - self.x0, 0) + max(self.x1 - other.x1, 0)
                + max(other.y0 - self.y0, 0) + max(self.y1 - other.y1, 0))

    def nearest(self, x: float, y: float) -> tuple[float, float]:
        return min(max(x, self.x0), self.x1), min(max(y, self.y0), self.y1)


@dataclass(frozen=True)
class Spot:
    """A place for a label: its box, and the side on which it hangs."""

    box: Box
    align: str  # left, center or right
    cost: float


def spots(x: float, y: float, width: float, height: float) -> list[Spot]:
    """Places around a point, the near ones and those beside it first."""
    found = []
    for distance, turn in itertools.product((7, 11, 16, 23, 32, 44), range(16)):
        angle = turn * math.pi / 8
        dx, dy = math.cos(angle), math.sin(angle)
        align = "center" if abs(dx) < 0.3 else "left" if dx > 0 else "right"
        left = x + dx * distance - {"left": 0.0, "center": width / 2, "right": width}[align]
        bottom = y + dy * distance - height / 2 + (dy * height / 2 if align == "center" else 0)
        found.append(Spot(Box(left, bottom, left + width, bottom + height), align, distance + (2 if dx < 0.9 else 0)))
    return found


def crosses(box: Box, line: tuple[float, float, float, float]) -> bool:
    """Whether the line from (x0, y0) to (x1, y1) goes through the box: whether any of it is left when clipped."""
    x0, y0, x1, y1 = line
    start, end = 0.0, 1.0
    for at, step, low, high in ((x0, x1 - x0, box.x0, box.x1), (y0, y1 - y0, box.y0, box.y1)):
        if step == 0:
            if not low < at < high:
                return False
            continue
        a, b = (low - at) / step, (high - at) / step
        start, end = max(start, min(a, b)), min(end, max(a, b))
    return start < end


def spread_labels(at: Sequence[tuple[float, float]], sizes: Sequence[tuple[float, float]], frame: Box,
                  lines: Sequence[tuple[float, float, float, float]]) -> list[Spot]:
    """A place for each label: near its point, in the frame, away from other labels, points and, if possible, lines.

    Each label in turn takes its best place while the others stay. A few such passes are enough for a few labels.
    """
    marks = [Box(x - 5, y - 5, x + 5, y + 5) for x, y in at]
    fixed = []
    for (x, y), (width, height) in zip(at, sizes, strict=True):
        choices = []
        for spot in spots(x, y, width, height):
            cost = spot.cost + 40 * spot.box.outside(frame) + 4 * sum(spot.box.overlap(mark) for mark in marks)
            cost += 25 * sum(crosses(spot.box, line) for line in lines)
            choices.append((cost, spot))
        fixed.append(sorted(choices, key=lambda choice: choice[0])[:CHOICES])
    chosen = [choices[0][1] for choices in fixed]

    def crowd(i: int, spot: Spot) -> float:
        others = [j for j in range(len(at)) if j != i]
        near = sum(spot.box.overlap(chosen[j].box) for j in others)
        leader = (*at[i], *spot.box.nearest(*at[i]))
        cut = sum(crosses(chosen[j].box, leader) for j in others)
        cut += sum(crosses(spot.box, (*at[j], *chosen[j].box.nearest(*at[j]))) for j in others)
        return 20 * near + 60 * cut

    for _ in range(PASSES):
        before = list(chosen)
        for i, choices in enumerate(fixed):
            chosen[i] = min(choices, key=lambda choice: choice[0] + crowd(i, choice[1]))[1]
        if chosen == before:
            break
    return chosen


class TextStyle(TypedDict):
    """Arguments of axes.text."""

    fontsize: float
    fontweight: str


def text_size(axes: Axes, text: str, style: TextStyle) -> tuple[float, float]:
    artist = axes.text(0, 0, text, **style)
    box = artist.get_window_extent()
    artist.remove()
    return box.width + 2, box.height + 1


# Cost against error -------------------------------------------------------------------------------------------

COST_TICKS = (0, 3, 10, 30, 100, 300, 1000, 10000, 100000)
LINEAR_COST = 3.0  # %: the cost's axis is linear below, where the noise is; logarithmic above


class ErrorAxis:
    """Wrong pixels as heights in a plot: the logarithm, and below it a band for what is exactly 0."""

    def __init__(self, values: Sequence[float]) -> None:
        above = [value for value in values if value > 0] or [1.0]
        self.low = math.floor(math.log10(min(above)) - 0.15)
        self.high = max(math.log10(max(above)) + 0.25, self.low + 1)
        self.border, self.zero = self.low - 0.15, self.low - 0.45
        self.has_zero = any(value == 0 for value in values)

    def height(self, value: float) -> float:
        return math.log10(value) if value > 0 else self.zero

    def apply(self, axes: Axes) -> None:
        powers = range(self.low, math.floor(self.high) + 1)
        ticks, names = [float(p) for p in powers], [f"{10.0 ** p:g} %" for p in powers]
        if self.has_zero:
            ticks, names = [self.zero, *ticks], ["0", *names]
            axes.axhline(self.border, color=INK, linewidth=0.7, linestyle=(0, (1, 2)))
        axes.set_yticks(ticks, names)
        axes.set_ylim(self.zero - 0.35 if self.has_zero else self.low - 0.1, self.high)


@styled
def cost_error(report: Report, scene: str) -> str | None:
    """Cost against error, with the Pareto front; None where fewer than two methods have both."""
    points = tables.points(report, scene)
    if len(points) < 2:
        return None
    figure, axes = new_figure(410, 330)
    place(figure, axes, 66, 40, 10, 10)
    scale = ErrorAxis([wrong for _, wrong in points.values()])
    scale.apply(axes)
    costs = [cost for cost, _ in points.values()]
    axes.set_xscale("symlog", linthresh=LINEAR_COST, linscale=0.8)
    axes.set_xlim(min(*costs, -1.0) - 1.0, max(*costs, 10) * 1.9)
    axes.set_xticks([t for t in COST_TICKS if t < axes.get_xlim()[1]],
                    [f"+{t}" if t else "0" for t in COST_TICKS if t < axes.get_xlim()[1]])
    axes.xaxis.set_minor_locator(_no_ticks())
    axes.set_xlabel(f"added time, % over {data.BUMP_ONLY}  (log; linear below {LINEAR_COST:g})")
    axes.set_ylabel("wrong pixels of the cast shadow", rotation=90, rotation_mode="anchor", labelpad=6)
    axes.grid(True)

    ahead = tables.front(report, scene)
    at = {method: (cost, scale.height(wrong)) for method, (cost, wrong) in points.items()}
    stairs_x, stairs_y = _stairs([at[method] for method in ahead], axes.get_xlim()[1])
    axes.plot(stairs_x, stairs_y, color=INK, alpha=0.4, linewidth=1.2, zorder=1.5)
    for method, (x, y) in at.items():
        colour, marker, filled = look(method)
        bar = tables.added_cost(report, scene, method)
        if bar:
            axes.plot([bar["low"], bar["high"]], [y, y], color=colour, linewidth=1.4, solid_capstyle="butt", zorder=2)
        axes.plot([x], [y], marker=marker, markersize=9 if marker == "*" else 6.5, color=colour, linestyle="none",
                  markerfacecolor=colour if filled else PAGE, markeredgewidth=1.2, zorder=3)
    corners = [_pixels(axes, corner) for corner in zip(stairs_x, stairs_y, strict=True)]
    lines = [(*a, *b) for a, b in itertools.pairwise(corners)]
    for method, (_, y) in at.items():
        if bar := tables.added_cost(report, scene, method):
            lines.append((*_pixels(axes, (bar["low"], y)), *_pixels(axes, (bar["high"], y))))
    if scale.has_zero:
        left, right = ((x, scale.border) for x in axes.get_xlim())
        lines.append((*_pixels(axes, left), *_pixels(axes, right)))
    _label_points(axes, {m: _pixels(axes, p) for m, p in at.items()}, ahead, lines)
    values = (f"{method_name(m)} {tables.added(c)} %, {tables.share(w)} % wrong" for m, (c, w) in points.items())
    return svg(figure, f"cost-error-{scene}",
               f"Cost against error, {tables.scene_title(report, scene)}: {'; '.join(values)}")


def _pixels(axes: Axes, point: tuple[float, float]) -> tuple[float, float]:
    """Where a point of the data is, in pixels."""
    x, y = axes.transData.transform(point)
    return float(x), float(y)


def _no_ticks() -> Locator:
    from matplotlib.ticker import NullLocator

    return NullLocator()


def _stairs(points: Sequence[tuple[float, float]], end: float) -> tuple[list[float], list[float]]:
    """The border of what the points dominate: across to the next one's cost, then down to it."""
    x, y = [points[0][0]], [points[0][1]]
    for to_x, to_y in points[1:]:
        x += [to_x, to_x]
        y += [y[-1], to_y]
    return [*x, end], [*y, y[-1]]


def _label_points(axes: Axes, at: dict[str, tuple[float, float]], bold: Sequence[str],
                  lines: Sequence[tuple[float, float, float, float]]) -> None:
    """Name the points, given in pixels, with a thin line where a name is far from its point."""
    styles: dict[str, TextStyle] = {m: {"fontsize": 9.5, "fontweight": "bold" if m in bold else "normal"} for m in at}
    sizes = [text_size(axes, method_name(m), styles[m]) for m in at]
    area = axes.get_window_extent()
    placed = spread_labels(list(at.values()), sizes, Box(area.x0, area.y0 + 1, area.x1, area.y1), lines)
    for (method, (x, y)), spot in zip(at.items(), placed, strict=True):
        box = spot.box
        to_x, to_y = box.nearest(x, y)
        if math.hypot(to_x - x, to_y - y) > 12:
            axes.plot([x, to_x], [y, to_y], color=INK, alpha=0.55, linewidth=0.6, transform=None, zorder=2.5)
        text_x = {"left": box.x0, "center": (box.x0 + box.x1) / 2, "right": box.x1}[spot.align]
        axes.text(text_x, (box.y0 + box.y1) / 2, method_name(method), transform=None, ha=spot.align,
                  va="center_baseline", zorder=4, **styles[method])


# Stages -------------------------------------------------------------------------------------------------------

LEGEND_COLUMNS = 5
LONGEST_BAR = 4.0  # times the shortest: longer bars are cut off, or the others would be too short to see


@styled
def stage_bars(report: Report, scene: str) -> str | None:
    """What each stage takes, one bar for a method; the interval of the whole at its end."""
    costs = data.costs(report).get(scene, {})
    times = {method: (ns, stages) for method, stages in tables.stage_times(report, scene).items()
             if method in report["methods"] and (ns := costs[method]["ns"])}
    if not times:
        return None
    totals = {m: ns["median"] for m, (ns, _) in times.items()}
    limit = LONGEST_BAR * min(totals.values())
    end = 1.08 * max(value for value in totals.values() if value <= limit)
    names = tables.stages(report, scene)
    legend_rows = math.ceil(len(names) / LEGEND_COLUMNS)
    figure, axes = new_figure(430, 19 * len(times) + 46 + 17 * legend_rows)
    place(figure, axes, 78, 38, 54, 10 + 17 * legend_rows)
    colours = dict(zip(names, itertools.cycle(STAGES), strict=False))  # as many as there are names
    for row, (ns, stages) in enumerate(times.values()):
        start = 0.0
        for name in names:
            width = min(stages.get(name) or 0.0, end - start)
            axes.barh(row, width, left=start, height=0.7, color=colours[name], edgecolor=PAGE, linewidth=0.6,
                      label=name if row == 0 else None)
            start += width
        median, low, high = ns["median"], ns["low"], ns["high"]
        if median > end:
            text, at, gap = f"▸ {median:.0f}", end, 3
        else:
            text, at, gap = f"{median:.1f}", min(high, end), 6
            axes.errorbar(median, row, xerr=[[median - low], [high - median]], color=INK, capsize=2.5, linewidth=1.1)
        axes.annotate(text, (at, row), xytext=(gap, 0), textcoords="offset points", va="center_baseline", ha="left",
                      fontsize=9)
    axes.set_xlim(0, end)
    axes.set_yticks(range(len(times)), [method_name(m) for m in times])
    axes.tick_params(axis="y", length=0)
    axes.invert_yaxis()
    axes.set_xlabel("ns a pixel, one thread")
    axes.grid(True, axis="x")
    handles, labels = axes.get_legend_handles_labels()
    # matplotlib fills a legend by columns; so ordered, it reads by rows.
    order = [i for column in range(LEGEND_COLUMNS) for i in range(column, len(labels), LEGEND_COLUMNS)]
    axes.legend([handles[i] for i in order], [labels[i] for i in order], loc="lower left", bbox_to_anchor=(-0.02, 1),
                ncols=LEGEND_COLUMNS, fontsize=9, handlelength=1.1, handleheight=1.0, columnspacing=1.2, borderpad=0.2)
    values = "; ".join(f"{method_name(m)} {total:.1f} ns" for m, total in totals.items())
    return svg(figure, f"stages-{scene}", f"Stages, {tables.scene_title(report, scene)}: {values}")


# Maps of sweeps -----------------------------------------------------------------------------------------------

CELL = (42, 27)
LINE, LETTER = 12.0, 5.8  # a line's height and a letter's width


def wrapped(text: str, width: float) -> str:
    return textwrap.fill(text, max(int(width / LETTER), 8))


@styled
def sweep_map(sweep: Sweep, bound: float) -> str:
    """Which method is the cheapest with at most `bound` % wrong, for each x and y."""
    xs, ys = sweep["x"]["values"], sweep["y"]["values"]
    width, height = CELL[0] * max(len(xs), 3), CELL[1] * max(len(ys), 3)
    x_label, y_label = wrapped(sweep["x"]["label"], width + 40), wrapped(sweep["y"]["label"], height + 30)
    left, bottom = (34 + LINE * (label.count("\n") + 1) for label in (y_label, x_label))
    figure, axes = new_figure(width + left + 6, height + bottom + 6)
    place(figure, axes, left, bottom, 6, 6)
    axes.set_xlim(0, len(xs))
    axes.set_ylim(0, len(ys))
    for row, column in itertools.product(range(len(ys)), range(len(xs))):
        wrong = sweep["wrong"][row][column]
        if wrong is None:
            axes.add_patch(_cell(column, row, facecolor="none", edgecolor=INK, hatch="/////", alpha=0.45, linewidth=0))
            continue
        method = cheapest(wrong, sweep["by_cost"], bound)
        colour = cell_colour(method)
        axes.add_patch(_cell(column, row, facecolor=colour, edgecolor=PAGE, linewidth=1.2))
        text = "×" if method is None else cell_name(method)
        axes.text(column + 0.5, row + 0.5, text, ha="center", va="center_baseline", fontsize=8.5,
                  color=CELL_LIGHT if _luminance(colour) < 0.18 else CELL_DARK)
    axes.set_xticks([i + 0.5 for i in range(len(xs))], [tables.short(x) for x in xs])
    axes.set_yticks([i + 0.5 for i in range(len(ys))], [tables.short(y) for y in ys])
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    axes.set_xlabel(x_label)
    axes.set_ylabel(y_label, rotation=90, rotation_mode="anchor", labelpad=6)
    return svg(figure, f"map-{sweep['id']}-{bound:g}".replace(".", "-"),
               f"{sweep['title']}: the cheapest method with at most {bound:g} % wrong pixels")


def _cell(column: int, row: int, **style: Any) -> Rectangle:
    """A square of the map; `style` is matplotlib's."""
    from matplotlib.patches import Rectangle

    return Rectangle((column, row), 1, 1, **style)


def _luminance(colour: str) -> float:
    """Relative luminance by WCAG, of a colour `#rrggbb`."""
    r, g, b = images.linear_of_srgb(np.array([int(colour[i:i + 2], 16) / 255 for i in (1, 3, 5)]))
    return float(0.2126 * r + 0.7152 * g + 0.0722 * b)


# Slopes of the error ------------------------------------------------------------------------------------------

DASHES = ("solid", (0, (5, 2)), (0, (5, 2, 1, 2)), (0, (1, 1.5)), (0, (8, 2)))


def slope_label(slopes: Slopes, method: str) -> str:
    """The fitted exponent, and in brackets that of theory."""
    fit, theory = slopes["fit"].get(method), slopes["theory"].get(method)
    text = MISSING if fit is None else f"{fit:.2f}"
    return f"{method_name(method)}: {text}" + (f" ({theory:g})" if theory is not None else "")


def known_errors(slopes: Slopes) -> dict[str, list[tuple[float, float]]]:
    """Amplitude and error by method, of the errors that a logarithmic axis can show."""
    lines = {}
    for method, errors in slopes["error"].items():
        known = [(a, e) for a, e in zip(slopes["amplitude"], errors, strict=True) if e is not None and e > 0]
        if known:
            lines[method] = sorted(known)
    return lines


@styled
def error_slopes(report: Report, scene: str) -> str | None:
    """The error of τ over the bumps' amplitude, both logarithmic, so that an exponent is a slope. Beside each line are
    the fitted exponent and that of theory."""
    slopes = report["slopes"][scene]
    lines = known_errors(slopes)
    if not lines:
        return None
    figure, axes = new_figure(410, 310)
    place(figure, axes, 54, 40, 116, 10)
    axes.set_xscale("log")
    axes.set_yscale("log")
    styles: dict[str, int] = {}
    for method, known in lines.items():
        colour, marker, filled = look(method)
        number = styles.setdefault(family(method), 0)
        styles[family(method)] += 1
        axes.plot([a for a, _ in known], [e for _, e in known], color=colour, linestyle=DASHES[number % len(DASHES)],
                  linewidth=1.4, marker=marker, markersize=4.5, markerfacecolor=colour if filled else PAGE)
    floor = slopes["floor"]
    if floor:
        axes.axhline(floor, color=INK, linewidth=0.8, linestyle=(0, (1, 2)))
        axes.text(0.98, floor, "floor of rounding", transform=axes.get_yaxis_transform(), ha="right", va="bottom",
                  fontsize=8.5)
    ticks = _log_ticks(slopes["amplitude"])
    axes.set_xticks(ticks, [f"{t:g}" for t in ticks])
    axes.xaxis.set_minor_locator(_no_ticks())
    low, high = (math.log10(limit) for limit in axes.get_ylim())
    step = math.ceil((high - low) / 8)
    powers = [p for p in range(math.ceil(low), math.floor(high) + 1) if p % step == 0]
    axes.set_yticks([10.0 ** p for p in powers], ["10" + str(p).translate(tables.SUPERSCRIPTS) for p in powers])
    axes.yaxis.set_minor_locator(_no_ticks())
    axes.set_xlabel(slopes["label"])
    axes.set_ylabel("error of τ", rotation=90, rotation_mode="anchor", labelpad=6)
    axes.grid(True)
    _label_ends(axes, {method: known[-1] for method, known in lines.items()}, slopes)
    labels = "; ".join(slope_label(slopes, method) for method in lines)
    return svg(figure, f"slopes-{scene}", f"Error of tau over amplitude, {tables.scene_title(report, scene)}: {labels}")


def _log_ticks(values: Sequence[float]) -> list[float]:
    """1, 2 and 5 times powers of ten, in the values' range."""
    low, high = math.log10(min(values)), math.log10(max(values))
    ticks = [m * 10.0 ** p for p in range(math.floor(low) - 1, math.ceil(high) + 1) for m in (1, 2, 5)]
    return [t for t in ticks if low - 0.05 <= math.log10(t) <= high + 0.05]


def _label_ends(axes: Axes, ends: dict[str, tuple[float, float]], slopes: Slopes) -> None:
    """Name the lines at their right ends, one below the other, in the margin beside the plot."""
    gap = 14.0
    area = axes.get_window_extent()
    at = sorted(((_pixels(axes, end), m) for m, end in ends.items()), key=lambda item: -item[0][1])
    heights = [min(y, area.y1 - 5) for (_, y), _ in at]
    for i in range(1, len(heights)):
        heights[i] = min(heights[i], heights[i - 1] - gap)
    low = area.y0 + 4
    for i in reversed(range(len(heights))):  # labels that are now below the margin go up again
        heights[i] = max(heights[i], low)
        low = heights[i] + gap
    for ((x, y), method), height in zip(at, heights, strict=True):
        colour, _, _ = look(method)
        left = area.x1 + 16
        axes.plot([x + 3, area.x1 + 4, left - 2], [y, y, height], color=colour, linewidth=0.7, transform=None,
                  clip_on=False)
        axes.text(left, height, slope_label(slopes, method), transform=None, va="center_baseline", ha="left",
                  fontsize=9)
