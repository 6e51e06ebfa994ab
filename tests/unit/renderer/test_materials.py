import pytest
from pydantic import TypeAdapter

from renderer.materials import bsdf, is_near_mirror, roughness_of
from scenes.material import Material
from scenes.spectrum import Quantity, on_band


def _material(**tree) -> Material:
    return TypeAdapter(Material).validate_python({"source": "test"} | tree)


def _mean(quantity: Quantity) -> float:
    return float(on_band(quantity).mean())


def test_each_kind_becomes_its_bsdf_with_folded_numbers():
    assert bsdf(_material(type="paint", reflectance=0.3), lambda value: 2 * value) == {
        "type": "diffuse",
        "reflectance": {"type": "uniform", "value": 0.6},
    }
    coated = bsdf(_material(type="coated", base_reflectance=0.3, refractive_index=1.4, roughness=0.1), lambda value: value)
    assert (coated["type"], coated["alpha"], coated["int_ior"], coated["nonlinear"]) == ("roughplastic", 0.1, 1.4, True)
    metal = bsdf(_material(type="metal", n=1.2, k=7.0, roughness=0.2), _mean)
    assert (metal["type"], metal["distribution"], metal["alpha"]) == ("roughconductor", "ggx", 0.2)
    assert (metal["eta"]["value"], metal["k"]["value"]) == pytest.approx((1.2, 7.0))


def test_a_film_on_metal_is_a_conductor_that_reflects_as_much():
    film = {"type": "film-on-metal", "n": 1.2, "k": 7.0, "film_index": 1.5, "roughness": 0.2}
    clear, opaque = (bsdf(_material(**film, film_transmittance=t), _mean) for t in (1.0, 0.0))
    assert (clear["type"], clear["eta"]["value"], clear["alpha"]) == ("roughconductor", 1.5, 0.2)
    n, k = clear["eta"]["value"], clear["k"]["value"]
    behind = (0.3**2 + 7.0**2) / (2.7**2 + 7.0**2)
    assert ((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2) == pytest.approx(0.04 + 0.96**2 * behind / (1 - 0.04 * behind))
    assert opaque["k"]["value"] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(("roughness", "near"), [(0.001, True), (0.0299, True), (0.03, False), (0.5, False)])
def test_near_mirrors_are_known(roughness: float, near: bool):
    assert is_near_mirror(_material(type="metal", n=1.0, k=6.0, roughness=roughness)) is near
    assert is_near_mirror(_material(type="coated", base_reflectance=0.5, roughness=roughness)) is near
    assert not is_near_mirror(_material(type="paint", reflectance=0.5))


def test_paint_has_no_roughness_and_films_do():
    film = _material(type="film-on-metal", n=0.1, k=3.0, film_index=1.5, film_transmittance=1.0, roughness=0.01)
    assert roughness_of(film) == 0.01
    assert is_near_mirror(film)
    assert roughness_of(_material(type="paint", reflectance=0.5)) is None
