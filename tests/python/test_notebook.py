"""docs/notebook.ipynb: every cell runs, and what it says is so; what is kept of it is small and names no machine."""

from __future__ import annotations

import re
from typing import Any

import nbformat
import pytest

from scripts import notebook
from tests.conftest import PROGRAM

WIDGET = "application/vnd.jupyter.widget-view+json"


@pytest.fixture(scope="module")
def kept() -> Any:
    return nbformat.read(notebook.NOTEBOOK, as_version=4)


@pytest.fixture(scope="module")
def fresh() -> Any:
    book = nbformat.read(notebook.NOTEBOOK, as_version=4)
    for cell in book.cells:
        cell.pop("outputs", None)
        if cell.cell_type == "code":
            cell.outputs = []
    notebook.run(book, PROGRAM.parent / "python")  # a cell that fails raises
    return book


def wrong(book: Any) -> list[float]:
    """The first % of wrong pixels that cells with "wrong" print, in their order."""
    return [float(re.findall(r"([\d.]+) %", text)[0]) for text in notebook.words(book) if "wrong" in text]


def test_all_cells_run(fresh: Any) -> None:
    assert not [cell.source for cell in fresh.cells if cell.cell_type == "code" and cell.execution_count is None]
    none, zero, one, two = wrong(fresh)[:4]
    assert none > 5 > zero > one > two
    printed = "".join(notebook.words(fresh))
    shares = [float(x) for x in re.findall(r"([\d.]+) % of the ground's pixels are as kage's", printed)]
    assert len(shares) == 6 and min(shares) > 99.9
    assert fresh.metadata.widgets


def test_the_kept_outputs_are_these(kept: Any, fresh: Any) -> None:
    """Numbers may differ in their last digits with another numpy."""
    assert wrong(kept) == pytest.approx(wrong(fresh), abs=0.11)
    outputs = [[[output.output_type for output in cell.get("outputs", ())] for cell in book.cells]
               for book in (kept, fresh)]
    assert outputs[0] == outputs[1]


def test_what_is_kept_is_clean(kept: Any) -> None:
    text = notebook.NOTEBOOK.read_text()
    assert len(text) < 1_500_000
    assert not re.findall(r"/(?:home|root|tmp|work|usr)/", text)
    assert set(kept.metadata) == {"kernelspec", "language_info", "widgets"}
    assert all(not cell.metadata for cell in kept.cells)
    assert kept.metadata.language_info == {"name": "python"}
    outputs = [output for cell in kept.cells for output in cell.get("outputs", ())]
    views = [output.data[WIDGET]["model_id"] for output in outputs if WIDGET in output.get("data", {})]
    state = kept.metadata.widgets["application/vnd.jupyter.widget-state+json"]["state"]
    assert len(views) == 6 and all(view in state for view in views)
    # sliders that need no Python to move their pictures
    assert sum(model["model_name"] == "LinkModel" for model in state.values()) == 5
