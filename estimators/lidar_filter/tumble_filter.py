"""The recommended filter: twenty states in the target's own axes, begun from one measurement of a target not known at all.

It keeps two states: the last measurement's, and the prediction of the present from it. So a scan that arrives late is taken in
at its own instant. Measured attitudes enter as rotations, inertia as five numbers without labels or poles, and measurements
that no such motion explains are refused; after several in a row it is the filter that is doubted.
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import block_diag
from scipy.spatial.transform import RigidTransform, Rotation
from scipy.special import chdtri

from estimators.lidar_filter import tumble_filter_state as at
from estimators.lidar_filter.chaser import ChaserOrbit, chaser_at
from estimators.lidar_filter.filter_extras import tumble_extras
from estimators.lidar_filter.measurement import Innovation, PoseMeasurement
from estimators.lidar_filter.tumble_filter_parameters import TumbleParameters
from estimators.lidar_filter.tumble_filter_prediction import predicted
from estimators.lidar_filter.tumble_filter_state import STATES, TumbleState
from estimators.lidar_filter.tumble_filter_update import View, sensitivity, updated
from scenes.arrays import Floats
from scenes.recording import ChaserState

_DOF = 6
_BLIND_RAD = 1.0  # 1σ of an attitude before its first measurement: large against any


class TumbleFilter:
    """``PoseFilter`` of the target's attitude, rate, inertia, path and centre of mass."""

    def __init__(self, chaser_from_lidar: RigidTransform, parameters: TumbleParameters | None = None) -> None:
        """``chaser_from_lidar``: the LIDAR's mount."""
        self._mount = chaser_from_lidar.rotation.as_matrix(), chaser_from_lidar.inv().translation
        self._parameters = parameters or TumbleParameters()
        gate = self._parameters.measurement.gate
        self._gate = float(chdtri(_DOF, 1 - gate)) if gate < 1 else np.inf
        self._refused = 0
        self._measured: TumbleState | None = None
        self._now: TumbleState | None = None

    @property
    def state(self) -> TumbleState:
        """The state at the instant of the last call; ``RuntimeError`` before the first measurement."""
        if self._now is None:
            raise RuntimeError("the filter has not been started")
        return self._now

    def start(self, measurement: PoseMeasurement, chaser: ChaserState) -> None:
        """Begins from a first measurement alone, and predicts to ``chaser.time_s``."""
        blind = begun(measurement, self._view(chaser, measurement.time_s), self._parameters)
        self._refused = 0
        self._now = self._measured = blind
        self._take(blind, measurement, chaser, np.inf)

    def predict(self, chaser: ChaserState) -> None:
        """Moves on to ``chaser.time_s`` without a measurement."""
        self._now = predicted(self.state, chaser.time_s, ChaserOrbit.of(chaser), self._parameters)

    def update(self, measurement: PoseMeasurement, chaser: ChaserState) -> Innovation:
        """Takes a measurement in at its own instant, and predicts to ``chaser.time_s``; one older than the last is refused."""
        last = self._measured
        if last is None:
            raise RuntimeError("the filter has not been started")
        if measurement.time_s < last.time_s:
            self.predict(chaser)
            return Innovation(np.nan, _DOF, False)
        prior, gate = predicted(last, measurement.time_s, ChaserOrbit.of(chaser), self._parameters), self._gate
        if self._refused >= self._parameters.measurement.patience:
            prior, gate = doubted(prior, self._parameters), np.inf
        nis = self._take(prior, measurement, chaser, gate)
        accepted = bool(np.isfinite(nis)) and nis <= gate
        self._refused = 0 if accepted else self._refused + 1
        return Innovation(nis, _DOF, accepted)

    def _take(self, prior: TumbleState, measurement: PoseMeasurement, chaser: ChaserState, gate: float) -> float:
        """Updates at the measurement's instant, predicts to the present, and returns the squared Mahalanobis length."""
        view = self._view(chaser, measurement.time_s)
        pose, (R, lasting) = measurement.lidar_from_target.as_matrix(), stated(measurement.covariance, self._parameters)
        after, nis = updated(prior, view, pose[:3, :3], pose[:3, 3], R, gate, self._parameters.least_moment)
        self._measured = replace(after, drift_spread=lasting) if nis <= gate else after
        self._now = predicted(self._measured, chaser.time_s, ChaserOrbit.of(chaser), self._parameters)
        return float(nis)

    def lidar_from_target(self, chaser: ChaserState) -> RigidTransform:
        """The pose expected at ``chaser.time_s``. The filter stays as it is."""
        state = predicted(self.state, chaser.time_s, ChaserOrbit.of(chaser), self._parameters, mean_only=True)
        view = View.of(chaser, *self._mount)
        rotation = view.rotation(state)
        return RigidTransform.from_components(view.origin(state, rotation), Rotation.from_matrix(rotation))

    def extras(self) -> dict[str, float]:
        """States and their 1σ as named numbers; none before the first measurement."""
        state = self._now
        if state is None:
            return {}
        P = state.covariance[:STATES, :STATES]
        return tumble_extras(state.omega_rad_s, state.J, state.position_m, state.velocity_m_s, state.offset_m, P)

    def pose_sigma(self, chaser: ChaserState) -> tuple[float, float]:
        """1σ of ``lidar_from_target`` now, along its worst axes: attitude (rad), and the target's origin (m)."""
        state, view = self.state, View.of(chaser, *self._mount)
        H = sensitivity(view.rotation(state), view.lidar_from_lvlh, state.offset_m)[:, :STATES]
        P = H @ state.covariance[:STATES, :STATES] @ H.T
        rotation, position = (float(np.sqrt(np.linalg.eigvalsh(P[part, part])[-1])) for part in (slice(0, 3), slice(3, 6)))
        return rotation, position

    def is_sound(self) -> str:
        """Empty, or one sentence that says how the filter diverged."""
        return fault(self.state) if self._now is not None else ""

    def _view(self, chaser: ChaserState, time_s: float) -> View:
        return View.of(chaser_at(chaser, time_s), *self._mount)


