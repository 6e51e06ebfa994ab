import numpy as np
import pytest
from pydantic import ValidationError
from scipy.constants import c, h

from scenes.spectrum import BAND_NM, Spectrum, band_irradiance, band_mean, electron_irradiance, on_band


def test_a_table_is_interpolated_and_held_at_its_ends():
    values = Spectrum(wavelength_nm=(400.0, 600.0), value=(1.0, 3.0)).on_band
    assert values[BAND_NM == 500.0] == pytest.approx(2.0)
    assert values[0] == 1.0
    assert values[-1] == 3.0
    line = Spectrum(wavelength_nm=(400.0, 600.0), value=(1.0, 3.0), zero_outside=True).on_band
    assert line[BAND_NM < 400].max() == 0.0
    assert line[BAND_NM > 600].max() == 0.0
    assert line[BAND_NM == 400.0] == 1.0


@pytest.mark.parametrize(
    ("nm", "value", "says"),
    [
        ((400.0,), (1.0, 2.0), "1 wavelengths but 2 values"),
        ((), (), "at least one value"),
        ((500.0, 400.0), (1.0, 2.0), "must increase"),
        ((400.0, 400.0), (1.0, 2.0), "must increase"),
        ((400.0, 500.0), (1.0, -2.0), "no negative value, got -2.0"),
        ((400.0, float("nan")), (1.0, 2.0), "finite"),
    ],
)
def test_what_is_no_table_is_refused(nm: tuple[float, ...], value: tuple[float, ...], says: str):
    with pytest.raises(ValidationError, match=says):
        Spectrum(wavelength_nm=nm, value=value)


def test_a_watt_of_monochromatic_light_makes_its_photons():
    line = np.where(BAND_NM == 700.0, 1.0 / 5.0, 0.0)  # 1 W/m² within one step of 5 nm
    assert band_irradiance(line) == pytest.approx(1.0)
    assert electron_irradiance(line, np.full_like(BAND_NM, 0.4)) == pytest.approx(0.4 * 700e-9 / (h * c), rel=1e-9)


def test_a_band_mean_is_a_mean():
    weight = np.random.default_rng(0).random(len(BAND_NM))
    assert band_mean(on_band(0.3), weight) == pytest.approx(0.3)
    assert band_mean(BAND_NM, weight) == pytest.approx(np.trapezoid(weight * BAND_NM) / np.trapezoid(weight))
    with pytest.raises(ValueError, match="do not overlap"):
        band_mean(BAND_NM, np.zeros_like(BAND_NM))


def test_the_band_resolves_every_table_of_the_library():
    from scenes.scenario import load_scenario

    case = load_scenario("zhai2014-in-plane")
    efficiency = case.cameras["nav"].detector.quantum_efficiency
    assert isinstance(efficiency, Spectrum)
    assert set(efficiency.wavelength_nm) <= set(BAND_NM)
    assert np.array_equal(np.array(efficiency.value), efficiency.on_band[np.isin(BAND_NM, efficiency.wavelength_nm)])


def test_a_table_that_was_used_equals_one_that_was_not():
    used, fresh = (Spectrum(wavelength_nm=(400.0, 500.0), value=(0.1, 0.2)) for _ in range(2))
    assert used.on_band.any()
    assert used == fresh
