"""A marker's own edge, to a fraction of a pixel: four straight sides, or an ellipse.

A blob's centroid is dragged by the marker's contact shadow and by whatever dark facet touches it; its edges are not. The centre
of a square in perspective is where its diagonals meet; that of a disc is taken for its ellipse's, which at a marker's size is
within 0.1 px and always to the same side.
"""

from dataclasses import dataclass, replace

import numpy as np

from estimators.stereo_ring.edge_peaks import edge_peaks
from estimators.stereo_ring.parameters import MarkerParameters, RefineParameters
from estimators.stereo_ring.pictures import Smoothed
from estimators.stereo_ring.refine import refined
from scenes.arrays import Bools, Floats

_TUKEY, _MAD_TO_SIGMA = 4.685, 1.4826
_FIT_STEPS = 5


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """``corners_px`` (4, 2) in order round a square, or ``ellipse`` (5,) of a disc; the other is None.

    ``centre_px`` (2,): image of the marker's centre; ``share`` of the stations that lie on the outline, and the ``rms_px`` of
    those; ``bright``: brighter than its ground.
    """

    corners_px: Floats | None
    ellipse: Floats | None
    centre_px: Floats
    bright: bool
    share: float
    rms_px: float

    @property
    def quality(self) -> float:
        """Larger for the shape that explains the edge better."""
        return self.share - 0.5 * self.rms_px

    @property
    def area_px(self) -> float:
        """Area in px²."""
        if self.ellipse is not None:
            return float(np.pi * self.ellipse[2] * self.ellipse[3])
        return abs(_signed_area(self.corners_px)) if self.corners_px is not None else 0.0


def square_outline(view: Smoothed, corners_px: Floats, bright: bool, windows_px: tuple[float, ...], p: MarkerParameters) -> Outline | None:
    """Four lines on the edges near those of a quadrilateral (4, 2), and their corners; None if a side is not there."""
    corners = corners_px if _signed_area(corners_px) > 0 else corners_px[::-1]
    found = np.zeros((4, p.side_stations), dtype=bool)
    for window in windows_px:
        stations, normals = _side_stations(corners, p)
        peaks = edge_peaks(view, stations, normals, window, p.least_gradient_dn, -1 if bright else 1)
        lines, found, residual = _lines(stations + peaks.distance_px[..., None] * normals, peaks.found, p)
        if lines is None:
            return None
        corners = _corners(lines)
        if not np.isfinite(corners).all() or _signed_area(corners) <= 0:
            return None
    near = found & (np.abs(residual) <= p.near_px)
    if near.mean(axis=1).min() < p.side_share:
        return None
    rms = float(np.sqrt(np.mean(residual[near] ** 2)))
    return Outline(corners, None, _crossing(corners[[0, 1]], corners[[2, 3]]), bright, float(near.mean()), rms)


def disc_outline(view: Smoothed, ellipse: Floats, bright: bool, windows_px: tuple[float, ...], p: MarkerParameters) -> Outline | None:
    """The ellipse (5,) on the edge near it; None if there is none."""
    settings = RefineParameters(
        stations=4 * p.side_stations, near_px=p.near_px, least_gradient_dn=p.least_gradient_dn, windows_px=windows_px
    )
    fit = refined(view, ellipse[None], windows_px, settings, -1 if bright else 1)
    found = fit.parameters[0]
    if not np.isfinite(found).all() or fit.share[0] < p.side_share:
        return None
    near = np.abs(np.nan_to_num(fit.residual_px[0], nan=np.inf)) <= p.near_px
    rms = float(np.sqrt(np.mean(fit.residual_px[0][near] ** 2)))
    return Outline(None, found, found[:2].copy(), bright, float(fit.share[0]), rms)


def better(one: Outline | None, other: Outline | None) -> Outline | None:
    """The outline that explains the edge better."""
    if one is None or other is None:
        return one if other is None else other
    return one if one.quality >= other.quality else other


