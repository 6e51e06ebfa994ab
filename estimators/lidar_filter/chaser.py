"""The chaser's own state between the instants at which it is known, and the orbital frame that moves with it.

``lvlh`` is the chaser's local-vertical-local-horizontal frame: x away from the Earth, z along the orbit's normal.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from estimators.lidar_filter.relative_orbit import EARTH_GM_M3_S2, OrbitRates
from estimators.lidar_filter.rigid_body import cross_matrix
from scenes.arrays import Floats, unit
from scenes.recording import ChaserState


def at_rest(time_s: float) -> ChaserState:
    """A chaser that says nothing of itself: taken as inertial, without an orbit, with the inertial axes for its own."""
    zero = np.zeros(3)
    return ChaserState(time_s, Rotation.identity(), zero, zero, zero)


def has_orbit(chaser: ChaserState) -> bool:
    """Whether the chaser goes round anything."""
    return bool(np.any(chaser.position_inertial_m))


def chaser_at(chaser: ChaserState, time_s: float) -> ChaserState:
    """The chaser a little earlier or later: at a constant turn rate, along a two-body orbit (one Runge-Kutta step)."""
    dt = time_s - chaser.time_s
    if dt == 0:
        return chaser
    turned = chaser.inertial_from_chaser * Rotation.from_rotvec(chaser.omega_chaser_rad_s * dt)
    now = replace(chaser, time_s=time_s, inertial_from_chaser=turned)
    if not has_orbit(chaser):
        return now
    state = np.concatenate([chaser.position_inertial_m, chaser.velocity_inertial_m_s])
    a = _two_body(state)
    b = _two_body(state + dt / 2 * a)
    c = _two_body(state + dt / 2 * b)
    d = _two_body(state + dt * c)
    state = state + dt / 6 * (a + 2 * b + 2 * c + d)
    return replace(now, position_inertial_m=state[:3], velocity_inertial_m_s=state[3:])


def _two_body(state: Floats) -> Floats:
    """d/dt of position and velocity (6,)."""
    radius = np.sqrt(state[:3] @ state[:3])
    return np.concatenate([state[3:], -EARTH_GM_M3_S2 / radius**3 * state[:3]])


def inertial_from_lvlh(chaser: ChaserState) -> Floats:
    """Axes of the chaser's orbital frame as the columns of a matrix (3, 3); the inertial axes where there is no orbit."""
    if not has_orbit(chaser):
        return np.eye(3)
    x = unit(chaser.position_inertial_m)
    z = unit(cross_matrix(x) @ chaser.velocity_inertial_m_s)
    return np.stack([x, cross_matrix(z) @ x, z], axis=1)


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
        pull = self.momentum_m2_s**2 / self.radius_m**3 - EARTH_GM_M3_S2 / self.radius_m**2
        radius = self.radius_m + self.radius_rate_m_s * dt + pull * dt**2 / 2
        return OrbitRates(
            self.momentum_m2_s / radius**2, radius, self.radius_rate_m_s + pull * dt, self.momentum_m2_s**2 / EARTH_GM_M3_S2
        )
