"""`kage import`: models become scenes, with their cameras, lights, materials, images, parts and copies; and bumps on
them. The models are those of scenes/models, which scripts/make_models.py makes.
"""

from __future__ import annotations

import json
import math
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.conftest import TOP, Kage
from tests.support import models
from tests.support.parity import layers, rgb

MODELS = TOP / "scenes/models"
BUMP = ",scale=0.05,zero=0.5"
SMALL = ("--size", "160x120", "--set", "render.aa=1", "--quiet")


def bring(kage: Kage, name: str) -> Path:
    """A model and what belongs to it, in the test's folder."""
    for path in MODELS.glob(name.split(".")[0] + "*"):
        shutil.copy(path, kage.folder)
    return kage.folder / name


def imported(kage: Kage, *arguments: str | Path) -> str:
    """What it tells of."""
    done = kage("import", *arguments)
    assert done.returncode == 0, done.stderr
    return done.stderr


def scene_of(kage: Kage, name: str, *options: str) -> str:
    """Import one of the models as x.yaml. Returns the scene's text."""
    imported(kage, bring(kage, name), "-o", "x.yaml", *options)
    return (kage.folder / "x.yaml").read_text()


def picture(kage: Kage, *options: str) -> dict[str, np.ndarray]:
    kage.good("render", "x.yaml", "-o", "x.exr", *SMALL, *options)
    return layers(kage.folder / "x.exr")


def value(text: str, key: str) -> np.ndarray:
    """The numbers behind a key's first place in a scene."""
    found = re.search(rf"\b{key}: (\[[^]]*\]|[-0-9.e]+)", text)
    assert found, key
    return np.array(json.loads(found[1]), float)


# ---- what comes in ----


@pytest.mark.parametrize(("name", "objects", "lights", "files"), [
    ("corner.glb", "Ball Crate Floor Picture Walls", "Lamp", "x-planks.png x-quarters.png x-tiles.png"),
    ("still-life.obj", "Ball Card Table Tumbler Vase_Clay Vase_Glaze", "lamp", "x-still-life-planks.png"),
    ("tower.dae", "Ground Sign Tower", "Lamp", ""),
    ("garden.gltf", "Lawn Tree_001_Bark Tree_001_Leaves Tree_002_Bark Tree_002_Leaves Tree_003_Bark Tree_003_Leaves "
     "Tree_004_Bark Tree_004_Leaves Tree_Bark Tree_Leaves", "Spot Sun", "x-garden_leaves-2.png x-garden_leaves.png"),
])
def test_what_is_in_the_scene(kage: Kage, name: str, objects: str, lights: str, files: str) -> None:
    before = {path.name for path in MODELS.iterdir()}
    text = scene_of(kage, name)
    checked = kage.good("check", "x.yaml")
    assert " ".join(sorted(re.findall(r"^object (\S+):", checked, re.M))) == objects
    assert " ".join(sorted(re.findall(r"^light (\S+) ", checked, re.M))) == lights
    made = {path.name for path in kage.folder.iterdir()} - before - {"x.yaml"}
    assert " ".join(sorted(made)) == files
    assert rgb(picture(kage)).max() > 0.3, text
    assert str(kage.folder) not in text  # names are relative


def test_the_camera_is_the_models(kage: Kage) -> None:
    """glTF: its node's place and direction, its vertical angle and aspect as kage's horizontal angle."""
    text = scene_of(kage, "corner.glb")
    np.testing.assert_allclose(value(text, "from"), [2.6, 1.9, -3.4], atol=1e-5)
    toward, wanted = value(text, "at") - value(text, "from"), np.array([-2.7, -1.1, 4.0])
    np.testing.assert_allclose(toward / np.linalg.norm(toward), wanted / np.linalg.norm(wanted), atol=1e-5)
    across = 2 * math.atan(math.tan(math.radians(16)) * 4 / 3)
    assert value(text, "fov") == pytest.approx(math.degrees(across), abs=1e-3)
    text = scene_of(kage, "tower.dae", "--overwrite")  # z is up in it, and its angle is horizontal
    np.testing.assert_allclose(value(text, "from"), [2.2, 2.0, -4.6], atol=1e-5)
    assert value(text, "fov") == 40


