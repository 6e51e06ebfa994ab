"""Coarse search: which straight lines near a predicted edge have a brightness step all along?

A Hough transform in miniature: its axes are the shifts of the line's two ends, and each station votes with its smoothed
gradient, bounded so that a short glaring piece cannot outvote a faint edge that is there all along.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter

from estimators.mono_rectangle.stations import Stations
from scenes.arrays import Floats

_STATIONS = 64
_KERNEL_REACH = 3


def search_lines(
    pixels: NDArray[np.generic],
    stations: Stations,
    window_px: float,
    half_step_dn: float,
    polarities: tuple[int, ...],
    keep: int,
) -> list[tuple[Floats, int]]:
    """Shifts (2,) of the line's ends along its normal, px, outward positive, and polarity; best first, at most ``keep``.

    ``half_step_dn``: the step at which a station casts half a vote. ``polarities``: +1 bright inside, −1 bright outside.
    """
    if len(stations.at) < 4:
        return []
    reach = int(np.ceil(window_px / max(float(stations.cosine.min()), 0.5)))
    thin = max(1, len(stations.at) // _STATIONS)
    gradient = _smoothed_gradient(pixels, stations, reach)[::thin]
    found: list[tuple[float, Floats, int]] = []
    for polarity in polarities:
        signed = np.clip(polarity * gradient, 0, None)
        votes = signed / (signed + 0.35 * half_step_dn)
        found += [(vote, shift, polarity) for vote, shift in _peaks(_ballot(votes, stations, reach, thin), reach, keep)]
    found.sort(key=lambda peak: -peak[0])
    return [(shift * float(stations.cosine.mean()), polarity) for _, shift, polarity in found[:keep]]


def _smoothed_gradient(pixels: NDArray[np.generic], stations: Stations, reach: int) -> Floats:
    """(n, 2·reach+1): fall of brightness outward, DN a px, at whole shifts of the nearest pixel to the crossing."""
    values, _ = stations.gather(pixels, reach + _KERNEL_REACH)
    offset = np.arange(-_KERNEL_REACH, _KERNEL_REACH + 1)
    kernel = -offset * np.exp(-(offset**2) / 2) / np.sqrt(2 * np.pi)
    windows = np.lib.stride_tricks.sliding_window_view(values, 2 * _KERNEL_REACH + 1, axis=1)
    gradient = windows @ kernel * stations.outward
    return np.asarray(gradient if stations.outward > 0 else gradient[:, ::-1])


def _ballot(votes: Floats, stations: Stations, reach: int, thin: int) -> Floats:
    """Mean vote (2·reach+1, 2·reach+1) of the lines whose two ends are shifted outward by whole pixels."""
    shift = np.arange(-reach, reach + 1, dtype=np.float64)
    fraction = stations.fraction[::thin]
    rounding = stations.outward * (np.rint(stations.crossing) - stations.crossing)[::thin]
    line = (1 - fraction)[:, None, None] * shift[:, None] + fraction[:, None, None] * shift
    index = np.clip(np.rint(line - rounding[:, None, None]).astype(np.int64) + reach, 0, 2 * reach)
    return np.asarray(np.take_along_axis(votes, index.reshape(len(votes), -1), axis=1).mean(axis=0).reshape(line.shape[1:]))


def _peaks(ballot: Floats, reach: int, keep: int) -> list[tuple[float, Floats]]:
    highest = np.argwhere((ballot == maximum_filter(ballot, size=5)) & (ballot > 0.15))
    best = sorted(((float(ballot[i, j]), i, j) for i, j in highest), reverse=True)[:keep]
    return [(vote, np.array([i - reach, j - reach], dtype=np.float64)) for vote, i, j in best]
