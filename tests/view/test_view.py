"""kage view in a real window: events go in by xdotool, what is seen comes from the X server's screen."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.conftest import PROGRAM, TOP, Kage
from tests.support.display import Display, View, display, until, view

VIEWER = PROGRAM.parent / "kage-view"
SIZE = (480, 270)
#: How the last picture of a scene without antialiasing is made.
FINISH = ("--aa", 3, "--aa-threshold", 0.1)

#: CI must have the window and what the tests need for it: there their absence is a failure.
needs_window = pytest.mark.skipif(
    not (VIEWER.exists() and shutil.which("Xvfb") and shutil.which("xdotool")) and not os.environ.get("CI"),
    reason="no kage-view, Xvfb or xdotool")


@pytest.fixture(scope="module")
def screen(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Display]:
    with display(tmp_path_factory.mktemp("screen")) as on:
        yield on


@pytest.fixture
def scene(kage: Kage) -> Path:
    """Figure 5's, small, with a comment."""
    text = (TOP / "scenes" / "cube.yaml").read_text().replace("[640, 480]", f"[{SIZE[0]}, {SIZE[1]}]")
    (kage.folder / "data").mkdir()
    shutil.copy(TOP / "scenes" / "data" / "bumps.png", kage.folder / "data")
    path = kage.folder / "cube.yaml"
    path.write_text(text)
    return path


def rendered(kage: Kage, scene: Path, *options: object) -> np.ndarray:
    out = kage.folder / "rendered.png"
    kage.good("render", scene, "-o", out, "--quiet", *options)
    return np.asarray(Image.open(out).convert("RGB"))


def shows(window: View, picture: np.ndarray) -> bool:
    """Whether the picture is in the window, to the last bit."""
    return bool((window.pixels(*SIZE) == picture).all())


@needs_window
def test_keys_change_the_picture(kage: Kage, screen: Display, scene: Path) -> None:
    with view(screen, PROGRAM, scene, cwd=kage.folder) as window:
        window.park()
        assert shows(window, rendered(kage, scene, *FINISH))
        for keys, said, options in (
            ("n", "shadow=none", ["--shadow", "none"]),
            ("2", "shadow=2", ["--shadow", "2"]),
            ("m", "shadow=march:8", ["--shadow", "march:8"]),
            ("s", "shade=shifted", ["--shadow", "march:8", "--shade", "shifted"]),
            ("b", "own=march:8", ["--shadow", "march:8", "--shade", "shifted", "--bump-shadow", "march:8"]),
        ):
            window.key(keys)
            window.settle(said)
            assert shows(window, rendered(kage, scene, *options, *FINISH)), said
        window.key("r")
        window.settle("shadow=0 .* shade=smooth own=none")
        screen.do("keydown", "c")
        window.settle("shadow=none")
        screen.do("keyup", "c")
        window.settle("shadow=0")
        window.key("q")
        assert window.process.wait(timeout=60) == 0


@needs_window
def test_the_mouse_changes_the_scene_and_p_saves_it(kage: Kage, screen: Display, scene: Path) -> None:
    """The saved scene has its comments, and renders to the very bytes of the saved picture, which is in the window."""
    with view(screen, PROGRAM, scene, cwd=kage.folder) as window:
        first = window.pixels(*SIZE)
        window.drag(100, 200, 160, 180)
        window.settle()
        window.drag(100, 200, 200, 190, hold="shift")
        window.settle()
        window.mouse(350, 230)
        window.wait("^under 350 230 ground$")
        screen.do("click", 4)
        window.settle()
        window.drag(100, 200, 110, 190, button=3)
        window.settle()
        window.key("1")
        window.settle("shadow=1")
        window.park()
        window.key("p")
        assert window.wait("saved") == "saved cube-view-1.yaml and cube-view-1.png"
        picture = np.asarray(Image.open(kage.folder / "cube-view-1.png").convert("RGB"))
        assert (picture != first).any(axis=2).mean() > 0.5
        assert shows(window, picture)
        window.key("p")
        assert window.wait("saved") == "saved cube-view-2.yaml and cube-view-2.png"
    saved = (kage.folder / "cube-view-1.yaml").read_text()
    assert saved.startswith("# Figures 4 to 7 of the paper") and "# scene units from black to white" in saved
    assert "scale: 0.242" in saved
    before, after = (yaml_numbers(text) for text in (scene.read_text(), saved))
    for key in ("from", "at"):  # the eye, what it looks at, and the lamp
        assert before[key] != after[key]
    kage.good("render", "cube-view-1.yaml", "-o", "again.png", "--quiet")
    assert (kage.folder / "again.png").read_bytes() == (kage.folder / "cube-view-1.png").read_bytes()
    assert "Figures 4 to 7" in scene.read_text() and "scale: 0.22 " in scene.read_text()  # never over it


