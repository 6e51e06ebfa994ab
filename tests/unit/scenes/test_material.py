import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from scenes.material import Material
from scenes.scenario import load_scenario
from scenes.spectrum import BAND_NM, on_band

MATERIAL = TypeAdapter(Material)


@pytest.mark.parametrize(
    ("tree", "says"),
    [
        ({"type": "paint", "reflectance": 1.1}, "at most 1, got 1.1"),
        ({"type": "paint", "reflectance": {"wavelength_nm": (400, 500), "value": (0.9, 1.2)}}, "at most 1, got 1.2"),
        ({"type": "paint", "reflectance": -0.1}, "must not be negative"),
        ({"type": "coated", "base_reflectance": 0.5, "roughness": 0.0}, "greater than or equal to 0.001"),
        ({"type": "coated", "base_reflectance": 0.5, "roughness": 0.1, "refractive_index": 0.9}, "greater than 1"),
        ({"type": "metal", "n": -1.0, "k": 6.0, "roughness": 0.1}, "must not be negative"),
        (
            {"type": "film-on-metal", "n": 1.0, "k": 6.0, "film_index": 1.0, "film_transmittance": 1, "roughness": 0.1},
            "greater than 1",
        ),
        (
            {"type": "film-on-metal", "n": 1.0, "k": 6.0, "film_index": 1.5, "film_transmittance": 1.1, "roughness": 0.1},
            "at most 1",
        ),
        ({"type": "gold", "roughness": 0.1}, "tag"),
        ({"type": "paint", "reflectance": 0.5, "source": None}, "string"),
    ],
)
def test_impossible_materials_are_refused(tree: dict, says: str):
    with pytest.raises(ValidationError, match=says):
        MATERIAL.validate_python({"source": "test"} | tree)


def test_a_source_is_required():
    with pytest.raises(ValidationError, match="source"):
        MATERIAL.validate_python({"type": "paint", "reflectance": 0.5})


def test_the_librarys_aluminium_reflects_what_palik_says():
    metal = load_scenario("zhai2014-in-plane", ["target.wing_material=aluminium"]).target.parts[1].material
    n, k = on_band(metal.n), on_band(metal.k)
    reflectance = ((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2)
    for nm, expected in ((450, 0.924), (550, 0.921), (650, 0.912)):
        assert reflectance[nm == BAND_NM][0] == pytest.approx(expected, abs=0.01)
    assert reflectance.max() < 0.97  # never a perfect mirror, also beyond the table's ends
    assert reflectance.min() > 0.8
    assert np.isfinite(reflectance).all()


@pytest.mark.parametrize(("name", "absorptance"), [("white-paint", 0.26), ("black-paint", 0.95)])
def test_the_librarys_paints_absorb_what_they_say(name: str, absorptance: float):
    paint = load_scenario("zhai2014-in-plane", [f"target.body_material={name}"]).target.parts[0].material
    assert paint.reflectance == pytest.approx(1 - absorptance)
