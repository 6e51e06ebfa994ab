"""Step 4 of section 2.3.1: of ellipses that are one and the same, the best covered stays."""

import numpy as np
from numpy.typing import NDArray

from estimators.stereo_ring.conics import conics_from_parameters, points_on_parameters, sampson_px
from scenes.arrays import Bools, Floats

_SAMPLES = 12
_MOST = 400
_FAR = 4  # times that distance: centres or axes further apart need no look at the points


def distinct(ellipses: Floats, score: Floats, nearer_than: float, most: int) -> NDArray[np.intp]:
    """Indices of the best of each cluster of ellipses (n, 5), the highest ``score`` (n,) first, ``most`` at most."""
    order = np.argsort(-score, kind="stable")[:_MOST]
    same = alike(ellipses[order], nearer_than)
    free = np.ones(len(order), dtype=bool)
    chosen: list[int] = []
    for place in range(len(order)):
        if free[place] and len(chosen) < most:
            chosen.append(place)
            free &= ~same[place]
    return order[np.array(chosen, dtype=np.intp)]


def alike(ellipses: Floats, nearer_than: float) -> Bools:
    """Which pairs (n, n) are nowhere further apart than ``nearer_than``, by the points of one against the conic of the other."""
    close = (np.abs(ellipses[:, None, :4] - ellipses[None, :, :4]) <= _FAR * nearer_than).all(axis=-1)
    first, second = np.nonzero(np.triu(close))
    conics, points = conics_from_parameters(ellipses), points_on_parameters(ellipses, _SAMPLES)
    there, back = (np.abs(sampson_px(conics[i], points[j])).max(axis=-1) for i, j in ((first, second), (second, first)))
    same = np.zeros((len(ellipses), len(ellipses)), dtype=bool)
    same[first, second] = np.minimum(there, back) <= nearer_than
    return same | same.T