@pytest.mark.parametrize(("name", "of"), [("corner.glb", "Picture"), ("still-life.obj", "Card")])
def test_images_are_the_right_way_up(kage: Kage, name: str, of: str) -> None:
    """Red above blue, green above yellow; red to the left of green, as on the wall and on the card."""
    scene_of(kage, name)
    made = picture(kage)
    color = rgb(made) / np.maximum(rgb(made).max(-1, keepdims=True), 1e-6)

    def middle(r: float, g: float, b: float) -> np.ndarray:
        near = (np.abs(color - np.array([r, g, b])) < 0.1).all(-1) & (rgb(made).max(-1) > 0.1)
        assert near.sum() > 20, (of, r, g, b)
        return np.argwhere(near).mean(0)

    red, green = middle(1, 0.02, 0.02), middle(0.03, 1, 0.05)
    blue, yellow = middle(0.03, 0.06, 1), middle(1, 0.82, 0.03)
    assert red[0] < blue[0] - 5 and green[0] < yellow[0] - 5
    assert red[1] < green[1] - 5 and blue[1] < yellow[1] - 5


def test_all_parts_are_the_model(kage: Kage) -> None:
    """Parts, copies, mirrored and stretched trees: the same places as those of the whole file as one object."""
    text = scene_of(kage, "garden.gltf")
    assert len(re.findall("copy: ", text)) == 4
    apart = picture(kage)["Z"]
    head = text[:text.index("\nobjects:")]
    (kage.folder / "x.yaml").write_text(head + "\nobjects:\n  all: {mesh: {file: garden.gltf}, material: Bark}\n")
    whole = picture(kage)["Z"]
    assert np.isclose(apart, whole, rtol=0, atol=1e-4).mean() > 0.999
    assert (whole < 1e30).mean() > 0.3


def test_images_are_converted(kage: Kage) -> None:
    """A JPEG as libjpeg decodes it; an image times a colour; both as PNG. Alpha is left out and noted."""
    scene_of(kage, "still-life.obj")
    made = np.asarray(Image.open(kage.folder / "x-still-life-planks.png"), float)
    given = np.asarray(Image.open(MODELS / "still-life-planks.jpg").convert("RGB"), float)
    assert np.abs(made - given).max() <= 2
    text = scene_of(kage, "garden.gltf", "--overwrite")
    tinted = np.asarray(Image.open(kage.folder / "x-garden_leaves-2.png"), float) / 255
    given = np.asarray(Image.open(MODELS / "garden leaves.png"), float) / 255
    linear = np.where(given <= 0.04045, given / 12.92, ((given + 0.055) / 1.055) ** 2.4) * [1, 0.55, 0.35]
    wanted = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    assert np.abs(tinted - wanted).max() < 0.6 / 255
    assert "size: [0.1666667, 0.1666667], offset: [-0.04166667, -0.08333333]" in text  # KHR_texture_transform
    Image.fromarray(np.full((4, 4, 4), 200, np.uint8)).save(kage.folder / "still-life-quarters.png")
    done = imported(kage, "still-life.obj", "-o", "x.yaml", "--overwrite")
    assert "image still-life-quarters.png is transparent in places" in done
    assert Image.open(kage.folder / "x-still-life-quarters.png").getpixel((1, 1)) == (200, 200, 200)


def test_images_that_are_missing_are_noted(kage: Kage) -> None:
    model = bring(kage, "still-life.obj")
    (kage.folder / "still-life-quarters.png").unlink()
    (kage.folder / "still-life-planks.jpg").write_bytes(b"\xff\xd8\xff no JPEG")
    done = imported(kage, model, "-o", "x.yaml")
    assert "material Card: its image still-life-quarters.png can't be used: there is no such file" in done
    assert "material Wood: its image still-life-planks.jpg can't be used: " in done
    assert rgb(picture(kage)).max() > 0.3


