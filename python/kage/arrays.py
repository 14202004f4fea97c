"""Height maps, images and meshes from numpy arrays: the library knows each by a name, "array:NAME" in the scene."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kage._kage import ffi, lib
from kage.errors import OptionError
from kage.requests import Struct

#: What the samples of a height map or an image may be.
TYPES = {"uint8": lib.KAGE_U8, "uint16": lib.KAGE_U16, "float32": lib.KAGE_F32, "float64": lib.KAGE_F64}

#: The keys under which an array is a height map or an image, and not a list of numbers.
IMAGES = ("map", "image")


class Arrays:
    """The arrays of a scene or a change, and the values in which they stand."""

    def __init__(self, named: Mapping[str, Any] | None = None) -> None:
        self.images: dict[str, NDArray[Any]] = {}
        self.meshes: dict[str, dict[str, NDArray[Any]]] = {}
        for name, value in (named or {}).items():
            if isinstance(value, Mapping):
                self.meshes[name] = mesh_arrays(value, name)
            else:
                self.images[name] = image_array(value, name)

    def named(self, value: Any, path: str = "") -> Any:
        """A value of the scene at `path`, with "array:NAME" in the place of each array."""
        key = path.rpartition(".")[2]
        if isinstance(value, Mapping):
            if key == "mesh" and "vertices" in value:
                return self.mesh(value, path)
            return {name: self.named(one, f"{path}.{name}" if path else str(name)) for name, one in value.items()}
        if isinstance(value, list | tuple):
            return [self.named(one, f"{path}.{index}") for index, one in enumerate(value)]
        if isinstance(value, np.ndarray) and key in IMAGES:
            return {"file": self.image(value, path)}
        if isinstance(value, np.ndarray) and key == "file":
            return self.image(value, path)
        return value

    def image(self, value: NDArray[Any], path: str) -> str:
        array = image_array(value, path)
        name = name_of(array)
        self.images[name] = array
        return f"array:{name}"

    def mesh(self, value: Mapping[str, Any], path: str) -> dict[str, Any]:
        """The keys of docs/scene.md stay: `crease` and others."""
        arrays = mesh_arrays(value, path)
        name = name_of(*arrays.values())
        self.meshes[name] = arrays
        kept = {key: one for key, one in value.items() if key not in ("vertices", "triangles", "uvs")}
        if not isinstance(kept.get("normals"), str):
            kept.pop("normals", None)
        return {"file": f"array:{name}", **kept}

    def fill(self, made: Struct) -> None:
        """Into kage_load_options."""
        made.keep(self)
        images = made.keep(ffi.new("kage_image_array[]", len(self.images)))
        for entry, (name, array) in zip(images, self.images.items(), strict=True):
            entry.name = made.keep(ffi.new("char[]", name.encode()))
            entry.height, entry.width, entry.channels = array.shape
            entry.type = TYPES[array.dtype.name]
            entry.samples = made.keep(ffi.from_buffer(array))
        meshes = made.keep(ffi.new("kage_mesh_array[]", len(self.meshes)))
        for entry, (name, arrays) in zip(meshes, self.meshes.items(), strict=True):
            entry.name = made.keep(ffi.new("char[]", name.encode()))
            entry.vertex_count, entry.triangle_count = len(arrays["positions"]), len(arrays["triangles"])
            for field, array in arrays.items():
                kind = "uint32_t[]" if field == "triangles" else "double[]"
                setattr(entry, field, made.keep(ffi.from_buffer(kind, array)))
        made.c.images, made.c.image_count = images, len(images)
        made.c.meshes, made.c.mesh_count = meshes, len(meshes)


def name_of(*arrays: NDArray[Any]) -> str:
    """By the content, so that a scene has the same text, and its pictures the same bytes, each time."""
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(f"{array.dtype}{array.shape}".encode())
        digest.update(array.data)
    return digest.hexdigest()[:16]


def image_array(value: Any, path: str) -> NDArray[Any]:
    """Height x width x channels, of a type that the library knows."""
    array = np.asarray(value)
    if array.dtype.name == "float16":
        array = array.astype(np.float32)
    if array.ndim == 2:
        array = array[..., np.newaxis]
    if array.dtype.name not in TYPES:
        raise OptionError(f"{path}: an array of {array.dtype}, expected uint8 or uint16 (0 to the largest is 0 to 1), "
                          "float32 or float64")
    if array.ndim != 3 or not 1 <= array.shape[2] <= 4 or array.size == 0:
        raise OptionError(f"{path}: an array of shape {np.shape(value)}, expected height x width, or height x width x "
                          "1 to 4")
    return np.ascontiguousarray(array, array.dtype.newbyteorder("="))


def mesh_arrays(value: Mapping[str, Any], path: str) -> dict[str, NDArray[Any]]:
    """The fields of kage_mesh_array."""
    for name in ("vertices", "triangles"):
        if name not in value:
            raise OptionError(f"{path}: a mesh without {name!r}")
    arrays = {"positions": numbers(value["vertices"], 3, f"{path}.vertices")}
    count = len(arrays["positions"])
    triangles = np.asarray(value["triangles"])
    if triangles.ndim != 2 or triangles.shape[1] != 3 or triangles.dtype.kind not in "iu":
        raise OptionError(f"{path}.triangles: an array of {triangles.dtype} and shape {triangles.shape}, expected "
                          "whole numbers, n x 3")
    if triangles.size and not 0 <= triangles.min() <= triangles.max() < count:
        raise OptionError(f"{path}.triangles: vertices {triangles.min()} to {triangles.max()}, but there are {count}")
    arrays["triangles"] = np.ascontiguousarray(triangles, np.uint32)
    for name, size in (("normals", 3), ("uvs", 2)):
        if value.get(name) is not None and not isinstance(value[name], str):
            arrays[name] = numbers(value[name], size, f"{path}.{name}")
            if len(arrays[name]) != count:
                raise OptionError(f"{path}.{name}: {len(arrays[name])} of them, expected one for each of {count} "
                                  "vertices")
    return arrays


def numbers(value: Any, size: int, path: str) -> NDArray[np.float64]:
    """n x size."""
    array = np.asarray(value)
    if array.ndim != 2 or array.shape[1] != size or array.dtype.kind not in "iuf":
        raise OptionError(f"{path}: an array of {array.dtype} and shape {array.shape}, expected numbers, n x {size}")
    return np.ascontiguousarray(array, np.float64)
