"""What is on disk: each picture has a record beside it, so that the same command goes on where it was.

    DIR/.kage-sweep/FILE.json       written whole after the picture is: its identity, digest, counts and time
    DIR/.kage-sweep/HOST-PID.log    of one worker: a line when a picture is begun, and one when it is done

A picture is done if its record has the task's identity and the file has the record's digest.
"""

from __future__ import annotations

import dataclasses
import fcntl
import hashlib
import json
import os
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from kage.sweep.errors import SweepError

FOLDER = ".kage-sweep"


@dataclasses.dataclass(frozen=True)
class Record:
    """Of one finished picture."""

    file: str
    identity: str
    digest: str  # SHA-256 of the file
    size: int  # bytes
    seconds: float  # that the task took
    stats: dict[str, Any]  # kage.Picture.stats without stages and orders
    worker: str  # host and process


def worker_name() -> str:
    return f"{socket.gethostname()}-{os.getpid()}"


def path_of(folder: Path, file: str) -> Path:
    return folder / FOLDER / f"{file}.json"


def find(folder: Path, file: str, identity: str) -> Record | None:
    """The record of a picture that is done, whole and of the same inputs."""
    try:
        record = Record(**json.loads(path_of(folder, file).read_text(encoding="utf-8")))
        if record.identity != identity or (folder / file).stat().st_size != record.size:
            return None
        with (folder / file).open("rb") as picture:
            same = hashlib.file_digest(picture, "sha256").hexdigest() == record.digest
    except (OSError, ValueError, TypeError):
        return None
    return record if same else None


def keep(folder: Path, record: Record) -> None:
    """On the disk when this returns."""
    path = path_of(folder, record.file)
    path.parent.mkdir(parents=True, exist_ok=True)
    replace(path, (json.dumps(dataclasses.asdict(record)) + "\n").encode())


def drop(folder: Path, file: str) -> None:
    """A picture and its record."""
    path_of(folder, file).unlink(missing_ok=True)
    (folder / file).unlink(missing_ok=True)


def replace(path: Path, data: bytes) -> None:
    """Write a file whole or not at all."""
    aside = path.with_name(f"{path.name}.{worker_name()}.new")
    try:
        with aside.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        aside.replace(path)
    finally:
        aside.unlink(missing_ok=True)


def log(folder: Path, event: str, file: str) -> None:
    """Each process has a log of its own, so that lines never mix, also on network file systems."""
    line = json.dumps({"event": event, "file": file, "time": round(time.time(), 3)})
    with (folder / FOLDER / f"{worker_name()}.log").open("a", encoding="utf-8") as to:
        to.write(line + "\n")


def read_logs(folder: Path) -> list[dict[str, Any]]:
    """All lines of all workers. A line that was cut short by a kill is left out."""
    found = []
    for path in sorted((folder / FOLDER).glob("*.log")):
        for line in path.read_text(encoding="utf-8").splitlines():
            try:
                found.append({**json.loads(line), "worker": path.stem})
            except ValueError:
                continue
    return found


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """One sweep at a time writes to a folder."""
    try:
        (folder / FOLDER).mkdir(parents=True, exist_ok=True)
        file = (folder / FOLDER / "lock").open("a")
    except OSError as error:
        raise SweepError(f"{folder}: can't be written: {error.strerror}", 1) from error
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise SweepError(f"{folder}: another sweep is writing there", 1) from error
        yield
