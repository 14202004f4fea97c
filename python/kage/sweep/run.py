"""Send a sweep's tasks to a Dask cluster, and wait for them: lost workers' tasks are done again by others."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import dask
from distributed import Client, Future, KilledWorker, LocalCluster, as_completed

from kage._kage import ffi, lib
from kage.calls import Call
from kage.sweep import index, interrupts, records
from kage.sweep.errors import SweepError
from kage.sweep.inputs import VERSION, Inputs, digest
from kage.sweep.plan import Picture, Plan, Task
from kage.sweep.records import Record
from kage.sweep.worker import Result, work
from kage.text import bytes_of

#: Above all levels of logging: at the end of a cluster on this machine, Dask calls what is as it should be critical.
SILENT = 60
#: Tasks that wait at the scheduler for each thread of a worker, and at least: so that millions of tasks need no memory
#: there, and no worker ever waits.
AHEAD, LEAST = 20, 200
#: How many workers may die over a task before Dask gives it up (of a cluster that is started here; else 3 is usual),
#: and how often that may be. Then it is likely the task that kills them.
DEATHS, ROUNDS = 10, 3
#: How long a worker that died may take to be there again (of a cluster that is started here). By default Dask gives it
#: up for ever after 15 s, which a busy machine may need to start one.
RETURN = "1 day"
#: Seconds after which a result is asked for again. Where a worker dies in the middle of giving it, Dask may wait for
#: ever.
PATIENCE = 30
#: Seconds after which a scheduler without workers is told of.
SILENCE = 3.0

Note = Callable[[Task, Result], object]


@dataclass
class Done:
    """What a sweep has done."""

    folder: Path
    records: dict[str, Record] = field(default_factory=dict)  # by file
    rendered: int = 0  # tasks, by this run
    found: int = 0  # that were done before
    failed: dict[str, str] = field(default_factory=dict)  # by file: why


@contextmanager
def cluster(scheduler: str | None = None, workers: int | None = None,
            tell: Callable[[str], object] | None = None) -> Iterator[Client]:
    """A client of a scheduler; or of a cluster of processes on this machine, which ends with it.

    tell: called, in another thread, where the scheduler has no workers for some seconds."""
    if scheduler:
        try:
            with Client(scheduler, timeout="20s", set_as_default=False) as client, watched(client, scheduler, tell):
                yield client
        except (OSError, ValueError) as error:
            raise SweepError(f"{scheduler}: no scheduler answers: {error}", 1) from error
        return
    count = workers or len(os.sched_getaffinity(0))
    with dask.config.set({"distributed.scheduler.allowed-failures": DEATHS,
                          "distributed.deploy.lost-worker-timeout": RETURN}), LocalCluster(
        n_workers=count, threads_per_worker=1, processes=True, dashboard_address=":0", silence_logs=SILENT,
        preload="kage.sweep.quiet",
    ) as local, Client(local, set_as_default=False) as client:
        yield client


@contextmanager
def watched(client: Client, scheduler: str, tell: Callable[[str], object] | None) -> Iterator[None]:
    """Tell once where there are no workers. Meanwhile the tasks are sent, as some clusters start workers for them."""
    ended = threading.Event()

    def watch() -> None:
        with suppress(OSError, RuntimeError):  # the scheduler is lost: the tasks tell of that
            if tell and not ended.wait(SILENCE) and not client.nthreads():
                tell(f"waiting for workers at {scheduler}")

    thread = threading.Thread(target=watch, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join(1)


#: A client, or what makes one when it is needed.
Source = Client | Callable[[], AbstractContextManager[Client]]


def run(plan: Plan, client: Source = cluster, *, threads: int = 1, note: Note | None = None) -> Done:
    """Render what is not there yet, and write DIR/index.html, index.csv and index.json.

    client: of a Dask cluster (default: one on this machine, for this call). threads: of one render. note: called for
    each task that is done. A call that is interrupted or fails leaves an index of what there is. Raises a SweepError
    where an input is wrong; pictures that failed otherwise are in `failed`.
    """
    folder = Path(plan.output.folder).resolve()
    with records.locked(folder):
        done = Done(folder)
        left = remaining(plan, done, note or ignore)
        try:
            if left:
                with client() if callable(client) else nullcontext(client) as chosen, interrupts.kept():
                    Sweep(plan, chosen, threads, note or ignore, done).render(left)
        finally:
            index.write(plan, done)
        return done


def ignore(_task: Task, _result: Result) -> None:
    """No note is wanted."""


def remaining(plan: Plan, done: Done, note: Note) -> list[Picture]:
    """The pictures that are not on disk, each without the bands that are."""
    left = []
    for picture in plan.pictures:
        if record := records.find(done.folder, picture.whole.file, picture.whole.identity):
            done.records[record.file] = record
            done.found += max(1, len(picture.bands))
            for task in picture.bands or [picture.whole]:
                note(task, Result(record, found=True))
        else:
            left.append(picture)
    return left


class Sweep:
    """One run on a cluster."""

    def __init__(self, plan: Plan, client: Client, threads: int, note: Note, done: Done) -> None:
        self.plan, self.client, self.note, self.done = plan, client, note, done
        self.options = (None if plan.send else str(done.folder), threads, VERSION)
        self.ahead, self.sent = LEAST, 0
        self.deaths: dict[str, int] = {}
        self.bands: dict[str, Bands] = {}  # by the band's file

    def render(self, pictures: list[Picture]) -> None:
        """All tasks; those that are waiting are cancelled if this is interrupted or fails."""
        waiting = self.due(pictures)
        # A task gives the inputs on, rather than data that is scattered: that a lost worker had, nobody could make
        # again.
        inputs = self.client.submit(give, self.plan.inputs, key=f"kage-inputs-{self.plan.inputs.digest}")
        running: dict[Future[Any], Task] = {}
        ended = as_completed(loop=self.client.loop)
        try:
            self.fill(ended, waiting, running, inputs)
            for future in ended:
                task = running.pop(future)
                if self.finish(future, task):
                    running[future] = task
                    ended.add(future)
                self.fill(ended, waiting, running, inputs)
        finally:
            if running:
                self.client.cancel(list(running), force=True)

    def due(self, pictures: list[Picture]) -> Iterator[Task]:
        """The tasks that are not done. A picture whose bands are all there is joined when it is its turn."""
        for picture in pictures:
            bands = Bands(picture, {})
            for task in picture.bands or [picture.whole]:
                self.bands[task.file] = bands
                if record := records.find(self.done.folder, task.file, task.identity):
                    self.take(task, Result(record, found=True))
                else:
                    yield task

    def fill(self, ended: Any, waiting: Iterator[Task], running: dict[Future[Any], Task], inputs: Future[Any]) -> None:
        threads = sum(self.client.nthreads().values()) if not running else 0
        self.ahead = max(LEAST, AHEAD * threads) if threads else self.ahead
        while len(running) < self.ahead and (task := next(waiting, None)):
            self.sent += 1
            key, order = f"kage-{task.identity}", -self.sent
            future = self.client.submit(work, inputs, task, *self.options, key=key, priority=order)
            running[future] = task
            ended.add(future)

    def finish(self, future: Future[Any], task: Task) -> bool:
        """Take a task's result. True: it is to be done again."""
        if future.status == "cancelled":
            raise SweepError("the scheduler has been lost, or has cancelled the tasks", 1)
        if future.status == "finished":
            result = self.result(future, task)
            if result:
                self.take(task, result)
            return result is None
        if future.status != "error":  # its result has gone with a worker: Dask does it again
            return True
        error = future.exception()
        if isinstance(error, KilledWorker):
            self.deaths[task.file] = self.deaths.get(task.file, 0) + 1
            if self.deaths[task.file] < ROUNDS:
                future.retry()
                return True
            error = SweepError("again and again the worker died that rendered it, perhaps for lack of memory")
        if isinstance(error, ImportError):
            raise SweepError(f"a worker can't import the package: {error}", 1)
        self.take(task, Result(None, f"{task.file}: {error}", 1))
        return False

    def result(self, future: Future[Any], task: Task) -> Result | None:
        """A result, which the disk has, too, where the folder is shared. None: it has gone with its worker."""
        record = None if self.plan.send else records.find(self.done.folder, task.file, task.identity)
        if record:
            return Result(record)
        try:
            found: Result = future.result(timeout=PATIENCE)
        except (TimeoutError, CancelledError):
            return None
        return found

    def take(self, task: Task, result: Result) -> None:
        """A task is done or has failed. What fails for its inputs ends the sweep, as the others would fail, too."""
        if result.status == 2:
            raise SweepError(result.wrong)
        if result.record is None:
            self.done.failed[task.file] = result.wrong
        else:
            if result.data is not None:
                records.replace(self.done.folder / task.file, result.data)
                records.keep(self.done.folder, result.record)
            self.done.found += result.found
            self.done.rendered += not result.found
            self.bands[task.file].add(self.done, result.record)
        self.note(task, result)


