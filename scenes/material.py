"""Materials with optical constants and their source. What a renderer makes of them is the renderer's business."""

from typing import Annotated, Literal

from pydantic import Field

from scenes.spec import Spec
from scenes.spectrum import FractionQuantity, NonNegativeQuantity

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


Material = Annotated[Paint | Coated | Metal, Field(discriminator="type")]