def yaml_numbers(text: str) -> dict[str, list[str]]:
    return {key: re.findall(rf"\b{key}: (\[[^]]*\])", text) for key in ("from", "at")}


@needs_window
def test_the_split_line_follows_the_mouse(kage: Kage, screen: Display, scene: Path) -> None:
    none, two = (rendered(kage, scene, "--shadow", method, *FINISH) for method in ("none", "2"))
    with view(screen, PROGRAM, scene, "--shadow", "2", cwd=kage.folder) as window:
        window.mouse(240, 100)
        window.key("space")
        window.settle("shadow=2 beside=none")
        for x in (360, 330, 120):
            window.mouse(x, 100)
            # The line and the names beside it are left out, and the pointer.
            right, left = slice(x + 2, None), slice(None, x - 2)

            def is_split(left: slice = left, right: slice = right) -> bool:
                seen = window.pixels(*SIZE)[130:]
                return bool((seen[:, left] == none[130:, left]).all() and (seen[:, right] == two[130:, right]).all())

            assert until(is_split), x
        assert (none[130:] != two[130:]).any()


@needs_window
def test_layers_are_false_colours_with_a_legend(kage: Kage, screen: Display, scene: Path) -> None:
    with view(screen, PROGRAM, scene, cwd=kage.folder) as window:
        window.park()
        seen = {}
        for layer in ("tau", "order", "height"):
            window.key("l")
            window.settle(f"layer={layer}")
            seen[layer] = window.pixels(*SIZE)
        on_cube = 150, 90
        for pixels in seen.values():
            assert tuple(pixels[on_cube[1], on_cube[0]]) == (60, 60, 60)  # without a bump
        assert tuple(seen["order"][250, 400]) == (102, 194, 165)
        ground = seen["tau"][250:, :300].reshape(-1, 3).astype(int)
        assert (ground[:, 0] > ground[:, 2] + 20).any() and (ground[:, 2] > ground[:, 0] + 20).any()
        assert len(np.unique(seen["height"][250:, :300].reshape(-1, 3), axis=0)) > 50


