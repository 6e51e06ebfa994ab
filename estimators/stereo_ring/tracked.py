"""``stereo-ring``: a docking ring of unknown size and its markers, found and followed in two views.

Acquire: arc-support ellipses of any polarity → refined to the edges → circles that both views see, with the other view asked at
every distance → one joint fit → the outermost edge in its plane. Track: optical flow predicts, the edges of both views measure
the circle, the remembered radius judges. Markers: on their own edges, remembered as a constellation in ring coordinates, whose
turn gives the X axis. Without a ring the constellation carries the ring's frame. A frame without sufficient evidence is a failure
with its reason.
"""

import numpy as np
from scipy.spatial.transform import RigidTransform

from estimators.api import Estimate, Outcome
from estimators.stereo_ring.axis_track import AxisFix, AxisTrack
from estimators.stereo_ring.centre_filter import CentreFilter, filtered
from estimators.stereo_ring.fallback import laid_onto
from estimators.stereo_ring.measurement import Measured, seen_ellipses
from estimators.stereo_ring.motion import Motion, circle_at, followed, turned_to
from estimators.stereo_ring.parameters import TrackedParameters
from estimators.stereo_ring.ring_track import RingSeen, RingTrack
from estimators.stereo_ring.setting import Setting, setting_from
from estimators.stereo_ring.tracking import Pictures
from estimators.stopwatch import Stopwatch
from scenes.recording import Knowledge, Observation


