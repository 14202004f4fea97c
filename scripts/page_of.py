"""Pages in the style of the bench's report, from the templates beside its own (bench/templates)."""

from __future__ import annotations

from pathlib import Path

from bench.page import templates


def write(template: str, path: Path, **values: object) -> None:
    """Whole or not at all."""
    aside = path.with_name(path.name + ".new")
    aside.write_text(templates().get_template(template).render(**values), encoding="utf-8")
    aside.replace(path)
