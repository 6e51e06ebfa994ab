"""Where a LIDAR is at each beam's own instant."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.arrays import Floats, frozen

INTERVALS = 32  # between knots; within one the target turns at a constant rate and its origin moves on a straight line


@dataclass(frozen=True, slots=True, eq=False)
class BeamTimes:
    """When each of n beams is fired, (n,): in which interval between knots, and which fraction of it has passed.

    ``knots_s`` (k,): instants of the knots, from the middle of the scan. One knot, and no interval, where all are fired at once.
    """

    knots_s: Floats
    interval: NDArray[np.int64]
    fraction: Floats

    @classmethod
    def of(cls, time_s: Floats) -> "BeamTimes":
        """From instants (n,) about the middle of a scan."""
        span_s = float(np.ptp(time_s))
        if span_s == 0:
            return cls(frozen([0.0]), np.zeros(time_s.shape, np.int64), np.zeros(time_s.shape))
        place = (time_s - time_s.min()) / span_s * INTERVALS
        interval = np.minimum(place.astype(np.int64), INTERVALS - 1)
        return cls(frozen(np.linspace(time_s.min(), time_s.max(), INTERVALS + 1)), interval, place - interval)

    @property
    def moving(self) -> bool:
        """Whether beams are fired at different instants."""
        return len(self.knots_s) > 1


@dataclass(frozen=True, slots=True, eq=False)
class ScanPoses:
    """The LIDAR before the target during a scan: the poses at the knots.

    ``turns`` (k, 3, 3): target axes from LIDAR axes. ``turn_rad`` (k − 1, 3): the rotation vector to the next knot, LIDAR axes.
    ``position_m`` (k, 3): the target's origin in LIDAR axes. ``reference``: ``lidar_from_target`` at the middle of the scan.
    """

    times: BeamTimes
    turns: Floats
    turn_rad: Floats
    position_m: Floats
    reference: RigidTransform

    @classmethod
    def at(cls, times: BeamTimes, lidar_from_target: Callable[[float], RigidTransform]) -> "ScanPoses":
        """``lidar_from_target`` gives the pose at an instant counted from the middle of the scan."""
        knots = [lidar_from_target(float(instant_s)) for instant_s in times.knots_s]
        reference = lidar_from_target(0.0) if times.moving else knots[0]
        position_m = np.array([knot.translation for knot in knots])
        turns = Rotation.concatenate([knot.rotation.inv() for knot in knots])
        turn_rad = (turns[:-1].inv() * turns[1:]).as_rotvec() if times.moving else np.zeros((0, 3))
        return cls(times, turns.as_matrix(), turn_rad, position_m, reference)

    def target_points(self, beams: NDArray[np.int64], points_lidar: Floats) -> Floats:
        """Points (m, 3) in LIDAR axes at the instants of their ``beams`` (m,) → target frame."""
        if not self.times.moving:
            return np.asarray((points_lidar - self.position_m[0]) @ self.turns[0].T)
        interval, fraction = self.times.interval[beams], self.times.fraction[beams][:, None]
        start, end = self.position_m[interval], self.position_m[interval + 1]
        relative = points_lidar - start - fraction * (end - start)
        turned = Rotation.from_rotvec(fraction * self.turn_rad[interval]).apply(relative)
        return np.asarray(np.einsum("nij,nj->ni", self.turns[interval], turned))

    def at_reference(self, beams: NDArray[np.int64], points_lidar: Floats) -> Floats:
        """Points (m, 3) in LIDAR axes at their beams' instants → LIDAR axes at the middle of the scan, fixed to the target."""
        if not self.times.moving:
            return points_lidar
        return np.asarray(self.reference.apply(self.target_points(beams, points_lidar)))
