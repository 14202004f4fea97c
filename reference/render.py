"""Make the references: each scene with its bumps truly displaced, as POV-Ray renders it.

`kage pov` writes the scene for POV-Ray; POV-Ray renders it, without antialiasing, into out/reference/. For the pictures
and the mask of the shadow:

    self     every object casts shadows, rough surfaces too
    cast     rough surfaces cast none: the shadows of other objects, which the method is about
    cast, nocast, dark (larger), for the mask
             where `cast` and `nocast` (no object casts a shadow) differ is the shadow; where `nocast` and `dark` (no
             light) do not, the surface is turned away from the light; and in `dark` each object has its own flat colour

For the masks of the bumps' own shadows, without other objects, by lamps of three colours (own.py):

    own-1, own-2     low lamps and high ones, with the bumps' shadows
    own-1-none, own-2-none, own-dark     without these, and without light: masks come of them as above

A reference is good while its scene, its maps, what `kage pov` writes for it, the commands, the version of POV-Ray and
its pixels are those of reference/manifest.json (pixels, not bytes: POV-Ray's files carry their date). The others are
stale, and only they are made again. Files are written under other names and renamed, the manifest last: so after an
interruption a reference is good or stale, and a bad one is never taken for good.

status: 0 all references are good, 1 some are stale (--check) or can't be made, 2 wrong usage, 130 interrupted
"""

from __future__ import annotations

import argparse
import hashlib
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from reference import own, references
else:
    import own  # this file is run by its path, so its folder is searched
    import references

FOLDER, TOP, ReferenceError = references.FOLDER, references.TOP, references.ReferenceError
WORK = Path("out") / "reference"  # relative to TOP, where all commands run, so that they are the same everywhere
FLAGS = ("+FE", "-A", "-D", "-P", "-V")  # EXR, no antialiasing, no window, no waiting, no count of lines
HALF_ULP = 2.0**-11  # POV-Ray writes half floats: a relative step


@dataclass(frozen=True)
class Shot:
    """One render by POV-Ray: its name, its size, and the options of `kage pov`."""

    name: str
    size: tuple[int, int]
    options: tuple[str, ...]


@dataclass(frozen=True)
class Checked:
    """What `kage check` says of a scene: its lights and where they are, and the objects without bumps."""

    lights: dict[str, own.Point]
    casters: list[str]


def scaled(size: tuple[int, int], scale: int) -> tuple[int, int]:
    return size[0] * scale, size[1] * scale


def dark_sets(lights: Iterable[str]) -> dict[str, str]:
    return {f"lights.{light}.color": "[0, 0, 0]" for light in lights}


def shots(lights: Iterable[str], scale: int = 1) -> tuple[Shot, ...]:
    """`scale`: width and height, in those of the references in reference/."""
    picture, mask = scaled(references.PICTURE_SIZE, scale), scaled(references.MASK_SIZE, scale)
    dark = own.options(dark_sets(lights))
    return (
        Shot("self", picture, ()),
        Shot("cast", picture, ("--no-self-shadow",)),
        Shot("mask-cast", mask, ("--no-self-shadow",)),
        Shot("mask-nocast", mask, ("--no-self-shadow", "--no-cast")),
        Shot("mask-dark", mask, ("--no-self-shadow", *dark)),
    )


GROUPS = (references.ELEVATIONS[:3], references.ELEVATIONS[3:])  # what POV-Ray sees at once


def own_shots(scene: Checked, scale: int = 1) -> tuple[Shot, ...]:
    """For the masks of own shadows. They need a scene with one light."""
    ((light, at),) = scene.lights.items()
    size, alone = scaled(references.MASK_SIZE, scale), own.without_casters(scene.casters)
    found = []
    for number, group in enumerate(GROUPS, 1):
        options = own.options(alone | own.coloured_lamps(light, at, group))
        found.append(Shot(f"own-{number}", size, options))
        found.append(Shot(f"own-{number}-none", size, ("--no-self-shadow", *options)))
    dark = own.options(alone | dark_sets(scene.lights))
    return (*found, Shot("own-dark", size, ("--no-self-shadow", *dark)))


# The commands of kage and POV-Ray -------------------------------------------------------------------


