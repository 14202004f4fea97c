"""How near the whole picture is to true displacement, and how right the bumps' own shadows are.

The truth is kage's `--surface displaced` with all shadows, and POV-Ray's picture `self`, which is smaller. A pixel's
error is the largest difference of its red, green and blue in linear light; the report has it in steps of 255.

The pixels of the receiver (seen in the smooth picture, in the displaced one, or in both) are of two kinds. A pixel is
at the silhouette where the two pictures see different things: another object, or another part of the receiver than the
one in the slab around the smooth hit, which is what `exact` finds (their depths differ by another amount than exact's
tau). So are its eight neighbours. There no method can be right, as it sees what the smooth surface lets it see. All
others are the ground.

The masks of own shadows have no other objects, and a low or a high lamp (reference/own.py). kage makes them at exact's
place, so that only the own shadow can be wrong. A pixel counts where both programs see the receiver and its rough
surface faces the lamp, away from the silhouette.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench import images, masks, programs, quality
from bench.plan import OWN, Bench, Facts
from bench.programs import MeasureError, Size
from bench.quality import Layers, rounded
from bench.runner import Job, Stage
from bench.store import Inputs, Value
from reference import own, references

CODE = programs.file_digest(*(Path(module.__file__ or "") for module in (images, own, quality)), Path(__file__))
OFF = (1, 8, 32)  # of 255: a step that is hardly seen, one that is, one that is seen at once
SEEN = 8
SAME_DEPTH = 1e-3  # of the depth: rounding is a thousand times smaller, another part is much farther away
LAYERS = "color,Z,tau,order"
OWN_LAYERS = "N,P,Z,tau,order,visibility"
HEIGHTS = references.ELEVATIONS  # of the lamp, in degrees
SLOPES = (0.1, 0.2, 0.35, 0.6, 1.0)  # of the bumps: 95 % are below
SCALE = {"cube": 0.22, "sphere": 0.09, "terrain": 0.001, "torus": 0.03, "waves": 0.03}  # of the bumps in the scene


@dataclass(frozen=True)
class Setting:
    """A scene as it is, or with another lamp or other bumps."""

    name: str
    sets: Mapping[str, object]
    size: Size


@dataclass(frozen=True)
class Truth:
    """The displaced picture, and where the receiver and the silhouette are."""

    color: np.ndarray
    receiver: np.ndarray
    silhouette: np.ndarray


# Settings -----------------------------------------------------------------------------------------


def as_it_is(bench: Bench) -> Setting:
    return Setting("scene", {}, quality.mask_size(bench))


def small(bench: Bench) -> Setting:
    """As large as POV-Ray's picture."""
    return Setting("small", {}, quality.picture_size(bench))


def lamp_set(scene: Facts, elevation: int) -> dict[str, object]:
    return {f"lights.{scene.light}.at": own.vector(own.lamp_at(scene.at, elevation))}


def lamps(bench: Bench, scene: Facts) -> dict[int, Setting]:
    size = quality.picture_size(bench)
    return {height: Setting(f"light-{height}", lamp_set(scene, height), size) for height in HEIGHTS}


def slopes(bench: Bench, scene: Facts) -> dict[float, Setting]:
    size = quality.picture_size(bench)
    path = f"objects.{scene.receiver}.bump.scale"
    return {slope: Setting(f"slope-{slope:g}", {path: f"{SCALE[scene.name] * slope / scene.slope_95:.8g}"}, size)
            for slope in SLOPES}


def settings(bench: Bench, scene: Facts) -> list[Setting]:
    return [as_it_is(bench), small(bench), *lamps(bench, scene).values(), *slopes(bench, scene).values()]


# The truth ----------------------------------------------------------------------------------------


def near(mask: np.ndarray) -> np.ndarray:
    """The mask, and the eight neighbours of each of its pixels."""
    rows, columns = mask.shape
    padded = np.pad(mask, 1)
    shifted = [padded[i:i + rows, j:j + columns] for i in range(3) for j in range(3)]
    found: np.ndarray = np.logical_or.reduce(shifted)
    return found


def silhouette(smooth: Layers, displaced: Layers) -> tuple[np.ndarray, np.ndarray]:
    """The receiver, and its silhouette. `smooth` is made by exact."""
    before, after = smooth["order"] >= 0, displaced["order"] >= 0
    both = before & after
    moved = np.abs(displaced["Z"] - smooth["Z"] - smooth["tau"]) > SAME_DEPTH * smooth["Z"]
    other = (before != after) | (both & (moved | (smooth["order"] != quality.ORDER_CODES["exact"])))
    receiver = before | after
    return receiver, receiver & near(other)


def picture(bench: Bench, scene: Facts, method: str, setting: Setting, layers: str = "color") -> Layers:
    options = (*programs.method_options(method), *programs.set_options(dict(setting.sets)))
    return quality.render(bench, scene, setting.size, options, layers)


