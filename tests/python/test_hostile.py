"""A fixed part of `python -m tests.verify.numbers`: no NaN and no infinity, whatever the scene."""

from __future__ import annotations

from pathlib import Path

import kage
from tests.verify import numbers


def test_random_hostile_scenes(tmp_path: Path) -> None:
    done = numbers.run(kage, tmp_path, 40, 1, loud=False)
    assert done["failed"] == []
    assert done["samples without a value"] > 500
