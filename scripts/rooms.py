"""The rooms of the house, the folders of src/: their order and what includes what, as a table and a picture.

    scripts/venv python scripts/rooms.py           the table
    scripts/venv python scripts/rooms.py --write   the table and the picture, into docs/design.md and docs/rooms.svg

ROOMS is the order that the sources must keep: a file includes files of its own room and of rooms of a lower rank.
The tests check it (tests/program/test_house.py), and that the table and the picture are not stale.
"""

from __future__ import annotations

import argparse
import html
import itertools
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
DESIGN, PICTURE = Path("docs/design.md"), Path("docs/rooms.svg")
BEGIN, END = "<!-- rooms -->", "<!-- /rooms -->"

#: Each room's rank and purpose.
ROOMS = {
    "cli": (13, "the program `kage`: commands, options, progress"),
    "view": (14, "the program `kage-view`: the window, its thread that renders, text in it"),
    "look": (13, "what the window shows and how it is changed, without a window: state, keys, stages, false colours"),
    "import": (13, "the program that reads model files, apart as they may crash their reader"),
    "api": (12, "the library's interface, `include/kage.h`"),
    "read": (11, "YAML to a scene"),
    "povray": (11, "a scene to POV-Ray's language: materials, shapes, meshes"),
    "tessellate": (10, "displaced surfaces as triangles that are as fine as the picture needs"),
    "pov_text": (9, "POV-Ray's text: numbers, expressions, frames of flat surfaces"),
    "film": (10, "the picture: tiles, threads, adaptive samples, layers"),
    "render": (9, "the way of a ray: intersection, the method's shadows, secondary rays"),
    "light": (8, "lights and materials over waves: falloff, shading"),
    "scene": (7, "camera, lights, materials, objects and the hierarchy over them"),
    "displaced": (6, "true displacement, for comparison"),
    "patch": (5, "parametric patches: pieces with proven bounds, intersection, projection"),
    "crowd": (5, "many copies of one surface, each under a map of its own"),
    "mesh": (5, "triangle meshes: loading, repair, intersection, texture coordinates"),
    "geometry": (4, "surfaces with formulas: intersection, Q and its partials, occlusion"),
    "method": (4, "the paper: the shift by each method, over waves"),
    "texture": (3, "functions of (u,w): bumps and colors, from samples and expressions"),
    "expr": (2, "expressions: parser, compiler, jets in batches, interval bounds"),
    "math": (1, "elementary functions, gradient noise, slabs"),
    "wave": (1, "rays in waves: arrays, lanes, grouping by object"),
    "image": (1, "PNG and OpenEXR, read and written"),
    "bvh": (1, "hierarchies of boxes: by Embree, and one whose rays can wait"),
    "points": (2, "lists of places with sizes, turns and labels, from CSV and PLY"),
    "yaml": (1, "YAML with positions: errors, changes by `--set`, typed values"),
    "base": (0, "numbers, vectors, errors, files"),
}


def rank(room: str) -> int:
    return ROOMS[room][0]


def room_of(path: str) -> str:
    """Of a path below src/."""
    return path.split("/")[0]


def read_sources(top: Path) -> dict[str, str]:
    """The texts of the sources by their paths below src/."""
    return {str(path.relative_to(top / "src")): path.read_text() for path in sorted((top / "src").glob("*/*.[ch]"))}


def includes(text: str) -> list[str]:
    """What a file includes of the project."""
    return re.findall(r'^#include "([^"]+)"', text, re.MULTILINE)


def rooms_below(sources: Mapping[str, str]) -> dict[str, set[str]]:
    """The rooms that each room includes; the public header kage.h is of api/."""
    found: dict[str, set[str]] = {room_of(path): set() for path in sources}
    for path, text in sources.items():
        others = {"api" if other == "kage.h" else room_of(other) for other in includes(text)}
        found[room_of(path)] |= (others & ROOMS.keys()) - {room_of(path)}
    return found


# The table ------------------------------------------------------------------------------------------


