"""Material → Mitsuba BSDF as a plain dictionary, spectra folded into one number each."""

from collections.abc import Callable
from typing import Any

from scenes.fresnel import extinction_for
from scenes.material import Coated, FilmOnMetal, Material, Metal, Paint
from scenes.spectrum import Quantity

NEAR_MIRROR_ROUGHNESS = 0.03  # below, a lobe is narrow against the sun's disk and light sampling alone gets noisy

Fold = Callable[[Quantity], float]


def bsdf(material: Material, fold: Fold) -> dict[str, Any]:
    """The BSDF that Mitsuba evaluates; ``fold`` gives the number that stands for a spectrum."""
    match material:
        case Paint():
            return {"type": "diffuse", "reflectance": _flat(fold(material.reflectance))}
        case Coated():
            return {
                "type": "roughplastic",
                "distribution": "ggx",
                "alpha": material.roughness,
                "int_ior": material.refractive_index,
                "ext_ior": 1.0,
                "diffuse_reflectance": _flat(fold(material.base_reflectance)),
                "nonlinear": True,
            }
        case Metal():
            return _conductor(fold(material.n), fold(material.reflectance), material.roughness)
        case FilmOnMetal():
            return _conductor(material.film_index, fold(material.reflectance), material.roughness)


def roughness_of(material: Material) -> float | None:
    """GGX α of a material's mirror-like lobe, None where it has none."""
    return None if isinstance(material, Paint) else material.roughness


def is_near_mirror(material: Material, light_radius_rad: float = 0.0) -> bool:
    """Whether a surface needs its own lobe sampled to find a light that looks so large (half its angle)."""
    narrow = max(NEAR_MIRROR_ROUGHNESS, light_radius_rad)
    roughness = roughness_of(material)
    return roughness is not None and roughness < narrow


def _conductor(n: float, reflectance: float, roughness: float) -> dict[str, Any]:
    """A conductor with index ``n`` whose k makes it reflect just this much at normal incidence.

    Means of n and k over a band would not: gold's reflectance jumps within it. A film on metal becomes a conductor with the
    film's index: one that lets no light through is then the dielectric that it is, and all of them reflect more at grazing
    angles, as films do (off the layers' own formula by 0.025 at most up to 40 degrees, 0.09 at 80).
    """
    return {
        "type": "roughconductor",
        "distribution": "ggx",
        "alpha": roughness,
        "eta": _flat(n),
        "k": _flat(extinction_for(reflectance, n)),
    }


def _flat(value: float) -> dict[str, Any]:
    return {"type": "uniform", "value": value}
