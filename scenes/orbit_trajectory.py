"""A tumble in orbit, bound to its target's mass properties, as the rest of the program asks for it."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.arrays import Floats, frozen, unit
from scenes.attitude_pointing import pointed
from scenes.errors import UsageError
from scenes.inertia import MassProperties
from scenes.orbit import lvlh, relative_state
from scenes.orbit_motion import TumbleInOrbit
from scenes.orbit_realisation import Realisation
from scenes.recording import ChaserState
from scenes.spec import Vector3
from scenes.tumble import ATTITUDE, OMEGA, POSITIONS, VELOCITIES, Tumble

_SEEDS_KEPT = 8


@dataclass(frozen=True, slots=True, eq=False)
class Instant:
    """Both craft at ``time_s``: inertial positions and velocities (2, 3), target first; attitudes (3, 3), angular velocities.

    ``omega_body_rad_s`` in body axes and ``omega_chaser_rad_s`` in chaser axes are inertial angular velocities.
    """

    time_s: float
    positions_m: Floats
    velocities_m_s: Floats
    inertial_from_body: Floats
    omega_body_rad_s: Floats
    inertial_from_chaser: Floats
    omega_chaser_rad_s: Floats

    @property
    def chaser_from_body(self) -> Floats:
        """Takes points from the target's principal axes into chaser axes, (4, 4); the chaser's centre of mass is their origin."""
        matrix = np.eye(4)
        matrix[:3, :3] = self.inertial_from_chaser.T @ self.inertial_from_body
        matrix[:3, 3] = self.inertial_from_chaser.T @ (self.positions_m[0] - self.positions_m[1])
        return matrix


class TumbleTrajectory:
    """The ``Trajectory`` of a ``TumbleInOrbit``. Angular velocity of the target against the chaser, pose of the target frame."""

    def __init__(self, motion: TumbleInOrbit, mass: MassProperties) -> None:
        """Nothing is integrated before it is asked for."""
        self._motion = motion
        self._body_from_target = frozen(mass.target_from_body.inv().as_matrix())
        self._tumble = Tumble(mass.principal_kg_m2, motion.j2, motion.gravity_gradient)
        self._reference = unit(motion.roll_reference)
        self._realisations: dict[int, Realisation] = {}

    def instant(self, time_s: float, seed: int) -> Instant:
        """Both craft at ``time_s``. Raises ``UsageError`` where the chaser cannot point at the target."""
        state = self._realisation(seed).state(time_s)
        positions, velocities = state[POSITIONS].reshape(2, 3), state[VELOCITIES].reshape(2, 3)
        try:
            attitude, omega = pointed(positions[0] - positions[1], velocities[0] - velocities[1], self._reference)
        except UsageError as error:
            raise UsageError(f"motion.roll_reference: at {time_s:g} s {error}") from None
        return Instant(
            time_s=time_s,
            positions_m=frozen(positions),
            velocities_m_s=frozen(velocities),
            inertial_from_body=frozen(Rotation.from_quat(state[ATTITUDE], scalar_first=True).as_matrix()),
            omega_body_rad_s=frozen(state[OMEGA]),
            inertial_from_chaser=attitude,
            omega_chaser_rad_s=omega,
        )

    def chaser_from_target(self, time_s: float, frame: int, seed: int) -> RigidTransform:  # noqa: ARG002
        """The pose of the target frame at ``time_s``."""
        return RigidTransform.from_matrix(self.instant(time_s, seed).chaser_from_body @ self._body_from_target)

    def omega_target_rad_s(self, time_s: float, seed: int = 0) -> Vector3:
        """Angular velocity of the target against the chaser, in target axes: ω_body − R ω_chaser (Song et al. 2017, eq. (9))."""
        now = self.instant(time_s, seed)
        body_from_chaser = now.inertial_from_body.T @ now.inertial_from_chaser
        omega_body = now.omega_body_rad_s - body_from_chaser @ now.omega_chaser_rad_s
        x, y, z = (self._body_from_target[:3, :3].T @ omega_body).tolist()
        return x, y, z

    def chaser_state(self, time_s: float, seed: int) -> ChaserState:
        """What the chaser's navigation knows of itself."""
        now = self.instant(time_s, seed)
        return ChaserState(
            time_s=time_s,
            inertial_from_chaser=Rotation.from_matrix(now.inertial_from_chaser),
            position_inertial_m=frozen(now.positions_m[1]),
            velocity_inertial_m_s=frozen(now.velocities_m_s[1]),
            omega_chaser_rad_s=now.omega_chaser_rad_s,
        )

    def truth_columns(self, time_s: float, seed: int) -> dict[str, float]:
        """The whole state: ``body_q*`` = inertial_from_body, ``rel_*`` in the chaser's LVLH, the chaser's own (inertial axes)."""
        now = self.instant(time_s, seed)
        (target_m, chaser_m), (target_m_s, chaser_m_s) = now.positions_m, now.velocities_m_s
        frame = lvlh(chaser_m, chaser_m_s, j2=self._motion.j2)
        position, velocity = relative_state(frame, target_m - chaser_m, target_m_s - chaser_m_s)
        return (
            _quaternion("body", now.inertial_from_body)
            | _vector("omega_body_{}_rad_s", now.omega_body_rad_s)
            | _vector("rel_{}_m", position)
            | _vector("rel_v{}_m_s", velocity)
            | _quaternion("chaser", now.inertial_from_chaser)
            | _vector("chaser_{}_m", chaser_m)
            | _vector("chaser_v{}_m_s", chaser_m_s)
            | {
                "lvlh_rate_rad_s": float(frame.omega_lvlh_rad_s[2]),
                "orbit_radius_m": frame.radius_m,
                "orbit_radius_rate_m_s": frame.radius_rate_m_s,
            }
        )

    def _realisation(self, seed: int) -> Realisation:
        if seed not in self._realisations:
            while len(self._realisations) >= _SEEDS_KEPT:
                del self._realisations[next(iter(self._realisations))]
            self._realisations[seed] = Realisation(self._motion, self._tumble, seed)
        return self._realisations[seed]


@lru_cache(maxsize=8)
def bound(motion: TumbleInOrbit, mass: MassProperties) -> TumbleTrajectory:
    """The trajectory of a motion and a mass: one object, so that each course is integrated once in a process."""
    return TumbleTrajectory(motion, mass)


def _quaternion(name: str, matrix: Floats) -> dict[str, float]:
    numbers = Rotation.from_matrix(matrix).as_quat(canonical=True, scalar_first=True)
    return {f"{name}_q{axis}": float(one) for axis, one in zip("wxyz", numbers)}


def _vector(name: str, vector: Floats) -> dict[str, float]:
    return {name.format(axis): float(one) for axis, one in zip("xyz", np.asarray(vector))}
