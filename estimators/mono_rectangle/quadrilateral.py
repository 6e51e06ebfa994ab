"""Four vertices P1..P4 and the four lines between them, in ideal (undistorted) pixels."""

import numpy as np
from numpy.typing import ArrayLike

from estimators.mono_rectangle.closed_form import homogeneous
from scenes.arrays import Floats
from scenes.intrinsics import Intrinsics

EDGES = ((0, 1), (2, 3), (0, 2), (1, 3))
"""Vertex indices of the edges P1P2, P3P4 (along the length) and P1P3, P2P4 (along the width)."""
EDGE_NAMES = ("p1p2", "p3p4", "p1p3", "p2p4")
LONG_EDGES = (0, 1)
EDGES_AT_VERTEX = ((0, 2), (0, 3), (1, 2), (1, 3))
"""The two edges that meet at each vertex."""


def ideal_from_normalised(points: ArrayLike, intrinsics: Intrinsics) -> Floats:
    """Pixels (..., 2) that a camera without distortion would show for normalised points (..., 2)."""
    scale, centre = _pinhole(intrinsics)
    return np.asarray(np.asarray(points) * scale + centre)


def normalised_from_ideal(pixels: ArrayLike, intrinsics: Intrinsics) -> Floats:
    """Normalised points (..., 2) of ideal pixels (..., 2)."""
    scale, centre = _pinhole(intrinsics)
    return np.asarray((np.asarray(pixels) - centre) / scale)


def edge_ends(vertices_px: Floats) -> Floats:
    """Both ends of the four edges, (..., 4 edges, 2 ends, 2), of vertices (..., 4, 2)."""
    return np.asarray(vertices_px[..., np.array(EDGES), :])


def intersections(ends_px: Floats) -> Floats:
    """Vertices P1..P4, (..., 4, 2), where the lines through ``ends_px`` (..., 4 edges, 2, 2) meet; NaN if parallel."""
    ends = homogeneous(ends_px)
    lines = np.cross(ends[..., 0, :], ends[..., 1, :])
    pairs = lines[..., np.array(EDGES_AT_VERTEX), :]
    meets = np.cross(pairs[..., 0, :], pairs[..., 1, :])
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(meets[..., :2] / meets[..., 2:])


def edge_normals(ends_px: Floats, centre_px: Floats) -> Floats:
    """Unit normals (..., 2) of the lines through ``ends_px`` (..., 2, 2) that point away from ``centre_px`` (2,)."""
    along = ends_px[..., 1, :] - ends_px[..., 0, :]
    length = np.maximum(np.hypot(along[..., 0], along[..., 1]), 1e-9)  # of a point, some normal
    normal = along[..., ::-1] * np.array([1.0, -1.0]) / length[..., None]
    inward = np.sum(normal * (ends_px[..., 0, :] - centre_px), axis=-1, keepdims=True) < 0
    return np.asarray(np.where(inward, -normal, normal))


def _pinhole(intrinsics: Intrinsics) -> tuple[Floats, Floats]:
    return np.array([intrinsics.fx_px, intrinsics.fy_px]), np.array([intrinsics.cx_px, intrinsics.cy_px])
