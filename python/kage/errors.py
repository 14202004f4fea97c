"""Exceptions: the library's lists of errors, raised."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from kage._kage import ffi, lib
from kage.text import text_of


@dataclass(frozen=True)
class Error:
    """One thing that is wrong, and where."""

    file: str | None  #: the scene's file, or "--set" for a change; None: not in a file
    line: int  #: from 1; 0 without a file
    column: int  #: from 1, in characters; 0 without a file
    text: str  #: what is wrong and what was expected, in one line
    message: str  #: `file:line:column: text`, then the line of the file and a caret


class KageError(Exception):
    """Something that kage could not do. Its attributes are those of the first error; `errors` has all that were found.

    A scene with several mistakes names all of them at once. (Of very many only the first are listed; `found` counts
    them all.)
    """

    def __init__(self, message: str, errors: tuple[Error, ...] = (), found: int = 0) -> None:
        super().__init__(message)
        first = errors[0] if errors else Error(None, 0, 0, message, message)
        self.errors = errors or (first,)
        self.found = found or len(self.errors)
        self.file, self.line, self.column, self.text = first.file, first.line, first.column, first.text


class InputError(KageError, ValueError):
    """The scene, or a file that it names, is wrong or can't be read."""


class OptionError(KageError, ValueError):
    """An option or argument of the call is wrong."""


class OutputError(KageError, OSError):
    """The output can't be written."""


class NoMemoryError(KageError, MemoryError):
    """There is not enough memory."""


class OutOfTimeError(KageError, TimeoutError):
    """It takes more than `Limits.seconds`."""


def exceptions() -> dict[int, type[KageError]]:
    """The exception of each kage_status that is a failure."""
    return {
        lib.KAGE_BAD_INPUT: InputError,
        lib.KAGE_BAD_OPTION: OptionError,
        lib.KAGE_NOT_WRITTEN: OutputError,
        lib.KAGE_NO_MEMORY: NoMemoryError,
        lib.KAGE_OUT_OF_TIME: OutOfTimeError,
    }


def raise_errors(status: int, errors: Any) -> None:
    """Raise what the library says; `errors` is a kage_errors **, whose list is freed."""
    listed, found = taken(errors)
    more = [f"... and {found - len(listed)} more"] if found > len(listed) else []
    message = "\n".join([error.message for error in listed] + more) or "not enough memory"
    raise exceptions()[status](message, listed, found)


def taken(errors: Any) -> tuple[tuple[Error, ...], int]:
    """The errors of a list, and how many were found. The list is freed."""
    owned = ffi.gc(errors[0], lib.kage_errors_free)
    if not owned:
        return (), 0
    entries = (lib.kage_errors_get(owned, index) for index in range(lib.kage_errors_count(owned)))
    listed = tuple(
        Error(text_of(entry.file), entry.line, entry.column, text_of(entry.text) or "", text_of(entry.message) or "")
        for entry in entries
    )
    return listed, int(lib.kage_errors_found(owned))
