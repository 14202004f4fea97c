"""Meshes from files, through the program: the formats, what is wrong with files, the same bytes for any number of
threads, a million triangles, and POV-Ray's picture of them.
"""

from __future__ import annotations

import os
import pty
import random
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

from scripts import make_lantern
from tests.conftest import PROGRAM, TOP, Kage, needs_povray, not_sanitized
from tests.support import models
from tests.support.parity import CAMERA, FLOOR, HEAD, LIGHTS, layers, povray, rgb


def scene(kage: Kage, mesh: str, more: str = "", *, size: str = "[96, 72]", material: str = "clay") -> Path:
    path = kage.folder / "mesh.yaml"
    head = HEAD.format(camera=CAMERA, lights=LIGHTS).replace("[160, 120]", size)
    rest = "".join(f"    {line}\n" for line in more.splitlines())
    path.write_text(head + FLOOR + f"  it:\n    mesh: {{{mesh}}}\n    material: {material}\n" + rest)
    return path


def picture(kage: Kage, path: Path, *options: str) -> dict[str, np.ndarray]:
    kage.good("render", path, "-o", "x.exr", "--quiet", *options)
    return layers(kage.folder / "x.exr")


# ---- what comes in ----


def test_formats_read_alike(kage: Kage) -> None:
    """Of a ball: all pictures are the same but for STL and OFF, which have no normals (those found differ from the
    ball's by less than 1 degree), and no texture. glTF's node has a matrix that is undone, and mirrors."""
    model = models.ball(48, 24)
    paths = models.write_all(kage.folder, model)
    normal = model.normal * (-2, 1, 1)
    turned = models.Model(model.at * (-0.5, 1, 1), normal / np.linalg.norm(normal, axis=1, keepdims=True), model.uv,
                          model.face[:, ::-1])
    models.gltf(kage.folder / "c.glb", turned, [-2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
    first = None
    for path in [*paths, kage.folder / "c.glb"]:
        made = picture(kage, scene(kage, f"file: {path.name}", "transform: [{translate: [0, 1, 0]}]"))
        first = first or made
        bare = path.suffix in (".stl", ".off")
        assert np.abs(rgb(made) - rgb(first)).max() < (0.02 if bare else 1e-5), path.name
        # an edge may be rounded the other way
        assert ((made["Z"] == first["Z"]) | (np.abs(made["Z"] - first["Z"]) < 1e-3)).mean() > 0.999, path.name
        if not bare:
            assert np.abs(made["uw.u"] - first["uw.u"]).max() < 1e-5
            assert np.abs(made["uw.w"] - first["uw.w"]).max() < 1e-5


def test_as_the_sphere(kage: Kage) -> None:
    """A fine ball, its texture from left to right and downward: the same picture as of the sphere itself, with a bump,
    by every method."""
    models.gltf(kage.folder / "ball.glb", models.ball(400, 200))
    place, bump = "transform: [{scale: 0.9}, {translate: [0, 1, 0]}]", "sin(9*{u})*sin(9*{w})*sin({w})^2"
    path = scene(kage, "file: ball.glb",
                 f'bump: {{function: "{bump.format(u="2*pi*u", w="(pi*w)")}", scale: 0.03}}\n{place}')
    mesh = path.read_text()
    # the file's u begins on its +z, kage's -z, where the sphere's is -pi/2
    sphere = mesh.replace("mesh: {file: ball.glb}", "sphere: {center: [0, 0, 0], radius: 1}")
    sphere = sphere.replace(bump.format(u="2*pi*u", w="(pi*w)"), bump.format(u="(u + pi/2)", w="w"))
    for method in ("none", "0", "1", "2", "2+", "iter:3", "march:4", "exact"):
        path.write_text(mesh)
        ours = rgb(picture(kage, path, "--shadow", method))
        path.write_text(sphere)
        off = np.abs(ours - rgb(picture(kage, path, "--shadow", method))).max(axis=-1)
        assert (off < 0.02).mean() > 0.99, (method, (off < 0.02).mean())


def test_smoothing(kage: Kage) -> None:
    """A ball without normals in the file: flat as asked, smooth below the crease, as given otherwise."""
    models.obj(kage.folder / "given.obj", models.ball(12, 6))
    models.obj(kage.folder / "bare.obj", models.ball(12, 6), normals=False)
    place = "transform: [{translate: [0, 1, 0]}]"

    def normals(mesh: str) -> np.ndarray:
        made = picture(kage, scene(kage, mesh, place))
        ball = made["P.Y"] > 1e-3
        return len(np.unique(np.round(np.stack([made[f"N.{a}"][ball] for a in "XYZ"], axis=1), 4), axis=0))

    assert normals("file: given.obj, normals: flat") == normals("file: bare.obj, crease: 5") < 72
    assert min(normals("file: given.obj"), normals("file: bare.obj"), normals("file: given.obj, normals: smooth")) > 500


def test_mirrored_texture(kage: Kage) -> None:
    """Half of a floor has its texture mirrored, as on models that are alike left and right: a bump that is even there
    is one all over."""
    whole = models.grid(8)
    half = models.grid(8)
    half.uv[:, 0] = np.abs(half.at[:, 0])
    whole.uv[:, 0] = whole.at[:, 0]  # this cosine does not tell them apart, nor 1 - u from u
    pictures = []
    for name, model in (("whole", whole), ("half", half)):
        models.gltf(kage.folder / f"{name}.glb", model)
        path = scene(kage, f"file: {name}.glb",
                     'bump: {function: "0.05*cos(4*pi*u)*cos(9*w)"}\ntransform: [{translate: [0, 0.1, 0]}]')
        ball = path.read_text() + "  ball: {sphere: {center: [0.2, 0.8, 0.1], radius: 0.4}, material: clay}\n"
        for transform in ("{translate: [0, 0.1, 0]}", "{scale: [-1, 1, 1]}, {translate: [0, 0.1, 0]}"):
            path.write_text(ball.replace("{translate: [0, 0.1, 0]}", transform))
            pictures += [picture(kage, path, "--shadow", "march:4"), picture(kage, path, "--surface", "displaced")]
    for a, b in zip(pictures[:4], pictures[4:], strict=True):
        assert (np.abs(rgb(a) - rgb(b)).max(axis=-1) < 1e-3).mean() > 0.998
    assert "64 with the texture mirrored" in kage.good("check", path)


def test_image_on_a_mesh(kage: Kage) -> None:
    """An image fills the square of the texture coordinates, its first row at the top, whatever part of it the mesh
    has."""
    from PIL import Image

    Image.fromarray(np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]],
                             dtype=np.uint8)).save(kage.folder / "four.png")
    model = models.grid(4)
    model.uv = 0.25 + 0.25 * model.uv  # within the lower left quarter of the image
    models.gltf(kage.folder / "part.glb", model)
    path = scene(kage, "file: part.glb", "transform: [{translate: [0, 0.2, 0]}]", material="four")
    four = "  four: {color: {image: {file: four.png, interpolation: nearest}}, ambient: 1, diffuse: 0}\nobjects:"
    path.write_text(path.read_text().replace("objects:", four))
    made = picture(kage, path)
    on = made["P.Y"] > 0.1
    assert on.sum() > 500
    assert np.allclose(rgb(made)[on], [0, 0, 1])


