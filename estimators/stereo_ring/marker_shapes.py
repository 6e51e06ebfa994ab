"""Which regions may be regular marks: seen from straight above, in the ring's plane, they are squares or discs of a sensible size.

A region is laid into the ring's plane by the homography of its view; a marker's own plane lies a little below, which changes its
size by a hundredth and its shape not at all.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from estimators.stereo_ring.circle_cone import Circle
from estimators.stereo_ring.marker_parameters import MarkerParameters
from estimators.stereo_ring.marker_sweep import Blob
from estimators.stereo_ring.rig import homogeneous
from scenes.arrays import Floats

_ON_DISC = 64  # points on the border of a disc


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """``border_px`` (n, 2): four corners of a ``square``, or points round a disc, in one view."""

    border_px: Floats
    square: bool


def plane_homography(ring: Circle, projection: Floats) -> Floats:
    """H (3, 3): pixels of a view with M = ``projection`` (3, 4) from coordinates (metres) in the ring's plane about its centre."""
    aside = np.cross(ring.normal, np.eye(3)[np.argmin(np.abs(ring.normal))])
    first = aside / np.linalg.norm(aside)
    basis = np.column_stack([first, np.cross(ring.normal, first), ring.centre_m])
    return np.asarray(projection @ np.vstack([basis, [0.0, 0.0, 1.0]]))


def shapes_of(blobs: list[Blob], ring: Circle, projection: Floats, p: MarkerParameters) -> list[Shape]:
    """The squares and discs among the regions of one view."""
    pixels_from_plane = plane_homography(ring, projection)
    plane_from_pixels = np.linalg.inv(pixels_from_plane)
    found = []
    for blob in blobs:
        hull = np.asarray(cv2.convexHull(blob.points_px.astype(np.float32))[:, 0], dtype=np.float64)
        shape = _regular_shape(_mapped(np.asarray(plane_from_pixels), hull), ring.radius_m, p)
        if shape is not None:
            found.append(Shape(_mapped(pixels_from_plane, shape), len(shape) == 4))
    return found


def _regular_shape(hull: Floats, radius_m: float, p: MarkerParameters) -> Floats | None:
    """The square (4, 2) or the disc (64, 2) that a convex hull (n, 2) in the plane is close to, or None."""
    points = (hull / radius_m).astype(np.float32)  # OpenCV thinks in single precision
    if len(points) < 4:
        return None
    middle, (width, height), _ = box = cv2.minAreaRect(points)
    if not (p.least_size < min(width, height) and max(width, height) < p.most_size):
        return None
    if max(width, height) > p.regular_ratio * min(width, height):
        return None
    filled = cv2.contourArea(points) / (width * height)
    if filled >= p.square_fill:
        return np.asarray(cv2.boxPoints(box), dtype=np.float64) * radius_m
    if filled < p.disc_fill:
        return None
    angle = np.arange(_ON_DISC) * (2 * np.pi / _ON_DISC)
    radius = np.sqrt(cv2.contourArea(points) / np.pi)
    return np.asarray(middle + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)) * radius_m


def _mapped(homography: Floats, points: Floats) -> Floats:
    image = np.asarray(homogeneous(points) @ homography.T, dtype=np.float64)
    return np.asarray(image[:, :2] / image[:, 2:])
