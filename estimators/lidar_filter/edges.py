"""Where a surface ends: there, and only there, nearest points say how a scan lies within the surface."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from estimators.lidar_filter.clouds import Surface, neighbours_of
from scenes.arrays import Bools, Floats

_NEIGHBOURS = 16
_LOPSIDED = 0.45  # distance from a point to the middle of its neighbours, in mean distances, beyond which it is an edge
_IN_FRONT_M = 0.25  # an edge is not one if what ends there goes on behind something nearer than this


def with_edges(surface: Surface, lidar_from_frame: RigidTransform, ends: Bools | None = None) -> Surface:
    """The surface with its edges marked, as seen from a LIDAR; ``ends``: ``lopsided`` of it, where that is known.

    A point is an edge if its neighbours lie to one side of it, unless two of the beams next to it end nearer to the LIDAR: what is
    half hidden does not end there, and the border moves with the view (Turk & Levoy 1994 leave borders out for this).
    """
    is_edge = lopsided(surface) if ends is None else ends.copy()
    if is_edge.any():
        is_edge[is_edge] = ~_half_hidden(lidar_from_frame.apply(surface.points), is_edge)
    return Surface(surface.points, surface.normals, is_edge)


def lopsided(surface: Surface) -> Bools:
    """Which points have their neighbours to one side, whoever looks."""
    if len(surface) <= _NEIGHBOURS:
        return np.zeros(len(surface), dtype=bool)
    distance, near = neighbours_of(surface.points, _NEIGHBOURS)
    offset = surface.points[near].mean(axis=1) - surface.points
    offset -= np.sum(offset * surface.normals, axis=1, keepdims=True) * surface.normals
    return np.asarray(np.linalg.norm(offset, axis=1) > _LOPSIDED * distance[:, 1:].mean(axis=1))


def _half_hidden(points_lidar: Floats, which: Bools) -> Bools:
    slopes = points_lidar[:, :2] / points_lidar[:, 2:]
    _, near = neighbours_of(slopes, _NEIGHBOURS, which)
    nearer_m = points_lidar[which, 2, None] - points_lidar[near, 2]
    return np.asarray(np.sum(nearer_m > _IN_FRONT_M, axis=1) >= 2)