# ---- what is wrong ----


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        ("normals: flat", "mesh lacks its 'file'"),
        ("file: none.obj", "'none.obj' can't be used: No such file or directory"),
        ("file: ball.txt", "'ball.txt' can't be used: no known kind of model, expected a name that ends in .obj, .ply, "
                           ".stl, .gltf, .glb, .off, .dae, .fbx or .3ds"),
        ("file: folder.obj", "'folder.obj' can't be used: Is a directory"),
        ("file: empty.ply", "'empty.ply' can't be used: the file is empty"),
        ("file: points.obj", "'points.obj' can't be used: "),
        ("file: thin.obj", "'thin.obj' can't be used: no triangles with an area, expected at least one"),
        ("file: far.obj", "'far.obj' can't be used: a vertex has the coordinate 3e+07, expected -1e+06 to 1e+06"),
        ("file: nan.ply", "'nan.ply' can't be used: a vertex has the coordinate nan, expected -1e+06 to 1e+06"),
        ("file: ball.obj, normals: bent", "expected file, smooth or flat"),
        ("file: ball.obj, crease: 200", "expected an angle of 0 to 180 degrees"),
        ("file: ball.obj, creases: 20", "mesh has no 'creases', did you mean 'crease'?"),
    ],
)
def test_wrong(kage: Kage, mesh: str, message: str) -> None:
    model = models.ball(6, 4)
    models.obj(kage.folder / "ball.obj", model)
    (kage.folder / "ball.txt").write_bytes((kage.folder / "ball.obj").read_bytes())
    (kage.folder / "folder.obj").mkdir()
    (kage.folder / "empty.ply").touch()
    (kage.folder / "points.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\n")
    (kage.folder / "thin.obj").write_text("v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\nf 1 1 2\n")
    (kage.folder / "far.obj").write_text("v 0 0 0\nv 3e7 0 0\nv 0 1 0\nf 1 2 3\n")
    model.at[5, 1] = np.nan
    models.ply(kage.folder / "nan.ply", model, binary=True)
    result = kage("render", scene(kage, mesh), "-o", "x.png")
    assert result.returncode == 2, result.stderr
    assert result.stderr.startswith(f"{kage.folder}/mesh.yaml:1"), result.stderr
    assert message in result.stderr.splitlines()[0], result.stderr
    assert not (kage.folder / "x.png").exists()


