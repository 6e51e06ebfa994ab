"""How far is the gradient's balance? Exact for every sub-pixel phase, but only where the edge is a plain step.

The first moment of the gradient, which summed by parts is the area under the profile (Tabatabai & Mitchell 1984): box
pixels and any symmetric point spread leave it where it is.
"""

import numpy as np
from numpy.typing import NDArray

from estimators.mono_rectangle.stations import Stations
from scenes.arrays import Floats

_TRANSITION_PX = 1.75  # half-width of a step after box pixel and point spread
_INSIDE_PX = 4.25  # beyond it, over how many pixels the brightness inside is taken


def to_balance(pixels: NDArray[np.generic], stations: Stations, outside_px: float) -> tuple[Floats, Floats]:
    """Distance outward (n,) px from the line to the gradient's balance, and the weight (n,): the step across the edge.

    Σ D F(u) / Σ D over the differences D of neighbouring pixels at distances u. F(u) = u across the whole transition, so
    that the quotient is the first moment; beyond, F sinks to 0 (outside within ``outside_px``), which takes the
    brightness on both sides from the pixels at hand: farther inside, where their shot noise is larger.
    """
    slant = float(np.sqrt(1 / stations.cosine.min() ** 2 - 1))
    full = _TRANSITION_PX * (1 + slant) / np.hypot(1, slant)
    reach = int(np.ceil((full + max(_INSIDE_PX, outside_px)) / float(stations.cosine.min()))) + 1
    values, outward = stations.gather(pixels, reach)
    fall, at = -np.diff(values, axis=1) * stations.outward, (outward[:, 1:] + outward[:, :-1]) / 2
    ramp = np.interp(at, [-full - _INSIDE_PX, -full, full, full + outside_px], [0.0, -full, full, 0.0])
    step = np.sum(fall, axis=1, where=np.abs(at) < full + 1)
    typical = float(np.median(step))
    sound = step * np.sign(typical) > 0.3 * abs(typical)
    distance = np.sum(fall * ramp, axis=1) / np.where(sound, step, 1.0)
    near = sound & (np.abs(distance) < full)
    return np.where(near, distance, 0.0), np.where(near, np.minimum(np.abs(step), 3 * abs(typical)), 0.0)
