"""Where the four vertices will be in the next picture: a Kalman filter of their image positions and velocities.

State: P1..P4 (8 ideal px) and their velocities (8 px/s), constant velocity with white acceleration (Bar-Shalom, Li &
Kirubarajan 2001, § 6.2). The accelerations of the vertices go together, as those of a body do: translation and linear
deformation of the whole quadrilateral, and little else. So an edge that is hidden for a while is carried along by the
three that are seen, and its uncertainty, which sets the width of its search, grows. Knows no pose and no size.
"""

from dataclasses import dataclass, replace

import numpy as np

from estimators.mono_rectangle.quadrilateral import EDGES
from scenes.arrays import Floats

_OWN_SHARE = 0.05  # of the variance of a vertex' acceleration that is its own affair


@dataclass(frozen=True, slots=True, eq=False)
class VertexTrack:
    """``mean`` (16,) and ``covariance`` (16, 16): positions x1, y1, …, x4, y4, then velocities; ideal px, seconds."""

    mean: Floats
    covariance: Floats

    @property
    def vertices_px(self) -> Floats:
        """P1..P4, (4, 2), ideal px."""
        return self.mean[:8].reshape(4, 2)

    def line_covariance(self, edge: int, normal: Floats) -> Floats:
        """Covariance (2, 2) px² of the distances along ``normal`` (2,) of the two ends of an edge."""
        rows = _line_rows(edge, normal)
        return np.asarray(rows @ self.covariance @ rows.T)


def started(vertices_px: Floats, sigma_px: float, rate_prior_rad_s: float) -> VertexTrack:
    """A track from vertices (4, 2) with iid noise ``sigma_px`` of a body that turns at an unknown rate of the given 1σ."""
    covariance = np.zeros((16, 16))
    covariance[:8, :8] = sigma_px**2 * np.eye(8)
    covariance[8:, 8:] = (rate_prior_rad_s * _radius(vertices_px)) ** 2 * _common_motion(vertices_px)
    return VertexTrack(np.concatenate([np.ravel(vertices_px), np.zeros(8)]), covariance)


def predicted(track: VertexTrack, dt_s: float, acceleration_px2_s3: float, curvature: float) -> VertexTrack:
    """The track ``dt_s`` later. On a circle of radius r, speed v is an acceleration v²/r: its square adds to the noise."""
    move = np.eye(16)
    move[:8, 8:] = dt_s * np.eye(8)
    speed = float(np.linalg.norm(track.mean[8:].reshape(4, 2), axis=1).max())
    density = acceleration_px2_s3 + curvature * (speed**2 / _radius(track.vertices_px)) ** 2 * dt_s
    growth = np.array([[dt_s**3 / 3, dt_s**2 / 2], [dt_s**2 / 2, dt_s]])
    noise = density * np.kron(growth, _common_motion(track.vertices_px))
    return VertexTrack(move @ track.mean, move @ track.covariance @ move.T + noise)


def line_innovation(track: VertexTrack, edge: int, ends_px: Floats, normal: Floats, noise: Floats) -> tuple[Floats, float]:
    """Distances (2,) px along ``normal`` of a measured line from an edge's predicted ends, and their squared Mahalanobis length.

    ``ends_px`` (2, 2): two points on the measured line; ``noise`` (2, 2) px².
    """
    gap = (ends_px - track.vertices_px[np.array(EDGES[edge])]) @ normal
    spread = track.line_covariance(edge, normal) + noise
    return gap, float(gap @ np.linalg.solve(spread, gap))


def updated(track: VertexTrack, edge: int, ends_px: Floats, normal: Floats, noise: Floats) -> VertexTrack:
    """The track after one measured line (Joseph form)."""
    rows = _line_rows(edge, normal)
    gap, _ = line_innovation(track, edge, ends_px, normal, noise)
    gain = np.linalg.solve(rows @ track.covariance @ rows.T + noise, rows @ track.covariance).T
    keep = np.eye(16) - gain @ rows
    return replace(track, mean=track.mean + gain @ gap, covariance=keep @ track.covariance @ keep.T + gain @ noise @ gain.T)


def _line_rows(edge: int, normal: Floats) -> Floats:
    rows = np.zeros((2, 16))
    for end, vertex in enumerate(EDGES[edge]):
        rows[end, 2 * vertex : 2 * vertex + 2] = normal
    return rows


def _radius(vertices_px: Floats) -> float:
    return max(float(np.linalg.norm(vertices_px - vertices_px.mean(axis=0), axis=1).mean()), 1.0)


def _common_motion(vertices_px: Floats) -> Floats:
    """Correlation (8, 8) of the vertices' motions: shifts, linear maps about the centre, and a small share of its own."""
    arm = (vertices_px - vertices_px.mean(axis=0)) / _radius(vertices_px)
    shapes = np.concatenate([np.ones((4, 1)), arm], axis=1)
    together = shapes @ shapes.T / 3
    return np.kron(together + _OWN_SHARE * np.eye(4), np.eye(2))