def _ignorance(parameters: TumbleParameters) -> Floats:
    """Covariance (20, 20) of what is not known before anything is measured."""
    start, sigma = parameters.start, np.zeros(STATES)
    sigma[at.ATTITUDE], sigma[at.OMEGA], sigma[at.INERTIA] = _BLIND_RAD, start.omega_rad_s, start.inertia
    sigma[at.POSITION], sigma[at.VELOCITY], sigma[at.OFFSET] = start.range_m, start.velocity_m_s, start.offset_m
    return np.diag(sigma**2)


def begun(measurement: PoseMeasurement, view: View, parameters: TumbleParameters) -> TumbleState:
    """Measured attitude, centre of mass at the frame's origin, no motion, a sphere; with the covariance of ignorance."""
    pose = measurement.lidar_from_target
    position = (pose.translation - view.chaser_lidar_m) @ view.lidar_from_lvlh
    zero, j, drift = (np.zeros((*position.shape[:-1], size)) for size in (3, 5, 6))
    attitude = Rotation.from_matrix(view.lidar_from_inertial.T @ pose.rotation.as_matrix())
    _, lasting = stated(measurement.covariance, parameters)
    covariance = block_diag(_ignorance(parameters), lasting)
    return TumbleState(measurement.time_s, attitude, zero, j, position, zero, zero, drift, lasting, covariance)


def doubted(state: TumbleState, parameters: TumbleParameters) -> TumbleState:
    """A state that measurements contradict: motion is forgotten, inertia and centre of mass are half as sure."""
    ignorance = _ignorance(parameters)
    for kept in (at.INERTIA, at.OFFSET):
        ignorance[kept, kept] = 0.0
    return replace(state, covariance=4 * state.covariance + block_diag(ignorance, np.zeros((6, 6))))


def stated(covariance: Floats, parameters: TumbleParameters) -> tuple[Floats, Floats]:
    """Covariances (6, 6) of a registration's fresh error and of its lasting one, from what the registration states."""
    measurement = parameters.measurement
    floor = np.diag(np.repeat([measurement.floor_rad**2, measurement.floor_m**2], 3))
    drift = np.diag(np.repeat([measurement.drift_rad**2, measurement.drift_m**2], 3))
    scaled = covariance * measurement.scale
    return (1 - measurement.lasting) * scaled + floor, measurement.lasting * scaled + drift


def fault(state: TumbleState) -> str:
    """Why a state is of no use, as a sentence; empty where it is fine."""
    if not (np.isfinite(state.omega_rad_s).all() and np.isfinite(state.covariance).all()):
        return "the filter's state is not a number"
    diagonal = np.diagonal(state.covariance)[:STATES]
    if (diagonal <= 0).any():
        return f"the filter's covariance is not positive: its least variance is {diagonal.min():.3g}"
    return ""
