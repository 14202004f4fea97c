"""The export to POV-Ray: what is in the file, when it is refused, and what POV-Ray makes of it but for the pictures of
parity.py."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import Kage, needs_povray
from tests.support.parity import (
    CAMERA,
    HEAD,
    LIGHTINGS,
    LIGHTS,
    MAP,
    PLANE,
    POVRAY,
    SIZE,
    STEP,
    SURFACES,
    colored,
    displaced,
    layers,
    povray,
    rgb,
    write_images,
)


def write_scene(kage: Kage, text: str, name: str = "rough") -> Path:
    write_images(kage.folder)
    scene = kage.folder / f"{name}.yaml"
    scene.write_text(text)
    return scene


def write_displaced(kage: Kage, name: str, camera: str = CAMERA) -> Path:
    return write_scene(kage, displaced(name, camera))


@pytest.mark.parametrize("color", ["{image: {file: color.png, wrap: clamp}}",
                                   "{image: {file: color.png, wrap: mirror}}",
                                   "{image: {file: color.png, wrap: clamp, interpolation: nearest, size: [0.5, 1]}}"])
def test_image_that_povray_has_not(kage: Kage, color: str) -> None:
    scene = write_scene(kage, colored(color, "rectangle: {origin: [-1, 2.1, 0.2], u: [2, 0.4, 0.3], w: [0.5, -1.2, "
                                             "0.4]}"), "color")
    done = kage("pov", scene, "-o", "color.pov")
    assert done.returncode == 2
    assert "object it: POV-Ray's images repeat and do nothing else, expected 'wrap: repeat'" in done.stderr
    assert not (kage.folder / "color.pov").exists()
    kage.good("render", scene, "-o", "color.exr", "--quiet")


def mesh_list(text: str, name: str) -> np.ndarray:
    """One list of the first mesh2, a row for each of its vectors."""
    found = re.search(name + r" \{ \d+,([^}]*)\}", text)
    assert found
    return np.array([row.split(",") for row in re.findall(r"<([^>]*)>", found[1])], float)


def test_normals_beyond_a_clamped_map_are_those_of_the_triangles(kage: Kage) -> None:
    """From the places of their corners alone. Pictures cannot tell: POV-Ray shades with the normals that stand in the
    file."""
    text = HEAD.format(camera=CAMERA, lights=LIGHTS)
    scene = write_scene(kage, f"{text}  rough: "
                              f"{{{PLANE}, material: clay, bump: {MAP.replace('[2, 2]', '[1, 1], wrap: clamp')}}}\n")
    kage.good("pov", scene, "-o", "rough.pov", "--surface", "displaced", "--size", "48x36")
    mesh = (kage.folder / "rough.pov").read_text()
    at, normals = mesh_list(mesh, "vertex_vectors"), mesh_list(mesh, "normal_vectors")
    corners = mesh_list(mesh, "face_indices").astype(int)
    a, b, c = (at[corners[:, k]] for k in range(3))
    facets = np.cross(b - a, c - a)
    facets /= np.linalg.norm(facets, axis=1, keepdims=True)
    for axis in (2, 0):  # u, then w; a sample is half a cell inside the edge, and a cell is 1/16
        beyond = np.all((at[corners, axis] < 1 / 32) | (at[corners, axis] > 31 / 32), axis=1)
        assert beyond.sum() > 1000 and np.abs(facets[beyond, axis]).max() < 1e-3
        assert np.abs(normals[corners[beyond], axis]).max() < 1e-6
        assert np.abs(normals[corners[beyond], 2 - axis]).max() > 0.1


@needs_povray
def test_area_light_as_adaptive_0(kage: Kage) -> None:
    """POV-Ray's usual way leaves samples out where the four around them agree: no picture of its own, but close."""
    camera, lights, objects = LIGHTINGS["area uneven"]
    scene = kage.folder / "area.yaml"
    scene.write_text(HEAD.format(camera=camera, lights=lights) + objects)
    kage.good("pov", scene, "-o", "area.pov", "--surface", "smooth")
    kage.good("render", scene, "-o", "area.exr", "--quiet")
    text = (kage.folder / "area.pov").read_text()
    assert "5, 3 adaptive 16 }" in text
    (kage.folder / "area.pov").write_text(text.replace("adaptive 16", "adaptive 0"))
    theirs, words = povray(kage.folder / "area.pov")
    picture = layers(kage.folder / "area.exr")
    assert not words.strip()
    assert np.abs(rgb(picture) - theirs).mean() < 0.5 * STEP
    visible = picture["visibility.a"]
    assert 0.01 < ((visible > 0) & (visible < 1)).mean() < 0.5


