"""The references: those that are committed are good; and whatever POV-Ray does, reference/render.py leaves no bad one.

POV-Ray is a fake here, a script first in PATH that does as FAKE_POVRAY says. Its pictures are rough: flat colours, a
square of shadow.
"""

from __future__ import annotations

import importlib.util
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import references
from PIL import Image

from tests.conftest import PROGRAM, TOP, start

RENDER = TOP / "reference" / "render.py"


def load() -> ModuleType:
    """As `reference_render`: plain `render` is a name that others have, too."""
    spec = importlib.util.spec_from_file_location("reference_render", RENDER)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules["reference_render"] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


render = load()

FAKE = """#!/bin/sh
if [ "$1" = --version ]; then
    if [ $FAKE_POVRAY = stranger ]; then echo hello; else echo POV-Ray 3.7.0.fake; fi
    exit
fi
for word; do
    case $word in
    +I*) scene=${{word#+I}} ;;
    +O*) out=${{word#+O}} ;;
    esac
done
echo "$@" >> {folder}/log
test -s "$scene" || exit 9
shot=${{out##*/waves-}}
case $FAKE_POVRAY-$shot in
fails-late-mask-dark* | fails-self*) echo Parse Error: something >&2; exit 1 ;;
nothing-*) exit ;;
garbage-*) echo no picture > "$out"; exit ;;
half-*) printf 'v/1\\001 and no more' > "$out"; kill -9 $$ ;;
sleeps-*) echo $$ > {folder}/pid; exec sleep 60 ;;
holes-*) echo 'Warning: The maximum gradient found was 2.0, but max_gradient of the
isosurface was set to 1.0. The isosurface may contain holes!' >&2 ;;
slow-*) echo 'Warning: ... Adjust max_gradient to get a faster rendering of the isosurface.' >&2 ;;
nan-* | small-*) shot=$FAKE_POVRAY.exr ;;
noshadow-mask-cast*) shot=mask-nocast.exr ;;
noown-own-1.exr) shot=own-1-none.exr ;;
esac
cp {pictures}/$shot "$out"
"""


