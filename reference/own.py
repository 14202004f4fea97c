"""The scenes in which bumps shadow each other: one lamp, low or high, and nothing else that casts a shadow.

The lamp keeps the scene's compass direction and its distance, both seen from the origin, which is in the middle of
every receiver; it stands at one of references.ELEVATIONS above the horizon. The other objects are moved away.

POV-Ray sees up to three of these lamps at once, one in red, one in green and one in blue light: a channel of its
picture knows only its own lamp. So a mesh is read twice, not five times.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

Point = tuple[float, float, float]
Options = tuple[str, ...]

COLOURS = ("[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]")
AWAY = "[{translate: [0, -1000, 0]}]"  # below all that is seen, and below every lamp


def vector(point: Sequence[float]) -> str:
    return "[" + ", ".join(f"{x:.6f}" for x in point) + "]"


def lamp_at(at: Point, elevation: float) -> Point:
    """Where a scene's lamp stands at that elevation."""
    x, y, z = at
    distance, compass, above = math.hypot(x, y, z), math.atan2(z, x), math.radians(elevation)
    flat = distance * math.cos(above)
    return flat * math.cos(compass), distance * math.sin(above), flat * math.sin(compass)


def without_casters(casters: Sequence[str]) -> dict[str, str]:
    """What to set so that only the receiver is left."""
    return {f"objects.{name}.transform": AWAY for name in casters}


def options(sets: Mapping[str, str]) -> Options:
    return tuple(word for path, value in sets.items() for word in ("--set", f"{path}={value}"))


def coloured_lamps(light: str, at: Point, elevations: Sequence[int]) -> dict[str, str]:
    """What to set for up to three lamps: the scene's own, and others with names of their own."""
    places = [vector(lamp_at(at, elevation)) for elevation in elevations]
    sets = {f"lights.{light}.at": places[0], f"lights.{light}.color": COLOURS[0]}
    for elevation, place, colour in list(zip(elevations, places, COLOURS, strict=False))[1:]:
        sets[f"lights.{light}{elevation}"] = f"{{at: {place}, color: {colour}}}"
    return sets
