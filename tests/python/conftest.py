"""What the tests of the package share."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import PROGRAM, TOP, Kage, start

#: A child that interrupts itself: what runs, and when it began, is printed by it.
PACKAGE = PROGRAM.parent / "python"


@pytest.fixture
def program(kage: Kage) -> Kage:
    """The program, for tests in which `kage` is the package."""
    return kage


@pytest.fixture
def python(tmp_path: Path) -> Callable[..., subprocess.Popen[Any]]:
    """Starts Python with the package, for a text."""
    def run(text: str, *arguments: object, **options: Any) -> subprocess.Popen[Any]:
        environment = {**os.environ, "PYTHONPATH": str(PACKAGE), "SCENES": str(TOP / "scenes")}
        return start([sys.executable, "-c", text, *arguments], cwd=tmp_path, env=environment, text=True,
                     stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)

    return run
