"""A marker's own edge, to a fraction of a pixel: four straight sides, or an ellipse of known shape.

A blob's centroid is dragged by the marker's shadow and by whatever dark facet touches it; its edges are not. A marker is plain
paint, so its edge is the first on the way out from its inside; the steepest may be that of its shadow, two pixels farther.
Where a shadow is too narrow to be resolved, the picture just inside the edge is darker than the marker, and the edge is no
measure of it. The centre of a square in perspective is where its diagonals meet.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimators.stereo_ring.disc_and_shadow import lit_part
from estimators.stereo_ring.edge_peaks import Peaks
from estimators.stereo_ring.marker_parameters import MarkerParameters
from estimators.stereo_ring.marker_view import Inside, MarkerView, inside_of, marker_edges
from estimators.stereo_ring.side_lines import corners_of, crossing, side_lines, side_stations, signed_area
from scenes.arrays import Floats


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
        return self.share - self.rms_px

    @property
    def area_px(self) -> float:
        """Area in px²."""
        border = self.corners_px if self.border_px is None else self.border_px
        return 0.0 if border is None else abs(signed_area(border))


def square_outline(view: MarkerView, corners_px: Floats, windows_px: Sequence[float], p: MarkerParameters) -> Outline | None:
    """Four lines on the edges near those of a quadrilateral (4, 2), and their corners; None if a side is not there."""
    corners = corners_px if signed_area(corners_px) > 0 else corners_px[::-1]
    found = np.zeros((4, p.side_stations), dtype=bool)
    inside = inside_of(view, corners, p)
    for window in windows_px:
        stations, normals = side_stations(corners, p)
        peaks, clear = marker_edges(view, stations, normals, window, inside, p)
        enough = clear.mean(axis=1, keepdims=True) >= p.clear_share
        points = stations + peaks.distance_px[..., None] * normals
        lines, found, residual = side_lines(points, np.where(enough, clear, peaks.found), p)
        if lines is None:
            return None
        corners = corners_of(lines)
        if not np.isfinite(corners).all() or signed_area(corners) <= 0:
            return None
    near = found & (np.abs(residual) <= p.near_px)
    if near.mean(axis=1).min() < p.side_share:
        return None
    rms = float(np.sqrt(np.mean(residual[near] ** 2)))
    bright = bool(np.median(np.sign(peaks.gradient[near])) < 0)
    return Outline(corners, None, crossing(corners[[0, 1]], corners[[2, 3]]), bright, float(near.mean()), rms)


def disc_outline(view: MarkerView, border_px: Floats, windows_px: Sequence[float], p: MarkerParameters) -> Outline | None:
    """The ellipse of a disc near ``border_px`` (n, 2): its shape is that of the border, its centre and size the edge's.

    The shape is known from the ring's normal. So the centre follows from the part of the edge that is clear, where the rest is
    blurred into the disc's own narrow shadow. None if too little of it is there.
    """
    border = border_px
    inside = inside_of(view, border, p)
    for window in windows_px:
        outward = _outward(border)
        peaks, clear = marker_edges(view, border, outward, window, inside, p)
        used = clear if clear.mean() >= p.clear_share else peaks.found
        found = lit_part(border, outward, peaks.distance_px, used, _darkness(view, border, outward, peaks, inside), p)
        if found is None:
            return None
        border, residual = found
    near = used & (np.abs(residual) <= p.near_px)
    if near.mean() < p.side_share:
        return None
    bright = bool(np.median(np.sign(peaks.gradient[near])) < 0)
    share = float(near.sum() / max(used.sum(), 1))
    return Outline(None, border, border.mean(axis=0), bright, share, float(np.sqrt(np.mean(residual[near] ** 2))))


def _darkness(view: MarkerView, border: Floats, outward: Floats, peaks: Peaks, inside: Inside) -> Floats:
    """How much darker than the marker (n,) the picture is a pixel inside the edge, DN."""
    just_inside = border + (peaks.distance_px - 1.0)[:, None] * outward
    return inside.level_dn - np.asarray(view.raw.at(just_inside[None])[0], dtype=np.float64)


def _outward(border: Floats) -> Floats:
    """Unit normals (n, 2) of a closed convex curve through points (n, 2)."""
    along = np.roll(border, -1, axis=0) - np.roll(border, 1, axis=0)
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    return np.asarray(normal * np.sign(np.sum(normal * (border - border.mean(axis=0)), axis=1, keepdims=True)))
