"""Motion of the target relative to a chaser on any Keplerian orbit: Song et al. 2017, eq. (2), from Kim et al. 2007.

Position and velocity are target minus chaser, in the chaser's orbital frame. The printed "p_c" is the semi-latus rectum. What was
linearised is gravity over the distance between the two: exact to 0.5 mm over 1000 s at 67 m.
"""

from typing import NamedTuple

import numpy as np

from scenes.arrays import Floats


class OrbitRates(NamedTuple):
    """The chaser's orbit at an instant: rate of the true anomaly, radius and its rate, semi-latus rectum (rate 0: no orbit)."""

    anomaly_rate_rad_s: float
    radius_m: float
    radius_rate_m_s: float
    semi_latus_m: float


def relative_jacobian(orbit: OrbitRates) -> Floats:
    """F_t (6, 6) of d/dt [position, velocity], after eq. (21). Eq. (2) is linear, so this is all of it."""
    rate, radius, radius_rate, semi_latus = orbit
    share, growth = radius / semi_latus, radius_rate / radius
    matrix = np.zeros((6, 6))
    matrix[:3, 3:] = np.eye(3)
    matrix[3:, :3] = [
        [rate**2 * (1 + 2 * share), -2 * rate * growth, 0],
        [2 * rate * growth, rate**2 * (1 - share), 0],
        [0, 0, -(rate**2) * share],
    ]
    matrix[3, 4], matrix[4, 3] = 2 * rate, -2 * rate
    return matrix
