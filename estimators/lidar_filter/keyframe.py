"""One keyframe of a map: what was seen from about one direction, averaged over all scans from there.

A beam errs along itself far more than to its sides. So returns are collected in the columns of a grid that lies across the line of
sight, and the mean of a column has the error of one beam over the root of their number, while edges stay where they are.
"""

import numpy as np
from scipy.spatial.transform import RigidTransform

from estimators.lidar_filter.clouds import Surface, filled, planes_through
from estimators.lidar_filter.edges import with_edges
from scenes.arrays import Floats


class Keyframe:
    """Key axes: LIDAR axes of its first scan, the origin at that scan's centroid. Columns lie along z."""

    def __init__(self, points_lidar: Floats, own_from_lidar: RigidTransform, cell_m: float, neighbours: int) -> None:
        """From its first scan (n, 3). ``cell_m``: width of the columns; ``neighbours``: of a point, that make its plane."""
        self.lidar_from_key = RigidTransform.from_translation(points_lidar.mean(axis=0))
        self.own_from_key = own_from_lidar * self.lidar_from_key
        self._cell_m, self._neighbours = cell_m, neighbours
        self.points_key = np.zeros((0, 3))
        self._held = np.zeros(0)
        self._surface_key: Surface | None = None
        self.scans = 0
        self.is_linked = False
        self.add(points_lidar, own_from_lidar)

    @property
    def sight_own(self) -> Floats:
        """The direction of view (3,), away from the LIDAR, own axes."""
        return np.asarray(self.own_from_key.rotation.as_matrix()[:, 2])

    @property
    def returns_a_point(self) -> float:
        """How many returns a point is the mean of, in the mean."""
        return float(self._held.mean())

    def add(self, points_lidar: Floats, own_from_lidar: RigidTransform) -> None:
        """Takes in another scan (n, 3)."""
        new_key = (self.own_from_key.inv() * own_from_lidar).apply(points_lidar)
        points = np.concatenate([self.points_key, new_key])
        weights = np.concatenate([self._held, np.ones(len(new_key))])
        cells = np.floor(points[:, :2] / self._cell_m).astype(np.int64)
        cells -= cells.min(axis=0)
        _, number = np.unique(cells[:, 0] * (cells[:, 1].max() + 1) + cells[:, 1], return_inverse=True)
        self._held = np.bincount(number, weights=weights).astype(np.float64)
        self.points_key = np.stack([np.bincount(number, weights=weights * axis) for axis in points.T], axis=1) / self._held[:, None]
        self._surface_key = None
        self.scans += 1

    @property
    def surface_key(self) -> Surface:
        """The mean points, smoothed, with normals towards the LIDAR and points between, and which of them are edges."""
        if self._surface_key is None:
            eye = self.lidar_from_key.inv().translation
            whole = filled(planes_through(self.points_key, eye, self._neighbours))
            self._surface_key = with_edges(whole, self.lidar_from_key)
        return self._surface_key