def test_materials(kage: Kage) -> None:
    text = scene_of(kage, "corner.glb")
    brass = text[text.index("  Brass:"):]
    np.testing.assert_allclose(value(brass, "reflection"), 0.85 ** 2 * np.array([0.9, 0.7, 0.3]), rtol=1e-4)
    assert value(brass, "diffuse") == pytest.approx(1 - 0.85 ** 2, rel=1e-4)
    assert "# material Floor_tiles: left out: the normal map, which has slopes but no heights" in text
    text = scene_of(kage, "still-life.obj", "--overwrite")
    assert value(text[text.index("  Glass:"):], "transmit") == pytest.approx(0.7)
    np.testing.assert_allclose(value(text[text.index("  Chrome:"):], "reflection"), [0.8] * 3)
    assert "specular" not in text[text.index("  Card:"):].split("diffuse")[1].split("color")[0]  # illum 1


def test_lights_keep_their_ratio(kage: Kage) -> None:
    """Sun and spotlight of the garden: lux and candela by the square of the distance; together they are 1."""
    text = scene_of(kage, "garden.gltf")
    sun, spot = text[text.index("  Sun:"):], text[text.index("  Spot:"):]
    grey, far = np.array([0.2126, 0.7152, 0.0722]), value(spot, "distance")
    middle = value(sun, "to")
    d = np.linalg.norm(value(spot, "at") - middle)
    lux = value(sun, "color") @ grey
    assert lux + 2 * value(spot, "color") @ grey * (far / d) ** 2 == pytest.approx(1, rel=1e-3)
    assert value(spot, "color")[2] * 2 * far ** 2 / value(sun, "color")[0] == pytest.approx(2e5 / 2049, rel=1e-3)
    assert value(spot, "falloff") == pytest.approx(math.degrees(0.4), rel=1e-3)
    assert value(scene_of(kage, "garden.gltf", "--overwrite", "--brightness", "2"), "color")[0] == pytest.approx(
        2 * value(sun, "color")[0], rel=1e-4)


def test_z_up(kage: Kage) -> None:
    """A model that lies on its back in the file stands with --up z."""
    m = models.ball(16, 8)
    for name, turn in (("y", np.eye(3)), ("z", np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]))):
        turned = models.Model(m.at * [1, 2, 1] @ turn, m.normal @ turn, m.uv, m.face)
        models.ply(kage.folder / f"{name}.ply", turned, binary=True)
    made = []
    for name, options in (("y", []), ("z", ["--up", "z"])):
        imported(kage, f"{name}.ply", "-o", "x.yaml", "--overwrite", *options)
        made.append(picture(kage)["Z"])
    assert np.isclose(made[0], made[1], rtol=0, atol=1e-4).mean() > 0.999


def test_names(kage: Kage) -> None:
    """Names that a scene can't have, and the same one twice."""
    box = "".join(f"v {x} {y} {z}\n" for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 1, 0)))
    (kage.folder / "n.obj").write_text(f'{box}o Bäume+rot\nf 1 2 3\no a.b\nf 1 3 2\no a+b\nf 1 2 3\n')
    imported(kage, "n.obj", "-o", "x.yaml")
    checked = kage.good("check", "x.yaml")
    assert re.findall(r"^object (\S+):", checked, re.M) == ["B_ume_rot", "a_b", "a_b_2"]


def test_folders(kage: Kage) -> None:
    """The scene, the model and the map each in a folder of its own."""
    for name in ("models", "maps", "scenes/new"):
        (kage.folder / name).mkdir(parents=True)
    for name in ("garden.gltf", "garden.bin", "garden leaves.png"):
        shutil.copy(MODELS / name, kage.folder / "models")
    shutil.copy(MODELS / "sand-16.png", kage.folder / "maps")
    imported(kage, "models/garden.gltf", "-o", "scenes/new/x.yaml", "--bump", f"Lawn=maps/sand-16.png{BUMP}")
    text = (kage.folder / "scenes/new/x.yaml").read_text()
    assert "{file: ../../models/garden.gltf, part: Lawn}" in text and "{file: ../../maps/sand-16.png}" in text
    kage.good("check", "scenes/new/x.yaml")


