"""From regions in two views to markers in space: each on its own edge, matched along epipolar lines, gated about the ring."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from estimators.stereo_ring.circle_cone import Circle
from estimators.stereo_ring.conics import points_on_parameters
from estimators.stereo_ring.marker_sweep import Blob
from estimators.stereo_ring.outlines import Outline, better, disc_outline, square_outline
from estimators.stereo_ring.parameters import MarkerParameters
from estimators.stereo_ring.pictures import Smoothed
from estimators.stereo_ring.rig import Rig, epipolar_distance_px, homogeneous, triangulate
from scenes.arrays import Bools, Floats

_BORDER = 24  # points on a disc's edge
_SAME_PX = 2.0  # outlines whose centres are nearer than this are one


@dataclass(frozen=True, slots=True, eq=False)
class Sighting:
    """One marker in both views.

    ``point_left`` (3,): its centre, metres, left camera frame; ``border_left`` (n, 3): a square's four corners, or points of a
    disc's edge, in the plane through the centre that is parallel to the ring's; ``square``; ``bright``; ``area_px`` on the left.
    """

    point_left: Floats
    border_left: Floats
    square: bool
    bright: bool
    area_px: float


def outlines_of(view: Smoothed, blobs: list[Blob], p: MarkerParameters) -> list[Outline]:
    """The sound outlines of regions, each once, the best first."""
    found = [outline for blob in blobs if (outline := outline_of(view, blob, p)) is not None]
    found.sort(key=lambda one: -one.quality)
    return [
        one
        for number, one in enumerate(found)
        if not any(np.linalg.norm(one.centre_px - other.centre_px) < _SAME_PX for other in found[:number])
    ]


def outline_of(view: Smoothed, blob: Blob, p: MarkerParameters) -> Outline | None:
    """The region's own edge, as the square or the disc that explains it better; None if it has neither's."""
    hull = cv2.convexHull(blob.points_px.astype(np.float32))
    corners = _four_corners(hull)
    square = None if corners is None else square_outline(view, corners, blob.bright, p.windows_px, p)
    (x, y), (width, height), turn = cv2.fitEllipseDirect(hull) if len(hull) >= 6 else ((0, 0), (0, 0), 0)
    disc = None
    if min(width, height) > 2:
        a, b, theta = (width / 2, height / 2, turn) if width >= height else (height / 2, width / 2, turn + 90)
        disc = disc_outline(view, np.array([x, y, a, b, np.deg2rad(theta)]), blob.bright, p.windows_px, p)
    found = better(square, disc)
    return found if found is not None and is_sound(found, p) else None


def is_sound(outline: Outline, p: MarkerParameters) -> bool:
    """Whether enough of the outline is seen, and lies on it."""
    return outline.share >= p.share and outline.rms_px <= p.rms_px


def sightings(left: list[Outline], right: list[Outline], rig: Rig, ring: Circle, p: MarkerParameters) -> list[Sighting]:
    """Pairs of outlines that are one marker's on the ring's spacecraft, the best epipolar fit first, each outline once."""
    pairs = [(i, j) for i, a in enumerate(left) for j, b in enumerate(right) if _may_be_one(a, b, p)]
    if not pairs:
        return []
    centres = np.array([left[i].centre_px for i, _ in pairs]), np.array([right[j].centre_px for _, j in pairs])
    distance = epipolar_distance_px(rig, *centres)
    points = triangulate(rig, *centres)
    good = (distance <= p.epipolar_px) & is_about(points, ring, p)
    chosen: list[Sighting] = []
    used_left: set[int] = set()
    used_right: set[int] = set()
    for index in np.argsort(distance, kind="stable"):
        i, j = pairs[index]
        if good[index] and i not in used_left and j not in used_right:
            seen = sighting(left[i], points[index], rig, ring.normal)
            if is_regular(seen.border_left - seen.point_left, seen.square, p):
                used_left.add(i)
                used_right.add(j)
                chosen.append(seen)
    return chosen


def sighting(left: Outline, point_left: Floats, rig: Rig, normal: Floats) -> Sighting:
    """The marker at ``point_left`` with its border from the left view."""
    border = left.corners_px
    if border is None:
        border = points_on_parameters(np.asarray(left.ellipse), _BORDER)
    rays = homogeneous(border) @ np.linalg.inv(rig.K_left).T
    depth = (normal @ point_left) / (rays @ normal)
    return Sighting(point_left, rays * depth[:, None], left.corners_px is not None, left.bright, left.area_px)


def is_regular(border: Floats, square: bool, p: MarkerParameters) -> bool:
    """Whether a border (n, 3) about the centre is a square's or a disc's, within a factor and an angle."""
    if not square:
        radii = np.linalg.norm(border, axis=1)
        return bool(radii.max() <= p.regular_ratio * radii.min())
    sides = np.roll(border, -1, axis=0) - border
    length = np.linalg.norm(sides, axis=1)
    cosine = np.sum(sides * np.roll(sides, -1, axis=0), axis=1) / (length * np.roll(length, -1))
    return bool(length.max() <= p.regular_ratio * length.min() and np.abs(cosine).max() <= np.sin(np.deg2rad(p.regular_deg)))


def _four_corners(hull: NDArray[np.generic]) -> Floats | None:
    """The quadrilateral (4, 2) that a hull is close to, or None."""
    around = cv2.arcLength(hull, True)
    for tolerance in (0.03, 0.05, 0.08, 0.11):
        corners = cv2.approxPolyDP(hull, tolerance * around, True)
        if len(corners) == 4:
            return np.asarray(corners[:, 0], dtype=np.float64)
        if len(corners) < 4:
            break
    return None


def _may_be_one(one: Outline, other: Outline, p: MarkerParameters) -> bool:
    ratio = one.area_px / max(other.area_px, 1e-9)
    same_shape = (one.ellipse is None) == (other.ellipse is None)
    return one.bright == other.bright and same_shape and 1 / p.view_area < ratio < p.view_area


def is_about(points_left: Floats, ring: Circle, p: MarkerParameters) -> Bools:
    """Which points (n, 3) lie on the panel about the ring: height along its normal and distance from its axis, in radii."""
    offset = np.nan_to_num(points_left, nan=1e9) - ring.centre_m
    height = offset @ ring.normal / ring.radius_m
    across = np.linalg.norm(offset - (offset @ ring.normal)[:, None] * ring.normal, axis=1) / ring.radius_m
    in_height = (height > p.lowest) & (height < p.highest)
    return np.asarray(in_height & (across > p.innermost) & (across < p.outermost))
