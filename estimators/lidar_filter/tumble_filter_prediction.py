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
from estimators.lidar_filter.relative_orbit import OrbitRates, relative_jacobian
from estimators.lidar_filter.rigid_body import angular_acceleration, angular_jacobians, cross_matrix, times, turned
from estimators.lidar_filter.tumble_filter_parameters import TumbleParameters
from estimators.lidar_filter.tumble_filter_state import ALL, STATES, TumbleState
from scenes.arrays import Floats
from scenes.inertia import inertia_of

_NOISY = [*range(3, 6), *range(14, 17)]  # ω and v
_EYE, _EYE_3 = np.eye(STATES), np.eye(3)
_MOST_STEPS = 1000


def predicted(
    state: TumbleState, time_s: float, orbit: ChaserOrbit, parameters: TumbleParameters, mean_only: bool = False
) -> TumbleState:
    """The state at ``time_s``, also an earlier one with ``mean_only``, which leaves the covariance as it is."""
    span = time_s - state.time_s
    steps = _steps(abs(span), state.omega_rad_s, parameters)
    for index in range(steps):
        h = span / steps
        rates = orbit.rates_at(state.time_s + h / 2)
        after = _moved(state, h, rates, parameters.measurement.drift_time_s)
        covariance = state.covariance if mean_only else _spread(state, after, h, rates, parameters)
        state = replace(after, covariance=covariance, time_s=time_s if index == steps - 1 else after.time_s)
    return state


def _steps(span_s: float, omega: Floats, parameters: TumbleParameters) -> int:
    """How many steps a span is divided into; a filter that diverges shall not stop the clock."""
    fastest = float(np.sqrt(np.max(np.sum(omega**2, axis=-1))))
    turns = min(fastest * span_s / parameters.longest_turn_rad, _MOST_STEPS) if np.isfinite(fastest) else 0.0
    return max(ceil(span_s / parameters.longest_step_s), ceil(turns))


def _moved(state: TumbleState, h: float, rates: OrbitRates, drift_time_s: float) -> TumbleState:
    """The mean after one step."""
    J = state.J
    inverse = _inverse(J)
    omega, turn = turned(lambda value: angular_acceleration(value, J, inverse), state.omega_rad_s, h)
    path = np.concatenate([state.position_m, state.velocity_m_s], axis=-1)
    path = times(_series(relative_jacobian(rates) * h, np.eye(6)), path)
    return replace(
        state,
        time_s=state.time_s + h,
        inertial_from_target=state.inertial_from_target * Rotation.from_rotvec(turn),
        omega_rad_s=omega,
        position_m=path[..., :3],
        velocity_m_s=path[..., 3:],
        drift=state.drift * exp(-h / drift_time_s),
    )


def _inverse(J: Floats) -> Floats:
    return np.asarray(np.linalg.inv(J), dtype=np.float64)


def error_matrix(omega: Floats, inertia: Floats, rates: OrbitRates) -> Floats:
    """F (..., 20, 20) of the errors' rates."""
    J = inertia_of(inertia)
    slope, by_inertia = angular_jacobians(omega, J, _inverse(J))
    F = np.zeros((*omega.shape[:-1], STATES, STATES))
    F[..., at.ATTITUDE, at.ATTITUDE] = -cross_matrix(omega)
    F[..., at.ATTITUDE, at.OMEGA] = _EYE_3
    F[..., at.OMEGA, at.OMEGA] = slope
    F[..., at.OMEGA, at.INERTIA] = by_inertia
    F[..., at.TRANSLATION, at.TRANSLATION] = relative_jacobian(rates)
    return F


def _series(step: Floats, eye: Floats) -> Floats:
    """exp(step) to fourth order, in Horner's form."""
    value = eye + step / 4
    for order in (3, 2, 1):
        value = eye + step @ value / order
    return value


def _spread(before: TumbleState, after: TumbleState, h: float, rates: OrbitRates, parameters: TumbleParameters) -> Floats:
    """Covariance after one step: Φ P Φᵀ + Q, with Q = ∫ Φ G Φᵀ by Simpson's rule for white accelerations of density G."""
    F = error_matrix((before.omega_rad_s + after.omega_rad_s) / 2, before.inertia, rates)
    noise, measurement = parameters.noise, parameters.measurement
    root = np.sqrt([noise.rotation_rad2_s3] * 3 + [noise.translation_m2_s3] * 3)
    whole, half = _series(F * h, _EYE), _series(F * (h / 2), _EYE)
    early, middle = whole[..., _NOISY] * root, half[..., _NOISY] * root
    Q = h / 6 * (early @ early.swapaxes(-1, -2) + 4 * (middle @ middle.swapaxes(-1, -2)))
    Q[..., _NOISY, _NOISY] += h / 6 * root**2
    kept = exp(-h / measurement.drift_time_s)
    Phi = np.zeros((*Q.shape[:-2], ALL, ALL))
    Phi[..., :STATES, :STATES] = whole
    Phi[..., range(STATES, ALL), range(STATES, ALL)] = kept
    P = Phi @ before.covariance @ Phi.swapaxes(-1, -2)
    P[..., :STATES, :STATES] += Q
    drift = np.repeat([measurement.drift_rad**2, measurement.drift_m**2], 3)
    P[..., range(STATES, ALL), range(STATES, ALL)] += (1 - kept**2) * drift
    return np.asarray(P)
