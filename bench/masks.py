"""How far a shadow is from the true one: two masks, True in shadow, compared where `counted` is True.

wrong       pixels that differ, in % of the true shadow's; above 100 where more is wrong than there is shadow
iou         intersection over union of the two shadows, 0 to 1
edge_...    distances between the two shadows' edges, in pixels

An edge is the set of the midpoints between two pixels that share a side, where both are counted, one is in shadow and
the other is lit. So an edge is the same for a shadow and for its negative. There is no edge where a shadow ends at the
receiver's silhouette or at its unlit side, as the pixels beyond are not counted. Each point of either edge has a
distance to the nearest point of the other edge. The metrics are the mean, the 95th percentile and the largest of the
distances of both edges together. The largest is the Hausdorff distance; one stray pixel can make it large.

None is a share of no shadow or a distance from no edge.
"""

from __future__ import annotations

from typing import TypedDict

import numpy as np

# The levels of `picture`.
NOT_COUNTED = 0
RIGHT_LIT = 1
RIGHT_SHADOW = 2
WRONGLY_LIT = 3
WRONGLY_SHADOW = 4


class Distances(TypedDict):
    """Between two edges, in pixels."""

    mean: float
    p95: float
    hausdorff: float


class Metrics(TypedDict):
    """Of a shadow against the true one; see above."""

    wrong: float | None
    iou: float | None
    edge_mean: float | None
    edge_95: float | None
    edge_hausdorff: float | None


def check(*masks: np.ndarray) -> None:
    if any(mask.dtype != bool or mask.ndim != 2 or mask.shape != masks[0].shape for mask in masks):
        raise ValueError("masks are boolean, height x width, and of one size: "
                         + ", ".join(f"{mask.dtype} {mask.shape}" for mask in masks))


def edge(shadow: np.ndarray, counted: np.ndarray) -> np.ndarray:
    """The points of the shadow's edge, (row, column); a pixel's centre has whole numbers."""
    check(shadow, counted)
    down = counted[1:] & counted[:-1] & (shadow[1:] != shadow[:-1])
    right = counted[:, 1:] & counted[:, :-1] & (shadow[:, 1:] != shadow[:, :-1])
    return np.concatenate([np.argwhere(down) + np.array([0.5, 0.0]), np.argwhere(right) + np.array([0.0, 0.5])])


def edge_distances(a: np.ndarray, b: np.ndarray, counted: np.ndarray) -> Distances | None:
    """Between the edges of two shadows, the same whichever comes first. None where one has no edge."""
    from scipy.spatial import KDTree  # comes with scikit-image, which may be missing

    points_a, points_b = edge(a, counted), edge(b, counted)
    if not len(points_a) or not len(points_b):
        return None
    found = np.concatenate([KDTree(points_b).query(points_a)[0], KDTree(points_a).query(points_b)[0]])
    return {"mean": float(found.mean()), "p95": float(np.percentile(found, 95)), "hausdorff": float(found.max())}


def measure(shadow: np.ndarray, truth: np.ndarray, counted: np.ndarray) -> Metrics:
    check(shadow, truth, counted)
    ours, theirs = shadow & counted, truth & counted
    true_pixels, either = int(theirs.sum()), int((ours | theirs).sum())
    distances = edge_distances(shadow, truth, counted)
    return {
        "wrong": 100 * int((ours != theirs).sum()) / true_pixels if true_pixels else None,
        "iou": int((ours & theirs).sum()) / either if either else None,
        "edge_mean": distances["mean"] if distances else None,
        "edge_95": distances["p95"] if distances else None,
        "edge_hausdorff": distances["hausdorff"] if distances else None,
    }


def picture(shadow: np.ndarray, truth: np.ndarray, counted: np.ndarray) -> np.ndarray:
    """Where the shadow is right and wrong: height x width, uint8, of the levels above."""
    check(shadow, truth, counted)
    levels = np.array([[RIGHT_LIT, WRONGLY_LIT], [WRONGLY_SHADOW, RIGHT_SHADOW]], dtype=np.uint8)
    return np.where(counted, levels[shadow.astype(int), truth.astype(int)], np.uint8(NOT_COUNTED))
