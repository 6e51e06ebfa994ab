"""A map of what the target has shown so far: keyframes from directions some degrees apart, each the mean of many scans.

A scan is registered to the keyframes that are known to lie beside the present one. When the view moves on, the keyframe that it
leaves is registered to every other that was seen from near its direction, also to those from long ago; then all poses are settled
together. So an error that grew on the way round goes when the way closes.
"""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import RigidTransform

from estimators.lidar_filter.clouds import Surface, thinned
from estimators.lidar_filter.edges import lopsided, with_edges
from estimators.lidar_filter.keyframe import Keyframe
from estimators.lidar_filter.keyframe_links import linked
from estimators.lidar_filter.parameters import MapParameters, RegistrationParameters
from estimators.lidar_filter.pose_graph import Link, settled
from estimators.lidar_filter.registration_noise import Noise
from scenes.arrays import Bools, Floats

Anchored = tuple[int, RigidTransform]


class KeyframeMap:
    """``Reference`` that is made of scans. Its own frame: LIDAR axes at the first scan, origin at that scan's centroid."""

    def __init__(self, noise: Noise, parameters: MapParameters, registration: RegistrationParameters) -> None:
        """An empty map."""
        self._noise, self._parameters, self._registration = noise, parameters, registration
        self.keyframes: list[Keyframe] = []
        self.links: list[Link] = []
        self._beside: list[set[int]] = []  # of each keyframe, those whose pose against it is known
        self._current = 0
        self._points = 0
        self._parts: Sequence[object] = ()  # what ``_kept`` was made of
        self._kept = Surface(np.zeros((0, 3)), np.zeros((0, 3))), np.zeros(0, dtype=np.bool_)

    @property
    def target_from_own(self) -> RigidTransform:
        """The own frame is the one that is answered for."""
        return RigidTransform.identity()

    @property
    def holds_what_is_seen(self) -> bool:
        """It grows with the view as long as scans are used."""
        return True

    def begin(self, points_lidar: Floats) -> RigidTransform | str:
        """The first scan lies where it lies."""
        lidar_from_own = RigidTransform.from_translation(points_lidar.mean(axis=0))
        self.keyframes, self.links, self._beside, self._current = [], [], [], 0
        self._open(points_lidar, lidar_from_own.inv())
        return lidar_from_own

    def visible(self, lidar_from_own: RigidTransform) -> Surface:
        """The keyframes beside the present one that are seen from about the same direction, one point a voxel, own frame."""
        p = self._parameters
        near = [number for number, angle in self._by_angle(lidar_from_own)[: p.used] if angle <= np.deg2rad(p.used_deg)]
        surface, ends = self._together([self.keyframes[number] for number in near or [self._current]])
        self._points = len(surface)
        return with_edges(surface, lidar_from_own, ends)

    def _together(self, chosen: list[Keyframe]) -> tuple[Surface, Bools]:
        """Keyframes as one surface with its ends, own frame. It is kept, as it stays the same in most scans."""
        parts = [part for one in chosen for part in (one.surface_key, one.own_from_key)]
        if len(parts) != len(self._parts) or any(one is not other for one, other in zip(parts, self._parts)):
            surfaces = [one.surface_key.moved(one.own_from_key) for one in chosen]
            whole = Surface(np.concatenate([one.points for one in surfaces]), np.concatenate([one.normals for one in surfaces]))
            surface = thinned(whole, self._parameters.voxel_m)
            self._parts, self._kept = parts, (surface, lopsided(surface))
        return self._kept

    def learn(self, points_lidar: Floats, lidar_from_own: RigidTransform) -> bool:
        """Adds the scan to the keyframe seen from nearest by, or makes a new one; says whether poses were settled anew."""
        p = self._parameters
        nearest, angle = self._by_angle(lidar_from_own)[0]
        left = self._current
        own_from_lidar = lidar_from_own.inv()
        if angle < np.deg2rad(p.apart_deg):
            self._current = nearest
            if self.keyframes[nearest].scans < p.most_scans:
                self.keyframes[nearest].add(points_lidar, own_from_lidar)
        else:
            self._open(points_lidar, own_from_lidar)
        if self._current == left or self.keyframes[left].is_linked:
            return False
        return self._link(left)

    def anchored(self, lidar_from_own: RigidTransform) -> Anchored:
        """A pose that moves with the map: the present keyframe, and lidar_from_key."""
        return self._current, lidar_from_own * self.keyframes[self._current].own_from_key

    def released(self, anchored: Anchored) -> RigidTransform:
        """lidar_from_own of an anchored pose as the map now is."""
        number, lidar_from_key = anchored
        return lidar_from_key * self.keyframes[number].own_from_key.inv()

    def extras(self) -> dict[str, float]:
        """How many keyframes and links, and how many points were used last."""
        loops = sum(link.is_loop for link in self.links)
        return {"keyframes": float(len(self.keyframes)), "map_points": float(self._points), "map_loops": float(loops)}

    def _by_angle(self, lidar_from_own: RigidTransform, everywhere: bool = False) -> list[tuple[int, float]]:
        """Keyframes beside the present one, or all, with the angle between directions of view, the nearest first."""
        sight = lidar_from_own.rotation.as_matrix()[2]
        numbers = range(len(self.keyframes)) if everywhere else sorted(self._beside[self._current] | {self._current})
        angles = [(number, float(np.arccos(np.clip(self.keyframes[number].sight_own @ sight, -1, 1)))) for number in numbers]
        return sorted(angles, key=lambda one: one[1])

    def _open(self, points_lidar: Floats, own_from_lidar: RigidTransform) -> None:
        """A new keyframe, for now beside all that the scan was registered to."""
        beside = self._beside[self._current] | {self._current} if self.keyframes else set()
        self.keyframes.append(Keyframe(points_lidar, own_from_lidar, self._parameters.cell_m, self._parameters.neighbours))
        self._current = len(self.keyframes) - 1
        self._beside.append(set())
        self._join(self._current, beside)

    def _join(self, number: int, others: set[int]) -> None:
        self._beside[number] |= others
        for other in others:
            self._beside[other].add(number)

    def _link(self, number: int) -> bool:
        """Registers a keyframe to all seen from near its direction, and settles all poses."""
        p, one = self._parameters, self.keyframes[number]
        one.is_linked = True
        key_from_own = one.own_from_key.inv()
        by_angle = self._by_angle(key_from_own, everywhere=True)
        near = [other for other, angle in by_angle if angle < np.deg2rad(p.linked_deg) and self.keyframes[other].is_linked]
        near = [other for other in near if other != number]
        known = [other for other in near if other in self._beside[number]][: p.linked]
        new = [other for other in near if other not in self._beside[number]][: p.looped]
        found = linked(self.keyframes, number, known, new, self._noise, p, self._registration)
        self.links += found
        self._join(number, {link.of for link in found})
        if not found:
            return False
        poses = settled([one.own_from_key for one in self.keyframes], self.links, p.believed_m)
        for keyframe, pose in zip(self.keyframes, poses, strict=True):
            keyframe.own_from_key = pose
        return True
