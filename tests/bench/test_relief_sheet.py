"""scripts/relief_sheet.py with a fake kage, a script that copies a picture and tells made-up times."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from scripts import relief_sheet

FAKE = """#!/bin/sh
ns=20.0
for word; do
    case $word in
    --relief) ns=61.0 ;;
    displaced) ns=480.0 ;;
    --stats) stats=1 ;;
    *.png) out=$word ;;
    esac
done
cp {folder}/picture.png "$out"
test -z "$stats" || echo " render   1.00 ms  $ns ns a sample"
"""


@pytest.fixture
def kage(tmp_path: Path) -> Path:
    Image.fromarray(np.full((360, 480, 3), 90, np.uint8)).save(tmp_path / "picture.png")
    program = tmp_path / "kage"
    program.write_text(FAKE.format(folder=tmp_path))
    program.chmod(0o755)
    return program


def test_labels_have_costs(kage: Path) -> None:
    assert [cell.label for cell in relief_sheet.cells(kage)] == [
        "bump mapping alone (1.0×)", "the paper, order 0 (1.0×)", "kage --relief (3.0×)", "the truth: displaced (24×)"]


def test_sheet(kage: Path, tmp_path: Path) -> None:
    sheet = tmp_path / "out" / "relief.png"
    assert relief_sheet.main(["--kage", str(kage), "-o", str(sheet)]) == 0
    with Image.open(sheet) as image:
        assert image.size[0] > 4 * 480


def test_failures(kage: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for text, told in ((FAKE.format(folder=tmp_path).replace("ns a sample", ""), "no time of the render"),
                       ("#!/bin/sh\necho scene: bad; exit 2\n", "kage: scene: bad"), ("no program", "relief_sheet: ")):
        kage.write_text(text)
        assert relief_sheet.main(["--kage", str(kage), "-o", str(tmp_path / "a.png")]) == 1
        assert told in capsys.readouterr().err
    assert not (tmp_path / "a.png").exists()
