"""libkage as a user has it: installed by make into a folder of its own, and programs built against that alone."""

from __future__ import annotations

import os
import shlex
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.conftest import PROGRAM, SANITIZED, TOP

BUILD = PROGRAM.parent
CC = os.environ.get("KAGE_TEST_CC", "cc")
CXX = os.environ.get("KAGE_TEST_CXX", "c++")


def make(target: str, *settings: str) -> None:
    """Make a target with what is built already, whatever the make around this test was told."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("MAKE", "MFLAGS"))}
    subprocess.run(["make", "-s", target, f"BUILD={BUILD}", *settings], cwd=TOP, env=environment, check=True,
                   capture_output=True)


@dataclass
class Installed:
    prefix: Path

    @property
    def library(self) -> Path:
        return self.prefix / "lib"

    def config(self, *options: str) -> list[str]:
        """What pkg-config says of kage."""
        environment = {**os.environ, "PKG_CONFIG_PATH": str(self.library / "pkgconfig")}
        done = subprocess.run(["pkg-config", *options, "kage"], env=environment, check=True, capture_output=True,
                              text=True)
        return shlex.split(done.stdout)

    def build(self, source: Path, program: Path, *options: str, static: bool = False) -> Path:
        """A program from one source, in C or C++, without a warning."""
        compiler = [CXX, "-std=c++17"] if source.suffix == ".cpp" else [CC, "-std=c99"]
        if static:
            libraries = [word for word in self.config("--libs", "--static") if word != "-lkage"]
            libraries = [str(self.library / "libkage.a"), *libraries]
        else:
            libraries = [*self.config("--libs"), f"-Wl,-rpath,{self.library}"]
        command = [*compiler, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O2", str(source), "-o", str(program),
                   *self.config("--cflags"), *options, *libraries, "-lm"]
        done = subprocess.run(command, capture_output=True, text=True, cwd=program.parent)
        assert done.returncode == 0, done.stderr
        return program


def install(prefix: Path) -> Installed:
    if SANITIZED:
        pytest.skip("a library for a sanitizer is not installed")
    make("install-files", f"PREFIX={prefix}")
    return Installed(prefix)
