"""The paper's Z→Y→X angles: R_ct = Rx(θ3) Ry(θ2) Rz(θ1) with PASSIVE elementary matrices, target to camera.

Passive: Ry(θ) = [[c, 0, −s], [0, 1, 0], [s, 0, c]] rotates axes, so it turns a body by −θ. The sign of the paper's
θ(t) means something only with this. All functions work over leading batch axes.
"""

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from estimators.mono_rectangle.paper_form import PAPER_FROM_CV
from scenes.arrays import Floats

GIMBAL_TOLERANCE = 1e-12


def rotation_from_zyx(angles_rad: ArrayLike) -> Floats:
    """R_ct, (..., 3, 3), of angles (..., 3) = (θ1 about Z, θ2 about Y, θ3 about X)."""
    theta1, theta2, theta3 = np.moveaxis(np.asarray(angles_rad, dtype=np.float64), -1, 0)
    (c1, s1), (c2, s2), (c3, s3) = ((np.cos(t), np.sin(t)) for t in (theta1, theta2, theta3))
    rows = [
        [c2 * c1, c2 * s1, -s2],
        [s3 * s2 * c1 - c3 * s1, s3 * s2 * s1 + c3 * c1, s3 * c2],
        [c3 * s2 * c1 + s3 * s1, c3 * s2 * s1 - s3 * c1, c3 * c2],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def zyx_from_rotation(R_ct: ArrayLike, gimbal_tolerance: float = GIMBAL_TOLERANCE) -> Floats:
    """(θ1, θ2, θ3), (..., 3), radians, of R_ct (..., 3, 3).

    The paper's two branches with ``arctan`` made ``atan2`` and "|R13| = 1" made a tolerance: at θ2 = ±90° only θ1 ± θ3
    is defined, and θ3 = 0 is chosen. θ2 = atan2(−R13, hypot(R11, R12)) is asin(−R13) without its loss of digits at ±90°.
    """
    R = np.asarray(R_ct, dtype=np.float64)
    theta2 = np.arctan2(-R[..., 0, 2], np.hypot(R[..., 0, 0], R[..., 0, 1]))
    locked = np.abs(R[..., 0, 2]) > 1 - gimbal_tolerance
    theta1 = np.where(locked, np.arctan2(-R[..., 1, 0], R[..., 1, 1]), np.arctan2(R[..., 0, 1], R[..., 0, 0]))
    theta3 = np.where(locked, 0.0, np.arctan2(R[..., 1, 2], R[..., 2, 2]))
    return np.stack([theta1, theta2, theta3], axis=-1)


def zyx_from_cam_rotation(cam_from_target: Rotation) -> Floats:
    """(θ1, θ2, θ3), (..., 3), radians, of a rotation in OpenCV camera axes: R_ct = M R_cv."""
    return zyx_from_rotation(PAPER_FROM_CV @ cam_from_target.as_matrix())


def zyx_covariance(rotation_covariance_cam: ArrayLike, angles_rad: ArrayLike) -> Floats:
    """Covariance of (θ1, θ2, θ3), (..., 3, 3), from that of a small rotation vector in OpenCV camera axes.

    With R_ct → exp([φ]×) R_ct, passive angles give φ = −[Rx Ry e_z, Rx e_y, e_x] d(θ1, θ2, θ3).
    """
    theta3, theta2 = np.asarray(angles_rad)[..., 2], np.asarray(angles_rad)[..., 1]
    zero = np.zeros_like(theta3)
    turned_y = rotation_from_zyx(np.stack([zero, zero, theta3], axis=-1))[..., 1]
    turned_z = rotation_from_zyx(np.stack([zero, theta2, theta3], axis=-1))[..., 2]
    axes = -np.stack([turned_z, turned_y, np.broadcast_to([1.0, 0.0, 0.0], turned_y.shape)], axis=-1)
    angles_from_cam = np.linalg.solve(axes, np.broadcast_to(PAPER_FROM_CV, axes.shape))
    return np.asarray(angles_from_cam @ np.asarray(rotation_covariance_cam) @ np.swapaxes(angles_from_cam, -1, -2))