def table(sources: Mapping[str, str]) -> str:
    """Lines are rounded, so that the table lasts for longer than one change."""
    below = rooms_below(sources)
    rows = ["| rank | room | what it is for | files | lines | includes |", "|---|---|---|---|---|---|"]
    for room, (order, idea) in ROOMS.items():
        texts = [text for path, text in sources.items() if room_of(path) == room]
        if texts:
            lines = round(sum(text.count("\n") for text in texts), -2)
            others = " ".join(other for other in ROOMS if other in below[room])
            rows.append(f"| {order} | `{room}/` | {idea} | {len(texts)} | {lines} | {others} |")
    return "\n".join(rows) + "\n"


def block(sources: Mapping[str, str]) -> str:
    return (f"{BEGIN}\n\n{table(sources)}\n![The rooms and what they include]({PICTURE.name})\n\n"
            "A room may include any room with a lower rank. The last column lists those that it does include. In the\n"
            "picture an arrow goes to an included room, unless a longer way of arrows leads there.\n\n"
            f"{END}")


def with_block(text: str, sources: Mapping[str, str]) -> str:
    """A document with its part between the markers made anew."""
    begin, end = text.find(BEGIN), text.find(END)
    if begin < 0 or end < begin:
        raise ValueError(f"{DESIGN} has no '{BEGIN}' ... '{END}'")
    return text[:begin] + block(sources) + text[end + len(END):]


# The picture ----------------------------------------------------------------------------------------

WIDTH, HEIGHT, GAP = 132, 40, 34  # of a box; between two boxes of a layer
LAYER = 92  # from one layer to the next
MARGIN = 20
LANE = 26  # the width of a place where an arrow passes a layer


@dataclass(frozen=True)
class Place:
    """A box, or a point where an arrow passes a layer."""

    name: str
    layer: int


Graph = dict[str, set[str]]
Arrow = list[Place]  # from box to box through the layers between


def reduced(below: Graph) -> Graph:
    """Without the includes that a longer way says already."""
    def reach(room: str) -> set[str]:
        found: set[str] = set()
        for other in below.get(room, ()):
            found |= {other} | reach(other)
        return found

    return {room: {x for x in others if not any(x in reach(y) for y in others - {x})} for room, others in below.items()}


def layers_of(arrows: Graph) -> dict[str, int]:
    """Each room one layer above the highest that it includes; 0 is the lowest."""
    found: dict[str, int] = {}

    def layer(room: str) -> int:
        if room not in found:
            found[room] = 1 + max((layer(other) for other in arrows.get(room, ())), default=-1)
        return found[room]

    for room in arrows:
        layer(room)
    return found


def routes(arrows: Graph, layer: Mapping[str, int]) -> list[Arrow]:
    found = []
    for room in ROOMS:
        for other in (name for name in ROOMS if name in arrows.get(room, ())):
            between = [Place(f"{room}>{other}", k) for k in range(layer[room] - 1, layer[other], -1)]
            found.append([Place(room, layer[room]), *between, Place(other, layer[other])])
    return found


def ordered(layer: Mapping[str, int], found: list[Arrow]) -> dict[int, list[Place]]:
    """The places of each layer from left to right: each near the middle of its neighbours, so that few arrows cross."""
    rows: dict[int, list[Place]] = {k: [] for k in set(layer.values())}
    for place in dict.fromkeys(
        [Place(room, layer[room]) for room in ROOMS if room in layer] + [p for a in found for p in a]
    ):
        rows[place.layer].append(place)
    for turn in range(24):
        near: dict[Place, list[float]] = {}
        for arrow in found:
            for upper, lower in itertools.pairwise(arrow):
                here, there = (upper, lower) if turn % 2 else (lower, upper)
                row = rows[there.layer]
                near.setdefault(here, []).append((row.index(there) + 0.5) / len(row))
        for row in rows.values():
            at = {place: (k + 0.5) / len(row) for k, place in enumerate(row)}
            at |= {place: sum(near[place]) / len(near[place]) for place in row if place in near}
            row.sort(key=at.__getitem__)
    return rows


def placed(rows: Mapping[int, list[Place]]) -> tuple[dict[Place, tuple[float, float]], float, float]:
    """The middles of all places, and the size of the whole; layers are centred."""
    def width(place: Place) -> float:
        return LANE if ">" in place.name else WIDTH + GAP

    whole = max(sum(map(width, row)) for row in rows.values())
    top = max(rows)
    found = {}
    for k, row in rows.items():
        x = MARGIN + (whole - sum(map(width, row))) / 2
        for place in row:
            found[place] = (x + width(place) / 2, MARGIN + HEIGHT / 2 + (top - k) * LAYER)
            x += width(place)
    return found, whole + 2 * MARGIN, 2 * MARGIN + HEIGHT + top * LAYER