class TrackedRing:
    """The estimator; keyword arguments override ``TrackedParameters``."""

    def __init__(self, **parameters: object) -> None:
        """Raises ``pydantic.ValidationError`` for an unknown or impossible parameter."""
        self.parameters = TrackedParameters.model_validate(parameters)

    def start(self, knowledge: Knowledge) -> None:
        """Raises ``ValueError`` if the ring, the pair or one of its sensors is not in ``knowledge``."""
        self._setting: Setting = setting_from(knowledge)
        self._ring = RingTrack(self._setting.rig, self.parameters)
        self._axis = AxisTrack(self._setting.rig, self.parameters)
        self._motion: Motion | None = None
        self._path: CentreFilter | None = None
        self._radius_m = 0.0  # of the ring that was last answered
        self._coasted = 0  # frames in a row whose turn was predicted
        self._is_marked = False  # whether a marker was seen since the ring was acquired
        self._carried = 0  # frames in a row that markers alone carried

    def step(self, observation: Observation) -> Estimate:
        """One frame: the ring, then the turn about its normal; without a ring, the markers."""
        pictures = self._setting.pictures(observation)
        if isinstance(pictures, str):
            return self._failed(Outcome.SKIPPED, pictures, {})
        watch = Stopwatch()
        expected = None if self._motion is None else self._motion.at(observation.time_s, self.parameters.track.longest_gap_s)
        circle = None if expected is None else circle_at(expected, self._radius_m)
        seen = self._ring.step(pictures, circle, watch)
        if seen.measured is None:
            return self._without_ring(pictures, seen.reason, expected, observation.time_s, watch)
        return self._with_ring(pictures, seen, seen.measured, expected, observation.time_s, watch)

    def _with_ring(
        self,
        pictures: Pictures,
        seen: RingSeen,
        ring: Measured,
        expected: RigidTransform | None,
        time_s: float,
        watch: Stopwatch,
    ) -> Estimate:
        self._carried = 0
        self._is_marked = self._is_marked and not seen.is_new
        extras = _ring_extras(ring) | {"acquired": float(seen.is_new)}
        if not seen.believed:
            reason = f"the ring is there, but has to be seen in {self.parameters.track.confirm} frames before it is believed"
            return self._failed(Outcome.NOT_CONVERGED, reason, extras | watch.extras)
        turned = None if expected is None else turned_to(expected, ring.circle)
        sure = self._motion is not None and self._motion.rate_rad_s is not None
        sigma_m = float(np.sqrt(np.trace(ring.fit.covariance[:2, :2]) / 2))
        fix = self._axis.step(pictures, ring.ellipses, ring.circle, turned, sigma_m)
        watch.ends("markers")
        return self._turned(fix, turned, sure, time_s, extras | watch.extras)

    def _turned(
        self, fix: AxisFix | None, expected: RigidTransform | None, sure: bool, time_s: float, extras: dict[str, float]
    ) -> Estimate:
        """The answer with X from the markers, or for a few frames from the rate of before."""
        p = self.parameters.track
        if fix is not None:
            self._coasted, self._is_marked = 0, True
            self._radius_m = self._ring.memory.radius_m
            self._motion = followed(self._motion, fix.left_from_ring, time_s, p.longest_gap_s)
            self._path = filtered(
                self._path, fix.left_from_ring.translation, time_s, self.parameters.centre_gain, p.longest_gap_s, p.farthest_m
            )
            extras = extras | {"markers": float(fix.markers), "sigma_turn_deg": float(np.rad2deg(fix.sigma_rad))}
            answered = RigidTransform.from_components(self._path.centre_m, fix.left_from_ring.rotation)
            return self._answer(answered, extras | {"from_ring": 1.0})
        extras = extras | {"markers": 0.0}
        self._coasted += 1
        if self._coasted >= p.unmarked_frames:
            self._ring.forget()  # what has no markers about it for so long is another circle
            self._coasted = 0
        if expected is None or not sure or not self._is_marked or self._coasted > p.coast_frames:
            return self._failed(Outcome.NO_FEATURES, "no marker is seen in both pictures, so the turn is not known", extras)
        extras = extras | {"sigma_turn_deg": p.coast_sigma_deg * self._coasted, "from_ring": 1.0}
        return self._answer(expected, extras)

    def _without_ring(
        self, pictures: Pictures, reason: str, expected: RigidTransform | None, time_s: float, watch: Stopwatch
    ) -> Estimate:
        """The remembered markers carry the ring's frame for a while."""
        p = self.parameters
        self._carried += 1
        if expected is not None and self._carried <= p.track.fallback_frames:
            frame = self._carried_by_markers(pictures, expected)
            watch.ends("markers")
            if not isinstance(frame, str):
                fixed, count = frame
                self._motion = followed(self._motion, fixed, time_s, p.track.longest_gap_s)
                return self._answer(fixed, {"markers": float(count), "from_ring": 0.0} | watch.extras)
            reason = f"{reason}; {frame}"
        return self._failed(Outcome.NO_FEATURES, reason, watch.extras)

    def _carried_by_markers(self, pictures: Pictures, expected: RigidTransform) -> tuple[RigidTransform, int] | str:
        ring = circle_at(expected, self._radius_m)
        ellipses = seen_ellipses(ring, self._setting.rig)
        if ellipses is None:
            return "the ring would lie outside what the cameras see"
        seen = self._axis.remembered_in_ring(pictures, ellipses, expected, ring)
        p = self.parameters.constellation
        known = np.array([place for place, _ in seen]).reshape(-1, 3)
        found = np.array([point for _, point in seen]).reshape(-1, 3)
        frame = laid_onto(known, found, p.fallback_height_m, p.fallback_residual_m)
        return frame if isinstance(frame, str) else (frame, len(seen))

    def _answer(self, left_from_ring: RigidTransform, extras: dict[str, float]) -> Estimate:
        left_from_target = self._setting.left_from_target(left_from_ring)
        name = self._setting.names[0]
        return Estimate(name, Outcome.OK, left_from_target.rotation, left_from_target.translation, extras=extras)

    def _failed(self, outcome: Outcome, reason: str, extras: dict[str, float]) -> Estimate:
        return Estimate(self._setting.names[0], outcome, reason=reason, extras=extras)


def _ring_extras(ring: Measured) -> dict[str, float]:
    extras = {"radius_m": ring.circle.radius_m, "residual_px": ring.fit.sigma_px}
    for view, ellipse, share, rms in zip(("left", "right"), ring.ellipses, ring.share, ring.rms_px, strict=True):
        for name, value in zip(("x_px", "y_px", "a_px", "b_px", "theta_rad"), ellipse.parameters, strict=True):
            extras[f"{view}_{name}"] = float(value)
        extras[f"{view}_share"], extras[f"{view}_rms_px"] = share, rms
    return extras
