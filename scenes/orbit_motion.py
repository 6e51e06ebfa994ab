"""A tumbling target and a chaser, each on its own orbit about the Earth: the motion of Song et al. 2017, section 5.1."""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from scenes.arrays import Floats, frozen
from scenes.constants import EARTH_EQUATOR_M
from scenes.draw import NonZeroVector3
from scenes.orbit import chaser_orbit, eccentricity, mean_motion_rad_s, semi_major_axis_m
from scenes.quaternion import Quaternion
from scenes.spec import NonNegative, Positive, Spec, Vector3

_PRINTED_RATE_RAD_S = 0.0011  # of the paper, its θ̇₀: 2 % above the mean motion of its own orbit
_MOST_TURN_RAD = 0.1  # in a step: after 100 rad the integrated attitude is then off by about 1e-5 rad


class StateAtStart(Spec):
    """Where the target is at the start, in the chaser's LVLH: target minus chaser; the velocity as seen from these axes."""

    type: Literal["state"]
    position_m: Vector3
    velocity_m_s: Vector3 = (0.0, 0.0, 0.0)

    def at_start(self, orbit: Floats) -> tuple[Floats, Floats]:  # noqa: ARG002
        """Position and velocity (3,) in LVLH."""
        return frozen(self.position_m), frozen(self.velocity_m_s)


class Ellipse(Spec):
    """The closed relative path of Song et al. 2017, section 5.1, of half width ``amplitude_m``, at ``phase_deg`` at the start.

    With A the amplitude and α the phase: r = A (cos α, −2 sin α, 2 cos α),
    v = −A θ̇ (2 + e) / (2 √((1 + e)(1 − e)³)) (sin α, 2 cos α, 2 sin α), e the eccentricity of the target's orbit.
    ``rate``: θ̇ is its mean motion, with which the path closes, or the 0.0011 rad/s that the paper prints, with which it drifts.
    """

    type: Literal["ellipse"]
    amplitude_m: Positive
    phase_deg: float = 0.0
    rate: Literal["mean-motion", "printed"] = "mean-motion"

    def at_start(self, orbit: Floats) -> tuple[Floats, Floats]:
        """Position and velocity (3,) in LVLH, for the target's inertial state ``orbit`` (2, 3)."""
        e, sine, cosine = eccentricity(*orbit), math.sin(math.radians(self.phase_deg)), math.cos(math.radians(self.phase_deg))
        rate = mean_motion_rad_s(*orbit) if self.rate == "mean-motion" else _PRINTED_RATE_RAD_S
        speed = self.amplitude_m * rate * (2 + e) / (2 * math.sqrt((1 + e) * (1 - e) ** 3))
        position = self.amplitude_m * np.array([cosine, -2 * sine, 2 * cosine])
        return frozen(position), frozen(-speed * np.array([sine, 2 * cosine, 2 * sine]))


class TumbleInOrbit(Spec):
    """Both craft fall freely about the Earth, the target turns as a free body, the chaser keeps +z on its centre of mass.

    Inertial axes are J2000's, time 0 is the first frame. The target needs ``mass``; body axes are its principal axes.
    ``roll_reference``: inertial direction that is kept upwards before the chaser. ``j2``: the Earth's flatness, on both craft;
    ``gravity_gradient``: its torque on the target. The ``_psd_`` are densities q of white accelerations in each axis, so that
    the variance of a velocity grows by q a second; each is held for ``noise_hold_s``, with the variance q / ``noise_hold_s``.
    ``step_s``: of the integration.
    """

    type: Literal["tumble-in-orbit"]
    target_position_m: Vector3
    target_velocity_m_s: Vector3
    relative: Annotated[StateAtStart | Ellipse, Field(discriminator="type")]
    inertial_from_body_wxyz: Quaternion
    omega_body_rad_s: Vector3
    roll_reference: NonZeroVector3 = (0.0, 0.0, 1.0)
    j2: bool = False
    gravity_gradient: bool = False
    target_acceleration_psd_m2_s3: NonNegative = 0.0
    chaser_acceleration_psd_m2_s3: NonNegative = 0.0
    target_angular_acceleration_psd_rad2_s3: NonNegative = 0.0
    noise_hold_s: Positive = 1.0
    step_s: Annotated[float, Field(gt=0, le=10)] = 0.1

    @model_validator(mode="after")
    def _noise_changes_between_steps(self) -> "TumbleInOrbit":
        if abs(self.steps_held * self.step_s / self.noise_hold_s - 1) > 1e-9:
            raise ValueError(f"noise_hold_s {self.noise_hold_s:g} must be a whole multiple of step_s {self.step_s:g}")
        return self

    @model_validator(mode="after")
    def _steps_are_fine_enough(self) -> "TumbleInOrbit":
        turned = math.hypot(*self.omega_body_rad_s) * self.step_s
        if turned > _MOST_TURN_RAD:
            raise ValueError(
                f"step_s {self.step_s:g}: omega_body_rad_s turns the target by {turned:.3g} rad in a step, at most "
                f"{_MOST_TURN_RAD:g} can be integrated; a step_s of {_MOST_TURN_RAD * self.step_s / turned:.2g} or less will do"
            )
        return self

    @model_validator(mode="after")
    def _stays_in_orbit(self) -> "TumbleInOrbit":
        """A start below the ground has no velocity that mends it, so position and velocity are named together."""
        radius, (position, velocity) = math.hypot(*self.target_position_m), self.target_orbit
        if radius < EARTH_EQUATOR_M:
            raise ValueError(f"target_position_m lies {radius / 1e3:.0f} km from the Earth's centre: inside of the Earth")
        e, a = eccentricity(position, velocity), semi_major_axis_m(position, velocity)
        if a <= 0:
            raise ValueError(f"target_velocity_m_s is {math.hypot(*velocity):.0f} m/s: the target leaves the Earth (e = {e:.3f})")
        if a * (1 - e) < EARTH_EQUATOR_M:
            lowest_m = max(a * (1 - e), 0.0)
            raise ValueError(
                f"target_velocity_m_s lets the target fall to {lowest_m / 1e3:.0f} km from the Earth's centre: into the Earth"
            )
        return self

    @model_validator(mode="after")
    def _chaser_stands_apart(self) -> "TumbleInOrbit":
        position, _ = self.relative.at_start(self.target_orbit)
        if not position.any():
            raise ValueError("relative.position_m puts the chaser into the target's centre of mass")
        self.chaser_orbit()
        return self

    @property
    def steps_held(self) -> int:
        """Steps of the integration during which a disturbance stays the same."""
        return max(round(self.noise_hold_s / self.step_s), 1)

    @property
    def target_orbit(self) -> Floats:
        """The target's inertial position and velocity at the start, (2, 3)."""
        return frozen([self.target_position_m, self.target_velocity_m_s])

    def chaser_orbit(self) -> Floats:
        """The chaser's, (2, 3). Raises ``ValueError`` where there is none."""
        position, velocity = self.relative.at_start(self.target_orbit)
        return chaser_orbit(self.target_orbit, position, velocity, j2=self.j2)
