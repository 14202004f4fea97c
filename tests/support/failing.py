"""Runs a command whose n-th call of one of the system's functions fails (failing_calls.c)."""

from __future__ import annotations

import errno
import os
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tests.conftest import PROGRAM
from tests.support.stops import left_over

#: The functions, and with what each fails. 0: it does only one byte.
FAILURES = {"open": (errno.EACCES, errno.EIO), "write": (errno.ENOSPC, errno.EIO, errno.EINTR, 0),
            "read": (errno.EIO, errno.EINTR, 0), "pread": (errno.EIO, errno.EINTR, 0), "close": (errno.EIO,),
            "rename": (errno.EIO, errno.ENOSPC), "linkat": (errno.EIO, errno.ENOSPC), "ftruncate": (errno.EIO,),
            "lseek": (errno.EIO,)}

#: Errors in words: status 1 or 2; never a signal.
ENDED = (0, 1, 2)

OLDER = b"an older good file"


@dataclass(frozen=True)
class Failure:
    """What happened when a call failed."""

    call: str
    at: int
    code: int
    status: int
    said: str
    wrong: tuple[str, ...]


def preloaded(source: Path, folder: Path) -> Path:
    """A library for LD_PRELOAD, of a file in C."""
    made = folder / f"{source.stem}.so"
    subprocess.run([os.environ.get("CC", "cc").split()[-1], "-O1", "-fno-builtin", "-shared", "-fPIC", "-o", made,
                    source, "-ldl"], check=True)
    return made


def make_library(folder: Path) -> Path:
    return preloaded(Path(__file__).with_name("failing_calls.c"), folder)


def fail(command: list[str], output: str, folder: Path, library: Path, call: str, at: int,
         code: int) -> Failure | None:
    """Run the command over an older output. None: it has fewer such calls."""
    log, target = folder / "failed.log", folder / output
    log.unlink(missing_ok=True)
    target.write_bytes(OLDER)
    environment = os.environ | {"LD_PRELOAD": str(library), "FAIL_CALL": call, "FAIL_AT": str(at),
                                "FAIL_ERRNO": str(code), "FAIL_LOG": str(log)}
    done = subprocess.run([str(PROGRAM), *command], cwd=folder, env=environment, capture_output=True, text=True,
                          timeout=120, check=False)
    if not log.exists():
        return None
    wrong = []
    if done.returncode not in ENDED:
        wrong.append(f"status {done.returncode}")
    if done.returncode == 0 and target.read_bytes() == OLDER:
        wrong.append("status 0, and nothing written")
    if done.returncode and target.read_bytes() != OLDER:
        wrong.append("the older file is lost")
    if done.returncode and not done.stderr.strip():
        wrong.append("fails without a word")
    if code in (0, errno.EINTR) and call in ("read", "write", "pread") and done.returncode:
        wrong.append("a short or interrupted call is no error")
    wrong += [f"left {name}" for name in left_over(folder)]
    return Failure(call, at, code, done.returncode, done.stderr, tuple(wrong))


def fail_each(command: list[str], output: str, folder: Path, library: Path, most: int) -> Iterator[Failure]:
    """Let each call fail in turn, of each function the first `most`."""
    for call, codes in FAILURES.items():
        for code in codes:
            for at in range(1, most + 1):
                found = fail(command, output, folder, library, call, at, code)
                if not found:
                    break
                yield found
