"""Sub-pixel refinement of ellipses: edge points along the normals in ever narrower windows, and a robust conic through them.

The fit is that of Sampson distances, by iterated weights: with the conic scaled to C₃₃ = −1 in coordinates about the ellipse,
pᵀCp/(2|(Cp)₁₂|) is linear in the other five once the denominator is held, and Tukey's biweight times 1/denominator² gives
weighted normal equations (Zhang 1997, sec. 4.4 and 9.3). C₃₃ = −1 costs nothing as long as the centre is inside.

How well the points lie on the conic tells a true edge from a false one: a projected circle's edge scatters by 0.1 to 0.4 px,
the chance meeting of shadows, facets and edges by one or two. The share of *all* stations near the conic counts, since a
robust scale by itself hides a bad fit.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimators.stereo_ring.conics import conics_from_parameters, parameters_from_conics, sampson_px
from estimators.stereo_ring.edge_peaks import edge_peaks
from estimators.stereo_ring.parameters import RefineParameters
from estimators.stereo_ring.pictures import Smoothed
from estimators.stereo_ring.robust import tukey_weights
from scenes.arrays import Bools, Floats

_LEAST_POINTS = 12
_FULL_WINDOW_PX, _LEAST_WINDOW_PX = 250.0, 1.5


@dataclass(frozen=True, slots=True, eq=False)
class EdgeFits:
    """What k ellipses became: ``parameters`` (k, 5), NaN where the fit failed.

    ``points_px`` (k, n, 2) and their Sampson distance ``residual_px`` (k, n), NaN at stations without an edge; ``gradient``
    (k, n) DN a pixel, positive where it is brighter outside; ``share`` (k,) of all stations near the ellipse; ``rms_px`` (k,)
    of those that the robust fit kept.
    """

    parameters: Floats
    points_px: Floats
    residual_px: Floats
    gradient: Floats
    share: Floats
    rms_px: Floats

    def near(self, index: int, within_px: float) -> Floats:
        """The edge points (n, 2) px of one ellipse that lie near it."""
        return np.asarray(self.points_px[index][np.abs(np.nan_to_num(self.residual_px[index], nan=np.inf)) <= within_px])


def refined(picture: Smoothed, ellipses: Floats, windows_px: Sequence[float], p: RefineParameters) -> EdgeFits:
    """Ellipses (k, 5), each moved to the edge nearby; ``windows_px``: half-widths of the search, one after the other."""
    current = np.asarray(ellipses, dtype=np.float64)
    for window in windows_px:
        stations, normals = stations_on(current, p.stations)
        reach = scaled_window(window, np.nan_to_num(current[:, 2], nan=1.0))
        peaks = edge_peaks(picture, np.nan_to_num(stations), np.nan_to_num(normals), reach, p.least_gradient_dn)
        points = stations + peaks.distance_px[..., None] * normals
        points = np.where(peaks.found[..., None], points, np.nan)
        current, kept = fitted(points, current, p)
    residual = sampson_px(conics_from_parameters(current), points)
    near = np.abs(np.nan_to_num(residual, nan=np.inf)) <= p.near_px
    count = np.sum(kept, axis=-1)
    rms = np.sqrt(np.sum(np.where(kept, residual, 0.0) ** 2, axis=-1) / np.maximum(count - 5, 1))
    rms = np.where(np.isfinite(current[:, 0]), rms, np.inf)
    return EdgeFits(current, points, residual, peaks.gradient, np.mean(near, axis=-1), rms)


def scaled_window(window_px: float, semi_axis_px: Floats) -> Floats:
    """The half-width (...,) of a search about ellipses with ``semi_axis_px`` (...,): less where all of the ring is smaller.

    An estimate is off by a share of the size, and so far away are the neighbouring edges.
    """
    return np.clip(window_px * semi_axis_px / _FULL_WINDOW_PX, min(window_px, _LEAST_WINDOW_PX), window_px)


def stations_on(ellipses: Floats, count: int) -> tuple[Floats, Floats]:
    """Points (k, count, 2) px, even in the ellipse's parameter, and their outward unit normals (k, count, 2)."""
    x, y, a, b, theta = (one[..., None] for one in np.moveaxis(ellipses, -1, 0))
    t = np.arange(count) * (2 * np.pi / count)
    c, s, ct, st = np.cos(theta), np.sin(theta), np.cos(t), np.sin(t)
    points = np.stack([x + c * a * ct - s * b * st, y + s * a * ct + c * b * st], axis=-1)
    along, across = b * ct, a * st
    normals = np.stack([c * along - s * across, s * along + c * across], axis=-1)
    return points, normals / np.linalg.norm(normals, axis=-1, keepdims=True)


