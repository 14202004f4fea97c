"""kage.gbuffer: from kage's own layers, as another renderer would have them, it finds what kage finds."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from PIL import Image

import kage
from kage import gbuffer, methods
from kage.heights import HeightMap
from tests.conftest import TOP

METHODS = ("none", "0", "1", "2", "2+", "iter:3", "march:4")
SIZE = (160, 120)
EYES = {"cube": (0.2, 4.3, -5.6), "sphere": (0.9, 1.0, -6.4)}


def bumps(scene: str) -> HeightMap:
    """The heights of scenes/cube.yaml and scenes/sphere.yaml."""
    samples = np.asarray(Image.open(TOP / "scenes" / "data" / "bumps.png"), np.float64) / 65535
    if scene == "cube":
        return HeightMap(samples, (12, 12), scale=0.22, zero=0.417)
    return HeightMap(samples, (math.pi, math.pi), offset=(-math.pi, 0), scale=0.09, zero=0.417)


@pytest.fixture(scope="module")
def films() -> Any:
    """Planes of a scene by a method, rendered once."""
    made: dict[tuple[str, ...], dict[str, np.ndarray]] = {}

    def film(scene: str, method: str, shade: str = "smooth") -> dict[str, np.ndarray]:
        key = (scene, method, shade)
        if key not in made:
            loaded = kage.load(TOP / "scenes" / f"{scene}.yaml")
            picture = loaded.render(shadow=method, shade=shade, size=SIZE, layers=True)
            made[key] = {name: np.array(picture[name]) for name in picture.planes}
        return made[key]

    return film


def three(planes: dict[str, np.ndarray], name: str) -> np.ndarray:
    return np.stack([planes[f"{name}.{axis}"] for axis in "XYZ"], -1).astype(np.float64)


def layers_of(planes: dict[str, np.ndarray], scene: str, **known: Any) -> gbuffer.Layers:
    uv = np.stack([planes["uw.u"], planes["uw.w"]], -1).astype(np.float64)
    position = three(planes, "P")
    if scene == "sphere":
        known["normal"] = position  # its centre is the origin
    return gbuffer.layers(EYES[scene], position, uv, there=planes["order"] >= 0, **known)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("scene", ["cube", "sphere"])
def test_shifts_are_kages(films: Any, scene: str, method: str) -> None:
    """t_hit is Z in kage's layers and 1 in these. Of the sphere, differences at the silhouette are coarse."""
    base, want = films(scene, "0"), films(scene, method)
    a = layers_of(base, scene)
    got = gbuffer.correct(a, bumps(scene), method)
    there = a.there
    with np.errstate(invalid="ignore"):
        off = np.abs(got.tau * base["Z"] - want["tau"])[there]
    turned = np.abs(got.normal - three(want, "N")).max(-1)[there]
    same = (got.order == want["order"])[there]
    print(f"tau off by {np.median(off):.2g}, {np.percentile(off, 95):.2g}; order same {same.mean():.4f}")
    most, share, normal = (3e-5, 1.0, 1e-5) if scene == "cube" else (2e-2, 0.99, 5e-3)
    assert np.percentile(off, 95) <= most and np.median(off) < 1e-6
    assert same.mean() >= share
    assert np.percentile(turned, 90) < normal
    assert (got.fell_back[there] == (got.order[there] != gbuffer.ORDERS[method.partition(":")[0]])).all()
    if method == "2":
        assert 0.005 < got.fell_back[there].mean() < 0.2


def test_the_place_that_is_shaded_is_kages(films: Any) -> None:
    base, want = films("cube", "0"), films("cube", "march:4", "shifted")
    a = layers_of(base, "cube")
    got = gbuffer.correct(a, bumps("cube"), "march:4", shade="shifted")
    for ours, its in ((got.u, "uw.u"), (got.w, "uw.w")):
        assert np.abs(ours - want[its])[a.there].max() < 2e-4
    assert np.percentile(np.abs(got.normal - three(want, "N")).max(-1)[a.there], 99) < 1e-3
    plain = gbuffer.correct(a, bumps("cube"), "march:4").normal
    assert np.percentile(np.abs(plain - three(want, "N")).max(-1)[a.there], 50) > 1e-2


