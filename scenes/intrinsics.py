"""The calibrated pinhole camera with Brown-Conrady distortion, as a value: project, unproject, rays.

Axes are OpenCV's (x right, y down, z forward); pixel coordinates have integers at pixel centres.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from scenes.arrays import Floats, frozen

_UNDISTORT_STEPS = 20
_UNDISTORT_TOLERANCE = 1e-14


@dataclass(frozen=True, slots=True)
class Intrinsics:
    """Calibration of one camera.

    ``fx_px, fy_px, cx_px, cy_px`` in pixels; ``distortion`` = (k1, k2, p1, p2, k3), dimensionless, in OpenCV's order
    (Brown 1971 as in OpenCV's calibration model).
    """

    width_px: int
    height_px: int
    fx_px: float
    fy_px: float
    cx_px: float
    cy_px: float
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)

    @property
    def matrix(self) -> Floats:
        """K, (3, 3): pixel = K · (x/z, y/z, 1) of the distorted normalised point."""
        return frozen(np.array([[self.fx_px, 0.0, self.cx_px], [0.0, self.fy_px, self.cy_px], [0.0, 0.0, 1.0]]))

    @property
    def is_distorted(self) -> bool:
        """Whether any distortion coefficient differs from zero."""
        return any(self.distortion)

    def project(self, points_cam: ArrayLike) -> Floats:
        """Pixels (..., 2) of points (..., 3) in metres in the camera frame; NaN for points that this lens cannot image.

        Those are points not in front of the camera, and points so far aside that the distortion polynomial folds back.
        """
        points = np.asarray(points_cam, dtype=np.float64)
        depth = np.where(points[..., 2] > 0, points[..., 2], np.nan)
        return self.pixels_from_normalised(points[..., :2] / depth[..., None])

    def pixels_from_normalised(self, normalised: ArrayLike) -> Floats:
        """Pixels (..., 2) of ideal normalised image points (x/z, y/z), distortion applied; NaN beyond ``fold_radius``."""
        ideal = np.asarray(normalised, dtype=np.float64)
        bent = self._distort(ideal)
        if self.is_distorted:
            bent = np.where(np.sum(ideal * ideal, axis=-1, keepdims=True) < self.fold_radius**2, bent, np.nan)
        return np.asarray(bent * np.array([self.fx_px, self.fy_px]) + np.array([self.cx_px, self.cy_px]))

    def normalised_from_pixels(self, pixels: ArrayLike) -> Floats:
        """Ideal normalised points (..., 2) of pixels (..., 2): distortion removed by a Newton iteration."""
        centred = np.asarray(pixels, dtype=np.float64) - np.array([self.cx_px, self.cy_px])
        bent = centred / np.array([self.fx_px, self.fy_px])
        return self._undistort(bent) if self.is_distorted else bent

    def rays(self, pixels: ArrayLike) -> Floats:
        """Unit directions (..., 3) in the camera frame of pixels (..., 2)."""
        normalised = self.normalised_from_pixels(pixels)
        directions = np.concatenate([normalised, np.ones_like(normalised[..., :1])], axis=-1)
        return np.asarray(directions / np.linalg.norm(directions, axis=-1, keepdims=True))

    @property
    def fold_radius(self) -> float:
        """Ideal normalised radius up to which the image grows outwards; beyond, the polynomial folds back (inf: never).

        The smallest root of d/dr (r + k1 r³ + k2 r⁵ + k3 r⁷); the tangential terms are small against these.
        """
        k1, k2, _, _, k3 = self.distortion
        squares = np.roots([7 * k3, 5 * k2, 3 * k1, 1.0])
        real = squares.real[(np.abs(squares.imag) < 1e-12) & (squares.real > 0)]
        return float(np.sqrt(real.min(initial=np.inf)))

    def _distort(self, ideal: Floats) -> Floats:
        if not self.is_distorted:
            return ideal
        k1, k2, p1, p2, k3 = self.distortion
        x, y = ideal[..., 0], ideal[..., 1]
        r2 = x * x + y * y
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        return np.stack(
            [
                x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
            ],
            axis=-1,
        )

    def _undistort(self, bent: Floats) -> Floats:
        ideal = bent.copy()
        for _ in range(_UNDISTORT_STEPS):
            residual = self._distort(ideal) - bent
            step = np.linalg.solve(self._distortion_jacobian(ideal), residual[..., None])[..., 0]
            ideal = ideal - step
            if np.nanmax(np.abs(step), initial=0.0) < _UNDISTORT_TOLERANCE:
                break
        return ideal

    def _distortion_jacobian(self, ideal: Floats) -> Floats:
        k1, k2, p1, p2, k3 = self.distortion
        x, y = ideal[..., 0], ideal[..., 1]
        r2 = x * x + y * y
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        slope = 2 * (k1 + r2 * (2 * k2 + 3 * r2 * k3))
        dxx = radial + slope * x * x + 2 * p1 * y + 6 * p2 * x
        dyy = radial + slope * y * y + 6 * p1 * y + 2 * p2 * x
        dxy = slope * x * y + 2 * p1 * x + 2 * p2 * y
        return np.stack([np.stack([dxx, dxy], -1), np.stack([dxy, dyy], -1)], -2)
