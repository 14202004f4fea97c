"""What a worker does with one task. It may be done again at any time: what is done is found, not rendered."""

from __future__ import annotations

import dataclasses
import hashlib
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import kage
from kage.sweep import records
from kage.sweep.errors import SweepError
from kage.sweep.inputs import VERSION, Inputs
from kage.sweep.plan import Task, scene_of
from kage.sweep.records import Record


@dataclass(frozen=True)
class Result:
    """What comes back from a worker: a record, or what is wrong."""

    record: Record | None
    wrong: str = ""
    status: int = 0  # of the program: 2 for wrong input, else 1
    found: bool = False  # it was done already
    data: bytes | None = field(default=None, repr=False)  # the picture, where no folder is shared


def work(inputs: Inputs, task: Task, folder: str | None, threads: int, version: str) -> Result:
    """Render a task into a folder that all share, or give the picture back where that is None."""
    try:
        if version != VERSION:
            raise SweepError(f"kage {VERSION} at {records.worker_name()}, {version} where the sweep was started", 1)
        return give_back(inputs, task, threads) if folder is None else share(inputs, task, Path(folder), threads)
    except SweepError as error:
        return Result(None, str(error), error.status)
    except (kage.InputError, kage.OptionError) as error:
        return Result(None, str(error), 2)
    except (kage.KageError, OSError) as error:
        return Result(None, f"{task.file}: {error}", 1)


def give_back(inputs: Inputs, task: Task, threads: int) -> Result:
    with tempfile.TemporaryDirectory(prefix="kage-sweep-") as made:
        record = render(inputs, task, Path(made), threads)
        return Result(record, data=(Path(made) / task.file).read_bytes())


def share(inputs: Inputs, task: Task, folder: Path, threads: int) -> Result:
    if found := records.find(folder, task.file, task.identity):
        return Result(found, found=True)
    if not (folder / records.FOLDER).is_dir():
        raise SweepError(f"{folder}: not there at {records.worker_name()}; --send sends pictures back", 1)
    records.log(folder, "begin", task.file)
    record = render(inputs, task, folder, threads)
    records.keep(folder, record)
    records.log(folder, "end", task.file)
    return Result(record)


def render(inputs: Inputs, task: Task, folder: Path, threads: int) -> Record:
    """Render and write one picture; the file appears whole."""
    start = time.monotonic()
    path = folder / task.file
    layers = task.file.endswith(".exr") and task.layers != "color"
    picture = scene_of(inputs, task).render(
        size=task.size, crop=task.crop, layers=layers, threads=threads, progress=False
    )
    written: Any = {"bits": task.bits} if task.bits else {"layers": task.layers} if task.layers else {}
    picture.save(path, threads=threads, progress=False, **written)
    data = path.read_bytes()
    counts = {name: value for name, value in dataclasses.asdict(picture.stats).items() if not isinstance(value, tuple)}
    return Record(task.file, task.identity, hashlib.sha256(data).hexdigest(), len(data),
                  round(time.monotonic() - start, 4), counts, records.worker_name())
