"""The target's axes from what was measured: Shu et al. 2020, eqs (8)-(10) and (13), mended.

Eq. (8): n_x = (X1 − X0)/|X1 − X0| is perpendicular to the ring's normal only for a marker in the ring's plane (one 0.1 m below
it, 0.31 m out, turns n_x by 18° and makes the matrix no rotation); the direction is projected into the plane first.
Eq. (13): n_z is used before it is defined, is no unit vector and may look away from the camera; here it is the normal of the
three markers, turned to the camera. Eq. (10): arctan(a, b) is atan2; since the normal faces the camera, θx is near ±180° and its
differences jump by 360°, so motion between frames is the rotation R_tᵀ R_(t+1), not a difference of angles.
"""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.arrays import Floats

_SMALLEST_SINE = 1e-6


def ring_frame(centre_m: Floats, normal: Floats, marker_m: Floats) -> RigidTransform | None:
    """left_from_ring, eqs (8) and (9): origin ``centre_m``, Z ``normal`` turned to the camera, X towards ``marker_m``.

    All (3,), left camera axes. None if the marker lies on the ring's axis.
    """
    z = normal if normal @ centre_m < 0 else -normal
    return _frame(centre_m, z / np.linalg.norm(z), marker_m - centre_m)


def marker_frame(b0_m: Floats, b1_m: Floats, b2_m: Floats) -> RigidTransform | None:
    """left_from_markers, eq. (13) mended: origin B0, X towards B1, Z the normal of the three, turned to the camera.

    All (3,), left camera axes. None if the three are on one line.
    """
    first, second = b1_m - b0_m, b2_m - b0_m
    z = np.cross(first, second)
    length = float(np.linalg.norm(z))
    if not length > _SMALLEST_SINE * float(np.linalg.norm(first) * np.linalg.norm(second)):
        return None
    return _frame(b0_m, (z if z @ b0_m < 0 else -z) / length, first)


def angles_xyz_rad(rotation: Rotation) -> Floats:
    """(θx, θy, θz) of R = Rz Ry Rx, eq. (10) with atan2."""
    return np.asarray(rotation.as_euler("ZYX")[::-1])


def rotation_between(before: Rotation, after: Rotation) -> Rotation:
    """The target's turn between two frames in its own axes, R_tᵀ R_(t+1)."""
    return before.inv() * after


def _frame(origin_m: Floats, z: Floats, towards: Floats) -> RigidTransform | None:
    flat = towards - (towards @ z) * z
    length = float(np.linalg.norm(flat))
    if not length > _SMALLEST_SINE * float(np.linalg.norm(towards)):
        return None
    x = flat / length
    return RigidTransform.from_components(origin_m, Rotation.from_matrix(np.stack([x, np.cross(z, x), z], axis=1)))
