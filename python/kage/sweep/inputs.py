"""What a sweep reads: the scene's text and the files that it names, which workers on other machines must have, too.

The text travels with the tasks, so that a change of the file meanwhile changes nothing. The files are read from the
scene's folder, which the workers share; each looks once whether they are the same there. Or they travel as well.
"""

from __future__ import annotations

import functools
import hashlib
import json
import os
import socket
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePath
from typing import Any

import yaml

import kage
from kage.sweep.errors import SweepError

#: What the bytes of a picture depend on besides the inputs.
VERSION = f"{kage.__version__} {kage.PRECISION}"


@dataclass(frozen=True)
class File:
    """A file that the scene names."""

    name: str  # as the scene has it
    digest: str
    data: bytes | None = field(default=None, repr=False)  # where it travels


@dataclass(frozen=True)
class Inputs:
    """A scene and its files."""

    name: str  # of the scene's file, without folders
    text: str = field(repr=False)
    folder: str  # of the scene's file; workers read other files from there
    files: tuple[File, ...]
    digest: str

    @staticmethod
    def read(scene: Path, values: Iterable[str] = (), send: bool = False) -> Inputs:
        """The scene in a file. values: of changes, which may name files, too. send: the files are to travel."""
        try:
            text = scene.read_text(encoding="utf-8")
            folder = scene.resolve().parent
            files = tuple(read_file(folder, name, send) for name in named_files(folder, [text, *values]))
        except (OSError, UnicodeDecodeError) as error:
            raise SweepError(f"{scene}: can't be read: {error}") from error
        about = [scene.name, text, *([file.name, file.digest] for file in files)]
        return Inputs(scene.name, text, str(folder), files, hashlib.sha256(json.dumps(about).encode()).hexdigest())

    def load(self, sets: Mapping[str, str]) -> kage.Scene:
        """Read the scene with changes, here."""
        return kage.load(self.text, sets=sets, folder=here(self), name=self.name, threads=1, progress=False)


def read_file(folder: Path, name: str, send: bool) -> File:
    if send and PurePath(name).is_absolute():
        raise SweepError(f"{name}: a file that is to be sent must be named from the scene's folder on")
    data = (folder / name).read_bytes() if send else None
    return File(name, digest(folder / name), data)


def digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


# Which files a scene names --------------------------------------------------------------------------


def named_files(folder: Path, texts: Iterable[str]) -> list[str]:
    """Every text in the YAML that is the name of a file, and the buffers of glTF files. One too many does no harm."""
    names = dict.fromkeys(name for text in texts for name in strings(parsed(text)) if is_file(folder, name))
    for name in [name for name in names if name.endswith(".gltf")]:
        beside = [str(PurePath(name).parent / uri) for uri in buffers(folder / name)]
        names |= dict.fromkeys(other for other in beside if is_file(folder, other))
    return sorted(names)


def parsed(text: str) -> Any:
    try:
        return yaml.safe_load(text)
    except yaml.YAMLError:
        return None  # kage says what is wrong


def strings(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        for part in value.values():
            yield from strings(part)
    elif isinstance(value, list):
        for part in value:
            yield from strings(part)


def is_file(folder: Path, name: str) -> bool:
    try:
        return bool(name) and (folder / name).is_file()
    except (OSError, ValueError):  # too long for a name; or with a zero
        return False


def buffers(path: Path) -> list[str]:
    try:
        return [buffer["uri"] for buffer in json.loads(path.read_bytes())["buffers"] if "uri" in buffer]
    except (OSError, ValueError, KeyError, TypeError):
        return []  # kage says what is wrong


# At the worker --------------------------------------------------------------------------------------

#: The folders of files that have travelled here, by digest; they go with the process.
_unpacked: dict[str, tempfile.TemporaryDirectory[str]] = {}


def here(inputs: Inputs) -> Path:
    """The folder from which the scene's files are read in this process."""
    sent = any(file.data is not None for file in inputs.files)
    return unpack(inputs) if sent else checked(inputs)


@functools.lru_cache(maxsize=8)
def checked(inputs: Inputs) -> Path:
    """That the shared files are the sender's."""
    for file in inputs.files:
        path = Path(inputs.folder) / file.name
        host = socket.gethostname()
        try:
            same = digest(path) == file.digest
        except OSError as error:
            raise SweepError(f"{path}: can't be read at {host}: {error.strerror}; --send sends files along") from error
        if not same:
            raise SweepError(f"{path}: at {host} it is another file than where the sweep was started, or has changed")
    return Path(inputs.folder)


def unpack(inputs: Inputs) -> Path:
    """Write the files that have travelled, once. `..` stays within the folder that is made."""
    ups = max((PurePath(os.path.normpath(file.name)).parts.count("..") for file in inputs.files), default=0)
    if inputs.digest not in _unpacked:
        made = tempfile.TemporaryDirectory(prefix="kage-sweep-")
        for file in inputs.files:
            path = Path(os.path.normpath(Path(made.name, *["x"] * ups, file.name)))
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(file.data or b"")
        Path(made.name, *["x"] * ups).mkdir(parents=True, exist_ok=True)
        _unpacked[inputs.digest] = made
    return Path(_unpacked[inputs.digest].name, *["x"] * ups)
