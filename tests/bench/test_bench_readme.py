"""What the README and docs/ tell of the bench is what bench/result.json holds."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import pytest

from bench import readme
from tests.conftest import TOP
from tests.support import bench_sample


@pytest.fixture
def data() -> dict[str, Any]:
    return json.loads(readme.RESULT.read_text())


def test_readme_and_docs_agree_with_the_result(data: dict[str, Any]) -> None:
    assert readme.disagreements(data) == [], "`make readme` writes them"
    assert readme.main(["--check"]) == 0


@pytest.mark.parametrize("path, wrong", [
    (("quality", "scenes", "cube", "0", "mask", "wrong"),
     {"docs/accuracy.md", "docs/method.md", "docs/cost-error.svg"}),
    (("quality", "scenes", "waves", "iter:2", "mask", "wrong"), {"docs/method.md"}),
    (("cost", "scenes", "cube", "methods", "0", "ns", "median"), {"docs/accuracy.md", "docs/design.md"}),
    (("cost", "scenes", "cube", "methods", "1", "added", "median"),
     {"docs/accuracy.md", "docs/design.md", "docs/cost-error.svg"}),
    (("claims", 0, "verdict"), {"docs/accuracy.md"}),
    (("quality", "parity", "sphere", "mask_differs"), {"docs/accuracy.md"}),
    (("circumstances", "commit"), {"docs/accuracy.md", "docs/design.md"}),
    (("sheets", "figures.png"), {"docs/figures.png"}),
    (("sheets", "gallery.png"), {"docs/gallery.png"}),
])
def test_another_result_disagrees(data: dict[str, Any], path: tuple[str | int, ...], wrong: set[str]) -> None:
    place = data
    for key in path[:-1]:
        place = place[key]
    old = place[path[-1]]
    place[path[-1]] = old + "x" if isinstance(old, str) else old + 7
    assert set(readme.disagreements(data)) == wrong


def test_a_region_must_be_there_once() -> None:
    text = "a\n<!-- bench:x -->\nold\n<!-- /bench:x -->\nb\n"
    assert readme.generated(text, "x", "new") == text.replace("old", "new")
    for bad in ("", text + text, text.replace("/bench", "bench")):
        with pytest.raises(readme.ReadmeError, match="no place, or more than one"):
            readme.generated(bad, "x", "new")


def test_what_was_not_measured_leaves_a_gap(data: dict[str, Any]) -> None:
    """As after a bench without POV-Ray and valgrind."""
    data = copy.deepcopy(data)
    data["quality"]["scenes"]["cube"]["0"]["mask"] = None
    data["cost"]["peers"] = []
    data["cost"]["scenes"]["cube"]["methods"]["0"]["instructions_added"] = None
    assert "| – |" in readme.wrong_table(data, ("none", "0", "1"))
    assert "POV-Ray" not in readme.cost_table(data, ("none", "0"))


def test_update_keeps_and_writes(data: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """From a report on, in a project of its own; then all agrees."""
    for name in (*readme.REGIONS, *(f"docs/{sheet}" for sheet in readme.SHEETS)):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes((TOP / name).read_bytes())
    page = tmp_path / "docs" / "accuracy.md"
    page.write_text(page.read_text().replace("kage, bump only", "kage, some"))
    monkeypatch.setattr(readme, "TOP", tmp_path)
    monkeypatch.setattr(readme, "RESULT", tmp_path / "result.json")
    monkeypatch.setattr(readme, "kept", lambda report, sheets: report | {"sheets": sheets})
    readme.update(data, TOP / "docs")
    sheets = {sheet: readme.pixels_digest(TOP / "docs" / sheet) for sheet in readme.SHEETS}
    assert json.loads((tmp_path / "result.json").read_text()) == data | {"sheets": sheets}
    assert readme.disagreements(data) == []
    assert page.read_text() == (TOP / "docs" / "accuracy.md").read_text()


def test_whole_pictures(data: dict[str, Any], tmp_path: Path) -> None:
    """From a made-up report: what is kept is enough for the tables, and an old result has none of it."""
    report = bench_sample.make_report(tmp_path)
    made = readme.kept(report, {})
    table = readme.whole_table(made, readme.WHOLE_VARIANTS)
    assert "| `relief` | 0.02 %, 4.1× |" in table and "| `auto shifted, own 8` | – |" in table
    assert "| cube, 10° | 60000 | 3.10 % | 5.00 % | 0.10 % |" in readme.own_table(made)
    assert "| 0.0404 %, 1.36 to 1.37× |" in readme.auto_table(made)
    assert "0 97.0 %, march 2.6 %, exact 0.4 %" in readme.auto_table(made)
    assert "costs at most 4 times bump only. cube |" in readme.bounds_table(made)
    assert "costs at most 4 times" not in readme.claims_text(made)
    for part in ("whole", "claims"):
        data[part] = [] if part == "claims" else {}
    tables = (readme.own_table, readme.auto_table, readme.bounds_table)
    assert {table(data) for table in tables} == {readme.whole_table(data, ())} == {readme.NOT_YET}