@needs_window
def test_the_file_is_watched(kage: Kage, screen: Display, scene: Path) -> None:
    good = scene.read_text()
    with view(screen, PROGRAM, scene, cwd=kage.folder) as window:
        window.park()
        first = window.pixels(*SIZE)
        scene.write_text(good.replace("shadow: 0", "shadow: 2"))
        window.settle("shadow=2")
        assert shows(window, rendered(kage, scene, *FINISH))

        # Errors are shown over the last good picture, which is dimmed; half of a file is no more than that.
        scene.write_text(good.replace("scale: 0.22", "scael: 0.22"))
        assert window.wait("^errors ").startswith("errors " + str(scene)) and "'scael'" in window.said[-1]
        assert until(lambda: window.pixels(*SIZE).mean() < 0.5 * first.mean())
        scene.write_text(good[: len(good) // 2])
        window.wait("^errors ")
        scene.write_text("")
        scene.write_bytes(bytes(range(256)))
        window.wait("^errors ")
        scene.unlink()

        other = scene.with_suffix(".new")  # as editors do it
        other.write_text(good.replace("shadow: 0", "shadow: none"))
        other.rename(scene)
        window.settle("shadow=none")
        assert shows(window, rendered(kage, scene, *FINISH))
        window.key("q")
        assert window.process.wait(timeout=60) == 0


@needs_window
def test_errors_of_a_look_leave_the_last_picture(kage: Kage, screen: Display, scene: Path) -> None:
    """Such as `exact` for a bump without bounds."""
    text = scene.read_text()
    start, end = text.index("      map: {file"), text.index("  cube:\n    box")
    scene.write_text(text[:start] + "      function: 0.1*u\n" + text[end:])
    with view(screen, PROGRAM, scene, cwd=kage.folder) as window:
        window.key("e")
        assert "bounds" in window.wait("^errors ")
        window.key("0")
        window.wait("^good")


@needs_window
def test_limits_hold_while_it_is_open(kage: Kage, screen: Display, scene: Path) -> None:
    """A picture that is too large, and a scene that has grown. What is wrong stands in the window."""
    objects = len(re.findall(r"material: ", scene.read_text()))
    options = ("--limit", f"objects={objects}", "--max-memory", "4M")
    with view(screen, PROGRAM, *options, scene, cwd=kage.folder) as window:
        words = "there is not enough memory: it needs .* more than the limit of 4 MB"
        window.key("l")  # a layer takes more
        assert re.search(words, window.wait("^errors "))
        scene.write_text(scene.read_text() + "  more: {sphere: {center: [0, 1, 0], radius: 1}, material: clay}\n")
        assert f"expected at most {objects} (--limit objects)" in window.wait("^errors .*objects")


@needs_window
def test_help_and_values_lie_over_the_picture_on_demand(kage: Kage, screen: Display, scene: Path) -> None:
    with view(screen, PROGRAM, scene, cwd=kage.folder) as window:
        window.mouse(400, 20)
        window.wait("^under")
        plain = window.pixels(*SIZE)
        for keys in ("h", "i"):
            window.key(keys)
            assert until(lambda: float((window.pixels(*SIZE) != plain).any(axis=2).mean()) > 0.2), keys
            window.key(keys)
            assert until(lambda: float((window.pixels(*SIZE) != plain).any(axis=2).mean()) < 0.02), keys


@needs_window
def test_the_picture_has_the_size_of_the_window(kage: Kage, screen: Display, scene: Path) -> None:
    with view(screen, PROGRAM, scene, cwd=kage.folder) as window:
        window.park()
        name = screen.do("search", "--pid", window.process.pid).split()[0]
        screen.do("windowsize", name, 600, 400)
        size = re.search(r"size=600x(\d+) ", window.settle("size=600x"))
        assert size and 340 < int(size[1]) < 390  # less the two lines below it
        place = dict(line.split("=") for line in screen.do("getwindowgeometry", "--shell", name).splitlines())
        window.place = int(place["X"]), int(place["Y"])
        picture = rendered(kage, scene, "--size", f"600x{size[1]}", *FINISH)
        assert until(lambda: bool((window.pixels(600, int(size[1])) == picture).all()))


@needs_window
def test_a_wish_of_the_window_manager_to_close_ends_it(kage: Kage, screen: Display, scene: Path) -> None:
    with view(screen, PROGRAM, scene, cwd=kage.folder) as window:
        window.process.terminate()
        assert window.process.wait(timeout=60) == 0


# Without a screen -------------------------------------------------------------------------------------------


@pytest.fixture
def blind(kage: Kage) -> Kage:
    """kage view on SDL's driver without a screen."""
    kage.environment["SDL_VIDEODRIVER"] = "dummy"
    return kage


@needs_window
def test_frames_are_measured(blind: Kage, scene: Path) -> None:
    """Before all other programs, where that is allowed: then the window costs less than the picture itself does."""
    first = ["chrt", "--fifo", "10"]
    alone = shutil.which("chrt") and not subprocess.run([*first, "true"], capture_output=True, check=False).returncode
    done = subprocess.run([*(first if alone else []), PROGRAM, "view", scene, "--size", "960x540", "--frames", "60"],
                          env=blind.environment, capture_output=True, text=True, timeout=300, check=True)
    said = done.stdout
    found = re.fullmatch(r"60 frames of 960x540: from the event to the window ([\d.]+) ms in the median, ([\d.]+) ms "
                         r"for 95 %; ([\d.]+) frames a second; (\d+) full, (\d+) coarse; the picture alone "
                         r"([\d.]+) ms\n", said)
    assert found, said
    whole, slow, rate, full, coarse, picture = map(float, found.groups())
    assert full + coarse == 60 and slow >= whole >= picture > 0 and rate > 0
    assert not alone or whole < 2 * picture


@needs_window
def test_help_lists_mouse_and_keys(kage: Kage) -> None:
    said = kage.good("view", "--help")
    for word in ("kage view SCENE", "shift drag", "wheel", "0 1 2", "c held", "space", "F5", "q Esc"):
        assert word in said


@needs_window
@pytest.mark.parametrize("arguments, message", [
    ([], "lacks its SCENE"),
    (["cube.yaml", "more"], "one argument too many"),
    (["cube.yaml", "--frames", "0"], "--frames 0: expected a number from 1 to 1000000"),
    (["cube.yaml", "--shadow", "3"], "no such method"),
    (["cube.yaml", "-o", "x.png"], "no option of 'kage view'"),
    (["cube.yaml", "--set", "camera.fvo=3"], "did you mean 'fov'?"),
    (["missing.yaml"], "missing.yaml"),
])
def test_wrong_arguments_and_scenes_end_it(blind: Kage, scene: Path, arguments: list[str], message: str) -> None:
    done = blind("view", *arguments)
    assert done.returncode == 2 and message in done.stderr and not done.stdout


@needs_window
def test_no_screen_is_told(kage: Kage, scene: Path) -> None:
    kage.environment.update(SDL_VIDEODRIVER="x11", DISPLAY=":987654")
    done = kage("view", scene)
    assert done.returncode == 1 and "kage: no window: " in done.stderr


@needs_window
def test_without_a_screen_no_driver_shows_nothing(kage: Kage, scene: Path) -> None:
    """SDL would choose its driver `offscreen`, which had run for ever, unseen."""
    for name in ("SDL_VIDEODRIVER", "DISPLAY", "WAYLAND_DISPLAY"):
        kage.environment.pop(name, None)
    done = kage("view", scene)
    assert done.returncode == 1 and "kage: no window: no screen was found" in done.stderr


def test_without_the_window_the_rest_works_and_says_what_is_missing(kage: Kage, scene: Path) -> None:
    alone = shutil.copy(PROGRAM, kage.folder / "kage")
    done = subprocess.run([alone, "view", scene], capture_output=True, text=True, check=False)
    assert done.returncode == 2 and not done.stdout
    assert "no program kage-view" in done.stderr and "SDL2, SDL2_ttf and fontconfig" in done.stderr
    assert subprocess.run([alone, "check", scene], capture_output=True, check=False).returncode == 0


def test_make_leaves_the_window_out() -> None:
    """Where SDL2 is missing, or when asked to."""
    def would_make(*words: str) -> str:
        environment = {name: value for name, value in os.environ.items() if not name.startswith("MAKE")}
        return subprocess.run(["make", "-n", "-B", "programs", "BUILD=build/none", *words], cwd=TOP, text=True,
                              env=environment, capture_output=True, check=True).stdout

    assert "kage-view" not in would_make("VIEW=no") and "kage-import" in would_make("VIEW=no")
    assert "kage-view" in would_make("VIEW=yes")
