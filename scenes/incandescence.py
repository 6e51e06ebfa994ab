"""Light of hot bodies: Planck's law, tungsten's emissivity, and the ripple that alternating current leaves in a lamp."""

import math
from dataclasses import dataclass

import numpy as np

from scenes.arrays import Floats
from scenes.constants import BOLTZMANN_J_K, PLANCK_J_S, SPEED_OF_LIGHT_M_S

# Normal spectral emissivity of tungsten near 2800 K, rounded from de Vos 1954 (Physica 20, 690) up to 2.6 um; beyond that
# the free-electron trend 1/sqrt(wavelength) (Hagen & Rubens 1903), where a lamp radiates little.
_TUNGSTEN_NM = np.array([300, 350, 400, 500, 600, 700, 800, 900, 1000, 1200, 1400, 1600, 1800, 2000, 2300, 2600, 4000, 10000])
_TUNGSTEN = np.array(
    [0.475, 0.470, 0.462, 0.449, 0.436, 0.424, 0.409, 0.391, 0.370, 0.325, 0.282, 0.250, 0.228, 0.213, 0.199, 0.190, 0.153, 0.097]
)
_WIDE_NM = np.geomspace(250.0, 20_000.0, 2000)  # holds more than 99.9 % of what a filament radiates


def planck_w_m2_sr_nm(wavelength_nm: Floats, temperature_k: float) -> Floats:
    """Spectral radiance of a black body, W m⁻² sr⁻¹ nm⁻¹ (Planck 1901)."""
    wavelength_m = np.asarray(wavelength_nm) * 1e-9
    exponent = PLANCK_J_S * SPEED_OF_LIGHT_M_S / (wavelength_m * BOLTZMANN_J_K * temperature_k)
    return np.asarray(2 * PLANCK_J_S * SPEED_OF_LIGHT_M_S**2 / wavelength_m**5 / np.expm1(exponent) * 1e-9)


def tungsten_w_m2_sr_nm(wavelength_nm: Floats, temperature_k: float) -> Floats:
    """Spectral radiance of a tungsten filament: Planck's law times its emissivity."""
    return np.asarray(planck_w_m2_sr_nm(wavelength_nm, temperature_k) * np.interp(wavelength_nm, _TUNGSTEN_NM, _TUNGSTEN))


def share_per_nm(wavelength_nm: Floats, temperature_k: float) -> Floats:
    """Which share of a tungsten filament's radiant power falls into each nanometre, 1/nm."""
    whole = float(np.trapezoid(tungsten_w_m2_sr_nm(_WIDE_NM, temperature_k), _WIDE_NM))
    return np.asarray(tungsten_w_m2_sr_nm(wavelength_nm, temperature_k) / whole)


@dataclass(frozen=True, slots=True)
class Ripple:
    """Power that swings about its mean at twice the mains frequency: P(t) = 1 + depth · cos(2π · 2 f t + phase)."""

    mains_hz: float
    depth: float
    phase_rad: float = 0.0

    def mean(self, time_s: float, exposure_s: float) -> float:
        """Mean of P over an exposure about ``time_s``: 1 + depth · sinc(2 f T) · cos(2π · 2 f t + phase)."""
        frequency_hz = 2 * self.mains_hz
        swing = float(np.sinc(frequency_hz * exposure_s)) * math.cos(2 * math.pi * frequency_hz * time_s + self.phase_rad)
        return 1.0 + self.depth * swing
