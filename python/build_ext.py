"""Write the C sources of the package's two modules, and what is made from the headers.

    python build_ext.py FOLDER

makes FOLDER/_kage.c, the module kage._kage, from include/kage.h, and FOLDER/_methods.c, kage._methods, from methods.h
beside this script. cffi writes both, for Python's stable ABI. So a function or a struct of a header is in Python
without a second text of it.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import cffi

HERE = Path(__file__).resolve().parent
HEADER = HERE.parent / "include" / "kage.h"
METHODS = HERE / "methods.h"

#: What progress.h adds to the library.
PROGRESS = """
typedef struct kage_py_call { ...; } kage_py_call;
void kage_py_begin(kage_py_call *call);
int kage_py_progress(void *user, const char *what, double share);
double kage_py_look(kage_py_call *call, char what[24]);
void kage_py_stop(kage_py_call *call);
"""


def declarations(header: str) -> str:
    """What cffi reads of a header: no comments, no preprocessor, texts that are #defined as constants."""
    text = re.sub(r"/\*.*?\*/", "", header, flags=re.DOTALL)
    text = re.sub(r"#ifdef __cplusplus.*?#endif", "", text, flags=re.DOTALL)
    texts = re.findall(r'^#define (\w+) ".*"$', text, flags=re.MULTILINE)
    text = re.sub(r"^ *#(.*\\\n)*.*$", "", text, flags=re.MULTILINE).replace("KAGE_API ", "")
    return text + "".join(f"static const char *const {name};\n" for name in texts)


def library() -> cffi.FFI:
    """kage._kage: kage.h, and the library itself by the linker."""
    ffi = cffi.FFI()
    ffi.cdef(declarations(HEADER.read_text()) + PROGRESS)
    ffi.set_source("kage._kage", '#include "progress.h"\n')
    return ffi


def methods() -> cffi.FFI:
    """kage._methods: loops over arrays with the formulas of bumpshadow.h, in methods.c."""
    ffi = cffi.FFI()
    ffi.cdef(declarations(METHODS.read_text()))
    ffi.set_source("kage._methods", '#include "methods.h"\n')
    return ffi


def main() -> None:
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    library().emit_c_code(str(folder / "_kage.c"))
    methods().emit_c_code(str(folder / "_methods.c"))


if __name__ == "__main__":
    main()