def make_truth(bench: Bench, scene: Facts, setting: Setting) -> Value:
    path = bench.whole_truth(scene.name, setting.name)
    path.parent.mkdir(parents=True, exist_ok=True)
    displaced, smooth = (picture(bench, scene, method, setting, LAYERS) for method in ("displaced", "exact"))
    receiver, edge = silhouette(smooth, displaced)
    aside = path.with_suffix(".new")
    with aside.open("wb") as file:
        np.savez(file, color=references.stack(displaced), receiver=receiver, silhouette=edge)
    aside.replace(path)
    return {}


@functools.lru_cache(maxsize=16)
def read_truth(path: Path) -> Truth:
    with np.load(path) as found:
        return Truth(found["color"], found["receiver"], found["silhouette"])


# Measures -----------------------------------------------------------------------------------------


def share(part: np.ndarray, of: np.ndarray) -> float | None:
    """In %."""
    return 100 * int((part & of).sum()) / int(of.sum()) if of.any() else None


def errors(color: np.ndarray, truth: Truth) -> dict[str, float | None]:
    """Of a picture, against the truth; see above."""
    error = 255 * np.abs(color - truth.color).max(axis=-1)
    ground = truth.receiver & ~truth.silhouette
    off = error > SEEN
    found: dict[str, float | None] = {f"off_{step}": share(error > step, ground) for step in OFF}
    return found | {
        "median": float(np.median(error[ground])), "p95": float(np.percentile(error[ground], 95)),
        "silhouette": share(truth.silhouette, truth.receiver),
        "silhouette_off": share(off, truth.silhouette),
        "of_rest": share(truth.silhouette, truth.receiver & off),
    }


# The levels of a picture of the errors: those of bench/masks.py, so that the page shows them alike.
OFF_GROUND, OFF_SILHOUETTE = masks.WRONGLY_LIT, masks.WRONGLY_SHADOW


def error_levels(color: np.ndarray, truth: Truth) -> np.ndarray:
    """Where the receiver is off by more than SEEN."""
    off = 255 * np.abs(color - truth.color).max(axis=-1) > SEEN
    levels = np.where(truth.receiver, masks.RIGHT_LIT, masks.NOT_COUNTED).astype(np.uint8)
    levels[off & truth.receiver] = OFF_GROUND
    levels[off & truth.silhouette] = OFF_SILHOUETTE
    return levels


def file_names(variant: str) -> tuple[str, str]:
    """Of the picture and of that of its errors, without their ends."""
    return f"whole-{quality.slug(variant)}", f"whole-{quality.slug(variant)}.wrong"


def measure(bench: Bench, scene: Facts, variant: str) -> Value:
    """The scene as it is: against kage's displacement, and against POV-Ray's where that is there."""
    setting, (name, wrong) = as_it_is(bench), file_names(variant)
    options = (*programs.method_options(variant), *programs.size_options(setting.size))
    png = bench.picture(scene.name, name)
    png.parent.mkdir(parents=True, exist_ok=True)
    color = references.stack(quality.render(bench, scene, setting.size, programs.method_options(variant), "color", png))
    truth = read_truth(bench.whole_truth(scene.name, setting.name))
    quality.save_levels(error_levels(color, truth), bench.picture(scene.name, wrong))
    flip = images.flip(images.srgb(color), images.srgb(truth.color))
    value: Value = rounded(errors(color, truth) | {"flip": flip}) | {
        "povray": None,
        "command": programs.shown(quality.command(bench, scene, options,
                                                  Path(f"{scene.name}-{quality.slug(variant)}.png"))),
    }
    try:
        return value | {"povray": against_povray(bench, scene, variant)}
    except MeasureError as error:
        return value | {"why": str(error)}


def against_povray(bench: Bench, scene: Facts, variant: str) -> Mapping[str, object]:
    setting = small(bench)
    theirs = quality.reference(bench.references, scene.name).pictures["self"].astype(np.float32)
    kept = read_truth(bench.whole_truth(scene.name, setting.name))
    color = references.stack(picture(bench, scene, variant, setting))
    return rounded(errors(color, Truth(theirs, kept.receiver, kept.silhouette)))


def measure_setting(bench: Bench, scene: Facts, setting: Setting) -> Value:
    """The share of each variant's ground that is off by more than SEEN."""
    truth = read_truth(bench.whole_truth(scene.name, setting.name))
    return {"off": {variant: errors(references.stack(picture(bench, scene, variant, setting)), truth)[f"off_{SEEN}"]
                    for variant in bench.level.variants}}


def keep_displaced(bench: Bench, scene: Facts) -> Value:
    """The truth's picture, for the report."""
    color = read_truth(bench.whole_truth(scene.name, as_it_is(bench).name)).color
    quality.save_levels(np.rint(255 * images.srgb(color)).astype(np.uint8),
                        bench.picture(scene.name, file_names("displaced")[0]))
    return {}


# Own shadows --------------------------------------------------------------------------------------


@functools.lru_cache(maxsize=4)
def own_reference(folder: Path, scene: str) -> references.OwnShadows:
    """POV-Ray's masks. The scene must not have changed since."""
    quality.check_reference(folder, scene, references.own_entry(scene))
    try:
        return references.load_own(scene, folder)
    except references.ReferenceError as error:
        raise MeasureError(str(error)) from error


def own_method(how: str) -> str:
    return how if how == "displaced" else f"exact shifted, {how}"


