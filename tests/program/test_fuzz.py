"""What the fuzzer has found stays mended: every find, and what the fuzzer begins with, by its target (tests/fuzz)."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.conftest import PROGRAM, TOP
from tests.fuzz import seeds

REPLAY = PROGRAM.parent / "fuzz" / "replay"
FINDS = TOP / "tests" / "fuzz" / "finds"

#: Pictures of whole scenes take long; other tests make them.
QUICK = [target for target in seeds.SEEDS if target not in ("scene", "set", "patch")]


def replay(*words: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([REPLAY, *words], capture_output=True, text=True, errors="replace", timeout=600, check=False)


def test_finds() -> None:
    done = replay(FINDS)
    assert done.returncode == 0, done.stdout[-400:] + done.stderr
    kept = [path for path in FINDS.glob("*/*") if path.is_file()]
    assert done.stdout.endswith(f"{len(kept)} inputs, no find\n"), "a folder there is called after no target"


@pytest.mark.parametrize("target", QUICK)
def test_seeds(target: str, tmp_path: Path) -> None:
    """They reach what they are made for, so the fuzzer begins there."""
    seeds.write(target, tmp_path)
    done = replay(target, *sorted(tmp_path.iterdir()))
    assert done.returncode == 0, done.stdout[-400:] + done.stderr


def test_words_are_those_of_the_readers() -> None:
    scene, expr, points = (seeds.words(target) for target in ("scene", "expr", "points"))
    assert {'"ior"', '"bump_shadow"', '"torus"', '"smoothstep("', '"wrap"'} <= set(scene)
    assert {'"sqrt("', '"atan2("', '"noise("', '"select("'} <= set(expr)
    assert {'"property"', '"turn"', '"float64"'} <= set(points)


def test_what_is_no_input_is_refused(tmp_path: Path) -> None:
    assert replay(tmp_path).returncode == 2
    assert replay("scene", tmp_path / "missing").returncode == 2
