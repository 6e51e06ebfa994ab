"""Whether a place lies inside of a solid."""

import numpy as np

from scenes.arrays import Floats
from scenes.solids import Solid


def is_inside(solid: Solid, point_target: Floats) -> bool:
    """Whether a point (3,) lies inside of a closed body: the solid angle that its triangles fill about it is 4π, else 0.

    Each triangle's by van Oosterom & Strackee 1983, eq. (8).
    """
    low, high = solid.vertices_target.min(axis=0), solid.vertices_target.max(axis=0)
    if np.any(point_target < low) or np.any(point_target > high):
        return False
    a, b, c = (solid.vertices_target[solid.faces[:, corner]] - point_target for corner in range(3))
    la, lb, lc = (np.linalg.norm(one, axis=1) for one in (a, b, c))
    triple = np.sum(a * np.cross(b, c), axis=1)
    below = la * lb * lc + np.sum(a * b, axis=1) * lc + np.sum(b * c, axis=1) * la + np.sum(c * a, axis=1) * lb
    return bool(abs(2 * np.arctan2(triple, below).sum()) > 2 * np.pi)