def own_layers(bench: Bench, scene: Facts, method: str, elevation: int) -> Layers:
    """Of the scene without other objects."""
    sets: dict[str, object] = lamp_set(scene, elevation) | own.without_casters(scene.casters)
    return picture(bench, scene, method, Setting("own", sets, quality.mask_size(bench)), OWN_LAYERS)


def faces_lamp(layers: Layers, at: own.Point) -> np.ndarray:
    """Where the rough surface of a displaced picture faces the lamp."""
    n, p = (np.stack([layers[f"{v}.{axis}"] for axis in "XYZ"], axis=-1) for v in "NP")
    with np.errstate(invalid="ignore"):
        facing: np.ndarray = ((np.array(at) - p) * n).sum(axis=-1) > 0
    return facing


def measure_own(bench: Bench, scene: Facts, elevation: int) -> Value:
    """Wrong pixels of the own shadow by each way to find it, in numbers, with those of the true shadow."""
    mask = own_reference(bench.references, scene.name).masks[elevation]
    smooth = own_layers(bench, scene, "exact", elevation)
    displaced = own_layers(bench, scene, "displaced", elevation)
    receiver, edge = silhouette(smooth, displaced)
    truth = mask == references.SHADOW
    counted = (truth | (mask == references.LIT)) & receiver & ~edge
    counted &= faces_lamp(displaced, own.lamp_at(scene.at, elevation))
    wrong = {}
    for how in OWN:
        got = displaced if how == "displaced" else own_layers(bench, scene, own_method(how), elevation)
        wrong[how] = int((counted & (quality.in_shadow(got, scene) != truth)).sum())
    return {"shadow": int((counted & truth).sum()), "counted": int(counted.sum()), "wrong": wrong}


# The work of auto ---------------------------------------------------------------------------------


ORDERS = "auto.order"  # the picture's name


def measure_orders(bench: Bench, scene: Facts) -> Value:
    """The method that each pixel of the receiver needed: shares in %, and a picture of codes one above the layer's."""
    order = quality.render(bench, scene, quality.mask_size(bench),
                           (*programs.method_options("auto"), quality.OTHERS), "order")["order"]
    quality.save_levels((order + 1).astype(np.uint8), bench.picture(scene.name, ORDERS))
    codes, counts = np.unique(order[order >= 0], return_counts=True)
    names = {code: name for name, code in quality.ORDER_CODES.items()}
    return {"orders": {names[int(code)]: 100 * float(n) / float(counts.sum())
                       for code, n in zip(codes, counts, strict=True)}}


# Jobs ---------------------------------------------------------------------------------------------


def inputs(bench: Bench, scene: Facts, **more: object) -> Inputs:
    return quality.inputs(bench, scene, **{"code": CODE, **more})


def setting_job(bench: Bench, scene: Facts, setting: Setting) -> Job:
    return Job(f"whole {scene.name} {setting.name}", inputs(bench, scene, variants=list(bench.level.variants)),
               functools.partial(measure_setting, bench, scene, setting), Stage.MEASURES, 1.5)


def own_job(bench: Bench, scene: Facts, elevation: int) -> Job:
    entry = references.read_manifest(bench.references).get(references.own_entry(scene.name), {})
    return Job(f"own {scene.name} {elevation}", inputs(bench, scene, masks=entry.get("pixels"), ways=list(OWN)),
               functools.partial(measure_own, bench, scene, elevation), Stage.MEASURES, 3)


def variant_job(bench: Bench, scene: Facts, variant: str) -> Job:
    files = tuple(bench.picture(scene.name, name) for name in file_names(variant))
    return Job(f"whole {scene.name} {variant}", inputs(bench, scene, variant=variant),
               functools.partial(measure, bench, scene, variant), Stage.MEASURES, 1.0, files)


def truth_jobs(bench: Bench, scene: Facts) -> list[Job]:
    shown = bench.picture(scene.name, file_names("displaced")[0])
    return [Job(f"truth {scene.name} whole {setting.name}", inputs(bench, scene),
                functools.partial(make_truth, bench, scene, setting), Stage.TRUTHS, 0.7,
                (bench.whole_truth(scene.name, setting.name),))
            for setting in settings(bench, scene)] + [
        Job(f"picture {scene.name} whole", inputs(bench, scene), functools.partial(keep_displaced, bench, scene),
            Stage.MEASURES, 0.1, (shown,))]


def jobs(bench: Bench) -> list[Job]:
    found = []
    for scene in bench.scenes.values():
        found += truth_jobs(bench, scene)
        found += [variant_job(bench, scene, variant) for variant in bench.level.variants]
        changed = [*lamps(bench, scene).values(), *slopes(bench, scene).values()]
        found += [setting_job(bench, scene, setting) for setting in changed]
        found += [own_job(bench, scene, elevation) for elevation in HEIGHTS]
        if "auto" in bench.level.methods:
            found.append(Job(f"orders {scene.name}", inputs(bench, scene),
                             functools.partial(measure_orders, bench, scene), Stage.MEASURES, 0.3,
                             (bench.picture(scene.name, ORDERS),)))
    return found
