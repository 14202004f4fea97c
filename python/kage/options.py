"""The options of rendering and writing, by the names of the scene file's keys, and how they become structs of C."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from typing import Any, Literal, TypedDict, TypeVar

from kage.calls import Listener
from kage.structs import Limits

#: None: a bar on a terminal and in notebooks, for what lasts. True: always a bar. False: none. Or what is called with
#: the step ("rendering", "writing", ...) and how much of it is done, 0..1; what it raises ends the call.
Progress = bool | Listener | None

Function = TypeVar("Function", bound=Callable[..., Any])


class How(TypedDict, total=False):
    """How a picture is rendered. What is not given, or None, is as the scene says."""

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
    timing: bool  #: whether `Stats.stages` are timed, which costs about 1 %
    threads: int | None  #: None: as many as there are processors
    progress: Progress  #: None: a bar, where somebody sees it
    limits: Limits | None  #: of memory and time; None: the scene's memory, and any time


class RenderOptions(How, total=False):
    """Of `Scene.render`."""

    layers: bool  #: whether the picture has the other planes besides R, G and B (default True)


class WriteOptions(TypedDict, total=False):
    """Of `Picture.save`."""

    bits: Literal[8, 16]  #: of a PNG (default 8)
    layers: str | Sequence[str] | None  #: of an EXR: names of planes, "N" for N.X N.Y N.Z; None: all
    threads: int | None  #: None: as many as there are processors
    progress: Progress  #: None: a bar, where somebody sees it
    limits: Limits | None  #: of memory and time; None: the scene's memory, and any time


class FileOptions(How, total=False):
    """Of `Scene.render_file`."""

    bits: Literal[8, 16]  #: of a PNG (default 8)
    layers: bool | str | Sequence[str] | None  #: of an EXR: names of planes; False: R, G and B; None, True: all
    resume: bool  #: go on with the rows that are whole in PATH.part, to the same bytes
    keep: bool | None  #: leave PATH.part when this is interrupted; None: of an EXR
    band: int | None  #: rows of a band, a multiple of 16; None: 64 MiB or more


def takes(options: type) -> Callable[[Function], Function]:
    """A function's **options as help() and editors show them: each by its name."""
    def with_signature(function: Function) -> Function:
        signature = inspect.signature(function)
        kept = [one for one in signature.parameters.values() if one.kind is not inspect.Parameter.VAR_KEYWORD]
        added = [
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=hint.__forward_arg__)
            for name, hint in options.__annotations__.items()
        ]
        vars(function)["__signature__"] = signature.replace(parameters=kept + added)
        return function

    return with_signature
