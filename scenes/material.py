"""Materials with optical constants and their source. What a renderer makes of them is the renderer's business."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from scenes.arrays import Floats
from scenes.fresnel import film_reflectance, normal_reflectance
from scenes.spec import Spec
from scenes.spectrum import BAND_NM, FractionQuantity, NonNegativeQuantity, Spectrum, on_band

Roughness = Annotated[float, Field(ge=1e-3, le=1)]


class Paint(Spec):
    """A Lambertian surface: the same radiance in every direction. ``reflectance`` is the hemispherical albedo."""

    type: Literal["paint"]
    description: str = ""
    source: str
    reflectance: FractionQuantity


class Coated(Spec):
    """A clear dielectric coat over a diffuse base (cover glass on solar cells, glossy paint).

    ``roughness``: GGX α of the coat; ``refractive_index`` of the coat; ``base_reflectance``: albedo of what lies below.
    """

    type: Literal["coated"]
    description: str = ""
    source: str
    base_reflectance: FractionQuantity
    refractive_index: Annotated[float, Field(gt=1, le=4)] = 1.5
    roughness: Roughness


class Metal(Spec):
    """A conductor with complex refractive index n + ik and GGX ``roughness`` α."""

    type: Literal["metal"]
    description: str = ""
    source: str
    n: NonNegativeQuantity
    k: NonNegativeQuantity
    roughness: Roughness

    @property
    def reflectance(self) -> Spectrum:
        """At normal incidence: what it reflects in all directions together."""
        return _spectrum(normal_reflectance(on_band(self.n), on_band(self.k)))


class FilmOnMetal(Spec):
    """A metal seen through a clear or absorbing film that is metallised on its back (MLI, second-surface mirrors).

    ``n``, ``k`` of the metal; ``film_index`` of the film; ``film_transmittance``: of the film's inside, one way, without the
    reflections of its faces; ``roughness``: GGX α of both faces.
    """

    type: Literal["film-on-metal"]
    description: str = ""
    source: str
    n: NonNegativeQuantity
    k: NonNegativeQuantity
    film_index: Annotated[float, Field(gt=1, le=4)]
    film_transmittance: FractionQuantity
    roughness: Roughness

    @property
    def reflectance(self) -> Spectrum:
        """At normal incidence: the film's front, and the metal behind it with all the reflections in between."""
        front = normal_reflectance(np.array(self.film_index), np.array(0.0))
        back = normal_reflectance(on_band(self.n), on_band(self.k), self.film_index)
        return _spectrum(film_reflectance(front, on_band(self.film_transmittance), back))


Material = Annotated[Paint | Coated | Metal | FilmOnMetal, Field(discriminator="type")]


def _spectrum(values: Floats) -> Spectrum:
    return Spectrum(wavelength_nm=tuple(BAND_NM.tolist()), value=tuple(values.tolist()))
