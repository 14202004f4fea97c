"""A rendered picture: its planes as arrays, its files."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray

from kage._kage import ffi, lib
from kage.calls import Call
from kage.convert import converted
from kage.options import WriteOptions, takes
from kage.progress import watched
from kage.requests import check_names, write_struct
from kage.structs import Stats
from kage.text import bytes_of, text_of


class Picture:
    """What `Scene.render` returns. It keeps its memory for as long as it or one of its arrays is there.

    `picture.rgb` has the colours in linear light. `picture["tau"]` is a plane, height x width, `picture["N"]` a group
    of planes, height x width x 3; `list(picture)` names the planes. Arrays are float32, read-only, and no copies.
    """

    def __init__(self, film: Any, name: str) -> None:
        self._film = film
        self._name = name
        count = range(lib.kage_film_plane_count(film))
        #: The names of the planes: R G B, and with layers Z (1e30 where nothing is met), P.X P.Y P.Z, N.X ..., uw.u
        #: uw.w, height, tau, order, and visibility.NAME for each light.
        self.planes: tuple[str, ...] = tuple(text_of(lib.kage_film_plane_name(film, index)) or "" for index in count)

    @property
    def width(self) -> int:
        """In pixels; with a crop, of the crop."""
        return int(lib.kage_film_width(self._film))

    @property
    def height(self) -> int:
        return int(lib.kage_film_height(self._film))

    @property
    def crop(self) -> tuple[int, int, int, int]:
        """The part of the whole picture that this is: x0 y0 x1 y1."""
        crop = ffi.new("int[4]")
        lib.kage_film_crop(self._film, crop)
        return (crop[0], crop[1], crop[2], crop[3])

    @property
    def stats(self) -> Stats:
        """What rendering counted, and its time."""
        return converted(Stats, lib.kage_film_get_stats(self._film))

    @property
    def metadata(self) -> dict[str, str]:
        """What files of the picture hold: the scene's text, its changes, the options. They make it again."""
        pairs = (lib.kage_film_metadata(self._film, index) for index in range(lib.kage_film_metadata_count(self._film)))
        return {text_of(pair.name) or "": text_of(pair.value) or "" for pair in pairs}

    @property
    def srgb(self) -> NDArray[np.uint8]:
        """Height x width x 3 bytes for a screen, sRGB: the very values of an 8-bit PNG."""
        rgba = np.empty((self.height, self.width, 4), np.uint8)
        call = Call()
        call.check(lib.kage_film_srgb(self._film, ffi.from_buffer("uint8_t[]", rgba), 0, 0))
        return rgba[:, :, :3]

    @property
    def rgb(self) -> NDArray[np.float32]:
        """Height x width x 3, linear light."""
        return self._stacked(["R", "G", "B"])

    def __getitem__(self, name: str) -> NDArray[np.float32]:
        """A plane by its whole name, height x width, or what stands before the dot: height x width x members."""
        if name in self.planes:
            return np.asarray(Plane(self._film, name, (self.height, self.width)))
        members = [plane for plane in self.planes if plane.startswith(f"{name}.")]
        if not members:
            few = "" if len(self.planes) > 3 else ": rendered with layers=False"
            raise KeyError(f"no plane {name!r}; there are {' '.join(self.planes)}{few}")
        return self._stacked(members)

    def __iter__(self) -> Iterator[str]:
        return iter(self.planes)

    def __contains__(self, name: object) -> bool:
        return name in self.planes

    def __len__(self) -> int:
        return len(self.planes)

    def _stacked(self, names: list[str]) -> NDArray[np.float32]:
        """Planes side by side along a last axis. They lie at equal distances in memory, so it is a view of them."""
        addresses = [int(ffi.cast("uintptr_t", lib.kage_film_plane(self._film, bytes_of(name)))) for name in names]
        steps = set(np.diff(addresses).tolist())
        if len(steps) > 1:
            return np.stack([self[name] for name in names], axis=-1)
        return np.asarray(Plane(self._film, names[0], (self.height, self.width, len(names)), *steps))

    @takes(WriteOptions)
    def save(self, path: str | os.PathLike[str], **options: Unpack[WriteOptions]) -> None:
        """Write a file: where `path` ends in .png, R, G and B in sRGB; in .exr, planes as 32-bit floats, linear.

        The file appears whole or not at all, and holds `metadata`.
        bits: of a PNG, 8 or 16. layers: of an EXR, the planes ("color", "N", "tau", ...; default: all).
        """
        check_names("save", options, WriteOptions)
        with watched(options.get("progress"), Path(path).name) as call:
            self._write(path, options, call)

    def _write(self, path: str | os.PathLike[str], options: WriteOptions, call: Call) -> None:
        made = write_struct(options, call)
        call.run(lambda: lib.kage_film_write(self._film, bytes_of(path), made.c, call.errors), files=True)

    def _repr_png_(self) -> bytes:
        """For notebooks."""
        with tempfile.TemporaryDirectory(prefix="kage-") as folder:
            path = Path(folder, "picture.png")
            self._write(path, {}, Call())
            return path.read_bytes()

    def __repr__(self) -> str:
        return f"<kage.Picture {self._name}: {self.width} x {self.height} pixels, planes {' '.join(self.planes)}>"


class Plane:
    """The memory of a film's plane for numpy, which keeps this object, and so the film, with the array."""

    def __init__(self, film: Any, name: str, shape: tuple[int, ...], step: int = 0) -> None:
        self.film = film
        values = lib.kage_film_plane(film, bytes_of(name))
        strides = None if len(shape) < 3 else (4 * shape[1], 4, step)
        self.__array_interface__ = {
            "version": 3,
            "shape": shape,
            "strides": strides,
            "typestr": np.dtype(np.float32).str,
            "data": (int(ffi.cast("uintptr_t", values)), True),  # read-only
        }
