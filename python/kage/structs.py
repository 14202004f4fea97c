"""What the library takes and returns, as dataclasses. Made from include/kage.h by structs.py: do not edit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Limits:
    """What a call may take, and what a scene and its files may have (docs/limits.md). Zero: the default. Those
    below `seconds` can only be smaller than the built-in ones (kage_limit_get tells these). They hold where a scene
    is read, and for what it reads later: what passes one is an error of the scene (InputError) and is refused
    before it is taken, but for triangles, which are counted when their file has been decoded."""

    #: bytes that a scene, those that are changed from it, and their films may take together while the call
    #: runs. What would take more is refused before it is taken, with NoMemoryError and the figure that it
    #: needs. 0: 7/8 of the machine's memory; below 0: no limit
    memory: int = 0
    #: of the call, by the wall clock; then it ends as if it were cancelled, with OutOfTimeError. 0: no limit
    seconds: float = 0
    #: bytes of the scene's text
    scene: int = 0
    #: levels of maps and lists in it
    nesting: int = 0
    #: bytes of an expression
    expression: int = 0
    #: levels of brackets, signs and powers in it
    expression_nesting: int = 0
    #: pixels along a side of the picture
    picture: int = 0
    #: rays in a row: the scene's render.depth
    depth: int = 0
    #: in the scene's file
    objects: int = 0
    #: bytes of a map, an image, a list of copies, patches or a model
    file: int = 0
    #: samples along a side of a map or an image
    side: int = 0
    #: of a map or an image
    samples: int = 0
    #: points of a list of them
    copies: int = 0
    #: of a model
    triangles: int = 0
    #: of an object
    patches: int = 0


@dataclass(frozen=True, eq=False)
class LightInfo:
    """kage_light_info of kage.h."""

    name: str
    #: "point", "spot" or "parallel"
    kind: str
    at: NDArray[np.float64]
    #: its light fades with distance
    fades: bool
    #: of an area light, along its sides; 1 and 1: no area
    samples: tuple[int, int]


@dataclass(frozen=True, eq=False)
class ModelInfo:
    """A model's file, and its defects and repairs."""

    #: as the scene says
    file: str
    #: that are used
    triangles: int
    #: triangles without an area, left out
    flat: int
    #: triangles that were turned over, as all of their normals are on the other side
    flipped: int
    #: corners whose normal was on the other side of the triangle; replaced by the triangle's
    normals: int
    #: triangles without texture coordinates
    untextured: int
    #: triangles whose texture is mirrored
    mirrored: int
    #: triangles on which the texture has no area
    texture_points: int


@dataclass(frozen=True, eq=False)
class ObjectInfo:
    """kage_object_info of kage.h."""

    name: str
    #: its kind, as in docs/scene.md
    shape: str
    #: the object that it is a copy of; None: none
    copy_of: str | None
    #: it has a transform
    transformed: bool
    #: the material's name
    material: str
    #: the kind of its colour, "checker" or "image ..."; None: constant
    color: str | None
    #: the kind of its bump; None: none
    bump: str | None
    #: its material reflects; lets light through
    mirrors: bool
    transparent: bool
    #: None: not a mesh, or a copy
    model: ModelInfo | None
    #: its height map's file, as the scene says; None: none
    map: str | None
    #: of the map, in samples
    map_size: tuple[int, int]
    #: the lowest and highest sample, before `scale` and `zero`
    map_range: tuple[float, float]
    #: bounds of the bump's height P, in scene units
    height: tuple[float, float]
    #: P has finite bounds
    bounded: bool
    #: how many copies of copy_of it is, from a list; 0: it is one object
    copies: int
    #: the object under whose key `bump` the bump is, often itself; None: no bump
    bump_of: str | None
    #: the bump's `scale`
    bump_scale: float
    #: of the map's samples, which have 2^map_bits values from 0 to 1; 0: floats
    map_bits: int
    #: the radius of its smoothing, in samples; 0: none
    map_smooth: float


@dataclass(frozen=True, eq=False)
class CameraInfo:
    """kage_camera_info of kage.h."""

    #: as the scene says; eye: its `from`
    eye: NDArray[np.float64]
    at: NDArray[np.float64]
    up: NDArray[np.float64]
    #: fov in degrees, 0: orthographic; width in scene units, 0: a pinhole
    fov: float
    width: float


@dataclass(frozen=True, eq=False)
class SceneInfo:
    """kage_scene_info of kage.h."""

    #: or the name of a text in memory
    path: str
    #: of the picture, in pixels
    width: int
    height: int
    #: aa x aa samples a pixel
    aa: int
    #: only where neighbours differ by more than this; below 0: everywhere
    aa_threshold: float
    method: str
    #: render.guard, render.surface: displaced, render.self_shadow
    guard: bool
    displaced: bool
    self_shadow: bool
    #: rays in a row, with the camera's; 0: no secondary rays
    depth: int
    lights: tuple[LightInfo, ...]
    objects: tuple[ObjectInfo, ...]
    #: render.bump_shadow
    bump_shadow: str
    #: render.shade: shifted
    shifted: bool
    camera: CameraInfo
    #: the scene's YAML, with the changes in it that it was read with; None: out of memory
    text: str | None


