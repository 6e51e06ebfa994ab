"""Where the target is going: the last two frames say where the next one finds it."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from estimators.stereo_ring.circle_cone import Circle
from scenes.arrays import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """``left_from_ring`` at ``time_s``; ``velocity_m_s`` (3,) in left axes and ``rate_rad_s`` (3,) in ring axes, None before
    there were two frames."""

    left_from_ring: RigidTransform
    time_s: float
    velocity_m_s: Floats | None = None
    rate_rad_s: Floats | None = None

    def at(self, time_s: float, longest_s: float) -> RigidTransform:
        """left_from_ring if nothing changes; after more than ``longest_s`` nothing but its last place is known."""
        dt = time_s - self.time_s
        if self.velocity_m_s is None or self.rate_rad_s is None or not 0 < dt <= longest_s:
            return self.left_from_ring
        rotation = self.left_from_ring.rotation * Rotation.from_rotvec(self.rate_rad_s * dt)
        return RigidTransform.from_components(self.left_from_ring.translation + self.velocity_m_s * dt, rotation)


def followed(before: Motion | None, left_from_ring: RigidTransform, time_s: float, longest_s: float) -> Motion:
    """The motion after another frame; without rates if the last one is longer ago than ``longest_s``."""
    if before is None or not 0 < time_s - before.time_s <= longest_s:
        return Motion(left_from_ring, time_s)
    dt = time_s - before.time_s
    velocity = (left_from_ring.translation - before.left_from_ring.translation) / dt
    rate = (before.left_from_ring.rotation.inv() * left_from_ring.rotation).as_rotvec() / dt
    return Motion(left_from_ring, time_s, velocity, rate)


def turned_to(left_from_ring: RigidTransform, circle: Circle) -> RigidTransform:
    """The frame moved to the circle's centre and turned the shortest way until Z is its normal."""
    z = left_from_ring.rotation.as_matrix()[:, 2]
    axis = np.cross(z, circle.normal)
    sine = float(np.linalg.norm(axis))
    angle = float(np.arctan2(sine, z @ circle.normal))
    turn = Rotation.from_rotvec(axis / sine * angle) if sine > 1e-12 else Rotation.identity()
    return RigidTransform.from_components(circle.centre_m, turn * left_from_ring.rotation)


def circle_at(left_from_ring: RigidTransform, radius_m: float) -> Circle:
    """The ring's circle in a frame."""
    return Circle(left_from_ring.translation, left_from_ring.rotation.as_matrix()[:, 2], radius_m)
