"""How good the methods' pictures are: their shadows against POV-Ray's true displacement, and against kage's own.

A pixel of a shadow counts where both programs see the receiver and it faces the light: the smooth surface in kage, the
rough one in POV-Ray. Where a surface is turned away no cast shadow can be seen. kage shades the smooth hit of the same
viewing ray, so pixels are compared one to one.
"""

from __future__ import annotations

import functools
import re
import tempfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from bench import images, masks, package, programs
from bench.plan import Bench, Facts
from bench.programs import TOP, MeasureError, Options, Size
from bench.runner import Job, Stage
from bench.store import Inputs, Value
from reference import references

Layers = dict[str, np.ndarray]

# The values of the layer `order`.
ORDER_CODES = {"none": -1, "0": 0, "1": 1, "2": 2, "2+": 3, "iter": 4, "march": 5, "exact": 6}
CLOSE = 1 / 255
OTHERS = "--no-self-shadow"  # the method is about the shadows of other objects
TRUTH_LAYERS = "color,tau,order,visibility"
FLAT_LAYERS = "N,P,visibility"
CODE = programs.file_digest(*(Path(module.__file__ or "") for module in (images, masks)), Path(__file__))


def slug(method: str) -> str:
    """A method's or a variant's name for a file name."""
    return method.replace(":", "").replace(",", "").replace(" ", "-").replace("+", "plus")


def command(bench: Bench, scene: Facts, options: Options, *outputs: Path) -> list[str | Path]:
    """As the report shows it. With more threads the picture is the same."""
    words = [word for path in outputs for word in ("-o", path)]
    return [bench.kage, "render", scene.file, *options, *words, "--threads", "1", "--quiet"]


def render(bench: Bench, scene: Facts, size: Size, options: Options, layers: str, png: Path | None = None) -> Layers:
    """The layers of a render, which may also be kept as a PNG."""
    options = (*options, *programs.size_options(size), "--layers", layers)
    made = package.render(bench.kage, scene.file, options, png)
    if made is not None:
        return made
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.exr"
        outputs = [path] if png is None else [path, png]
        programs.run(command(bench, scene, options, *outputs))
        return references.read_exr(path)


# Truths -------------------------------------------------------------------------------------------


def check_reference(folder: Path, scene: str, entry: str) -> None:
    """That an entry of the manifest is of the scene as it is now."""
    made = references.read_manifest(folder).get(entry, {})
    if made.get("scene") != references.scene_digest(TOP / "scenes" / f"{scene}.yaml"):
        raise MeasureError(f"POV-Ray's reference {entry} is of another version of the scene: `make reference` makes it "
                           "again")


@functools.lru_cache(maxsize=4)
def reference(folder: Path, scene: str) -> references.Reference:
    """POV-Ray's."""
    check_reference(folder, scene, scene)
    try:
        return references.load(scene, folder)
    except references.ReferenceError as error:
        raise MeasureError(str(error)) from error


@functools.lru_cache(maxsize=8)
def read_truth(path: Path) -> Layers:
    return references.read_exr(path)


def scaled(size: Size, scale: int) -> Size:
    return size[0] * scale, size[1] * scale


def mask_size(bench: Bench) -> Size:
    return scaled(references.MASK_SIZE, bench.level.reference_scale)


def picture_size(bench: Bench) -> Size:
    return scaled(references.PICTURE_SIZE, bench.level.reference_scale)


def make_truth(bench: Bench, scene: Facts, name: str) -> Value:
    """Render what the methods are compared with: `exact` by the method of that name, `flat` without bumps."""
    level = programs.set_options({f"objects.{scene.receiver}.bump.scale": 0})
    options, layers = {
        "exact": ((*programs.method_options("exact"), OTHERS), TRUTH_LAYERS),
        "flat": ((OTHERS, *programs.method_options("none"), *level), FLAT_LAYERS),
    }[name]
    path = bench.truth(scene.name, name)
    path.parent.mkdir(parents=True, exist_ok=True)
    options = (*options, *programs.size_options(mask_size(bench)), "--layers", layers)
    programs.run(command(bench, scene, options, path))
    return {}


def in_shadow(layers: Layers, scene: Facts) -> np.ndarray:
    shadow: np.ndarray = layers[f"visibility.{scene.light}"] == 0
    return shadow


def faces_light(flat: Layers, scene: Facts) -> np.ndarray:
    """Where the smooth surface faces the light; in a picture without bumps N is its normal."""
    n, p = (np.stack([flat[f"{v}.{axis}"] for axis in "XYZ"], axis=-1) for v in "NP")
    facing: np.ndarray = ((np.array(scene.at) - p) * n).sum(axis=-1) > 0
    return facing


# Measures -----------------------------------------------------------------------------------------


def rounded(values: Mapping[str, object]) -> dict[str, float | None]:
    """To 6 digits, so few that another processor's sums give the same. The values are floats or None."""
    return {name: float(f"{value:.6g}") if isinstance(value, float) else None for name, value in values.items()}


def measure_tau(method: str, got: Layers, exact: Layers) -> Value:
    """The error of tau where the ray meets the rough surface, and the share that fell back of all that has bumps."""
    found, bumped = exact["order"] == ORDER_CODES["exact"], exact["order"] >= 0
    error = np.abs(got["tau"] - exact["tau"])[found]
    code = ORDER_CODES.get(re.split("[ :]", method)[0])  # auto has none: it chooses
    tau = {"median": float(np.median(error)), "p95": float(np.percentile(error, 95))}
    fell_back = None if code is None else 100 * float((got["order"] != code)[bumped].mean())
    return {"tau": rounded(tau), "fell_back": fell_back}


