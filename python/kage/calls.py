"""Calls of the library: their progress, Ctrl-C, and what they fail with.

cffi lets go of Python's lock (the GIL) for the time of each call, so that other threads go on. A call that is made in
the main thread, or whose progress is wanted, is made by a worker (workers.py).
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

from kage import workers
from kage._kage import ffi, lib
from kage.errors import raise_errors

#: What hears how far a call is: the step ("reading", "rendering", ...) and how much of it is done, 0..1.
Listener = Callable[[str, float], object]
#: Seconds after which a listener is told the same again, so that a bar shows the time, and a listener may end the call.
AGAIN = 0.25


class Call:
    """One call of the library."""

    def __init__(self, listener: Listener | None = None) -> None:
        self.listener = listener
        self.told: tuple[str, float] = ("", 0.0)
        self.told_at = 0.0
        self.errors = ffi.new("kage_errors **")
        #: For an options struct.
        self.user = ffi.new("kage_py_call *")
        lib.kage_py_begin(self.user)
        self.progress = ffi.addressof(lib, "kage_py_progress")

    def run(self, function: Callable[[], int], *, files: bool = False) -> None:
        """Make the call: `function` does, and returns its kage_status. Ctrl-C and what the listener raises end it.

        files: it writes some, so that a program which ends should wait until none is left unfinished.
        """
        self.make(function, files=files)

    def make(self, function: Callable[[], int], made: Any = None, free: Any = None, *, files: bool = False) -> Any:
        """The same of a call that makes something, which it stores in *made and `free` frees."""
        def body() -> tuple[int, Any]:
            status = function()
            return status, ffi.gc(made[0], free) if made is not None and made[0] else None

        if self.listener is None and threading.current_thread() is not threading.main_thread():
            status, owned = body()  # Ctrl-C is for the main thread
        else:
            status, owned = workers.run(body, self.look, lambda: lib.kage_py_stop(self.user), files)
        self.check(status)
        return owned

    def look(self) -> None:
        """Tell the listener, if there is something new, or it has heard nothing for long."""
        if self.listener is None:
            return
        what = ffi.new("char[24]")
        share = lib.kage_py_look(self.user, what)
        now, clock = (ffi.string(what).decode(), share), time.monotonic()
        if now[0] and (now != self.told or clock - self.told_at > AGAIN):
            self.told, self.told_at = now, clock
            self.listener(*now)

    def check(self, status: int) -> None:
        """Raise what the library says is wrong."""
        if status != lib.KAGE_OK:
            raise_errors(status, self.errors)