@contextmanager
def late_signals() -> Iterator[None]:
    """SIGINT and SIGTERM interrupt at the end of the block, not within."""
    came: list[int] = []
    before = {number: signal.signal(number, lambda number, _: came.append(number))
              for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    if came:
        raise KeyboardInterrupt


def run(command: Sequence[str | Path]) -> str:
    """What the command prints, on both streams. It is killed where this is interrupted."""
    process = None
    try:
        with late_signals():  # one that came while Popen is at work would leave a process that nobody knows
            process = subprocess.Popen(command, cwd=TOP, env=os.environ | {"LC_ALL": "C"}, stdin=subprocess.DEVNULL,
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace")
        text = "".join(process.communicate())
    except OSError as error:
        raise ReferenceError(f"{command[0]}: {error.strerror}") from error
    finally:
        if process and process.poll() is None:
            process.kill()
            process.wait()
    status = process.returncode
    if status:
        how = f"killed by signal {-status}" if status < 0 else f"status {status}"
        raise ReferenceError(f"{shlex.join(map(str, command))}: {how}\n{text[-1500:].strip()}")
    return text


def check(kage: Path, scene: str) -> Checked:
    text = run([kage, "check", scene])
    lights = re.findall(r"^light (\S+) at (\S+), (\S+), (\S+)$", text, re.MULTILINE)
    objects = re.findall(r"^object (\S+): (.*)$", text, re.MULTILINE)
    return Checked({name: (float(x), float(y), float(z)) for name, x, y, z in lights},
                   [name for name, about in objects if ", bump by" not in about])


def scene_path(name: str) -> str:
    return f"scenes/{name}.yaml"


def export_command(name: str, shot: Shot) -> list[str]:
    size = f"{shot.size[0]}x{shot.size[1]}"
    return ["pov", scene_path(name), "--surface", "displaced", *shot.options, "--size", size,
            "-o", str(WORK / f"{name}-{shot.name}.pov")]


def povray_command(name: str, shot: Shot) -> list[str]:
    base = WORK / f"{name}-{shot.name}"
    return ["povray", f"+I{base}.pov", f"+O{base}.exr", f"+W{shot.size[0]}", f"+H{shot.size[1]}", *FLAGS]


def commands(name: str, plan: Sequence[Shot]) -> list[str]:
    """As they are in the manifest: for a shell in TOP."""
    return [shlex.join(command) for shot in plan
            for command in (["build/float/kage", *export_command(name, shot)], povray_command(name, shot))]


def export(kage: Path, name: str, shot: Shot) -> Path:
    """Write the scene for POV-Ray."""
    path = TOP / WORK / f"{name}-{shot.name}.pov"
    path.parent.mkdir(parents=True, exist_ok=True)
    words = run([kage, *export_command(name, shot)])
    if "coarse mesh" in words:
        path.unlink()
        raise ReferenceError(f"{scene_path(name)}, {shot.name}: no truth comes of it: {words.strip()}")
    if words:
        print(f"{name}, {shot.name}: {words.strip()}", flush=True)
    return path


def export_digest(kage: Path, name: str, shot: Shot) -> str:
    """Of what kage writes for one shot; the others differ only by options and the resolution of meshes."""
    path = export(kage, name, shot)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    path.unlink()
    return digest


def povray_version() -> str:
    if not shutil.which("povray"):
        raise ReferenceError("POV-Ray is missing: `scripts/bootstrap povray` installs it (Debian: povray)")
    found = re.search(r"POV-Ray \d\S*", run(["povray", "--version"]))
    if not found:
        raise ReferenceError("`povray --version` does not tell its version, expected `POV-Ray 3...`")
    return found[0]


def shoot(kage: Path, name: str, shot: Shot) -> np.ndarray:
    """The picture of a shot. An old file is removed first, so that it is not taken for the new one."""
    scene = export(kage, name, shot)
    path = scene.with_suffix(".exr")
    path.unlink(missing_ok=True)
    command = povray_command(name, shot)
    text = run(command)
    path.with_suffix(".log").write_text(text)
    # An isosurface whose max_gradient is too low has holes, and POV-Ray only warns. It also warns of one that is higher
    # than needed; that is only slower.
    if "contain holes" in text:
        raise ReferenceError(f"{shlex.join(command)}: POV-Ray found max_gradient too low, so the surface may have "
                             f"holes; its message is in {WORK / f'{name}-{shot.name}.log'}")
    try:
        picture = references.stack(references.read_exr(path))
    except (OSError, RuntimeError, KeyError) as error:
        raise ReferenceError(f"{shlex.join(command)}: no good picture came out: {error}") from error
    if picture.shape != (shot.size[1], shot.size[0], 3) or not np.isfinite(picture).all():
        raise ReferenceError(f"{shlex.join(command)}: a picture of another size, or with values that are no numbers")
    scene.unlink()  # a mesh takes a hundred megabytes; it stays where something failed, to find out why
    return picture


# The mask -------------------------------------------------------------------------------------------


def receiver(dark: np.ndarray, colors: Sequence[np.ndarray]) -> np.ndarray:
    """Where the picture without light shows one of the ambient colours."""
    like = [(np.abs(dark - c) <= HALF_ULP * np.maximum(c, HALF_ULP)).all(axis=-1) for c in colors]
    anywhere: np.ndarray = np.any(like, axis=0)
    return anywhere


def make_mask(cast: np.ndarray, nocast: np.ndarray, dark: np.ndarray, colors: Sequence[np.ndarray]) -> np.ndarray:
    """From three renders by one program: where they show the same, their pixels are equal to the bit."""
    mask = np.full(dark.shape[:2], references.LIT, dtype=np.uint8)
    mask[(nocast != cast).any(axis=-1)] = references.SHADOW
    mask[(nocast == dark).all(axis=-1)] = references.AWAY
    mask[~receiver(dark, colors)] = references.ELSEWHERE
    return mask


def make_own_masks(shown: np.ndarray, none: np.ndarray, dark: np.ndarray, colors: Sequence[np.ndarray],
                   elevations: Sequence[int]) -> dict[int, np.ndarray]:
    """As make_mask, from one channel of each picture for each lamp."""
    seen = receiver(dark, colors)
    masks = {}
    for channel, elevation in enumerate(elevations):
        here, without, unlit = (picture[..., channel] for picture in (shown, none, dark))
        mask = np.where(here != without, references.SHADOW, references.LIT).astype(np.uint8)
        mask[without == unlit] = references.AWAY
        mask[~seen] = references.ELSEWHERE
        masks[elevation] = mask
    return masks


def receiver_colors(kage: Path, name: str, lights: Iterable[str]) -> list[np.ndarray]:
    """The colours of bumped objects without light, from kage's own picture: one of its layers shows where they are."""
    dark = own.options(dark_sets(lights))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "dark.exr"
        run([kage, "render", scene_path(name), "--shadow", "0", "--size", "64x48", *dark, "--quiet", "-o", path])
        layers = references.read_exr(path)
    picture = references.stack(layers)
    seen, others = (np.unique(picture[where], axis=0) for where in (layers["order"] >= 0, layers["order"] < 0))
    if any((np.abs(a - b) <= HALF_ULP).all() for a in seen for b in others):
        raise ReferenceError(f"{scene_path(name)}: a bumped object and another thing have the same ambient colour: "
                             "the mask can't tell them apart")
    return list(seen)


# References -----------------------------------------------------------------------------------------


def make(kage: Path, name: str, plan: Sequence[Shot], lights: Iterable[str]) -> references.Reference:
    pictures = {shot.name: shoot(kage, name, shot) for shot in plan}
    mask = make_mask(pictures["mask-cast"], pictures["mask-nocast"], pictures["mask-dark"],
                     receiver_colors(kage, name, lights))
    if not ((mask == references.SHADOW).any() and (mask == references.LIT).any()):
        raise ReferenceError(f"{scene_path(name)}: POV-Ray's pictures show no shadow on the receiver, or nothing else")
    return references.Reference({kind: pictures[kind] for kind in references.PICTURES}, mask)


def make_own(kage: Path, name: str, plan: Sequence[Shot], lights: Iterable[str]) -> references.OwnShadows:
    pictures = {shot.name: shoot(kage, name, shot) for shot in plan}
    colors = receiver_colors(kage, name, lights)
    masks: dict[int, np.ndarray] = {}
    for number, group in enumerate(GROUPS, 1):
        masks |= make_own_masks(pictures[f"own-{number}"], pictures[f"own-{number}-none"], pictures["own-dark"], colors,
                                group)
    lowest = masks[min(masks)]
    if not ((lowest == references.SHADOW).any() and (lowest == references.LIT).any()):
        raise ReferenceError(f"{scene_path(name)}: POV-Ray's pictures show no shadow of the bumps by the lowest lamp, "
                             "or nothing else")
    return references.OwnShadows(masks)


def keep(entry: str, reference: references.Reference | references.OwnShadows, made: dict[str, object],
         folder: Path) -> None:
    """Put an entry's files, and what they were made from, in their place. Until the last rename its pixels are not the
    manifest's, so it is stale."""
    with tempfile.TemporaryDirectory(dir=folder, prefix=".new-") as aside:
        references.save(entry.removesuffix(references.OWN), reference, Path(aside))
        for file in references.files(entry):
            (Path(aside) / file).replace(folder / file)
    digest = references.digest(entry, folder)
    manifest = references.read_manifest(folder)
    manifest[entry] = made | {"pixels": digest}
    references.write_manifest(manifest, folder)


def update(options: argparse.Namespace, entry: str, version: str) -> bool:
    """Make one entry if it is stale and --check is not given. Whether it is good now."""
    name = entry.removesuffix(references.OWN)
    scene = check(options.kage, scene_path(name))
    plan = (shots(scene.lights, options.scale) if entry == name else own_shots(scene, options.scale))
    wanted: dict[str, object] = {
        "scene": references.scene_digest(TOP / scene_path(name)),
        "commands": commands(name, plan),
        "export": export_digest(options.kage, name, plan[0]),
    }
    if version:
        wanted["povray"] = version
    reason = "--all" if options.all else references.why_stale(entry, wanted, options.folder)
    if not reason:
        print(f"{entry}: good")
        return True
    print(f"{entry}: stale ({reason})", flush=True)
    if options.check:
        return False
    keep(entry, (make if entry == name else make_own)(options.kage, name, plan, scene.lights), wanted, options.folder)
    print(f"{entry}: made")
    return True


def update_all(options: argparse.Namespace) -> int:
    """Each by itself: if one can't be made, the others still are. The exit status."""
    try:
        version = povray_version()
    except ReferenceError as error:
        if not options.check:
            raise
        print(f"{error}\nits version is not compared")
        version = ""
    bad = 0
    names = options.scenes or references.SCENES
    for entry in (entry for name in names for entry in (name, references.own_entry(name))):
        try:
            bad += not update(options, entry, version)
        except ReferenceError as error:
            print(f"render.py: {entry}: {error}", file=sys.stderr)
            bad += 1
    return 1 if bad else 0


# The command line -----------------------------------------------------------------------------------


def parse_arguments(arguments: Sequence[str] | None) -> argparse.Namespace:
    about, _, status = (__doc__ or "").partition("\nstatus:")
    parser = argparse.ArgumentParser(prog="render.py", description=about, epilog="status:" + status,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"{', '.join(references.SCENES)} (all)")
    parser.add_argument("--check", action="store_true", help="only name those that are stale")
    parser.add_argument("--all", action="store_true", help="also make the good ones again")
    parser.add_argument("--kage", type=Path, default=TOP / "build" / "float" / "kage", metavar="FILE",
                        help="the program that writes the scenes for POV-Ray (the project's build/float/kage)")
    parser.add_argument("--scale", type=int, choices=range(1, 9), default=1, metavar="N",
                        help="N times as wide and high as those in reference/ (1; more only with --folder)")
    parser.add_argument("--folder", type=Path, default=FOLDER, metavar="DIR",
                        help="where the references are (reference/)")
    options = parser.parse_args(arguments)
    for name in options.scenes:
        if name not in references.SCENES:
            parser.error(f"'{name}' is none of the scenes {', '.join(references.SCENES)}")
    if options.scale != 1 and options.folder == FOLDER:
        parser.error("--scale: the references in reference/ have their size; expected another --folder")
    if options.check and options.all:
        parser.error("--check makes nothing: it can't go with --all")
    options.kage, options.folder = options.kage.resolve(), options.folder.resolve()
    if not os.access(options.kage, os.X_OK):
        parser.error(f"{options.kage} is not there, or is not a program: `make build/float/kage` builds it")
    return options


def main(arguments: Sequence[str] | None = None) -> int:
    options = parse_arguments(arguments)
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # so that POV-Ray ends with this program
    try:
        options.folder.mkdir(parents=True, exist_ok=True)
        return update_all(options)
    except (ReferenceError, OSError) as error:
        print(f"render.py: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("render.py: interrupted; what is not made stays stale", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