def measure_mask(got: np.ndarray, truth: np.ndarray, counted: np.ndarray) -> dict[str, float | None]:
    return rounded(masks.measure(got, truth, counted))


def against_povray(bench: Bench, scene: Facts, got: Layers, counted: np.ndarray) -> dict[str, object]:
    mask = reference(bench.references, scene.name).mask
    both = counted & ((mask == references.SHADOW) | (mask == references.LIT))
    ours, truth = in_shadow(got, scene), mask == references.SHADOW
    return {"mask": measure_mask(ours, truth, both), "mask_shadow": int((both & truth).sum()),
            "mask_differs": int((both & (ours != truth)).sum())}


def against_displacement(bench: Bench, scene: Facts, method: str) -> dict[str, object]:
    """The picture against POV-Ray's two: rough surfaces cast shadows (`self`), or only other objects do (`cast`)."""
    truth = reference(bench.references, scene.name).pictures
    found: dict[str, object] = {}
    for kind in references.PICTURES:
        options = (*programs.method_options(method), *([OTHERS] if kind == "cast" else []))
        got = references.stack(render(bench, scene, picture_size(bench), options, "color"))
        found[kind] = rounded(images.measure(got, truth[kind]))
        found[f"{kind}_close"] = 100 * float((np.abs(got - truth[kind]) <= CLOSE).all(axis=-1).mean())
    return found


def measure(bench: Bench, scene: Facts, method: str) -> Value:
    """All measures of one method. Those against POV-Ray's reference are left out where it is missing; `why` says so."""
    exact, flat = (read_truth(bench.truth(scene.name, name)) for name in ("exact", "flat"))
    png = bench.picture(scene.name, slug(method))
    png.parent.mkdir(parents=True, exist_ok=True)
    own = method == "displaced"
    options = (*programs.method_options(method), OTHERS)
    got = render(bench, scene, mask_size(bench), options, TRUTH_LAYERS, png)
    counted = (exact["order"] >= 0) & faces_light(flat, scene)
    if own:
        counted &= got["order"] == ORDER_CODES["exact"]
    ours, theirs, smooth = (in_shadow(layers, scene) for layers in (got, exact, flat))
    moved = masks.edge_distances(ours, smooth, counted)
    value: Value = {
        "exact": measure_mask(ours, theirs, counted),
        "edge_moved": rounded(moved) if moved else None,
        "hybrid": rounded(images.measure(references.stack(got), references.stack(exact))),
        "tau": None, "fell_back": None,
        "command": programs.shown(command(bench, scene, (*options, *programs.size_options(mask_size(bench))),
                                          Path(f"{scene.name}-{slug(method)}.png"))),
    }
    if not own:
        value |= measure_tau(method, got, exact)
    save_levels(masks.picture(ours, theirs, counted), bench.picture(scene.name, f"{slug(method)}.wrong"))
    try:
        value |= against_povray(bench, scene, got, (got["order"] == ORDER_CODES["exact"]) if own else counted)
        value |= against_displacement(bench, scene, method)
    except MeasureError as error:
        value["why"] = str(error)
    return value


# Pictures -----------------------------------------------------------------------------------------


def save_levels(levels: np.ndarray, path: Path) -> None:
    from PIL import Image

    path.parent.mkdir(parents=True, exist_ok=True)
    aside = path.with_suffix(".new")
    Image.fromarray(levels).save(aside, format="PNG", optimize=True)
    aside.replace(path)


def save_references(bench: Bench, scene: Facts) -> Value:
    """Write POV-Ray's pictures as PNG, for the report."""
    for kind, picture in reference(bench.references, scene.name).pictures.items():
        save_levels(np.rint(255 * images.srgb(picture)).astype(np.uint8), bench.picture(scene.name, f"povray-{kind}"))
    return {}


# Jobs ---------------------------------------------------------------------------------------------


def inputs(bench: Bench, scene: Facts, **more: object) -> Inputs:
    entry = references.read_manifest(bench.references).get(scene.name, {})
    return {"kage": bench.kage_digest, "scene": scene.digest, "code": CODE, "reference": entry.get("pixels"),
            "scale": bench.level.reference_scale, "packages": images.missing(), **more}


def jobs(bench: Bench) -> list[Job]:
    found = []
    for scene in bench.scenes.values():
        for name in ("exact", "flat"):
            found.append(Job(f"truth {scene.name} {name}", inputs(bench, scene),
                             functools.partial(make_truth, bench, scene, name), Stage.TRUTHS, 0.6,
                             (bench.truth(scene.name, name),)))
        shown = tuple(bench.picture(scene.name, f"povray-{kind}") for kind in references.PICTURES)
        found.append(Job(f"reference {scene.name}", inputs(bench, scene),
                         functools.partial(save_references, bench, scene), Stage.MEASURES, 0.1, shown))
        for method in bench.level.methods:
            files = tuple(bench.picture(scene.name, name) for name in (slug(method), f"{slug(method)}.wrong"))
            found.append(Job(f"quality {scene.name} {method}", inputs(bench, scene, method=method),
                             functools.partial(measure, bench, scene, method), Stage.MEASURES, 1.0, files))
    return found
