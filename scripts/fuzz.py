#!/usr/bin/env python3
"""Change scenes at random and check that kage answers each with a picture or an error, never with a crash.

Run n (of --seed) changes one of the scenes: bytes are replaced, removed, repeated or inserted, tokens are swapped, and
numbers become strange ones. The same seed gives the same runs; `--only N` repeats one. A scene that fails is kept, and
its command is printed.

    scripts/venv python scripts/fuzz.py --count 10000 --program build/float/kage
"""

from __future__ import annotations

import argparse
import random
import re
import shlex
import subprocess
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent

TOKEN = re.compile(rb"[A-Za-z_]+|[-+.0-9e]+|[ \t]+|\n|.", re.DOTALL)
STRANGE = [
    b"0", b"-1", b"1e6", b"1e-6", b"-1e6", b"1e38", b"1e-45", b"1e999", b"nan", b".inf", b"0x7f", b"32768",
    b"2147483648", b"''", b"[", b"]", b"{", b"}", b"[]", b"{}", b":", b": ", b",", b"- ", b"? ", b"&a ", b"*a", b"<<: ",
    b"!!str ", b"|\n", b">\n", b"'", b'"', b'"\\', b"#", b"---\n", b"...\n", b"%YAML 1.1\n", b"\t", b"\r", b"\0",
    b"\xff", b"\xef\xbb\xbf", b"\xe2\x80\xa8", b"~", b"null", b"true", b"none", b"2+", b"march:64", b"iter:64",
    b"function: ", b"sin(u)", b"u/w", b"noise(u,w)", b"u^w^u", b"clamp(u,1,0)", b"map", b"plane", b"rectangle", b"box",
    b"sphere", b"disc", b"cylinder", b"cone", b"torus", b"transform", b"copy", b"rotate", b"open", b"from_radius",
    b"mirror", b"corners", b"down", b"../", b"/",
]
NUMBERS = STRANGE[:14]


def mutate_bytes(data: bytearray, rng: random.Random) -> None:
    at = rng.randrange(len(data) + 1)
    match rng.randrange(4):
        case 0:
            data[at : at + 1] = bytes([rng.randrange(256)])
        case 1:
            del data[at : at + rng.choice([1, 1, 2, 8, 64])]
        case 2:
            data[at:at] = rng.choice(STRANGE)
        case _:
            part = data[at : at + rng.randrange(1, 80)]
            data[at:at] = part * rng.choice([1, 1, 2, 50])


def mutate_tokens(data: bytearray, rng: random.Random) -> None:
    tokens = TOKEN.findall(bytes(data))
    if not tokens:
        return
    at, other = rng.randrange(len(tokens)), rng.randrange(len(tokens))
    match rng.randrange(4):
        case 0:
            tokens[at] = rng.choice(STRANGE)
        case 1:
            tokens[at], tokens[other] = tokens[other], tokens[at]
        case 2:
            tokens[at] = tokens[other]
        case _:
            numbers = [k for k, token in enumerate(tokens) if re.fullmatch(rb"-?[0-9.]+", token)]
            if numbers:
                tokens[rng.choice(numbers)] = rng.choice(NUMBERS)
    data[:] = b"".join(tokens)


def mutated(scene: bytes, rng: random.Random) -> bytes:
    data = bytearray(scene)
    for _ in range(rng.choice([1, 1, 1, 2, 3, 8])):
        rng.choice([mutate_bytes, mutate_tokens, mutate_tokens])(data, rng)
    return bytes(data)


def run(program: Path, scene: Path, out: Path, rng: random.Random) -> tuple[list[str], int | str, bytes]:
    """One command on a scene: (command, status, stderr)."""
    method = rng.choice(["none", "0", "1", "2", "2+", "iter:3", "march:4"])
    commands = [
        ["render", "-o", str(out), "--size", "17x9", "--threads", "1", "--shadow", method],
        ["render", "-o", str(out.with_suffix(".exr")), "--size", "5x5", "--threads", "2", "--no-guard",
         "--shadow", method],
        ["pixel", "8,4", "--size", "17x9"],
    ]
    name, *rest = rng.choice(commands)
    command = [str(program), name, str(scene), *rest]
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=60, check=False)
    except subprocess.TimeoutExpired:
        return command, "no answer in 60 s", b""
    if done.returncode == 2 and not done.stderr:
        return command, "status 2 without a message", b""
    return command, done.returncode, done.stderr


def main() -> int:
    parser = argparse.ArgumentParser(description="Change scenes at random and check that kage does not crash.")
    parser.add_argument("--program", type=Path, default=TOP / "build" / "float" / "kage")
    parser.add_argument("--count", type=int, default=1000, help="runs (1000)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, help="repeat this run alone")
    parser.add_argument("--keep", type=Path, default=TOP / "out" / "fuzz", help="where failing scenes go (out/fuzz)")
    options = parser.parse_args()
    options.keep.mkdir(parents=True, exist_ok=True)
    (options.keep / "data").unlink(missing_ok=True)
    (options.keep / "data").symlink_to(TOP / "scenes" / "data")  # the maps, beside the scenes
    originals = [path.read_bytes() for path in sorted((TOP / "scenes").glob("*.yaml"))]
    program = options.program.resolve()
    failed, good = 0, 0
    for number in [options.only] if options.only is not None else range(options.count):
        rng = random.Random(f"{options.seed}:{number}")
        scene = options.keep / f"{options.seed}-{number}.yaml"
        scene.write_bytes(mutated(rng.choice(originals), rng))
        out = options.keep / "out.png"
        command, status, message = run(program, scene, out, rng)
        good += status == 0
        if status in (0, 2):
            scene.unlink()
            continue
        failed += 1
        print(f"run {number}: {status}: {shlex.join(command)}\n{message[-2000:].decode(errors='replace')}", flush=True)
    for path in (options.keep / "out.png", options.keep / "out.exr", options.keep / "data"):
        path.unlink(missing_ok=True)
    print(f"{options.count if options.only is None else 1} runs, {good} pictures, {failed} failures")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
