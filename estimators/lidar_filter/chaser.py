"""The chaser's own state between the instants at which it is known, and the orbital frame that moves with it.

``lvlh`` is the chaser's local-vertical-local-horizontal frame: x away from the Earth, z along the orbit's normal.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from estimators.lidar_filter.relative_orbit import OrbitRates
from estimators.lidar_filter.rigid_body import cross_matrix
from scenes.arrays import Floats
from scenes.constants import EARTH_MU_M3_S2
from scenes.recording import ChaserState


def at_rest(time_s: float) -> ChaserState:
    """A chaser that says nothing of itself: taken as inertial, without an orbit, with the inertial axes for its own."""
    zero = np.zeros(3)
    return ChaserState(time_s, Rotation.identity(), zero, zero, zero)


def has_orbit(chaser: ChaserState) -> bool:
    """Whether the chaser goes round anything."""
    return bool(np.any(chaser.position_inertial_m))


def chaser_at(chaser: ChaserState, time_s: float) -> ChaserState:
    """The chaser a little earlier or later: at a constant turn rate, along its two-body orbit's series to third order."""
    dt = time_s - chaser.time_s
    if dt == 0:
        return chaser
    turned = chaser.inertial_from_chaser * Rotation.from_rotvec(chaser.omega_chaser_rad_s * dt)
    r, v = chaser.position_inertial_m, chaser.velocity_inertial_m_s
    if has_orbit(chaser):
        square = r @ r
        rate = EARTH_MU_M3_S2 / square**1.5  # n²: acceleration −n² r, and of that the derivative
        pull, change = -rate * r, -rate * (v - 3 * (r @ v) / square * r)
        r, v = r + dt * (v + dt / 2 * (pull + dt / 3 * change)), v + dt * (pull + dt / 2 * change)
    return ChaserState(time_s, turned, r, v, chaser.omega_chaser_rad_s)


def inertial_from_lvlh(chaser: ChaserState) -> Floats:
    """Axes of the chaser's orbital frame as the columns of a matrix (3, 3); the inertial axes where there is no orbit."""
    if not has_orbit(chaser):
        return np.eye(3)
    r, v = chaser.position_inertial_m, chaser.velocity_inertial_m_s
    x = r / np.sqrt(r @ r)
    along = v - (v @ x) * x
    y = along / np.sqrt(along @ along)
    return np.stack([x, y, cross_matrix(x) @ y], axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class ChaserOrbit:
    """Scalars of the chaser's orbit at ``time_s``: ``momentum_m2_s`` (0: no orbit), ``radius_m`` and its rate."""

    time_s: float
    momentum_m2_s: float
    radius_m: float
    radius_rate_m_s: float

    @staticmethod
    def of(chaser: ChaserState) -> "ChaserOrbit":
        """From the chaser's position and velocity."""
        if not has_orbit(chaser):
            return ChaserOrbit(chaser.time_s, 0.0, 1.0, 0.0)
        position, velocity = chaser.position_inertial_m, chaser.velocity_inertial_m_s
        radius, along = float(np.sqrt(position @ position)), float(position @ velocity)
        momentum = float(np.sqrt(radius**2 * float(velocity @ velocity) - along**2))  # |r × v|
        return ChaserOrbit(chaser.time_s, momentum, radius, along / radius)

    def rates_at(self, time_s: float) -> OrbitRates:
        """What the equations of relative motion need at a time near by: r(t) to second order, momentum kept."""
        if self.momentum_m2_s == 0:
            return OrbitRates(0.0, 1.0, 0.0, 1.0)
        dt = time_s - self.time_s
        pull = self.momentum_m2_s**2 / self.radius_m**3 - EARTH_MU_M3_S2 / self.radius_m**2
        radius = self.radius_m + self.radius_rate_m_s * dt + pull * dt**2 / 2
        return OrbitRates(
            self.momentum_m2_s / radius**2, radius, self.radius_rate_m_s + pull * dt, self.momentum_m2_s**2 / EARTH_MU_M3_S2
        )
