"""Makes a scene that breaks a property as small as it still breaks it, so that a person sees why."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from tests.random.draw import Scene

FOUND = Path(__file__).parent / "found"
Key = str | int


def paths(tree: Any, above: tuple[Key, ...] = ()) -> Iterator[tuple[Key, ...]]:
    """Of all that could be left out, the largest first: objects, then their parts, then single keys."""
    inner: list[tuple[Key, Any]] = []
    if isinstance(tree, dict):
        inner = list(tree.items())
    elif isinstance(tree, list) and any(isinstance(item, dict) for item in tree):
        inner = list(enumerate(tree))
    yield from ((*above, key) for key, _ in reversed(inner))
    for key, value in inner:
        yield from paths(value, (*above, key))


def without(scene: Scene, path: tuple[Key, ...]) -> Scene | None:
    made = scene.copy()
    at: Any = made.tree
    for key in path[:-1]:
        try:
            at = at[key]
        except (KeyError, IndexError):
            return None  # gone with something else
    try:
        del at[path[-1]]
    except (KeyError, IndexError):
        return None
    return made


def simpler(scene: Scene) -> Iterator[Scene]:
    """Values in place of other ones, and shorter files."""
    for name, thing in scene.tree["objects"].items():
        if "function" in thing.get("bump", {}) and thing["bump"]["function"] not in ("1", "u"):
            for function in ("1", "u"):
                made = scene.copy()
                made.tree["objects"][name]["bump"]["function"] = function
                yield made
    for name, data in scene.named().items():
        lines = data.split(b"\n")[:-1] if name.endswith(".csv") else []
        for k in range(len(lines) - 1, 0, -1):
            made = scene.copy()
            made.files[name] = b"\n".join([*lines[:k], *lines[k + 1:], b""])
            yield made


def shrunk(scene: Scene, fails: Callable[[Scene], bool], seconds: float = 120) -> Scene:
    """fails: whether a scene breaks the property; a scene that is not valid does not."""
    end = time.monotonic() + seconds
    smaller = True
    while smaller and time.monotonic() < end:
        smaller = False
        for path in list(paths(scene.tree)):
            made = without(scene, path)
            if made is not None and time.monotonic() < end and fails(made):
                scene, smaller = made, True
        for made in simpler(scene):
            if time.monotonic() < end and fails(made):
                scene, smaller = made, True
                break
    scene.files = scene.named()
    return scene


def keep(scene: Scene, name: str, seed: int, folder: Path = FOUND) -> Path:
    """As folder/PROPERTY-SEED/scene.yaml, with the files that it names."""
    path = folder / f"{name}-{seed}" / "scene.yaml"
    scene.write(path)
    return path


def kept(folder: Path = FOUND) -> list[tuple[str, int, Path]]:
    """Property, seed and scene of all that are kept."""
    found = []
    for path in sorted(folder.glob("*/scene.yaml")):
        name, _, seed = path.parent.name.rpartition("-")
        found.append((name, int(seed), path))
    return found

