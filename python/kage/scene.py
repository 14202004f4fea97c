"""Scenes: loaded from a file, a text or a dict; rendered."""

from __future__ import annotations

import os
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, Unpack

from kage._kage import ffi, lib
from kage.arrays import Arrays
from kage.calls import Call
from kage.convert import converted
from kage.options import FileOptions, How, Progress, RenderOptions, takes
from kage.picture import Picture
from kage.progress import watched
from kage.requests import Struct, check_names, one_of, render_struct, whole, write_struct
from kage.source import Source, Text, changes_of
from kage.structs import Limits, PovrayReport, Probe, SceneInfo, Stats, Survey
from kage.text import bytes_of, text_of
from kage.version import __version__

#: The program that reads models, beside this file; the environment may name another.
READER = Path(__file__).with_name("kage-import")


class Scene:
    """A scene that was read by `kage.load`. It may be used by several threads at once."""

    def __init__(self, handle: Any) -> None:
        self._handle = handle
        self._lock = threading.Lock()  # of changes

    @property
    def name(self) -> str:
        """Of its file, or of the text."""
        return Path(text_of(lib.kage_scene_get_info(self._handle).path) or "").name

    @property
    def info(self) -> SceneInfo:
        """What is in the scene: its settings, lights and objects."""
        return converted(SceneInfo, lib.kage_scene_get_info(self._handle))

    @takes(RenderOptions)
    def render(self, **options: Unpack[RenderOptions]) -> Picture:
        """Render a picture. An option that is not given, or None, is as the scene says.

        shadow: where shadow rays start: none 0 1 2 2+ iter:K march:N exact auto[:E] (`kage.METHODS` describes them).
        shade: "smooth", or "shifted": shade where the shadow rays start.
        bump_shadow: the bumps' shadows on their own surface: none march:N horizon exact.
        surface: "smooth", bump mapping; "displaced", truly displaced surfaces.
        self_shadow: whether bumped objects cast shadows. guard: keep to the slab between the lowest and highest P.
        relief: the best picture for its cost: sets shadow, shade and bump_shadow where they are not given.
        size: (width, height) in pixels. crop: (x0, y0, x1, y1), only this part.
        aa: aa x aa samples a pixel, 1 to 16. aa_threshold: only where neighbours differ by more, above 0 and up to 3.
        timing: whether the stages in `Picture.stats` are timed. threads: default as many as there are processors.
        progress: None, a bar where somebody sees it; True, False; or a function of the step and the share done.
        limits: a `kage.Limits` of memory and time (default: the scene's memory, and any time).
        layers: whether the picture has the other planes besides R, G and B (default True).

        The picture depends neither on the threads nor on the crop.
        """
        check_names("render", options, RenderOptions)
        handle, film = self._handle, ffi.new("kage_film **")
        with watched(options.get("progress"), self.name, self._pixels(options)) as call:
            made = render_struct(options, call)
            free = lib.kage_film_free
            owned = call.make(lambda: lib.kage_render(handle, made.c, film, call.errors), film, free)
        return Picture(owned, self.name)

    @takes(FileOptions)
    def render_file(self, path: str | os.PathLike[str], **options: Unpack[FileOptions]) -> Stats:
        """Render a picture to a file, in bands: memory does not bound it. The bytes are those of render and save.

        The options are those of `render`, and:
        bits: of a PNG, 8 or 16. layers: of an EXR, names of planes, or False for R, G and B (default: all).
        resume: go on with the rows that are whole in PATH.part, to the same bytes.
        keep: leave PATH.part when this is interrupted (default: of an EXR). band: rows of a band, a multiple of 16.
        """
        check_names("render_file", options, FileOptions)
        handle, film, exr = self._handle, ffi.new("kage_film **"), os.fspath(path).lower().endswith(".exr")
        with watched(options.get("progress"), self.name, self._pixels(options)) as call:
            how = render_struct({"layers": exr, **options}, call)
            to = write_struct({"keep": exr, **options})
            place = bytes_of(path)
            owned = call.make(
                lambda: lib.kage_render_file(handle, how.c, place, to.c, film, call.errors),
                film,
                lib.kage_film_free,
                files=True,
            )
        return converted(Stats, lib.kage_film_get_stats(owned))

    @property
    def text(self) -> str:
        """The scene as YAML, with all changes in it; comments are kept."""
        return text_of(lib.kage_scene_get_info(self._handle).text) or ""

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write `text` to a file, whole or not at all."""
        handle, call = self._handle, Call()
        call.run(lambda: lib.kage_scene_write(handle, bytes_of(path), call.errors), files=True)

    def set(
        self, path: str | Mapping[str, Any], value: Any = None, *, arrays: Mapping[str, Any] | None = None
    ) -> None:
        """Change the scene: scene.set("objects.ground.bump.scale", 0.1), or several keys at once by a dict.

        A value is what a dict for `kage.load` may hold. A key of a map that is not there yet is added. Where a value is
        wrong, the scene stays as it was. Only what the changes touch is read again. Renders in other threads go on with
        the scene as they found it.
        """
        with self._lock:
            self._handle = self.changed(path, value, arrays=arrays)._handle

    def changed(
        self, path: str | Mapping[str, Any], value: Any = None, *, arrays: Mapping[str, Any] | None = None
    ) -> Scene:
        """A new scene with the changes of `set`. This one stays as it is; the two share what is the same."""
        handle, call, scene = self._handle, Call(), ffi.new("kage_scene **")
        options = load_struct({path: value} if isinstance(path, str) else path, Arrays(arrays), call, None)
        free = lib.kage_scene_free
        return Scene(call.make(lambda: lib.kage_scene_change(handle, options.c, scene, call.errors), scene, free))

    def probe(self, x: int, y: int) -> Probe:
        """Every value that is computed for the ray through the middle of pixel x, y, by each method."""
        handle, call, probe = self._handle, Call(), ffi.new("kage_probe **")
        place = (whole("x", x, 0, lib.KAGE_MAX_SIDE), whole("y", y, 0, lib.KAGE_MAX_SIDE))
        free = lib.kage_probe_free
        owned = call.make(lambda: lib.kage_scene_probe(handle, *place, probe, call.errors), probe, free)
        return converted(Probe, owned, {"visible": lib.kage_scene_get_info(handle).light_count})

    def survey(self) -> Survey:
        """How steep the bumps are where the camera sees them, and what to be warned of."""
        handle, call, survey = self._handle, Call(), ffi.new("kage_survey **")
        free = lib.kage_survey_free
        owned = call.make(lambda: lib.kage_scene_survey(handle, survey, call.errors), survey, free)
        return converted(Survey, owned, {"objects": lib.kage_scene_get_info(handle).object_count})

    def povray(
        self,
        path: str | os.PathLike[str],
        *,
        surface: Literal["smooth", "displaced"] | None = None,
        cast: bool = True,
        progress: Progress = None,
        limits: Limits | None = None,
    ) -> PovrayReport:
        """Write the scene for POV-Ray 3.7 (docs/povray.md).

        surface: as for `render`. cast: whether objects without a bump cast shadows.
        """
        handle, report, place = self._handle, ffi.new("kage_povray_report *"), bytes_of(path)
        with watched(progress, Path(path).name) as call:
            made = Struct("kage_povray_options", call)
            made.limits(limits)
            made.text("command", f"kage {__version__} in Python")
            made.c.no_cast = not cast
            made.c.displaced = one_of("surface", surface, no="smooth", yes="displaced")
            call.run(lambda: lib.kage_scene_write_povray(handle, place, made.c, report, call.errors), files=True)
        return converted(PovrayReport, report)

    def _pixels(self, options: How) -> int:
        """For the progress; wrong options are found later."""
        info = lib.kage_scene_get_info(self._handle)
        try:
            if crop := options.get("crop"):
                return max(0, (crop[2] - crop[0]) * (crop[3] - crop[1]))
            width, height = options.get("size") or (info.width, info.height)
            return max(0, int(width * height))
        except (TypeError, ValueError, IndexError):
            return 0

    def __repr__(self) -> str:
        info = lib.kage_scene_get_info(self._handle)
        return (
            f"<kage.Scene {self.name}: {info.width} x {info.height} pixels, {info.light_count} lights, "
            f"{info.object_count} objects, shadow {text_of(info.method)}>"
        )


def load(
    source: Source,
    *,
    sets: Mapping[str, Any] | None = None,
    folder: str | os.PathLike[str] | None = None,
    name: str | None = None,
    arrays: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: Progress = None,
    limits: Limits | None = None,
) -> Scene:
    """Read a scene: a file's path, a text of YAML, or a dict with the keys of docs/scene.md.

    A str is a text if it has a line end or begins with "{", otherwise a path. A dict may hold numpy arrays: height
    maps, images and meshes, see docs/python.md.
    sets: changes, as {"objects.ground.bump.scale": 0.1}. folder: where relative names of files begin, for a text or a
    dict (default: the current folder). name: what errors and pictures call a text or a dict (default "scene").
    arrays: what "array:NAME" is, where the scene has that in place of a file. limits: a `kage.Limits`, of what reading
    may take and of what the scene and its files may have; it also holds for changes of the scene. All errors of the
    scene are raised at once, as an InputError.
    """
    named = Arrays(arrays)
    found = Text(source, folder, name, named)
    scene = ffi.new("kage_scene **")
    with watched(progress, found.name) as call:
        options = load_struct(sets or {}, named, call, threads)
        options.limits(limits)
        return Scene(call.make(lambda: found.read(options.c, scene, call.errors), scene, lib.kage_scene_free))


def load_struct(sets: Mapping[str, Any], arrays: Arrays, call: Call, threads: int | None) -> Struct:
    made = Struct("kage_load_options", call, threads)
    texts = [made.keep(ffi.new("char[]", text)) for text in changes_of(sets, arrays)]
    arrays.fill(made)
    made.c.sets = made.keep(ffi.new("char *[]", texts))
    made.c.set_count = len(texts)
    if "KAGE_IMPORT" not in os.environ:
        made.text("model_reader", str(READER))
    return made
