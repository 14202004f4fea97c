"""Calls of the library that last: their progress, Ctrl-C, and what they fail with.

cffi lets go of Python's lock (the GIL) for the time of each call, so that other threads go on. progress.h in C calls
`kage_py_listen` for a new step and then 20 times a second, which takes the lock for a moment. In the main thread that
is where Python sees Ctrl-C: KeyboardInterrupt is raised inside, ends the call, and is raised again from it.
"""

from __future__ import annotations

from collections.abc import Callable
from types import TracebackType
from typing import Any

from kage._kage import ffi, lib
from kage.errors import raise_errors

#: What hears how far a call is: the step ("reading", "rendering", ...) and how much of it is done, 0..1.
Listener = Callable[[str, float], object]


class Call:
    """One call of the library that may last."""

    def __init__(self, listener: Listener | None = None) -> None:
        self.listener = listener
        self.raised: BaseException | None = None
        self.errors = ffi.new("kage_errors **")
        self.handle = ffi.new_handle(self)
        #: For an options struct.
        self.user = ffi.new("kage_py_call *", {"handle": self.handle})
        self.progress = ffi.addressof(lib, "kage_py_progress")

    def check(self, status: int) -> None:
        """Raise what has ended the call, if anything."""
        if self.raised is not None:
            raised, self.raised = self.raised, None
            raise raised
        if status != lib.KAGE_OK:
            raise_errors(status, self.errors)


def _note(_kind: type[BaseException], raised: BaseException, traceback: TracebackType | None) -> None:
    """What was raised while listening waits for the end of the call."""
    if traceback is not None:
        call = ffi.from_handle(traceback.tb_frame.f_locals["handle"])
        call.raised = raised


@ffi.def_extern(error=1, onerror=_note)  # type: ignore[untyped-decorator]
def kage_py_listen(handle: Any, what: Any, share: float) -> int:
    call = ffi.from_handle(handle)
    if call.listener is not None:
        call.listener(ffi.string(what).decode(), share)
    return 0
