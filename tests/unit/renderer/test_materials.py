import pytest
from pydantic import TypeAdapter

from renderer.materials import bsdf, is_near_mirror
from scenes.material import Material


def _material(**tree) -> Material:
    return TypeAdapter(Material).validate_python({"source": "test"} | tree)


def test_each_kind_becomes_its_bsdf_with_folded_numbers():
    assert bsdf(_material(type="paint", reflectance=0.3), lambda value: 2 * value) == {
        "type": "diffuse",
        "reflectance": {"type": "uniform", "value": 0.6},
    }
    coated = bsdf(_material(type="coated", base_reflectance=0.3, refractive_index=1.4, roughness=0.1), lambda value: value)
    assert (coated["type"], coated["alpha"], coated["int_ior"], coated["nonlinear"]) == ("roughplastic", 0.1, 1.4, True)
    metal = bsdf(_material(type="metal", n=1.2, k=7.0, roughness=0.2), lambda value: value)
    assert (metal["eta"]["value"], metal["k"]["value"], metal["distribution"]) == (1.2, 7.0, "ggx")


@pytest.mark.parametrize(("roughness", "near"), [(0.001, True), (0.0299, True), (0.03, False), (0.5, False)])
def test_near_mirrors_are_known(roughness: float, near: bool):
    assert is_near_mirror(_material(type="metal", n=1.0, k=6.0, roughness=roughness)) is near
    assert is_near_mirror(_material(type="coated", base_reflectance=0.5, roughness=roughness)) is near
    assert not is_near_mirror(_material(type="paint", reflectance=0.5))
