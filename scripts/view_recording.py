"""A recording of kage view for the README: the light moves, the method changes, the split line follows the mouse.

    scripts/venv python -m scripts.view_recording --kage build/float/kage -o docs/view.webp

The window is on an X server without a screen, and is led by events as a user's hand would lead it. A frame is taken
when its picture is finished, so that the recording does not depend on the speed of this machine.
"""

from __future__ import annotations

import argparse
import math
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from PIL import Image, ImageDraw

from tests.support.display import View, display, view

TOP = Path(__file__).resolve().parent.parent
WIDTH, HEIGHT, BAR = 640, 360, 42
MOST = 1_500_000  # bytes

Frame = tuple[Image.Image, int]  # and how long it stays, in milliseconds


def take(window: View, x: int, y: int, stays: int = 60) -> Frame:
    """What the window shows, with the pointer at x, y."""
    picture = Image.fromarray(window.pixels(WIDTH, HEIGHT + BAR))
    arrow = [(0, 0), (0, 16), (4, 12), (7, 18), (9, 17), (6, 11), (11, 11)]
    ImageDraw.Draw(picture).polygon([(x + dx, y + dy) for dx, dy in arrow], fill="white", outline="black")
    return picture, stays


def moved(window: View, x: int, y: int) -> None:
    """Move the mouse, and wait until the values there are shown."""
    window.mouse(x, y)
    window.wait(f"^under {x} {y} ")
    time.sleep(0.1)  # the window is drawn at once


def light(window: View) -> Iterator[Frame]:
    """Shift-drag: to the right, back, and down."""
    x, y = 300, 300
    moved(window, x, y)
    yield take(window, x, y, 900)
    window.display.do("keydown", "shift", "mousedown", 1)
    for k in range(1, 25):
        turn = 2 * math.pi * k / 24
        window.mouse(x + round(90 * math.sin(turn)), y - round(30 * (1 - math.cos(turn)) / 2))
        window.settle()
        yield take(window, x + round(90 * math.sin(turn)), y - round(30 * (1 - math.cos(turn)) / 2))
    window.display.do("mouseup", 1, "keyup", "shift")


def methods(window: View) -> Iterator[Frame]:
    """Keys: none, order 0, order 2, own shadows, and what is shaded."""
    x, y = 300, 300
    for key, said, stays in (("n", "shadow=none", 1100), ("0", "shadow=0", 900), ("m", "shadow=march:8", 900),
                             ("b", "own=march:8", 900), ("s", "shade=shifted", 1100)):
        window.key(key)
        window.settle(said)
        yield take(window, x, y, stays)


def split(window: View) -> Iterator[Frame]:
    """The split line from right to left and back."""
    y = 250
    moved(window, 560, y)
    window.key("space")
    window.settle("beside=none")
    for k in range(33):
        x = round(360 + 200 * math.cos(2 * math.pi * k / 32))
        if k:
            moved(window, x, y + k % 2)
        yield take(window, x, y, 70)


def record(program: Path, scene: Path) -> list[Frame]:
    with (tempfile.TemporaryDirectory() as folder, display(Path(folder)) as screen,
          view(screen, program, scene, "--size", f"{WIDTH}x{HEIGHT}", cwd=TOP) as window):
        return [frame for part in (light, methods, split) for frame in part(window)]


def main() -> None:
    parser = argparse.ArgumentParser(description="Record kage view.")
    parser.add_argument("--kage", type=Path, default=TOP / "build/float/kage")
    parser.add_argument("--scene", type=Path, default=TOP / "scenes/cube.yaml")
    parser.add_argument("-o", "--output", type=Path, default=TOP / "docs/view.webp")
    given = parser.parse_args()
    frames = record(given.kage.resolve(), given.scene.resolve())
    pictures, stays = [picture for picture, _ in frames], [stay for _, stay in frames]
    for quality in (80, 70, 60, 50, 40, 30):
        pictures[0].save(given.output, save_all=True, append_images=pictures[1:], duration=stays, loop=0,
                         quality=quality, method=4)
        if given.output.stat().st_size <= MOST:
            break
    print(f"{given.output}: {len(pictures)} frames, {given.output.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
