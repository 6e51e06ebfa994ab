"""``mono-rectangle``: the attitude of a rectangle of unknown size, edge by edge, frame after frame.

Predicted lines → gradient-weighted sub-pixel refit → visibility and quality gates → closed form of Zhai et al. 2014 with
SVD projection (or the orthogonality-constrained or known-aspect fit) → constant-rate attitude filter. Knows the camera,
the rectangle's axes on the target and the corners that an operator clicked in the first frame; not the size, nor a model.
A frame in which one edge cannot be seen for certain is a failure with its reason, never a guess.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from estimators.api import Estimate, Outcome
from estimators.mono_rectangle import vertex_track
from estimators.mono_rectangle.angles import zyx_from_cam_rotation
from estimators.mono_rectangle.aspect_memory import AspectMemory
from estimators.mono_rectangle.attitude_filter import AttitudeSample
from estimators.mono_rectangle.attitude_track import AttitudeTrack, Verdict
from estimators.mono_rectangle.edge_finder import Candidate, EdgeFinder, Sighting
from estimators.mono_rectangle.edge_refit import EdgeFit
from estimators.mono_rectangle.parameters import TrackedParameters
from estimators.mono_rectangle.quad_choice import choose_lines
from estimators.mono_rectangle.quadrilateral import EDGE_NAMES, ideal_from_normalised
from estimators.mono_rectangle.setting import Setting, setting_from
from estimators.mono_rectangle.solution import Solution, solve
from estimators.mono_rectangle.vertex_track import VertexTrack
from estimators.mono_rectangle.visibility import GreyScale
from scenes.arrays import Floats
from scenes.recording import Knowledge, Observation


class TrackedRectangle:
    """The estimator; keyword arguments override ``TrackedParameters``."""

    def __init__(self, **parameters: object) -> None:
        """Raises ``pydantic.ValidationError`` for an unknown or impossible parameter."""
        self.parameters = TrackedParameters.model_validate(parameters)

    def start(self, knowledge: Knowledge) -> None:
        """Raises ``ValueError`` if the rectangle, the corner prior or its sensor is not in ``knowledge``."""
        self._setting: Setting = setting_from(knowledge)
        sensor, rectangle = self._setting.sensor, self._setting.rectangle
        self._finder = EdgeFinder(sensor.intrinsics, GreyScale(sensor.black_dn, sensor.white_dn), rectangle, self.parameters)
        corners = ideal_from_normalised(sensor.intrinsics.normalised_from_pixels(self._setting.prior.corners_px), sensor.intrinsics)
        self._quad = self._fresh_track(corners, self._setting.prior.sigma_px)
        self._last_good = corners
        self._misses = 0
        self._time_s: float | None = None
        self._attitude = AttitudeTrack(self.parameters)
        self._shape = AspectMemory(self.parameters.aspect_sigma_px, self.parameters.gate_sigmas)
        self._refusals = 0
        self._aspect = self.parameters.known_aspect or rectangle.aspect

    def step(self, observation: Observation) -> Estimate:
        """One frame: look for the four edges where they should be, solve, judge against the past."""
        pixels = self._setting.pixels(observation)
        if isinstance(pixels, str):
            return self._failed(Outcome.SKIPPED, pixels)
        quad = self._predicted_quad(observation.time_s)
        sightings = [self._finder.find(pixels, quad, edge) for edge in range(4)]
        lines = choose_lines(sightings, self._setting.sensor.intrinsics, self._shape)
        self._follow_quad(quad, lines)
        seen = [line.fit for line in lines if line is not None]
        if len(seen) < 4:
            return self._failed(Outcome.NO_FEATURES, _unseen(sightings), _line_extras(lines))
        return self._attitude_from(seen, observation.time_s, quad, _line_extras(lines))

    def _attitude_from(self, seen: list[EdgeFit], time_s: float, quad: VertexTrack, extras: dict[str, float]) -> Estimate:
        """Four lines → attitude, unless they are no rectangle, another rectangle, or not where the past leads."""
        expected = self._attitude.predicted(time_s)
        solution = solve(seen, self._setting.sensor.intrinsics, self.parameters, self._aspect, expected)
        if isinstance(solution, str):
            return self._refused(Outcome.NOT_CONVERGED, solution, extras)
        if misfit := self._shape.why_not(solution):
            self._quad = quad  # the track of the vertices does not learn from another's edge
            return self._refused(Outcome.NOT_CONVERGED, misfit, extras)
        verdict = self._attitude.take(AttitudeSample(time_s, solution.rotation, solution.covariance))
        extras = extras | self._attitude_extras(solution, verdict)
        if verdict.reason:
            return self._refused(Outcome.DIVERGED, verdict.reason, extras)
        self._refusals, self._last_good = 0, solution.vertices_px
        if waiting := self._unsettled(verdict):
            return self._failed(Outcome.NOT_CONVERGED, waiting, extras)
        return Estimate(self._setting.sensor_name, Outcome.OK, self._on_target(self._filtered(verdict)), extras=extras)

    def _fresh_track(self, vertices_px: Floats, sigma_px: float) -> VertexTrack:
        return vertex_track.started(vertices_px, sigma_px, float(np.deg2rad(self.parameters.rate_prior_deg_s)))

    def _predicted_quad(self, time_s: float) -> VertexTrack:
        dt = 0.0 if self._time_s is None else max(time_s - self._time_s, 0.0)
        self._time_s = time_s
        return vertex_track.predicted(self._quad, dt, self.parameters.acceleration_px2_s3, self.parameters.curvature)

    def _follow_quad(self, quad: VertexTrack, lines: list[Candidate | None]) -> None:
        """Moves the track of the vertices; after a long loss the search begins anew at the last good quadrilateral."""
        for edge, line in enumerate(lines):
            if line is not None:
                quad = vertex_track.updated(quad, edge, line.fit.ends_px, line.fit.normal, line.noise)
        self._quad = quad
        self._misses = self._misses + 1 if sum(line is not None for line in lines) < 2 else 0
        if self._misses >= self.parameters.lost_after:
            self._quad = self._fresh_track(self._last_good, self.parameters.lost_sigma_px)
            self._attitude.forget()
            self._shape.forget()
            self._misses = 0

    def _refused(self, outcome: Outcome, reason: str, extras: dict[str, float]) -> Estimate:
        """A frame with four lines that do not fit the past. After several in a row the past is doubted, not the frame."""
        self._refusals += 1
        if self._refusals >= self.parameters.restart_after:
            self._attitude.forget()
            self._shape.forget()
            self._refusals = 0
        return self._failed(outcome, reason, extras)

    def _unsettled(self, verdict: Verdict) -> str:
        """Why there is no filtered answer yet, or "" if there is one or none is wanted."""
        share = self.parameters.settled
        if not self.parameters.filter or share == 1:
            return ""
        state = self._attitude.state
        if state is None:
            return "the filter has not started: it needs frames on a line of constant rate"
        now, single = (np.sqrt(np.linalg.eigvalsh(c)[-1]) for c in (state.covariance[:3, :3], verdict.sample.covariance))
        if now <= share * single:
            return ""
        now_deg, single_deg = np.rad2deg(now), np.rad2deg(single)
        return f"the filter has not settled: {now_deg:.2f} deg, above {share:.0%} of one frame's {single_deg:.2f} deg"

    def _filtered(self, verdict: Verdict) -> Rotation:
        state = self._attitude.state
        return state.rotation if self.parameters.filter and state is not None else verdict.sample.rotation

    def _on_target(self, cam_from_feature: Rotation) -> Rotation:
        return cam_from_feature * self._setting.rectangle.target_from_feature.inv()

    def _attitude_extras(self, solution: Solution, verdict: Verdict) -> dict[str, float]:
        sigma = np.sqrt(np.diag(solution.covariance))
        extras = {
            "aspect": float(np.exp(solution.log_aspect)),
            "r2_dot_r3": solution.skew,
            "r2_dot_r3_sigma": solution.skew_sigma,
            "innovation_sigmas": verdict.sigmas,
            "label_k": float(verdict.k),
        }
        extras |= {f"sigma_{axis}_deg": float(np.rad2deg(s)) for axis, s in zip("xyz", sigma, strict=True)}
        extras |= _angle_extras("", self._on_target(verdict.sample.rotation))
        if self._attitude.state is not None:
            extras |= _angle_extras("_filtered", self._on_target(self._attitude.state.rotation))
            rate = np.rad2deg(self._attitude.state.rate_rad_s)
            extras |= {f"rate_{axis}_deg_s": float(r) for axis, r in zip("xyz", rate, strict=True)}
        return extras

    def _failed(self, outcome: Outcome, reason: str, extras: dict[str, float] | None = None) -> Estimate:
        return Estimate(self._setting.sensor_name, outcome, reason=reason, extras=extras or {})


def _angle_extras(suffix: str, cam_from_target: Rotation) -> dict[str, float]:
    angles = np.rad2deg(zyx_from_cam_rotation(cam_from_target))
    return {f"theta{i + 1}{suffix}_deg": float(angle) for i, angle in enumerate(angles)}


def _line_extras(lines: list[Candidate | None]) -> dict[str, float]:
    extras = {}
    for name, line in zip(EDGE_NAMES, lines, strict=True):
        if line is not None:
            extras[f"{name}_scale_px"] = line.fit.scale_px
            extras[f"{name}_support"] = line.fit.support
            extras[f"{name}_step_dn"] = line.fit.polarity * (line.fit.inner_dn - line.fit.outer_dn)
            for end, (x_px, y_px) in enumerate(line.fit.ends_px.tolist()):
                extras |= {f"{name}_x{end}_px": x_px, f"{name}_y{end}_px": y_px}
    return extras


def _unseen(sightings: list[Sighting]) -> str:
    lost = [f"{name}: {s.reason}" for name, s in zip(EDGE_NAMES, sightings, strict=True) if not s.candidates]
    return f"{len(lost)} of 4 edges not visible ({'; '.join(lost)})"
