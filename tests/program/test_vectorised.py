"""The stages are SIMD: read off the program by scripts/vectorised.py."""

from __future__ import annotations

import platform
import shutil
from pathlib import Path

import pytest

from scripts import vectorised
from tests.conftest import PROGRAM as KAGE

# What is known not to be vectorised, or not to full width, and why.
SCALAR = {"order_2_bare"}  # gcc 12 finds no vector for its choice between the orders 1 and 2; not the default method
# Their choices become branches without blends of masks.
NOT_ON_SSE2 = {
    "drop_irregular",
    "cone_caps_eval",
    "torus_bounds",
    "torus_bracket",
    "occlude_by_quartic",
    "torus_step",
    "level_up",
}
# Four values of a colour, or four heights of a row, are one vector of 128 bits, on purpose.
HALF = {"map_interpolate", "heights_down", "heights_bend_down"}


@pytest.mark.skipif(platform.machine() != "x86_64", reason="reads x86-64 instructions")
def test_every_stage_is_simd_on_every_level() -> None:
    if not shutil.which("objdump"):
        pytest.fail("objdump is missing (binutils, which comes with the compiler)")
    found = vectorised.stages(KAGE)
    levels = {level for _, level in found}
    if levels == {"x86-64"} or not levels:
        pytest.skip("this program was built without clones")
    assert len(found) > 150, "the symbols of the clones are not where they were"
    for (stage, level), (bits, packed, scalar) in found.items():
        least = 128 if level == "x86-64" or stage in HALF else 256
        if stage in SCALAR or (level == "x86-64" and stage in NOT_ON_SSE2):
            continue
        assert bits >= least, f"{stage} on {level}: vectors of {bits} bits"
        if least == 256 and packed >= 8:
            # a scalar rest is as long as the loop at most; a loop that is scalar has next to nothing packed
            assert packed > scalar / 4, f"{stage} on {level}: {packed} packed, {scalar} scalar instructions"


def test_counts_on_made_up_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The reading itself: a packed, a scalar and a foreign function."""
    code = """
0000000000001000 <good.arch_x86_64_v3>:
    1000:\tvaddps %ymm0,%ymm1,%ymm2
    1004:\tvmulss %xmm0,%xmm1,%xmm2
    1008:\tvmovaps %ymm0,(%rdi)

0000000000002000 <bad.arch_x86_64_v3>:
    2000:\tvmulss %xmm0,%xmm1,%xmm2
    2004:\tvdivsd %xmm0,%xmm1,%xmm2

0000000000003000 <main>:
    3000:\tvaddps %zmm0,%zmm1,%zmm2
"""

    class Output:
        stdout = code

    monkeypatch.setattr(vectorised.subprocess, "run", lambda *_, **__: Output)
    assert vectorised.stages(tmp_path) == {("good", "AVX2"): (256, 2, 1), ("bad", "AVX2"): (0, 0, 2)}