@dataclass(frozen=True, eq=False)
class Stage:
    """The time of one stage of rendering."""

    name: str
    #: in the tiles that are timed: use it as a share of the sum over the stages
    seconds: float


@dataclass(frozen=True, eq=False)
class OrderCount:
    """How many bumped samples used an order."""

    #: none 0 1 2 2+ iter march exact
    order: str
    samples: int


@dataclass(frozen=True, eq=False)
class Stats:
    """kage_stats of kage.h."""

    #: of rendering, by the wall clock
    seconds: float
    #: as asked for
    method: str
    #: samples
    camera_rays: int
    shadow_rays: int
    #: reflected, refracted and straight through
    secondary_rays: int
    #: evaluations of P
    height_lookups: int
    #: samples on bumped objects
    bumped: int
    #: bumped samples with another order than asked for
    fell_back: int
    #: hits of displaced and parametric surfaces that are not proved to be the first
    unconfirmed: int
    #: all seconds are 0 without RenderOptions.timing
    stages: tuple[Stage, ...]
    orders: tuple[OrderCount, ...]
    #: samples where P, n', the shift or the light had no value (docs/scene.md, "Without a value")
    undefined: int
    #: the first object with such a sample, index into SceneInfo.objects; -1: none
    undefined_object: int
    #: the most bytes that the scene's family and its films have taken, as kage_limits counts
    memory: int


@dataclass(frozen=True, eq=False)
class ProbeRow:
    """One method on the sample of a pixel."""

    method: str
    #: 0: the bare formula
    guard: bool
    #: t0 = t + tau
    tau: float
    t0: float
    #: of the shadow rays: r + s t0
    origin: NDArray[np.float64]
    #: the order that was used instead; None: it did not fall back
    fell_back: str | None
    #: the visible share of each light of the scene, 0..1
    visible: tuple[float, ...]
    #: linear, without secondary rays
    color: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Probe:
    """Every value that is computed for the ray through the middle of a pixel. Names as in docs/method.md."""

    #: the ray r + s t
    r: NDArray[np.float64]
    s: NDArray[np.float64]
    #: index into SceneInfo.objects; -1: no hit, and the rest is 0
    object: int
    t: float
    u: float
    w: float
    Q: NDArray[np.float64]
    Qu: NDArray[np.float64]
    Qw: NDArray[np.float64]
    Quu: NDArray[np.float64]
    Quw: NDArray[np.float64]
    Qww: NDArray[np.float64]
    n: NDArray[np.float64]
    #: 0: no bump, and the fields up to `slab` are 0
    bumped: bool
    P: float
    Pu: float
    Pw: float
    Puu: float
    Puw: float
    Pww: float
    Pmin: float
    Pmax: float
    #: n'
    n_bump: NDArray[np.float64]
    #: 0: |n| is 0 against |Qu| and |Qw|; the smooth normal is used, sn, a, b and slab are 0
    regular: bool
    #: s.n/|n|, and s in the tangent plane
    sn: float
    a: float
    b: float
    #: tau where the ray enters and leaves the slab between Pmin and Pmax
    slab: tuple[float, float]
    rows: tuple[ProbeRow, ...]
    #: the material has secondary rays, whose light is in no row
    sends: bool
    #: P, n' or the surface has no value here: P is 0, n' is n, and no method shifts
    undefined: int


@dataclass(frozen=True, eq=False)
class BumpSurvey:
    """kage_bump_survey of kage.h."""

    #: of 40 000 over the picture; 0: no bump, or not visible, and the rest is 0
    samples: int
    #: tan of the angle between n and n'; slope_95: the 95th percentile
    slope_median: float
    slope_95: float
    slope_max: float
    #: [1], [2]: by order 1 and 2, in per cent of the samples; [0] is 0
    fell_back: NDArray[np.float64]
    step: float
    step_slope: float
    #: of the samples from the eye, in the median
    distance: float
    #: P has no value there, in per cent of the samples; slopes and fell_back are of the others
    undefined: float


@dataclass(frozen=True, eq=False)
class BumpWarning:
    """kage_warning of kage.h."""

    code: str
    #: index into SceneInfo.objects
    object: int
    value: float
    bound: float


@dataclass(frozen=True, eq=False)
class Survey:
    """kage_survey of kage.h."""

    #: one for each of SceneInfo.objects
    objects: tuple[BumpSurvey, ...]
    #: in the order of the objects
    warnings: tuple[BumpWarning, ...]


@dataclass(frozen=True, eq=False)
class PovrayReport:
    """kage_povray_report of kage.h."""

    #: the coarsest of the objects with a mesh that is too coarse; None: none. The scene owns it
    coarse: str | None
    #: by how much its heights may be wrong, in scene units
    height: float
    #: the same in pixels
    pixels: float


@dataclass(frozen=True, eq=False)
class Method:
    """kage_method of kage.h."""

    #: with K or N for a number: "iter:K"
    name: str
    #: what it does, in one line
    text: str
