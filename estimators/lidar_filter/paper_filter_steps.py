"""Prediction and update of the paper's filter: an extended Kalman filter after Kim et al. 2007, to which Song et al. 2017 refer.

The attitude is carried in inertial space, R_PA(t + dt) = R_AI(t + dt) R_IA(t) R_PA(t) exp(turn), which solves eqs. (8) and (9)
without the chaser's rate. The sign of q_PA stays continuous, which additive residuals of quaternions live on.
"""

from dataclasses import replace
from math import ceil

import numpy as np
from scipy.spatial.transform import Rotation

from estimators.lidar_filter.chaser import ChaserOrbit, chaser_at, inertial_from_lvlh
from estimators.lidar_filter.paper_filter_equations import (
    STATES,
    PaperState,
    aligned,
    corrected,
    measurement_matrix,
    process_noise,
    system_matrix,
)
from estimators.lidar_filter.paper_filter_parameters import PaperFilterParameters
from estimators.lidar_filter.relative_orbit import relative_jacobian
from estimators.lidar_filter.rigid_body import body_acceleration, turned
from scenes.arrays import Floats
from scenes.recording import ChaserState

_MOST_TURN_RAD = 1e6  # in one step: a filter that has diverged


def predicted(state: PaperState, time_s: float, chaser: ChaserState, parameters: PaperFilterParameters) -> PaperState:
    """The state at ``time_s``, in steps of Φ = 1 + F Δt, eq. (22); the chaser's own state is near that time."""
    span, orbit = time_s - state.time_s, ChaserOrbit.of(chaser)
    steps = ceil(abs(span) / parameters.longest_step_s)
    for index in range(steps):
        h = span / steps
        end_s = time_s if index == steps - 1 else state.time_s + h
        motion = relative_jacobian(orbit.rates_at(state.time_s + h / 2))
        axes = state.body_from_target.as_matrix()
        F = system_matrix(axes, state.omega_body_rad_s, state.ratios, motion, parameters.mended)
        Phi = np.eye(STATES) + F * h
        P = Phi @ state.covariance @ Phi.T + process_noise(Phi, parameters, abs(h))
        state = replace(_moved(state, h, motion, chaser_at(chaser, end_s)), covariance=P, time_s=end_s)
    return state


def _moved(state: PaperState, h: float, motion: Floats, chaser: ChaserState) -> PaperState:
    """The nominal state after one step, fourth order in the rotation and second order in the slow relative path."""
    omega, turn = turned(lambda value: body_acceleration(value, state.ratios), state.omega_body_rad_s, h)
    if not np.abs(turn).max() < _MOST_TURN_RAD:
        return replace(state, omega_body_rad_s=np.full(3, np.nan))
    path = np.concatenate([state.position_m, state.velocity_m_s])
    path = path + h * motion @ (path + h / 2 * motion @ path)
    chaser_turn = (chaser.inertial_from_chaser.inv() * state.inertial_from_chaser).as_rotvec()
    in_target = Rotation.from_rotvec(state.body_from_target.inv().apply(turn))
    return replace(
        state,
        inertial_from_chaser=chaser.inertial_from_chaser,
        chaser_from_target=Rotation.from_rotvec(chaser_turn) * state.chaser_from_target * in_target,
        omega_body_rad_s=omega,
        position_m=path[:3],
        velocity_m_s=path[3:],
    )


def origin(state: PaperState, chaser: ChaserState, lidar_from_chaser: Rotation, chaser_lidar_m: Floats) -> Floats:
    """l (3,) of eq. (25): the target's origin in LIDAR axes."""
    lidar_from_lvlh, lidar_from_target = _axes(state, chaser, lidar_from_chaser)
    return chaser_lidar_m + lidar_from_target @ state.offset_m + lidar_from_lvlh @ state.position_m


def _axes(state: PaperState, chaser: ChaserState, lidar_from_chaser: Rotation) -> tuple[Floats, Floats]:
    """R(q_HC) and R(q_PC)."""
    turn = lidar_from_chaser.as_matrix()
    from_inertial = turn @ chaser.inertial_from_chaser.as_matrix().T
    return from_inertial @ inertial_from_lvlh(chaser), turn @ state.chaser_from_target.as_matrix()


def updated(
    state: PaperState,
    chaser: ChaserState,
    mount: tuple[Rotation, Floats],
    measured: tuple[Rotation, Floats],
    parameters: PaperFilterParameters,
) -> tuple[PaperState | None, float]:
    """The state after a measurement, or None where it broke, and the measurement's squared Mahalanobis length.

    ``mount``: the chaser's axes and centre of mass in LIDAR axes. ``measured``: lidar_from_target, as rotation and l.
    """
    repairs, estimate = parameters.mended, state.chaser_from_target.as_quat()
    quaternion = aligned((mount[0].inv() * measured[0]).as_quat(canonical=True), estimate, repairs)
    residual = np.concatenate([measured[1] - origin(state, chaser, *mount), (quaternion - estimate)[:3]])
    lidar_from_lvlh, lidar_from_target = _axes(state, chaser, mount[0])
    H = measurement_matrix(estimate, lidar_from_target, lidar_from_lvlh, state.offset_m, repairs)
    R = np.diag(np.repeat([parameters.position_variance_m2, parameters.attitude_variance], 3))
    S_inverse = np.linalg.inv(H @ state.covariance @ H.T + R)
    gain = state.covariance @ H.T @ S_inverse
    P = (np.eye(STATES) - gain @ H) @ state.covariance
    return corrected(state, gain @ residual, (P + P.T) / 2, repairs), float(residual @ S_inverse @ residual)