def test_a_mirrored_texture_is_the_same_surface(films: Any) -> None:
    """u runs the other way, as in most renderers' uv: Qu x Qw points down, and the normal says so."""
    base = films("cube", "0")
    a = layers_of(base, "cube")
    uv = np.stack([-base["uw.u"], base["uw.w"]], -1).astype(np.float64)
    samples = np.asarray(Image.open(TOP / "scenes" / "data" / "bumps.png"), np.float64)[:, ::-1] / 65535
    turned = HeightMap(samples, (12, 12), scale=0.22, zero=0.417)
    b = gbuffer.layers(EYES["cube"], a.position, uv, there=a.there, normal=[0, 1, 0])
    for method in METHODS:
        one, two = gbuffer.correct(a, bumps("cube"), method), gbuffer.correct(b, turned, method)
        assert np.abs(one.tau - two.tau)[a.there].max() < 1e-6
        assert np.abs(one.normal - two.normal)[a.there].max() < 1e-6
        assert np.abs(one.u + two.u)[a.there].max() < 1e-6


def test_layers_of_heights(films: Any) -> None:
    """A renderer's own height layers, without a map to look up."""
    a = layers_of(films("cube", "0"), "cube")
    p = bumps("cube").bump(a.u, a.w)
    one = gbuffer.correct(a, bumps("cube"), "2")
    two = gbuffer.correct(a, p, "2", bounds=bumps("cube").bounds)
    assert np.array_equal(one.tau, two.tau, equal_nan=True)
    assert (gbuffer.correct(a, p, "2").order >= 0).sum() == (one.order >= 0).sum()
    with pytest.raises(ValueError, match="heights must be a map or a function"):
        gbuffer.correct(a, p, "march:4")


