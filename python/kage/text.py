"""Texts of C."""

from __future__ import annotations

import os
from typing import Any

from kage._kage import ffi


def text_of(value: Any) -> str | None:
    """A const char * as str, NULL as None. Names of files come back as os.fsencode made them."""
    return os.fsdecode(ffi.string(value)) if value else None


def bytes_of(value: str | os.PathLike[str] | None) -> Any:
    """For a const char * of an argument: None is NULL."""
    if value is None:
        return ffi.NULL
    text = os.fsencode(value)
    if b"\0" in text:
        raise ValueError("embedded null byte")  # as open() says; in C the text would end there
    return text
