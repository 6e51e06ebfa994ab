"""Brightness and noise on both sides of an edge."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimators.mono_rectangle.stations import Stations
from scenes.arrays import Bools, Floats

_QUANTISATION_DN = 0.29  # 1/√12: no picture of whole numbers is better known


@dataclass(frozen=True, slots=True)
class Side:
    """Median ``level_dn`` of the pixels on one side, and ``noise_dn``, 1σ of one pixel; NaN without pixels."""

    level_dn: float
    noise_dn: float


def sides_of(pixels: NDArray[np.generic], stations: Stations, between_px: tuple[float, float]) -> tuple[Side, Side]:
    """Inside and outside, from the pixels whose distance from the edge lies between the two given ones."""
    reach = int(np.ceil(between_px[1] / float(stations.cosine.min()))) + 1
    values, outward = stations.gather(pixels, reach)
    near = (np.abs(outward) > between_px[0]) & (np.abs(outward) < between_px[1])
    return _side(values, near & (outward < 0)), _side(values, near & (outward > 0))


def _side(values: Floats, chosen: Bools) -> Side:
    """The noise is taken from the differences of neighbours along the edge, so that slow shading is none; the largest fifth
    counts as the next smaller one, so that a crossing boom is none: 0.824 σ of a Gaussian's differences are left."""
    if not chosen.any():
        return Side(float("nan"), float("nan"))
    steps = np.abs(np.diff(values, axis=0)[chosen[1:] & chosen[:-1]])
    most = np.partition(steps, int(0.8 * steps.size))[int(0.8 * steps.size)] if steps.size else 0.0
    noise = float(np.sqrt(np.mean(np.minimum(steps, most) ** 2) / 2)) / 0.824 if steps.size else 0.0
    return Side(float(np.median(values[chosen])), max(noise, _QUANTISATION_DN))
