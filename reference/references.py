"""The references: each scene with its bumps truly displaced, rendered by POV-Ray and kept in the project.

For a scene NAME this folder holds

    NAME.exr        two pictures in linear light, half floats: `self.R` and so on, where rough surfaces also cast
                    shadows, and `cast.R` and so on, where only the other objects do (the method's case)
    NAME.mask.png   what each pixel shows: one of the levels below
    NAME.own.png    the same of the bumps' own shadows, without other objects: one picture below the other for each
                    elevation of the lamp (reference/own.py)
    manifest.json   what these were made from, by which commands, and digests of their pixels

The rest of the project reads them only through this file; reference/render.py makes them.
"""

from __future__ import annotations

import hashlib
import json
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

TOP = Path(__file__).resolve().parent.parent
FOLDER = TOP / "reference"
SCENES = ("cube", "sphere", "terrain", "torus", "waves")

PICTURES = ("self", "cast")
PICTURE_SIZE = (320, 240)
MASK_SIZE = (640, 480)  # the scenes' own
ELEVATIONS = (10, 20, 30, 45, 60)  # of the lamp in the masks of own shadows, degrees

# The levels of a mask, chosen so that the PNG can be looked at.
ELSEWHERE = 0  # another object, or the background
AWAY = 85  # the receiver, where its rough surface is turned away from the light: no shadow can be seen there
SHADOW = 170  # the receiver in the shadow of another object; in the masks of own shadows, of its own bumps
LIT = 255  # the receiver in the light

Manifest = dict[str, dict[str, object]]


class ReferenceError(Exception):
    """What is wrong with a reference, in one line."""


@dataclass(frozen=True)
class Reference:
    """POV-Ray's pictures of a scene, height x width x 3 in linear light, and its mask, which may have another size."""

    pictures: dict[str, np.ndarray]
    mask: np.ndarray

    def digest(self) -> str:
        """Of the pixels only: a file's bytes also depend on the library that wrote it."""
        sha = hashlib.sha256()
        for array in (*(self.pictures[name].astype("<f2") for name in PICTURES), self.mask):
            sha.update(repr(array.shape).encode() + array.tobytes())
        return sha.hexdigest()


@dataclass(frozen=True)
class OwnShadows:
    """POV-Ray's masks of the bumps' own shadows, by the lamp's elevation in degrees, the lowest first."""

    masks: dict[int, np.ndarray]

    def stacked(self) -> np.ndarray:
        return np.concatenate(list(self.masks.values()))

    def digest(self) -> str:
        stacked = self.stacked()
        return hashlib.sha256(repr(stacked.shape).encode() + stacked.tobytes()).hexdigest()


def read_exr(path: Path) -> dict[str, np.ndarray]:
    import OpenEXR  # here, as without it the bench still runs, and measures less

    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels.copy() for name, channel in file.channels().items()}


def write_exr(path: Path, channels: dict[str, np.ndarray]) -> None:
    """As half floats. ZIP packs rows of all channels together, so that two similar pictures need little space."""
    import OpenEXR

    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {name: plane.astype(np.float16) for name, plane in channels.items()}).write(str(path))


def stack(layers: dict[str, np.ndarray], prefix: str = "") -> np.ndarray:
    """The picture in the layers PREFIXR, PREFIXG and PREFIXB: height x width x 3."""
    return np.stack([layers[prefix + c].astype(np.float32) for c in "RGB"], axis=-1)


# Entries ------------------------------------------------------------------------------------------

OWN = ".own"  # NAME.own is the entry of NAME's own shadows in the manifest, NAME that of all else


def own_entry(name: str) -> str:
    return name + OWN


def files(entry: str) -> tuple[str, ...]:
    return (f"{entry}.png",) if entry.endswith(OWN) else (f"{entry}.exr", f"{entry}.mask.png")


def read_png(path: Path) -> np.ndarray:
    from PIL import Image

    with Image.open(path) as image:
        return np.array(image)


def load(name: str, folder: Path = FOLDER) -> Reference:
    exr, png = (folder / file for file in files(name))
    try:
        layers = read_exr(exr)
        mask = read_png(png)
        pictures = {kind: stack(layers, f"{kind}.") for kind in PICTURES}
    except (OSError, RuntimeError, SyntaxError, KeyError) as error:
        raise ReferenceError(f"{exr} or {png.name} can't be read ({error}): `make reference` makes them") from error
    return Reference(pictures, mask)


def load_own(name: str, folder: Path = FOLDER) -> OwnShadows:
    (file,) = files(own_entry(name))
    try:
        stacked = read_png(folder / file)
        masks = np.split(stacked, len(ELEVATIONS))
    except (OSError, SyntaxError, ValueError) as error:
        raise ReferenceError(f"{folder / file} can't be read ({error}): `make reference` makes it") from error
    return OwnShadows(dict(zip(ELEVATIONS, masks, strict=True)))


def digest(entry: str, folder: Path) -> str:
    """Of the pixels in an entry's files."""
    if entry.endswith(OWN):
        return load_own(entry.removesuffix(OWN), folder).digest()
    return load(entry, folder).digest()


def save(name: str, reference: Reference | OwnShadows, folder: Path) -> None:
    from PIL import Image

    if isinstance(reference, OwnShadows):
        Image.fromarray(reference.stacked()).save(folder / files(own_entry(name))[0], optimize=True)
        return
    exr, png = (folder / file for file in files(name))
    write_exr(exr, {f"{kind}.{c}": reference.pictures[kind][..., i] for kind in PICTURES for i, c in enumerate("RGB")})
    Image.fromarray(reference.mask).save(png, optimize=True)


# The manifest -------------------------------------------------------------------------------------


def scene_digest(scene: Path) -> str:
    """Of a scene's text and of the maps it names."""
    text = scene.read_text(encoding="utf-8")
    sha = hashlib.sha256(text.encode())
    for name in re.findall(r"\bfile:\s*([^\s,}]+)", text):
        sha.update((scene.parent / name).read_bytes())
    return sha.hexdigest()


def read_manifest(folder: Path = FOLDER) -> Manifest:
    """By entry; empty where there is no manifest, or a broken one."""
    try:
        content = json.loads((folder / "manifest.json").read_text())
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}


def write_manifest(manifest: Manifest, folder: Path) -> None:
    aside = folder / "manifest.json.new"
    aside.write_text(json.dumps(manifest, indent=1, sort_keys=True) + "\n")
    aside.replace(folder / "manifest.json")


def why_stale(entry: str, wanted: dict[str, object], folder: Path = FOLDER) -> str:
    """Why an entry must be made again; empty where it is good. In the manifest it must have all `wanted`."""
    found = read_manifest(folder).get(entry)
    if found is None:
        return "not in the manifest"
    for key, value in wanted.items():
        if found.get(key) != value:
            return f"another {key}"
    try:
        pixels = digest(entry, folder)
    except ReferenceError:
        return "files missing or broken"
    return "" if pixels == found.get("pixels") else "other pixels than the manifest's"
