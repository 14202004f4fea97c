"""What the library says of itself."""

from __future__ import annotations

from kage._kage import ffi, lib

__version__: str = ffi.string(lib.kage_version()).decode()

#: The number type of the tracer: "float" or "double".
PRECISION: str = ffi.string(lib.kage_precision()).decode()

#: The shadowing methods, and what each does; K and N stand for a number.
METHODS: dict[str, str] = {
    ffi.string(method.name).decode(): ffi.string(method.text).decode()
    for method in map(lib.kage_method_get, range(lib.kage_method_count()))
}
