"""One frame's markers: all of them by a sweep over the grey levels, or the remembered ones where they should be."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from estimators.stereo_ring.circle_cone import Circle
from estimators.stereo_ring.conics import Ellipse
from estimators.stereo_ring.constellation import Landmark
from estimators.stereo_ring.marker_points import Sighting, is_about, is_sound, outline_near, outlines_of, sighting, sightings
from estimators.stereo_ring.marker_shapes import Shape, shapes_of
from estimators.stereo_ring.marker_sweep import swept
from estimators.stereo_ring.marker_view import MarkerView, marker_view
from estimators.stereo_ring.outlines import Outline
from estimators.stereo_ring.parameters import TrackedParameters
from estimators.stereo_ring.rig import Rig, epipolar_distance_px, homogeneous, triangulate
from scenes.arrays import Floats

Pictures = tuple[NDArray[np.uint8], NDArray[np.uint8]]


@dataclass(frozen=True, slots=True, eq=False)
class Match:
    """A sighting, and the index of the landmark that it is (None: of none)."""

    seen: Sighting
    landmark: int | None


@dataclass(frozen=True, slots=True, eq=False)
class MarkerWatch:
    """Both pictures (h, w) of eight bits, the parts of them about the ring, and the ring in them."""

    pictures: Pictures
    views: tuple[MarkerView, MarkerView]
    ellipses: tuple[Ellipse, Ellipse]
    ring: Circle
    rig: Rig
    parameters: TrackedParameters

    @classmethod
    def of(
        cls, pictures: Pictures, ellipses: tuple[Ellipse, Ellipse], ring: Circle, rig: Rig, parameters: TrackedParameters
    ) -> "MarkerWatch":
        """Cuts the parts out of the pictures."""
        p = parameters.markers
        left, right = (
            marker_view(picture, ellipse.centre_px, (p.reach + 0.1) * ellipse.a_px + 20, p)
            for picture, ellipse in zip(pictures, ellipses, strict=True)
        )
        return cls(pictures, (left, right), ellipses, ring, rig, parameters)

    def swept(self) -> list[Sighting]:
        """All markers about the ring."""
        p = self.parameters.markers
        outlines = [
            outlines_of(view, shapes_of(swept(picture, ellipse, p), self.ring, projection, p), p)
            for picture, view, ellipse, projection in zip(
                self.pictures, self.views, self.ellipses, self.rig.projections, strict=True
            )
        ]
        return sightings(outlines[0], outlines[1], self.rig, self.ring, p)

    def remembered(self, landmarks: list[Landmark], left_from_memory: RigidTransform) -> list[Match]:
        """The landmarks that are seen in both views about where this frame puts them."""
        followed = ((self._followed(landmark, left_from_memory), index) for index, landmark in enumerate(landmarks))
        return [Match(seen, index) for seen, index in followed if seen is not None]

    def _followed(self, landmark: Landmark, left_from_memory: RigidTransform) -> Sighting | None:
        p, rig = self.parameters.markers, self.rig
        border = left_from_memory.apply(landmark.border_ring)
        left, right = (
            self._outline_near(view, border, landmark.square, projection)
            for view, projection in zip(self.views, rig.projections, strict=True)
        )
        if left is None or right is None or not (is_sound(left, p) and is_sound(right, p)):
            return None
        if float(epipolar_distance_px(rig, left.centre_px, right.centre_px)) > p.epipolar_px:
            return None
        point = triangulate(rig, left.centre_px, right.centre_px)
        expected = left_from_memory.apply(landmark.point_ring)
        near = np.linalg.norm(point - expected) <= self.parameters.constellation.vote_share * self.ring.radius_m
        if not near or not is_about(point[None], self.ring, p)[0]:
            return None
        return sighting((left, right), point, rig, self.ring.normal)

    def _outline_near(self, view: MarkerView, border_left: Floats, square: bool, projection: Floats) -> Outline | None:
        """The outline in one view, near where the landmark's border (n, 3), left frame, is expected."""
        pixels = homogeneous(border_left) @ projection.T
        shape = Shape(pixels[:, :2] / np.maximum(pixels[:, 2:], 1e-6), square)
        return outline_near(view, shape, self.parameters.markers.track_windows_px, self.parameters.markers)
