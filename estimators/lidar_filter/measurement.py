"""What a registration tells a filter, what the filter makes of it, and what every filter of this folder can do."""

from dataclasses import dataclass
from typing import Protocol

from scipy.spatial.transform import RigidTransform

from scenes.arrays import Floats
from scenes.recording import ChaserState


@dataclass(frozen=True, slots=True, eq=False)
class PoseMeasurement:
    """One scan's registration.

    ``time_s``: the scan's reference instant. ``covariance`` (6, 6): of the error's rotation vector in target axes (rad; the
    measured rotation is true · exp(error)) and of the target's origin in LIDAR axes (m), in this order.
    """

    time_s: float
    lidar_from_target: RigidTransform
    covariance: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Innovation:
    """How a measurement compared with its prediction: squared Mahalanobis length, its degrees of freedom, the gate's verdict."""

    nis: float
    dof: int
    accepted: bool

    def extras(self) -> dict[str, float]:
        """The same as named numbers for the judge."""
        return {"nis": self.nis, "nis_dof": float(self.dof), "accepted": float(self.accepted)}


class PoseFilter(Protocol):
    """A filter of the target's motion. It knows where the LIDAR is mounted; ``chaser`` is the chaser's own state, now.

    Where the chaser says nothing of itself, ``chaser.at_rest(time_s)`` stands for a chaser that floats in inertial space.
    Scans come in the order of their instants, which may lie before what was already predicted.
    """

    def start(self, measurement: PoseMeasurement, chaser: ChaserState) -> None:
        """Begins from a first measurement alone, and predicts to ``chaser.time_s``."""

    def predict(self, chaser: ChaserState) -> None:
        """Moves on to ``chaser.time_s`` without a measurement."""

    def update(self, measurement: PoseMeasurement, chaser: ChaserState) -> Innovation:
        """Takes a measurement in at its own instant, and predicts to ``chaser.time_s``."""

    def lidar_from_target(self, chaser: ChaserState) -> RigidTransform:
        """The pose expected at ``chaser.time_s``, as where a registration may start. The filter stays as it is."""

    def pose_sigma(self, chaser: ChaserState) -> tuple[float, float]:
        """1σ of ``lidar_from_target`` now, along its worst axes: attitude (rad), and the target's origin (m)."""

    def extras(self) -> dict[str, float]:
        """States and their 1σ as named numbers, at the instant of the last call."""

    def is_sound(self) -> str:
        """Empty, or one sentence that says how the filter diverged."""
