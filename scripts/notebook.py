"""Run docs/notebook.ipynb again and keep its outputs, without what differs from run to run or names this machine.

    scripts/venv python -m scripts.notebook [--check] [FILE]

--check writes nothing: it runs the notebook and compares its text outputs with those that are in the file.
"""

from __future__ import annotations

import argparse
import os
import re
import sys
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient

TOP = Path(__file__).resolve().parent.parent
NOTEBOOK = TOP / "docs" / "notebook.ipynb"
PACKAGE = TOP / "build" / "float" / "python"


def run(book: Any, package: Path) -> None:
    """In place. The widgets' state is stored in the notebook, so that sliders move without a kernel."""
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (str(package), os.environ.get("PYTHONPATH"))))
    NotebookClient(book, timeout=300, kernel_name="python3", store_widget_state=True,
                   resources={"metadata": {"path": str(NOTEBOOK.parent)}}).execute()


def clean(book: Any) -> None:
    """No times, no version of Python; identifiers in their order."""
    book.metadata = nbformat.from_dict({
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"}, "widgets": book.metadata.get("widgets", {})})
    for index, cell in enumerate(book.cells):
        cell.metadata = nbformat.from_dict({})
        cell["id"] = f"cell-{index}"
    text = nbformat.writes(book)
    names = dict.fromkeys(re.findall(r"\b[0-9a-f]{32}\b", text))
    for index, name in enumerate(names):
        text = text.replace(name, f"{index:032x}")
    book.update(nbformat.reads(text, as_version=4))


def words(book: Any) -> list[str]:
    """What the cells print."""
    return ["".join(output["text"]) for cell in book.cells for output in cell.get("outputs", ())
            if output["output_type"] == "stream"]


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("file", nargs="?", type=Path, default=NOTEBOOK)
    options.add_argument("--check", action="store_true")
    options.add_argument("--package", type=Path, default=PACKAGE, help="folder to import kage from")
    given = options.parse_args()
    book = nbformat.read(given.file, as_version=4)
    before = words(book)
    run(book, given.package)
    if given.check:
        sys.exit(0 if words(book) == before else f"{given.file}: prints other words than it holds; run it again")
    clean(book)
    nbformat.write(book, given.file)


if __name__ == "__main__":
    main()
