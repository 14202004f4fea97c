"""make install, and programs in C and C++ against nothing but what it installs; the library's symbols."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest
from PIL import Image

from tests.conftest import TOP
from tests.support.installed import Installed, install, make

PROGRAM = r"""
#include <kage.h>
#include <stdio.h>
#include <string.h>

int main(int argc, char **argv)
{
    kage_scene *scene;
    kage_film *film;
    kage_errors *errors;
    kage_render_options options = ZERO;
    if (argc != 3 || strcmp(kage_version(), KAGE_VERSION) != 0)
        return 3;
    options.width = 64;
    options.height = 48;
    if (kage_scene_load(argv[1], NULL, &scene, &errors) != KAGE_OK) {
        puts(kage_errors_get(errors, 0)->message);
        kage_errors_free(errors);
        return 1;
    }
    if (kage_render(scene, &options, &film, &errors) != KAGE_OK)
        return 2;
    printf("%s %d %d\n", kage_film_plane_name(film, 0), kage_film_width(film), kage_film_height(film));
    const kage_status status = kage_film_write(film, argv[2], NULL, NULL);
    kage_film_free(film);
    kage_scene_free(scene);
    return status;
}
"""


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Installed:
    return install(tmp_path_factory.mktemp("prefix"))


@pytest.mark.parametrize("static", [False, True], ids=["shared", "static"])
@pytest.mark.parametrize(("ending", "zero"), [("c", "{0}"), ("cpp", "{}")], ids=["C", "C++"])
def test_a_program_against_the_installed_library(installed: Installed, tmp_path: Path, ending: str, zero: str,
                                                 static: bool) -> None:
    source = tmp_path / f"program.{ending}"
    source.write_text(PROGRAM.replace("ZERO", zero))
    program = installed.build(source, tmp_path / "program", static=static)
    picture = tmp_path / "picture.png"
    done = subprocess.run([program, TOP / "scenes" / "cube.yaml", picture], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "R 64 48\n", "")
    same = tmp_path / "same.png"
    subprocess.run([installed.prefix / "bin" / "kage", "render", TOP / "scenes" / "cube.yaml", "--size", "64x48",
                    "--quiet", "-o", same], check=True)
    assert pixels(picture) == pixels(same)


def pixels(path: Path) -> bytes:
    with Image.open(path) as image:
        return image.tobytes()


@pytest.mark.parametrize("static", [False, True], ids=["shared", "static"])
def test_models_are_read_by_the_installed_reader(installed: Installed, tmp_path: Path, static: bool) -> None:
    """From libexec beside the library; of a program that holds the library itself, as KAGE_IMPORT says."""
    source = tmp_path / "program.c"
    source.write_text(PROGRAM.replace("ZERO", "{0}"))
    program = installed.build(source, tmp_path / "program", static=static)
    environment = {name: value for name, value in os.environ.items() if name != "KAGE_IMPORT"}
    reader = installed.prefix / "libexec" / "kage" / "kage-import"
    if static:
        environment["KAGE_IMPORT"] = str(reader)
    scene, picture = TOP / "scenes" / "gallery" / "wall.yaml", tmp_path / "picture.png"
    assert subprocess.run([program, scene, picture], env=environment, stdout=subprocess.DEVNULL).returncode == 0
    moved = reader.with_name("away")
    reader.rename(moved)
    try:
        done = subprocess.run([program, scene, picture], env=environment, capture_output=True, text=True)
    finally:
        moved.rename(reader)
    assert done.returncode == 1
    assert re.search(r"^\S+wall.yaml:\d+:\d+: .*no program .*kage-import to read models", done.stdout)


def test_uninstall_leaves_nothing(tmp_path: Path, installed: Installed) -> None:
    make("install-files", f"DESTDIR={tmp_path}", "PREFIX=/opt/kage")
    files = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if not path.is_dir()}
    assert {"opt/kage/bin/kage", "opt/kage/include/bumpshadow.h", "opt/kage/include/bumpshadow.glsl",
            "opt/kage/share/man/man1/kage.1", "opt/kage/share/man/man5/kage-scene.5", "opt/kage/share/man/man3/kage.3",
            "opt/kage/share/bash-completion/completions/kage", "opt/kage/share/zsh/site-functions/_kage",
            "opt/kage/share/fish/vendor_completions.d/kage.fish"} <= files
    assert str(tmp_path) not in (tmp_path / "opt/kage/lib/pkgconfig/kage.pc").read_text()
    make("uninstall", f"DESTDIR={tmp_path}", "PREFIX=/opt/kage")
    assert [path for path in tmp_path.rglob("*") if not path.is_dir()] == []


def declared() -> set[str]:
    """The functions of kage.h."""
    return set(re.findall(r"KAGE_API[^;(]*?\b(kage_\w+)\(", (TOP / "include" / "kage.h").read_text()))


def symbols(*command: object) -> set[str]:
    text = subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout
    return {line.split()[-1] for line in text.splitlines() if len(line.split()) > 2}


def test_only_what_is_declared_can_be_seen(installed: Installed) -> None:
    assert len(declared()) > 30
    assert symbols("nm", "-D", "--defined-only", installed.library / "libkage.so") == declared()
    assert symbols("nm", "-g", "--defined-only", installed.library / "libkage.a") == declared()


def test_the_library_has_its_name(installed: Installed) -> None:
    text = subprocess.run(["readelf", "-d", installed.library / "libkage.so"], check=True, capture_output=True,
                          text=True).stdout
    assert re.search(r"SONAME.*\[libkage\.so\.\d+\]", text)
    assert "assimp" not in text


@pytest.mark.parametrize("name", ["printf", "puts", "fputs", "exit", "abort", "fork", "vfork", "system", "signal",
                                  "sigaction", "omp_set_num_threads", "setlocale", "stdout", "stderr"])
def test_the_library_does_not_call(installed: Installed, name: str) -> None:
    undefined = subprocess.run(["nm", "-D", "--undefined-only", installed.library / "libkage.so"], check=True,
                               capture_output=True, text=True).stdout
    assert not re.search(rf"\b(__)?{name}(_chk)?(@|$)", undefined, re.MULTILINE)
