"""``lidar-ekf``: a tumbling target through registered scans and a filter in the target's own axes.

Each scan: the filter predicts where the target is; the scan is freed of the motion during it; it is laid over the part of the
reference that can be seen from there; the filter takes the pose in with the covariance that the registration states; a map learns
the scan where the filter then has it. A scan that gives no pose is predicted, and said to be, as far as a ``Bridge`` carries; scans
that contradict the prediction have the pose looked for anew.
"""

from scipy.spatial.transform import RigidTransform

from estimators.api import Estimate, Outcome
from estimators.lidar_filter.answers import filter_extras, icp_extras, stated_covariance
from estimators.lidar_filter.bridge import Bridge
from estimators.lidar_filter.chaser import chaser_at
from estimators.lidar_filter.clouds import Returns
from estimators.lidar_filter.deskew import deskewed
from estimators.lidar_filter.history import History
from estimators.lidar_filter.measurement import PoseFilter, PoseMeasurement
from estimators.lidar_filter.parameters import LidarParameters, suited
from estimators.lidar_filter.reference import Reference, reference_for
from estimators.lidar_filter.registration import Registration, register
from estimators.lidar_filter.setting import Setting, setting_from
from estimators.lidar_filter.tumble_filter import TumbleFilter
from estimators.stopwatch import Stopwatch
from scenes.arrays import Floats
from scenes.recording import ChaserState, Knowledge, Observation


