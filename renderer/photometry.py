"""Folds spectra into the numbers that a grey camera's picture needs: one per light, one per material, one for the camera."""

from dataclasses import dataclass

import numpy as np

from scenes.arrays import Floats
from scenes.camera import Camera
from scenes.spectrum import BAND_NM, Quantity, band_irradiance, band_mean, electron_irradiance, on_band


@dataclass(frozen=True, slots=True, eq=False)
class Photometry:
    """A camera under a light's spectrum.

    ``weight``: photo-electrons per wavelength on ``BAND_NM``, for band means. ``responsivity_e_j``: photo-electrons per
    joule of the light's in-band power. ``electrons_per_radiance``: electrons/s of one pixel per W m⁻² sr⁻¹ of in-band
    radiance, responsivity · pixel area · π τ / (4 N²) (camera equation).
    """

    weight: Floats
    responsivity_e_j: float
    electrons_per_radiance: float

    def effective(self, quantity: Quantity) -> float:
        """The one number that stands for a material's spectrum before this camera in this light."""
        return band_mean(on_band(quantity), self.weight)


def photometry(camera: Camera, spectral_irradiance_w_m2_nm: Floats) -> Photometry:
    """How ``camera`` counts light of this spectrum (its scale does not matter)."""
    efficiency = on_band(camera.detector.quantum_efficiency)
    per_joule = electron_irradiance(spectral_irradiance_w_m2_nm, efficiency) / band_irradiance(spectral_irradiance_w_m2_nm)
    return Photometry(
        weight=np.asarray(spectral_irradiance_w_m2_nm * efficiency * BAND_NM),
        responsivity_e_j=per_joule,
        electrons_per_radiance=per_joule * camera.pixel_solid_etendue_m2_sr,
    )