def fitted(points_px: Floats, starts: Floats, p: RefineParameters) -> tuple[Floats, Bools]:
    """Robust Sampson fits (k, 5) to points (k, n, 2), NaN where there is none; ``kept`` (k, n): points of weight above 0."""
    local, scale = _local(points_px, starts)
    known = np.asarray(np.isfinite(local).all(axis=-1))
    u, v = np.moveaxis(np.where(known[..., None], local, 0.0), -1, 0)
    monomials = np.stack([u * u, 2 * u * v, v * v, 2 * u, 2 * v], axis=-1)
    conic = _start_conic(starts, scale)
    weight = known.astype(np.float64)
    for step in range(p.fit_steps):
        residual, slope = _distances(conic, u, v, scale)
        if step:  # the first step's scale is that of the search, not of the edge
            weight = tukey_weights(residual, known, p.least_sigma_px)
        conic = _solved(monomials, weight / np.maximum(slope, 1e-6) ** 2)
    parameters = _global(conic, starts, scale)
    enough = np.sum(weight > 0, axis=-1) >= _LEAST_POINTS
    return np.where(enough[:, None], parameters, np.nan), np.asarray(weight > 0)


def _local(points_px: Floats, ellipses: Floats) -> tuple[Floats, Floats]:
    """Points about the ellipse's centre in units of its mean semi-axis, and that unit (k,) px."""
    scale = np.nan_to_num((ellipses[:, 2] + ellipses[:, 3]) / 2, nan=1.0)
    return (points_px - ellipses[:, None, :2]) / scale[:, None, None], scale


def _start_conic(ellipses: Floats, scale: Floats) -> Floats:
    """(k, 5): uu, uv, vv, u, v of the conic with C₃₃ = −1 in the local coordinates."""
    local = np.nan_to_num(ellipses, nan=1.0).copy()
    local[:, :2] = 0.0
    local[:, 2:4] /= scale[:, None]
    C = conics_from_parameters(local)
    return np.stack([C[:, 0, 0], C[:, 0, 1], C[:, 1, 1], C[:, 0, 2], C[:, 1, 2]], axis=-1)


def _distances(conic: Floats, u: Floats, v: Floats, scale: Floats) -> tuple[Floats, Floats]:
    """Sampson distances (k, n) px and the denominators 2|(Cp)₁₂|."""
    A, B, C, D, E = (one[:, None] for one in conic.T)
    gu, gv = A * u + B * v + D, B * u + C * v + E
    value = gu * u + gv * v + D * u + E * v - 1
    slope = 2 * np.hypot(gu, gv)
    return value / np.maximum(slope, 1e-6) * scale[:, None], slope


def _solved(monomials: Floats, weight: Floats) -> Floats:
    """Minimises Σ w (m · c − 1)² for each of k; a hair of damping keeps an empty one solvable."""
    weighted = monomials * weight[..., None]
    normal = np.swapaxes(weighted, -1, -2) @ monomials
    normal += (1e-12 + 1e-9 * np.trace(normal, axis1=-2, axis2=-1))[:, None, None] * np.eye(5)
    return np.asarray(np.linalg.solve(normal, np.sum(weighted, axis=-2)[..., None])[..., 0])


def _global(conic: Floats, ellipses: Floats, scale: Floats) -> Floats:
    A, B, C, D, E = conic.T
    rows = [np.stack([A, B, D], -1), np.stack([B, C, E], -1), np.stack([D, E, -np.ones_like(A)], -1)]
    found = parameters_from_conics(np.stack(rows, axis=-2))
    found[:, :4] *= scale[:, None]
    found[:, :2] += ellipses[:, :2]
    return found