class LidarEkf:
    """The estimator; keyword arguments override ``LidarParameters``."""

    def __init__(self, **parameters: object) -> None:
        """Raises ``pydantic.ValidationError`` for an unknown or impossible parameter."""
        self.parameters = LidarParameters.model_validate(parameters)

    def start(self, knowledge: Knowledge) -> None:
        """Raises ``ValueError`` if no LIDAR is told of, or no model where the reference is to be one."""
        self._setting: Setting = setting_from(knowledge)
        self._p = suited(self.parameters, self._setting.lidar.range_sigma_m)
        self._filter: PoseFilter = TumbleFilter(self._setting.lidar.chaser_from_lidar, self._p.filter)
        self._is_lost = False
        self._restart()

    @property
    def _is_told_model(self) -> bool:
        return self._p.reference in ("auto", "model") and self._setting.model is not None

    def _give_up(self) -> None:
        """Begins anew against a model. Without one the frame of the method's own is lost with the target, for good."""
        self._is_lost = not self._is_told_model
        self._restart()

    def _restart(self) -> None:
        self._reference: Reference = reference_for(self._setting, self._p)
        self._is_begun = False
        self._last: RigidTransform | None = None  # of the last registration, lidar_from_own
        self._history = History()
        self._bridge = Bridge()

    def step(self, observation: Observation) -> Estimate:
        """One scan: predict, register, filter, learn."""
        returns = self._setting.returns(observation)
        if isinstance(returns, str):
            return self._failed(Outcome.SKIPPED, returns, {})
        if self._is_lost:
            return self._failed(Outcome.DIVERGED, "the target was lost, and with it the frame of this method's own", {})
        watch = Stopwatch()
        now, then = self._setting.chaser(observation)
        if not self._is_begun:
            return self._begin(returns, now, then, watch)
        expected = self._filter.lidar_from_target(then)
        points = self._freed(returns, now, expected)
        start = expected if self.parameters.feedback or self._last is None else self._last
        found = self._registered(points, start)
        watch.ends("icp")
        if isinstance(found, str):
            self._bridge.misses(self._reference.holds_what_is_seen and len(points) >= self._p.registration.least_points, False)
            answer = self._predicted(found, now, watch)
        else:
            answer = self._followed(found, points, now, then, watch)
        if self._is_told_model and self._bridge.is_contradicted(self._p.track):
            self._restart()
            return self._begin(returns, now, then, watch)
        return answer

    def _begin(self, returns: Returns, now: ChaserState, then: ChaserState, watch: Stopwatch) -> Estimate:
        """The first pose, from one scan or a few."""
        if len(returns) < self._p.registration.least_points:
            return self._failed(Outcome.NO_FEATURES, f"{len(returns)} beams came back, and the target was not seen before", {})
        start = self._reference.begin(returns.points_lidar)
        found = start if isinstance(start, str) else self._registered(returns.points_lidar, start)
        watch.ends("icp")
        if isinstance(found, str):
            return self._failed(Outcome.NOT_CONVERGED, found, watch.extras)
        measured = PoseMeasurement(then.time_s, found.lidar_from_target, stated_covariance(found, self._p))
        self._filter.start(measured, now)
        self._history.measured(measured, self._reference.anchored(found.lidar_from_target), now)
        self._is_begun, self._last = True, found.lidar_from_target
        self._bridge.follows()
        watch.ends("filter")
        return self._answer(now, icp_extras(found, self._reference.target_from_own) | {"predicted": 0.0}, watch)

    def _freed(self, returns: Returns, now: ChaserState, expected: RigidTransform) -> Floats:
        """The points without the motion that is predicted over the scan."""
        lidar = self._setting.lidar
        if lidar.duration_s <= 0:
            return returns.points_lidar
        end = self._filter.lidar_from_target(chaser_at(now, now.time_s - lidar.delay_s + lidar.duration_s / 2))
        return deskewed(returns, expected, end, lidar.duration_s / 2, -lidar.delay_s)

    def _registered(self, points_lidar: Floats, start: RigidTransform) -> Registration | str:
        """The scan laid over what can be seen of the reference; a sentence where that says nothing."""
        surface = self._reference.visible(start)
        found = register(points_lidar, surface, start, self._setting.noise, self._p.registration)
        if not isinstance(found, str) and found.overlap < self._p.track.least_overlap:
            return f"only {found.overlap:.0%} of the returns lie near the target as it is known"
        return found

    def _followed(
        self, found: Registration, points_lidar: Floats, now: ChaserState, then: ChaserState, watch: Stopwatch
    ) -> Estimate:
        measured = PoseMeasurement(then.time_s, found.lidar_from_target, stated_covariance(found, self._p))
        innovation = self._filter.update(measured, now)
        watch.ends("filter")
        extras = icp_extras(found, self._reference.target_from_own) | dict(innovation.extras())
        if not innovation.accepted:
            self._bridge.misses(contradicts=True, is_registered=True)
            return self._predicted("the registration lies farther from the prediction than both allow", now, watch, extras)
        self._last = found.lidar_from_target
        self._bridge.follows()
        self._history.measured(measured, self._reference.anchored(found.lidar_from_target), now)
        if self._reference.learn(points_lidar, self._filter.lidar_from_target(then)):
            self._history.tell(self._filter, self._reference)
        watch.ends("map")
        return self._answer(now, extras | {"predicted": 0.0}, watch)

    def _predicted(self, reason: str, now: ChaserState, watch: Stopwatch, extras: dict[str, float] | None = None) -> Estimate:
        """A scan of which nothing was used: the filter goes on alone, but not for ever."""
        self._filter.predict(now)
        self._history.predicted(now)
        watch.ends("filter")
        if self._bridge.unused > self._p.track.most_predictions:
            failed = self._failed(Outcome.DIVERGED, f"nothing was used of {self._bridge.unused} scans: {reason}", watch.extras)
            self._give_up()
            return failed
        broken = "" if self._filter.is_sound() else self._bridge.breaks(self._filter.pose_sigma(now), self._p.track)
        if broken:
            return self._failed(Outcome.NOT_CONVERGED, f"{broken}: {reason}", (extras or {}) | watch.extras)
        return self._answer(now, (extras or {}) | {"predicted": 1.0}, watch)

    def _answer(self, now: ChaserState, extras: dict[str, float], watch: Stopwatch) -> Estimate:
        """The filter's pose now, with all that it knows."""
        fault = self._filter.is_sound()
        target_from_own = self._reference.target_from_own
        known = {} if fault else filter_extras(self._filter.extras(), target_from_own)
        named = known | extras | self._reference.extras() | watch.extras
        if fault:
            self._give_up()
            return self._failed(Outcome.DIVERGED, fault, named)
        pose = self._filter.lidar_from_target(now) * target_from_own.inv()
        return Estimate(self._setting.name, Outcome.OK, pose.rotation, pose.translation, extras=named)

    def _failed(self, outcome: Outcome, reason: str, extras: dict[str, float]) -> Estimate:
        return Estimate(self._setting.name, outcome, reason=reason, extras=extras)
