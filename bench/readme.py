"""The tables and pictures of the README and of docs/, from a bench's result.

    scripts/venv python -m bench.readme           keep out/bench's result in bench/result.json, and write all from it
    scripts/venv python -m bench.readme --check   only name the files that disagree with bench/result.json (for a test)

`make readme` renders and measures first. Generated text is between <!-- bench:NAME --> and <!-- /bench:NAME -->.

status: 0 all agrees, 1 something does not (--check) or there is no result, 2 wrong usage
"""

from __future__ import annotations

import argparse
import hashlib
import json
import re
import sys
import textwrap
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np

from bench import bounds, claims, whole_tables
from bench import data as reading
from bench.data import BUMP_ONLY, Claim, Kept, Report
from bench.plan import METHODS
from bench.programs import TOP
from bench.stats import Interval
from bench.tables import FUSED_ABOUT, peer_name

RESULT = TOP / "bench" / "result.json"
SHEETS = ("figures.png", "gallery.png", "relief.png")  # in docs/, from `make render`, which makes them in out/
PLOT = "docs/cost-error.svg"
PLOTTED = "cube"
TABLE_METHODS = ("none", "0", "1", "2", "2+", "march:4", "auto", "exact")
WHOLE_VARIANTS = ("none", "0", "march:8 shifted", "march:8 shifted, own 8", "auto shifted, own 8", "relief")
AUTO_BESIDE = ("none", "0", "2", "march:8", "auto", "auto:1", "exact")
PAPER = "https://doi.org/10.1007/BF01900827"
MEDIANS = ("Medians; the bootstrap 95 % interval is in brackets. The % are of rounds that time both, one after the "
           "other: on a busy\nmachine they are surer than the ns, and need not be their ratio.")
NOT_YET = "Not measured yet: `make readme` measures it."
DETAILS = tuple(method for method in METHODS if method != "displaced")


class ReadmeError(Exception):
    """Why something can't be generated, in one line."""


# What is kept -------------------------------------------------------------------------------------


def picked(found: Mapping[str, Any], *keys: str) -> dict[str, Any]:
    return {key: found[key] for key in keys}


def kept(report: Report, sheets: dict[str, str]) -> Kept:
    """What the tables and the plot need of a report, and the digests of the sheets' pixels."""
    costs = {scene: {"methods": {m: picked(c, "ns", "added", "instructions_added") for m, c in methods.items()}}
             for scene, methods in reading.costs(report).items()}
    quality = {scene: {m: picked(q, "mask", "exact") for m, q in methods.items()}
               for scene, methods in reading.qualities(report).items()}
    peers = [picked(peer, "name", "scene", "ns", "build_s", "memory") for peer in reading.peers(report)]
    whole = reading.whole_part(report)
    scenes = {scene: {v: picked(w, "off_8", "flip", "silhouette", "of_rest") for v, w in variants.items()}
              for scene, variants in reading.wholes(report).items()}
    return cast(Kept, picked(report, "level", "circumstances", "methods", "variants", "scenes") | {
        "whole": picked(whole, "own", "lamps", "orders") | {"scenes": scenes},
        "cost": {"size": report["cost"]["size"], "scenes": costs, "peers": peers},
        "quality": picked(report["quality"], "truth", "parity") | {"scenes": quality},
        "claims": [picked(claim, "id", "who", "sentence", "source", "verdict")
                   | (picked(claim, "cases") if claim["who"] != "paper" else {}) for claim in report["claims"]],
        "sheets": sheets,
    })


def pixels_digest(path: Path) -> str:
    """Not of the file's bytes, as another version of the library may compress them otherwise."""
    from PIL import Image

    with Image.open(path) as image:
        pixels = np.asarray(image.convert("RGB"))
    return hashlib.sha256(repr(pixels.shape).encode() + pixels.tobytes()).hexdigest()


# Tables -------------------------------------------------------------------------------------------


