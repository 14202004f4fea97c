"""The files of the source tree: those under version control, or all of an unpacked source archive (`make dist`)."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent

#: Folders that builds, tests and tools make; .gitignore names them, too.
MADE = {"build", "out", ".venv", "__pycache__", ".pytest_cache", ".mypy_cache", ".ruff_cache"}


def is_repository(top: Path = TOP) -> bool:
    """Whether `top` is a working tree of its own, not a folder within another project's."""
    return (top / ".git").exists()


def git(*words: str, top: Path = TOP) -> bytes:
    return subprocess.run(["git", *words], cwd=top, check=True, capture_output=True).stdout


def names(top: Path = TOP) -> list[str]:
    """The files by their paths from the top, sorted; in a repository also those that are new and not ignored."""
    if is_repository(top):
        listed = git("ls-files", "-z", "-co", "--exclude-standard", top=top).decode().split("\0")
        return sorted(name for name in set(listed) if name and (top / name).is_file())
    found = []
    for folder, folders, files in os.walk(top):
        folders[:] = [name for name in folders if name not in MADE]
        found += [(Path(folder) / name).relative_to(top).as_posix() for name in files]
    return sorted(found)
