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
_NEXT, _AFTER = [1, 2, 0], [2, 0, 1]
_FAR_RAD = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """Where the LIDAR is at one instant: inertial and orbital axes in its own (3, 3), and the chaser's centre of mass there."""

    lidar_from_inertial: Floats
    lidar_from_lvlh: Floats
    chaser_lidar_m: Floats

    @staticmethod
    def of(chaser: ChaserState, chaser_from_lidar: Floats, chaser_lidar_m: Floats) -> "View":
        """From the chaser's own state at that instant, the LIDAR's axes (3, 3), and the chaser's centre of mass in them."""
        turn = (chaser.inertial_from_chaser.as_matrix() @ chaser_from_lidar).T
        return View(turn, turn @ inertial_from_lvlh(chaser), chaser_lidar_m)

    def rotation(self, state: TumbleState) -> Floats:
        """lidar_from_target (..., 3, 3) as the state has it."""
        return np.asarray(self.lidar_from_inertial @ state.inertial_from_target.as_matrix())

    def origin(self, state: TumbleState, rotation: Floats) -> Floats:
        """l (..., 3): the target's origin in LIDAR axes."""
        return self.chaser_lidar_m + times(rotation, state.offset_m) + times(self.lidar_from_lvlh, state.position_m)


def rotation_vectors(matrices: Floats) -> Floats:
    """Rotation vectors (..., 3) of matrices (..., 3, 3): SciPy's, but several times as fast where no turn is near half a circle."""
    sines = (matrices[..., _AFTER, _NEXT] - matrices[..., _NEXT, _AFTER]) / 2
    sine = np.sqrt((sines * sines).sum(axis=-1))
    angle = np.arctan2(sine, (matrices[..., 0, 0] + matrices[..., 1, 1] + matrices[..., 2, 2] - 1) / 2)
    if not np.all(angle < _FAR_RAD):
        return np.asarray(Rotation.from_matrix(matrices).as_rotvec())
    return sines * (np.where(sine > 0, angle, 1.0) / np.where(sine > 0, sine, 1.0))[..., None]


def sensitivity(lidar_from_target: Floats, lidar_from_lvlh: Floats, offset: Floats) -> Floats:
    """H (..., 6, 26): derivatives of [rotation vector, l] by the errors, from matrices (..., 3, 3) and ρ (..., 3)."""
    H = np.zeros((*offset.shape[:-1], 6, ALL))
    H[..., :3, at.ATTITUDE] = H[..., :3, at.DRIFT_ATTITUDE] = H[..., 3:, at.DRIFT_POSITION] = _EYE_3
    H[..., 3:, at.ATTITUDE] = -lidar_from_target @ cross_matrix(offset)
    H[..., 3:, at.POSITION] = lidar_from_lvlh
    H[..., 3:, at.OFFSET] = lidar_from_target
    return H


def updated(
    state: TumbleState, view: View, measured: Floats, origin_lidar: Floats, R: Floats, gate: float, least_moment: float
) -> tuple[TumbleState, Floats]:
    """The state after a measured lidar_from_target (..., 3, 3) and l (..., 3), covariance ``R`` (6, 6), and its NIS (...).

    A measurement farther than ``gate`` changes nothing. Joseph's form of the covariance (Bucy & Joseph 1968).
    """
    rotation = view.rotation(state)
    H = sensitivity(rotation, view.lidar_from_lvlh, state.offset_m)
    turn = rotation_vectors(rotation.swapaxes(-1, -2) @ measured)
    residual = np.concatenate([turn, origin_lidar - view.origin(state, rotation)], axis=-1) - state.drift
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
