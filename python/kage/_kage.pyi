# The module that cffi makes of include/kage.h.
from typing import Any

ffi: Any
lib: Any
