"""Constant-rate attitude filter: a six-state multiplicative extended Kalman filter on SO(3).

State: cam_from_feature rotation R and the angular velocity ω in camera axes (rad/s); error state (φ, δω) with
R_true = exp([φ]×) R (Markley & Crassidis 2014, § 6.2, with rate as a state instead of a gyro). R turns with
R(t + dt) = exp([ω]× dt) R; the angular acceleration is white noise of density q (rad²/s³) about each axis. It starts from
a straight line through the rotation vectors of the first accepted frames, weighted by their covariances.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from scenes.arrays import Floats


@dataclass(frozen=True, slots=True, eq=False)
class AttitudeSample:
    """One frame's measured rotation, with the covariance (3, 3) rad² of its rotation vector in camera axes."""

    time_s: float
    rotation: Rotation
    covariance: Floats


@dataclass(frozen=True, slots=True, eq=False)
class AttitudeState:
    """``rotation`` camera from feature, ``rate_rad_s`` (3,) in camera axes, ``covariance`` (6, 6) of (φ, δω), at ``time_s``."""

    time_s: float
    rotation: Rotation
    rate_rad_s: Floats
    covariance: Floats


def line_through(samples: Sequence[AttitudeSample]) -> AttitudeState:
    """State at the last sample's time from a weighted least-squares line: log(R_i R_last⁻¹) = φ + (t_i − t_last) ω."""
    last = samples[-1]
    information, moment = np.zeros((6, 6)), np.zeros(6)
    for sample in samples:
        turn = (sample.rotation * last.rotation.inv()).as_rotvec()
        design = np.hstack([np.eye(3), (sample.time_s - last.time_s) * np.eye(3)])
        weighted = design.T @ np.linalg.inv(sample.covariance)
        information += weighted @ design
        moment += weighted @ turn
    covariance = np.asarray(np.linalg.inv(information), dtype=np.float64)
    solution = covariance @ moment
    return AttitudeState(last.time_s, Rotation.from_rotvec(solution[:3]) * last.rotation, solution[3:], covariance)


def predicted(state: AttitudeState, time_s: float, rate_noise_rad2_s3: float) -> AttitudeState:
    """The state at ``time_s``; an earlier time is taken for now."""
    dt = max(time_s - state.time_s, 0.0)
    turn = Rotation.from_rotvec(state.rate_rad_s * dt)
    move = np.eye(6)
    move[:3, :3], move[:3, 3:] = turn.as_matrix(), dt * np.eye(3)
    noise = rate_noise_rad2_s3 * np.kron([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]], np.eye(3))
    return AttitudeState(
        max(time_s, state.time_s), turn * state.rotation, state.rate_rad_s, move @ state.covariance @ move.T + noise
    )


def innovation(state: AttitudeState, sample: AttitudeSample) -> tuple[Floats, float]:
    """Rotation vector (3,) rad from the state to the sample, and its Mahalanobis length in sigmas."""
    turn = (sample.rotation * state.rotation.inv()).as_rotvec()
    spread = state.covariance[:3, :3] + sample.covariance
    return turn, float(np.sqrt(turn @ np.linalg.solve(spread, turn)))


def updated(state: AttitudeState, sample: AttitudeSample) -> AttitudeState:
    """The state after a measurement at its own time (Joseph form)."""
    turn, _ = innovation(state, sample)
    pick = np.eye(3, 6)
    gain = np.linalg.solve(state.covariance[:3, :3] + sample.covariance, pick @ state.covariance).T
    keep = np.eye(6) - gain @ pick
    correction = gain @ turn
    return AttitudeState(
        time_s=state.time_s,
        rotation=Rotation.from_rotvec(correction[:3]) * state.rotation,
        rate_rad_s=state.rate_rad_s + correction[3:],
        covariance=keep @ state.covariance @ keep.T + gain @ sample.covariance @ gain.T,
    )
