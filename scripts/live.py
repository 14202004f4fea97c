#!/usr/bin/env python3
"""Puts docs/live/index.html together: one page that draws the paper's scenes in a browser, without a network.

    scripts/venv python -m scripts.live            write docs/live/index.html (after `make`)
    scripts/venv python -m scripts.live --check    whether it is what would be written; status 1 if not

The parts are in docs/live/parts/; include/bumpshadow.glsl goes in unchanged. The numbers of the scenes (live_scene.py)
and the picture that is shown without WebGL come from the scene files, the latter by kage itself. A check compares maps
and picture by what they decode to, as another zlib or libwebp writes other bytes.
"""

from __future__ import annotations

import argparse
import base64
import io
import json
import os
import re
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

import numpy as np
from PIL import Image

from scripts.live_scene import SCENES, Map, read_scene

TOP = Path(__file__).resolve().parent.parent
LIVE = TOP / "docs" / "live"
PARTS, PAGE = LIVE / "parts", LIVE / "index.html"
HEADER = TOP / "include" / "bumpshadow.glsl"
SHADERS = ("scene", "heights", "geometry", "tau", "displaced", "own_shadow", "light", "trace", "main")
SCRIPTS = ("start", "state", "camera", "maps", "draw", "code", "controls", "pointer", "main")
PICTURE_SIZE = (640, 480)
SHARE, LINE = 0.5, 2  # of the picture that is `none`; pixels of the line
LIKE = 6.0            # two pictures are the same if their codes differ by less on average
BLOB = re.compile(r"(?<=base64,)[A-Za-z0-9+/=]+")


class StaleError(Exception):
    """The page is not what its parts make."""


# The blobs ------------------------------------------------------------------------------------------------------


def kage_picture(kage: Path, method: str) -> Image.Image:
    with tempfile.TemporaryDirectory() as folder:
        png = Path(folder) / "picture.png"
        size = "x".join(map(str, PICTURE_SIZE))
        subprocess.run([kage, "render", "scenes/cube.yaml", "--shadow", method, "--size", size, "--aa", "3",
                        "-o", png, "--quiet"], cwd=TOP, check=True)
        return Image.open(png).convert("RGB")


def still_picture(kage: Path) -> Image.Image:
    """What the page shows first: bump mapping alone, and the paper's order 0, beside each other."""
    left, right = kage_picture(kage, "none"), kage_picture(kage, "0")
    x = round(SHARE * PICTURE_SIZE[0])
    right.paste(left.crop((0, 0, x, PICTURE_SIZE[1])), (0, 0))
    right.paste((255, 255, 255), (x - LINE // 2, 0, x + LINE - LINE // 2, PICTURE_SIZE[1]))
    return right


def webp(picture: Image.Image) -> str:
    to = io.BytesIO()
    picture.save(to, "WEBP", quality=84, method=6)
    return base64.b64encode(to.getvalue()).decode()


def packed(m: Map) -> str:
    """The table by differences along both axes, signs last, high bytes before low ones, deflated."""
    v = np.pad(m.table.astype(np.int64), ((1, 0), (1, 0)))
    d = v[1:, 1:] - v[:-1, 1:] - v[1:, :-1] + v[:-1, :-1]
    d = ((d + 0x8000) & 0xFFFF) - 0x8000
    z = np.where(d < 0, -2 * d - 1, 2 * d)
    return base64.b64encode(zlib.compress(np.stack([z >> 8, z & 255]).astype(np.uint8).tobytes(), 9)).decode()


# The page -------------------------------------------------------------------------------------------------------


def part(name: str) -> str:
    return (PARTS / name).read_text(encoding="utf-8")


def shader(name: str, text: str) -> str:
    if "</script" in text:
        raise StaleError(f"{name} ends the page's script")
    return f'<script type="x-shader/x-fragment" id="{name}">\n{text}</script>\n'


def build(kage: Path) -> str:
    maps: dict[str, Map] = {}
    scenes = {name: read_scene(TOP / "scenes" / f"{name}.yaml", maps) for name in SCENES}
    data = {"scenes": scenes, "maps": {name: m.header() for name, m in maps.items()}}
    shaders = shader("bumpshadow.glsl", HEADER.read_text(encoding="utf-8"))
    shaders += "".join(shader(f"{name}.glsl", part(f"{name}.glsl")) for name in SHADERS)
    blobs = "".join(f'<script type="text/plain" id="map-{name}">data:;base64,{packed(m)}</script>\n'
                    for name, m in maps.items())
    text = part("page.html")
    for mark, value in {
        "STYLE": part("style.css"),
        "PICTURE": "data:image/webp;base64," + webp(still_picture(kage)),
        "SHADERS": shaders,
        "MAPS": blobs,
        "SCENES": f'<script type="application/json" id="scenes">\n{json.dumps(data, indent=1)}\n</script>\n',
        "SCRIPT": "".join(part(f"{name}.js") for name in SCRIPTS),
    }.items():
        if text.count(f"<!--{mark}-->") != 1 and mark != "PICTURE":
            raise StaleError(f"page.html needs <!--{mark}--> once")
        text = text.replace(f"<!--{mark}-->", value)
    return text


def blob_like(a: str, b: str) -> bool:
    x, y = base64.b64decode(a), base64.b64decode(b)
    if x[:4] == b"RIFF" and y[:4] == b"RIFF":
        p, q = (np.asarray(Image.open(io.BytesIO(z)).convert("RGB"), dtype=float) for z in (x, y))
        return p.shape == q.shape and float(np.abs(p - q).mean()) < LIKE
    return x[:1] == y[:1] == b"x" and zlib.decompress(x) == zlib.decompress(y)


def same(a: str, b: str) -> bool:
    """Whether two pages are alike but for how blobs are compressed."""
    blobs = BLOB.findall(a), BLOB.findall(b)
    return (BLOB.sub("", a) == BLOB.sub("", b) and len(blobs[0]) == len(blobs[1])
            and all(x == y or blob_like(x, y) for x, y in zip(*blobs, strict=True)))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing; status 1 if the page is stale")
    parser.add_argument("--kage", type=Path, default=Path(os.environ.get("KAGE", TOP / "build" / "float" / "kage")))
    arguments = parser.parse_args()
    page = build(arguments.kage.resolve())
    if not arguments.check:
        PAGE.write_text(page, encoding="utf-8")
    elif not PAGE.exists() or not same(page, PAGE.read_text(encoding="utf-8")):
        print(f"{PAGE.relative_to(TOP)} is not what its parts make: run scripts/venv python -m scripts.live",
              file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
