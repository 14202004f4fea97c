"""The examples of docs/gbuffer.md and docs/methods-python.md run, block after block, and name every function."""

from __future__ import annotations

import re
from typing import Any

import pytest

from kage import methods
from tests.conftest import TOP


@pytest.mark.parametrize("page", ["gbuffer.md", "methods-python.md"])
def test_the_examples_run(page: str) -> None:
    blocks = re.findall(r"```python\n(.*?)```", (TOP / "docs" / page).read_text(), re.DOTALL)
    assert len(blocks) > 1
    names: dict[str, Any] = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)  # noqa: S102


def test_the_page_has_every_function() -> None:
    page = (TOP / "docs" / "methods-python.md").read_text()
    functions = {name for name, value in vars(methods).items()
                 if callable(value) and value.__module__ == methods.__name__ and name[0].islower()}
    assert len(functions) > 30
    assert functions - set(re.findall(r"`(\w+)`", page)) == set()


def test_every_function_of_the_header_is_there() -> None:
    """`view_of` is `view`, and so on."""
    header = (TOP / "include" / "bumpshadow.h").read_text()
    found = set(re.findall(r"^static inline \w+ bs_(\w+?)(?:_of)?\(", header, re.MULTILINE))
    inside = {"cross", "dot", "slab_ends", "way_to", "mean_above"}  # of vectors, or what others of them call
    assert found - inside - set(vars(methods)) == set()
    assert all(vars(methods)[name].__doc__ for name in found - inside)