@dataclass
class Bands:
    """A picture's bands that are done; of a picture that is one task, that task."""

    picture: Picture
    records: dict[str, Record]

    def add(self, done: Done, record: Record) -> None:
        """Join them after the last one."""
        whole, bands = self.picture.whole, self.picture.bands
        self.records[record.file] = record
        if not bands:
            done.records[record.file] = record
        elif len(self.records) == len(bands):
            made = join(done.folder, whole, [self.records[band.file] for band in bands])
            done.records[whole.file] = made


def join(folder: Path, whole: Task, bands: list[Record]) -> Record:
    """The picture's file from those of its bands, which then go."""
    call = Call()
    paths = [ffi.new("char[]", bytes_of(folder / band.file)) for band in bands]
    call.check(lib.kage_file_join(ffi.new("char *[]", paths), len(paths), bytes_of(folder / whole.file), ffi.NULL,
                                  call.errors))
    counts = {name: sum(band.stats[name] for band in bands) if isinstance(value, int | float) else value
              for name, value in bands[0].stats.items()}
    path = folder / whole.file
    record = Record(whole.file, whole.identity, digest(path), path.stat().st_size,
                    round(sum(band.seconds for band in bands), 4), counts, bands[0].worker)
    records.keep(folder, record)
    for band in bands:
        records.drop(folder, band.file)
    return record


def give(inputs: Inputs) -> Inputs:
    """A task that passes its argument on."""
    return inputs