def ports(ways: list[Arrow], at: Mapping[Place, tuple[float, float]], end: int) -> dict[int, float]:
    """Where each arrow leaves its box (end 0) or arrives at it (end -1): side by side, in the order of their ways."""
    found = {}
    for box in {way[end] for way in ways}:
        own = [k for k, way in enumerate(ways) if way[end] == box]
        own.sort(key=lambda k: at[ways[k][1 if end == 0 else -2]][0])
        for k, way in enumerate(own):
            found[way] = at[box][0] + WIDTH * 0.7 * ((k + 0.5) / len(own) - 0.5)
    return found


def svg_arrow(points: list[tuple[float, float]]) -> str:
    """Upright beside the boxes of a layer, curved between the layers."""
    (x, y), path = points[0], ""
    for k, (x1, y1) in enumerate(points[1:], 1):
        last = k == len(points) - 1
        start, stop = y + HEIGHT / 2, y1 - HEIGHT / 2 - (8 if last else 0)
        middle = (start + stop) / 2
        curve = f"C{x:.0f},{middle:.0f} {x1:.0f},{middle:.0f} {x1:.0f},{stop:.0f}"
        path += f"{'L' if path else 'M'}{x:.0f},{start:.0f} {curve} "
        x, y = x1, y1
    return f'<path class="arrow" d="{path.rstrip()}" marker-end="url(#head)"/>'


def picture(sources: Mapping[str, str]) -> str:
    # Upward includes are against the rule: test_house.py reports them.
    arrows = reduced({room: {x for x in found if rank(x) < rank(room)} for room, found in rooms_below(sources).items()})
    layer = layers_of(arrows)
    ways = routes(arrows, layer)
    at, width, height = placed(ordered(layer, ways))
    leave, arrive = ports(ways, at, 0), ports(ways, at, -1)
    parts = []
    for k, way in enumerate(ways):
        between = [at[place] for place in way[1:-1]]
        parts.append(svg_arrow([(leave[k], at[way[0]][1]), *between, (arrive[k], at[way[-1]][1])]))
    for place, (x, y) in at.items():
        if ">" not in place.name:
            box = f'x="{x - WIDTH / 2:.0f}" y="{y - HEIGHT / 2:.0f}" width="{WIDTH}" height="{HEIGHT}"'
            idea = html.escape(ROOMS[place.name][1])
            label = f'<text x="{x:.0f}" y="{y + 6:.0f}">{place.name}/</text>'
            parts.append(f'<g><title>{idea}</title><rect {box} rx="5"/>{label}</g>')
    body = "\n".join(parts)
    return f"""<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}">
<style>
.ground {{ fill: #fff }}
rect {{ fill: #eef2f7; stroke: #333 }}
text {{ font: 17px sans-serif; text-anchor: middle; fill: #111 }}
.arrow {{ fill: none; stroke: #667; stroke-width: 1.4 }}
</style>
<defs><marker id="head" markerWidth="9" markerHeight="8" refX="1" refY="4" orient="auto">
<path d="M0,0 L9,4 L0,8 z" fill="#667"/></marker></defs>
<path class="ground" d="M0,0 H{width:.0f} V{height:.0f} H0 z"/>
{body}
</svg>
"""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help=f"into {DESIGN} and {PICTURE}")
    asked = parser.parse_args()
    sources = read_sources(TOP)
    unknown = {room_of(path) for path in sources} - ROOMS.keys()
    if unknown:
        print(f"rooms.py: no rank and idea of {', '.join(sorted(unknown))}", file=sys.stderr)
        return 1
    if not asked.write:
        print(table(sources), end="")
        return 0
    (TOP / DESIGN).write_text(with_block((TOP / DESIGN).read_text(), sources))
    (TOP / PICTURE).write_text(picture(sources))
    return 0


if __name__ == "__main__":
    sys.exit(main())
