"""Markers without a past: regions that keep their shape through many grey levels, dark on bright and bright on dark.

One fixed threshold is a statement about the exposure; a region that is the same over several levels has an edge all round.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from estimators.stereo_ring.conics import Ellipse
from estimators.stereo_ring.marker_parameters import MarkerParameters
from estimators.stereo_ring.pictures import Float32s
from scenes.arrays import Bools, Floats

Picture = NDArray[np.uint8]
_BAND = 2  # of the three kinds of mask


@dataclass(frozen=True, slots=True, eq=False)
class Blob:
    """A region: ``points_px`` (n, 2) of its border in the whole picture, through how many ``levels`` it lasts."""

    points_px: Floats
    levels: int


@dataclass(frozen=True, slots=True, eq=False)
class _Regions:
    """All regions of all levels: rows of (level, kind, u, v, area, label, left, top, width, height, mask), labels of each mask.

    Kinds: 0 below the level, 1 above it, 2 in a band below it.
    """

    rows: Floats
    labels: list[NDArray[np.int32]]


def swept(picture: Picture, ring: Ellipse, p: MarkerParameters) -> list[Blob]:
    """The stable regions of marker size about a ring's ellipse in an eight-bit picture (h, w)."""
    reach = p.reach * ring.a_px
    shrink = min(1.0, p.sweep_semi_axis_px / ring.a_px)
    low = np.maximum(np.floor(ring.centre_px - reach).astype(int), 0)
    part = picture[low[1] : max(int(ring.y_px + reach), 0), low[0] : max(int(ring.x_px + reach), 0)]
    if min(part.shape) < 8:
        return []
    small = part.astype(np.float32)  # between two grey values there is room for levels, once neighbours are averaged
    if shrink < 1.0:
        small = np.asarray(cv2.resize(small, None, fx=shrink, fy=shrink, interpolation=cv2.INTER_AREA), dtype=np.float32)
    small = np.asarray(cv2.GaussianBlur(small, (3, 3), 0.7), dtype=np.float32)
    regions = _regions(small, ring.a_px * ring.b_px * shrink**2, p)
    return [_blob(regions, row, count, low, shrink) for row, count in _stable(regions.rows, p)]


def _regions(small: Float32s, ring_area: float, p: MarkerParameters) -> _Regions:
    """Regions of marker-like size, fill and aspect; ``ring_area``: product of the ring's semi-axes, px² of this picture."""
    rows: list[Floats] = []
    labels: list[NDArray[np.int32]] = []
    black = float(np.percentile(small, p.low_percent))
    for number, level in enumerate(grey_levels(small, p)):
        masks = (small < level, small > level, _band(small, black, float(level), p))
        for kind, mask in enumerate(masks):
            label, found = _marker_like(mask.view(np.uint8), ring_area, p)
            rows.append(np.column_stack([np.full((len(found), 2), (number, kind)), found, np.full(len(found), len(labels))]))
            labels.append(label)
    return _Regions(np.concatenate(rows) if rows else np.empty((0, 11)), labels)


def _marker_like(mask: Picture, ring_area: float, p: MarkerParameters) -> tuple[NDArray[np.int32], Floats]:
    """The labels of a mask, and of its marker-like regions: u, v, area, label, left, top, width, height (k, 8)."""
    _, label, boxes, centres = cv2.connectedComponentsWithStats(mask, connectivity=4, ltype=cv2.CV_32S)
    index = np.flatnonzero(_is_marker_like(boxes.astype(np.float64), ring_area, mask.shape, p))
    index = index[index > 0]  # the first is what is not in the mask
    found = np.column_stack([centres[index], boxes[index][:, [4]], index, boxes[index][:, :4]])
    return np.asarray(label, dtype=np.int32), found


def _band(small: Float32s, black: float, level: float, p: MarkerParameters) -> Bools:
    """Between a level and the level a ratio below it, without hairs: a marker that is darker than its ground, yet brighter than
    the shadow that touches it."""
    low = black + (level - black) / p.band_ratio
    mask = ((small > low) & (small < level)).view(np.uint8)
    return np.asarray(cv2.morphologyEx(mask, cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))).view(np.bool_)


def grey_levels(picture: Float32s, p: MarkerParameters) -> Floats:
    """The levels of the sweep: a constant ratio apart over the picture's darkest, since shading multiplies."""
    dark, bright = np.percentile(picture, [p.low_percent, p.high_percent])
    if bright - dark < 2 * p.first_level_dn:
        return np.empty(0)
    return np.asarray(dark + np.geomspace(p.first_level_dn, bright - dark, p.levels + 1)[:-1])


def _is_marker_like(boxes: Floats, ring_area: float, shape: tuple[int, ...], p: MarkerParameters) -> Bools:
    left, top, width, height, area = boxes.T
    sized = (area >= p.least_area * ring_area) & (area <= p.most_area * ring_area)
    filled = area >= p.least_fill * width * height
    straight = np.maximum(width, height) <= p.most_aspect * np.minimum(width, height)
    inside = (left > 0) & (top > 0) & (left + width < shape[1]) & (top + height < shape[0])
    return np.asarray(sized & filled & straight & inside)


def _stable(rows: Floats, p: MarkerParameters) -> list[tuple[Floats, int]]:
    """The middle region of each set that stays about the same through enough levels, with the number of those levels."""
    if not len(rows):
        return []
    place, area = rows[:, 2:4], rows[:, 4]
    near = np.linalg.norm(place[:, None] - place, axis=-1) <= p.same_place * np.sqrt(area)[:, None]
    ratio = area[:, None] / area
    alike = near & (ratio < p.same_area) & (ratio > 1 / p.same_area) & (rows[:, 1][:, None] == rows[:, 1])
    levels = np.zeros(len(rows), dtype=int)
    for number in range(len(rows)):
        levels[number] = np.unique(rows[alike[number], 0]).size
    chosen: list[tuple[Floats, int]] = []
    left = levels >= np.where(rows[:, 1] == _BAND, p.least_band_levels, p.least_levels)
    while left.any():
        best = int(np.argmax(np.where(left, levels, -1)))
        group = np.flatnonzero(alike[best])
        middle = group[np.argsort(rows[group, 0], kind="stable")[group.size // 2]]
        chosen.append((rows[middle], int(levels[best])))
        left &= ~alike[best]
    return chosen


def _blob(regions: _Regions, row: Floats, count: int, low: NDArray[np.int_], shrink: float) -> Blob:
    left, top, width, height, which = row[6:].astype(int)
    mask = (regions.labels[which][top : top + height, left : left + width] == int(row[5])).astype(np.uint8)
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    border = max(contours, key=len)[:, 0] + np.array([left, top], dtype=np.float64)
    outward = border - border.mean(axis=0)
    border += 0.5 * outward / np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1.0)  # pixels reach half a pixel farther
    return Blob((border + 0.5) / shrink - 0.5 + low, count)
