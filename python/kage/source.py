"""What a scene is read from: a path, a text, or a dict, which becomes JSON; and the values of changes."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from kage._kage import lib
from kage.arrays import Arrays
from kage.errors import OptionError
from kage.text import bytes_of

#: A path, a text of YAML, or a dict with the keys of docs/scene.md.
Source = str | os.PathLike[str] | Mapping[str, Any]


class Text:
    """A scene's text, or its file."""

    def __init__(self, source: Source, folder: str | os.PathLike[str] | None, name: str | None,
                 arrays: Arrays) -> None:
        self.path: str | os.PathLike[str] | None = None
        self.text = ""
        self.name = name or "scene"
        self.folder = folder
        if isinstance(source, Mapping):
            self.text = json_of(arrays.named(source), indent=1)
        elif isinstance(source, str) and ("\n" in source or source.lstrip().startswith("{")):
            self.text = source
        else:
            self.path = source
            self.name = Path(source).name

    def read(self, options: Any, scene: Any, errors: Any) -> int:
        """A kage_status."""
        if self.path is not None:
            return int(lib.kage_scene_load(bytes_of(self.path), options, scene, errors))
        text = self.text.encode()
        name, folder = bytes_of(self.name), bytes_of(self.folder)
        return int(lib.kage_scene_parse(text, len(text), name, folder, options, scene, errors))


def changes_of(sets: Mapping[str, Any], arrays: Arrays) -> list[bytes]:
    """PATH=VALUE of each change. A str stands as in the scene file, so "2+" is a method and "[1, 2]" a list."""
    return [f"{path}={value_of(arrays.named(value, path))}".encode() for path, value in sets.items()]


def value_of(value: Any) -> str:
    return value if isinstance(value, str) else json_of(value)


def json_of(value: Any, indent: int | None = None) -> str:
    """JSON is YAML, too."""
    try:
        return json.dumps(value, default=plain, indent=indent, allow_nan=False)
    except (TypeError, ValueError) as wrong:
        raise OptionError(f"in a scene: {wrong}") from None


def plain(value: Any) -> Any:
    """For JSON: numpy's numbers and small arrays, paths."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"{type(value).__name__} {value!r}, expected numbers, texts, lists, dicts and numpy arrays")