SCENE = render.Checked({"lamp": (-4.0, 5.0, -2.5)}, ["cube"])
ALL = 10  # renders for one scene: five for pictures and mask, five for the masks of own shadows
FILES = {"waves.exr", "waves.mask.png", "waves.own.png", "manifest.json"}


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the fake gives for each shot, and two bad ones."""
    folder = tmp_path_factory.mktemp("pictures")

    def write(name: str, picture: np.ndarray) -> None:
        references.write_exr(folder / f"{name}.exr", {c: picture[..., i] for i, c in enumerate("RGB")})

    for shot in (*render.shots(["lamp"]), *render.own_shots(SCENE)):
        picture = np.full((shot.size[1], shot.size[0], 3), 0.5)  # the receiver in the light
        if shot.name == "own-1":  # the red lamp is the lowest
            picture[:20, :20, 0], picture[:10, :10, 1] = 0.1, 0.1
        elif shot.name in ("self", "cast", "mask-cast"):
            picture[:20, :20] = 0.2
        if shot.name in ("mask-dark", "own-dark"):
            picture[:] = 0.0984, 0.0864, 0.0696  # clay: colour times ambient
        picture[:, -10:] = 0.01  # another object
        write(shot.name, picture)
    write("nan", np.full((240, 320, 3), np.nan))
    write("small", np.full((239, 320, 3), 0.5))
    return folder


class Studio:
    """A folder of references, a fake POV-Ray, and the program that makes the one with the other."""

    def __init__(self, folder: Path, pictures: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.folder, self.log, self.monkeypatch = folder / "reference", folder / "log", monkeypatch
        fake = folder / "bin" / "povray"
        fake.parent.mkdir()
        fake.write_text(FAKE.format(folder=folder, pictures=pictures))
        fake.chmod(0o755)
        monkeypatch.setenv("PATH", str(fake.parent), prepend=os.pathsep)
        monkeypatch.setattr(render, "WORK", folder / "work")

    def arguments(self, *more: str) -> list[str]:
        return ["waves", "--kage", str(PROGRAM), "--folder", str(self.folder), *more]

    def make(self, mode: str, *more: str) -> int:
        self.monkeypatch.setenv("FAKE_POVRAY", mode)
        return int(render.main(self.arguments(*more)))

    def renders(self) -> int:
        return len(self.log.read_text().splitlines()) if self.log.exists() else 0

    def files(self) -> dict[str, bytes]:
        return {path.name: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}

    def entry(self, name: str = "waves") -> dict[str, object]:
        return references.read_manifest(self.folder)[name]


@pytest.fixture
def studio(tmp_path: Path, pictures: Path, monkeypatch: pytest.MonkeyPatch) -> Studio:
    return Studio(tmp_path, pictures, monkeypatch)


# ---- the committed ones ----


@pytest.mark.parametrize("name", references.SCENES)
def test_committed(name: str) -> None:
    """Of the scene as it is now, by the commands as they are now, with the pixels of the manifest. (What `kage pov`
    writes is looked at by `make reference`: meshes take a while.)"""
    scene = render.check(PROGRAM, render.scene_path(name))
    digest = references.scene_digest(TOP / render.scene_path(name))
    for entry, plan in ((name, render.shots(scene.lights)), (references.own_entry(name), render.own_shots(scene))):
        wanted = {"scene": digest, "commands": render.commands(name, plan)}
        assert references.why_stale(entry, wanted) == "", "make reference"
    reference = references.load(name)
    assert {picture.shape for picture in reference.pictures.values()} == {(240, 320, 3)}
    assert reference.mask.shape == (480, 640)
    assert set(np.unique(reference.mask)) <= {references.ELSEWHERE, references.AWAY, references.SHADOW, references.LIT}
    assert (reference.mask == references.SHADOW).sum() > 5000
    own = references.load_own(name)
    assert tuple(own.masks) == references.ELEVATIONS and {mask.shape for mask in own.masks.values()} == {(480, 640)}
    assert (own.masks[min(own.masks)] == references.SHADOW).sum() > 5000
    files = references.files(name) + references.files(references.own_entry(name))
    assert all((references.FOLDER / file).stat().st_size < 500_000 for file in files)


def test_every_scene_has_one() -> None:
    assert sorted(path.stem for path in (TOP / "scenes").glob("*.yaml")) == sorted(references.SCENES)
    entries = {entry for name in references.SCENES for entry in (name, references.own_entry(name))}
    assert references.read_manifest().keys() == entries
    wanted = {file for entry in entries for file in references.files(entry)}
    assert {path.name for path in references.FOLDER.iterdir() if path.suffix in (".exr", ".png")} == wanted


# ---- what is made, and when ----


def test_makes_then_leaves_alone(studio: Studio, capsys: pytest.CaptureFixture[str]) -> None:
    assert studio.make("good") == 0
    assert studio.renders() == ALL
    assert studio.files().keys() == FILES
    reference = references.load("waves", studio.folder)
    assert reference.digest() == studio.entry()["pixels"]
    assert studio.entry()["povray"] == "POV-Ray 3.7.0.fake"
    want = np.full((480, 640), references.LIT, dtype=np.uint8)
    want[:20, :20], want[:, -10:] = references.SHADOW, references.ELSEWHERE
    assert (reference.mask == want).all()
    own = references.load_own("waves", studio.folder)
    assert own.digest() == studio.entry("waves.own")["pixels"]
    for mask, side in zip(own.masks.values(), (20, 10, 0, 0, 0), strict=True):
        want = np.full((480, 640), references.LIT, dtype=np.uint8)
        want[:side, :side], want[:, -10:] = references.SHADOW, references.ELSEWHERE
        assert (mask == want).all()
    assert capsys.readouterr().out == "".join(f"{entry}: stale (not in the manifest)\n{entry}: made\n"
                                              for entry in ("waves", "waves.own"))
    assert not list(render.WORK.glob("*.pov"))  # meshes are large

    before = studio.files()
    assert studio.make("good") == 0 and studio.make("good", "--check") == 0
    assert capsys.readouterr().out == "waves: good\nwaves.own: good\n" * 2
    assert studio.renders() == ALL and studio.files() == before
    assert studio.make("slow", "--all") == 0  # a warning that it could be faster is no reason to fail
    assert studio.renders() == 2 * ALL and studio.files() == before


def test_check_only_tells(studio: Studio, capsys: pytest.CaptureFixture[str]) -> None:
    assert studio.make("good", "--check") == 1
    assert capsys.readouterr().out == "".join(f"{entry}: stale (not in the manifest)\n"
                                              for entry in ("waves", "waves.own"))
    assert studio.renders() == 0 and not studio.files()


@pytest.mark.parametrize("entry", ["waves", "waves.own"])
@pytest.mark.parametrize("key", ["scene", "export", "povray", "commands", "pixels"])
def test_stale(studio: Studio, key: str, entry: str, capsys: pytest.CaptureFixture[str]) -> None:
    studio.make("good")
    before = studio.files()
    manifest = references.read_manifest(studio.folder)
    manifest[entry][key] = "what it was once"
    references.write_manifest(manifest, studio.folder)
    assert studio.make("good", "--check") == 1
    reason = "other pixels than the manifest's" if key == "pixels" else f"another {key}"
    assert f"{entry}: stale ({reason})" in capsys.readouterr().out
    assert studio.make("good") == 0
    assert studio.renders() == ALL + ALL // 2  # the other one is left alone
    assert studio.files() == before


@pytest.mark.parametrize("file", sorted(FILES))
@pytest.mark.parametrize("content", [None, b"half a fi"])
def test_broken_files(studio: Studio, file: str, content: bytes | None) -> None:
    studio.make("good")
    before = studio.files()
    path = studio.folder / file
    path.unlink() if content is None else path.write_bytes(content)
    assert studio.make("good", "--check") == 1
    assert studio.make("good") == 0
    assert studio.files() == before


def test_changed_pixels(studio: Studio) -> None:
    studio.make("good")
    path = studio.folder / "waves.mask.png"
    mask = np.array(Image.open(path))
    mask[100, 100] = references.SHADOW
    Image.fromarray(mask).save(path)
    assert studio.make("good", "--check") == 1


def test_scene_digest_knows_maps(tmp_path: Path) -> None:
    shutil.copy(TOP / "scenes" / "cube.yaml", tmp_path)
    shutil.copytree(TOP / "scenes" / "data", tmp_path / "data")
    scene = tmp_path / "cube.yaml"
    first = references.scene_digest(scene)
    assert first == references.scene_digest(TOP / "scenes" / "cube.yaml")
    with (tmp_path / "data" / "bumps.png").open("ab") as file:
        file.write(b"x")
    second = references.scene_digest(scene)
    scene.write_text(scene.read_text() + "\n")
    assert len({first, second, references.scene_digest(scene)}) == 3


# ---- what may go wrong ----

FAILURES = {
    "fails": "status 1\nParse Error: something",
    "fails-late": "status 1\nParse Error: something",
    "holes": "max_gradient too low",
    "half": "killed by signal 9",
    "nothing": "no good picture came out",
    "garbage": "no good picture came out",
    "nan": "values that are no numbers",
    "small": "another size",
    "noshadow": "show no shadow on the receiver",
    "noown": "show no shadow of the bumps",
}
ONE_FAILS = {"fails": ("waves",), "fails-late": ("waves",), "noshadow": ("waves",), "noown": ("waves.own",)}


@pytest.mark.parametrize("mode", FAILURES)
def test_failures(studio: Studio, mode: str, capsys: pytest.CaptureFixture[str]) -> None:
    """One message for each entry that can't be made; of it nothing is made, and what was there stays as it was: good,
    or stale and known to be."""
    bad = ONE_FAILS.get(mode, ("waves", "waves.own"))
    assert studio.make(mode) == 1
    err = capsys.readouterr().err
    assert [line.split(": ")[1] for line in err.splitlines() if line.startswith("render.py: ")] == list(bad)
    assert FAILURES[mode] in err
    assert not studio.files().keys() & {file for entry in bad for file in references.files(entry)}
    assert studio.make("good") == 0
    before = studio.files()
    assert studio.make(mode, "--all") == 1
    assert studio.files() == before


def test_a_coarse_mesh_is_no_truth(studio: Studio, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """kage writes a file all the same, and says so on stderr alone."""
    kage = tmp_path / "kage"
    kage.write_text(f'#!/bin/sh\n{PROGRAM} "$@" || exit\n'
                    '[ "$1" != pov ] || echo "kage: object ground: coarse mesh: heights are off by up to 0.1, 9 '
                    'pixels" >&2\n')
    kage.chmod(0o755)
    assert studio.make("good", "--kage", str(kage)) == 1
    assert "no truth comes of it: kage: object ground: coarse mesh" in capsys.readouterr().err
    assert not studio.files() and not list(render.WORK.glob("*.pov"))


def test_old_picture_does_not_pass_for_a_new_one(studio: Studio) -> None:
    studio.make("good")
    assert studio.make("nothing", "--all") == 1


@pytest.mark.parametrize("mode, words", [("stranger", "does not tell its version"), ("missing", "POV-Ray is missing")])
def test_no_povray(studio: Studio, mode: str, words: str, capsys: pytest.CaptureFixture[str]) -> None:
    if mode == "missing":
        studio.monkeypatch.setenv("PATH", str(studio.folder))
    assert studio.make(mode) == 1
    err = capsys.readouterr().err
    assert words in err and len(err.splitlines()) == 1
    assert not studio.files()


def test_check_needs_no_povray(studio: Studio, capsys: pytest.CaptureFixture[str]) -> None:
    studio.make("good")
    studio.monkeypatch.setenv("PATH", str(studio.folder))
    assert studio.make("good", "--check") == 0
    out = capsys.readouterr().out
    assert "its version is not compared" in out and out.endswith("waves: good\nwaves.own: good\n")


def test_interrupted_between_files(studio: Studio) -> None:
    """The manifest comes last: without it, new pixels are not what the old one says."""
    studio.make("good")
    reference = references.load("waves", studio.folder)
    reference.mask[200, 200] = references.SHADOW

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    with studio.monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(references, "write_manifest", stop)
        render.keep("waves", reference, studio.entry(), studio.folder)
    assert studio.make("good", "--check") == 1
    assert studio.make("good") == 0
    assert studio.files().keys() == FILES


def runs(pid: int) -> bool:
    """Whether there is such a process; one that has ended may stay as a zombie until somebody collects it."""
    state = subprocess.run(["ps", "-o", "stat=", "-p", str(pid)], capture_output=True, text=True, check=False).stdout
    return state.strip() != "" and not state.startswith("Z")


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_interrupted(studio: Studio, how: signal.Signals) -> None:
    """POV-Ray ends with the program, and nothing is left."""
    env = os.environ | {"FAKE_POVRAY": "sleeps"}
    process = start([sys.executable, RENDER, *studio.arguments()], env=env, stdout=subprocess.PIPE,
                    stderr=subprocess.PIPE,
                    text=True)
    pid = studio.log.with_name("pid")
    for _ in range(300):
        if pid.exists() and pid.read_text():
            break
        time.sleep(0.1)
    process.send_signal(how)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 130
    assert err == "render.py: interrupted; what is not made stays stale\n"
    assert not studio.files()
    assert not runs(int(pid.read_text()))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupted_while_povray_starts(monkeypatch: pytest.MonkeyPatch, number: signal.Signals) -> None:
    """The process is there, and Popen has not returned: on a busy machine the signal came then, and POV-Ray went on."""
    started: list[int] = []

    class Slow(subprocess.Popen):  # type: ignore[type-arg]
        def __init__(self, *arguments: Any, **options: Any) -> None:
            super().__init__(*arguments, **options)
            started.append(self.pid)
            signal.raise_signal(number)

    monkeypatch.setattr(subprocess, "Popen", Slow)
    with pytest.raises(KeyboardInterrupt):
        render.run(["sleep", "60"])
    monkeypatch.undo()
    assert len(started) == 1 and not runs(started[0])


def test_usage(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments, words in [(["nosuch"], "'nosuch' is none of the scenes"), (["--check", "--all"], "can't go with"),
                             (["--kage", "/nosuch"], "is not there")]:
        with pytest.raises(SystemExit) as stop:
            render.main(arguments)
        assert stop.value.code == 2 and words in capsys.readouterr().err


def test_manifest_is_plain(studio: Studio) -> None:
    """Nothing of the machine or the day in it: the same references give the same bytes."""
    text = (references.FOLDER / "manifest.json").read_text()
    assert json.loads(text).keys() >= set(references.SCENES)
    assert str(TOP) not in text and "tmp" not in text
