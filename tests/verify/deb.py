"""The Debian packages: built by scripts/deb, looked at by lintian, installed, used, and removed again.

    scripts/venv python -m tests.verify.deb [--built FOLDER]

It installs into this system, as root, and removes all of it. --built: a folder of packages that scripts/deb has made.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from scripts import dist
from tests.verify.record import TOP, record

PACKAGES = ("kage", "kage-view", "libkage1", "libkage-dev")


def run(*words: object, cwd: Path = TOP) -> str:
    done = subprocess.run([str(word) for word in words], cwd=cwd, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, words))}:\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


def built() -> tuple[Path, int]:
    """The folder of the packages, and how many errors lintian found."""
    done = subprocess.run(["scripts/deb"], cwd=TOP, capture_output=True, text=True)
    errors = re.findall(r"^E: .*$", done.stdout + done.stderr, re.MULTILINE)
    print("\n".join(errors))
    if done.returncode != 0 and not errors:
        raise RuntimeError(done.stdout[-3000:] + done.stderr[-3000:])
    return TOP / "out" / "deb", len(errors)


def files_of(package: str) -> list[Path]:
    """What a package has put into the system, without folders."""
    return [path for line in run("dpkg", "-L", package).splitlines() if (path := Path(line)).is_file()]


def used(folder: Path) -> list[str]:
    """What does not work as it should, of a render, a model, a program in C, and the manuals."""
    wrong = []
    scene = TOP / "scenes" / "gallery" / "wall.yaml"  # with a model
    run("kage", "render", scene, "--size", "64x48", "--quiet", "-o", "a.png", cwd=folder)
    run("kage", "import", TOP / "scenes" / "models" / "corner.glb", "-o", "a.yaml", cwd=folder)
    flags = run("pkg-config", "--cflags", "--libs", "kage").split()
    run("cc", TOP / "examples" / "render.c", "-o", "render", *flags, cwd=folder)
    run(folder / "render", TOP / "scenes" / "cube.yaml", "b.png", "2", cwd=folder)
    wrong += [f"{name} was not written" for name in ("a.png", "a.yaml", "b.png") if not (folder / name).is_file()]
    if f"{dist.version()}" not in run("kage", "--version"):
        wrong.append("kage --version tells another version")
    if run("pkg-config", "--modversion", "kage").strip() != dist.version():
        wrong.append("kage.pc tells another version")
    return wrong


def main() -> int:
    parser = argparse.ArgumentParser(description="Build, install, use and remove the Debian packages.")
    parser.add_argument("--built", type=Path, help="a folder of packages, in place of building them")
    given = parser.parse_args().built
    if os.geteuid() != 0:
        sys.exit("deb: to install packages it must run as root")
    folder, errors = (given, 0) if given else built()
    found = sorted(folder.glob("*.deb"))
    names = {path.name.split("_")[0] for path in found}
    wrong = [f"no package {name}" for name in PACKAGES if name not in names]
    wanted = [path for path in found if path.name.split("_")[0] in PACKAGES]
    try:
        run("dpkg", "--install", *wanted)
        installed = [path for name in PACKAGES for path in files_of(name)]
        with tempfile.TemporaryDirectory() as work:
            wrong += used(Path(work))
    finally:
        run("dpkg", "--purge", *PACKAGES)
    wrong += [f"{path} is left" for path in installed if path.exists()]
    print("\n".join(wrong))
    return record("deb", {"packages": len(wanted), "files installed and removed": len(installed),
                          "errors of lintian": errors}, len(wrong) + errors)


if __name__ == "__main__":
    sys.exit(main())