# ---- bumps ----


def test_bump(kage: Kage) -> None:
    """On the objects that the pattern names; the method then moves the shadow's edge."""
    sand = MODELS / "sand-16.png"
    text = scene_of(kage, "corner.glb", "--bump", f"Fl*={sand},scale=0.2")
    assert text.count("bump:") == 1 and "scale: 0.2\n      zero: 0.5\n      sign: up" in text
    flat, moved = (rgb(picture(kage, "--shadow", method)) for method in ("none", "auto"))
    assert (np.abs(flat - moved).max(-1) > 0.05).mean() > 0.002
    text = scene_of(kage, "garden.gltf", "--overwrite", "--bump", f"Tree*Leaves={sand}{BUMP}", "--bump",
                    f"Tree.001/Leaves={sand},scale=0.02,repeat=2x1,sign=down")
    assert "repeat: [2, 1]\n      sign: down\n      zero: 0.5" in text
    assert text.count("bump:") == 4 and text.count("copy:") == 3  # the one with another bump is no copy


@pytest.mark.parametrize(("bump", "message"), [
    ("Flor=sand-16.png,scale=1", "--bump: no object 'Flor', expected one of the 5: Floor, Walls, Picture, Crate, Ball"),
    ("Floor=sand-16.png", "it lacks its scale, expected one, as Floor=sand-16.png,scale=0.05"),
    ("Floor", "expected OBJECT=MAP,scale=S and other keys of a bump"),
    ("Floor=none.png,scale=1", "'none.png' can't be used: No such file or directory"),
    ("Floor=normals.png,scale=1", "the PNG is a normal map, which has slopes but no heights"),
    ("Floor=sand-16.png,scale=high", "'high' is no number, expected scene units for one unit of the map"),
    ("Floor=sand-16.png,scale=1,siz=2", "has no 'siz', did you mean 'size'?"),
])
def test_wrong_bumps(kage: Kage, bump: str, message: str) -> None:
    bring(kage, "sand-16.png")
    bring(kage, "corner.glb")
    Image.fromarray(np.full((8, 8, 3), [130, 120, 250], np.uint8)).save(kage.folder / "normals.png")
    before = sorted(kage.folder.iterdir())
    done = kage("import", "corner.glb", "-o", "x.yaml", "--bump", bump)
    assert done.returncode == 2 and message in done.stderr, done.stderr
    assert sorted(kage.folder.iterdir()) == before  # the images are gone, too


def test_no_texture_coordinates(kage: Kage) -> None:
    models.stl(kage.folder / "ball.stl", models.ball(8, 4), binary=True)
    done = kage("import", "ball.stl", "-o", "x.yaml", "--bump", f"x={MODELS / 'sand-16.png'}{BUMP}")
    assert done.returncode == 2
    assert "object x has no texture coordinates, expected some" in done.stderr


def test_steps(kage: Kage) -> None:
    """A map of 8 bits is told; smoothed it is ten times nearer to the one of 16 bits; nothing is told of that one."""
    sand = MODELS / "sand-8.png"
    bring(kage, "corner.glb")
    told = imported(kage, "corner.glb", "-o", "x.yaml", "--bump", f"Floor={sand},scale=0.3")
    assert "has 8 bits: its steps of 0.00118 scene units are seen as stairs" in told
    smooth = ("--set", "objects.Floor.bump.smooth=2")
    checked = kage.good("check", "x.yaml")
    assert "warning: the map has 8 bits" in checked and "not smoothed" in checked
    checked = kage.good("check", "x.yaml", *smooth)
    assert "warning: the map has" not in checked and "; smoothed" in checked
    truth = rgb(picture(kage, "--set", f"objects.Floor.bump.map.file={MODELS / 'sand-16.png'}"))
    off = [np.abs(rgb(picture(kage, *more)) - truth).mean() for more in ((), smooth)]
    assert off[1] < off[0] / 5, off
    told = imported(kage, "corner.glb", "-o", "x.yaml", "--overwrite", "--bump",
                     f"Floor={MODELS / 'sand-16.png'},scale=0.3")
    assert "bits" not in told