def test_own_shadows_are_kages(films: Any) -> None:
    lamp = [-4.4, 1.3, -2.6]
    scene = kage.load(TOP / "scenes" / "cube.yaml", sets={"lights.lamp.at": lamp})
    picture = scene.render(shadow="march:8", shade="shifted", bump_shadow="march:16", size=SIZE, layers=True)
    lit = np.array(picture["visibility.lamp"]) > 0.5
    a = layers_of(films("cube", "0"), "cube")
    c = gbuffer.correct(a, bumps("cube"), "march:8", shade="shifted")
    dark = gbuffer.own_shadow(a, c, bumps("cube"), lamp, 16)
    # the cube's shadow does not reach the left third
    asked = a.there & (np.arange(SIZE[0]) < SIZE[0] // 3)
    assert 0.1 < dark[asked].mean() < 0.9
    assert (dark == ~lit)[asked].mean() > 0.99


def test_differences_stay_within_a_part() -> None:
    """Two planes side by side: at their border each pixel takes its own side's neighbour."""
    y, x = np.mgrid[:8, :10].astype(float)
    part = (x >= 5).astype(int)
    uv = np.stack([x + 100 * part, y], -1)
    position = np.stack([x * (1 + part), y, 7 * part], -1)
    by_u, by_w = gbuffer.partials(position, uv, part)
    assert np.abs(by_u - np.stack([1 + part, 0 * x, 0 * x], -1)).max() < 1e-12
    assert np.abs(by_w - [0, 1, 0]).max() < 1e-12
    alone, _ = gbuffer.partials(position, uv, np.arange(80).reshape(8, 10))
    assert np.isnan(alone).all()
    found = gbuffer.layers([0, 0, -9], position, uv, part=np.arange(80).reshape(8, 10))
    c = gbuffer.correct(found, HeightMap(np.ones((2, 2)), (1, 1)), "1")
    assert (c.order == -1).all() and np.array_equal(c.origin, position)


def test_bump_is_another_name_for_none(films: Any) -> None:
    a = layers_of(films("cube", "0"), "cube")
    one, other = (gbuffer.correct(a, bumps("cube"), method) for method in ("bump", "none"))
    assert np.array_equal(one.tau, other.tau) and (one.order == -1).all()


@pytest.mark.parametrize(("call", "message"), [
    (lambda a: gbuffer.correct(a, bumps("cube"), "3"), "method '3': expected none, 0, 1, 2, 2+, iter:K or march:N"),
    (lambda a: gbuffer.correct(a, bumps("cube"), "march"), "method 'march'"),
    (lambda a: gbuffer.correct(a, bumps("cube"), "iter:0"), "times=0"),
    (lambda a: gbuffer.correct(a, bumps("cube"), "1", shade="sharp"), 'expected "smooth" or "shifted"'),
    (lambda a: gbuffer.layers([0, 0, 0], a.position, a.u), "expected shapes (..., 3) and (..., 2)"),
    (lambda _: HeightMap(np.ones(3), (1, 1)), "2 x 2 or more"),
    (lambda _: HeightMap(np.ones((2, 2)), (1, 0)), "expected two lengths above 0"),
    (lambda _: HeightMap(np.ones((2, 2)), (1, 1), wrap="mirror"), 'expected "repeat" or "clamp"'),
])
def test_what_is_wrong_is_said(films: Any, call: Any, message: str) -> None:
    with pytest.raises(ValueError) as wrong:
        call(layers_of(films("cube", "0"), "cube"))
    assert message in str(wrong.value)


@pytest.mark.parametrize("lie", ["cells", "corners"])
@pytest.mark.parametrize("wrap", ["repeat", "clamp"])
def test_height_maps_are_kages(wrap: str, lie: str, tmp_path: Any) -> None:
    """P and all partials, by kage's probe, of places on and off the map."""
    samples = np.random.default_rng(3).integers(0, 65536, (5, 7)).astype(np.uint16)
    Image.fromarray(samples).save(tmp_path / "map.png")
    text = f"""\
camera: {{from: [0, 6, -0.01], at: [0, 0, 0], up: [0, 0, 1], fov: 60}}
image: {{size: [64, 48]}}
lights: {{lamp: {{at: [0, 5, 0], color: [1, 1, 1]}}}}
materials: {{clay: {{color: [1, 1, 1]}}}}
objects:
  ground:
    plane: {{origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}}
    material: clay
    bump: {{map: {{file: map.png}}, size: [2, 3], offset: [-1, 0.5], scale: 0.3, zero: 0.4, sign: up, wrap: {wrap},
           samples: {lie}}}
"""
    scene = kage.load(text, folder=tmp_path)
    heights = HeightMap(samples / 65535, (2, 3), offset=(-1, 0.5), scale=0.3, zero=0.4, wrap=wrap, lie=lie)
    middle = scene.probe(32, 24)
    assert heights.bounds == pytest.approx((middle.Pmin, middle.Pmax), abs=1e-6)
    outside = 0
    for x in range(1, 64, 9):
        for y in range(1, 48, 9):
            probe = scene.probe(x, y)
            p = heights.bump(probe.u, probe.w)
            want = np.array([getattr(probe, name) for name in methods.Bump._fields])
            assert np.abs(np.array(p) - want) == pytest.approx(np.zeros(6), abs=2e-4), (x, y)
            outside += not (-1 < probe.u < 1 and 0.5 < probe.w < 3.5)
    assert 5 < outside < 42


def test_methods_are_the_probes() -> None:
    """Every value that kage pixel prints, from the same numbers."""
    scene = kage.load(TOP / "scenes" / "sphere.yaml")
    fell = 0
    for x, y in np.random.default_rng(4).integers((130, 60), (500, 420), (60, 2)):
        q = scene.probe(int(x), int(y))
        if not q.bumped:
            continue
        n = methods.normal(q.Qu, q.Qw)
        v = methods.view(q.s, n, q.Qu, q.Qw)
        assert np.array(v) == pytest.approx([q.sn, q.a, q.b], rel=1e-4)
        p = methods.Bump(*(getattr(q, name) for name in methods.Bump._fields))
        assert methods.perturbed_normal(n, q.Qu, q.Qw, p.Pu, p.Pw) == pytest.approx(q.n_bump, rel=1e-3, abs=1e-5)
        slab = methods.slab(v, q.Pmin, q.Pmax)
        assert np.array(slab) == pytest.approx(q.slab, rel=1e-4)
        bend = methods.curvature(v, n, q.Quu, q.Quw, q.Qww)
        for row in q.rows:
            if row.method in ("0", "1", "2", "2+"):
                order = gbuffer.ORDERS[row.method]
                got = methods.shift(order, v, p, slab, curvature=bend, guard=bool(row.guard))
                assert got.tau == pytest.approx(row.tau, rel=2e-3, abs=1e-5), (x, y, row.method)
                assert (got.order == order) == (row.fell_back is None)
                fell += got.order != order
    assert fell > 0
