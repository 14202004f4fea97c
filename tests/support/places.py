"""Places where kage can't write: a small disk, one that is mounted to be read only, a folder without permission.

A real disk needs the right to mount one, which a container may lack: then a library stands in (failing_calls.c).
"""

from __future__ import annotations

import errno
import functools
import os
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.conftest import PROGRAM
from tests.support.failing import OLDER

#: $1: the disk's size, $2: rw or ro, once it has the older files; $3 ...: the command. What it leaves is in after/.
IN_DISK = """\
mount -t tmpfs -o "size=$1" none disk && cp -R older/. disk || exit 99
test "$2" = rw || mount -o "remount,bind,$2" disk || exit 99
shift 2
(cd disk && exec "$@")
status=$?
cp -R disk/. after
exit $status
"""


@dataclass(frozen=True)
class Done:
    """How a command ended, and what was in its folder then."""

    status: int
    said: str
    folder: Path

    def files(self) -> dict[str, bytes]:
        return {path.name: path.read_bytes() for path in self.folder.iterdir()}


@functools.cache
def may_mount() -> tuple[str, ...]:
    """The command that gives another one the right to mount; (): there is none."""
    for words in (("unshare", "-rm"), ("unshare", "-m")):
        with tempfile.TemporaryDirectory() as folder:
            if subprocess.run([*words, "mount", "-t", "tmpfs", "none", folder], capture_output=True).returncode == 0:
                return words
    return ()


def run(folder: Path, command: Sequence[object], **more: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(list(map(str, command)), cwd=folder, env=os.environ | more, capture_output=True, text=True,
                          timeout=120, check=False)


def on_disk(folder: Path, size: str, then: str, command: Sequence[object], older: Sequence[str]) -> Done:
    """Run kage on a disk of its own."""
    for name in ("disk", "older", "after"):
        (folder / name).mkdir()
    for name in older:
        (folder / "older" / name).write_bytes(OLDER)
    done = run(folder, [*may_mount(), "sh", "-c", IN_DISK, "sh", size, then, PROGRAM, *command])
    assert done.returncode != 99, done.stderr
    return Done(done.returncode, done.stderr, folder / "after")


def on_small_disk(folder: Path, pages: int, command: Sequence[object], older: Sequence[str]) -> Done:
    return on_disk(folder, f"{4 * pages}k", "rw", command, older)


def where_writes_fail(folder: Path, library: Path, after: int, command: Sequence[object],
                      older: Sequence[str]) -> Done:
    """As on a disk that is full after some writes of kage's own."""
    for name in older:
        (folder / name).write_bytes(OLDER)
    done = run(folder, [PROGRAM, *command], LD_PRELOAD=str(library), FAIL_CALL="write", FAIL_AT=str(after + 1),
               FAIL_ERRNO=str(errno.ENOSPC), FAIL_ON="1", FAIL_IN=PROGRAM.name)
    return Done(done.returncode, done.stderr, folder)


def on_read_only_disk(folder: Path, command: Sequence[object], older: Sequence[str]) -> Done:
    return on_disk(folder, "40k", "ro", command, older)


def without_permission(folder: Path, command: Sequence[object], older: Sequence[str]) -> Done:
    """In a folder that the user may not change; who may nevertheless, as root, loses that right."""
    place = folder / "closed"
    place.mkdir()
    for name in older:
        (place / name).write_bytes(OLDER)
    place.chmod(0o555)
    bound = ("setpriv", "--bounding-set", "-dac_override") if os.access(place, os.W_OK) else ()
    done = run(place, [*bound, PROGRAM, *command])
    place.chmod(0o755)
    return Done(done.returncode, done.stderr, place)


def remove(folder: Path) -> None:
    """Also while another process makes files in it."""
    while folder.exists():
        shutil.rmtree(folder, ignore_errors=True)
