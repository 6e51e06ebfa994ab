"""Tabulated spectra and the one integral that a grey camera needs.

A grey camera has one band. Source, optics, detector and material spectra are folded into one number per light and one per
material before rendering: photo-electrons count photons, so the weight is E(λ)·QE(λ)·λ/(hc).
"""

from typing import Annotated

import numpy as np
from pydantic import AfterValidator, model_validator

from scenes.arrays import Floats, frozen
from scenes.constants import PLANCK_J_S, SPEED_OF_LIGHT_M_S
from scenes.spec import Spec

BAND_NM = frozen(np.arange(300.0, 1101.0, 5.0))  # where silicon sees; the step resolves every table in the library


class Spectrum(Spec):
    """A table of values over wavelength, interpolated linearly, constant beyond its ends unless ``zero_outside``."""

    wavelength_nm: tuple[float, ...]
    value: tuple[float, ...]
    zero_outside: bool = False

    @model_validator(mode="after")
    def _is_a_table(self) -> "Spectrum":
        if len(self.wavelength_nm) != len(self.value):
            raise ValueError(f"{len(self.wavelength_nm)} wavelengths but {len(self.value)} values")
        if len(self.wavelength_nm) < 1:
            raise ValueError("a spectrum needs at least one value")
        if any(b <= a for a, b in zip(self.wavelength_nm[:-1], self.wavelength_nm[1:])):
            raise ValueError("wavelength_nm must increase")
        if min(self.value) < 0:
            raise ValueError(f"a spectrum has no negative value, got {min(self.value)}")
        return self

    @property
    def on_band(self) -> Floats:
        """Values on ``BAND_NM``."""
        outside = 0.0 if self.zero_outside else None
        return frozen(np.interp(BAND_NM, self.wavelength_nm, self.value, left=outside, right=outside))


Quantity = float | Spectrum  # a plain number is a flat spectrum


def _not_negative(quantity: Quantity) -> Quantity:
    lowest = min(quantity.value) if isinstance(quantity, Spectrum) else quantity
    if lowest < 0:
        raise ValueError(f"must not be negative, got {lowest:g}")
    return quantity


def _at_most_one(quantity: Quantity) -> Quantity:
    highest = max(quantity.value) if isinstance(quantity, Spectrum) else quantity
    if highest > 1:
        raise ValueError(f"is a fraction, at most 1, got {highest:g}")
    return quantity


def sends_light(quantity: Quantity) -> Quantity:
    """``quantity`` if it is above zero somewhere in the band. Raises ``ValueError``."""
    if not on_band(quantity).any():
        raise ValueError(f"is zero from {BAND_NM[0]:g} to {BAND_NM[-1]:g} nm: there would be no light")
    return quantity


NonNegativeQuantity = Annotated[Quantity, AfterValidator(_not_negative)]
FractionQuantity = Annotated[Quantity, AfterValidator(_not_negative), AfterValidator(_at_most_one)]


def on_band(quantity: Quantity) -> Floats:
    """A number or a spectrum as values on ``BAND_NM``."""
    return quantity.on_band if isinstance(quantity, Spectrum) else frozen(np.full(BAND_NM.shape, quantity))


def electron_irradiance(spectral_irradiance_w_m2_nm: Floats, quantum_efficiency: Floats) -> float:
    """Photo-electrons per second and square metre of detector that an irradiance makes: ∫ E(λ)·QE(λ)·λ/(hc) dλ."""
    electrons_per_joule = quantum_efficiency * BAND_NM * 1e-9 / (PLANCK_J_S * SPEED_OF_LIGHT_M_S)
    return float(np.trapezoid(spectral_irradiance_w_m2_nm * electrons_per_joule, BAND_NM))


def band_irradiance(spectral_irradiance_w_m2_nm: Floats) -> float:
    """Irradiance within the band, W/m²: ∫ E(λ) dλ from 300 to 1100 nm."""
    return float(np.trapezoid(spectral_irradiance_w_m2_nm, BAND_NM))


def band_mean(values: Floats, weight: Floats) -> float:
    """The one number that stands for a material's spectrum: its mean under ``weight`` (both on ``BAND_NM``)."""
    total = float(np.trapezoid(weight, BAND_NM))
    if total <= 0:
        raise ValueError("the band's weight is zero everywhere: light and detector do not overlap in wavelength")
    return float(np.trapezoid(values * weight, BAND_NM)) / total
