"""How far is the largest gradient? The coarse of the three measures: it needs no levels and sees two pixels far."""

import numpy as np
from numpy.typing import NDArray

from estimators.mono_rectangle.stations import Stations
from scenes.arrays import Floats

_PSF_VARIANCE = 0.35  # px²: of a sharp lens and a box pixel; it only sets the length of a step, not where it ends


def to_gradient_peak(pixels: NDArray[np.generic], stations: Stations, sigma: float, polarity: int) -> tuple[Floats, Floats]:
    """Distance outward (n,) px from the line to the gradient's maximum, and the weight (n,): the gradient there.

    The picture is correlated with the first and the second derivative of a Gaussian of ``sigma`` px at the line; at a
    maximum the second is nought, and near it their quotient is the distance over σ² + σ_psf².
    """
    reach = int(np.ceil(4 * sigma / float(stations.cosine.min()))) + 1
    values, outward = stations.gather(pixels, reach)
    values = values - values[:, reach : reach + 1]
    u = outward / sigma
    bell = np.exp(-(u**2) / 2)
    scale = polarity * stations.cosine / (sigma**2 * np.sqrt(2 * np.pi))
    strength = -np.sum(values * u * bell, axis=1) * scale
    change = -np.sum(values * (u**2 - 1) * bell, axis=1) * scale / sigma
    typical = max(float(np.median(strength)), 1e-9)
    distance = (sigma**2 + _PSF_VARIANCE) * change / np.maximum(strength, 0.3 * typical)
    weight = np.where(strength > 0.3 * typical, np.minimum(strength, 3 * typical), 0.0)
    return np.clip(distance, -2 * sigma, 2 * sigma), weight
