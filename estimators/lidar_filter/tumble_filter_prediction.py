"""Prediction: the mean by fourth-order steps, its error by the transition matrix of the linearised equations.

Right attitude error: θ̇ = −ω × θ + δω; δω̇ = (∂ω̇/∂ω) δω + (∂ω̇/∂j) δj; r and v by Song et al. 2017, eq. (2); j and ρ rest; a lasting
error of the measurements decays. In steps short enough the matrix at mid-step is a constant, and exp(F h) is its series.
"""

from dataclasses import replace
from math import ceil, exp

import numpy as np
from scipy.spatial.transform import Rotation

from estimators.lidar_filter import tumble_filter_state as at
from estimators.lidar_filter.chaser import ChaserOrbit
from estimators.lidar_filter.relative_orbit import relative_jacobian
from estimators.lidar_filter.rigid_body import (
    angular_jacobians,
    angular_quadratic,
    cross_matrix,
    quadratic,
    quadratic_form,
    times,
    turned,
)
from estimators.lidar_filter.tumble_filter_parameters import TumbleParameters
from estimators.lidar_filter.tumble_filter_state import STATES, TumbleState
from scenes.arrays import Floats

_NOISY = np.array([*range(3, 6), *range(14, 17)])  # ω and v
_EYE, _EYE_3, _EYE_6 = np.eye(STATES), np.eye(3), np.eye(6)
_MOST_STEPS, _TINY = 1000, 1e-300
_QUADRATIC = slice(3, 11)  # ω and j


def predicted(
    state: TumbleState, time_s: float, orbit: ChaserOrbit, parameters: TumbleParameters, mean_only: bool = False
) -> TumbleState:
    """The state at ``time_s``, also an earlier one with ``mean_only``, which leaves the covariance as it is."""
    span = time_s - state.time_s
    steps = _steps(abs(span), state.omega_rad_s, parameters)
    if not steps:
        return state
    h, J, start_s = span / steps, state.J, state.time_s
    inverse = np.asarray(np.linalg.inv(J), dtype=np.float64)
    form, kept = quadratic_form(J, inverse), exp(-h / parameters.measurement.drift_time_s)
    for index in range(steps):
        motion = relative_jacobian(orbit.rates_at(start_s + (index + 0.5) * h))
        after = _moved(state, h, form, motion, kept)
        if not mean_only:
            F = error_matrix((state.omega_rad_s + after.omega_rad_s) / 2, J, inverse, motion)
            gained = _second_order(state, J, inverse, F, h, parameters)
            after = replace(after, covariance=_spread(state, F, h, kept, parameters, gained))
        state = after
    return replace(state, time_s=time_s)


def _steps(span_s: float, omega: Floats, parameters: TumbleParameters) -> int:
    """How many steps a span is divided into; a filter that diverges shall not stop the clock."""
    fastest = float(np.sqrt((omega * omega).sum(axis=-1).max()))
    turns = min(fastest * span_s / parameters.longest_turn_rad, _MOST_STEPS) if np.isfinite(fastest) else 0.0
    return max(ceil(span_s / parameters.longest_step_s), ceil(turns))


def _moved(state: TumbleState, h: float, form: Floats, motion: Floats, kept: float) -> TumbleState:
    """The mean after one step, with the covariance of before."""
    omega, turn = turned(lambda value: quadratic(form, value), state.omega_rad_s, h)
    path = times(_series(motion * h, _EYE_6), np.concatenate([state.position_m, state.velocity_m_s], axis=-1))
    return TumbleState(
        time_s=state.time_s + h,
        inertial_from_target=state.inertial_from_target * Rotation.from_rotvec(turn),
        omega_rad_s=omega,
        inertia=state.inertia,
        position_m=path[..., :3],
        velocity_m_s=path[..., 3:],
        offset_m=state.offset_m,
        drift=state.drift * kept,
        drift_spread=state.drift_spread,
        covariance=state.covariance,
    )


