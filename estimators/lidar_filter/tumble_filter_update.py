"""Update with a registration: the pose that it measured against the pose that the state predicts, Song et al. 2017, eq. (25).

l = l_A + R ρ + R_CH r, with R = lidar_from_target, and the chaser's centre of mass at l_A in LIDAR axes. The attitude's residual
is the rotation vector log(R̂ᵀ R), which has no sign to choose and no singularity near the estimate.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from estimators.lidar_filter import tumble_filter_state as at
from estimators.lidar_filter.chaser import inertial_from_lvlh
from estimators.lidar_filter.rigid_body import cross_matrix, times
from estimators.lidar_filter.tumble_filter_state import ALL, TumbleState
from scenes.arrays import Floats
from scenes.recording import ChaserState

_EYE, _EYE_3 = np.eye(ALL), np.eye(3)


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """Where the LIDAR is at one instant: its axes, those of the orbital frame in them, and the chaser's centre of mass there."""

    inertial_from_lidar: Rotation
    lidar_from_inertial: Floats
    lidar_from_lvlh: Floats
    chaser_lidar_m: Floats

    @staticmethod
    def of(chaser: ChaserState, chaser_from_lidar: Rotation, chaser_lidar_m: Floats) -> "View":
        """From the chaser's own state at that instant, the LIDAR's axes, and the chaser's centre of mass in them."""
        turn = chaser.inertial_from_chaser * chaser_from_lidar
        back = turn.as_matrix().T
        return View(turn, back, back @ inertial_from_lvlh(chaser), chaser_lidar_m)

    def rotation(self, state: TumbleState) -> Floats:
        """lidar_from_target (..., 3, 3) as the state has it."""
        return np.asarray(self.lidar_from_inertial @ state.inertial_from_target.as_matrix())

    def origin(self, state: TumbleState, rotation: Floats) -> Floats:
        """l (..., 3): the target's origin in LIDAR axes."""
        return self.chaser_lidar_m + times(rotation, state.offset_m) + times(self.lidar_from_lvlh, state.position_m)


def sensitivity(lidar_from_target: Floats, lidar_from_lvlh: Floats, offset: Floats) -> Floats:
    """H (..., 6, 26): derivatives of [rotation vector, l] by the errors, from matrices (..., 3, 3) and ρ (..., 3)."""
    H = np.zeros((*offset.shape[:-1], 6, ALL))
    H[..., :3, at.ATTITUDE] = H[..., :3, at.DRIFT_ATTITUDE] = H[..., 3:, at.DRIFT_POSITION] = _EYE_3
    H[..., 3:, at.ATTITUDE] = -lidar_from_target @ cross_matrix(offset)
    H[..., 3:, at.POSITION] = lidar_from_lvlh
    H[..., 3:, at.OFFSET] = lidar_from_target
    return H


def updated(
    state: TumbleState, view: View, measured: Rotation, origin_lidar: Floats, R: Floats, gate: float, least_moment: float
) -> tuple[TumbleState, Floats]:
    """The state after a measured pose with covariance ``R`` (6, 6), and its squared Mahalanobis length (...).

    A measurement farther than ``gate`` changes nothing. Joseph's form of the covariance (Bucy & Joseph 1968).
    """
    rotation = view.rotation(state)
    H = sensitivity(rotation, view.lidar_from_lvlh, state.offset_m)
    turn = state.inertial_from_target.inv() * (view.inertial_from_lidar * measured)
    residual = np.concatenate([turn.as_rotvec(), origin_lidar - view.origin(state, rotation)], axis=-1) - state.drift
    P = state.covariance
    cross = P @ H.swapaxes(-1, -2)
    S_inverse = np.asarray(np.linalg.inv(H @ cross + R), dtype=np.float64)
    nis = np.sum(residual * times(S_inverse, residual), axis=-1)
    accepted = np.asarray((nis <= gate) & np.isfinite(nis))  # a choice and no product: what is refused may be no number
    gain = cross @ S_inverse
    keep = _EYE - gain @ H
    joseph = keep @ P @ keep.swapaxes(-1, -2) + gain @ R @ gain.swapaxes(-1, -2)
    P = np.where(accepted[..., None, None], (joseph + joseph.swapaxes(-1, -2)) / 2, P)
    return state.corrected(np.where(accepted[..., None], times(gain, residual), 0.0), P, least_moment), nis
