"""A slow change is noticed without a clock: the instructions of eight renders are near those that are kept.

They are kept for each compiler, in tests/golden/instructions.json; `make counts` counts and keeps them again.
"""

from __future__ import annotations

import pytest

from bench import callgrind
from bench.callgrind import Function
from bench.programs import MeasureError
from tests.conftest import not_sanitized
from tests.support import instructions

PROFILE = """\
version: 1
events: Ir Dr Dw

ob=(1) /usr/bin/kage
fl=(1) ???
fn=(1) render
0 100 20
cob=(2) /lib/libc.so.6
cfn=(2) memset
calls=3 0
0 900 0 900
fn=(3) trace
0 5 4 3
+2 1

ob=(2)
fl=(1)
fn=(2)
0 900 0 900

ob=(1)
fn=(1)
0 7
totals: 1013 24 903
"""


def test_a_profile_is_read() -> None:
    counts = callgrind.parse(PROFILE)
    assert counts == {Function("kage", "render"): {"Ir": 107, "Dr": 20, "Dw": 0},
                      Function("kage", "trace"): {"Ir": 6, "Dr": 4, "Dw": 3},
                      Function("libc.so.6", "memset"): {"Ir": 900, "Dr": 0, "Dw": 900}}
    assert callgrind.total(counts) == 1013 and callgrind.total(counts, "Dw", "libc.so.6") == 900


@pytest.mark.parametrize("text", ["", "events: Ir\nob=(1) a\nfn=(1) f\n"])
def test_a_profile_without_counts_is_an_error(text: str) -> None:
    with pytest.raises(MeasureError):
        callgrind.parse(text)


def test_both_ways_are_noticed() -> None:
    assert instructions.complaint("a", 1049, 1000) == instructions.complaint("a", 951, 1000) == ""
    assert "+6.0 %: slower" in instructions.complaint("a", 1060, 1000)
    assert "-6.0 %: faster" in instructions.complaint("a", 940, 1000)


@not_sanitized
@pytest.mark.parametrize("pair", instructions.PAIRS)
def test_instructions(pair: str) -> None:
    missing = instructions.why_not()
    if missing:
        pytest.skip(missing)
    before = instructions.kept().get(instructions.compiler(), {})
    if pair not in before:
        pytest.skip(f"none are kept for {instructions.compiler()}: make counts")
    fault = instructions.complaint(pair, instructions.count(pair), before[pair])
    assert not fault, fault