def test_no_texture(kage: Kage) -> None:
    """A bump, or a pattern, needs texture coordinates; without both, and as what casts, a mesh does not."""
    models.stl(kage.folder / "ball.stl", models.ball(12, 6), binary=True)
    plain = scene(kage, "file: ball.stl")
    kage.good("render", plain, "-o", "x.png", "--quiet")
    told = "the 120 triangles of 'ball.stl' have no texture coordinates, expected them for a bump or a pattern"
    result = kage("render", scene(kage, "file: ball.stl", 'bump: {function: "0.1*sin(u)"}'), "-o", "x.png")
    assert result.returncode == 2 and told in result.stderr
    tiles = "  tiles: {color: {checker: {even: [1, 1, 1], odd: [0, 0, 0]}}}\nobjects:"
    plain.write_text(scene(kage, "file: ball.stl", material="tiles").read_text().replace("objects:", tiles))
    result = kage("render", plain, "-o", "x.png")
    assert result.returncode == 2 and told in result.stderr


def test_flat_triangles_are_told(kage: Kage) -> None:
    models.obj(kage.folder / "ball.obj", models.ball(6, 4), texture=False)
    (kage.folder / "ball.obj").write_text((kage.folder / "ball.obj").read_text() + "f 1//1 2//2 1//1\nf 9//9 9//9 "
                                                                                   "9//9\n")
    path = scene(kage, "file: ball.obj")
    told = kage("render", path, "-o", "x.png").stderr
    assert "kage: object it: 2 of the 38 triangles in ball.obj have no area; they are left out" in told
    assert "warning: 2 triangles without an area are left out" in kage.good("check", path)


MUTATIONS = [b"999999999", b"-1", b"nan", b"1e39", b"\xff\xff\xff\xff", bytes(4), b"\n", b"f 1 2 99999999\n"]


def is_borne(kage: Kage, path: Path, what: object) -> bool:
    """A picture without a NaN, or an error in the place of the file; whether it is an error."""
    result = kage("render", scene(kage, f"file: {path.name}", size="[24, 18]"), "-o", "x.exr", "--quiet")
    assert result.returncode in (0, 2), (what, result.returncode, result.stderr)
    if result.returncode == 0:
        assert np.isfinite(rgb(layers(kage.folder / "x.exr"))).all(), what
    else:
        assert "can't be used: " in result.stderr and all(c.isprintable() or c == "\n"
                                                          for c in result.stderr), result.stderr
    return result.returncode == 2


def test_broken_files(kage: Kage) -> None:
    """Whatever is in a file: a picture or an error, within seconds; never a crash."""
    chance = random.Random(5)
    sources = models.write_all(kage.folder, models.ball(6, 4))
    wrong = 0
    for k in range(32):
        path = kage.folder / f"broken{sources[k % 8].suffix}"
        text = bytearray(sources[k % 8].read_bytes())
        for _ in range(chance.choice([1, 2, 8])):
            at = chance.randrange(len(text))
            how = chance.randrange(4)
            if how == 0:
                text[at] = chance.randrange(256)
            elif how == 1:
                del text[at : at + chance.randrange(1, 40)]
            elif how == 2:
                text[at:at] = chance.choice(MUTATIONS)
            else:
                del text[max(at, 8) :]
        path.write_bytes(text)
        wrong += is_borne(kage, path, k)
    assert 10 < wrong < 32


def test_files_that_break_the_reader(kage: Kage) -> None:
    """Files that end too soon: of PLY assimp 5.2's reader goes on beyond its memory, or for ever where only some of the
    vertices are there."""
    for source in models.write_all(kage.folder, models.ball(6, 4)):
        path = kage.folder / f"broken{source.suffix}"
        text = source.read_bytes()
        for share in (0.1, 0.6, 0.95):
            path.write_bytes(text[: int(share * len(text))])
            is_borne(kage, path, (source.name, share))
    text = (kage.folder / "a.ply").read_text().splitlines()
    (kage.folder / "broken.ply").write_text("\n".join(text[:27])[:-20])
    assert is_borne(kage, kage.folder / "broken.ply", "cut")


# ---- large and small ----


