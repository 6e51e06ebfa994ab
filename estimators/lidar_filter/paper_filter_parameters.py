"""The named numbers of the paper's filter; the defaults are those of Song et al. 2017, § 5.1, except for what is guessed at first.

The paper starts "from 150 % of the simulated values". A filter is never told these: a suite that wants that start gives numbers.
"""

from typing import Annotated

from pydantic import Field

from scenes.quaternion import Quaternion
from scenes.spec import NonNegative, Positive, Spec, Vector3

Ratio = Annotated[float, Field(gt=0)]


class Repairs(Spec):
    """What is mended in the printed equations, one by one; ``PaperFilterParameters.printed`` turns all of them off."""

    omega_sign: bool = True  # F_r holds +∂δq̇_v/∂δω (printed: −)
    half_angle: bool = True  # H_1 = −2 R [ρ]×, as δq_v is half an angle (printed without the 2)
    noise_order: bool = True  # Q takes the rotation's noise for the rotation (printed: the translation's, and the other way round)
    sign_alignment: bool = True  # the measured quaternion is taken with the sign that is nearer to the estimate's
    unit_correction: bool = True  # a correction of more than 180° is cut there; printed, its scalar part has no real value


class GuessParameters(Spec):
    """The first state. The attitude comes from the first measurement."""

    omega_body_rad_s: Vector3 = (0.0, 0.0, 0.0)
    p: tuple[Ratio, Ratio] = (1.0, 1.0)  # I_y / I_x and I_z / I_x
    position_lvlh_m: Vector3 | None = None  # None: where the first measurement sees the target frame's origin
    velocity_lvlh_m_s: Vector3 = (0.0, 0.0, 0.0)
    body_from_target_wxyz: Quaternion = (1.0, 0.0, 0.0, 0.0)  # {P} → {B}
    offset_target_m: Vector3 = (0.0, 0.0, 0.0)  # ρ, from the centre of mass to the target frame's origin


class VarianceParameters(Spec):
    """P_0: variances of each axis of the first errors, as printed."""

    attitude: Positive = 1.0  # of the quaternion's vector part
    omega_rad2_s2: Positive = 0.1
    p: Positive = 0.1
    position_m2: Positive = 25.0
    velocity_m2_s2: Positive = 0.1
    body_attitude: Positive = 1.0  # of the vector part of {P} → {B}
    offset_m2: Positive = 1.0


class PaperFilterParameters(Spec):
    """Twenty states in the target's principal axes: all of it."""

    printed: bool = False  # the equations as they stand in the paper, without a repair
    repairs: Repairs = Repairs()
    guess: GuessParameters = GuessParameters()
    variance: VarianceParameters = VarianceParameters()
    rotation_noise_rad2_s3: NonNegative = 1e-7  # σ_fr², read as the density of angular acceleration, with J = 1 in Γ_r
    translation_noise_m2_s3: NonNegative = 1e-7  # σ_ft², read as the density of acceleration
    position_variance_m2: Positive = 1.0  # R: of l …
    attitude_variance: Positive = 1e-4  # … and of the measured quaternion's vector part
    at_own_instant: bool = False  # a late scan is taken in where it belongs; the paper takes it for the present
    longest_step_s: Positive = 1.0  # of Φ = 1 + F Δt; the paper's period

    @property
    def mended(self) -> Repairs:
        """The repairs that are in force."""
        if not self.printed:
            return self.repairs
        return Repairs(**dict.fromkeys(Repairs.model_fields, False))
