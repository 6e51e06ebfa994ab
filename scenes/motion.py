"""How the target moves before the chaser. Chaser axes are a forward camera's: x right, y down, z towards the target.

The paper of the fly-around (Zhai et al. 2014) has a camera frame with X backward, Y right, Z up and passive elementary
matrices; ``CHASER_FROM_PAPER`` takes its vectors into ours.
"""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.arrays import Floats, frozen
from scenes.draw import PositiveScalar, Scalar, scalar
from scenes.motion_scatter import NutationScatter, Scatter
from scenes.orbit_motion import TumbleInOrbit
from scenes.provenance import stream
from scenes.recording import ChaserState
from scenes.spec import Positive, Spec, Vector3, is_empty

# P_chaser = CHASER_FROM_PAPER · P_paper: right = Y, down = −Z, forward = −X.
CHASER_FROM_PAPER = frozen([[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]])


class BeforeChaser(Spec):
    """A motion of the target in chaser axes: the chaser is at rest, nothing is said of an orbit."""

    def chaser_state(self, time_s: float, seed: int) -> ChaserState | None:  # noqa: ARG002
        """None: its navigation has nothing to say."""
        return None

    def truth_columns(self, time_s: float, seed: int) -> dict[str, float]:  # noqa: ARG002
        """The pose is all there is."""
        return {}


class AxisSweep(BeforeChaser):
    """The fly-around of Zhai et al. 2014, section 3: θ(t) = start + rate·t about one axis of the target, at a fixed range.

    Positive θ follows the paper's passive matrices, R_ct = R_axis(θ): the target turns by −θ in the right-hand sense.
    """

    type: Literal["axis-sweep"]
    axis: Literal["x", "y", "z"]
    start_deg: float
    rate_deg_s: float
    range_m: Positive

    def angle_rad(self, time_s: float) -> float:
        """θ(t) in radians."""
        return math.radians(self.start_deg + self.rate_deg_s * time_s)

    def chaser_from_target(self, time_s: float, frame: int, seed: int) -> RigidTransform:  # noqa: ARG002
        """The pose at ``time_s``: CHASER_FROM_PAPER · R_axis(θ), target origin on the boresight."""
        paper_from_target = Rotation.from_euler(self.axis, -self.angle_rad(time_s))
        rotation = Rotation.from_matrix(CHASER_FROM_PAPER) * paper_from_target
        return RigidTransform.from_components([0.0, 0.0, self.range_m], rotation)

    def omega_target_rad_s(self, time_s: float, seed: int = 0) -> Vector3:  # noqa: ARG002
        """Angular velocity of the target against the chaser, in target axes: always the same."""
        rate = -math.radians(self.rate_deg_s)
        return tuple(rate if name == self.axis else 0.0 for name in "xyz")  # type: ignore[return-value]


class Spin(BeforeChaser):
    """Constant angular velocity from a start attitude, at a position that drifts at constant velocity (chaser axes).

    ``scatter``: how far the start of a run lies from the stated one, as its seed draws it.
    """

    type: Literal["spin"]
    position_m: Vector3
    velocity_m_s: Vector3 = (0.0, 0.0, 0.0)
    rotation_vector_deg: Vector3 = (0.0, 0.0, 0.0)
    omega_target_deg_s: Vector3 = (0.0, 0.0, 0.0)
    scatter: Scatter | None = Field(default=None, exclude_if=is_empty)

    def chaser_from_target(self, time_s: float, frame: int, seed: int) -> RigidTransform:  # noqa: ARG002
        """The pose at ``time_s``: start attitude, then ω·t in target axes."""
        turned = Rotation.from_rotvec(np.asarray(self.omega_target_deg_s) * time_s, degrees=True)
        start, position_m = _start(self.rotation_vector_deg, self.position_m, self.scatter, seed)
        return RigidTransform.from_components(position_m + np.asarray(self.velocity_m_s) * time_s, start * turned)

    def omega_target_rad_s(self, time_s: float, seed: int = 0) -> Vector3:  # noqa: ARG002
        """Angular velocity of the target against the chaser, in target axes: always the same."""
        x, y, z = np.radians(self.omega_target_deg_s)
        return float(x), float(y), float(z)


