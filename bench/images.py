"""How far a picture is from the true one: both linear RGB, floats, height x width x 3.

rmse    root mean square error over all pixels and channels, in linear light, not clipped; 0 is the best
psnr    peak signal to noise ratio, dB; more is better. Identical pictures have PSNR_CEILING, which JSON can hold
ssim    structural similarity, -1 to 1, 1 is the best: Wang et al. 2004 (Gaussian window, sigma 1.5, K 0.01 and 0.03),
        for each channel and averaged; a picture must have at least 11 x 11 pixels, the window's size
flip    mean FLIP error, 0 to 1, 0 is the best: LDR-FLIP at its default distance, 67 pixels a degree

The last three are about what is seen: they take the pictures clipped to 0 to 1 and sRGB-encoded. A metric is None where
its package is missing; `missing` names the packages.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Mapping
from types import ModuleType
from typing import TypedDict

import numpy as np

PSNR_CEILING = 100.0  # dB: an error of 1e-5, or of 1/400 of a step in 8 bits; smaller errors count the same
LEAST_SIDE = 11  # pixels
# Without these some metrics are None: their names for pip and for Python.
PACKAGES = {"scikit-image": "skimage.metrics", "flip-evaluator": "flip_evaluator"}


class Metrics(TypedDict):
    """Of a picture against the true one; the file's head explains them."""

    rmse: float
    psnr: float
    ssim: float | None
    flip: float | None


def load(module: str) -> ModuleType | None:
    """The module; None where it can't be imported."""
    try:
        return importlib.import_module(module)
    except ImportError:
        return None


def missing(packages: Mapping[str, str] = PACKAGES) -> list[str]:
    """Those of the packages, by their names for pip, that can't be imported."""
    return [package for package, module in packages.items() if load(module) is None]


def srgb(linear: np.ndarray) -> np.ndarray:
    """Clipped to 0 to 1 and encoded by IEC 61966-2-1; still floats."""
    x = np.clip(linear.astype(np.float64), 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def linear_of_srgb(encoded: np.ndarray) -> np.ndarray:
    """The inverse of `srgb`, for values of 0 to 1."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def rmse(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.sqrt(np.mean((a.astype(np.float64) - b) ** 2)))


def psnr(a: np.ndarray, b: np.ndarray) -> float:
    """Of encoded pictures, whose peak is 1."""
    error = rmse(a, b)
    return min(-20 * math.log10(error), PSNR_CEILING) if error else PSNR_CEILING


def ssim(a: np.ndarray, b: np.ndarray) -> float | None:
    """Of encoded pictures."""
    metrics = load("skimage.metrics")
    if metrics is None:
        return None
    return float(metrics.structural_similarity(a, b, channel_axis=-1, data_range=1.0, gaussian_weights=True, sigma=1.5,
                                               use_sample_covariance=False))


def flip(test: np.ndarray, reference: np.ndarray) -> float | None:
    """Of encoded pictures."""
    evaluator = load("flip_evaluator")
    if evaluator is None:
        return None
    return float(evaluator.evaluate(reference.astype(np.float32), test.astype(np.float32), "LDR", applyMagma=False)[1])


def measure(picture: np.ndarray, truth: np.ndarray) -> Metrics:
    """All metrics of a linear picture against the true one."""
    for array in (picture, truth):
        if array.ndim != 3 or array.shape[2] != 3 or array.shape != truth.shape or min(array.shape[:2]) < LEAST_SIDE:
            raise ValueError(f"pictures are height x width x 3, of one size, and {LEAST_SIDE} or more pixels each way: "
                             f"{picture.shape} {truth.shape}")
        if not np.isfinite(array).all():
            raise ValueError("a picture has values that are not finite")
    a, b = srgb(picture), srgb(truth)
    return {"rmse": rmse(picture, truth), "psnr": psnr(a, b), "ssim": ssim(a, b), "flip": flip(a, b)}
