"""The gallery's page: each scene of scenes/gallery by `none`, as plain bump mapping does it, beside its best method.

    scripts/venv python scripts/gallery.py -o out/gallery/index.html scenes/gallery/*.yaml

Scene NAME has its pictures NAME-none.png and NAME.png beside the page (`make render` makes them). The text about a
scene is the comment at the start of its file; its best method is the `shadow` in it.
"""

from __future__ import annotations

import argparse
import re
import sys
from dataclasses import dataclass
from pathlib import Path

import jinja2

PAGE = """\
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>kage: a gallery</title>
<style>
:root { color-scheme: light dark; }
body { font: 1rem/1.5 system-ui, sans-serif; max-width: 84rem; margin: 2rem auto; padding: 0 1rem; }
section { margin: 2.5rem 0; }
h2 { margin: 0 0 .2rem; font-size: 1.2rem; }
p { margin: 0 0 .6rem; max-width: 44rem; }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(22rem, 100%), 1fr)); gap: .6rem; }
figure { margin: 0; }
img { width: 100%; height: auto; display: block; }
figcaption, code { font-size: .85rem; }
</style>
<h1>Shadows that follow the bumps</h1>
<p>Left: bump mapping alone. The shadows of other objects run straight over the bumps.
Right: the same scene by the method below it.</p>
{% for scene in scenes %}
<section>
<h2>{{ scene.name }}</h2>
<p>{{ scene.about }}</p>
<div class="pair">
<figure><img src="{{ scene.name }}-none.png" width="{{ scene.size[0] }}" height="{{ scene.size[1] }}"
alt="{{ scene.about }} By none.">
<figcaption>none</figcaption></figure>
<figure><img src="{{ scene.name }}.png" width="{{ scene.size[0] }}" height="{{ scene.size[1] }}"
alt="{{ scene.about }} By {{ scene.method }}.">
<figcaption>{{ scene.method }}</figcaption></figure>
</div>
<code>build/float/kage render scenes/gallery/{{ scene.name }}.yaml --aa 3</code>
</section>
{% endfor %}
</html>
"""


class GalleryError(Exception):
    """What a scene lacks, in one line."""


@dataclass(frozen=True)
class Scene:
    """What the page shows of a scene."""

    name: str
    about: str
    method: str
    size: tuple[int, int]


def read_scene(path: Path) -> Scene:
    text = path.read_text(encoding="utf-8")
    comment = re.match(r"((?:# .*\n)+)", text)
    method = re.search(r'^render: \{.*?shadow: "?([^",}]+)', text, re.MULTILINE)
    size = re.search(r"^image: \{size: \[(\d+), (\d+)\]", text, re.MULTILINE)
    if not comment or not method or not size:
        raise GalleryError(f"{path}: expected a comment in its first line, an image size and a render.shadow")
    about = " ".join(line[2:] for line in comment[1].splitlines())
    return Scene(path.stem, about, method[1], (int(size[1]), int(size[2])))


def main() -> int:
    parser = argparse.ArgumentParser(description="Make the gallery's page.")
    parser.add_argument("scenes", nargs="+", type=Path, metavar="SCENE")
    parser.add_argument("-o", "--output", type=Path, required=True, help="the page; the pictures are beside it")
    options = parser.parse_args()
    try:
        scenes = [read_scene(path) for path in options.scenes]
        absent = [name for scene in scenes for name in (f"{scene.name}-none.png", f"{scene.name}.png")
                  if not (options.output.parent / name).exists()]
        if absent:
            raise GalleryError(f"{options.output.parent}: no {', '.join(absent)}; have they been rendered?")
        template = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined).from_string(PAGE)
        aside = options.output.with_name(options.output.name + ".new")
        aside.write_text(template.render(scenes=scenes), encoding="utf-8")
        aside.replace(options.output)
    except (GalleryError, OSError) as error:
        print(f"gallery: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
