"""The four sides of a quadrilateral: where to look for them, robust lines through what is found, and where these meet."""

import numpy as np

from estimators.stereo_ring.marker_parameters import MarkerParameters
from estimators.stereo_ring.robust import tukey_weights
from scenes.arrays import Bools, Floats

_FIT_STEPS = 5


def side_stations(corners: Floats, p: MarkerParameters) -> tuple[Floats, Floats]:
    """Stations (4, n, 2) on the sides, away from the corners, and outward normals (4, n, 2)."""
    along = np.roll(corners, -1, axis=0) - corners
    t = np.linspace(p.corner_share, 1 - p.corner_share, p.side_stations)
    stations = corners[:, None] + t[:, None] * along[:, None]
    outward = np.stack([along[:, 1], -along[:, 0]], axis=-1) / np.maximum(np.linalg.norm(along, axis=-1), 1e-9)[:, None]
    return stations, np.broadcast_to(outward[:, None], stations.shape)


def side_lines(points: Floats, found: Bools, p: MarkerParameters) -> tuple[Floats | None, Bools, Floats]:
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


def corners_of(lines: Floats) -> Floats:
    """Where each side's line (4, 2, 2) meets the one before it: (4, 2), NaN for parallels."""
    ends = np.concatenate([lines, np.ones((4, 2, 1))], axis=-1)
    line = np.cross(ends[:, 0], ends[:, 1])
    meet = np.cross(np.roll(line, 1, axis=0), line)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(meet[:, :2] / meet[:, 2:])


def crossing(start: Floats, end: Floats) -> Floats:
    """Where the diagonals start[i]–end[i] meet, (2,)."""
    ends = np.stack([start, end], axis=1)
    ends = np.concatenate([ends, np.ones((2, 2, 1))], axis=-1)
    first, second = np.cross(ends[:, 0], ends[:, 1])
    meet = np.cross(first, second)
    return np.asarray(meet[:2] / meet[2])


def signed_area(corners: Floats) -> float:
    """Positive for corners that run from u towards v."""
    u, v = corners[:, 0], corners[:, 1]
    return float(np.sum(u * np.roll(v, -1) - np.roll(u, -1) * v) / 2)
