"""The filter of Song et al. 2017, as printed or mended: twenty states in the target's principal axes.

``printed`` takes every equation as it stands, and diverges within minutes. Mended, it runs from a first guess that is good enough:
from the paper's own start, 150 % of the truth with its P_0, it settles in a wrong labelling of axes about as often as not.
"""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from estimators.lidar_filter.chaser import chaser_at, inertial_from_lvlh
from estimators.lidar_filter.measurement import Innovation, PoseMeasurement
from estimators.lidar_filter.paper_filter_equations import PaperState
from estimators.lidar_filter.paper_filter_parameters import PaperFilterParameters
from estimators.lidar_filter.paper_filter_solution import paper_extras
from estimators.lidar_filter.paper_filter_steps import origin, predicted, updated
from scenes.arrays import Floats
from scenes.inertia import infeasibility
from scenes.quaternion import rotation
from scenes.recording import ChaserState

_DOF = 6
_BROKEN = "a correction left the filter without a real quaternion, or its state is not a number"


class PaperFilter:
    """``PoseFilter`` with the paper's states. Once broken it stays where it was, and ``is_sound`` says so."""

    def __init__(self, chaser_from_lidar: RigidTransform, parameters: PaperFilterParameters | None = None) -> None:
        """``chaser_from_lidar``: the LIDAR's mount."""
        self._mount = chaser_from_lidar.rotation.inv(), chaser_from_lidar.inv().translation
        self._parameters = parameters or PaperFilterParameters()
        self._broken = False
        self._measured: PaperState | None = None
        self._now: PaperState | None = None

    @property
    def state(self) -> PaperState:
        """The state at the instant of the last call; ``RuntimeError`` before the first measurement."""
        if self._now is None:
            raise RuntimeError("the filter has not been started")
        return self._now

    def guess_fault(self) -> str:
        """Why no body has the inertia that the filter starts from, as a sentence; empty where one has."""
        return infeasibility([1.0, *self._parameters.guess.p])

    def start(self, measurement: PoseMeasurement, chaser: ChaserState) -> None:
        """Begins from the guess and a first measurement's attitude, and takes the measurement in."""
        time_s = self._instant(measurement, chaser)
        there = chaser_at(chaser, time_s)
        self._broken = False
        self._measured = self._now = begun(measurement.lidar_from_target, time_s, there, self._mount, self._parameters)
        self.update(measurement, chaser)

    def predict(self, chaser: ChaserState) -> None:
        """Moves on to ``chaser.time_s`` without a measurement."""
        with np.errstate(all="ignore"):
            self._advanced(predicted(self.state, chaser.time_s, chaser, self._parameters))

    def update(self, measurement: PoseMeasurement, chaser: ChaserState) -> Innovation:
        """Takes a measurement in, as of now or at its own instant, and predicts to ``chaser.time_s``. There is no gate."""
        time_s, last = self._instant(measurement, chaser), self._measured
        if last is None:
            raise RuntimeError("the filter has not been started")
        if self._broken or time_s < last.time_s:
            return Innovation(np.nan, _DOF, False)
        pose = measurement.lidar_from_target
        with np.errstate(all="ignore"):
            prior = predicted(last, time_s, chaser, self._parameters)
            if not self._advanced(prior):
                return Innovation(np.nan, _DOF, False)
            there = chaser_at(chaser, time_s)
            after, nis = updated(prior, there, self._mount, (pose.rotation, pose.translation), self._parameters)
            if self._advanced(after):
                self._measured = self.state
                self._advanced(predicted(self.state, chaser.time_s, chaser, self._parameters))
        return Innovation(nis, _DOF, not self._broken)

    def _advanced(self, state: PaperState | None) -> bool:
        """Whether a new state is one; if so it is the present."""
        self._broken = self._broken or state is None or not state.is_finite()
        self._now = self._now if self._broken else state
        return not self._broken

    def _instant(self, measurement: PoseMeasurement, chaser: ChaserState) -> float:
        return measurement.time_s if self._parameters.at_own_instant else chaser.time_s

    def lidar_from_target(self, chaser: ChaserState) -> RigidTransform:
        """The pose expected at ``chaser.time_s``. The filter stays as it is."""
        with np.errstate(all="ignore"):
            state = predicted(self.state, chaser.time_s, chaser, self._parameters)
        state = state if state.is_finite() else self.state
        place = origin(state, chaser, *self._mount)
        return RigidTransform.from_components(place, self._mount[0] * state.chaser_from_target)

    def extras(self) -> dict[str, float]:
        """States and their 1σ as named numbers; none before the first measurement."""
        return paper_extras(self._now) if self._now is not None else {}

    def is_sound(self) -> str:
        """Empty, or one sentence that says how the filter diverged."""
        if self._broken:
            return _BROKEN
        if self._now is not None and (self._now.ratios <= 0).any():
            return f"the filter's inertia ratios {self._now.ratios[0]:.3g} and {self._now.ratios[1]:.3g} are not both positive"
        return ""


def begun(
    pose: RigidTransform, time_s: float, chaser: ChaserState, mount: tuple[Rotation, Floats], parameters: PaperFilterParameters
) -> PaperState:
    """The guess, with the attitude of a first measured lidar_from_target."""
    guess, variance = parameters.guess, parameters.variance
    attitude = mount[0].inv() * pose.rotation
    inertial = chaser.inertial_from_chaser.apply(mount[0].inv().apply(pose.translation - mount[1]))
    seen = inertial @ inertial_from_lvlh(chaser)
    diagonal = [variance.attitude, variance.omega_rad2_s2, variance.position_m2, variance.velocity_m2_s2]
    a, omega, r, v, b, rho = np.repeat([*diagonal, variance.body_attitude, variance.offset_m2], 3).reshape(6, 3)
    return PaperState(
        time_s=time_s,
        inertial_from_chaser=chaser.inertial_from_chaser,
        chaser_from_target=Rotation.from_quat(attitude.as_quat(canonical=True)),
        omega_body_rad_s=np.array(guess.omega_body_rad_s),
        ratios=np.array(guess.p),
        position_m=seen if guess.position_lvlh_m is None else np.array(guess.position_lvlh_m),
        velocity_m_s=np.array(guess.velocity_lvlh_m_s),
        body_from_target=rotation(guess.body_from_target_wxyz),
        offset_m=np.array(guess.offset_target_m),
        covariance=np.diag(np.concatenate([a, omega, [variance.p] * 2, r, v, b, rho])),
    )
