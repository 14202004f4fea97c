"""The program from outside: what it writes, that it is the same again, and how it behaves as a program."""

from __future__ import annotations

import os
import pty
import re
import shutil
import signal
import subprocess
import termios
import time
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from PIL import Image

from reference.references import read_exr as exr
from tests.conftest import PROGRAM, SCENE, TOP, Kage, start
from tests.support import models

DATA = TOP / "tests" / "data"
CUBE, SPHERE = DATA / "cube.yaml", DATA / "sphere.yaml"
SMALL = ("--size", "160x120")
METHODS = ["none", "0", "1", "2", "2+", "iter:3", "march:4"]
LAYERS = {"R", "G", "B", "Z", "P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z", "uw.u", "uw.w", "height", "tau", "order"}


def header(path: Path) -> dict[str, object]:
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return dict(file.header())


def png(path: Path) -> np.ndarray:
    return np.array(Image.open(path))


def same(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> bool:
    return a.keys() == b.keys() and all(a[name].tobytes() == b[name].tobytes() for name in a)


# ---- what it says ----


COMMANDS = ("render", "view", "check", "pixel", "pov", "import", "methods", "help")


def test_help_names_the_commands(kage: Kage) -> None:
    text = kage.good("--help")
    assert kage.good("-h") == text == kage.good("help")
    for name in COMMANDS:
        assert re.search(rf"^  {name}\b", text, re.MULTILINE), name
    assert "--shadow" not in text
    assert len(text.splitlines()) <= 24
    assert re.fullmatch(r"kage \d+\.\d+\.\d+ \((float|double)\)\n", kage.good("--version"))


@pytest.mark.parametrize("name", COMMANDS)
def test_help_of_a_command_has_its_own_options(kage: Kage, name: str) -> None:
    text = kage.good("help", name)
    assert kage.good(name, "--help") == kage.good(name, "x.yaml", "-h") == text
    assert text.startswith(f"Usage: kage {name}")
    assert max(map(len, text.splitlines())) <= 80
    found = set(re.findall(r"^  (?:-\w, |    )(--[\w-]+)", text, re.MULTILINE))
    assert "--help" in found
    assert ("--crop" in found) == (name == "render") and ("--no-cast" in found) == (name == "pov")
    assert ("--set" in found) == (name in ("render", "view", "check", "pixel", "pov"))
    for option in found - {"--help"}:  # the parser has it
        done = kage(name, "missing.yaml", f"{option}=")
        assert done.returncode == 2 and "no option of" not in done.stderr, option


def test_ways_to_write_options(kage: Kage) -> None:
    written = []
    for options in (["-o", "a.png"], ["-oa.png"], ["--output", "a.png"], ["--output=a.png"], ["-o", "a.PNG"]):
        kage.good("render", *options, CUBE, *SMALL, "-q")
        written.append((kage.folder / options[-1].rpartition("=")[2].removeprefix("-o")).read_bytes())
    assert len(set(written)) == 1
    kage.good("render", CUBE, *SMALL, "-o", "a.Exr")
    assert (kage.folder / "a.Exr").read_bytes()[:4] == b"\x76\x2f\x31\x01"
    (kage.folder / "-cube.yaml").symlink_to(CUBE)
    (kage.folder / "bumps.png").symlink_to(DATA / "bumps.png")
    assert "object cube" in kage.good("check", "--size=80x60", "--", "-cube.yaml")
    assert "one argument too many" in kage("check", "--", "-cube.yaml", "--size=80x60").stderr


def test_methods(kage: Kage) -> None:
    lines = kage.good("methods").splitlines()
    assert max(map(len, lines)) <= 80
    names = [line.split()[0] for line in lines if not line.startswith(" ")]
    assert names == ["none", "0", "1", "2", "2+", "iter:K", "march:N", "exact", "auto[:E]"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full on this system")
def test_full_standard_output(kage: Kage) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run([PROGRAM, "methods"], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr) == (1, "kage: standard output can't be written\n")


def test_check(kage: Kage) -> None:
    text = kage.good("check", CUBE)
    assert re.search(r"cube\.yaml: 640 x 480 pixels", text)
    assert "light lamp at -4.5, 5.2, -2.2" in text
    assert "object ground: plane, material clay, bump by map" in text
    assert re.search(r"map +bumps\.png: \d+ x \d+ samples from", text)
    assert re.search(r"P +from -0\.\d+ to 0\.\d+ scene units", text)
    assert re.search(r"slope +median \d\.\d+, 95 % below \d\.\d+, steepest \d\.\d+", text)
    assert "object cube: box, material blue" in text


def test_check_judges_the_method(kage: Kage) -> None:
    """Steep slopes are too much for orders, but not for methods that search."""
    steep = (CUBE, "--set", "objects.ground.bump.scale=0.5")
    for method in ("0", "1", "2", "2+"):
        text = kage.good("check", *steep, "--shadow", method)
        assert re.search(rf"warning: slopes above 0.6 are too steep for order {re.escape(method)}: ", text), method
        assert "use auto or march:8" in text
    for method in ("none", "march:4", "exact", "auto", "iter:4"):
        assert kage.good("check", *steep, "--shadow", method).endswith("\n0 warnings\n"), method
    assert kage.good("check", *steep, "--surface", "displaced").endswith("\n0 warnings\n")
    assert "order 1 falls back often" in kage.good("check", *steep, "--shadow", "1")
    assert kage.good("check", CUBE, "--shadow", "2").endswith("\n0 warnings\n")


@pytest.mark.parametrize("scene", [*(TOP / "scenes").glob("*.yaml"), *(TOP / "scenes" / "gallery").glob("*.yaml")],
                         ids=lambda scene: scene.stem)
def test_shipped_scenes_suit_their_method(kage: Kage, scene: Path) -> None:
    text = kage.good("check", scene)
    assert text.endswith("\n0 warnings\n")
    for line in text.splitlines():
        assert len(line) <= 80 or line.startswith(("object ", "light ", str(scene))), line


@pytest.mark.parametrize(("change", "advice"), [
    ("scale=30", "warning: the bumps are steeper than anything that is only shaded; try scale: 0.3"),
    ("scale=0.0022", "warning: the bumps are too flat to be seen; try scale: 0.3"),
    ("zero=-3", "warning: all of P is far above the surface, where shadows then fall; try zero: 0.5"),
    ("zero=3", "warning: all of P is far below the surface, where shadows then fall; try zero: 0.5"),
])
def test_check_advises_scale_and_zero(kage: Kage, change: str, advice: str) -> None:
    text = kage.good("check", CUBE, "--shadow", "march:4", "--set", f"objects.ground.bump.{change}")
    assert advice in re.sub(r"\s+", " ", text)
    assert text.endswith("\n1 warning\n")


def test_check_warns_of_unbounded_functions(kage: Kage) -> None:
    (kage.folder / "scene.yaml").write_text(SCENE.replace("0.1 * sin(u)", "0.01 * u").replace("bump: {map", "#"))
    text = kage.good("check", "scene.yaml")
    assert "warning: P has no bounds" in text
    text = kage.good("check", "scene.yaml", "--set", "objects.ground.bump.scale=90", "--shadow", "0")
    assert "too steep for order 0" in text and "march:8" not in text and "use auto" not in text


# ---- outputs ----


def test_default_output(kage: Kage) -> None:
    assert kage.good("render", CUBE, *SMALL) == ""
    assert kage.files() == {"cube.png"}
    assert png(kage.folder / "cube.png").shape == (120, 160, 3)


def test_several_outputs(kage: Kage) -> None:
    kage.good("render", CUBE, "-o", "a.png", "-o", "b.exr", "-o", "c.png", "--size=160x120")
    assert kage.files() == {"a.png", "b.exr", "c.png"}
    assert (kage.folder / "a.png").read_bytes() == (kage.folder / "c.png").read_bytes()
    assert exr(kage.folder / "b.exr").keys() == LAYERS | {"visibility.lamp"}


def test_bits_of_a_png(kage: Kage) -> None:
    kage.good("render", CUBE, *SMALL, "-o", "a.png")
    kage.good("render", CUBE, *SMALL, "-o", "b.png", "--bits", "16")
    kage.good("render", CUBE, *SMALL, "-o", "c.exr")
    assert (kage.folder / "a.png").read_bytes()[24:26] == b"\x08\x02"  # depth, RGB
    assert (kage.folder / "b.png").read_bytes()[24:26] == b"\x10\x02"
    layers = exr(kage.folder / "c.exr")
    linear = np.clip(np.stack([layers["R"], layers["G"], layers["B"]], -1).astype(float), 0, 1)
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    assert np.abs(png(kage.folder / "a.png") - srgb * 255).max() <= 0.501
    # Pillow gives the high bytes of 16 bits
    assert np.abs(png(kage.folder / "b.png").astype(float) * 257 - srgb * 65535).max() <= 65535 / 200


def test_some_layers_of_an_exr(kage: Kage) -> None:
    kage.good("render", CUBE, *SMALL, "-o", "all.exr")
    kage.good("render", CUBE, *SMALL, "-o", "some.exr", "--layers", "visibility,color,N.X,uw")
    every, some = exr(kage.folder / "all.exr"), exr(kage.folder / "some.exr")
    assert some.keys() == {"visibility.lamp", "R", "G", "B", "N.X", "uw.u", "uw.w"}
    assert all(some[name].tobytes() == every[name].tobytes() for name in some)


@pytest.mark.parametrize("layers", ["nothing", "", "N,", "visibility.sun", "NX"])
def test_no_such_layer(kage: Kage, layers: str) -> None:
    done = kage("render", CUBE, *SMALL, "-o", "a.exr", "--layers", layers)
    assert done.returncode == 2
    assert "no such layer, expected color, Z, P, N" in done.stderr
    assert kage.files() == set()


def test_layers_without_an_exr(kage: Kage) -> None:
    done = kage("render", CUBE, *SMALL, "-o", "a.png", "--layers", "N")
    assert (done.returncode, kage.files()) == (2, set())
    assert "only an EXR has layers" in done.stderr


def test_layers_of_an_exr(kage: Kage) -> None:
    kage.good("render", CUBE, *SMALL, "--shadow", "2", "-o", "a.exr")
    v = exr(kage.folder / "a.exr")
    assert all(plane.dtype == np.float32 and plane.shape == (120, 160) for plane in v.values())
    hit = np.hypot(np.hypot(v["N.X"], v["N.Y"]), v["N.Z"]) > 0
    assert hit.mean() > 0.5
    length = np.sqrt(v["N.X"] ** 2 + v["N.Y"] ** 2 + v["N.Z"] ** 2)[hit]
    assert np.abs(length - 1).max() < 1e-6
    ground = hit & (np.abs(v["P.Y"]) < 1e-5)
    assert np.abs(v["P.Z"] - (v["uw.u"] - 6))[ground].max() < 1e-4
    assert np.abs(v["P.X"] - (v["uw.w"] - 6))[ground].max() < 1e-4
    assert set(np.unique(v["order"])) <= {-1, 0, 1, 2}
    assert set(np.unique(v["visibility.lamp"])) == {0, 1}
    low, high = (0.22 * (value - 0.417) for value in (0, 1))  # the map goes from black to white
    assert low - 1e-6 <= v["height"].min() < 0 < v["height"].max() <= high + 1e-6


def test_metadata(kage: Kage) -> None:
    kage.good("render", CUBE, *SMALL, "--crop", "10,20,50,60", "--no-guard", "--shadow", "march:4", "-o", "a.exr")
    h = header(kage.folder / "a.exr")
    assert re.fullmatch(r"kage \d+\.\d+\.\d+ (float|double)", str(h["Software"]))
    assert h["kage:scene"] == CUBE.read_text()
    assert h["kage:file"] == "cube.yaml"
    assert h["kage:set"] == "image.size=[160, 120]\nrender.guard=false\nrender.shadow=march:4"
    assert (h["kage:crop"], h["kage:shadow"], h["kage:guard"]) == ("10,20,50,60", "march:4", "no")


@pytest.mark.parametrize("how", ["option", "set", "scene"])
def test_bump_is_another_name_for_none(kage: Kage, how: str) -> None:
    """The same pixels, and the metadata hold the name that has always been there."""
    scene = kage.folder / "bump.yaml"
    told = "bump" if how == "scene" else "0"
    text = CUBE.read_text().replace("{shadow: 0}", f"{{shadow: {told}}}")
    scene.write_text(text.replace("bumps.png", f"{CUBE.parent}/bumps.png"))
    asked = {"option": ["--shadow", "bump"], "set": ["--set", "render.shadow=bump"], "scene": []}[how]
    kage.good("render", scene, *SMALL, *asked, "-o", "bump.exr")
    kage.good("render", CUBE, *SMALL, "--shadow", "none", "-o", "none.exr")
    assert header(kage.folder / "bump.exr")["kage:shadow"] == "none"
    assert same(*(exr(kage.folder / f"{name}.exr") for name in ("bump", "none")))


def test_exrheader_reads_it(kage: Kage) -> None:
    if not shutil.which("exrheader"):
        pytest.skip("exrheader is not installed")
    kage.good("render", CUBE, *SMALL, "-o", "a.exr")
    text = subprocess.run(["exrheader", "a.exr"], cwd=kage.folder, capture_output=True, text=True, check=True).stdout
    for name in LAYERS:
        assert f"    {name}, 32-bit floating-point" in text
    assert 'kage:shadow (type string): "0"' in text


def test_oiiotool_reads_it(kage: Kage) -> None:
    if not shutil.which("oiiotool"):
        pytest.skip("oiiotool is not installed")
    kage.good("render", CUBE, *SMALL, "-o", "a.exr", "-o", "a.png")
    for name, channels in (("a.exr", 16), ("a.png", 3)):
        command = ["oiiotool", "--info", "-v", name]
        text = subprocess.run(command, cwd=kage.folder, capture_output=True, text=True, check=True).stdout
        assert re.search(rf"160 x +120, {channels} channel", text)
        assert "Software:" in text


def test_made_again_from_its_own_metadata(kage: Kage) -> None:
    options = [*SMALL, "--shadow", "2", "--aa", "2", "--set", "objects.ground.bump.scale=0.3", "--crop", "20,10,100,90"]
    kage.good("render", CUBE, *options, "-o", "first.exr", "-o", "first.png")
    h = header(kage.folder / "first.exr")
    (kage.folder / str(h["kage:file"])).write_text(str(h["kage:scene"]))
    (kage.folder / "bumps.png").symlink_to(DATA / "bumps.png")
    again = [part for change in str(h["kage:set"]).split("\n") for part in ("--set", change)]
    kage.good("render", h["kage:file"], *again, "--crop", h["kage:crop"], "-o", "again.exr", "-o", "again.png")
    for ending in ("exr", "png"):
        assert (kage.folder / f"first.{ending}").read_bytes() == (kage.folder / f"again.{ending}").read_bytes()


# ---- what must be the same ----


@pytest.mark.parametrize("scene", [CUBE, SPHERE], ids=["cube", "sphere"])
@pytest.mark.parametrize("aa", [1, 2])
def test_crop_is_that_part_of_the_picture(kage: Kage, scene: Path, aa: int) -> None:
    kage.good("render", scene, *SMALL, "--aa", aa, "--shadow", "2", "-o", "all.exr", "-o", "all.png")
    kage.good("render", scene, *SMALL, "--aa", aa, "--shadow", "2", "-o", "part.exr", "-o", "part.png", "--crop",
              "37,21,120,86")
    whole, part = exr(kage.folder / "all.exr"), exr(kage.folder / "part.exr")
    assert same({name: plane[21:86, 37:120] for name, plane in whole.items()}, part)
    assert (png(kage.folder / "all.png")[21:86, 37:120] == png(kage.folder / "part.png")).all()


@pytest.mark.parametrize("crop", ["0,0,1,1", "159,119,160,120", "0,5,160,6", "3,0,4,120"])
def test_thin_crops(kage: Kage, crop: str) -> None:
    kage.good("render", CUBE, *SMALL, "--crop", crop, "-o", "a.png")
    kage.good("render", CUBE, *SMALL, "-o", "b.png")
    x0, y0, x1, y1 = map(int, crop.split(","))
    assert (png(kage.folder / "a.png") == png(kage.folder / "b.png")[y0:y1, x0:x1]).all()


@pytest.mark.parametrize("size", [(1, 1), (3, 200), (200, 3), (129, 65)])
def test_size(kage: Kage, size: tuple[int, int]) -> None:
    kage.good("render", CUBE, "--size", f"{size[0]}x{size[1]}", "-o", "a.png")
    assert Image.open(kage.folder / "a.png").size == size


def test_aa_averages_the_samples(kage: Kage) -> None:
    """2 x 2 samples a pixel are the four pixels of the picture of twice the size."""
    kage.good("render", CUBE, "--size", "80x60", "--aa", "2", "-o", "a.exr")
    kage.good("render", CUBE, "--size", "160x120", "-o", "b.exr")
    coarse, fine = exr(kage.folder / "a.exr"), exr(kage.folder / "b.exr")
    for name in ("R", "G", "B", "visibility.lamp"):
        mean = fine[name].reshape(60, 2, 80, 2).mean((1, 3))
        assert np.mean(np.abs(coarse[name] - mean) > 1e-5) < 0.002, name  # a hit on an edge may go either way


def test_set_is_an_edited_scene(kage: Kage) -> None:
    edited = CUBE.read_text().replace("scale: 0.22", "scale: 0.1").replace("from: [0, 3.9, -5.2]", "from: [0, 3, -5.2]")
    (kage.folder / "bumps.png").symlink_to(DATA / "bumps.png")
    (kage.folder / "edited.yaml").write_text(edited)
    kage.good("render", "edited.yaml", *SMALL, "-o", "a.exr")
    kage.good("render", CUBE, *SMALL, "-o", "b.exr", "--set", "objects.ground.bump.scale=0.1", "--set",
              "camera.from.1=3")
    assert same(exr(kage.folder / "a.exr"), exr(kage.folder / "b.exr"))


def test_set_adds_removes_nothing_else(kage: Kage) -> None:
    add = "objects.moon={sphere: {center: [1, 2, 0], radius: 0.3}, material: blue}"
    text = kage.good("check", CUBE, "--set", add, "--set", "objects.moon.sphere.radius=0.4")
    assert "object moon: sphere, material blue" in text
    assert "object cube: box, material blue" in text


@pytest.mark.parametrize("scene", [CUBE, SPHERE], ids=["cube", "sphere"])
def test_any_number_of_threads_gives_the_same_bytes(kage: Kage, scene: Path) -> None:
    for threads in (1, 2, 7):
        kage.good("render", scene, *SMALL, "--aa", 2, "--threads", threads, "-o", f"{threads}.png", "-o",
                  f"{threads}.exr")
    for ending in ("png", "exr"):
        pictures = {(kage.folder / f"{threads}.{ending}").read_bytes() for threads in (1, 2, 7)}
        assert len(pictures) == 1


def test_any_working_directory_gives_the_same_bytes(kage: Kage) -> None:
    out = kage.folder
    kage.good("render", CUBE, *SMALL, "-o", out / "a.exr", cwd=Path("/"))
    kage.good("render", "cube.yaml", *SMALL, "-o", out / "b.exr", cwd=CUBE.parent)
    kage.good("render", "data/cube.yaml", *SMALL, "-o", out / "c.exr", cwd=TOP / "tests")
    assert len({(out / f"{name}.exr").read_bytes() for name in "abc"}) == 1


def test_every_method_is_the_same_where_the_surface_is_flat(kage: Kage) -> None:
    flat = ("--set", "objects.ground.bump.scale=0")
    kage.good("render", CUBE, *SMALL, *flat, "--shadow", "none", "-o", "none.png", "-o", "none.exr")
    reference, picture = exr(kage.folder / "none.exr"), png(kage.folder / "none.png")
    for method in METHODS[1:]:
        for guard in ([], ["--no-guard"]):
            kage.good("render", CUBE, *SMALL, *flat, "--shadow", method, *guard, "-o", "a.png", "-o", "a.exr")
            layers = exr(kage.folder / "a.exr")
            assert (png(kage.folder / "a.png") == picture).all(), (method, guard)
            for name in set(reference) - {"order", "tau"}:
                assert layers[name].tobytes() == reference[name].tobytes(), (method, guard, name)
            assert not layers["tau"].any()


# ---- kage pixel ----


def pixel(kage: Kage, scene: Path, x: int, y: int, *options: object) -> tuple[dict[str, list[float]],
                                                                              dict[str, list[str]]]:
    """The values of `kage pixel`, and its two tables as one: method -> columns."""
    head, *tables = kage.good("pixel", scene, f"{x},{y}", *options).split("\n\n")
    values = {}
    for line in head.splitlines():
        name, *rest = re.sub(r" to | in tau", " ", line).split()
        try:
            values[name] = [float(v) for v in rest]
        except ValueError:
            continue
    rows: dict[str, list[str]] = {}
    for line in [line for table in tables for line in table.splitlines()[1:]]:
        assert len(line) <= 80
        match = re.match(r"(\S+(?: bare)?)\s+(.*)", line)
        assert match
        rows.setdefault(match[1], []).extend(match[2].split())
    return values, rows


PIXELS = [(80, 60), (75, 75), (10, 110), (150, 70), (60, 90), (83, 49), (79, 30)]


@pytest.mark.parametrize("scene", [CUBE, SPHERE], ids=["cube", "sphere"])
@pytest.mark.parametrize("method", ["none", "0", "1", "2", "2+", "march:4", "1 bare", "2 bare"])
def test_pixel_agrees_with_the_layers(kage: Kage, scene: Path, method: str) -> None:
    name, _, bare = method.partition(" ")
    options = ["--no-guard"] if bare else []
    kage.good("render", scene, *SMALL, "--shadow", name, *options, "-o", "a.exr")
    layers = exr(kage.folder / "a.exr")
    bumped = 0
    for x, y in PIXELS:
        at = {layer: float(plane[y, x]) for layer, plane in layers.items()}
        values, rows = pixel(kage, scene, x, y, *SMALL)
        if "t_hit" not in values:
            assert not rows and at["N.X"] == at["N.Y"] == at["N.Z"] == 0
            continue
        near = {"rel": 1e-6, "abs": 1e-6}
        assert at["Z"] == pytest.approx(values["t_hit"][0], **near)
        assert [at["P.X"], at["P.Y"], at["P.Z"]] == pytest.approx(values["Q"], rel=1e-5, abs=1e-5)
        assert [at["uw.u"], at["uw.w"]] == pytest.approx([values["u"][0], values["w"][0]], **near)
        normal = np.array(values.get("n'", values["n"]))
        assert [at["N.X"], at["N.Y"], at["N.Z"]] == pytest.approx(list(normal / np.linalg.norm(normal)), **near)
        row = rows[method]
        assert [at["R"], at["G"], at["B"]] == pytest.approx([float(v) for v in row[-3:]], abs=6e-5)
        assert at["visibility.lamp"] == (row[-4] == "lit")
        if "P" in values:
            bumped += 1
            assert at["height"] == pytest.approx(values["P"][0], **near)
            assert at["tau"] == pytest.approx(float(row[0]), rel=1e-5, abs=1e-6)
            fell = row[5] if len(row) == 10 else name
            code = {"none": -1, "0": 0, "1": 1, "2": 2, "2+": 3, "iter": 4, "march": 5}[fell.partition(":")[0]]
            assert at["order"] == code
    assert bumped >= 2


# ---- as a program ----


def test_stats(kage: Kage) -> None:
    text = kage.good("render", CUBE, *SMALL, "--stats", "--shadow", "2", "-o", "a.png")
    for stage in ("render", "camera", "hit", "sort", "surface", "bump", "normal", "shift", "shadow", "shade", "film",
                  "output"):
        assert re.search(rf"^ *{stage} +[\d.]+ ms", text, re.MULTILINE), stage
    assert "Mrays/s" in text
    assert re.search(r"camera rays 19200, shadow rays \d+, height look-ups \d+", text)
    assert re.search(r"bumped samples \d+ by method 2, fell back \d+ \([\d.]+ %\); by order", text)


def test_no_progress_without_a_terminal(kage: Kage) -> None:
    assert kage.good("render", CUBE, "--size", "1600x1200", "--aa", "2", "-o", "a.png") == ""


def on_terminal(kage: Kage, *arguments: object, columns: int = 0) -> tuple[int, str]:
    """Run with a terminal behind stderr; (status, what it was sent). columns: 0: it does not say."""
    master, slave = pty.openpty()
    termios.tcsetwinsize(slave, (24, columns))
    command = [str(PROGRAM), *map(str, arguments)]
    process = subprocess.Popen(command, cwd=kage.folder, stdin=slave, stdout=subprocess.DEVNULL, stderr=slave)
    os.close(slave)
    said = b""
    while True:
        try:
            part = os.read(master, 4096)
        except OSError:  # Linux: the other end is closed
            break
        if not part:
            break
        said += part
    os.close(master)
    return process.wait(), said.decode()


def shown(said: str) -> list[str]:
    """The lines left on a terminal that was sent this."""
    lines = []
    for line in said.replace("\r\n", "\n").split("\n"):
        screen = ""
        for part in line.split("\r"):
            at = 0
            for k, text in enumerate(part.split("\x1b[K")):
                screen = screen[:at] + text + screen[at + len(text) :]
                at += len(text)
                if part.count("\x1b[K") > k:
                    screen = screen[:at]
        lines.append(screen.rstrip())
    return [line for line in lines if line]


def test_progress_on_a_terminal(kage: Kage) -> None:
    status, said = on_terminal(
        kage, "render", CUBE, "--size", "2400x1800", "--aa", "3", "--threads", "1", "--crop", "0,0,2400,1200", "-o",
        "a.png"
    )
    assert status == 0
    bars = re.findall(r"\rcube\.yaml \[(#*)(\.*)\] +(\d+) %  [\d.]+ Mpixel/s  [\d.]+ s left", said)
    assert bars
    assert all(len(done) + len(left) == 30 for done, left, _ in bars)
    shares = [int(share) for _, _, share in bars]
    assert shares == sorted(shares)
    left = shown(said)
    assert len(left) == 1
    assert re.fullmatch(r"cube\.yaml: [\d.]+ s; a\.png", left[0])


@pytest.mark.parametrize("columns", [60, 80, 100])
def test_a_terminal_is_not_wider_than_it_is(kage: Kage, columns: int) -> None:
    """Messages are broken at words, but not the lines of a scene."""
    arguments = ("render", CUBE, "--set", "render.shadow=best", "--quiet")
    said = kage(*arguments).stderr
    assert max(map(len, said.splitlines())) > 100
    status, shows = on_terminal(kage, *arguments, columns=columns)
    assert status == 2
    lines = shows.replace("\r\n", "\n").splitlines()
    assert max(len(line) for line in lines if not re.match(r" +(\d+)? \| ", line)) <= columns
    assert re.sub(r"\s+", " ", shows) == re.sub(r"\s+", " ", said)


def test_the_bar_fits_into_a_narrow_terminal(kage: Kage) -> None:
    status, shows = on_terminal(kage, "render", CUBE, "--size", "1600x1200", "--aa", "3", "--threads", "1", "-o",
                                "a.png", columns=60)
    bars = [bar for bar in re.split(r"\r|\n", shows.replace("\x1b[K", "")) if "[" in bar]
    assert status == 0 and bars
    assert max(map(len, bars)) < 60


def test_quiet_on_a_terminal(kage: Kage) -> None:
    assert on_terminal(kage, "render", CUBE, "--size", "800x600", "--aa", "4", "--quiet", "-o", "a.png") == (0, "")


@pytest.mark.parametrize("name", ["none/a.png", "none/a.exr", "folder.png", "folder.exr"])
def test_output_that_cannot_be_written(kage: Kage, name: str) -> None:
    (kage.folder / "folder.png").mkdir()
    (kage.folder / "folder.exr").mkdir()
    before = kage.files()
    done = kage("render", CUBE, *SMALL, "-o", name)
    assert (done.returncode, done.stdout) == (1, "")
    why = "Is a directory" if name.startswith("folder") else "No such file or directory"
    assert done.stderr == f"{name}: cannot be written: {why}\n"
    assert kage.files() == before


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full on this system")
@pytest.mark.parametrize("ending", ["png", "exr"])
def test_full_disk(kage: Kage, ending: str) -> None:
    (kage.folder / f"full.{ending}").symlink_to("/dev/full")
    before = kage.files()
    done = kage("render", CUBE, *SMALL, "-o", f"full.{ending}")
    assert (done.returncode, done.stderr) == (1, f"full.{ending}: cannot be written: No space left on device\n")
    assert kage.files() == before


@pytest.mark.parametrize("name", ["none/a.png", "none/a.exr"])
def test_outputs_are_probed_before_the_render(kage: Kage, name: str) -> None:
    """The picture would take hours."""
    command = [PROGRAM, "render", str(CUBE), "--size", "16384x16384", "--aa", "16", "-o", "b.png", "-o", name]
    done = subprocess.run(command, cwd=kage.folder, capture_output=True, text=True, timeout=20, check=False)
    assert (done.returncode, done.stderr) == (1, f"{name}: cannot be written: No such file or directory\n")
    assert kage.files() == set()


# ---- in bands ----


#: Five bands or so.
BANDS = ("--size", "2048x1400", "--threads", "2")


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("whole") / "a.exr"
    subprocess.run([PROGRAM, "render", CUBE, *BANDS, "--quiet", "-o", path], check=True)
    return path.read_bytes()


def test_a_killed_picture_is_resumed(kage: Kage, whole: bytes) -> None:
    command = [PROGRAM, "render", CUBE, *BANDS, "--resume", "-o", "a.exr"]
    part = kage.folder / "a.exr.part"
    kept: list[int] = []
    for more in (1, 1 << 20, 3 << 20, 1 << 23):
        process = start(command, cwd=kage.folder)
        size = kept[-1] if kept else 0
        while process.poll() is None and not (part.exists() and part.stat().st_size >= size + more):
            time.sleep(0.003)
        process.kill()
        process.wait()
        if part.exists():
            kept.append(part.stat().st_size)
    assert len(kept) >= 2 and kept == sorted(kept)
    kage.good("render", CUBE, *BANDS, "--resume", "-o", "a.exr")
    assert (kage.folder / "a.exr").read_bytes() == whole
    assert kage.files() == {"a.exr"}


def test_an_interrupted_picture_is_resumed(kage: Kage, whole: bytes) -> None:
    process = start([PROGRAM, "render", CUBE, *BANDS, "--resume", "-o", "a.exr"], cwd=kage.folder, text=True,
                    stderr=subprocess.PIPE)
    part = kage.folder / "a.exr.part"
    while not (part.exists() and part.stat().st_size > 1 << 20):
        assert process.poll() is None
        time.sleep(0.003)
    process.send_signal(signal.SIGINT)
    said = process.communicate(timeout=60)[1]
    assert process.returncode == -signal.SIGINT
    assert re.fullmatch(r"cube.yaml: stopped while (rendering|writing), after \d+ %; "
                        r"--resume goes on with a.exr.part\n", said)
    assert kage.files() == {"a.exr.part"}
    another = kage("render", CUBE, *BANDS, "--shadow", "1", "--resume", "-o", "a.exr")
    assert another.returncode == 1
    assert "there is a part of another picture" in another.stderr
    kage.good("render", CUBE, *BANDS, "--resume", "-o", "a.exr")
    assert (kage.folder / "a.exr").read_bytes() == whole
    assert kage.files() == {"a.exr"}


def test_a_large_picture_is_written_in_bands(kage: Kage) -> None:
    """As its rows are those of its crop, which is small enough for a film."""
    size = ("--size", "4100x4100", "--layers", "color", "--set", "render.shadow=none")
    kage.good("render", CUBE, *size, "-o", "a.exr")
    kage.good("render", CUBE, *size, "--crop", "0,3000,4100,3064", "-o", "b.exr")
    rows, crop = exr(kage.folder / "a.exr"), exr(kage.folder / "b.exr")
    assert rows.keys() == crop.keys() == {"R", "G", "B"}
    assert same({name: rows[name][3000:3064] for name in rows}, crop)


@pytest.mark.parametrize(("outputs", "why"), [
    (["-o", "a.png"], "--resume: expected one -o, with a name that ends in .exr"),
    (["-o", "a.exr", "-o", "b.exr"], "--resume: expected one -o, with a name that ends in .exr"),
])
def test_what_cannot_be_resumed(kage: Kage, outputs: list[str], why: str) -> None:
    assert refuses(kage, "render", CUBE, "--resume", *outputs) == f"kage: {why}\n"


def test_too_large_for_two_outputs(kage: Kage) -> None:
    told = "kage: -o b.png: a second output of 1073741824 pixels, expected one, or at most 268435456 pixels\n"
    assert refuses(kage, "render", CUBE, "--size", "32768x32768", "-o", "a.exr", "-o", "b.png") == told


def test_a_part_replaces_no_other_file(kage: Kage) -> None:
    (kage.folder / "a.exr.part").write_text("precious")
    done = kage("render", CUBE, *SMALL, "--resume", "-o", "a.exr")
    assert done.returncode == 1
    assert done.stderr.startswith("a.exr.part: cannot be written: there is a file that is no unfinished picture")
    assert (kage.folder / "a.exr.part").read_text() == "precious"


# ---- what no output replaces ----

PATCH = ("0 0 0, 0 0 1, 0 0 2, 0 0 3, 1 0 0, 1 1 1, 1 1 2, 1 0 3, "
         "2 0 0, 2 1 1, 2 1 2, 2 0 3, 3 0 0, 3 0 1, 3 0 2, 3 0 3\n")
MADE_FROM = """
  cloth: {patches: {file: "data/cloth"}, material: clay}
  roof: {mesh: {file: roof.obj}, material: clay}
  model: {mesh: {file: model.gltf}, material: tiles}
"""


def grey(path: Path) -> None:
    Image.fromarray((np.arange(48).reshape(6, 8) * 5).astype(np.uint8)).save(path, "PNG")


def write_hill(kage: Kage) -> dict[str, bytes]:
    """A scene with every kind of file that it can be made from. What is in the folder."""
    folder = kage.folder
    (folder / "data").mkdir()
    grey(folder / "hill.png")
    grey(folder / "tiles.exr")  # its first bytes say what it is
    (folder / "data" / "cloth").write_text(PATCH)
    (folder / "roof.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    models.gltf(folder / "model.gltf", models.ball(8, 4), buffer="model.bin")
    scene = SCENE.replace("map.png", "hill.png").replace("materials:",
                                                         "materials:\n  tiles: {color: {image: {file: tiles.exr}}}")
    (folder / "hill.yaml").write_text(scene + MADE_FROM.strip("\n") + "\n")
    return contents(kage)


def contents(kage: Kage) -> dict[str, bytes]:
    return {name: (kage.folder / name).read_bytes() for name in kage.files() if (kage.folder / name).is_file()}


INPUTS = ["hill.yaml", "hill.png", "tiles.exr", "data/cloth", "roof.obj", "model.gltf", "model.bin"]


def refuses(kage: Kage, *arguments: object) -> str:
    before = contents(kage)
    done = kage(*arguments)
    assert (done.returncode, done.stdout) == (2, ""), done.stderr
    assert contents(kage) == before
    return done.stderr


@pytest.mark.parametrize(("link", "ending"), [("symbolic", "png"), ("symbolic", "pov"), ("hard", "exr")])
@pytest.mark.parametrize("name", INPUTS)
def test_no_output_is_an_input(kage: Kage, name: str, link: str, ending: str) -> None:
    write_hill(kage)
    output = kage.folder / f"link.{ending}"
    if link == "hard":
        output.hardlink_to(kage.folder / name)
    else:
        output.symlink_to(name)
    command = "pov" if ending == "pov" else "render"
    told = f"link.{ending}: the scene is made from this file, expected -o with another name\n"
    assert refuses(kage, command, "hill.yaml", "-o", output.name) == f"kage: {told}"
    if command == "render":
        assert refuses(kage, command, "hill.yaml", "-o", "good.png", "-o", output, "--overwrite").endswith(told)
    output.unlink()
    kage.good(command, "hill.yaml", "-o", output.name)


def test_no_output_is_an_input_by_its_own_name(kage: Kage) -> None:
    write_hill(kage)
    for name in ("hill.png", "./data/../hill.png", "tiles.exr"):
        assert refuses(kage, "render", "hill.yaml", "-o",
                       name) == f"kage: {name}: the scene is made from this file, expected -o with another name\n"
    for more in ([], ["--overwrite"]):
        assert refuses(kage, "render", "hill.yaml",
                       *more) == "kage: hill.png: the scene is made from this file, expected -o with another name\n"


def test_the_default_output_replaces_no_other_file(kage: Kage) -> None:
    plain = "\n".join(line for line in SCENE.split("\n") if "map.png" not in line)
    (kage.folder / "plain.yaml").write_text(plain)
    output = kage.folder / "plain.png"
    grey(output)
    data = output.read_bytes()
    for other in (data, data[:40], b"", b"a text", data[:8] + b"\0\0\0\0tEXt"):
        output.write_bytes(other)
        assert refuses(kage, "render", "plain.yaml") == (
            "kage: plain.png: kage did not write this file, expected -o with another name, or --overwrite\n")
    kage.good("render", "plain.yaml", "--overwrite")
    made = output.read_bytes()
    kage.good("render", "plain.yaml", "--shadow", "2")  # its own
    assert output.read_bytes() != made
    grey(output)
    kage.good("render", "plain.yaml", "-o", "plain.png")  # as was asked for
    kage.good("render", "plain.yaml", "--set", "camera.up=[0, 1, 0]  # ä")  # whose texts are UTF-8
    kage.good("render", "plain.yaml")
