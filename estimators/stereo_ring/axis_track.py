"""The turn about the ring's normal, frame after frame: remembered markers on their own edges; a sweep where those are too few."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from estimators.stereo_ring.circle_cone import Circle
from estimators.stereo_ring.conics import Ellipse
from estimators.stereo_ring.constellation import Constellation
from estimators.stereo_ring.frame_axes import ring_frame
from estimators.stereo_ring.marker_points import Sighting
from estimators.stereo_ring.marker_watch import MarkerWatch, Match
from estimators.stereo_ring.parameters import TrackedParameters
from estimators.stereo_ring.rig import Rig
from estimators.stereo_ring.turn import Turn, solved_turn, voted_pairs
from scenes.arrays import Floats

Pictures = tuple[NDArray[np.uint8], NDArray[np.uint8]]


@dataclass(frozen=True, slots=True, eq=False)
class AxisFix:
    """``left_from_ring`` with X towards the main marker, ``sigma_rad`` of the turn, and how many ``markers`` say so."""

    left_from_ring: RigidTransform
    sigma_rad: float
    markers: int


class AxisTrack:
    """Memory of one target's markers, and what is made of them in each frame."""

    def __init__(self, rig: Rig, parameters: TrackedParameters) -> None:
        """Nothing remembered."""
        self._rig, self._parameters = rig, parameters
        self.constellation = Constellation(parameters.constellation)
        self._since_sweep = 0

    def step(
        self,
        pictures: Pictures,
        ellipses: tuple[Ellipse, Ellipse],
        ring: Circle,
        expected: RigidTransform | None,
        ring_sigma_m: float,
    ) -> AxisFix | None:
        """One frame with a measured ``ring``; ``expected``: left_from_ring with that ring's normal, the turn predicted.
        None if no marker tells the turn."""
        watch = MarkerWatch.of(pictures, ellipses, ring, self._rig, self._parameters)
        if expected is None or self.constellation.main is None:
            return self._begun(watch.swept(), ring)
        base = expected * self._about_z(-self.constellation.main_azimuth_rad)
        tried = watch.remembered(self.constellation.landmarks, base)
        self._since_sweep += 1
        p = self._parameters.constellation
        if len(tried) >= (p.least_for_track if self._since_sweep < p.sweep_every else p.enough):
            return self._fixed(tried, base, ring_sigma_m)
        self._since_sweep = 0
        matches = self._matched(watch.swept(), base, ring)
        by_sweep = {one.landmark for one in matches}
        return self._fixed([*matches, *(one for one in tried if one.landmark not in by_sweep)], base, ring_sigma_m)

    def remembered_in_ring(
        self, pictures: Pictures, ellipses: tuple[Ellipse, Ellipse], left_from_ring: RigidTransform, ring: Circle
    ) -> list[tuple[Floats, Floats]]:
        """Pairs (place in the ring's frame (3,), point in the left frame (3,)) of remembered markers, if the ring were there."""
        if self.constellation.main is None:
            return []
        turn = self._about_z(-self.constellation.main_azimuth_rad)
        places = self._about_z(-self.constellation.main_azimuth_rad).apply(self.constellation.points_ring)
        watch = MarkerWatch.of(pictures, ellipses, ring, self._rig, self._parameters)
        matches = watch.remembered(self.constellation.landmarks, left_from_ring * turn)
        return [(places[one.landmark], one.seen.point_left) for one in matches if one.landmark is not None]

    def _begun(self, seen: list[Sighting], ring: Circle) -> AxisFix | None:
        """The first frame with markers: X towards the one nearest to the axis."""
        if not seen:
            return None
        across = [one.point_left - ring.centre_m for one in seen]
        out = [float(np.linalg.norm(np.cross(ring.normal, one))) for one in across]
        frame = ring_frame(ring.centre_m, ring.normal, seen[int(np.argmin(out))].point_left)
        if frame is None:
            return None
        self._learn([Match(one, None) for one in seen], frame)
        sigma = seen[int(np.argmin(out))].sigma_m / max(min(out), 1e-6)
        return AxisFix(frame, sigma, len(seen))

    def _matched(self, seen: list[Sighting], base: RigidTransform, ring: Circle) -> list[Match]:
        landmarks = self.constellation.landmarks
        if not seen or not landmarks:
            return [Match(one, None) for one in seen]
        observed = base.inv().apply(np.array([one.point_left for one in seen]))
        alike = np.array([[one.square == two.square and one.bright == two.bright for two in landmarks] for one in seen])
        p = self._parameters.constellation
        pairs = dict(voted_pairs(observed, self.constellation.points_ring, alike, ring.radius_m, p))
        return [Match(one, pairs.get(number)) for number, one in enumerate(seen)]

    def _fixed(self, matches: list[Match], base: RigidTransform, ring_sigma_m: float) -> AxisFix | None:
        known = [(one.seen, one.landmark) for one in matches if one.landmark is not None]
        turn = self._turn(known, base, ring_sigma_m)
        if turn is None:
            self._learn([], base)
            return None
        frame = base * self._about_z(turn.angle_rad)
        agreed = [pair for pair, used in zip(known, turn.used, strict=True) if used]
        self._learn([Match(seen, index) for seen, index in agreed] + [one for one in matches if one.landmark is None], frame)
        return AxisFix(frame * self._about_z(self.constellation.main_azimuth_rad), turn.sigma_rad, len(agreed))

    def _turn(self, known: list[tuple[Sighting, int]], base: RigidTransform, ring_sigma_m: float) -> Turn | None:
        if not known:
            return None
        p = self._parameters.constellation
        observed = base.inv().apply(np.array([seen.point_left for seen, _ in known]))[:, :2]
        remembered = self.constellation.points_ring[[index for _, index in known]][:, :2]
        sigma = self.constellation.sigmas_m([index for _, index in known])
        return solved_turn(observed, remembered, sigma, ring_sigma_m, p)

    def _learn(self, matches: list[Match], frame: RigidTransform) -> None:
        """Everything that was seen, in the memory's frame; a new marker only where none is remembered."""
        into = frame.inv()
        seen, new = [], []
        for one in matches:
            point, border = into.apply(one.seen.point_left), into.apply(one.seen.border_left)
            if one.landmark is not None:
                seen.append((one.landmark, point, border))
            elif not self._is_known(point):
                new.append((one.seen, point, border))
        self.constellation.learn(seen, new)

    def _is_known(self, point_ring: Floats) -> bool:
        points = self.constellation.points_ring
        apart = self._parameters.constellation.apart_m
        return bool(len(points)) and bool(np.hypot(*(points - point_ring)[:, :2].T).min() < apart)

    @staticmethod
    def _about_z(angle_rad: float) -> RigidTransform:
        return RigidTransform.from_rotation(Rotation.from_rotvec([0, 0, angle_rad]))