def moved(outline: Outline, by_px: Floats) -> Outline:
    """The same shape elsewhere."""
    corners = None if outline.corners_px is None else outline.corners_px + by_px
    ellipse = None if outline.ellipse is None else outline.ellipse + np.array([by_px[0], by_px[1], 0, 0, 0])
    return replace(outline, corners_px=corners, ellipse=ellipse, centre_px=outline.centre_px + by_px)


def _side_stations(corners: Floats, p: MarkerParameters) -> tuple[Floats, Floats]:
    """Stations (4, n, 2) on the sides, away from the corners, and outward normals (4, n, 2)."""
    along = np.roll(corners, -1, axis=0) - corners
    t = np.linspace(p.corner_share, 1 - p.corner_share, p.side_stations)
    stations = corners[:, None] + t[:, None] * along[:, None]
    outward = np.stack([along[:, 1], -along[:, 0]], axis=-1) / np.maximum(np.linalg.norm(along, axis=-1), 1e-9)[:, None]
    return stations, np.broadcast_to(outward[:, None], stations.shape)


def _lines(points: Floats, found: Bools, p: MarkerParameters) -> tuple[Floats | None, Bools, Floats]:
    """A robust line through each side's points (4, n, 2): two points of each (4, 2, 2); which points count; their distances."""
    middle = np.mean(points, axis=1)
    along = points[:, -1] - points[:, 0]
    along = along / np.maximum(np.linalg.norm(along, axis=-1), 1e-9)[:, None]
    across = np.stack([-along[:, 1], along[:, 0]], axis=-1)
    x, y = (np.einsum("snk,sk->sn", points - middle[:, None], axis) for axis in (along, across))
    weight = found.astype(np.float64)
    residual = y
    for step in range(_FIT_STEPS):
        if step:
            weight = _tukey(residual, found, p.least_sigma_px)
        total = np.sum(weight, axis=1)
        if total.min() < 3:
            return None, found, residual
        mx, my = np.sum(weight * x, axis=1) / total, np.sum(weight * y, axis=1) / total
        dx = x - mx[:, None]
        slope = np.sum(weight * dx * y, axis=1) / np.maximum(np.sum(weight * dx * dx, axis=1), 1e-9)
        residual = y - my[:, None] - slope[:, None] * dx
    ends = [middle + along * (mx + d)[:, None] + across * (my + slope * d)[:, None] for d in (-10.0, 10.0)]
    return np.stack(ends, axis=1), found & (weight > 0), residual


def _tukey(residual: Floats, found: Bools, least_sigma_px: float) -> Floats:
    size = np.where(found, np.abs(residual), np.nan)
    size[~found.any(axis=1)] = 0.0
    sigma = np.maximum(_MAD_TO_SIGMA * np.nanmedian(size, axis=1), least_sigma_px)[:, None]
    return np.where(found, np.maximum(1 - (residual / (_TUKEY * sigma)) ** 2, 0.0) ** 2, 0.0)


def _corners(lines: Floats) -> Floats:
    """Where each side's line (4, 2, 2) meets the one before it: (4, 2), NaN for parallels."""
    ends = np.concatenate([lines, np.ones((4, 2, 1))], axis=-1)
    line = np.cross(ends[:, 0], ends[:, 1])
    meet = np.cross(np.roll(line, 1, axis=0), line)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(meet[:, :2] / meet[:, 2:])


def _crossing(start: Floats, end: Floats) -> Floats:
    """Where the diagonals start[i]–end[i] meet, (2,)."""
    ends = np.stack([start, end], axis=1)
    ends = np.concatenate([ends, np.ones((2, 2, 1))], axis=-1)
    first, second = np.cross(ends[:, 0], ends[:, 1])
    meet = np.cross(first, second)
    return np.asarray(meet[:2] / meet[2])


def _signed_area(corners: Floats) -> float:
    """Positive for corners that run from u towards v."""
    u, v = corners[:, 0], corners[:, 1]
    return float(np.sum(u * np.roll(v, -1) - np.roll(u, -1) * v) / 2)
