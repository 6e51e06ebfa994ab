"""The ring's centre over time, if that is wanted: a straight path at constant speed, of which each frame corrects a share.

The α-β filter (Kalata 1984) with β = 2(2 − α) − 4√(1 − α), the pair that is optimal for white acceleration noise. It has no lag
behind a uniform motion, and divides the noise from frame to frame by about √2/α for small α. With α = 1 it answers each frame's
own measurement.
"""

from dataclasses import dataclass

import numpy as np

from scenes.arrays import Floats


@dataclass(frozen=True, slots=True, eq=False)
class CentreFilter:
    """``centre_m`` (3,) and ``velocity_m_s`` (3,) in left camera axes at ``time_s``."""

    centre_m: Floats
    velocity_m_s: Floats
    time_s: float


def filtered(
    before: CentreFilter | None, centre_m: Floats, time_s: float, gain: float, longest_s: float, farthest_m: float
) -> CentreFilter:
    """After another measurement; begun anew after a gap longer than ``longest_s``, or farther than ``farthest_m`` from the path."""
    if before is None or not 0 < time_s - before.time_s <= longest_s:
        return CentreFilter(centre_m, np.zeros(3), time_s)
    dt = time_s - before.time_s
    expected = before.centre_m + before.velocity_m_s * dt
    off = centre_m - expected
    if not before.velocity_m_s.any() or gain == 1 or np.linalg.norm(off) > farthest_m:
        return CentreFilter(centre_m, (centre_m - before.centre_m) / dt, time_s)
    beta = 2 * (2 - gain) - 4 * np.sqrt(1 - gain)
    return CentreFilter(expected + gain * off, before.velocity_m_s + beta * off / dt, time_s)
