"""Every scene by every method is what it was (tests/regression/); truly displaced, it is what POV-Ray shows
(reference/).

A failure writes old, new and difference into out/regression/ and tells the command that repeats it. `make accept` shows
all changes on one page and keeps them where that is wanted.
"""

from __future__ import annotations

import io
import itertools
import shlex
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bench import claims, plan, quality
from reference import references
from tests.regression import cases

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
    from tests.regression import accept

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


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> plan.Bench:
    """The bench's measures of the scenes, with the truths that they need."""
    facts = {name: plan.facts(KAGE, name) for name in references.SCENES}
    one = plan.Bench(KAGE, "tested", tmp_path_factory.mktemp("bench"), plan.LEVELS["normal"], facts)
    for scene in facts.values():
        for truth in ("exact", "flat"):
            quality.make_truth(one, scene, truth)
    return one


@pytest.mark.parametrize("scene", references.SCENES)
def test_displaced_is_povrays(bench: plan.Bench, scene: str) -> None:
    """A failure tells the command that makes kage's picture."""
    found = quality.measure(bench, bench.scenes[scene], "displaced")
    again = f"beside reference/{scene}.exr: {found['command']}"
    for kind, least in claims.LEAST_CLOSE.items():
        assert found[f"{kind}_close"] >= least, f"% of the pixels within 1/255 of POV-Ray's ({kind}); {again}"
    assert found["mask_shadow"] > 5000
    differ = f"{found['mask_differs']} pixels of shadow differ; {again}"
    assert found["mask"]["wrong"] <= claims.MOST_DIFFERENT, differ


@pytest.fixture(scope="module")
def waves(bench: plan.Bench) -> dict[str, dict[str, Any]]:
    return {method: quality.measure(bench, bench.scenes["waves"], method) for method in (*claims.MERIT, "exact")}


@pytest.mark.parametrize("truth", ["mask", "exact"])
def test_order_of_merit(waves: dict[str, dict[str, Any]], truth: str) -> None:
    """On function data with gentle slopes each order is better than the one before, against POV-Ray's truth and
    kage's."""
    wrong = [waves[method][truth]["wrong"] for method in claims.MERIT]
    assert all(a > b for a, b in itertools.pairwise(wrong)), wrong


def test_exact_is_povrays_shadow(waves: dict[str, dict[str, Any]]) -> None:
    """The hybrid's shadow origin is the true hit, so on a plane its mask is POV-Ray's."""
    exact = waves["exact"]
    assert exact["mask"]["wrong"] <= claims.MOST_DIFFERENT
    assert exact["exact"]["wrong"] == exact["tau"]["p95"] == exact["fell_back"] == 0


def test_without_a_reference_the_rest_is_measured(bench: plan.Bench, monkeypatch: pytest.MonkeyPatch,
                                                  tmp_path: Path) -> None:
    monkeypatch.setattr(plan.Bench, "references", tmp_path)
    found = quality.measure(bench, bench.scenes["waves"], "0")
    assert "mask" not in found and "`make reference` makes it again" in found["why"]
    assert 0.5 < found["exact"]["wrong"] < 1
