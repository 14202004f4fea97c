"""The completions of bash, zsh and fish, typed into the real shells; and what `kage complete` answers them."""

from __future__ import annotations

import os
import pty
import re
import select
import shutil
import signal
import time
from pathlib import Path

import pytest

from tests.conftest import PROGRAM, SCENE, TOP, Kage

#: How a shell is started without the settings of a user, and what makes it know the completions.
SHELLS = {
    "bash": (["bash", "--norc", "--noprofile", "-i"], "bind 'set bell-style none'; source {completions}/kage.bash"),
    "zsh": (["zsh", "-f", "-i"], "fpath=({completions} $fpath); autoload -Uz compinit; compinit -u -D"),
    "fish": (["fish", "--no-config", "-i"], "source {completions}/kage.fish"),
}


#: Stands for kage: only completes, and otherwise tells its arguments.
WRAPPER = """#!/bin/sh
[ "$1" = complete ] && exec {} "$@"
printf 'RAN:'
printf '[%s]' "$@"
printf ':END'
echo
"""


@pytest.fixture
def folder(kage: Kage) -> Path:
    (kage.folder / "scene.yaml").write_text(SCENE)
    (kage.folder / "scene.txt").write_text("none\n")
    (kage.folder / "pictures").mkdir()
    return kage.folder


# ---- kage complete ----


def complete(kage: Kage, *words: str) -> list[str]:
    """The words that are offered, with their kind."""
    return [line.partition("\t")[0] for line in kage.good("complete", *words).splitlines()]


@pytest.mark.parametrize(("words", "offered"), [
    (["re"], ["=render"]),
    (["help", "p"], ["=pixel", "=pov"]),
    (["render", "--sha"], ["=--shadow", "=--shade"]),
    (["render", "--shadow", "m"], ["+march:"]),
    (["render", "--shadow=a"], ["=--shadow=auto"]),
    (["render", "--bump-shadow", ""], ["=none", "+march:", "=horizon", "=exact"]),
    (["check", "--limit", "expr"], ["+expression=", "+expression-nesting="]),
    (["view", "--limit=si"], ["+--limit=side="]),
    (["render", "--layers", "color,or"], ["=color,order"]),
    (["render", ""], ["."]),
    (["render", "-o", ""], ["."]),
    (["render", "--output=p"], [".--output="]),
    (["render", "-op"], [".-o"]),
    (["pixel", "scene.yaml", ""], []),
    (["render", "scene.yaml", "--set", "objects."],
     ["+objects.ground.", "+objects.wall.", "+objects.cube.", "+objects.ball."]),
    (["render", "--quiet", "scene.yaml", "--set", "camera.f"], ["+camera.from.", "+camera.fov="]),
    (["check", "scene.yaml", "--set", "camera.fov="], ["=camera.fov=40"]),
    (["check", "scene.yaml", "--set=camera.from.1="], ["=--set=camera.from.1=3"]),
    (["render", "scene.yaml", "--set", "render.shadow=ma"], ["+render.shadow=march:"]),
    (["render", "missing.yaml", "--set", "ca"], []),
    (["render", "scene.txt", "--set", "ca"], []),
    (["render", "--", "--q"], ["."]),
    (["nothing", ""], []),
    ([], []),
])
def test_words(kage: Kage, folder: Path, words: list[str], offered: list[str]) -> None:
    assert complete(kage, *words) == offered


def test_every_option_is_offered(kage: Kage) -> None:
    for name in ("render", "view", "check", "pixel", "pov", "import"):
        listed = re.findall(r"^  (?:-\w, |    )(--[\w-]+)", kage.good("help", name), re.MULTILINE)
        assert complete(kage, name, "-") == [f"={option}" for option in listed]


# ---- the shells ----


class Shell:
    """A shell on a terminal of its own, into which a test types."""

    def __init__(self, name: str, folder: Path) -> None:
        if not shutil.which(name):
            assert not os.environ.get("CI"), f"CI has no {name}"
            pytest.skip(f"no {name}")
        command, setup = SHELLS[name]
        (folder / "bin").mkdir()
        wrapper = folder / "bin" / "kage"
        wrapper.write_text(WRAPPER.format(PROGRAM))
        wrapper.chmod(0o755)
        home = folder / "home"
        home.mkdir()
        environment = {"PATH": f"{folder / 'bin'}:{os.environ['PATH']}", "TERM": "xterm", "HOME": str(home),
                       "PS1": "> ", "LANG": "C.UTF-8", "XDG_CONFIG_HOME": str(home), "XDG_DATA_HOME": str(home)}
        self.process, self.terminal = pty.fork()
        if self.process == 0:
            os.chdir(folder)
            os.execvpe(command[0], command, environment)  # noqa: S606
        self.said = ""
        self.type(setup.format(completions=TOP / "completions") + "; echo read''y\r")
        self.wait_for(r"ready\r?\n")

    def type(self, text: str) -> None:
        os.write(self.terminal, text.encode())

    def wait_for(self, pattern: str) -> str:
        """Read until this was said since the last call; fail after a minute."""
        end = time.monotonic() + 60
        while not (found := re.search(pattern, self.said)):
            ready, _, _ = select.select([self.terminal], [], [], 1)
            assert time.monotonic() < end, f"no {pattern!r} in {self.said!r}"
            if ready:
                self.said += plain(os.read(self.terminal, 4096).decode(errors="replace"))
        self.said = self.said[found.end() :]
        return found[0]

    def run(self, typed: str) -> str:
        """Type a line, with tabs, and Enter: the arguments that kage is then started with."""
        self.type(typed + "\r")
        return self.wait_for(r"RAN:.*?:END")[len("RAN:") : -len(":END")]

    def end(self) -> None:
        os.kill(self.process, signal.SIGKILL)
        os.waitpid(self.process, 0)
        os.close(self.terminal)


def plain(text: str) -> str:
    """Without the terminal's controls."""
    return re.sub(r"\x1b(\[[0-9;?<>=]*[a-zA-Z]|\][^\x07\x1b]*(\x07|\x1b\\)|[()][A-Z0-9]|[=>])", "", text)


@pytest.mark.parametrize("name", SHELLS)
def test_in_a_shell(folder: Path, name: str) -> None:
    shell = Shell(name, folder)
    try:
        for typed, arguments in {
            "kage chec\tx": "[check][x]",
            "kage render sc\t--qui\t": "[render][scene.yaml][--quiet]",
            "kage render scene.yaml --shado\t mar\t8": "[render][scene.yaml][--shadow][march:8]",
            "kage check scene.yaml --set cam\tfo\t4": "[check][scene.yaml][--set][camera.fov=4]",
            "kage check scene.yaml --set objects.ground.bump.f\t\t":
                "[check][scene.yaml][--set][objects.ground.bump.function=0.1 * sin(u)]",
            "kage check scene.yaml --set=camera.fo\t9": "[check][scene.yaml][--set=camera.fov=9]",
            "kage render scene.yaml -o pic\t1.png": "[render][scene.yaml][-o][pictures/1.png]",
            "kage render --output=pic\t1.png": "[render][--output=pictures/1.png]",
            "kage render --layers color,hei\t": "[render][--layers][color,height]",
        }.items():
            assert shell.run(typed) == arguments, typed
        shell.type("kage \t\t")
        shell.wait_for(r"(?s)check.*import.*render.*view")
    finally:
        shell.end()