def test_smooth_is_for_steps(kage: Kage) -> None:
    exr = TOP / "scenes/data/jacksboro.exr"
    text = scene_of(kage, "corner.glb", "--bump", f"Floor={exr},scale=1e-5,zero=300,channel=elevation")
    assert "jacksboro.exr, channel: elevation}" in text
    done = kage("check", "x.yaml", "--set", "objects.Floor.bump.smooth=2")
    assert done.returncode == 2 and "the samples are floats, which have no steps to be smoothed" in done.stderr


# ---- files, and what is wrong with them ----


def test_nothing_is_replaced_unasked(kage: Kage) -> None:
    bring(kage, "corner.glb")
    for there in ("x.yaml", "x-tiles.png"):
        (kage.folder / there).write_text("mine")
        done = kage("import", "corner.glb", "-o", "x.yaml")
        assert done.returncode == 2 and f"{there}: it exists, expected a new name" in done.stderr
        assert (kage.folder / there).read_text() == "mine"
        assert not any(path.suffix == ".png" for path in kage.folder.iterdir() if path.name != there)
        (kage.folder / there).unlink()
    imported(kage, "corner.glb", "-o", "x.yaml")
    first = (kage.folder / "x.yaml").read_bytes()
    imported(kage, "corner.glb", "-o", "x.yaml", "--overwrite")
    assert (kage.folder / "x.yaml").read_bytes() == first


@pytest.mark.parametrize(("options", "message"), [
    (("none.glb", "-o", "x.yaml"), "none.glb: No such file or directory"),
    (("bad.glb", "-o", "x.yaml"), "bad.glb: "),
    (("bad.txt", "-o", "x.yaml"), "no known kind of model"),
    (("corner.glb", "-o", "none/x.yaml"), "none/x.yaml: its folder does not exist"),
    (("corner.glb", "-o", "x.png"), "expected a name that ends in .yaml"),
    (("corner.glb",), "'kage import' lacks -o SCENE.yaml"),
    (("-o", "x.yaml"), "'kage import' lacks its MODEL"),
    (("corner.glb", "-o", "x.yaml", "--camera", "Kamera"), "no camera 'Kamera', expected one of these: 'Camera'"),
    (("corner.glb", "-o", "x.yaml", "--up", "x"), "--up x: expected y or z"),
    (("corner.glb", "-o", "x.yaml", "--brightness", "0"), "--brightness 0: expected a number above 0"),
])
def test_wrong(kage: Kage, options: tuple[str, ...], message: str) -> None:
    data = bring(kage, "corner.glb").read_bytes()
    (kage.folder / "bad.glb").write_bytes(data[:3000] + b"\xff" * 2000)
    (kage.folder / "bad.txt").write_bytes(data)
    before = sorted(kage.folder.iterdir())
    done = kage("import", *options)
    assert done.returncode == 2 and message in done.stderr, done.stderr
    assert sorted(kage.folder.iterdir()) == before


def test_part(kage: Kage) -> None:
    """A part that is not there: those that are."""
    text = scene_of(kage, "corner.glb")
    (kage.folder / "x.yaml").write_text(text.replace("part: Crate", "part: Create"))
    done = kage("check", "x.yaml")
    assert done.returncode == 2
    assert "no part 'Create', expected one of its 5: 'Floor', 'Walls', 'Picture', 'Crate', 'Ball'" in done.stderr


def test_models_are_the_scripts(tmp_path: Path) -> None:
    """The numbers of the models; images may differ with the library that packs them."""
    from scripts import make_models

    make_models.still_life(tmp_path)
    make_models.garden(tmp_path)
    for name in ("still-life.obj", "still-life.mtl", "garden.gltf", "garden.bin"):
        assert (tmp_path / name).read_bytes() == (MODELS / name).read_bytes(), name
