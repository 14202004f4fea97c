"""The shape of a report's data, which bench/summary.py makes and out/bench/report.json holds.

The claims, the tables, the plots, the page and the README read a report through these types, so that mypy finds a wrong
key. Percentages are 0 to 100; units are ns, pixels, bytes, seconds and scene units. A value is None where it was not
measured. The large parts (`total=False`) may be missing or None as a whole, so they are read by the functions below.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, TypedDict

from bench import images, masks
from bench.stats import Interval

BUMP_ONLY = "bump only"  # what a text calls the method `none`, whose name reads as a word

Truth = Literal["mask", "exact"]  # the true shadow: POV-Ray's mask, or kage's exact
MaskMetric = Literal["wrong", "iou", "edge_mean", "edge_95", "edge_hausdorff"]


class Scene(TypedDict):
    """A scene, whatever the method."""

    title: str
    slope_median: float
    slope_95: float
    receiver: str
    size: list[int]  # of its masks
    shadow_pixels: int | None  # of POV-Ray's mask


class Tau(TypedDict):
    """The error of tau over the pixels of the receiver."""

    median: float
    p95: float


class Quality(TypedDict):
    """How good a method's shadow is on one scene (bench/quality.py)."""

    mask: masks.Metrics | None
    exact: masks.Metrics | None
    tau: Tau | None
    fell_back: float | None  # % of the receiver
    edge_moved: masks.Distances | None
    hybrid: images.Metrics | None
    cast: images.Metrics | None
    self: images.Metrics | None
    command: str | None


class Parity(TypedDict):
    """How well kage's displacement agrees with POV-Ray's: % of close pixels, % of wrong pixels, and their numbers."""

    self: float
    cast: float
    mask: float | None
    mask_differs: int
    mask_shadow: int


class QualityPart(TypedDict, total=False):
    """All that is measured of shadows."""

    truth: str | None  # the version of POV-Ray
    picture_size: list[int]
    scenes: dict[str, dict[str, Quality]]  # by scene and method
    parity: dict[str, Parity]  # by scene


class Errors(TypedDict):
    """How far a whole picture is from true displacement (bench/whole.py). `off_8` and so on: % of the ground's pixels
    that are off by more than 8/255; median and 95th percentile are in 255ths."""

    median: float
    p95: float
    off_1: float | None
    off_8: float | None
    off_32: float | None
    silhouette: float | None  # % of the receiver
    silhouette_off: float | None  # % of the silhouette, off by more than 8/255
    of_rest: float | None  # % of all pixels that are off by more than 8/255: those at the silhouette


class Whole(Errors, total=False):
    """Of a variant, against kage's displacement, and against POV-Ray's."""

    flip: float | None
    povray: Errors | None
    command: str


class Series(TypedDict):
    """% of the ground that is off by more than 8/255, by variant, for each value."""

    values: list[float]
    off: dict[str, list[float | None]]


class OwnShadows(TypedDict):
    """Wrong pixels of the bumps' own shadows in % of these, by how they are found, for each height of the lamp."""

    values: list[float]
    shadow: list[int | None]  # pixels of POV-Ray's
    wrong: dict[str, list[float | None]]


class WholePart(TypedDict, total=False):
    """All that is measured of whole pictures, by scene."""

    scenes: dict[str, dict[str, Whole]]  # and variant
    lamps: dict[str, Series]  # over the height of the lamp
    slopes: dict[str, Series]  # over the slope of the bumps
    own: dict[str, OwnShadows]
    orders: dict[str, dict[str, float]]  # % of the receiver by what auto needed


class Cost(TypedDict):
    """What a method costs on one scene (bench/cost.py). Times, counts and look-ups are those of a pixel."""

    ns: Interval | None
    added: Interval | None  # % over none
    stages: dict[str, float] | None
    shadow_rays: float | None
    lookups: float | None
    instructions: float | None
    instructions_added: float | None  # % over none
    memory: int | None
    build_s: float | None
    command: str | None


class SceneCosts(TypedDict):
    """A scene's costs, by method."""

    methods: dict[str, Cost]


class Peer(TypedDict, total=False):
    """What another program takes for one of the scenes."""

    name: str
    scene: str
    ns: Interval | None
    build_s: float | None
    memory: int | None
    command: str
    note: str
    times: dict[str, Interval]  # how many times as long as a method of kage or another peer


class CostPart(TypedDict, total=False):
    """All that is measured of costs."""

    size: list[int]
    scenes: dict[str, SceneCosts]
    noise: dict[str, float | None]  # half the interquartile range of none's time, in % of its median
    peers: list[Peer]


class MethodPicture(TypedDict):
    """Paths from the report's folder."""

    file: str
    wrong: str | None  # levels of bench/masks.py


class ReferencePicture(TypedDict):
    """POV-Ray's picture; the path is from the report's folder."""

    name: str
    file: str


class ScenePictures(TypedDict):
    """The pictures that there are of a scene."""

    methods: dict[str, MethodPicture]
    references: list[ReferencePicture]
    variants: dict[str, MethodPicture]  # with all shadows; the displaced one among them
    orders: str | None  # levels: one above the layer `order` of auto


