"""What a sweep fails with."""

from __future__ import annotations


class SweepError(Exception):
    """Why a sweep can't go on. `status` is the program's exit status: 2 for wrong input, else 1."""

    def __init__(self, message: str, status: int = 2) -> None:
        super().__init__(message)
        self.status = status
