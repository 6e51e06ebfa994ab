"""The detector as EMVA 1288 (release 4.0) describes it: a user types the numbers of a vendor's data sheet."""

from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator

from scenes.spec import Fraction, NonNegative, Positive, Spec
from scenes.spectrum import BAND_NM, FractionQuantity, Quantity, on_band

ExposureTime = Annotated[float, Field(gt=0, le=3600)]


def _sees_the_band(efficiency: Quantity) -> Quantity:
    if not on_band(efficiency).any():
        raise ValueError(f"is zero from {BAND_NM[0]:g} to {BAND_NM[-1]:g} nm, the band of the lights: the camera would see nothing")
    return efficiency


class FixedExposure(Spec):
    """The same exposure time for every frame."""

    type: Literal["fixed"] = "fixed"
    time_s: ExposureTime


class AutoExposure(Spec):
    """Exposure that brings a percentile of the target's pixels to a fraction of full scale, within limits.

    The chosen value is recorded with each frame and depends on that frame alone, so any frame can be rendered by itself.
    """

    type: Literal["auto"] = "auto"
    percentile: Annotated[float, Field(gt=0, le=100)] = 95.0
    target_fraction: Annotated[float, Field(gt=0, le=1)] = 0.7
    shortest_s: ExposureTime = 1e-6
    longest_s: ExposureTime = 1.0

    @model_validator(mode="after")
    def _ordered(self) -> "AutoExposure":
        if self.longest_s < self.shortest_s:
            raise ValueError(f"longest_s {self.longest_s:g} lies below shortest_s {self.shortest_s:g}")
        return self


Exposure = Annotated[FixedExposure | AutoExposure, Field(discriminator="type")]


class Detector(Spec):
    """EMVA 1288 detector: mean and variance of the digital signal follow from these numbers.

    μ_y = K (μ_e + μ_d) + offset, σ_y² = K² (σ_d² + μ_e + μ_d) + σ_q² (EMVA 1288 eqs. 3-11), K in DN per electron.
    ``prnu`` is the standard deviation of the pixel gain (1.0 = 100 %), ``dsnu_e`` of the dark signal, both fixed patterns.
    ``psf_sigma_px`` is lens blur plus pixel diffusion as a Gaussian.
    """

    quantum_efficiency: Annotated[FractionQuantity, AfterValidator(_sees_the_band)]
    full_well_e: Positive
    gain_dn_per_e: Positive
    bits: Annotated[int, Field(ge=1, le=16)] = 8
    black_level_dn: NonNegative = 0.0
    read_noise_e: NonNegative = 0.0
    dark_current_e_s: NonNegative = 0.0
    prnu: Fraction = 0.0
    dsnu_e: NonNegative = 0.0
    shot_noise: bool = True
    psf_sigma_px: Annotated[float, Field(ge=0, le=20)] = 0.0

    @model_validator(mode="after")
    def _has_a_scale(self) -> "Detector":
        if self.black_level_dn >= self.white_dn:
            raise ValueError(f"black_level_dn {self.black_level_dn:g} lies above the white of {self.bits} bits, {self.white_dn}")
        return self

    @property
    def white_dn(self) -> int:
        """The largest digital number, 2^bits − 1."""
        return int(2**self.bits - 1)
