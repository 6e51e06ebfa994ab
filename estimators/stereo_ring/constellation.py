"""The markers in ring coordinates: remembered as a running mean, so that the X axis keeps its marker whatever is hidden."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from estimators.stereo_ring.marker_parameters import ConstellationParameters
from estimators.stereo_ring.marker_points import Sighting
from scenes.arrays import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Landmark:
    """A marker: ``point_ring`` (3,) and ``border_ring`` (n, 3), metres, ring frame; how often it was seen and missed.

    ``scatter_m``: how far it was seen from where it is remembered, rms in the ring's plane; it begins with what its edge says.
    """

    point_ring: Floats
    border_ring: Floats
    square: bool
    bright: bool
    scatter_m: float
    count: int = 1
    missed: int = 0


class Constellation:
    """Memory of one target's markers; ``main`` is the index of the one that X points to, None before there is any."""

    def __init__(self, parameters: ConstellationParameters) -> None:
        """Empty."""
        self._parameters = parameters
        self.landmarks: list[Landmark] = []
        self.main: int | None = None
        self.frames = 0

    @property
    def points_ring(self) -> Floats:
        """(n, 3) of all landmarks."""
        return np.array([one.point_ring for one in self.landmarks]).reshape(-1, 3)

    @property
    def main_azimuth_rad(self) -> float:
        """Where the main marker is remembered, from the memory's own X axis: what the answer's X axis is turned by."""
        if self.main is None:
            return 0.0
        x, y, _ = self.landmarks[self.main].point_ring
        return float(np.arctan2(y, x))

    def sigmas_m(self, indices: list[int]) -> Floats:
        """How well (n,) landmarks tell the turn: their own scatter, and as part of it how well their places are remembered."""
        scatter = np.array([self.landmarks[index].scatter_m for index in indices])
        count = np.array([self.landmarks[index].count for index in indices])
        return np.asarray(scatter * np.sqrt(1 + 1 / count))

    def learn(self, seen: list[tuple[int, Floats, Floats]], new: list[tuple[Sighting, Floats, Floats]]) -> None:
        """Takes a frame, in ring coordinates: ``seen`` (landmark, point (3,), border (n, 3)), ``new`` (sighting, point, border)."""
        self.frames += 1
        for index, point, border in seen:
            self.landmarks[index] = self._averaged(self.landmarks[index], point, border)
        for index in set(range(len(self.landmarks))) - {index for index, _, _ in seen}:
            self.landmarks[index] = replace(self.landmarks[index], missed=self.landmarks[index].missed + 1)
        self.landmarks += [Landmark(point, border, one.square, one.bright, one.sigma_m) for one, point, border in new]
        self._drop()
        self._choose_main()

    def _averaged(self, old: Landmark, point: Floats, border: Floats) -> Landmark:
        count = min(old.count + 1, self._parameters.most_count)
        gain = 1 / count
        edge = old.border_ring + gain * (_reordered(border, old.border_ring) - old.border_ring)
        moved = point - old.point_ring
        fresh = 1 / min(count, self._parameters.scatter_count)
        square = (1 - fresh) * old.scatter_m**2 + fresh * float(moved[:2] @ moved[:2]) / 2
        scatter = max(float(np.sqrt(square)), self._parameters.least_scatter_m)
        return replace(old, point_ring=old.point_ring + gain * moved, border_ring=edge, count=count, scatter_m=scatter)

    def _drop(self) -> None:
        kept = [
            index
            for index, one in enumerate(self.landmarks)
            if index == self.main or one.missed - one.count < self._parameters.drop_after
        ]
        if self.main is not None:
            self.main = kept.index(self.main)
        self.landmarks = [self.landmarks[index] for index in kept]

    def _choose_main(self) -> None:
        """At first the marker nearest to the axis; soon after, one nearer still that was only missed at first."""
        p = self._parameters
        if not self.landmarks or (self.main is not None and self.frames > p.settle_frames):
            return
        out = np.hypot(*self.points_ring[:, :2].T)
        sure = np.array([one.count >= p.settle_count and one.count > one.missed for one in self.landmarks])
        if self.main is None:
            self.main = int(np.argmin(out))
        elif sure.any():
            nearest = int(np.argmin(np.where(sure, out, np.inf)))
            unsure = self.landmarks[self.main].missed > p.doubtful * self.landmarks[self.main].count
            if out[nearest] < out[self.main] or unsure:
                self.main = nearest


def turned_about_z(points: Floats, angle_rad: float) -> Floats:
    """Points (..., 3) turned about Z."""
    return np.asarray(Rotation.from_rotvec([0, 0, angle_rad]).apply(points))


def _reordered(border: Floats, like: Floats) -> Floats:
    """The border (n, 3) begun at the point and run in the direction that lies nearest to ``like`` (n, 3)."""
    if border.shape != like.shape:
        return like
    rolls = np.stack([np.roll(way, shift, axis=0) for way in (border, border[::-1]) for shift in range(len(border))])
    best = int(np.argmin(np.sum((rolls - like) ** 2, axis=(1, 2))))
    return np.asarray(rolls[best])
