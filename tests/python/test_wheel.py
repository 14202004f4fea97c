"""The wheel: built, complete, installed into a fresh environment of Python, and used from there."""

from __future__ import annotations

import re
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import PROGRAM, TOP

#: What every system of a manylinux tag has.
SYSTEM = re.compile(r"lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s|z)\.so\.\d+$")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    done = subprocess.run([sys.executable, "-m", "scripts.wheel", "-o", folder, "--build", PROGRAM.parent], cwd=TOP,
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return next(folder.glob("*.whl"))


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The Python of a new environment with the wheel. numpy, cffi and tqdm are lent to it: no network is needed."""
    folder = tmp_path_factory.mktemp("fresh") / "venv"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
    lent = Path(np.__file__).parents[1]
    site = next(folder.glob("lib/python3*/site-packages"))
    subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--target", site,
                    wheel], check=True)
    (site / "lent.pth").write_text(f"{lent}\n")
    return folder / "bin" / "python"


def test_it_is_for_all_pythons_from_3_11_on(wheel: Path) -> None:
    assert re.fullmatch(r"kage-[\d.]+-cp311-abi3-manylinux_\d+_\d+_x86_64\.whl", wheel.name)
    names = zipfile.ZipFile(wheel).namelist()
    needed = ("py.typed", "kage-import", "_kage.abi3.so", "sweep/__init__.py", "sweep/index.html.jinja")
    assert {f"kage/{name}" for name in needed} <= set(names)
    libraries = [name for name in names if name.startswith("kage.libs/")]
    licenses = [name for name in names if ".dist-info/licenses/" in name]
    assert any("libembree" in name for name in libraries) and any("libassimp" in name for name in libraries)
    assert any("embree" in name for name in licenses) and any("assimp" in name for name in licenses)


def test_it_works_where_it_is_installed(installed: Path, tmp_path: Path) -> None:
    text = f"""
import kage, kage.methods
scene = kage.load({str(TOP / "scenes" / "gallery" / "wall.yaml")!r})
picture = scene.render(size=(64, 48))
assert picture.rgb.max() > 0.1 and scene.info.objects[1].model.triangles > 0
picture.save("x.png")
print(kage.__file__)
"""
    done = subprocess.run([installed, "-I", "-c", text], cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert str(installed.parents[1]) in done.stdout and (tmp_path / "x.png").exists()


def test_it_brings_its_libraries_along(installed: Path) -> None:
    folder = next(installed.parents[1].glob("lib/python3*/site-packages/kage"))
    for file in (folder / "_kage.abi3.so", folder / "_methods.abi3.so", folder / "kage-import"):
        text = subprocess.run(["ldd", file], check=True, capture_output=True, text=True).stdout
        assert "not found" not in text
        for name, path in re.findall(r"(\S+) => (\S+)", text):
            assert str(folder.parent) in str(Path(path).resolve()) or SYSTEM.search(name), f"{file.name} uses {path}"
