"""``lidar-ekf-paper``: the method of Song et al. 2017, figure 2. ICP gives a rough pose, the filter takes it in, its prediction is
where the next ICP starts.

What the paper leaves open is done as for ``lidar-ekf``: the first pose is looked for over all attitudes, and a scan is laid over
the part of the reference that can be seen. Where ICP does not come to rest from a prediction, it starts again from its last pose.
"""

from scipy.spatial.transform import RigidTransform

from estimators.api import Estimate, Outcome
from estimators.lidar_filter.answers import icp_extras
from estimators.lidar_filter.measurement import PoseMeasurement
from estimators.lidar_filter.paper_filter import PaperFilter
from estimators.lidar_filter.paper_parameters import PaperLidarParameters
from estimators.lidar_filter.reference import Reference, reference_for
from estimators.lidar_filter.registration import Registration, register
from estimators.lidar_filter.setting import Setting, setting_from
from estimators.stopwatch import Stopwatch
from scenes.arrays import Floats
from scenes.recording import ChaserState, Knowledge, Observation

_LEAST_OVERLAP = 0.3  # of a registration that counts as one


class PaperLidarEkf:
    """The estimator; keyword arguments override ``PaperLidarParameters``."""

    def __init__(self, **parameters: object) -> None:
        """Raises ``pydantic.ValidationError`` for an unknown or impossible parameter."""
        self.parameters = PaperLidarParameters.model_validate(parameters)

    def start(self, knowledge: Knowledge) -> None:
        """Raises ``ValueError`` if no LIDAR is told of, or no model where the reference is to be one."""
        self._setting: Setting = setting_from(knowledge)
        self._filter = PaperFilter(self._setting.lidar.chaser_from_lidar, self.parameters.filter)
        self._reference: Reference = reference_for(self._setting, self.parameters.of_reference)
        self._last: RigidTransform | None = None  # of the last registration, lidar_from_own; None before the first
        self._missed = 0

    def step(self, observation: Observation) -> Estimate:
        """One scan: ICP from the prediction, then the filter."""
        returns = self._setting.returns(observation)
        if isinstance(returns, str):
            return self._failed(Outcome.SKIPPED, returns, {})
        fault = "" if self._last is None else self._filter.is_sound()
        if fault:  # the paper knows no way back
            return self._failed(Outcome.DIVERGED, fault, {})
        watch, (now, then) = Stopwatch(), self._setting.chaser(observation)
        if len(returns) < self.parameters.registration.least_points:
            reason = f"{len(returns)} beams came back"
            return self._failed(Outcome.NO_FEATURES, reason, {}) if self._last is None else self._missing(reason, now, watch)
        found = self._registered(returns.points_lidar, then)
        watch.ends("icp")
        if isinstance(found, str):
            return self._failed(Outcome.NOT_CONVERGED, found, {}) if self._last is None else self._missing(found, now, watch)
        return self._followed(found, returns.points_lidar, now, then, watch)

    def _registered(self, points_lidar: Floats, then: ChaserState) -> Registration | str:
        """The scan laid over the reference: the first one from any attitude, others from the prediction or the last pose."""
        if self._last is None:
            start = self._reference.begin(points_lidar)
            return start if isinstance(start, str) else self._laid(points_lidar, start)
        starts = [self._last]
        if self.parameters.feedback:
            starts.insert(0, self._filter.lidar_from_target(then) * self._reference.target_from_own)
        for start in starts:
            found = self._laid(points_lidar, start)
            if not isinstance(found, str):
                return found
        return found

    def _laid(self, points_lidar: Floats, start: RigidTransform) -> Registration | str:
        surface = self._reference.visible(start)
        found = register(points_lidar, surface, start, self._setting.noise, self.parameters.registration)
        if not isinstance(found, str) and found.overlap < _LEAST_OVERLAP:
            return f"ICP came to rest where {found.overlap:.0%} of the returns lie near the reference"
        return found

    def _followed(
        self, found: Registration, points_lidar: Floats, now: ChaserState, then: ChaserState, watch: Stopwatch
    ) -> Estimate:
        own_from_target = self._reference.target_from_own.inv()
        measured = PoseMeasurement(then.time_s, found.lidar_from_target * own_from_target, found.covariance)
        extras = icp_extras(found, self._reference.target_from_own) | {"predicted": 0.0}
        if self._last is None:
            self._filter.start(measured, now)
        else:
            extras |= self._filter.update(measured, now).extras()
        self._last, self._missed = found.lidar_from_target, 0
        watch.ends("filter")
        self._reference.learn(points_lidar, found.lidar_from_target)
        watch.ends("map")
        return self._answer(now, extras, watch)

    def _missing(self, reason: str, now: ChaserState, watch: Stopwatch) -> Estimate:
        """A scan that gave no pose: the filter predicts, but not for ever."""
        self._missed += 1
        self._filter.predict(now)
        watch.ends("filter")
        if self._missed > self.parameters.most_predictions:
            return self._failed(Outcome.DIVERGED, f"no registration of {self._missed} scans: {reason}", watch.extras)
        return self._answer(now, {"predicted": 1.0}, watch)

    def _answer(self, now: ChaserState, extras: dict[str, float], watch: Stopwatch) -> Estimate:
        """The filter's pose now."""
        named = extras | self._reference.extras() | watch.extras
        named |= {name: 1.0 for name in ("infeasible_guess",) if self._filter.guess_fault()}
        fault = self._filter.is_sound()
        if fault:
            return self._failed(Outcome.DIVERGED, fault, named)
        pose = self._filter.lidar_from_target(now)
        named |= self._filter.extras()
        return Estimate(self._setting.name, Outcome.OK, pose.rotation, pose.translation, extras=named)

    def _failed(self, outcome: Outcome, reason: str, extras: dict[str, float]) -> Estimate:
        return Estimate(self._setting.name, outcome, reason=reason, extras=extras)