def error_matrix(omega: Floats, J: Floats, inverse: Floats, motion: Floats) -> Floats:
    """F (..., 20, 20) of the errors' rates, from ω, J and its inverse, and F_t (6, 6) of the relative motion."""
    slope, by_inertia = angular_jacobians(omega, J, inverse)
    F = np.zeros((*omega.shape[:-1], STATES, STATES))
    F[..., at.ATTITUDE, at.ATTITUDE] = -cross_matrix(omega)
    F[..., at.ATTITUDE, at.OMEGA] = _EYE_3
    F[..., at.OMEGA, at.OMEGA] = slope
    F[..., at.OMEGA, at.INERTIA] = by_inertia
    F[..., at.TRANSLATION, at.TRANSLATION] = motion
    return F


def _series(step: Floats, eye: Floats) -> Floats:
    """exp(step) to fourth order, in Horner's form."""
    value = eye + step / 4
    for order in (3, 2, 1):
        value = eye + step @ value / order
    return value


def _second_order(state: TumbleState, J: Floats, inverse: Floats, F: Floats, h: float, parameters: TumbleParameters) -> Floats:
    """Variance (..., 3, 3) that ω gains in a step from what is quadratic in the errors of ω and j, taken for white noise.

    The quadratic form xᵀBx of a Gaussian error has the covariance 2 tr(B_i P B_j P) (Athans et al. 1968). It stays for about
    1 / |ω|. While little is known of the inertia it is the largest error; yet ω is never less known for it than at the start.
    """
    P, noise = state.covariance[..., _QUADRATIC, _QUADRATIC], parameters.noise
    slope, by_inertia = F[..., at.OMEGA, at.OMEGA], F[..., at.OMEGA, at.INERTIA]
    BP = angular_quadratic(state.omega_rad_s, J, inverse, slope, by_inertia) @ P[..., None, :, :]
    flat = BP.reshape((*BP.shape[:-2], 64))
    both = flat @ BP.swapaxes(-1, -2).reshape(flat.shape).swapaxes(-1, -2)  # tr(B_i P B_j P)
    slowest = np.maximum((state.omega_rad_s**2).sum(axis=-1), noise.remembered_s**-2)
    gained = 2 * noise.second_order * abs(h) / np.sqrt(slowest)[..., None, None] * both
    room = 3 * parameters.start.omega_rad_s**2 - np.trace(P[..., :3, :3], axis1=-2, axis2=-1)
    wanted = np.trace(gained, axis1=-2, axis2=-1)
    return np.asarray(gained * (np.clip(room, 0.0, wanted) / np.maximum(wanted, _TINY))[..., None, None])


def _spread(state: TumbleState, F: Floats, h: float, kept: float, parameters: TumbleParameters, gained: Floats) -> Floats:
    """Covariance (..., 26, 26) after one step: Φ P Φᵀ + Q, and a drift that forgets all but the share ``kept``."""
    half = _series(F * (h / 2), _EYE)
    whole = half @ half
    P, after = state.covariance, np.empty((*F.shape[:-2], at.ALL, at.ALL))
    after[..., :STATES, :STATES] = whole @ P[..., :STATES, :STATES] @ whole.swapaxes(-1, -2) + _noise(whole, half, h, parameters)
    after[..., at.OMEGA, at.OMEGA] += gained
    after[..., :STATES, at.DRIFT] = across = kept * (whole @ P[..., :STATES, at.DRIFT])
    after[..., at.DRIFT, :STATES] = across.swapaxes(-1, -2)
    after[..., at.DRIFT, at.DRIFT] = kept**2 * P[..., at.DRIFT, at.DRIFT] + (1 - kept**2) * state.drift_spread
    return after


def _noise(whole: Floats, half: Floats, h: float, parameters: TumbleParameters) -> Floats:
    """Q (..., 20, 20) = ∫ Φ G Φᵀ of white accelerations with density G, by Simpson's rule."""
    noise = parameters.noise
    density = np.repeat([noise.rotation_rad2_s3, noise.translation_m2_s3], 3)
    early, middle = whole[..., _NOISY], half[..., _NOISY]
    Q = (h / 6 * density * early) @ early.swapaxes(-1, -2) + (2 * h / 3 * density * middle) @ middle.swapaxes(-1, -2)
    Q[..., _NOISY, _NOISY] += h / 6 * density
    return Q
