"""The estimator's contract: Observation in, Estimate out. Failure is a value with a remedy in its text, never identity."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from types import MappingProxyType
from typing import Protocol, runtime_checkable

from scipy.spatial.transform import Rotation

from scenes.arrays import Floats
from scenes.recording import Knowledge, Observation


class Outcome(Enum):
    """How one frame ended. The value is what stands in predictions.csv."""

    OK = "ok"
    NOT_CONVERGED = "not_converged"
    NO_FEATURES = "no_features"
    DIVERGED = "diverged"
    TIMED_OUT = "timed_out"
    CRASHED = "crashed"
    SKIPPED = "skipped"


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """One frame's answer for one sensor.

    ``sensor_from_target``: the rotation, present exactly if ``outcome`` is OK. ``translation_m``: the target's origin in
    the sensor frame, metres, or None where the method cannot know it (an unknown-size rectangle gives no range).
    ``reason``: one sentence why a frame failed. ``extras``: named numbers for extras.parquet.
    """

    sensor: str
    outcome: Outcome
    sensor_from_target: Rotation | None = None
    translation_m: Floats | None = None
    reason: str = ""
    extras: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        """Refuses an answer without a pose and a failure with one."""
        if (self.outcome is Outcome.OK) != (self.sensor_from_target is not None):
            raise ValueError(f"outcome {self.outcome.value!r} and pose {self.sensor_from_target!r} contradict each other")


@runtime_checkable
class Estimator(Protocol):
    """What every method is: it is started once per sequence and then given one frame after the other."""

    def start(self, knowledge: Knowledge) -> None:
        """Takes what may be known in advance; offline work and compilation belong here and are timed apart."""

    def step(self, observation: Observation) -> Estimate:
        """Answers one frame. State lives in the object; the observation is not changed."""
