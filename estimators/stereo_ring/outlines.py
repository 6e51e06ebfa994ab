"""A marker's own edge, to a fraction of a pixel: four straight sides, or an ellipse of known shape.

A blob's centroid is dragged by the marker's shadow and by whatever dark facet touches it; its edges are not. A marker is plain
paint, so its edge is the first on the way out from its inside; the steepest may be that of its shadow, two pixels farther. Where
a shadow is too narrow to be resolved, the picture just inside the edge is darker than the marker, and the edge is no measure. The centre
of a square in perspective is where its diagonals meet; that of a disc is taken for its ellipse's, which at a marker's size is
within 0.1 px and always to the same side.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimators.stereo_ring.edge_peaks import STEP_PX, Peaks, peaks_in, profile_gradients
from estimators.stereo_ring.parameters import MarkerParameters
from estimators.stereo_ring.pictures import Smoothed, smoothed
from estimators.stereo_ring.robust import MAD_TO_SIGMA, tukey_weights
from scenes.arrays import Bools, Floats

_FIT_STEPS = 5


@dataclass(frozen=True, slots=True, eq=False)
class MarkerView:
    """A view twice: ``smooth`` for the place of edges, ``raw`` for narrow shadows."""

    smooth: Smoothed
    raw: Smoothed


def marker_view(picture: NDArray[np.uint8], centre_px: Floats, half_px: float, p: MarkerParameters) -> MarkerView:
    """The square of half-width ``half_px`` about ``centre_px`` (2,) of an eight-bit picture (h, w)."""
    smooth = smoothed(picture, centre_px, half_px, p.smooth_sigma_px)
    return MarkerView(smooth, smoothed(picture, centre_px, half_px, 0.0))


@dataclass(frozen=True, slots=True, eq=False)
class _Inside:
    """What is plain: the marker's brightness, DN, its ``noise_dn``, and the ``least_gradient`` that is an edge."""

    level_dn: float
    noise_dn: float
    least_gradient: float


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """``corners_px`` (4, 2) in order round a square, or ``border_px`` (n, 2) round a disc; the other is None.

    ``centre_px`` (2,): image of the marker's centre; ``share`` of the stations asked that lie on the outline, and the ``rms_px`` of
    those; ``bright``: brighter than its ground.
    """

    corners_px: Floats | None
    border_px: Floats | None
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
        border = self.corners_px if self.border_px is None else self.border_px
        return 0.0 if border is None else abs(_signed_area(border))


def square_outline(view: MarkerView, corners_px: Floats, windows_px: Sequence[float], p: MarkerParameters) -> Outline | None:
    """Four lines on the edges near those of a quadrilateral (4, 2), and their corners; None if a side is not there."""
    corners = corners_px if _signed_area(corners_px) > 0 else corners_px[::-1]
    found = np.zeros((4, p.side_stations), dtype=bool)
    inside = _inside(view, corners, p)
    for window in windows_px:
        stations, normals = _side_stations(corners, p)
        peaks, clear = _edges(view, stations, normals, window, inside, p)
        enough = clear.mean(axis=1, keepdims=True) >= p.clear_share
        points = stations + peaks.distance_px[..., None] * normals
        lines, found, residual = _lines(points, np.where(enough, clear, peaks.found), p)
        if lines is None:
            return None
        corners = _corners(lines)
        if not np.isfinite(corners).all() or _signed_area(corners) <= 0:
            return None
    near = found & (np.abs(residual) <= p.near_px)
    if near.mean(axis=1).min() < p.side_share:
        return None
    rms = float(np.sqrt(np.mean(residual[near] ** 2)))
    bright = bool(np.median(np.sign(peaks.gradient[near])) < 0)
    return Outline(corners, None, _crossing(corners[[0, 1]], corners[[2, 3]]), bright, float(near.mean()), rms)


def disc_outline(view: MarkerView, border_px: Floats, windows_px: Sequence[float], p: MarkerParameters) -> Outline | None:
    """The ellipse of a disc near ``border_px`` (n, 2): its shape is that of the border, its centre and size the edge's.

    The shape is known from the ring's normal. So the centre follows from the part of the edge that is clear, where the rest is
    blurred into the disc's own narrow shadow. None if too little of it is there.
    """
    border = border_px
    inside = _inside(view, border, p)
    for window in windows_px:
        outward = _outward(border)
        peaks, clear = _edges(view, border, outward, window, inside, p)
        used = clear if clear.mean() >= p.clear_share else peaks.found
        step, residual = _shift_and_size(border, outward, peaks.distance_px, used, p)
        if step is None:
            return None
        middle = border.mean(axis=0)
        border = middle + step[:2] + (1 + step[2]) * (border - middle)
    near = used & (np.abs(residual) <= p.near_px)
    if near.mean() < p.side_share:
        return None
    bright = bool(np.median(np.sign(peaks.gradient[near])) < 0)
    share = float(near.sum() / max(used.sum(), 1))
    return Outline(None, border, border.mean(axis=0), bright, share, float(np.sqrt(np.mean(residual[near] ** 2))))