class NutationApproach(BeforeChaser):
    """A target that nutates while it comes nearer: its z axis goes round a cone, its origin drifts at constant velocity.

    R(t) = R₀ · R_z(φ) · R_x(ν) · R_z(s·t − φ) with φ = 2π t / period + phase (Euler's angles; Goldstein, section 4.4): R₀ is
    ``rotation_vector_deg``, whose z axis is the cone's; ν is ``nutation_deg``, the angle that z keeps to it; s is
    ``spin_deg_s`` about z. Without spin the target wobbles but comes back to the same attitude after each period. A free body
    whose moments are It across z and Iz about it has s = 2π / period · (1 + cos ν (It / Iz − 1)) (Goldstein, section 5.6).
    ``scatter``: how far the start of a run lies from the stated one, as its seed draws it.
    """

    type: Literal["nutation-approach"]
    position_m: Vector3
    velocity_m_s: Vector3 = (0.0, 0.0, 0.0)
    rotation_vector_deg: Vector3 = (0.0, 0.0, 0.0)
    nutation_deg: Annotated[float, Field(ge=0, lt=90)]
    period_s: Positive
    phase_deg: float = 0.0
    spin_deg_s: float = 0.0
    scatter: NutationScatter | None = Field(default=None, exclude_if=is_empty)

    def chaser_from_target(self, time_s: float, frame: int, seed: int) -> RigidTransform:  # noqa: ARG002
        """The pose at ``time_s``."""
        round_cone, about_z = self._angles_rad(time_s, seed)
        wobble = Rotation.from_euler("ZXZ", [round_cone, math.radians(self.nutation_deg), about_z])
        start, position_m = _start(self.rotation_vector_deg, self.position_m, self.scatter, seed)
        return RigidTransform.from_components(position_m + np.asarray(self.velocity_m_s) * time_s, start * wobble)

    def omega_target_rad_s(self, time_s: float, seed: int = 0) -> Vector3:
        """Angular velocity of the target against the chaser, in target axes: φ̇ sin ν (sin ψ, cos ψ, 0) + (φ̇ cos ν + ψ̇) z.

        ψ = s·t − φ is the angle about z (Goldstein, eq. 4.87). Its length does not change.
        """
        tilt, rate, (_, about_z) = math.radians(self.nutation_deg), 2 * math.pi / self.period_s, self._angles_rad(time_s, seed)
        across = rate * math.sin(tilt)
        along = rate * (math.cos(tilt) - 1) + math.radians(self.spin_deg_s)
        return across * math.sin(about_z), across * math.cos(about_z), along

    def _angles_rad(self, time_s: float, seed: int) -> tuple[float, float]:
        """φ, round the cone, and ψ, about z."""
        drawn = 0.0 if self.scatter is None else self.scatter.phase_rad(seed)
        round_cone = 2 * math.pi * time_s / self.period_s + math.radians(self.phase_deg) + drawn
        return round_cone, math.radians(self.spin_deg_s) * time_s - round_cone


class RandomViews(BeforeChaser):
    """Independent views: attitude uniform over all rotations, range and off-boresight angles drawn for each frame."""

    type: Literal["random-views"]
    range_m: PositiveScalar
    right_deg: Scalar = 0.0
    down_deg: Scalar = 0.0

    def chaser_from_target(self, time_s: float, frame: int, seed: int) -> RigidTransform:  # noqa: ARG002
        """The pose of ``frame``; each field has its own stream, so changing one leaves the others as they were."""
        attitude = Rotation.random(rng=stream(seed, frame, "motion.attitude"))
        range_m = scalar(self.range_m, stream(seed, frame, "motion.range_m"))
        right = math.radians(scalar(self.right_deg, stream(seed, frame, "motion.right_deg")))
        down = math.radians(scalar(self.down_deg, stream(seed, frame, "motion.down_deg")))
        sight = np.array([math.tan(right), math.tan(down), 1.0])
        return RigidTransform.from_components(range_m * sight / np.linalg.norm(sight), attitude)

    def omega_target_rad_s(self, time_s: float, seed: int = 0) -> Vector3:  # noqa: ARG002
        """Nothing moves within a view."""
        return 0.0, 0.0, 0.0


def _start(rotation_vector_deg: Vector3, position_m: Vector3, scatter: Scatter | None, seed: int) -> tuple[Rotation, Floats]:
    """Attitude and position (3,) at the start of a run."""
    rotation, position = Rotation.from_rotvec(rotation_vector_deg, degrees=True), np.asarray(position_m)
    return (rotation, position) if scatter is None else (rotation * scatter.turn(seed), position + scatter.offset_m(seed))


Motion = Annotated[AxisSweep | Spin | NutationApproach | RandomViews | TumbleInOrbit, Field(discriminator="type")]