class Pictures(TypedDict):
    """All pictures, by scene."""

    size: list[int]
    scenes: dict[str, ScenePictures]


class Axis(TypedDict):
    """Of a sweep."""

    name: str
    label: str
    values: list[float]


Shares = dict[str, float]  # % wrong pixels, by method


class Sweep(TypedDict):
    """Wrong pixels over two axes; tables are rows (y) of cells (x)."""

    id: str
    scene: str
    title: str
    about: str
    x: Axis
    y: Axis
    by_cost: list[str]  # methods, the cheapest first
    wrong: list[list[Shares | None]]
    shadow_pixels: list[list[int | None]]


class Slopes(TypedDict):
    """The error of tau while the bumps grow, by method."""

    amplitude: list[float]
    label: str
    error: dict[str, list[float | None]]
    floor: float
    theory: dict[str, float]
    fit: dict[str, float | None]


class Case(TypedDict):
    """A claim's verdict on one scene, method or peer, and the numbers behind it."""

    case: str
    verdict: str
    detail: str


class Claim(TypedDict):
    """A claim and what the numbers say of it (bench/claims.py)."""

    id: str
    who: str  # paper, kage, or bound: what kage demands of itself
    sentence: str
    source: str
    test: str
    verdict: str
    cases: list[Case]


class Circumstances(TypedDict):
    """The machine and the programs. Empty or None: not known."""

    date: str
    kage: str
    commit: str
    dirty: bool
    processor: str
    memory: int
    system: str
    compiler: str
    povray: str | None
    packages: dict[str, str | None]
    load: list[float]
    command: str


class Report(TypedDict, total=False):
    """The whole."""

    schema: int
    level: str
    complete: bool
    incomplete: list[str]  # what is missing, a line each
    notes: list[str]
    circumstances: Circumstances
    methods: list[str]
    variants: list[str]
    scenes: dict[str, Scene]
    cost: CostPart
    whole: WholePart
    quality: QualityPart
    pictures: Pictures
    sweeps: list[Sweep]
    slopes: dict[str, Slopes]  # by scene
    claims: list[Claim]
    answer: list[str]


class Kept(Report):
    """What bench/result.json keeps of a report: only the keys that bench/readme.py picks."""

    sheets: dict[str, str]  # digests of the pixels of docs/'s contact sheets


# Reading ------------------------------------------------------------------------------------------------------


def dig(data: object, *keys: str) -> Any:
    """The value under the keys, or None where one of them is missing. For keys that are known only when it runs, as in
    templates; elsewhere the types above serve better."""
    for key in keys:
        if not isinstance(data, Mapping):
            return None
        data = data.get(key)
    return data


def qualities(report: Report) -> dict[str, dict[str, Quality]]:
    """By scene and method, of the scenes that have any."""
    part: QualityPart = report.get("quality") or {}
    return {scene: methods for scene, methods in (part.get("scenes") or {}).items() if methods}


def costs(report: Report) -> dict[str, dict[str, Cost]]:
    """By scene and method, of the scenes that have any."""
    part: CostPart = report.get("cost") or {}
    return {scene: found["methods"] for scene, found in (part.get("scenes") or {}).items() if found}


def quality(report: Report, scene: str, method: str) -> Quality | None:
    return qualities(report).get(scene, {}).get(method)


def cost(report: Report, scene: str, method: str) -> Cost | None:
    return costs(report).get(scene, {}).get(method)


def peers(report: Report) -> list[Peer]:
    part: CostPart = report.get("cost") or {}
    return part.get("peers") or []


def parities(report: Report) -> dict[str, Parity]:
    """By scene."""
    part: QualityPart = report.get("quality") or {}
    return part.get("parity") or {}


def truth_version(report: Report) -> str | None:
    """The version of POV-Ray that made the references; None where there are none."""
    part: QualityPart = report.get("quality") or {}
    return part.get("truth")


def whole_part(report: Report) -> WholePart:
    return report.get("whole") or {}


def wholes(report: Report) -> dict[str, dict[str, Whole]]:
    """By scene and variant, of the scenes that have any."""
    return {scene: found for scene, found in (whole_part(report).get("scenes") or {}).items() if found}


def whole(report: Report, scene: str, variant: str) -> Whole | None:
    return wholes(report).get(scene, {}).get(variant)


def mask_metric(quality: Quality | None, truth: Truth, metric: MaskMetric) -> float | None:
    mask = quality and quality[truth]
    return mask and mask[metric]


def added_cost(cost: Cost | None) -> Interval | None:
    return cost and cost["added"]


def times_none(cost: Cost | None) -> Interval | None:
    """The added cost as a multiple of none's."""
    added = added_cost(cost)
    if added is None:
        return None
    return {"median": 1 + added["median"] / 100, "low": 1 + added["low"] / 100, "high": 1 + added["high"] / 100,
            "n": added["n"]}


def median(interval: Interval | None) -> float | None:
    return interval and interval["median"]


def label(method: str) -> str:
    """As `--shadow` has it, but for bump mapping only."""
    return BUMP_ONLY if method == "none" else method
