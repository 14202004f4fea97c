"""Ctrl-C that comes at a moment at which Python would drop it.

What is raised within a __del__ goes nowhere: Python prints it and goes on. Dask's futures have one, which gives other
threads a turn, so that on a busy machine many signals come there.
"""

from __future__ import annotations

import _thread
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

#: Seconds after which what was dropped is raised again: the __del__ has ended then, or it is tried once more.
SOON = 0.05


@contextmanager
def kept() -> Iterator[None]:
    """A KeyboardInterrupt that is dropped in this block is raised again, in the block, in the main thread."""
    before, timers = sys.unraisablehook, list[threading.Timer]()

    def look(dropped: sys.UnraisableHookArgs) -> None:
        if not issubclass(dropped.exc_type, KeyboardInterrupt):
            before(dropped)
            return
        timers.append(threading.Timer(SOON, _thread.interrupt_main))
        timers[-1].start()

    sys.unraisablehook = look
    try:
        yield
    finally:
        sys.unraisablehook = before
        for timer in timers:
            timer.join()
