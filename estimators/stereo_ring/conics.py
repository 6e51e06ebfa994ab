"""Ellipses as five parameters and as 3 × 3 conics: Shu et al. 2020, eqs (3)-(5), with the printed errors mended.

A conic C is symmetric, pᵀ C p = 0 for the homogeneous pixels p = (u, v, 1) on it; in eq. (3), C = [[A, B/2, D/2],
[B/2, C, E/2], [D/2, E/2, F]]. Its scale and sign mean nothing; every function takes all of them.

Printed in (5) are a and b for one sign of the conic only (A + C > 0) and θ = ½ arctan(B/(A − C)), which divides by zero
for circles and means the minor axis as often as the major one. Here θ = ½ atan2(−B, C − A), the major axis.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from scenes.arrays import Floats


@dataclass(frozen=True, slots=True)
class Ellipse:
    """Centre ``x_px, y_px``, semi-axes ``a_px`` ≥ ``b_px``, ``theta_rad`` in (−π/2, π/2] of the major axis, from +u to +v."""

    x_px: float
    y_px: float
    a_px: float
    b_px: float
    theta_rad: float

    @property
    def parameters(self) -> Floats:
        """(x, y, a, b, θ), the order of the functions below."""
        return np.array([self.x_px, self.y_px, self.a_px, self.b_px, self.theta_rad])

    @property
    def centre_px(self) -> Floats:
        """(u, v) of the ellipse's centre, which is not the image of the circle's centre."""
        return np.array([self.x_px, self.y_px])


def ellipse_from_parameters(parameters: ArrayLike) -> Ellipse:
    """The value of one row (x, y, a, b, θ)."""
    return Ellipse(*(float(one) for one in np.asarray(parameters, dtype=np.float64)))


def conic_from_ellipse(ellipse: Ellipse) -> Floats:
    """C (3, 3), scaled so that pᵀ C p = (radial position)² − 1: negative inside."""
    return conics_from_parameters(ellipse.parameters)


def ellipse_from_conic(conic: ArrayLike) -> Ellipse | None:
    """The ellipse of C (3, 3) at any scale and sign; None if C is no real ellipse."""
    parameters = parameters_from_conics(conic)
    return ellipse_from_parameters(parameters) if np.isfinite(parameters).all() else None


def conics_from_parameters(parameters: ArrayLike) -> Floats:
    """C (..., 3, 3) of (x, y, a, b, θ) (..., 5): eq. (4), turned by θ and moved to (x, y)."""
    x, y, a, b, theta = np.moveaxis(np.asarray(parameters, dtype=np.float64), -1, 0)
    c, s = np.cos(theta), np.sin(theta)
    A, B, C = (c / a) ** 2 + (s / b) ** 2, c * s * (1 / a**2 - 1 / b**2), (s / a) ** 2 + (c / b) ** 2
    D, E = -(A * x + B * y), -(B * x + C * y)
    rows = [np.stack([A, B, D], -1), np.stack([B, C, E], -1), np.stack([D, E, -(D * x + E * y) - 1], -1)]
    return np.stack(rows, axis=-2)


def parameters_from_conics(conics: ArrayLike) -> Floats:
    """(x, y, a, b, θ) (..., 5) of C (..., 3, 3), eq. (5) mended; NaN where C is no real ellipse."""
    C = np.asarray(conics, dtype=np.float64)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        C = C * np.sign(C[..., 0, 0] + C[..., 1, 1])[..., None, None]
        p, q, r = C[..., 0, 0], C[..., 0, 1], C[..., 1, 1]
        determinant = p * r - q * q
        x = (q * C[..., 1, 2] - r * C[..., 0, 2]) / determinant
        y = (q * C[..., 0, 2] - p * C[..., 1, 2]) / determinant
        mu = -(C[..., 0, 2] * x + C[..., 1, 2] * y + C[..., 2, 2])
        larger = (p + r) / 2 + np.hypot((p - r) / 2, q)  # eigenvalue; determinant / larger is the smaller, without cancellation
        a, b = np.sqrt(mu * larger / determinant), np.sqrt(mu / larger)
        theta = np.arctan2(-2 * q, r - p) / 2
        found = np.stack([x, y, a, b, theta], axis=-1)
    real = (determinant > 0) & (mu > 0) & np.isfinite(found).all(axis=-1)
    return np.where(real[..., None], found, np.nan)


def points_on_ellipse(ellipse: Ellipse, count: int = 36) -> Floats:
    """``count`` points (count, 2) px, evenly spaced in the ellipse's own parameter, from the major axis towards +v."""
    return points_on_parameters(ellipse.parameters, count)


def points_on_parameters(parameters: ArrayLike, count: int = 36) -> Floats:
    """The same for (..., 5): (..., count, 2)."""
    x, y, a, b, theta = (one[..., None] for one in np.moveaxis(np.asarray(parameters, dtype=np.float64), -1, 0))
    t = np.arange(count) * (2 * np.pi / count)
    along, across = a * np.cos(t), b * np.sin(t)
    c, s = np.cos(theta), np.sin(theta)
    return np.stack([x + c * along - s * across, y + s * along + c * across], axis=-1)


def sampson_px(conics: ArrayLike, points_px: ArrayLike) -> Floats:
    """Signed distances (..., n) px of points (..., n, 2) from C (..., 3, 3), to first order; positive outside an ellipse.

    d = pᵀCp / (2 |(Cp)₁₂|) (Sampson 1982); the sign is that of a conic with A + C > 0.
    """
    C = np.asarray(conics, dtype=np.float64)
    C = C * np.sign(C[..., 0, 0] + C[..., 1, 1])[..., None, None]
    points = np.asarray(points_px, dtype=np.float64)
    u, v = points[..., 0], points[..., 1]
    c = C[..., None, :, :]
    gu = c[..., 0, 0] * u + c[..., 0, 1] * v + c[..., 0, 2]
    gv = c[..., 0, 1] * u + c[..., 1, 1] * v + c[..., 1, 2]
    value = gu * u + gv * v + c[..., 0, 2] * u + c[..., 1, 2] * v + c[..., 2, 2]
    return np.asarray(value / (2 * np.maximum(np.hypot(gu, gv), 1e-300)))


def radial_deviation(ellipse: Ellipse, points_px: ArrayLike) -> Floats:
    """Relative radial deviation (n,) of points (n, 2): √((u/a)² + (v/b)²) − 1 in the ellipse's own axes."""
    offset = np.asarray(points_px, dtype=np.float64) - ellipse.centre_px
    c, s = np.cos(ellipse.theta_rad), np.sin(ellipse.theta_rad)
    u, v = c * offset[..., 0] + s * offset[..., 1], c * offset[..., 1] - s * offset[..., 0]
    return np.asarray(np.hypot(u / ellipse.a_px, v / ellipse.b_px) - 1)
