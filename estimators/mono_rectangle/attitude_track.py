"""The attitude over time: starts the filter, holds the label, refuses what does not follow from the past."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from estimators.mono_rectangle import attitude_filter
from estimators.mono_rectangle.attitude_filter import AttitudeSample, AttitudeState
from estimators.mono_rectangle.labels import nearest_label, quarter_turn
from estimators.mono_rectangle.parameters import TrackedParameters


@dataclass(frozen=True, slots=True, eq=False)
class Verdict:
    """What became of a measurement: ``reason`` is "" if it was accepted; ``sigmas`` its innovation (NaN before a start);
    ``k`` the quarter turns by which it was relabelled; ``sample`` after that."""

    sample: AttitudeSample
    reason: str = ""
    sigmas: float = float("nan")
    k: int = 0


class AttitudeTrack:
    """Memory of one track. ``state`` is None until enough frames lie on one line of constant rate."""

    def __init__(self, parameters: TrackedParameters) -> None:
        """An empty track."""
        self._parameters = parameters
        self._q_rad2_s3 = float(np.deg2rad(1.0) ** 2 * parameters.rate_noise_deg2_s3)
        self.forget()

    def forget(self) -> None:
        """Back to the beginning: no rate, no past."""
        self.state: AttitudeState | None = None
        self._samples: list[AttitudeSample] = []

    def predicted(self, time_s: float) -> Rotation | None:
        """The rotation expected at ``time_s``, None before a start."""
        return None if self.state is None else attitude_filter.predicted(self.state, time_s, self._q_rad2_s3).rotation

    def take(self, sample: AttitudeSample) -> Verdict:
        """Judges a measurement against the past and learns from it if it is accepted."""
        return self._begin(sample) if self.state is None else self._follow(self.state, sample)

    def _begin(self, sample: AttitudeSample) -> Verdict:
        self._samples.append(sample)
        if len(self._samples) >= self._parameters.start_frames:
            line = attitude_filter.line_through(self._samples)
            if self._worst_misfit(line) < self._parameters.gate_sigmas:
                self.state = line
            self._samples = self._samples[1:]
        return Verdict(sample)

    def _worst_misfit(self, line: AttitudeState) -> float:
        worst = 0.0
        for sample in self._samples:
            there = replace(line, rotation=Rotation.from_rotvec(line.rate_rad_s * (sample.time_s - line.time_s)) * line.rotation)
            worst = max(worst, attitude_filter.innovation(replace(there, covariance=np.zeros((6, 6))), sample)[1])
        return worst

    def _follow(self, state: AttitudeState, sample: AttitudeSample) -> Verdict:
        p = self._parameters
        expected = attitude_filter.predicted(state, sample.time_s, self._q_rad2_s3)
        choice = nearest_label(sample.rotation, expected.rotation)
        sample = replace(sample, rotation=sample.rotation * quarter_turn(choice.k))
        _, sigmas = attitude_filter.innovation(expected, sample)
        verdict = Verdict(sample, "", sigmas, choice.k)
        if choice.margin_rad < np.deg2rad(p.label_margin_deg):
            margin = np.rad2deg(choice.margin_rad)
            return replace(verdict, reason=f"two labellings are within {margin:.0f} deg of each other: the label is not clear")
        if sigmas > p.gate_sigmas:
            return replace(verdict, reason=f"it is {sigmas:.1f} sigma from the prediction, above {p.gate_sigmas:.1f}")
        self.state = attitude_filter.updated(expected, sample)
        return verdict