@needs_povray
@pytest.mark.parametrize("name", ["box", "three lights", "area", "specular sphere"])
def test_adaptive_samples(kage: Kage, name: str) -> None:
    """POV-Ray compares other neighbours, in a gamma of 2.5, so this is not the same picture, but close."""
    camera, lights, objects = {**SURFACES, **LIGHTINGS}[name]
    scene = kage.folder / "adaptive.yaml"
    scene.write_text(HEAD.format(camera=camera, lights=lights) + objects)
    some = ["--set", "render={aa: 4, aa_threshold: 0.1}"]
    kage.good("pov", scene, "-o", "adaptive.pov", "--surface", "smooth", *some)
    found = re.search(r"// render:.* \+A0\.1 \+AM1 \+R4 -J -D$", (kage.folder / "adaptive.pov").read_text(),
                      re.MULTILINE)
    assert found
    theirs, words = povray(kage.folder / "adaptive.pov", SIZE, "+A0.1", "+AM1", "+R4", "-J")
    pictures = {}
    for file, options in {"one": [], "adaptive": some}.items():
        kage.good("render", scene, "-o", f"{file}.exr", "--quiet", *options)
        pictures[file] = np.abs(rgb(layers(kage.folder / f"{file}.exr")) - theirs).mean()
    assert not words.strip()
    assert pictures["adaptive"] < 0.5 * STEP and pictures["adaptive"] < 0.5 * pictures["one"], pictures


@needs_povray
def test_a_warning_of_holes_is_seen(kage: Kage) -> None:
    """The test above can fail."""
    scene = write_displaced(kage, "plane")
    kage.good("pov", scene, "-o", "rough.pov", "--surface", "displaced")
    text = (kage.folder / "rough.pov").read_text()
    (kage.folder / "low.pov").write_text(re.sub(r"max_gradient \S+", "max_gradient 0.5", text))
    assert "holes" in povray(kage.folder / "low.pov", (100, 75))[1]


@pytest.mark.parametrize("name", ["plane", "plane, map"])
def test_a_plane_reaches_the_edges_of_the_picture(kage: Kage, name: str) -> None:
    """Where the plane was cut too short the background (blue) would be seen."""
    scene = write_displaced(kage, name, "{from: [0, 2, -3], at: [0.5, 0, 0], up: [0.3, 1, 0], fov: 50}")
    kage.good("pov", scene, "-o", "rough.pov", "--surface", "displaced", "--set", "image.background=[0, 0, 9]")
    picture, _ = povray(kage.folder / "rough.pov", (100, 75))
    assert picture[..., 2].max() < 2


def test_horizon(kage: Kage) -> None:
    """An unbounded plane up to the horizon is a file of a bearable size."""
    scene = write_displaced(kage, "plane, map", "{from: [0, 1.2, -5], at: [0, 1.2, 0], fov: 70}")
    kage("pov", scene, "-o", "rough.pov", "--surface", "displaced")
    assert 1e5 < (kage.folder / "rough.pov").stat().st_size < 4e8


# ---- the file ----


def test_file(kage: Kage) -> None:
    scene = write_displaced(kage, "plane")
    before = kage.files()
    kage.good("pov", scene, "-o", "a.pov", "--surface", "displaced", "--set", "objects.rough.bump.scale=0.5")
    text = (kage.folder / "a.pov").read_text()
    lines = text.splitlines()
    assert lines[0] == "// rough.yaml, with its bumps truly displaced, for POV-Ray 3.7"
    assert lines[1].startswith("// made by: kage pov rough.yaml --set 'render.surface=displaced'")
    assert str(kage.folder) not in text and "\t" not in text
    assert "#version 3.7;\nglobal_settings { assumed_gamma 1" in text
    assert "#declare P_rough = function(u, w) { 0.5*(0.03*(sin(6*u)*cos(5.4*w) + 0.5*sin(10.2*u + 6.6*w))) }" in text
    assert "#declare Material_clay = texture {" in text
    kage.good("pov", scene, "-o", "b.pov", "--surface", "displaced", "--set", "objects.rough.bump.scale=0.5")
    assert (kage.folder / "b.pov").read_text() == text
    assert kage.files() == before | {"a.pov", "b.pov"}


