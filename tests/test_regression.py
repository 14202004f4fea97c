"""Every scene by every method is what it was (tests/regression/); truly displaced, it is what POV-Ray shows (reference/).

A failure writes old, new and difference into out/regression/ and tells the command that repeats it. `make accept` shows all
changes on one page and keeps them where that is wanted.
"""

from __future__ import annotations

import dataclasses
import io
import json
import os
import shlex
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from conftest import TOP

sys.path[:0] = [str(TOP / "tests" / "regression"), str(TOP / "reference"), str(TOP / "bench")]

import cases  # noqa: E402
import quality  # noqa: E402
import references  # noqa: E402

KAGE = cases.PROGRAM


# ---- against kage's own pictures ----


@pytest.mark.parametrize("case", cases.CASES, ids=lambda case: case.name)
def test_picture_is_what_it_was(case: cases.Case, tmp_path: Path) -> None:
    change = cases.compare(case, cases.render(case, tmp_path))
    if change:
        shown = [f"{cases.OUT / name}-difference.png" for name in change.show()]
        again = shlex.join(case.command(cases.OUT / f"{case.name}.exr"))
        pytest.fail(f"{case.name}: {change.what}\nlook at {', '.join(shown)}, beside -old.png and -new.png\n"
                    f"again: {again}\nif it is to be so: make accept", pytrace=False)


def test_no_picture_is_left_over() -> None:
    assert {path.stem for path in cases.HERE.glob("*.exr")} == {case.name for case in cases.CASES}


def one_pixel(value: float) -> cases.Layers:
    return {name: np.full((1, 1), value, dtype=np.float16) for name in cases.CHANNELS}


@pytest.mark.parametrize("old, new, same", [
    (0.5, 0.5, True), (0.5, np.nextafter(np.float16(0.5), np.float16(1)), True), (0.5, 0.5 + 2**-10, False),
    (0.0, -0.0, True), (0.0, 6e-8, True), (-6e-8, 6e-8, False), (0.1, -0.1, False),
])
def test_tolerance(old: float, new: float, same: bool) -> None:
    assert cases.differs(one_pixel(old), one_pixel(new)).any() == (not same)


# ---- accepting ----


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with one case's picture, shifted by a pixel, in place of the project's."""
    case = cases.Case("cube", "0")
    monkeypatch.setattr(cases, "HERE", tmp_path / "kept")
    monkeypatch.setattr(cases, "OUT", tmp_path / "out")
    monkeypatch.setattr(cases, "CASES", (case,))
    cases.HERE.mkdir()
    layers = cases.render(case, tmp_path)
    references.write_exr(cases.HERE / "cube-0.exr", {name: np.roll(plane, 1, axis=1) for name, plane in layers.items()})
    (cases.HERE / "gone-0.exr").write_bytes(b"")
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    return cases.HERE


def test_accept_asks(kept: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    import accept

    before = (kept / "cube-0.exr").read_bytes()
    monkeypatch.delenv("ACCEPT", raising=False)
    assert accept.main() == 1
    text = capsys.readouterr().out
    assert "cube-0: " in text and "gone-0.exr: of no case" in text and "not kept" in text
    page = (cases.OUT / "index.html").read_text()
    for name in ("cube-0", "cube-0-tau"):
        for kind in ("old", "new", "difference"):
            assert f'src="{name}-{kind}.png"' in page and (cases.OUT / f"{name}-{kind}.png").exists()
    assert (kept / "cube-0.exr").read_bytes() == before and (kept / "gone-0.exr").exists()

    monkeypatch.setenv("ACCEPT", "yes")
    assert accept.main() == 0
    assert [path.name for path in kept.iterdir()] == ["cube-0.exr"]
    assert accept.main() == 0
    assert "as before" in capsys.readouterr().out


# ---- against POV-Ray's ----


def show(name: str, old: np.ndarray, new: np.ndarray, options: quality.Options) -> str:
    """Write the pictures of a failure; where they are, and how to make kage's again."""
    cases.write_pictures(name, old, new)
    height, width = old.shape[:2]
    scene = name.partition("-")[0]
    command = [os.path.relpath(KAGE, TOP), "render", f"scenes/{scene}.yaml", *options, "--size", f"{width}x{height}", "-o",
               os.path.relpath(cases.OUT / f"{name}.exr", TOP)]
    return f"look at {cases.OUT / name}-difference.png, beside -old.png (POV-Ray) and -new.png\nagain: {shlex.join(command)}"


@pytest.mark.parametrize("kind", references.PICTURES)
@pytest.mark.parametrize("scene", references.SCENES)
def test_displaced_is_povrays(scene: str, kind: str) -> None:
    truth, options = references.load(scene).pictures[kind], quality.DISPLACED[kind]
    picture = references.stack(quality.render(KAGE, scene, truth.shape, options))
    close = quality.share_close(picture, truth)
    if close < quality.LEAST_CLOSE[kind]:
        pytest.fail(f"{close:.2f} % of the pixels are within 1/255 of POV-Ray's, expected {quality.LEAST_CLOSE[kind]} %\n"
                    + show(f"{scene}-povray-{kind}", truth, picture, options), pytrace=False)


@pytest.mark.parametrize("scene", references.SCENES)
def test_displaced_mask_is_povrays(scene: str) -> None:
    with ThreadPoolExecutor(2) as pool:
        parity = quality.measure_parity(KAGE, scene, pool)
    assert parity.mask_shadow > 5000
    assert parity.mask <= quality.MOST_DIFFERENT, f"{parity.mask_differs} of {parity.mask_shadow} pixels of shadow differ"


@pytest.fixture(scope="module")
def waves() -> list[quality.Row]:
    with ThreadPoolExecutor(2) as pool:
        return quality.measure_scene(KAGE, quality.MERIT_SCENE, pool, (*quality.MERIT, "exact"))


def test_order_of_merit(waves: list[quality.Row]) -> None:
    """On function data with gentle slopes each order is better than the one before, against either truth."""
    assert quality.merit_holds(waves), [(row.method, row.wrong_povray, row.wrong_exact) for row in waves]


def test_exact_is_povrays_shadow(waves: list[quality.Row]) -> None:
    """The hybrid's shadow origin is the true hit, so on a plane its mask is POV-Ray's."""
    assert waves[-1].wrong_povray <= quality.MOST_DIFFERENT
    assert waves[-1].wrong_exact == waves[-1].tau_95 == 0


def test_merit_can_fail(waves: list[quality.Row]) -> None:
    worse = [dataclasses.replace(row, wrong_povray=waves[1].wrong_povray) if row.method == "2" else row for row in waves]
    assert not quality.merit_holds(worse)


def test_quality_prints_and_writes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(quality, "METHODS", ("none", "1 bare"))
    path = tmp_path / "q.json"
    assert quality.main(["cube", "--markdown", "--json", str(path), "--kage", str(KAGE)]) == 0
    text = capsys.readouterr().out
    assert "| cube | none | 6.2" in text and "| cube | 1 bare | " in text and "PASS  cube: displaced as POV-Ray's" in text
    content = json.loads(path.read_text())
    assert [row["method"] for row in content["methods"]] == ["none", "1 bare"]
    assert content["displaced"][0]["mask_shadow"] > 5000


def test_quality_usage(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        quality.main(["nosuch"])
    assert stop.value.code == 2 and "'nosuch' is none of the scenes" in capsys.readouterr().err
