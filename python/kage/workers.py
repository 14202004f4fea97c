"""Threads that make calls of the library while another thread waits, which so can be interrupted at any moment.

Python sees Ctrl-C between two of its own steps only, and a call of the library is one step. So the call is made by a
worker; the caller waits for it, hears of its progress, and leaves it behind where it must. A worker that has ended its
call waits for the next one: the library's own threads are kept with it.
"""

from __future__ import annotations

import atexit
import os
import threading
from collections.abc import Callable
from queue import SimpleQueue
from typing import Generic, TypeVar

T = TypeVar("T")

#: Seconds after which the caller looks again.
STEP = 0.05

#: Seconds after which what a worker was told to stop, and did not, is left behind.
PATIENCE = 0.1

#: Seconds that a program which ends waits for what was left behind and writes files, so that no unfinished one stays.
LAST_PATIENCE = 3.0


class Job(Generic[T]):
    """A function that a worker calls, and what came of it."""

    def __init__(self, function: Callable[[], T]) -> None:
        self.function: Callable[[], T] | None = function
        self.ended = False
        self.running = threading.Lock()
        self.running.acquire()
        self.values: list[T] = []
        self.raised: BaseException | None = None
        self.wanted = True

    def __call__(self) -> None:
        try:
            if self.function is not None:
                value = self.function()
                if self.wanted:
                    self.values.append(value)
        except BaseException as raised:  # noqa: BLE001 - raised again where the caller waits
            self.raised = raised
        finally:
            self.function = None  # and what it holds
            self.ended = True
            self.running.release()

    def wait(self, seconds: float) -> bool:
        """Whether it has ended. Ctrl-C may come at any moment: an Event, which has a lock in Python, would at some turn
        it into a RuntimeError. A lock that is taken and not given back does no harm here.
        """
        if not self.ended and self.running.acquire(timeout=seconds):
            self.running.release()
        return self.ended

    def value(self) -> T:
        if self.raised is not None:
            raised, self.raised = self.raised, None
            raise raised
        return self.values.pop()


class Worker:
    """A thread that calls one job after the other."""

    def __init__(self) -> None:
        self.jobs: SimpleQueue[Callable[[], None]] = SimpleQueue()
        threading.Thread(target=self.work, name="kage", daemon=True).start()

    def work(self) -> None:
        while True:
            self.jobs.get()()  # without a name, which would keep the job until the next one


idle: list[Worker] = []
left: list[Job[object]] = []


def run(function: Callable[[], T], look: Callable[[], object], stop: Callable[[], object], files: bool) -> T:
    """function(), called by a worker. look() is called here 20 times a second. Where that, or Ctrl-C, raises something,
    stop() tells the call to end, and it is left behind unless it does so soon. files: whether it writes some.
    """
    try:
        worker = idle.pop()
    except IndexError:
        worker = Worker()
    job = Job(function)
    try:
        worker.jobs.put(job)
        while not job.wait(STEP):
            look()
        look()
    except BaseException:
        stop()
        if not job.wait(PATIENCE):
            job.wanted = False
            left[:] = [other for other in left if not other.ended]
            if files:
                left.append(job)  # type: ignore[arg-type]
            raise
        idle.append(worker)
        raise
    idle.append(worker)
    return job.value()


def wait_for_left() -> None:
    for job in left:
        job.wait(LAST_PATIENCE)


atexit.register(wait_for_left)
os.register_at_fork(after_in_child=idle.clear)  # a child has none of its parent's threads
