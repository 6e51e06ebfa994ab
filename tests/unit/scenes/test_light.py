import numpy as np
import pytest
from pydantic import ValidationError
from scipy.constants import c, h, k

from scenes.light import Sun
from scenes.scenario import Scenario, Scene, load_scenario, realize
from scenes.spectrum import BAND_NM, band_irradiance

SUN = {"type": "sun", "direction": (0.0, 0.0, -1.0)}


def _scene(at: int = 0, **changes) -> Scene:
    case = load_scenario("zhai2014-in-plane", ["frame_count=10"])
    sun = Sun.model_validate(SUN | changes)
    return realize(Scenario.model_validate(case.model_dump() | {"lights": {"sun": sun}}), 0, at)


def test_the_spectrum_is_that_of_the_sun():
    spectrum = Sun.model_validate(SUN).spectrum
    wavelength = BAND_NM * 1e-9
    planck = 2 * h * c**2 / wavelength**5 / np.expm1(h * c / (wavelength * k * 5772)) * 1e-9
    star = np.pi * planck * (6.957e8 / 1.495978707e11) ** 2
    # A black body of the sun's effective temperature: the sun is brighter in blue light and less so in the ultraviolet.
    assert band_irradiance(spectrum) == pytest.approx(np.trapezoid(star, BAND_NM), rel=0.01)
    assert np.abs(spectrum / star - 1)[BAND_NM >= 700].max() < 0.05
    assert 1.1 < (spectrum / star)[(BAND_NM >= 450) & (BAND_NM <= 480)].mean() < 1.2
    assert spectrum[BAND_NM == 300.0] < 0.7 * star[BAND_NM == 300.0]


def test_total_irradiance_scales_the_spectrum():
    half = Sun.model_validate(SUN | {"total_irradiance_w_m2": 683.05})
    assert half.spectrum == pytest.approx(0.5 * Sun.model_validate(SUN).spectrum)


def test_irradiance_falls_with_the_square_and_the_disk_with_the_distance():
    near, far = (_scene(distance_au=au).lights[0] for au in (1.0, 2.0))
    assert far.irradiance_w_m2_nm == pytest.approx(near.irradiance_w_m2_nm / 4)
    assert np.sin(near.emitter.half_angle_rad) == pytest.approx(2 * np.sin(far.emitter.half_angle_rad))
    assert near.emitter.half_angle_rad == pytest.approx(np.arcsin(6.957e8 / 1.495978707e11), rel=1e-3)


def test_the_direction_is_fixed_where_it_was_said():
    in_chaser, in_target = ([_scene(at, frame=axes).lights[0] for at in (0, 9)] for axes in ("chaser", "target"))
    assert all(light.direction_chaser == pytest.approx([0, 0, -1]) for light in in_chaser)
    assert all(light.direction_target == pytest.approx([0, 0, -1]) for light in in_target)
    assert in_chaser[0].direction_target != pytest.approx(in_chaser[1].direction_target, abs=1e-3)
    scene = _scene(5)
    back = scene.chaser_from_target.rotation.apply(np.array(scene.lights[0].direction_target))
    assert back == pytest.approx([0, 0, -1], abs=1e-15)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"direction": (0.0, 0.0, 0.0)}, "a zero vector has no direction"),
        ({"distance_au": 0.0}, "greater than 0"),
        ({"distance_au": {"draw": "uniform", "low": -1.0, "high": 1.0}}, "greater than 0, got values down to -1"),
        ({"distance_au": {"draw": "normal", "mean": 1.0, "sigma": 0.5}}, "greater than 0, got values down to -2"),
        ({"distance_au": 0.004}, r"down to 0.004, inside of the light: half_angle_deg 0.26\d* at 1 au makes its radius 0.0046"),
        ({"distance_au": {"draw": "uniform", "low": 0.3, "high": 1.0}, "half_angle_deg": 20.0}, "down to 0.3, .* 0.34202 au"),
        ({"distance_au": {"draw": "log-uniform", "low": 0.001, "high": 1.0}}, "down to 0.001, inside"),
        ({"distance_au": {"draw": "normal", "mean": 0.604, "sigma": 0.1}}, "down to 0.004, inside"),
        ({"half_angle_deg": 0.0}, "greater than 0"),
        ({"frame": "world"}, "chaser"),
    ],
)
def test_impossible_suns_are_refused(changes: dict, says: str):
    with pytest.raises(ValidationError, match=says):
        Sun.model_validate(SUN | changes)


def test_a_sun_just_outside_of_itself_is_nearly_half_the_sky():
    near = _scene(half_angle_deg=20.0, distance_au=1.0001 * np.sin(np.radians(20.0))).lights[0]
    assert np.degrees(near.emitter.half_angle_rad) == pytest.approx(np.degrees(np.arccos(np.sqrt(2e-4))), abs=0.01)
