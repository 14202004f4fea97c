"""kage: shadows on bump-mapped surfaces by Sumi and Noma's method, a ray tracer as a Python package.

    import kage

    scene = kage.load("scenes/cube.yaml")
    picture = scene.render(shadow="auto", shade="shifted", size=(640, 480))
    picture.rgb            # numpy, height x width x 3, linear light
    picture["tau"]         # numpy, height x width: how far the shadow rays' starts were moved
    picture.save("cube.png")

docs/python.md is the guide, docs/scene.md describes scenes, docs/method.md the methods.
"""

from __future__ import annotations

from kage import gbuffer, heights, methods
from kage.errors import InputError, KageError, NoMemoryError, OptionError, OutOfTimeError, OutputError
from kage.picture import Picture
from kage.scene import Scene, load
from kage.structs import Limits
from kage.version import METHODS, PRECISION, __version__

__all__ = [
    "METHODS",
    "PRECISION",
    "InputError",
    "KageError",
    "Limits",
    "NoMemoryError",
    "OptionError",
    "OutOfTimeError",
    "OutputError",
    "Picture",
    "Scene",
    "__version__",
    "gbuffer",
    "heights",
    "load",
    "methods",
]
