"""The options of rendering and writing, by the names of the scene file's keys, and how they become structs of C."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from typing import Any, Literal, TypedDict, get_type_hints

from kage.calls import Listener

#: None: a bar on a terminal and in notebooks, for what lasts. True: always a bar. False: none. Or what is called with
#: the step ("rendering", "writing", ...) and how much of it is done, 0..1; what it raises ends the call.
Progress = bool | Listener | None


class RenderOptions(TypedDict, total=False):
    """Of `Scene.render`. What is not given, or None, is as the scene says."""

    shadow: str | int | None  #: where shadow rays start: none 0 1 2 2+ iter:K march:N exact auto[:E]
    shade: Literal["smooth", "shifted"] | None  #: the place that is shaded: the smooth hit, or where shadow rays start
    bump_shadow: str | None  #: the bumps' shadows on their own surface: none march:N horizon exact
    surface: Literal["smooth", "displaced"] | None  #: bump mapping, or truly displaced surfaces
    self_shadow: bool | None  #: whether bumped objects cast shadows
    guard: bool | None  #: keep to the slab between the lowest and the highest P
    relief: bool  #: the best picture for its cost: `shadow`, `shade` and `bump_shadow`, where they are not given
    size: tuple[int, int] | None  #: width and height in pixels
    crop: tuple[int, int, int, int] | None  #: x0 y0 x1 y1: only pixels x0 <= x < x1, y0 <= y < y1
    aa: int | None  #: aa x aa samples a pixel, 1 to 16
    aa_threshold: float | None  #: aa only where neighbours differ by more, above 0 and up to 3
    layers: bool  #: whether the picture has the other planes besides R, G and B (default True)
    timing: bool  #: whether `Picture.stats.stages` are timed, which costs about 1 %
    threads: int | None  #: default: as many as there are processors
    progress: Progress  #: default None: a bar, where somebody sees it


class WriteOptions(TypedDict, total=False):
    """Of `Picture.save`."""

    bits: Literal[8, 16]  #: of a PNG (default 8)
    layers: str | Sequence[str] | None  #: of an EXR: names of planes, "N" for N.X N.Y N.Z; default: all
    threads: int | None  #: default: as many as there are processors
    progress: Progress  #: default None: a bar, where somebody sees it


def takes(*options: type) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """A function's **options as help() and editors show them: each by its name."""
    def with_signature(function: Callable[..., Any]) -> Callable[..., Any]:
        signature = inspect.signature(function)
        kept = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
        names = {p.name for p in kept}
        hints = {name: hint for kind in options for name, hint in get_type_hints(kind).items() if name not in names}
        added = [
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=hint)
            for name, hint in hints.items()
        ]
        function.__signature__ = signature.replace(parameters=kept + added)  # type: ignore[attr-defined]
        return function

    return with_signature
