"""Sunlight at one wavelength, also beyond the band of a camera."""

import numpy as np

from scenes.arrays import Floats
from scenes.incandescence import planck_w_m2_sr_nm
from scenes.spectrum import BAND_NM

_SUN_K = 5772.0  # effective temperature, IAU 2015 B3


def sunlight_w_m2_nm(on_band: Floats, wavelength_nm: float) -> float:
    """Irradiance at ``wavelength_nm`` from a solar spectrum on ``BAND_NM``.

    Beyond the band's end it goes on as a black body of the sun's temperature; at 1550 nm that is 13 % below ASTM E490, as the
    sun's opacity is least near there.
    """
    if wavelength_nm <= BAND_NM[-1]:
        return float(np.interp(wavelength_nm, BAND_NM, on_band))
    there, end = planck_w_m2_sr_nm(np.array([wavelength_nm, BAND_NM[-1]]), _SUN_K)
    return float(on_band[-1] * there / end)
