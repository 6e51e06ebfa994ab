"""Which part of a surface a LIDAR can see: what it turns away, grazes or hides cannot have sent a return.

Without this the nearest point of a thin panel is as often on its far side, and a registration comes to lie too near.
"""

import numpy as np

from estimators.lidar_filter.clouds import Indices, Surface
from estimators.lidar_filter.parameters import VisibilityParameters
from scenes.arrays import Bools, Floats


def seen(surface_lidar: Surface, parameters: VisibilityParameters) -> Bools:
    """Which points (n,) of a surface in LIDAR axes can be seen from the LIDAR.

    A point is seen if its normal is near enough to the line back to the LIDAR, and if no such point of the same narrow cone is
    nearer. The cones are as wide as ``parameters.cell_m`` at the surface's mean distance.
    """
    towards = facing(surface_lidar, np.deg2rad(parameters.most_incidence_deg))
    if not towards.any():
        return towards
    points = surface_lidar.points
    depth_m = points[:, 2]
    cell, count = cones(points, parameters.cell_m)
    nearest_m = np.full(count, np.inf)
    np.minimum.at(nearest_m, cell[towards], depth_m[towards])
    return np.asarray(towards & (depth_m < nearest_m[cell] + parameters.behind_m))


def facing(surface_lidar: Surface, most_incidence_rad: float) -> Bools:
    """Which points (n,) are turned to the LIDAR, by at most the angle of incidence given."""
    range_m = np.linalg.norm(surface_lidar.points, axis=1)
    cosine = -np.sum(surface_lidar.points * surface_lidar.normals, axis=1)
    return np.asarray(cosine > np.cos(most_incidence_rad) * range_m)


def cones(points_lidar: Floats, cell_m: float) -> tuple[Indices, int]:
    """The number (n,) of the cone that each point lies in, and how many there are, empty ones included.

    Cones are squares of the two slopes against the line to the middle of the points, ``cell_m`` wide at its distance.
    """
    middle = points_lidar.mean(axis=0)
    distance = float(np.linalg.norm(middle))
    if distance == 0:
        return np.zeros(len(points_lidar), dtype=np.intp), 1
    x, y = across(middle / distance)
    along = np.maximum(points_lidar @ middle / distance, 1e-6)
    slopes = np.stack([points_lidar @ x / along, points_lidar @ y / along], axis=1)
    cells = np.floor(slopes * (distance / cell_m)).astype(np.int64)
    cells -= cells.min(axis=0)
    width = int(cells[:, 1].max()) + 1
    return cells[:, 0] * width + cells[:, 1], (int(cells[:, 0].max()) + 1) * width


def across(direction: Floats) -> tuple[Floats, Floats]:
    """Two unit vectors that make a right-handed frame with the unit vector ``direction`` (3,); (x, y) for z."""
    y = np.array([0.0, 1.0, 0.0]) if abs(direction[1]) < 0.9 else np.array([1.0, 0.0, 0.0])
    x = np.cross(y, direction)
    x /= np.linalg.norm(x)
    return x, np.cross(direction, x)
