"""Two craft in orbit, one of them tumbling: the equations of motion and one step of their integration.

State (19,): positions of target and chaser, their velocities (inertial axes, m and m/s), inertial_from_body as w, x, y, z,
angular velocity of the target in body axes (rad/s). Body axes are the target's principal axes.
"""

from dataclasses import dataclass

import numpy as np

from scenes.arrays import Floats
from scenes.constants import EARTH_MU_M3_S2
from scenes.orbit import cross, gravity_m_s2

POSITIONS, VELOCITIES, ATTITUDE, OMEGA = slice(0, 6), slice(6, 12), slice(12, 16), slice(16, 19)
DISTURBANCES = 9  # accelerations of target and chaser, inertial axes; angular acceleration of the target, body axes


@dataclass(frozen=True, slots=True)
class Tumble:
    """The forces on two craft: ``principal_kg_m2`` of the target, the Earth's flatness, the pull on the target's two ends."""

    principal_kg_m2: tuple[float, float, float]
    j2: bool
    gravity_gradient: bool

    def rates(self, state: Floats, disturbance: Floats) -> Floats:
        """Time derivative (19,) of a state under accelerations (9,)."""
        positions = state[POSITIONS].reshape(2, 3)
        acceleration = gravity_m_s2(positions, j2=self.j2).ravel() + disturbance[:6]
        turning = self._angular_acceleration(state) + disturbance[6:]
        return np.concatenate([state[VELOCITIES], acceleration, _attitude_rate(state), turning])

    def step(self, state: Floats, step_s: float, disturbance: Floats) -> Floats:
        """The state ``step_s`` later (or earlier), the disturbance held: classical Runge-Kutta, order 4."""
        k1 = self.rates(state, disturbance)
        k2 = self.rates(state + step_s / 2 * k1, disturbance)
        k3 = self.rates(state + step_s / 2 * k2, disturbance)
        k4 = self.rates(state + step_s * k3, disturbance)
        later = state + step_s / 6 * (k1 + 2 * (k2 + k3) + k4)
        later[ATTITUDE] /= np.sqrt(later[ATTITUDE] @ later[ATTITUDE])
        return np.asarray(later)

    def _angular_acceleration(self, state: Floats) -> Floats:
        """Euler's equations, ω̇ = I⁻¹ (τ − ω × Iω), with the gravity-gradient torque 3 μ/r⁵ r × I r."""
        x, y, z = self.principal_kg_m2
        a, b, c = state[OMEGA].tolist()
        free = np.array([(y - z) / x * b * c, (z - x) / y * c * a, (x - y) / z * a * b])
        if not self.gravity_gradient:
            return free
        moments, radial = np.array(self.principal_kg_m2), _in_body(state)
        square = float(radial @ radial)
        torque = 3 * EARTH_MU_M3_S2 / square**2.5 * cross(radial, moments * radial)
        return np.asarray(free + torque / moments)


def _attitude_rate(state: Floats) -> Floats:
    """q̇ = ½ q ⊗ (0, ω), with ω in body axes."""
    w, x, y, z = state[ATTITUDE].tolist()
    a, b, c = state[OMEGA].tolist()
    return 0.5 * np.array([-x * a - y * b - z * c, w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a])


def _in_body(state: Floats) -> Floats:
    """The target's position in body axes: v + 2 u × (u × v − w v) with u = (x, y, z), the inverse of the state's rotation."""
    w, vector = float(state[ATTITUDE][0]), state[ATTITUDE][1:]
    position = state[POSITIONS][:3]
    return np.asarray(position + 2 * cross(vector, cross(vector, position) - w * position))
