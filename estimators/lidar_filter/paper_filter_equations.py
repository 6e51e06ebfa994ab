"""Song et al. 2017, equations (8) to (26), for one target: state, matrices and correction, with each misprint beside its repair.

Errors, eq. (13): a (vector part of δq_PA), δω_B, δp, δr, δv, b (vector part of δq_PB), δρ, with q = q̂ ⊗ δq, so that a and b are
half angles in target axes. At the estimate all δ are zero, so eqs. (15) to (17) are taken there. Eq. (17) is ∂/∂b, as F_p says.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from estimators.lidar_filter.paper_filter_parameters import PaperFilterParameters, Repairs
from estimators.lidar_filter.rigid_body import body_jacobians, cross_matrix
from scenes.arrays import Floats

ATTITUDE, OMEGA, RATIOS, POSITION, VELOCITY = slice(0, 3), slice(3, 6), slice(6, 8), slice(8, 11), slice(11, 14)
BODY, OFFSET, TRANSLATION = slice(14, 17), slice(17, 20), slice(8, 14)
STATES = 20


@dataclass(frozen=True, slots=True, eq=False)
class PaperState:
    """What is known at ``time_s``.

    ``chaser_from_target``, ``body_from_target``: q_PA, q_PB. ``inertial_from_chaser``: the chaser's own attitude at that time.
    ``omega_body_rad_s`` (3,), ``ratios`` p (2,), ``position_m`` and ``velocity_m_s`` (3,) in the chaser's orbital frame,
    ``offset_m`` ρ (3,) in target axes, ``covariance`` (20, 20).
    """

    time_s: float
    inertial_from_chaser: Rotation
    chaser_from_target: Rotation
    omega_body_rad_s: Floats
    ratios: Floats
    position_m: Floats
    velocity_m_s: Floats
    body_from_target: Rotation
    offset_m: Floats
    covariance: Floats

    def is_finite(self) -> bool:
        """Whether every number of it is one."""
        numbers = (self.omega_body_rad_s, self.ratios, self.position_m, self.velocity_m_s, self.offset_m, self.covariance)
        quaternions = (self.chaser_from_target.as_quat(), self.body_from_target.as_quat())
        return all(np.isfinite(values).all() for values in (*numbers, *quaternions))


def system_matrix(body_from_target: Floats, omega_body: Floats, ratios: Floats, motion: Floats, repairs: Repairs) -> Floats:
    """F (20, 20) of eq. (21), from R(q_PB), ω_B, p and F_t (6, 6)."""
    F = np.zeros((STATES, STATES))
    W = cross_matrix(body_from_target.T @ omega_body)
    F[ATTITUDE, ATTITUDE], F[ATTITUDE, BODY] = -W, W
    F[ATTITUDE, OMEGA] = (0.5 if repairs.omega_sign else -0.5) * body_from_target.T
    F[OMEGA, OMEGA], F[OMEGA, RATIOS] = body_jacobians(omega_body, ratios)
    F[TRANSLATION, TRANSLATION] = motion
    return F


def process_noise(Phi: Floats, parameters: PaperFilterParameters, dt: float) -> Floats:
    """Q (20, 20) of eq. (23); as printed the two noises change places."""
    densities = [parameters.rotation_noise_rad2_s3, parameters.translation_noise_m2_s3]
    if not parameters.mended.noise_order:
        densities.reverse()
    driven = np.concatenate([Phi[:, OMEGA], Phi[:, VELOCITY]], axis=1)  # Φ Γ
    return np.asarray(driven * np.repeat(densities, 3) @ driven.T * dt)


def measurement_matrix(
    quaternion: Floats, lidar_from_target: Floats, lidar_from_lvlh: Floats, offset: Floats, repairs: Repairs
) -> Floats:
    """H (6, 20) of eq. (26), from q_PA = [q_v, q_0], R(q_PC), R(q_HC) and ρ."""
    H = np.zeros((6, STATES))
    H[:3, ATTITUDE] = (-2 if repairs.half_angle else -1) * lidar_from_target @ cross_matrix(offset)
    H[:3, POSITION], H[:3, OFFSET] = lidar_from_lvlh, lidar_from_target
    H[3:, ATTITUDE] = cross_matrix(quaternion[:3]) + quaternion[3] * np.eye(3)
    return H


def aligned(quaternion: Floats, estimate: Floats, repairs: Repairs) -> Floats:
    """The measured quaternion (4,), or its negative if that is the same rotation nearer to the estimate (4,)."""
    return -quaternion if repairs.sign_alignment and quaternion @ estimate < 0 else quaternion


def turned_by(rotation: Rotation, half_turn: Floats, repairs: Repairs) -> Rotation | None:
    """q̂ ⊗ [a, √(1 − |a|²)]; None where the root is of a negative number and nothing mends it."""
    square = float(half_turn @ half_turn)
    if not square <= 1:
        if not (repairs.unit_correction and np.isfinite(square)):
            return None
        half_turn, square = half_turn / np.sqrt(square), 1.0
    return rotation * Rotation.from_quat([*half_turn, np.sqrt(max(1 - square, 0.0))])


def corrected(state: PaperState, error: Floats, covariance: Floats, repairs: Repairs) -> PaperState | None:
    """The state with estimated errors (20,) taken out; None where a quaternion cannot take them."""
    attitude = turned_by(state.chaser_from_target, error[ATTITUDE], repairs)
    body = turned_by(state.body_from_target, error[BODY], repairs)
    if attitude is None or body is None:
        return None
    return PaperState(
        time_s=state.time_s,
        inertial_from_chaser=state.inertial_from_chaser,
        chaser_from_target=attitude,
        omega_body_rad_s=state.omega_body_rad_s + error[OMEGA],
        ratios=state.ratios + error[RATIOS],
        position_m=state.position_m + error[POSITION],
        velocity_m_s=state.velocity_m_s + error[VELOCITY],
        body_from_target=body,
        offset_m=state.offset_m + error[OFFSET],
        covariance=covariance,
    )
