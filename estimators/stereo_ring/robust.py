"""Weights that forget outliers: Tukey's biweight, its scale from the median (Huber & Ronchetti 2009)."""

import numpy as np

from scenes.arrays import Bools, Floats

_TUKEY = 4.685  # 95 % efficiency for Gaussian noise
MAD_TO_SIGMA = 1.4826


def tukey_weights(residual: Floats, known: Bools, least_sigma: float) -> Floats:
    """Weights (..., n) of residuals (..., n), 0 where not ``known``; each row has its own scale, at least ``least_sigma``."""
    sigma = np.maximum(MAD_TO_SIGMA * median_of_known(np.abs(residual), known), least_sigma)[..., None]
    return np.where(known, np.maximum(1 - (residual / (_TUKEY * sigma)) ** 2, 0.0) ** 2, 0.0)


def median_of_known(values: Floats, known: Bools) -> Floats:
    """The (lower) median (...,) of each row's known values (..., n); 0 where none is known. Much faster than NumPy's with NaN."""
    ordered = np.sort(np.where(known, values, np.inf), axis=-1)
    count = np.sum(known, axis=-1, keepdims=True)
    middle = np.take_along_axis(ordered, np.maximum(count - 1, 0) // 2, axis=-1)
    return np.where(count > 0, middle, 0.0)[..., 0]
