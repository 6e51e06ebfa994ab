"""From regions in two views to markers in space: each on its own edge, matched along epipolar lines, gated about the ring."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimators.stereo_ring.circle_cone import Circle
from estimators.stereo_ring.marker_parameters import MarkerParameters
from estimators.stereo_ring.marker_shapes import Shape
from estimators.stereo_ring.marker_view import MarkerView
from estimators.stereo_ring.outlines import Outline, disc_outline, square_outline
from estimators.stereo_ring.rig import Rig, epipolar_distance_px, homogeneous, triangulate
from scenes.arrays import Bools, Floats

_STRETCHES, _LEAST_RMS_PX = 16, 0.04  # of a marker's edge that scatter on their own, and the least that they do
_SAME_SHARE = 0.3  # of the root of its area: outlines whose centres are nearer than this are one marker's


@dataclass(frozen=True, slots=True, eq=False)
class Sighting:
    """One marker in both views.

    ``point_left`` (3,): its centre, metres, left camera frame; ``border_left`` (n, 3): a square's four corners, or points of a
    disc's edge, in the plane through the centre that is parallel to the ring's; ``square``; ``bright``; ``sigma_m``: how well
    the centre is known across the line of sight, by how its edge scatters.
    """

    point_left: Floats
    border_left: Floats
    square: bool
    bright: bool
    sigma_m: float


def outlines_of(view: MarkerView, shapes: list[Shape], p: MarkerParameters) -> list[Outline]:
    """The sound outlines of one view's squares and discs, each once, the best first."""
    found = [outline for shape in shapes if (outline := outline_near(view, shape, p.windows_px, p)) is not None]
    found = sorted((one for one in found if is_sound(one, p)), key=lambda one: -one.quality)
    return [
        one
        for number, one in enumerate(found)
        if not any(_is_at(one, other) for other in found[:number])
    ]


def _is_at(one: Outline, better: Outline) -> bool:
    return bool(np.linalg.norm(one.centre_px - better.centre_px) < _SAME_SHARE * np.sqrt(better.area_px))


def outline_near(view: MarkerView, shape: Shape, windows_px: Sequence[float], p: MarkerParameters) -> Outline | None:
    """The edge near a square or a disc."""
    find = square_outline if shape.square else disc_outline
    return find(view, shape.border_px, windows_px, p)


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
            seen = sighting((left[i], right[j]), points[index], rig, ring.normal)
            if is_regular(seen.border_left - seen.point_left, seen.square, p):
                used_left.add(i)
                used_right.add(j)
                chosen.append(seen)
    return chosen


def sighting(seen: tuple[Outline, Outline], point_left: Floats, rig: Rig, normal: Floats) -> Sighting:
    """The marker at ``point_left`` with its border from the left view."""
    left, right = seen
    border = np.asarray(left.border_px if left.corners_px is None else left.corners_px)
    rays = homogeneous(border) @ np.linalg.inv(rig.K_left).T
    depth = (normal @ point_left) / (rays @ normal)
    rms_px = max(float(np.hypot(left.rms_px, right.rms_px)) / np.sqrt(2), _LEAST_RMS_PX)
    sigma_m = rms_px / _STRETCHES**0.5 * float(point_left[2]) / float(rig.K_left[0, 0])
    return Sighting(point_left, rays * depth[:, None], left.corners_px is not None, left.bright, sigma_m)


def is_regular(border: Floats, square: bool, p: MarkerParameters) -> bool:
    """Whether a border (n, 3) about the centre is a square's or a disc's, within a factor and an angle."""
    if not square:
        radii = np.linalg.norm(border, axis=1)
        return bool(radii.max() <= p.regular_ratio * radii.min())
    sides = np.roll(border, -1, axis=0) - border
    length = np.linalg.norm(sides, axis=1)
    cosine = np.sum(sides * np.roll(sides, -1, axis=0), axis=1) / (length * np.roll(length, -1))
    return bool(length.max() <= p.regular_ratio * length.min() and np.abs(cosine).max() <= np.sin(np.deg2rad(p.regular_deg)))


def _may_be_one(one: Outline, other: Outline, p: MarkerParameters) -> bool:
    ratio = one.area_px / max(other.area_px, 1e-9)
    same_shape = (one.corners_px is None) == (other.corners_px is None)
    return one.bright == other.bright and same_shape and 1 / p.view_area < ratio < p.view_area


def is_about(points_left: Floats, ring: Circle, p: MarkerParameters) -> Bools:
    """Which points (n, 3) lie on the panel about the ring: height along its normal and distance from its axis, in radii."""
    offset = np.nan_to_num(points_left, nan=1e9) - ring.centre_m
    height = offset @ ring.normal / ring.radius_m
    across = np.linalg.norm(offset - (offset @ ring.normal)[:, None] * ring.normal, axis=1) / ring.radius_m
    in_height = (height > p.lowest) & (height < p.highest)
    return np.asarray(in_height & (across > p.innermost) & (across < p.outermost))