def test_a_million_triangles(kage: Kage) -> None:
    """They load with a bar on a terminal and render, and POV-Ray's export of them is not tried."""
    models.ply(kage.folder / "big.ply", models.ball(1001, 501), binary=True)
    path = scene(kage, "file: big.ply", "transform: [{translate: [0, 1, 0]}]")
    main, side = pty.openpty()
    run = subprocess.Popen([PROGRAM, "render", path, "-o", kage.folder / "x.exr"], stderr=side, stdout=side,
                           cwd=kage.folder)
    os.close(side)
    shown = b""
    while True:
        try:
            piece = os.read(main, 4096)
        except OSError:
            break
        if not piece:
            break
        shown += piece
    os.close(main)
    assert run.wait(timeout=120) == 0
    assert b"mesh.yaml [" in shown and b"unpacking" in shown and b"building" in shown, shown
    made = layers(kage.folder / "x.exr")
    ball = made["P.Y"] > 1e-3
    at = np.stack([made["P.X"], made["P.Y"] - 1, made["P.Z"]], axis=-1)[ball]
    assert ball.sum() > 300
    assert np.abs(np.linalg.norm(at, axis=1) - 1).max() < 2e-5  # the chords', and half float's


@not_sanitized
def test_memory_that_does_not_suffice(kage: Kage) -> None:
    """Is an error, wherever it ends: also while Embree builds, whose threads would end the process."""
    models.ply(kage.folder / "ball.ply", models.ball(501, 251), binary=True)
    path = scene(kage, "file: ball.ply")
    ends = set()
    for mib in range(120, 480, 30):
        limited = f"ulimit -v {1024 * mib}; exec {PROGRAM} check {path.name}"
        done = subprocess.run(["sh", "-c", limited], cwd=kage.folder, capture_output=True, text=True)
        ends.add(done.returncode)
        assert done.returncode == 0 or re.search("(out of|not enough) memory", done.stderr), f"{mib} MiB: {done}"
    assert ends == {0, 2}


@pytest.mark.parametrize("options", [[], ["--surface", "displaced"]])
def test_threads(kage: Kage, options: list[str]) -> None:
    models.obj(kage.folder / "ball.obj", models.ball(24, 12))
    path = scene(kage, "file: ball.obj",
                 'bump: {function: "0.02*sin(40*u)*sin(20*w)"}\ntransform: [{translate: [0, 1, 0]}]')
    made = []
    for threads in (1, 2, 7):
        kage.good("render", path, "-o", "x.exr", "--quiet", "--threads", str(threads), *options)
        made.append((kage.folder / "x.exr").read_bytes())
    assert made[0] == made[1] == made[2]


def test_lantern_is_what_its_script_makes() -> None:
    assert (TOP / "scenes" / "data" / "lantern.obj").read_text() == make_lantern.text()


# ---- POV-Ray ----


def share(kage: Kage, path: Path, *options: str) -> float:
    kage.good("pov", path, "-o", "x.pov", *options)
    ours = rgb(picture(kage, path, *options))
    theirs, words = povray(kage.folder / "x.pov", (96, 72))
    assert not words.strip()
    off = np.abs(ours - theirs).max(axis=-1)
    return float((off <= np.maximum(1 / 255, np.abs(theirs).max(axis=-1) * 2.0**-10)).mean())


@needs_povray
@pytest.mark.parametrize("model", ["ball", "lantern", "floor", "tiles"])
def test_parity(kage: Kage, model: str) -> None:
    lantern = TOP / "scenes" / "data" / "lantern.obj"
    models.obj(kage.folder / "ball.obj", models.ball(32, 16))
    models.obj(kage.folder / "floor.obj", models.grid(4))
    said = {"ball": "file: ball.obj", "lantern": f"file: {lantern}", "floor": "file: floor.obj",
            "tiles": "file: ball.obj"}[model]
    place = "transform: [{scale: [0.9, 0.8, 1]}, {rotate: [20, 30, 0]}, {translate: [0, 1, 0]}]"
    path = scene(kage, said, place, material="tiles" if model == "tiles" else "shiny")
    checker = "{even: [0.9, 0.85, 0.7], odd: [0.1, 0.2, 0.3], size: [0.125, 0.125]}"
    tiles = f"  tiles: {{color: {{checker: {checker}}}}}\nobjects:"
    path.write_text(path.read_text().replace("objects:", tiles))
    if model == "lantern":
        path.write_text(path.read_text().replace(CAMERA, "{from: [0.6, 1.9, -5], at: [0.7, 0.8, 0], fov: 30}"))
    assert share(kage, path, "--surface", "smooth") >= 0.999
    if model in ("ball", "floor"):
        bump = '{function: "0.03*sin(2*pi*5*u)*sin(pi*9*w)*sin(pi*w)^2"}'
        path = scene(kage, said, place.replace("[0.9, 0.8, 1]", "0.9") + f"\nbump: {bump}", material="shiny")
        assert share(kage, path, "--surface", "displaced") >= 0.995
