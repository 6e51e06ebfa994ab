"""Light as the eye counts it: a monitor's data sheet says candela per square metre, a renderer wants watts."""

import numpy as np

from scenes.arrays import Floats
from scenes.spectrum import BAND_NM, band_irradiance

_LUMENS_PER_WATT = 683.0  # at 555 nm: the definition of the candela, to 0.003 %
# CIE 1924 luminous efficiency for photopic vision (ISO 23539), every 10 nm.
_EYE_NM = np.arange(380.0, 781.0, 10.0)
_EYE = np.array(
    [0.000039, 0.00012, 0.000396, 0.00121, 0.004, 0.0116, 0.023, 0.038, 0.06, 0.09098, 0.13902, 0.20802, 0.323, 0.503, 0.71,
     0.862, 0.954, 0.99495, 0.995, 0.952, 0.87, 0.757, 0.631, 0.503, 0.381, 0.265, 0.175, 0.107, 0.061, 0.032, 0.017, 0.00821,
     0.004102, 0.002091, 0.001047, 0.00052, 0.000249, 0.00012, 0.00006, 0.00003, 0.000015],
    dtype=np.float64,
)


def eye_response() -> Floats:
    """V(λ) on ``BAND_NM``, at most 1."""
    return np.asarray(np.interp(BAND_NM, _EYE_NM, _EYE, left=0.0, right=0.0))


def lumens_per_watt(spectrum: Floats) -> float:
    """Luminous flux of one watt within the band: 683 lm/W · ∫ S V dλ / ∫ S dλ, for a ``spectrum`` S on ``BAND_NM`` of any scale."""
    return _LUMENS_PER_WATT * float(np.trapezoid(spectrum * eye_response(), BAND_NM)) / band_irradiance(spectrum)
