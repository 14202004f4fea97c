"""25 random scenes, some of their properties each; and the small scenes that broke one before (found/).

`python -m tests.verify.scenes` looks at more of them, and by other compilers.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import PROGRAM, TOP
from tests.random.draw import Scene, draw, read
from tests.random.lab import Lab, LostError, RefusedError
from tests.random.oracle import camera_rays, meet
from tests.random.properties import PROPERTIES, check, chosen, complaint, same
from tests.random.shrink import keep, kept, paths, shrunk

SEEDS = range(5000, 5025)
WORDS = """plane rectangle disc box sphere cylinder cone torus ellipsoid parametric patches mesh copy copies hidden
    function map smooth checker image reflection filter ior phong specular area spot parallel fade width fov
    displaced horizon exact march:6 auto 2+ aa_threshold self_shadow guard mirror clamp corners up"""


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    builds = {"float": PROGRAM.parent, "double": TOP / "build" / "double"}
    for name, folder in builds.items():
        assert (folder / "python" / "kage").exists(), f"run make REAL={name} python"
    made = Lab(builds, tmp_path_factory.mktemp("random"))
    yield made
    made.end()


@pytest.mark.parametrize("seed", SEEDS)
def test_holds(lab: Lab, seed: int) -> None:
    looked = {name: check(lab, draw(seed), name, seed) for name in chosen(seed, 6)}
    assert not {name: wrong for name, wrong in looked.items() if wrong}


def test_each_property_is_looked_at() -> None:
    """By several of the scenes above."""
    count = {name: sum(name in chosen(seed, 6) for seed in SEEDS) for name in PROPERTIES if name != "builds"}
    assert min(count.values()) >= 2, count


def test_found_and_mended(lab: Lab) -> None:
    looked = {f"{name}-{seed}": check(lab, read(path), name, seed) for name, seed, path in kept()}
    assert not {name: wrong for name, wrong in looked.items() if wrong}


def test_the_same_seed_gives_the_same_scene() -> None:
    a, b = draw(7), draw(7)
    assert a.text() == b.text() and a.files == b.files and a.text() != draw(8).text()


def test_everything_is_drawn() -> None:
    text = "".join(draw(seed).text() for seed in range(150))
    for word in WORDS.split():
        assert f'"{word}"' in text, word


def test_differences_are_noticed(lab: Lab) -> None:
    """A pixel's last digit; a colour that is off by 1e-4 everywhere."""
    scene = draw(5000)
    a = lab.picture(scene)
    b = {name: plane.copy() for name, plane in a.items()}
    assert same(a, b) == ""
    b["R"][3, 4] = np.nextafter(b["R"][3, 4], np.float32(9))
    assert "4,3: R" in same(a, b)
    brighter = a | {"R": a["R"] * np.float32(1.0001)}
    assert "pixels differ" in complaint(brighter, a) and not complaint(brighter, a, within=1e-3)


def test_a_wrong_scene_is_refused(lab: Lab) -> None:
    scene = draw(5000)
    scene.tree["camera"]["fvo"] = 30
    with pytest.raises(RefusedError, match="did you mean 'fov'"):
        lab.picture(scene)


def test_a_crash_is_noticed(tmp_path: Path) -> None:
    made = Lab({"float": tmp_path}, tmp_path)  # there is no package
    with pytest.raises(LostError, match="exit status 1"):
        made.picture(draw(5000))
    made.end()


def test_shrinks(tmp_path: Path) -> None:
    """To what alone matters: here a ball whose material is there."""
    def fails(other: Scene) -> bool:
        tree = other.tree
        balls = [thing for thing in tree.get("objects", {}).values() if "sphere" in thing]
        return any(thing.get("material") in tree.get("materials", {}) for thing in balls)

    seed = next(seed for seed in range(100) if fails(draw(seed)) and len(draw(seed).tree["objects"]) > 3)
    small = shrunk(draw(seed), fails)
    assert len(list(paths(small.tree))) == 6, small.text()
    path = keep(small, "deeper", seed, tmp_path)
    assert kept(tmp_path) == [("deeper", seed, path)] and read(path).tree == small.tree


def test_the_oracle_by_hand() -> None:
    """A ray down the middle."""
    rays = camera_rays({"camera": {"from": [0, 0, -5], "at": [0, 0, 0], "width": 2}, "image": {"size": [1, 1]}})
    assert meet(rays, "sphere", {"center": [0, 0, 0], "radius": 1})[0] == pytest.approx(4)
    assert meet(rays, "rectangle", {"origin": [-1, -1, 2], "u": [2, 0, 0], "w": [0, 2, 0]})[0] == pytest.approx(7)
    torus = {"center": [0, 0, 0], "axis": [0, 1, 0], "major": 2, "minor": 0.5}
    assert meet(rays, "torus", torus)[0] == pytest.approx(2.5)
