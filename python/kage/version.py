"""What the library says of itself."""

from __future__ import annotations

from kage._kage import ffi, lib

__version__: str = ffi.string(lib.kage_version()).decode()

#: The number type of the tracer: "float" or "double".
PRECISION: str = ffi.string(lib.kage_precision()).decode()