def test_shadows(kage: Kage) -> None:
    scene = write_displaced(kage, "plane")

    def without(*options: str) -> list[bool]:
        kage.good("pov", scene, "-o", "a.pov", *options)
        parts = (kage.folder / "a.pov").read_text().split("// object ")[1:]
        return ["no_shadow" in part for part in parts]

    assert without("--surface", "displaced") == [False, False]
    assert without("--surface", "displaced", "--no-self-shadow") == [True, False]
    assert without("--surface", "displaced", "--no-cast") == [False, True]
    assert without("--surface", "smooth", "--no-self-shadow") == [True, False]
    assert without("--surface", "smooth", "--no-cast") == [False, True]


def test_names(kage: Kage) -> None:
    """POV-Ray has no '-' in names, and two names must not become one."""
    scene = write_displaced(kage, "plane")
    text = scene.read_text().replace("  clay:", "  a-b: {}\n  a_b: {}\n  clay:")
    scene.write_text(text.replace("rough:", "rough-one:").replace("material: shiny", "material: a-b"))
    kage.good("pov", scene, "-o", "a.pov", "--surface", "displaced")
    text = (kage.folder / "a.pov").read_text()
    names = re.findall(r"#declare (\S+) =", text)
    assert len(set(names)) == len(names) == 6 and not any("-" in name for name in names)
    if POVRAY:
        povray(kage.folder / "a.pov", (40, 30))


@pytest.mark.parametrize(
    ("arguments", "message", "status"),
    [
        (["pov", "rough.yaml"], "kage: 'kage pov' lacks -o FILE.pov; see kage pov --help\n", 2),
        (["pov", "rough.yaml", "-o", "a.png"], "kage: -o a.png: expected a name that ends in .pov\n", 2),
        (["pov", "rough.yaml", "-o", "a.pov", "-o", "b.pov"], "kage: -o b.pov: a second output, expected one\n", 2),
        (["pov", "rough.yaml", "-o", "a.pov", "--surface", "rough"],
         "kage: --surface rough: expected smooth or displaced\n", 2),
        (["pov", "rough.yaml", "-o", "a.pov", "--aa", "2"],
         "kage: --aa: no option of 'kage pov'; see kage pov --help\n", 2),
        (["pov", "-o", "a.pov"], "kage: 'kage pov' lacks its SCENE; see kage pov --help\n", 2),
        (["pov", "rough.yaml", "-o", "none/a.pov"], "No such file or directory", 1),
        (["pov", "rough.yaml", "-o", "/dev/full/a.pov"], "Not a directory", 1),
        (["pov", "rough.yaml", "-o", "folder.pov"], "Is a directory", 1),
        (["pov", "none.yaml", "-o", "a.pov"], "none.yaml", 2),
    ],
)
def test_errors(kage: Kage, arguments: list[str], message: str, status: int) -> None:
    write_displaced(kage, "plane")
    (kage.folder / "folder.pov").mkdir()
    before = kage.files()
    done = kage(*arguments)
    assert done.returncode == status and message in done.stderr and not done.stdout
    assert kage.files() == before


def test_without_bounds(kage: Kage) -> None:
    scene = write_displaced(kage, "plane")
    done = kage("pov", scene, "-o", "a.pov", "--surface", "displaced", "--set",
                "objects.rough.bump.function='0.1*floor(u)'")
    assert done.returncode == 2 and "no bounds" in done.stderr
    assert not (kage.folder / "a.pov").exists()
    kage.good("pov", scene, "-o", "a.pov", "--surface", "smooth", "--set", "objects.rough.bump.function='0.1*floor(u)'")
