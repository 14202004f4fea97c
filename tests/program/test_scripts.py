"""The scripts around the tracer: bootstrap, venv, the height maps, the contact sheet.

Nothing is installed here: bootstrap and venv run with a PATH that holds only stand-ins for the programs
they would call, which write down their arguments.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from scripts import same
from tests.conftest import TOP

SCRIPTS = TOP / "scripts"
DATA = TOP / "scenes" / "data"

Result = subprocess.CompletedProcess


def run_python(script: str, *arguments: object, cwd: Path | None = None) -> Result[str]:
    """Run one of the Python scripts as a user would."""
    command = [sys.executable, str(SCRIPTS / script), *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=120)


class Machine:
    """A directory of stand-ins that is all of PATH, and a log of what they were asked to do."""

    REAL = ("sh", "cat", "env", "tail", "mktemp", "rm", "mv", "mkdir", "dirname", "chmod", "printf")

    def __init__(self, root: Path) -> None:
        self.bin = root / "bin"
        self.log = root / "log"
        self.state = root / "state"
        self.bin.mkdir()
        self.state.mkdir()
        for name in self.REAL:
            path = shutil.which(name)
            assert path, name
            (self.bin / name).symlink_to(path)
        self.program("id", "echo 0")

    def program(self, name: str, body: str = "exit 0") -> None:
        """Put a shell script into PATH under this name."""
        path = self.bin / name
        path.write_text(f'#!/bin/sh\necho "{name} $*" >>"{self.log}"\n{body}\n')
        path.chmod(0o755)

    def everything(self, without: Iterable[str] = ()) -> None:
        """All that kage needs, less what the test wants missing."""
        for name in ("cc", "clang", "make", "python3", "povray", "valgrind", "chromium", "chromedriver", "pkg-config"):
            if name not in without:
                self.program(name)
        if "pkg-config" not in without:
            # Libraries are missing for as long as nothing has been "installed".
            absent = "|".join(f"*'{name}'*" for name in without) or "''"
            self.program("pkg-config", f'[ -e "{self.state}/installed" ] || case "$*" in {absent}) exit 1 ;; esac')

    def apt(self, install: str = "", update: str = "") -> None:
        """apt-get, whose install makes the libraries appear unless the text given here says otherwise."""
        self.program(
            "apt-get",
            f'case "$*" in\n*" install "*) {install or f": >{self.state}/installed"} ;;\n'
            f'*" update "*) {update or ":"} ;;\nesac',
        )

    def run(self, script: Path, *arguments: str, **environment: str) -> Result[str]:
        return subprocess.run(
            ["/bin/sh", str(script), *arguments],
            env={"PATH": str(self.bin), "TMPDIR": str(self.state), **environment},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=60,
        )

    def bootstrap(self, *arguments: str, **environment: str) -> Result[str]:
        return self.run(SCRIPTS / "bootstrap", *arguments, **environment)

    def calls(self, name: str) -> list[str]:
        lines = self.log.read_text().splitlines() if self.log.exists() else []
        return [line for line in lines if line.split()[0] == name]


@pytest.fixture
def machine(tmp_path: Path) -> Machine:
    return Machine(tmp_path)


# bootstrap -----------------------------------------------------------------------------------------


def test_bootstrap_is_silent_where_nothing_is_missing(machine: Machine) -> None:
    machine.everything()
    machine.apt()
    result = machine.bootstrap("build", "test", "python", "povray", "valgrind", "browser")
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    assert machine.calls("apt-get") == []
    assert machine.bootstrap(BOOTSTRAP="no").returncode == 0


def test_bootstrap_installs_exactly_what_is_missing(machine: Machine) -> None:
    machine.everything(without=["libfyaml", "cmocka"])
    machine.apt()
    result = machine.bootstrap()
    assert result.returncode == 0
    assert result.stderr == "bootstrap: installing with apt-get: libfyaml-dev libcmocka-dev\n"
    (call,) = machine.calls("apt-get")
    assert call.split("--no-install-recommends")[1].split() == ["libfyaml-dev", "libcmocka-dev"]
    assert list(machine.state.iterdir()) == [machine.state / "installed"], "the log is removed"


def test_bootstrap_tests_only_the_groups_named(machine: Machine) -> None:
    machine.everything(without=["cmocka", "povray"])
    machine.apt()
    assert machine.bootstrap("build", "python").returncode == 0
    result = machine.bootstrap("povray", BOOTSTRAP="no")
    assert result.returncode == 1
    assert "missing: POV-Ray\n" in result.stderr
    assert machine.calls("apt-get") == []


def test_bootstrap_no_reports_everything_and_installs_nothing(machine: Machine) -> None:
    machine.apt()
    result = machine.bootstrap(BOOTSTRAP="no")
    assert result.returncode == 1
    for label in ("C compiler (cc)", "make", "pkg-config", "libpng", "libfyaml", "OpenEXR", "cmocka", "python3"):
        assert label in result.stderr
    assert "type: scripts/bootstrap build test python" in result.stderr
    assert "POV-Ray" not in result.stderr
    assert machine.calls("apt-get") == []


@pytest.mark.parametrize("mode", ["yes", "no"])
def test_bootstrap_without_apt_prints_the_packages_of_each_system(machine: Machine, mode: str) -> None:
    machine.everything(without=["libpng", "OpenEXR"])
    result = machine.bootstrap(BOOTSTRAP=mode)
    assert result.returncode == 1
    assert "missing: libpng, OpenEXR >= 3.1\n" in result.stderr
    assert "apt-get install libpng-dev libopenexr-dev\n" in result.stderr
    assert "dnf install libpng-devel openexr-devel\n" in result.stderr
    assert "pacman -S libpng openexr\n" in result.stderr
    assert "brew install libpng openexr\n" in result.stderr


def test_bootstrap_fetches_the_package_lists_only_where_the_first_try_fails(machine: Machine) -> None:
    machine.everything(without=["libpng"])
    lists, installed = machine.state / "lists", machine.state / "installed"
    machine.apt(install=f'[ -e "{lists}" ] && : >"{installed}"', update=f': >"{lists}"')
    assert machine.bootstrap().returncode == 0
    kinds = [next(word for word in call.split() if word in ("install", "update")) for call in machine.calls("apt-get")]
    assert kinds == ["install", "update", "install"]


@pytest.mark.parametrize("step", ["install", "update"])
def test_bootstrap_says_that_apt_failed(machine: Machine, step: str) -> None:
    machine.everything(without=["libpng"])
    update = "" if step == "install" else "echo E: no route; exit 100"
    machine.apt(install="echo E: no such package; exit 100", update=update)
    result = machine.bootstrap()
    assert result.returncode == 1
    assert ("E: no such package" if step == "install" else "E: no route") in result.stderr
    assert f"apt-get {step} failed" in result.stderr
    assert "By hand: apt-get update && apt-get install libpng-dev" in result.stderr


def test_bootstrap_tests_again_after_installing(machine: Machine) -> None:
    machine.everything(without=["libpng"])
    machine.apt(install="exit 0")
    result = machine.bootstrap()
    assert result.returncode == 1
    assert "still not usable: libpng." in result.stderr


def test_bootstrap_uses_sudo_where_it_is_not_root(machine: Machine) -> None:
    machine.everything(without=["libpng"])
    machine.apt()
    machine.program("id", "echo 1000")
    result = machine.bootstrap()
    assert result.returncode == 1
    assert "cannot install without root or sudo; as root type: apt-get install libpng-dev" in result.stderr

    machine.program("sudo", "exit 1")
    result = machine.bootstrap()
    assert result.returncode == 1
    assert "type: sudo apt-get install libpng-dev" in result.stderr

    machine.program("sudo", 'shift; exec "$@"')
    (machine.bin / "true").symlink_to(shutil.which("true") or "")
    assert machine.bootstrap().returncode == 0
    assert "DEBIAN_FRONTEND=noninteractive apt-get" in machine.calls("sudo")[-1]


def test_bootstrap_wants_the_openmp_of_a_clang(machine: Machine) -> None:
    machine.everything()
    machine.apt()
    machine.program("clang-14", 'case "$*" in *-fopenmp*) exit 1 ;; esac')
    result = machine.bootstrap("build", BOOTSTRAP="no", CC="clang-14")
    assert result.returncode == 1
    assert "missing: OpenMP for clang-14\n" in result.stderr
    assert "apt-get install libomp-14-dev)" in result.stderr
    assert machine.bootstrap("build", CC="clang").returncode == 0


def test_bootstrap_explains_itself_and_its_wrong_use(machine: Machine) -> None:
    result = machine.bootstrap("--help")
    assert result.returncode == 0 and result.stdout.startswith("usage: scripts/bootstrap")
    result = machine.bootstrap("tests")
    assert result.returncode == 2 and "unknown group 'tests'" in result.stderr
    result = machine.bootstrap(BOOTSTRAP="maybe")
    assert result.returncode == 2 and "must be yes or no" in result.stderr


# venv ----------------------------------------------------------------------------------------------


@pytest.fixture
def project(machine: Machine, tmp_path: Path) -> Path:
    """A copy of scripts/venv with a python3 whose venv is a stand-in, too: pip only writes its name down."""
    top = tmp_path / "project"
    (top / "scripts").mkdir(parents=True)
    shutil.copy(SCRIPTS / "venv", top / "scripts" / "venv")
    (top / "requirements.txt").write_text("numpy==1\n")
    inner = tmp_path / "inner"
    inner.write_text(
        "#!/bin/sh\n"
        f'case "$*" in --version) echo Python 3 ;; "-m pip "*) echo "pip $*" >>"{machine.log}"; '
        f'[ ! -e "{machine.state}/offline" ] ;; *) echo "ran: $*" ;; esac\n'
    )
    inner.chmod(0o755)
    machine.program("python3", f'mkdir -p "$3/bin" && cat "{inner}" >"$3/bin/python" && chmod 755 "$3/bin/python"')
    return top


def test_venv_is_made_once_and_again_when_the_requirements_change(machine: Machine, project: Path) -> None:
    script = project / "scripts" / "venv"
    first = machine.run(script, "python", "a b", "c")
    assert (first.returncode, first.stdout) == (0, "ran: a b c\n")
    assert first.stderr == "venv: making .venv with the packages of requirements.txt, which takes minutes\n"
    again = machine.run(script)
    assert (again.returncode, again.stdout, again.stderr) == (0, "", "")
    assert len(machine.calls("pip")) == 1
    (project / "requirements.txt").write_text("numpy==2\n")
    assert machine.run(script).returncode == 0
    assert len(machine.calls("pip")) == 2


def test_venv_that_was_interrupted_is_made_again(machine: Machine, project: Path) -> None:
    script = project / "scripts" / "venv"
    offline = machine.state / "offline"
    offline.touch()
    result = machine.run(script, "python")
    assert result.returncode == 1 and "venv: failed" in result.stderr and result.stdout == ""
    offline.unlink()
    (project / ".venv" / "leftover").touch()
    assert machine.run(script).returncode == 0
    assert not (project / ".venv" / "leftover").exists()
    (project / ".venv" / "stamp").unlink()
    assert machine.run(script).returncode == 0
    assert len(machine.calls("pip")) == 3


# The height maps -----------------------------------------------------------------------------------


@pytest.mark.parametrize("script, name", [("make_bumps.py", "bumps.png"), ("make_dem.py", "jacksboro.exr")])
def test_maps_are_made_again_byte_for_byte(script: str, name: str, tmp_path: Path) -> None:
    result = run_python(script, "-o", tmp_path / "new" / name)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    assert (tmp_path / "new" / name).read_bytes() == (DATA / name).read_bytes()


def test_bumps_are_seamless_smooth_and_use_every_level() -> None:
    with Image.open(DATA / "bumps.png") as image:
        assert image.mode == "I;16" and image.size == (512, 512)
        height = np.asarray(image).astype(np.int64)
    assert (height.min(), height.max()) == (0, 65535)
    for axis in (0, 1):
        # The step across the seam, and the bend there, are no larger than elsewhere.
        step = np.moveaxis(np.roll(height, -1, axis) - height, axis, 0)
        bend = np.roll(step, -1, 0) - step
        assert np.abs(step[-1]).max() <= np.abs(step[:-1]).max()
        assert np.abs(bend[-2:]).max() <= np.abs(bend[:-2]).max()
        # No noise of single samples: a bend differs little from its neighbours'.
        assert np.abs(np.diff(bend, axis=0)).max() < 0.25 * np.abs(bend).max()


def test_elevations_are_the_originals_in_metres() -> None:
    import OpenEXR
    from matplotlib.cbook import get_sample_data

    channels = OpenEXR.File(str(DATA / "jacksboro.exr")).channels()
    assert list(channels) == ["elevation"]
    with get_sample_data("jacksboro_fault_dem.npz") as dem:
        np.testing.assert_array_equal(channels["elevation"].pixels, dem["elevation"])


# The contact sheet ---------------------------------------------------------------------------------


@pytest.fixture
def pictures(tmp_path: Path) -> list[Path]:
    """Four pictures of 320 x 200 pixels of noise."""
    random = np.random.default_rng(4)
    paths = [tmp_path / f"fig{number}.png" for number in range(4, 8)]
    for path in paths:
        Image.fromarray(random.integers(0, 256, (200, 320, 3), dtype=np.uint8)).save(path)
    return paths


def sheet_of(path: Path) -> np.ndarray:
    with Image.open(path) as image:
        assert "Software" not in image.info and "Creation Time" not in image.info
        return np.asarray(image.convert("RGB"))


def test_sheet_holds_every_pixel_where_it_belongs(pictures: list[Path], tmp_path: Path) -> None:
    out = tmp_path / "out" / "sheet.png"
    labelled = [f"{path}=Figure {number}: $a = b$" for number, path in enumerate(pictures, 4)]
    result = run_python("contact_sheet.py", "-o", out, "--title", "Four", *labelled)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    sheet = sheet_of(out)
    assert sheet.shape == (64 + 2 * (200 + 40) + 12, 24 + 3 * (320 + 24), 3)
    for index, path in enumerate(pictures):
        y, x = 64 + index // 3 * 240, 24 + index % 3 * 344
        with Image.open(path) as image:
            np.testing.assert_array_equal(sheet[y : y + 200, x : x + 320], np.asarray(image))
    first = out.read_bytes()
    run_python("contact_sheet.py", "-o", out, "--title", "Four", *labelled)
    assert out.read_bytes() == first


def test_sheet_enlarges_a_crop_with_hard_pixels(pictures: list[Path], tmp_path: Path) -> None:
    out = tmp_path / "sheet.png"
    result = run_python("contact_sheet.py", "-o", out, "--columns", 2, "--crop", "100,50,180,100", *pictures)
    assert result.returncode == 0, result.stderr
    sheet = sheet_of(out)
    assert sheet.shape == (24 + 2 * (200 + 12 + 200 + 40) + 12, 24 + 2 * (320 + 24), 3)
    with Image.open(pictures[1]) as image:
        pixels = np.asarray(image)
    y, x = 24 + 200 + 12, 24 + 344
    enlarged = pixels[50:100, 100:180].repeat(4, axis=0).repeat(4, axis=1)
    np.testing.assert_array_equal(sheet[y : y + 200, x : x + 320], enlarged)
    # The frame lies around the region and leaves the region itself alone.
    np.testing.assert_array_equal(sheet[24 + 50 : 24 + 100, x + 100 : x + 180], pixels[50:100, 100:180])
    assert (sheet[24 + 49, x + 100 : x + 180] == sheet[24 + 49, x + 100]).all()


def test_sheet_reads_16_bit_grey(tmp_path: Path) -> None:
    ramp = np.linspace(0, 65535, 200 * 64).reshape(64, 200).astype(np.uint16)
    Image.fromarray(ramp).save(tmp_path / "grey.png")
    assert run_python("contact_sheet.py", "-o", "sheet.png", "grey.png", cwd=tmp_path).returncode == 0
    np.testing.assert_array_equal(sheet_of(tmp_path / "sheet.png")[24:88, 24:224, 1], np.rint(ramp / 257.0))


def test_sheet_names_every_picture_that_is_missing_or_broken(pictures: list[Path], tmp_path: Path) -> None:
    (tmp_path / "broken.png").write_bytes(pictures[0].read_bytes()[:2000])
    arguments = ["-o", "sheet.png", "fig4.png=4", "none.png=5", "broken.png=6", "gone.png"]
    result = run_python("contact_sheet.py", *arguments, cwd=tmp_path)
    assert result.returncode == 1
    lines = result.stderr.splitlines()
    assert lines[0] == "contact_sheet: none.png: no such picture; has it been rendered?"
    assert lines[1].startswith("contact_sheet: broken.png: cannot be read as a picture")
    assert lines[2] == "contact_sheet: gone.png: no such picture; has it been rendered?"
    assert len(lines) == 3 and not (tmp_path / "sheet.png").exists()


@pytest.mark.parametrize(
    "arguments, status, message",
    [
        (["--crop", "0,0,400,100"], 1, "leaves a picture of 320x200 pixels"),
        (["--crop", "9,9,9,20"], 2, "is empty or negative"),
        (["--crop", "1,2,3"], 2, "is not X0,Y0,X1,Y1"),
        (["--columns", "0"], 2, "not a whole number above 0"),
        (["--title", "far too long " * 40], 1, "is too long for"),
    ],
)
def test_sheet_refuses(pictures: list[Path], tmp_path: Path, arguments: list[str], status: int, message: str) -> None:
    result = run_python("contact_sheet.py", "-o", tmp_path / "sheet.png", *arguments, pictures[0])
    assert result.returncode == status
    assert message in result.stderr and "Traceback" not in result.stderr
    assert not (tmp_path / "sheet.png").exists()


# same ----------------------------------------------------------------------------------------------


def test_same_has_each_command_once() -> None:
    commands = same.commands()
    assert len({name for name, _ in commands}) == len({words for _, words in commands}) == len(commands)
    assert all(any(word.startswith("{}") for word in words) for _, words in commands)


def test_same_compares_what_is_written(tmp_path: Path) -> None:
    """Two stand-ins for kage: one writes other bytes than the other, and one fails."""
    programs = {}
    for name, body in (("a", 'echo a >"$1"'), ("b", 'echo b >"$1"'), ("fails", "exit 2")):
        programs[name] = tmp_path / name
        programs[name].write_text(f"#!/bin/sh\n{body}\n")
        programs[name].chmod(0o755)
    job = ("a job", ("{}.png",))
    assert same.compare(programs["a"], programs["a"], job) == ("a job", [])
    assert same.compare(programs["a"], programs["b"], job) == ("a job", [".png"])
    assert same.compare(programs["a"], programs["fails"], job)[1][0].startswith("status None -> 2")