def _inside(view: MarkerView, border_px: Floats, p: MarkerParameters) -> _Inside:
    """Of the inner half of a border (n, 2). More is an edge in a bright marker, whose photon noise is larger."""
    middle = border_px.mean(axis=0)
    around = np.concatenate([middle + share * (border_px - middle) for share in (0.15, 0.3, 0.45, 0.6)])
    values = view.raw.at(np.concatenate([around, (around + np.roll(around, 1, axis=0)) / 2])[None])[0].astype(np.float64)
    level = float(np.median(values))
    noise = MAD_TO_SIGMA * float(np.median(np.abs(values - level)))
    return _Inside(level, noise, max(p.least_gradient_dn, p.least_gradient_share * level))


def _edges(
    view: MarkerView, stations: Floats, normals: Floats, window_px: float, inside: _Inside, p: MarkerParameters
) -> tuple[Peaks, Bools]:
    """The first edge outwards at stations (..., n, 2), and at which (..., n) no narrow shadow lies on it."""
    gradient, distance = profile_gradients(view.smooth, stations, normals, window_px + p.strip_px)
    near = np.abs(distance) <= window_px + STEP_PX
    peaks = peaks_in(gradient[..., near], distance[near], inside.least_gradient, first=True)
    beyond = distance - peaks.distance_px[..., None]
    other_side = np.where(beyond > STEP_PX, -np.sign(peaks.gradient)[..., None] * gradient, 0.0).max(axis=-1)
    before = peaks.distance_px[..., None] - np.arange(0.25, p.dip_px, STEP_PX)
    dark = view.raw.at(stations[..., None, :] + before[..., None] * normals[..., None, :]).min(axis=-1)
    dipped = dark < inside.level_dn - max(p.dip_sigmas * inside.noise_dn, p.dip_dn)
    return peaks, np.asarray(peaks.found & ~dipped & (other_side <= np.abs(peaks.gradient)))


def _outward(border: Floats) -> Floats:
    """Unit normals (n, 2) of a closed convex curve through points (n, 2)."""
    along = np.roll(border, -1, axis=0) - np.roll(border, 1, axis=0)
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    return np.asarray(normal * np.sign(np.sum(normal * (border - border.mean(axis=0)), axis=1, keepdims=True)))


def _shift_and_size(
    border: Floats, outward: Floats, distance: Floats, used: Bools, p: MarkerParameters
) -> tuple[Floats | None, Floats]:
    """Robust (du, dv, relative growth) that bring a curve's points (n, 2) to their measured distances (n,); residuals (n,)."""
    arm = np.sum(outward * (border - border.mean(axis=0)), axis=1)
    rows = np.column_stack([outward, arm])
    weight, step, residual = used.astype(np.float64), np.zeros(3), distance
    if used.sum() < p.least_points:
        return None, residual
    for number in range(_FIT_STEPS):
        if number:
            weight = tukey_weights(residual, used, p.least_sigma_px)
        normal = rows.T @ (weight[:, None] * rows)
        step = np.linalg.lstsq(normal, rows.T @ (weight * distance), rcond=1e-6)[0]
        residual = distance - rows @ step
    return np.asarray(step), residual


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
            weight = tukey_weights(residual, found, p.least_sigma_px)
        total = np.sum(weight, axis=1)
        if total.min() < 3:
            return None, found, residual
        mx, my = np.sum(weight * x, axis=1) / total, np.sum(weight * y, axis=1) / total
        dx = x - mx[:, None]
        slope = np.sum(weight * dx * y, axis=1) / np.maximum(np.sum(weight * dx * dx, axis=1), 1e-9)
        residual = y - my[:, None] - slope[:, None] * dx
    ends = [middle + along * (mx + d)[:, None] + across * (my + slope * d)[:, None] for d in (-10.0, 10.0)]
    return np.stack(ends, axis=1), found & (weight > 0), residual


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
