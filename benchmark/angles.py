"""The paper's three angles of an attitude: Z → Y → X from target to camera (Zhai et al. 2014, section 1).

The paper's camera frame is X backward, Y right, Z up and its elementary matrices are passive, so
R_ct = Rx(θ3) Ry(θ2) Rz(θ1) with P_paper = M P_cv. θ2 is swept by the in-plane fly-around, θ1 by the out-of-plane one.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from scenes.arrays import Floats, frozen
from scenes.motion import CHASER_FROM_PAPER

PAPER_FROM_CAM = frozen(CHASER_FROM_PAPER.T)
ANGLE_NAMES = ("theta1", "theta2", "theta3")
_ANGLE_OF_AXIS = {"z": "theta1", "y": "theta2", "x": "theta3"}
_GIMBAL_TOLERANCE = 1e-7


def paper_angles(cam_from_target: Rotation) -> Floats:
    """(n, 3) angles θ1, θ2, θ3 in radians of n attitudes, each in (−π, π], θ2 in [−π/2, π/2].

    θ2 = asin(−R13), θ1 = atan2(R12, R11), θ3 = atan2(R23, R33); at |R13| = 1: θ3 = 0, θ1 = atan2(−R21, R22) (the paper's
    two cases, with atan2 for its arctan and a tolerance for its equality).
    """
    r = PAPER_FROM_CAM @ np.atleast_3d(cam_from_target.as_matrix()).reshape(-1, 3, 3)
    locked = np.abs(r[:, 0, 2]) > 1 - _GIMBAL_TOLERANCE
    theta1 = np.where(locked, np.arctan2(-r[:, 1, 0], r[:, 1, 1]), np.arctan2(r[:, 0, 1], r[:, 0, 0]))
    theta2 = np.arcsin(np.clip(-r[:, 0, 2], -1.0, 1.0))
    theta3 = np.where(locked, 0.0, np.arctan2(r[:, 1, 2], r[:, 2, 2]))
    return np.stack([theta1, theta2, theta3], axis=1)


def wrapped(angle_rad: Floats) -> Floats:
    """Angles taken into (−π, π]."""
    return np.asarray(np.pi - np.mod(np.pi - angle_rad, 2 * np.pi))


def angle_of_axis(axis: str) -> str:
    """The name of the angle that a rotation about the target's axis ``axis`` (x, y or z) sweeps."""
    return _ANGLE_OF_AXIS[axis]
