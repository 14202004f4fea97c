"""bench/stats.py, masks.py and images.py: made-up data whose answers are known by other means."""

from __future__ import annotations

import json
import math
import random
import sys
from collections.abc import Sequence

import numpy as np
import pytest

from bench import images, masks, stats

# Intervals ------------------------------------------------------------------------------------------


def end_rank(n: int) -> int:
    """The rank of the lower end of an odd n's 95 % interval: the bootstrap's median is at most the k-th value where at
    least half of n draws are, of which each is with probability k / n."""
    def below(k: int) -> float:
        return sum(math.comb(n, i) * (k / n) ** i * (1 - k / n) ** (n - i) for i in range((n + 1) // 2, n + 1))

    return next(k for k in range(1, n + 1) if below(k) >= 0.025)


def coverage(n: int) -> float:
    """How often that interval holds the true median, which any value is above with probability 1/2."""
    return 1 - 2 * sum(math.comb(n, i) for i in range(end_rank(n))) / 2**n


@pytest.mark.parametrize("n", [1, 3, 5, 7, 11, 41])
def test_interval_ends_at_the_ranks_of_theory(n: int) -> None:
    values = [10.0 * i for i in range(1, n + 1)]
    random.Random(n).shuffle(values)
    k = end_rank(n)
    assert stats.interval(values) == {"median": 5.0 * (n + 1), "low": 10.0 * k, "high": 10.0 * (n + 1 - k), "n": n}


@pytest.mark.parametrize(("n", "share"), [(3, 0.75), (5, 0.9375), (7, 0.875), (11, 0.935), (41, 0.940)])
def test_coverage_is_as_the_docstring_says(n: int, share: float) -> None:
    assert coverage(n) == pytest.approx(share, abs=5e-4)


@pytest.mark.parametrize("n", [7, 11])
def test_coverage_by_simulation(n: int) -> None:
    """Of a skewed distribution, as times are. Nominal is 95 %; seven values give 87.5 %."""
    trials, rng = 400, np.random.default_rng(n)
    found = [stats.interval(values) for values in np.exp(rng.normal(size=(trials, n)))]  # the median is 1
    hits = sum(i["low"] <= 1 <= i["high"] for i in found) / trials
    p = coverage(n)
    assert hits == pytest.approx(p, abs=4 * math.sqrt(p * (1 - p) / trials))


def test_interval_of_an_even_number_lies_between_values() -> None:
    found = stats.interval([1, 2, 4, 8])
    assert found["median"] == 3 and 1 <= found["low"] < 3 < found["high"] <= 8


def test_same_values_same_interval_and_less_confidence_a_narrower_one() -> None:
    values = np.random.default_rng(1).normal(size=30).tolist()
    wide, narrow = stats.interval(values), stats.interval(values, confidence=0.5)
    assert stats.interval(values) == stats.interval(sorted(values)) == wide
    assert wide["low"] < narrow["low"] < narrow["median"] < narrow["high"] < wide["high"]
    assert json.loads(json.dumps(wide)) == wide


@pytest.mark.parametrize("values", [[], [1, math.nan], [1, math.inf], [[1, 2], [3, 4]]])
def test_no_interval_of_nonsense(values: Sequence[float]) -> None:
    with pytest.raises(ValueError, match="finite numbers"):
        stats.interval(values)


@pytest.mark.parametrize("confidence", [0, 1, 95])
def test_no_such_confidence(confidence: float) -> None:
    with pytest.raises(ValueError, match="confidence"):
        stats.interval([1, 2, 3], confidence)


def test_pairs_cancel_what_slows_both() -> None:
    base = [10.0, 20, 40, 15, 80]
    found = stats.paired_interval([1.1 * b for b in base], base)
    assert (found["low"], found["median"], found["high"], found["n"]) == (*[pytest.approx(10)] * 3, 5)


def test_pairs_have_a_sign() -> None:
    assert stats.paired_interval([0.3], [0.4])["median"] == pytest.approx(-25)


@pytest.mark.parametrize(("values", "base"), [([1, 2], [1]), ([1, 2], [1, 0]), ([1, 2], [1, -1])])
def test_no_such_pairs(values: list[float], base: list[float]) -> None:
    with pytest.raises(ValueError, match="paired|above 0"):
        stats.paired_interval(values, base)


def between(low: float, high: float) -> stats.Interval:
    return {"median": (low + high) / 2, "low": low, "high": high, "n": 7}


@pytest.mark.parametrize(
    ("a", "b", "apart"),
    [((1, 2), (3, 4), True), ((3, 4), (1, 2), True), ((1, 3), (2, 4), False), ((1, 2), (2, 3), False),
     ((2, 3), (1, 2), False), ((1, 9), (4, 5), False), ((4, 5), (1, 9), False)],
)
def test_apart(a: tuple[float, float], b: tuple[float, float], apart: bool) -> None:
    assert stats.apart(between(*a), between(*b)) is apart


def test_noise_is_half_the_interquartile_range() -> None:
    assert stats.noise([12, 8, 10, 11, 9]) == 10
    assert stats.noise([0.12, 0.08, 0.1, 0.11, 0.09]) == pytest.approx(10)
    assert stats.noise([5, 5, 5]) == 0
    assert stats.noise([12, 8, 10, 11, 900]) == pytest.approx(100 * 1 / 11)  # one slow run is no noise
    with pytest.raises(ValueError, match="median"):
        stats.noise([0, 0])


# The Pareto front -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("points", "front"),
    [
        ([], []),
        ([(1, 1)], [0]),
        ([(3, 1), (1, 3), (2, 2)], [1, 2, 0]),
        ([(1, 3), (2, 3), (3, 1)], [0, 2]),  # as wrong, but dearer
        ([(1, 3), (1, 2), (3, 1)], [1, 2]),  # as dear, but worse
        ([(1, 1), (2, 2), (1, 1)], [0, 2]),  # the same point twice
        ([(2, 2), (1, 1), (3, 3)], [1]),
        ([(1, 5), (2, 4), (3, 4.5), (4, 0), (5, 0)], [0, 1, 3]),
    ],
)
def test_pareto(points: list[tuple[float, float]], front: list[int]) -> None:
    assert stats.pareto(points) == front


def test_pareto_by_definition() -> None:
    rng = random.Random(2)
    points = [(rng.randrange(12), rng.randrange(12)) for _ in range(60)]  # few values, many ties

    def dominated(p: tuple[float, float]) -> bool:
        return any(q != p and q[0] <= p[0] and q[1] <= p[1] for q in points)

    assert sorted(stats.pareto(points)) == [i for i, p in enumerate(points) if not dominated(p)]


def test_pareto_of_what_is_no_number() -> None:
    with pytest.raises(ValueError, match="not a number"):
        stats.pareto([(1, 2), (math.nan, 1)])


# Exponents ------------------------------------------------------------------------------------------

X = [0.01, 0.02, 0.04, 0.08, 0.16, 0.32]


@pytest.mark.parametrize("k", [-1, 1.5, 2, 4])
def test_exponent(k: float) -> None:
    assert stats.fit_exponent(X, [3 * x**k for x in X], 0) == pytest.approx(k, abs=1e-9)


def test_points_near_the_floor_do_not_count() -> None:
    y = [x**3 + 1e-4 for x in X]
    assert stats.fit_exponent(X, y, 0) < 2.5
    assert stats.fit_exponent(X, y, 1e-4) is None  # only two points are left
    finer = [x**3 + 1e-6 for x in X]
    assert stats.fit_exponent(X, finer, 0) < 2.9
    assert stats.fit_exponent(X, finer, 1e-6) == pytest.approx(3, abs=0.03)


def test_unknown_points_do_not_count() -> None:
    y = [None, None, 0.04**2, 0.08**2, 0.16**2, math.inf]
    assert stats.fit_exponent(X, y, 0) == pytest.approx(2)
    assert stats.fit_exponent(X, [None, *y[:2], *y[3:]], 0) is None


def test_two_places_make_no_exponent() -> None:
    assert stats.fit_exponent([1, 1, 2], [1, 1.1, 4], 0) is None


def test_exponent_wants_x_above_0() -> None:
    with pytest.raises(ValueError, match="above 0"):
        stats.fit_exponent([0, 1, 2], [1, 2, 3], 0)


# Masks ----------------------------------------------------------------------------------------------


def square(top: int, left: int, side: int = 10) -> np.ndarray:
    mask = np.zeros((40, 50), dtype=bool)
    mask[top:top + side, left:left + side] = True
    return mask


EVERYWHERE = np.ones((40, 50), dtype=bool)
NOWHERE = np.zeros((40, 50), dtype=bool)


def test_the_same_mask_is_right() -> None:
    assert masks.measure(square(5, 7), square(5, 7), EVERYWHERE) == {
        "wrong": 0, "iou": 1, "edge_mean": 0, "edge_95": 0, "edge_hausdorff": 0}


def test_edge_lies_between_pixels() -> None:
    one = masks.edge(square(3, 4, 1), EVERYWHERE)
    assert sorted(map(tuple, one)) == [(2.5, 4), (3, 3.5), (3, 4.5), (3.5, 4)]
    assert len(masks.edge(square(5, 7), EVERYWHERE)) == 40


def test_shifted_half_planes() -> None:
    rows = np.arange(40)[:, None] * np.ones((1, 50), dtype=int)
    assert masks.measure(rows < 20, rows < 25, EVERYWHERE) == {
        "wrong": 20, "iou": 0.8, "edge_mean": 5, "edge_95": 5, "edge_hausdorff": 5}


def test_shifted_squares() -> None:
    """Three rows down. The outer sides are 3 apart; the other points are nearest to one around a corner, at sqrt(1/2),
    sqrt(5/2) and sqrt(13/2), or on the other square's edge."""
    found = masks.measure(square(13, 10), square(10, 10), EVERYWHERE)
    corner = math.sqrt(1 / 2) + math.sqrt(5 / 2) + math.sqrt(13 / 2)
    one_way = (10 * 3) + 2 * corner + (4 * 3 + 2 * corner)  # the outer side, left and right, the inner side
    assert found == pytest.approx({"wrong": 60, "iou": 70 / 130, "edge_mean": one_way / 40, "edge_95": 3,
                                   "edge_hausdorff": 3})


def test_squares_side_by_side() -> None:
    """No pixel in common: all of one is missing, and as many are wrong."""
    found = masks.measure(square(5, 30), square(5, 10), EVERYWHERE)
    assert (found["wrong"], found["iou"], found["edge_hausdorff"]) == (200, 0, 20)


def test_one_stray_pixel_is_hausdorffs_alone() -> None:
    stray = square(5, 5, 20) | square(14, 40, 1)
    found = masks.measure(stray, square(5, 5, 20), EVERYWHERE)
    assert found["edge_hausdorff"] == 16 and found["edge_95"] == 0  # columns 24.5 and 40.5
    assert found["edge_mean"] == pytest.approx((15 + 16 + 2 * math.hypot(15.5, 0.5)) / 164)


def random_masks(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    a, b = (rng.random((12, 15)) < 0.5 for _ in range(2))
    return a, b, rng.random((12, 15)) < 0.8


@pytest.mark.parametrize("seed", range(3))
def test_edges_by_brute_force(seed: int) -> None:
    a, b, counted = random_masks(seed)

    def edge(mask: np.ndarray) -> np.ndarray:
        pairs = [((i, j), (i + di, j + dj))
                 for di, dj in ((1, 0), (0, 1)) for i in range(12 - di) for j in range(15 - dj)]
        return np.array([((p[0] + q[0]) / 2, (p[1] + q[1]) / 2) for p, q in pairs
                         if counted[p] and counted[q] and mask[p] != mask[q]])

    table = np.linalg.norm(edge(a)[:, None] - edge(b)[None], axis=-1)
    all_of_them = [*table.min(axis=0), *table.min(axis=1)]
    assert masks.edge_distances(a, b, counted) == pytest.approx(
        {"mean": np.mean(all_of_them), "p95": np.percentile(all_of_them, 95), "hausdorff": np.max(all_of_them)})


def test_edges_are_the_same_the_other_way_round_and_of_the_negative() -> None:
    a, b, counted = random_masks(7)
    found = masks.edge_distances(a, b, counted)
    assert found == pytest.approx(masks.edge_distances(b, a, counted))
    assert found == masks.edge_distances(~a, ~b, counted)


def test_what_does_not_count() -> None:
    counted = EVERYWHERE.copy()
    counted[:, 30:] = False
    right, wrong = square(5, 10), square(5, 10) | square(5, 35)
    assert masks.measure(wrong, right, counted) == masks.measure(right, right, counted)
    assert masks.measure(right, wrong, counted)["wrong"] == 0


def test_the_silhouette_is_no_edge() -> None:
    counted = square(10, 10, 20)
    left = np.zeros_like(counted)
    left[:, :15] = True  # beyond what counts, above, below and left
    assert sorted(map(tuple, masks.edge(left, counted))) == [(row, 14.5) for row in range(10, 30)]


@pytest.mark.parametrize(("ours", "truth"),
                         [(NOWHERE, square(5, 5)), (EVERYWHERE, square(5, 5)), (square(5, 5), NOWHERE)])
def test_no_edge_no_distance(ours: np.ndarray, truth: np.ndarray) -> None:
    found = masks.measure(ours, truth, EVERYWHERE)
    assert [found[key] for key in ("edge_mean", "edge_95", "edge_hausdorff")] == [None] * 3
    assert masks.edge_distances(ours, truth, EVERYWHERE) is None


def test_no_shadow_no_share() -> None:
    found = masks.measure(square(5, 5), NOWHERE, EVERYWHERE)
    assert (found["wrong"], found["iou"]) == (None, 0)
    found = masks.measure(NOWHERE, NOWHERE, EVERYWHERE)
    assert (found["wrong"], found["iou"]) == (None, None)
    assert set(masks.measure(square(5, 5), square(5, 5), NOWHERE).values()) == {None}


def test_picture_of_a_mask() -> None:
    ours = np.array([[True, True, False, False, True]])
    truth = np.array([[True, False, True, False, True]])
    found = masks.picture(ours, truth, np.array([[True] * 4 + [False]]))
    assert found.dtype == np.uint8 and found.tolist() == [[2, 4, 3, 1, 0]]


def test_picture_tells_what_is_measured() -> None:
    a, b, counted = random_masks(3)
    levels = np.bincount(masks.picture(a, b, counted).ravel(), minlength=5)
    wrong = levels[masks.WRONGLY_LIT] + levels[masks.WRONGLY_SHADOW]
    shadow = levels[masks.RIGHT_SHADOW] + levels[masks.WRONGLY_LIT]
    assert masks.measure(a, b, counted)["wrong"] == 100 * wrong / shadow
    assert levels[masks.NOT_COUNTED] == (~counted).sum() and levels.sum() == counted.size


@pytest.mark.parametrize("bad", [EVERYWHERE.astype(np.uint8), EVERYWHERE[1:], EVERYWHERE[..., None]])
def test_what_is_no_mask(bad: np.ndarray) -> None:
    for judge in (masks.measure, masks.picture):
        with pytest.raises(ValueError, match="boolean"):
            judge(bad, EVERYWHERE, EVERYWHERE)
        with pytest.raises(ValueError, match="boolean"):
            judge(EVERYWHERE, EVERYWHERE, bad)
    with pytest.raises(ValueError, match="boolean"):
        masks.edge(*[EVERYWHERE[..., None]] * 2)


# Pictures -------------------------------------------------------------------------------------------


def plain(*color: float) -> np.ndarray:
    return np.ones((32, 48, 3), dtype=np.float32) * np.float32(color)


HALF = 0.21404114  # linear; 0.5 when encoded
needs_packages = pytest.mark.skipif(bool(images.missing()), reason="no " + ", ".join(images.missing()))


def test_srgb() -> None:
    linear = np.array([-1, 0, 0.0031308, HALF, 1, 2])
    assert images.srgb(linear) == pytest.approx([0, 0, 0.04044994, 0.5, 1, 1], abs=1e-6)


def test_rmse_is_linear_and_not_clipped() -> None:
    assert images.measure(plain(3, 0.5, 0.5), plain(1, 0.5, 0.5))["rmse"] == pytest.approx(2 / math.sqrt(3))


def test_psnr_is_of_encoded_pictures() -> None:
    brighter = (0.6 + 0.055) ** 2.4 / 1.055**2.4  # 0.6 when encoded
    assert images.measure(plain(brighter), plain(HALF))["psnr"] == pytest.approx(20, abs=1e-4)
    assert images.measure(plain(1), plain(0))["psnr"] == pytest.approx(0, abs=1e-6)


@needs_packages
def test_identical_pictures() -> None:
    noise = np.random.default_rng(4).random((32, 48, 3)).astype(np.float32)
    found = images.measure(noise, noise.copy())
    assert found == pytest.approx({"rmse": 0, "psnr": images.PSNR_CEILING, "ssim": 1, "flip": 0}, abs=1e-6)
    assert json.loads(json.dumps(found, allow_nan=False))["psnr"] == 100


def test_psnr_has_a_ceiling() -> None:
    found = images.measure(plain(HALF) + np.float32(1e-6), plain(HALF))
    assert found["rmse"] > 0 and found["psnr"] == images.PSNR_CEILING


@needs_packages
def test_ssim_of_plain_pictures_is_the_luminance_term() -> None:
    """(2ab + C) / (a^2 + b^2 + C), C = 0.01^2: nothing varies."""
    found = images.measure(plain(HALF), plain(1))["ssim"]
    assert found == pytest.approx((2 * 0.5 + 1e-4) / (0.25 + 1 + 1e-4), abs=1e-6)


@needs_packages
def test_ssim_is_wangs() -> None:
    """By the formulas of the paper of 2004, for each channel; where the window fits into the picture."""
    from scipy.ndimage import gaussian_filter

    rng = np.random.default_rng(6)
    pictures = [0.2 + 0.6 * rng.random((11, 30, 3)) for _ in range(2)]  # of the least height
    a, b = (images.srgb(p) for p in pictures)

    def window(x: np.ndarray) -> np.ndarray:
        return gaussian_filter(x, sigma=(1.5, 1.5, 0), radius=(5, 5, 0))[5:-5, 5:-5]

    ma, mb = window(a), window(b)
    va, vb, vab = window(a * a) - ma**2, window(b * b) - mb**2, window(a * b) - ma * mb
    c1, c2 = 0.01**2, 0.03**2
    found = (2 * ma * mb + c1) * (2 * vab + c2) / ((ma**2 + mb**2 + c1) * (va + vb + c2))
    assert images.measure(*pictures)["ssim"] == pytest.approx(found.mean(), abs=1e-9)


@needs_packages
def test_ssim_of_a_negative_is_below_0() -> None:
    encoded = np.random.default_rng(5).random((32, 48, 1)) * np.ones(3)
    linear, negative = (np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4) for x in (encoded, 1 - encoded))
    assert images.measure(linear, negative)["ssim"] < -0.8


@needs_packages
def test_flip_grows_with_what_is_seen() -> None:
    grey = plain(HALF)
    faint, strong = (images.measure(plain(HALF * factor), grey)["flip"] for factor in (1.05, 1.5))
    assert 0 < faint < strong < 1
    assert images.measure(plain(1), plain(0))["flip"] > 0.9
    assert images.measure(plain(0, 1, 0), plain(0, 0, 1))["flip"] == pytest.approx(1, abs=0.01)  # the largest there is


@needs_packages
def test_flip_is_a_mean_over_the_picture() -> None:
    """An error in a part of the picture counts as much as that part, but for its rim."""
    part = plain(0).repeat(4, axis=0).repeat(4, axis=1)
    part[:, :48] = 1
    whole, quarter = images.measure(plain(1), plain(0))["flip"], images.measure(part, np.zeros_like(part))["flip"]
    assert quarter == pytest.approx(whole / 4, rel=0.15)


@pytest.mark.parametrize(
    ("module", "package", "metric"),
    [("skimage.metrics", "scikit-image", "ssim"), ("flip_evaluator", "flip-evaluator", "flip")],
)
def test_without_a_package(module: str, package: str, metric: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, module, None)  # an import of it fails
    assert package in images.missing()
    found = images.measure(plain(0.4), plain(0.5))
    assert found[metric] is None and found["rmse"] == pytest.approx(0.1) and found["psnr"] > 0


@pytest.mark.parametrize(
    ("a", "b"),
    [(plain(1)[1:], plain(1)), (plain(1)[..., :2], plain(1)[..., :2]), (plain(1)[:10], plain(1)[:10]),
     (plain(1)[..., 0], plain(1)[..., 0]), (plain(math.nan), plain(1)), (plain(1), plain(math.inf))],
)
def test_what_is_no_pair_of_pictures(a: np.ndarray, b: np.ndarray) -> None:
    with pytest.raises(ValueError, match="pictures are|finite"):
        images.measure(a, b)
