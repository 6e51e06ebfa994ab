"""From what a beam meets to what a receiver reports: the physics of a pulsed receiver, or the paper's short form of it."""

import math
from typing import Annotated, Literal

from pydantic import Field

from scenes.arrays import Floats
from scenes.constants import PLANCK_J_S, SPEED_OF_LIGHT_M_S
from scenes.spec import Fraction, NonNegative, Positive, Spec

FWHM_PER_SIGMA = 2 * math.sqrt(2 * math.log(2))  # of a Gaussian
_GOOD_RETURN = 10.0  # thresholds: the return for which a data sheet states its noise


class PhysicalRanging(Spec):
    """A pulsed time-of-flight receiver counted in photo-electrons.

    ``pulse_energy_j``: of one pulse, which all pixels of a flash share. ``aperture_m``: diameter of the receiver.
    ``transmission``: of the optics out and in together. ``pulse_width_s``: full width at half maximum; two surfaces further apart
    than half the way that light goes in that time give returns of their own. ``threshold_e``: electrons that make a return.
    ``noise_e``: rms of electronics and dark current within a pulse. ``excess_noise``: factor on the variance of shot noise
    (avalanche diodes: 2 to 5). ``jitter_s``: rms of the clock. ``false_alarm_probability``: of one beam within its gate.
    ``range_step_m``, ``intensity_step_e``: of the reported numbers, 0 = not rounded. Sunlight is let in through
    ``filter_width_nm`` (0 = no sunlight) from ``receiver_field_mrad``, full angle (0 = the beam's own).
    """

    type: Literal["physical"]
    pulse_energy_j: Positive
    aperture_m: Positive
    transmission: Annotated[Fraction, Field(gt=0)]
    quantum_efficiency: Annotated[Fraction, Field(gt=0)]
    pulse_width_s: Positive
    threshold_e: Positive
    noise_e: NonNegative = 0.0
    excess_noise: Annotated[float, Field(ge=1)] = 1.0
    jitter_s: NonNegative = 0.0
    false_alarm_probability: Fraction = 0.0
    range_step_m: NonNegative = 0.0
    intensity_step_e: NonNegative = 0.0
    filter_width_nm: NonNegative = 0.0
    receiver_field_mrad: NonNegative = 0.0

    @property
    def resolution_m(self) -> float:
        """Gap of two surfaces that give two returns: c/2 times the pulse's full width at half maximum."""
        return SPEED_OF_LIGHT_M_S / 2 * self.pulse_width_s

    @property
    def pulse_sigma_m(self) -> float:
        """Standard deviation of the pulse, as a range."""
        return self.resolution_m / FWHM_PER_SIGMA

    @property
    def jitter_m(self) -> float:
        """The clock's jitter as a range."""
        return SPEED_OF_LIGHT_M_S / 2 * self.jitter_s

    def electrons_per_joule(self, wavelength_nm: float) -> float:
        """Photo-electrons per joule that enters the receiver's aperture: τ η λ / (h c)."""
        photons = wavelength_nm * 1e-9 / (PLANCK_J_S * SPEED_OF_LIGHT_M_S)
        return self.transmission * self.quantum_efficiency * photons

    @property
    def aperture_m2(self) -> float:
        """Area of the receiver."""
        return math.pi * self.aperture_m**2 / 4

    def noise_variance_e2(self, electrons: Floats, background_e: Floats | float = 0.0) -> Floats:
        """Variance of the counted electrons: F · (signal + background) + noise²."""
        return self.excess_noise * (electrons + background_e) + self.noise_e**2

    def range_sigma_m(self, electrons: Floats, stretch_m: Floats | float = 0.0, background_e: Floats | float = 0.0) -> Floats:
        """1σ of the range of a return: pulse and footprint together over the signal-to-noise ratio, and the clock's jitter.

        σ_t = σ_pulse / SNR is the Cramér–Rao bound of a Gaussian pulse in shot noise, where SNR = √N. A surface that is deep
        within the footprint stretches the pulse by ``stretch_m`` (1σ of range over the spot).
        """
        relative2 = self.noise_variance_e2(electrons, background_e) / electrons**2
        return (relative2 * (self.pulse_sigma_m**2 + stretch_m**2) + self.jitter_m**2) ** 0.5

    @property
    def stated_sigma_m(self) -> float:
        """1σ that a data sheet would state: of a return ten times above threshold from a surface that faces the beam."""
        timing = float(self.range_sigma_m(_GOOD_RETURN * self.threshold_e))  # type: ignore[arg-type]
        return math.hypot(timing, self.range_step_m / math.sqrt(12))


class PaperRanging(Spec):
    """The model of Song et al. 2017, section 4: noise on the range, more of it at edges, and a dead zone at large angles.

    ``sigma_m``: of every range. ``edge_sigma_m``: further noise on beams whose spot lies across an edge: part of it passes the
    surface by that the beam's axis meets, or meets another more than ``edge_step_m`` deeper. A beam at incidence θ is kept with
    probability 1 / (1 + exp((θ − cutoff) / width)): ``cutoff_deg``, ``cutoff_width_deg``.
    """

    type: Literal["paper"]
    sigma_m: NonNegative
    edge_sigma_m: NonNegative = 0.0
    edge_step_m: Positive = 0.1
    cutoff_deg: Annotated[float, Field(gt=0, le=90)] = 90.0
    cutoff_width_deg: Positive = 1e-3

    @property
    def stated_sigma_m(self) -> float:
        """1σ of a range away from edges."""
        return self.sigma_m


RangingModel = Annotated[PhysicalRanging | PaperRanging, Field(discriminator="type")]
