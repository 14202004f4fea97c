"""The results, kept as they come: a file of JSON lines that only grows.

Each line is one finished job: its name, what it depends on (`inputs`), the date, the commit, the seconds it took, and
its value. A job that has a line with the same inputs is not done again. A line that a crash cut short is skipped: its
job was not finished.
"""

from __future__ import annotations

import fcntl
import json
import os
from pathlib import Path
from typing import IO

Inputs = dict[str, object]
Value = dict[str, object]


class StoreError(Exception):
    """Why the results can't be kept."""


def parse(line: str) -> dict[str, object] | None:
    """A line's record; None where the line is cut short or not a result."""
    try:
        record = json.loads(line)
    except ValueError:
        return None
    good = isinstance(record, dict) and isinstance(record.get("job"), str) and {"inputs", "value"} <= record.keys()
    return record if good else None


def key(job: object, inputs: object) -> str:
    return json.dumps([job, inputs], sort_keys=True)


class Store:
    """Open for one bench at a time. Close it, or use it as a context."""

    def __init__(self, path: Path) -> None:
        self.records: dict[str, dict[str, object]] = {}
        path.parent.mkdir(parents=True, exist_ok=True)
        self.file: IO[str] = path.open("a+", encoding="utf-8", errors="replace")
        try:
            fcntl.flock(self.file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            self.file.close()
            raise StoreError(f"{path}: another bench is writing its results there") from error
        self.file.seek(0)
        text = self.file.read()
        for line in text.splitlines():
            record = parse(line)
            if record:
                self.records[key(record["job"], record["inputs"])] = record
        if text and not text.endswith("\n"):
            self.file.write("\n")

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *exc: object) -> None:
        self.file.close()

    def get(self, job: str, inputs: Inputs) -> Value | None:
        """The value of a finished job with these inputs."""
        record = self.records.get(key(job, inputs))
        value = record and record["value"]
        return value if isinstance(value, dict) else None

    def add(self, record: dict[str, object]) -> None:
        """The record is on the disk when this returns."""
        line = json.dumps(record, sort_keys=True)
        self.file.write(line + "\n")
        self.file.flush()
        os.fsync(self.file.fileno())
        self.records[key(record["job"], record["inputs"])] = json.loads(line)  # as when read: tuples become lists
