"""Materials at a laser's wavelength."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from renderer.materials import bsdf
from scenes.fresnel import normal_reflectance
from scenes.material import Coated, Material, Paint
from scenes.spectrum import Quantity, Spectrum
from scenes.target import Target


@dataclass(frozen=True, slots=True)
class LaserLine:
    """One wavelength, where a camera has a band. Tables are taken as constant beyond their ends unless they say otherwise."""

    wavelength_nm: float

    def effective(self, quantity: Quantity) -> float:
        """The value of a number or a spectrum at the wavelength."""
        if not isinstance(quantity, Spectrum):
            return float(quantity)
        outside = 0.0 if quantity.zero_outside else None
        return float(np.interp(self.wavelength_nm, quantity.wavelength_nm, quantity.value, left=outside, right=outside))

    def albedo(self, material: Material) -> float:
        """What a surface sends back in all directions together, face on (the first reflection and the base under a coat)."""
        if isinstance(material, Paint):
            return self.effective(material.reflectance)
        if isinstance(material, Coated):
            coat = float(normal_reflectance(np.array(material.refractive_index), np.array(0.0)))
            return coat + (1 - coat) ** 2 * self.effective(material.base_reflectance)
        return self.effective(material.reflectance)


@dataclass(frozen=True, slots=True, eq=False)
class Surfaces:
    """Of each part, by its 1-based number (0 = no part): ``albedo``, and ``face_on``, its BSDF back along the normal, sr⁻¹."""

    albedo: NDArray[np.float64]
    face_on: NDArray[np.float64]


def surfaces(target: Target, line: LaserLine) -> Surfaces:
    """What becomes of light that meets a target's parts head on."""
    albedo = [0.0, *(line.albedo(part.material) for part in target.parts)]
    face_on = [0.0, *(_face_on(part.material, line) for part in target.parts)]
    return Surfaces(np.array(albedo), np.array(face_on))


def _face_on(material: Material, line: LaserLine) -> float:
    import drjit as dr
    import mitsuba as mi

    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi = mi.Vector3f(0, 0, 1)
    value = mi.load_dict(bsdf(material, line.effective)).eval(mi.BSDFContext(), si, mi.Vector3f(0, 0, 1))
    return float(np.array(value).ravel()[0])
