"""The named numbers of the recommended filter, with unit and meaning."""

from typing import Annotated

from pydantic import Field

from scenes.spec import NonNegative, Positive, Spec


class StartParameters(Spec):
    """1σ of what is not known at the first measurement: no rotation, a sphere, no motion, centre of mass at the frame's origin."""

    omega_rad_s: Positive = 0.1
    inertia: Positive = 0.35  # of each component of J (trace 3); every body has |j| < 1.23
    range_m: Positive = 100.0  # of the centre of mass, before the first measurement
    velocity_m_s: Positive = 0.2
    offset_m: Positive = 2.0  # between the centre of mass and the target frame's origin, each axis


class NoiseParameters(Spec):
    """What the equations of motion leave out, as white noise of constant density on each axis, and what their linear form does."""

    rotation_rad2_s3: NonNegative = 1e-9  # of angular acceleration
    translation_m2_s3: NonNegative = 1e-7  # of acceleration relative to the chaser
    second_order: NonNegative = 0.25  # share of angular acceleration of second order in the errors that counts as noise (0: none) …
    remembered_s: Positive = 60.0  # … which stays the same for 1 / |ω|, but no longer than this


class MeasurementParameters(Spec):
    """What a registration's own covariance leaves out.

    Registrations err alike as long as a target is seen from the same side. Against a model at 5 cm range noise their errors had an
    autocorrelation of 0.3 (attitude) and 0.7 (position) after a second, and of 0.1 and 0.3 after ten.
    """

    scale: Positive = 1.0  # factor on the stated covariance
    floor_rad: NonNegative = 0.0  # 1σ that is added to each axis of the attitude …
    floor_m: NonNegative = 0.0  # … and of the position
    lasting: Annotated[float, Field(ge=0, lt=1)] = 0.5  # share of the stated covariance that is an error which stays for a while …
    drift_rad: NonNegative = 0.0  # … besides which such an error has this 1σ on each axis of the attitude …
    drift_m: NonNegative = 0.0  # … and of the position
    drift_time_s: Positive = 12.0  # over which it is forgotten: its autocorrelation is exp(−|Δt| / drift_time_s)
    gate: Annotated[float, Field(gt=0.5, le=1)] = 0.999  # share of good measurements that the χ² gate lets through; 1: no gate
    patience: Annotated[int, Field(ge=1)] = 5  # refused measurements in a row after which the filter doubts itself


class TumbleParameters(Spec):
    """Twenty states in the target's own axes: all of it."""

    start: StartParameters = StartParameters()
    noise: NoiseParameters = NoiseParameters()
    measurement: MeasurementParameters = MeasurementParameters()
    least_moment: Annotated[float, Field(gt=0, lt=1)] = 0.05  # no principal moment of J (trace 3) may fall below
    longest_step_s: Positive = 1.0  # of the integration of the equations of motion …
    longest_turn_rad: Positive = 0.1  # … which may not turn the target farther than this either