def table(head: Sequence[str], rows: Sequence[Sequence[str]], other: str = "---:") -> str:
    """The first column has words; `other`: how the others are aligned."""
    lines = ["| " + " | ".join(head) + " |", "|---" + f"|{other}" * (len(head) - 1) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def percent(value: float | None) -> str:
    return "–" if value is None else f"{value:.2f} %"


def wrong_table(data: Kept, methods: Sequence[str]) -> str:
    rows = []
    for scene, found in reading.qualities(data).items():
        about = data["scenes"][scene]
        name = f"{about['title']}; slopes {about['slope_median']:.2f}, {about['slope_95']:.2f}"
        rows.append([name, *(percent(reading.mask_metric(found[m], "mask", "wrong")) for m in methods if m in found)])
    heads = [reading.label(method) for method in methods if method in data["methods"]]
    return table(["scene; slope: median, 95 % below", *heads], rows)


def coded(method: str) -> str:
    """As code where it is what an option takes."""
    return reading.label(method) if method == "none" else f"`{method}`"


def cost_text(data: Kept, scene: str, method: str, form: str) -> str:
    """The interval: its middle alone would tell more than the runs bear."""
    cost = reading.times_none(reading.cost(data, scene, method))
    if method == "none":
        return "1×"
    if cost is None:
        return "–"
    return f"{claims.span_text(cost, form)}×"


def whole_table(data: Kept, variants: Sequence[str]) -> str:
    """What is off, and the cost in times that of bump mapping only, as an interval."""
    scenes = list(reading.wholes(data))
    if not scenes:
        return NOT_YET
    rows = []
    for variant in variants:
        cells = []
        for scene in scenes:
            found = reading.whole(data, scene, variant)
            cells.append(f"{percent(found['off_8'])}, {cost_text(data, scene, variant, '.1f')}" if found else "–")
        rows.append([coded(variant), *cells])
    return table([f"off by more than 8/255, cost in times {BUMP_ONLY}", *scenes], rows)


def own_table(data: Kept) -> str:
    """Wrong pixels of the bumps' own shadows."""
    part = reading.whole_part(data).get("own") or {}
    ways = list(dict.fromkeys(how for found in part.values() for how in found["wrong"]))
    if not ways:
        return NOT_YET
    rows = [[f"{scene}, {height:g}°", whole_tables.whole_number(found["shadow"][i]),
             *(percent(found["wrong"][how][i]) for how in ways)]
            for scene, found in part.items() for i, height in enumerate(found["values"])]
    return table(["scene, height of the lamp", "shadow pixels", *(how.removeprefix("own ") for how in ways)], rows)


def auto_table(data: Kept) -> str:
    """Cost and wrong pixels of auto beside the methods that compete with it, and what it needed."""
    orders = reading.whole_part(data).get("orders") or {}
    if not orders:
        return NOT_YET
    rows = []
    for scene, needed in orders.items():
        cells = []
        for method in AUTO_BESIDE:
            wrong = reading.mask_metric(reading.quality(data, scene, method), "exact", "wrong")
            cells.append("–" if wrong is None else f"{wrong:.3g} %, {cost_text(data, scene, method, '.2f')}")
        rows.append([scene, *cells, ", ".join(f"{name} {part:.1f} %" for name, part in needed.items())])
    return table([f"wrong pixels, cost in times {BUMP_ONLY}", *map(coded, AUTO_BESIDE), "what `auto` needed"], rows)


def parity_text(data: Kept) -> str:
    parity = reading.parities(data).values()
    differs, shadow = sum(p["mask_differs"] for p in parity), sum(p["mask_shadow"] for p in parity)
    others, own = min(p["cast"] for p in parity), min(p["self"] for p in parity)
    return ("In each scene kage's own displacement (`--surface displaced`) is within 1/255 of POV-Ray's on at least\n"
            f"{others:.2f} % of the pixels, or {own:.2f} % where rough surfaces also cast shadows. "
            f"Of {shadow} pixels of cast shadow {differs} {'differs' if differs == 1 else 'differ'}.")


def interval_text(value: Interval | None, form: str) -> str:
    return "" if value is None else f"{value['median']:{form}} ({value['low']:{form}} to {value['high']:{form}})"


def cost_rows(data: Kept, methods: Sequence[str]) -> list[list[str]]:
    found = reading.costs(data)[PLOTTED]
    rows = []
    for method in methods:
        cost = found.get(method)
        if cost and cost["ns"]:
            counted = cost["instructions_added"]
            rows.append([f"kage, {reading.label(method)}", f"{cost['ns']['median']:.1f}",
                         interval_text(cost["added"], "+.0f"), "" if counted is None else f"{counted:+.0f}"])
    return rows


def peer_rows(data: Kept) -> list[list[str]]:
    return [[peer_name(peer["name"]), f"{ns['median']:.0f}", "", ""] for peer in reading.peers(data)
            if peer["scene"] == PLOTTED and (ns := peer["ns"])]


def cost_table(data: Kept, methods: Sequence[str]) -> str:
    width, height = data["cost"]["size"]
    about = data["circumstances"]
    where = (f"{width} x {height} pixels on one thread of {about['processor'].partition(',')[0]}, {about['date']}, "
             f"commit {about['commit']}.\n{MEDIANS}")
    head = ["figure 5's scene", "ns a pixel", f"% over {BUMP_ONLY}", f"instructions, % over {BUMP_ONLY}"]
    rows = cost_rows(data, methods) + peer_rows(data)
    return "\n\n".join([where, table(head, rows), textwrap.fill(FUSED_ABOUT, 120)])


def claims_text(data: Kept) -> str:
    """The paper's claims with their verdicts; of kage's own those that hold, with their figures, and no others."""
    rows = [[f"{claim['sentence']} ({claim['source']})", claim["verdict"]] for claim in data["claims"]
            if claim["who"] == "paper"]
    held = [claim for claim in data["claims"] if claim["who"] == "kage" and claim["verdict"] == claims.HOLDS
            and claim["id"] != "parity"]  # whose figures are in a place of their own
    own = [textwrap.fill(f"- {claim['sentence']} Measured: {figures(claim)}.", 120, subsequent_indent="  ",
                         break_on_hyphens=False)
           for claim in held]
    found = table([f"claim of [the paper]({PAPER})", "verdict"], rows, "---")
    return "\n".join([found, "", "Of kage itself:", "", *own]) if own else found


def figures(claim: Claim) -> str:
    return "; ".join(f"{case['case']}: {case['detail']}" for case in claim["cases"])


def bounds_table(data: Kept) -> str:
    """What kage demands of itself, case by case."""
    rows = [[f"{claim['sentence']} {case['case']}", case["detail"], case["verdict"]]
            for claim in data["claims"] if claim["who"] == bounds.WHO for case in claim["cases"]]
    return table(["bound", "figure", "verdict"], rows, "---") if rows else NOT_YET


# Where they are -----------------------------------------------------------------------------------

REGIONS: dict[str, dict[str, Callable[[Kept], str]]] = {
    "README.md": {
        "whole": lambda data: whole_table(data, WHOLE_VARIANTS),
    },
    "docs/accuracy.md": {
        "whole": lambda data: whole_table(data, WHOLE_VARIANTS),
        "quality": lambda data: wrong_table(data, TABLE_METHODS),
        "parity": parity_text,
        "cost": lambda data: cost_table(data, TABLE_METHODS),
        "claims": claims_text,
    },
    "docs/method.md": {
        "quality": lambda data: wrong_table(data, DETAILS),
        "auto": auto_table,
        "own": own_table,
    },
    "docs/design.md": {"cost": lambda data: cost_table(data, METHODS), "bounds": bounds_table},
}


def generated(text: str, name: str, content: str) -> str:
    """The text with the region's content replaced. There must be one such region."""
    pattern = re.compile(rf"(<!-- bench:{name} -->\n).*?(<!-- /bench:{name} -->)", re.DOTALL)
    if len(pattern.findall(text)) != 1:
        raise ReadmeError(f"no place, or more than one, between <!-- bench:{name} --> and <!-- /bench:{name} -->, "
                          "expected one")
    return pattern.sub(lambda found: f"{found[1]}{content}\n{found[2]}", text)


def light_colours() -> dict[str, str]:
    """The colours of the report's light page, by name. The dark page's come later in the file; the first wins."""
    style = (Path(__file__).parent / "templates" / "style.css").read_text(encoding="utf-8")
    return dict(reversed(re.findall(r"--(\w+): (#\w+);", style)))


def plot(data: Kept) -> str:
    """On white, as a README's background is not known, with the colours written out."""
    from bench import plots

    drawn = plots.cost_error(data, PLOTTED)
    if drawn is None:
        raise ReadmeError(f"the result has no costs or no errors of {PLOTTED} to plot")
    head, rest = drawn.split(">", 1)
    if "xmlns=" not in head:
        head += ' xmlns="http://www.w3.org/2000/svg"'
    text = (head + '><rect width="100%" height="100%" fill="white"/>' + rest).replace("currentColor", "#202020") + "\n"
    colours = light_colours()
    return re.sub(r"var\(--(\w+)\)", lambda found: colours[found[1]], text)


def files(data: Kept) -> dict[str, str]:
    """What each generated file must hold."""
    found = {PLOT: plot(data)}
    for name, regions in REGIONS.items():
        text = (TOP / name).read_text(encoding="utf-8")
        for region, content in regions.items():
            text = generated(text, region, content(data))
        found[name] = text
    return found


def disagreements(data: Kept) -> list[str]:
    """The generated files that are not what the result says."""
    found = [name for name, text in files(data).items()
             if not (TOP / name).exists() or (TOP / name).read_text(encoding="utf-8") != text]
    return found + [f"docs/{sheet}" for sheet, digest in data["sheets"].items()
                    if pixels_digest(TOP / "docs" / sheet) != digest]


def write(path: Path, content: bytes) -> None:
    aside = path.with_name(path.name + ".new")
    aside.write_bytes(content)
    aside.replace(path)


def update(report: Report, rendered: Path) -> None:
    """Write the result and all that is generated from it. `rendered` is the folder of the sheets."""
    data = kept(report, {sheet: pixels_digest(rendered / sheet) for sheet in SHEETS})
    texts = files(data)
    write(RESULT, (json.dumps(data, indent=1) + "\n").encode())
    for sheet in SHEETS:
        write(TOP / "docs" / sheet, (rendered / sheet).read_bytes())
    for name, text in texts.items():
        write(TOP / name, text.encode())


# The command line ---------------------------------------------------------------------------------


def main(arguments: Sequence[str] | None = None) -> int:
    about, _, status = (__doc__ or "").partition("\nstatus:")
    parser = argparse.ArgumentParser(prog="python -m bench.readme", description=about, epilog="status:" + status,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="only name the files that disagree")
    options = parser.parse_args(arguments)
    try:
        if options.check:
            wrong = disagreements(json.loads(RESULT.read_text()))
            for name in wrong:
                print(f"readme.py: {name} is not what bench/result.json says: `make readme` writes it", file=sys.stderr)
            return 1 if wrong else 0
        update(json.loads((TOP / "out" / "bench" / "report.json").read_text()), TOP / "out")
    except (ReadmeError, OSError, ValueError) as error:
        print(f"readme.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
