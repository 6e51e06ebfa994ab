"""The turn about the ring's normal, frame after frame: remembered markers on their own edges; a sweep where those are too few."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from estimators.stereo_ring.circle_cone import Circle
from estimators.stereo_ring.conics import Ellipse
from estimators.stereo_ring.constellation import Constellation, Landmark
from estimators.stereo_ring.frame_axes import ring_frame
from estimators.stereo_ring.marker_points import Sighting, is_about, is_sound, outline_near, outlines_of, sighting, sightings
from estimators.stereo_ring.marker_shapes import Shape, shapes_of
from estimators.stereo_ring.marker_sweep import swept
from estimators.stereo_ring.outlines import MarkerView, Outline, marker_view
from estimators.stereo_ring.parameters import MarkerParameters, TrackedParameters
from estimators.stereo_ring.rig import Rig, epipolar_distance_px, homogeneous, triangulate
from estimators.stereo_ring.turn import Turn, solved_turn, voted_pairs
from scenes.arrays import Floats

Pictures = tuple[NDArray[np.uint8], NDArray[np.uint8]]
MarkerViews = tuple[MarkerView, MarkerView]


@dataclass(frozen=True, slots=True, eq=False)
class AxisFix:
    """``left_from_ring`` with X towards the main marker, ``sigma_rad`` of the turn, and how many ``markers`` say so."""

    left_from_ring: RigidTransform
    sigma_rad: float
    markers: int


@dataclass(frozen=True, slots=True, eq=False)
class Match:
    """A sighting, and the index of the landmark that it is (None: of none)."""

    seen: Sighting
    landmark: int | None


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
        views = self.views_about(pictures, ellipses)
        if expected is None or self.constellation.main is None:
            return self._begun(self._swept(pictures, views, ellipses, ring), ring)
        base = expected * self._about_z(-self.constellation.main_azimuth_rad)
        tried = self.remembered(views, base, ring)
        self._since_sweep += 1
        p = self._parameters.constellation
        if len(tried) >= p.least_for_track and self._since_sweep < p.sweep_every:
            return self._fixed(tried, base, ring_sigma_m)
        matches = self._matched(self._swept(pictures, views, ellipses, ring), base, ring)
        by_sweep = {one.landmark for one in matches}
        return self._fixed([*matches, *(one for one in tried if one.landmark not in by_sweep)], base, ring_sigma_m)

    def views_about(self, pictures: Pictures, ellipses: tuple[Ellipse, Ellipse]) -> MarkerViews:
        """The parts of both pictures in which there are markers."""
        p = self._parameters.markers
        left, right = (
            marker_view(picture, ellipse.centre_px, (p.reach + 0.1) * ellipse.a_px + 20, p)
            for picture, ellipse in zip(pictures, ellipses, strict=True)
        )
        return left, right

    def remembered(self, views: MarkerViews, left_from_memory: RigidTransform, ring: Circle) -> list[Match]:
        """The landmarks that are seen in both views about where this frame puts them."""
        found = []
        for index, landmark in enumerate(self.constellation.landmarks):
            seen = self._followed(views, landmark, left_from_memory, ring)
            if seen is not None:
                found.append(Match(seen, index))
        return found

    def remembered_in_ring(self, views: MarkerViews, left_from_ring: RigidTransform, ring: Circle) -> list[tuple[Floats, Floats]]:
        """Pairs (place in the ring's frame (3,), point in the left frame (3,)) of remembered markers that are seen."""
        if self.constellation.main is None:
            return []
        turn = self._about_z(-self.constellation.main_azimuth_rad)
        places = turn.apply(self.constellation.points_ring)
        matches = self.remembered(views, left_from_ring * turn, ring)
        return [(places[one.landmark], one.seen.point_left) for one in matches if one.landmark is not None]

    def _followed(self, views: MarkerViews, landmark: Landmark, left_from_memory: RigidTransform, ring: Circle) -> Sighting | None:
        p = self._parameters.markers
        border = left_from_memory.apply(landmark.border_ring)
        outlines = [
            _outline_near(view, border, landmark.square, projection, p)
            for view, projection in zip(views, self._rig.projections, strict=True)
        ]
        left, right = outlines
        if left is None or right is None or not (is_sound(left, p) and is_sound(right, p)):
            return None
        if float(epipolar_distance_px(self._rig, left.centre_px, right.centre_px)) > p.epipolar_px:
            return None
        point = triangulate(self._rig, left.centre_px, right.centre_px)
        expected = left_from_memory.apply(landmark.point_ring)
        near = np.linalg.norm(point - expected) <= self._parameters.constellation.vote_share * ring.radius_m
        if not near or not is_about(point[None], ring, p)[0]:
            return None
        return sighting(left, point, self._rig, ring.normal)

    def _swept(self, pictures: Pictures, views: MarkerViews, ellipses: tuple[Ellipse, Ellipse], ring: Circle) -> list[Sighting]:
        p = self._parameters.markers
        self._since_sweep = 0
        outlines = [
            outlines_of(view, shapes_of(swept(picture, ellipse, p), ring, projection, p), p)
            for picture, view, ellipse, projection in zip(pictures, views, ellipses, self._rig.projections, strict=True)
        ]
        return sightings(outlines[0], outlines[1], self._rig, ring, p)

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
        sigma = self._parameters.constellation.first_scatter_m / max(min(out), 1e-6)
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
        self.constellation.learn(seen, new, set(range(len(self.constellation.landmarks))))

    def _is_known(self, point_ring: Floats) -> bool:
        points = self.constellation.points_ring
        apart = self._parameters.constellation.apart_m
        return bool(len(points)) and bool(np.linalg.norm(points - point_ring, axis=1).min() < apart)

    @staticmethod
    def _about_z(angle_rad: float) -> RigidTransform:
        return RigidTransform.from_rotation(Rotation.from_rotvec([0, 0, angle_rad]))


def _outline_near(view: MarkerView, border_left: Floats, square: bool, projection: Floats, p: MarkerParameters) -> Outline | None:
    """The outline in one view, near where the landmark's border (n, 3), left frame, is expected."""
    pixels = homogeneous(border_left) @ projection.T
    shape = Shape(pixels[:, :2] / np.maximum(pixels[:, 2:], 1e-6), square)
    return outline_near(view, shape, p.track_windows_px, p)
