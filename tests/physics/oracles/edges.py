"""Where the straight edges of a picture are, to a few thousandths of a pixel: independent of any estimator's line fit."""

import numpy as np
from scipy.ndimage import map_coordinates

from scenes.arrays import Floats

_REACH_PX = 5.0
_STEP_PX = 0.05
_PLATEAU_PX = 3.0
_FLAT = 0.02
_LEAST_SHARE = 0.5
_TRIM_PX = 4.0


def fit_edge(picture: Floats, start_px: Floats, end_px: Floats) -> Floats:
    """The line (a, b, c), a x + b y + c = 0 with (a, b) a unit vector, of the edge that runs near start → end.

    Every pixel along it gives one crossing: across the edge the picture steps from one plateau to another, and whatever
    symmetric blur there is, the step lies where the area under the profile says it does. Pixels where something else comes
    within five pixels of the edge (another part, a shadow's border) have no plateaus and do not count; NaN where these are most.
    """
    along = end_px - start_px
    length = float(np.linalg.norm(along))
    along = along / length
    across = np.array([-along[1], along[0]])
    stations = start_px + np.arange(_TRIM_PX, length - _TRIM_PX, 1.0)[:, None] * along
    offsets = np.arange(-_REACH_PX, _REACH_PX + _STEP_PX / 2, _STEP_PX)
    samples = stations[:, None] + offsets[None, :, None] * across
    profile = map_coordinates(picture, [samples[..., 1], samples[..., 0]], order=1, mode="nearest")
    shift = _crossing(offsets, profile)
    points = (stations + shift[:, None] * across)[np.isfinite(shift)]
    return _line(points) if len(points) > _LEAST_SHARE * len(stations) else np.full(3, np.nan)


def _crossing(offsets: Floats, profile: Floats) -> Floats:
    """Offset of the step in each profile (stations, offsets), by the area between it and its plateaus; NaN without such."""
    left, right = profile[:, offsets < -_PLATEAU_PX], profile[:, offsets > _PLATEAU_PX]
    low, high = left.mean(axis=1, keepdims=True), right.mean(axis=1, keepdims=True)
    step = np.abs(high - low)[:, 0]
    flat = np.maximum(np.ptp(left, axis=1), np.ptp(right, axis=1)) < _FLAT * step
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (profile - low) / (high - low)
    return np.where(flat, offsets[-1] - np.trapezoid(share, offsets, axis=1), np.nan)


def _line(points: Floats) -> Floats:
    """Total least squares, twice, the second time without what lies further than three robust sigmas off."""
    keep = np.ones(len(points), dtype=bool)
    for _ in range(3):
        centre = points[keep].mean(axis=0)
        normal = np.linalg.svd(points[keep] - centre)[2][-1]
        off = (points - centre) @ normal
        keep = np.abs(off) <= 3 * 1.4826 * np.median(np.abs(off[keep])) + 1e-9
    return np.append(normal, -normal @ centre)


def intersection(first: Floats, second: Floats) -> Floats:
    """Where two lines (a, b, c) meet, (2,)."""
    point = np.cross(first, second)
    return point[:2] / point[2]


def fit_corners(picture: Floats, corners_px: Floats) -> Floats:
    """Corners (4, 2) of the quadrilateral near ``corners_px`` (4, 2; Z-order P1..P4) as intersections of fitted edges."""
    p1, p2, p3, p4 = corners_px
    bottom, top = fit_edge(picture, p1, p2), fit_edge(picture, p3, p4)
    left, right = fit_edge(picture, p1, p3), fit_edge(picture, p2, p4)
    pairs = [(bottom, left), (bottom, right), (top, left), (top, right)]
    return np.array([intersection(first, second) for first, second in pairs])
