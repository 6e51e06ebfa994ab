"""What the rest of the program asks of a motion, whatever its kind."""

from typing import Protocol

from scipy.spatial.transform import RigidTransform

from scenes.recording import ChaserState
from scenes.spec import Vector3


class Trajectory(Protocol):
    """A motion bound to its target: any time, in any order, gives the same answer for the same seed."""

    def chaser_from_target(self, time_s: float, frame: int, seed: int) -> RigidTransform:
        """The pose at ``time_s``. ``frame``: of the views that are drawn one by one."""

    def omega_target_rad_s(self, time_s: float, seed: int = 0) -> Vector3:
        """Angular velocity of the target against the chaser, in target axes."""

    def chaser_state(self, time_s: float, seed: int) -> ChaserState | None:
        """What the chaser's navigation knows of itself; None where the motion is of the target before a chaser at rest."""

    def truth_columns(self, time_s: float, seed: int) -> dict[str, float]:
        """What the truth table says of the motion besides the pose; empty where there is nothing to say."""
