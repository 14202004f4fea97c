"""Which stages the compiler has vectorised, read from the program itself.

Every stage (a function marked STAGE, src/real.h) is in the program once for each instruction level. This lists the
stages with the widest registers of their packed arithmetic (128: SSE and xmm, 256: ymm, 512: zmm; 0: none, the loop is
scalar) and the numbers of their packed and scalar arithmetic instructions. Every loop has a scalar rest.

    scripts/venv python scripts/vectorised.py [build/float/kage]
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
SYMBOL = re.compile(r"^[0-9a-f]+ <(\w+)\.(default|arch_x86_64_v3|arch_x86_64_v4|avx2)(?:\.\d+)?>:$")
# arithmetic, conversions, comparisons and blends; moves and shuffles alone make no SIMD loop
PACKED = re.compile(r"\bv?(add|sub|mul|div|sqrt|min|max|and|andn|or|xor|cmp\w*|cvt\w*|blend\w*|gather\w*|fm\w*)p[sd]\b")
INTEGER = re.compile(r"\bv?(p(add|sub|and|or|xor|cmp|gather)\w*)\b")
STORE = re.compile(r"\bv?mov(?:[au]p[sd]|dq[au]\d*)\s+%[xyz]mm\d+,[-0-9a-fx]*\(")  # all that a filling loop has
SCALAR = re.compile(r"\bv?(add|sub|mul|div|sqrt|min|max|comi|ucomi|cvt\w*)s[sd]\b")
LEVELS = {"default": "x86-64", "arch_x86_64_v3": "AVX2", "avx2": "AVX2", "arch_x86_64_v4": "AVX-512"}


def width(instruction: str) -> int:
    """The widest register of an instruction, in bits."""
    return 512 if "%zmm" in instruction else 256 if "%ymm" in instruction else 128 if "%xmm" in instruction else 0


def stages(program: Path) -> dict[tuple[str, str], tuple[int, int, int]]:
    """(stage, level): widest packed registers in bits, packed and scalar instructions."""
    text = subprocess.run(["objdump", "-d", "--no-show-raw-insn", program], check=True, capture_output=True,
                          text=True).stdout
    found: dict[tuple[str, str], tuple[int, int, int]] = {}
    key = None
    for line in text.splitlines():
        symbol = SYMBOL.match(line)
        if line.endswith(">:"):
            key = (symbol.group(1), LEVELS[symbol.group(2)]) if symbol else None
            if key:
                found.setdefault(key, (0, 0, 0))
        elif key:
            widest, packed, scalar = found[key]
            if PACKED.search(line) or INTEGER.search(line) or STORE.search(line):
                found[key] = (max(widest, width(line)), packed + 1, scalar)
            elif SCALAR.search(line):
                found[key] = (widest, packed, scalar + 1)
    return found


def main() -> int:
    program = Path(sys.argv[1]) if len(sys.argv) > 1 else TOP / "build" / "float" / "kage"
    found = stages(program)
    levels = [k for k in dict.fromkeys(LEVELS.values()) if any(level == k for _, level in found)]
    print(f"{'stage':28}" + "".join(f"{level + ': bits packed scalar':>28}" for level in levels))
    for name in sorted({stage for stage, _ in found}):
        row = [found.get((name, level), (0, 0, 0)) for level in levels]
        print(f"{name:28}" + "".join(f"{bits:>14}{packed:>7}{scalar:>7}" for bits, packed, scalar in row))
    return 0 if found else 1


if __name__ == "__main__":
    sys.exit(main())
