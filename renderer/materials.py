"""Material → Mitsuba BSDF as a plain dictionary, spectra folded into one number each."""

from collections.abc import Callable
from typing import Any

from scenes.material import Coated, Material, Metal, Paint
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
            return {
                "type": "roughconductor",
                "distribution": "ggx",
                "alpha": material.roughness,
                "eta": _flat(fold(material.n)),
                "k": _flat(fold(material.k)),
            }


def is_near_mirror(material: Material, light_radius_rad: float = 0.0) -> bool:
    """Whether a surface needs its own lobe sampled to find a light that looks so large (half its angle)."""
    narrow = max(NEAR_MIRROR_ROUGHNESS, 2 * light_radius_rad)
    return isinstance(material, Coated | Metal) and material.roughness < narrow


def _flat(value: float) -> dict[str, Any]:
    return {"type": "uniform", "value": value}
