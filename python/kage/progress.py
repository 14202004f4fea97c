"""The bar of a call that lasts: by tqdm, in a terminal and in a notebook."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from tqdm.auto import tqdm

from kage.calls import Call
from kage.options import Progress

#: Seconds before a bar appears: what is sooner done needs none.
DELAY = 0.3


@contextmanager
def watched(progress: Progress, name: str, pixels: int = 0) -> Iterator[Call]:
    """A call whose progress is shown, or told to the caller's function. pixels: what rendering counts; 0: nothing."""
    if callable(progress):
        yield Call(progress)
    elif progress or (progress is None and is_seen()):
        bar = Bar(name, pixels)
        try:
            yield Call(bar.show)
        finally:
            bar.end()
    else:
        yield Call()


def is_seen() -> bool:
    """Whether somebody sees a bar: a terminal, or a notebook."""
    return sys.stderr.isatty() or in_notebook()


def in_notebook() -> bool:
    """In the kernel of a notebook, which IPython then runs in."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and "IPKernelApp" in shell.config


class Bar:
    """One bar after the other, one for each step."""

    def __init__(self, name: str, pixels: int) -> None:
        self.name, self.pixels = name, pixels
        self.what = ""
        self.bar: Any = None

    def show(self, what: str, share: float) -> None:
        if what != self.what:
            self.end()
            self.what = what
            self.bar = self.begin(share)
        self.bar.update(share * self.bar.total - self.bar.n)

    def begin(self, share: float) -> Any:
        shown = {"desc": f"{self.name}: {self.what}", "leave": False, "delay": DELAY, "miniters": 0}
        if self.what == "rendering" and self.pixels:
            first = int(share * self.pixels)
            return tqdm(total=self.pixels, initial=first, unit="pixel", unit_scale=True, **shown)
        return tqdm(total=1.0, bar_format="{desc} {percentage:3.0f} %|{bar}| {elapsed}", **shown)

    def end(self) -> None:
        if self.bar is not None:
            self.bar.close()
            self.bar = None
