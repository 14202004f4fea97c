"""Renders by the Python package of the same build: for small pictures 1.4 to 5.6 times as fast as starting the program.

`make python` builds the package beside the program. Where it is not there, as beside kage of another commit, or where
an option is not known here, the program renders.
"""

from __future__ import annotations

import argparse
import functools
import importlib
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from bench.programs import TOP, MeasureError

Layers = dict[str, np.ndarray]


class Words(argparse.ArgumentParser):
    """The options of `kage render` that the package has by the same names."""

    def __init__(self) -> None:
        super().__init__(add_help=False, allow_abbrev=False, argument_default=argparse.SUPPRESS)
        self.add_argument("--set", dest="sets", action="append")
        for name in ("--shadow", "--shade", "--bump-shadow", "--surface", "--layers"):
            self.add_argument(name)
        self.add_argument("--aa", type=int)
        self.add_argument("--size", type=lambda text: tuple(map(int, text.split("x"))))
        self.add_argument("--no-self-shadow", dest="self_shadow", action="store_false")
        self.add_argument("--no-guard", dest="guard", action="store_false")
        self.add_argument("--relief", action="store_true")


@functools.cache
def package(kage: Path) -> ModuleType | None:
    """The package of the build that the program is of."""
    folder = kage.resolve().parent / "python"
    if not (folder / "kage" / "_kage.abi3.so").exists():
        return None
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))
    found = importlib.import_module("kage")
    return found if Path(found.__file__ or "").parent.parent == folder else None


def render(kage: Path, scene: str | Path, words: Sequence[object], png: Path | None = None) -> Layers | None:
    """The layers of `kage render SCENE WORDS`, whose picture may also be kept; None: it is for the program."""
    module = package(kage)
    if module is None:
        return None
    known, rest = Words().parse_known_args([str(word) for word in words])
    if rest:
        return None
    options: dict[str, Any] = vars(known)
    sets = dict(text.split("=", 1) for text in options.pop("sets", []))
    layers = options.pop("layers", None)
    try:
        picture = module.load(TOP / scene, sets=sets, threads=1, progress=False).render(
            **options, threads=1, progress=False
        )
        if png is not None:
            picture.save(png, progress=False)
    except module.KageError as error:
        raise MeasureError(str(error)) from error
    wanted = layers.replace("color", "R,G,B").split(",") if layers else list(picture)
    return {name: picture[name] for name in picture if name in wanted or name.partition(".")[0] in wanted}
