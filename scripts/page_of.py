"""Pages in the style of the bench's report, from the templates beside its own (bench/templates)."""

from __future__ import annotations

from pathlib import Path

import jinja2

TEMPLATES = Path(__file__).resolve().parent.parent / "bench" / "templates"


def write(template: str, path: Path, **values: object) -> None:
    """Whole or not at all."""
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(TEMPLATES), autoescape=True,
                                     undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    aside = path.with_name(path.name + ".new")
    aside.write_text(environment.get_template(template).render(**values), encoding="utf-8")
    aside.replace(path)
