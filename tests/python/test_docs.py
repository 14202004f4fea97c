"""docs/python.md: its examples run as they stand, one after another."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import TOP

GUIDE = TOP / "docs" / "python.md"


def test_the_examples_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenes").symlink_to(TOP / "scenes")
    names: dict[str, Any] = {}
    text = GUIDE.read_text()
    for block in re.finditer(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE):
        lines = "\n" * text[: block.start()].count("\n")  # so that an error names the line of the guide
        exec(compile(f"{lines}\n{block[1]}", str(GUIDE), "exec"), names)  # noqa: S102 - our own
    shown = capsys.readouterr().out
    assert "R G B Z P.X".replace(" ", "', '") in shown and "ground steep 0.6" in shown
    assert "scene 1 16" in shown and names["picture"].rgb.max() > 0.5
    assert {"cube.png", "cube.exr", "large.exr", "pond.yaml", "cube.pov"} <= {path.name for path in tmp_path.iterdir()}
