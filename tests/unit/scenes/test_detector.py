import pytest
from pydantic import ValidationError

from scenes.detector import AutoExposure, Detector, FixedExposure

GOOD = {"quantum_efficiency": 0.5, "full_well_e": 1e4, "gain_dn_per_e": 0.1}


@pytest.mark.parametrize(("bits", "white"), [(1, 1), (8, 255), (10, 1023), (12, 4095), (16, 65535)])
def test_white_is_the_last_number_of_the_bits(bits: int, white: int):
    assert Detector.model_validate(GOOD | {"bits": bits}).white_dn == white


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        pytest.param({"quantum_efficiency": 1.01}, "at most 1, got 1.01", id="more electrons than photons"),
        pytest.param({"quantum_efficiency": -0.1}, "must not be negative", id="negative efficiency"),
        pytest.param(
            {"quantum_efficiency": {"wavelength_nm": (400, 500), "value": (0.5, 1.5)}}, "at most 1, got 1.5", id="in a table"
        ),
        pytest.param({"quantum_efficiency": 0}, "is zero from 300 to 1100 nm", id="blind"),
        pytest.param(
            {"quantum_efficiency": {"wavelength_nm": (1200, 1500), "value": (0.5, 0.5), "zero_outside": True}},
            "is zero from 300 to 1100 nm",
            id="sees the infrared only",
        ),
        pytest.param({"black_level_dn": 255}, "black_level_dn 255 lies above the white of 8 bits, 255", id="no scale left"),
        pytest.param({"bits": 17}, "less than or equal to 16", id="bits"),
        pytest.param({"read_noise_e": -1}, "greater than or equal to 0", id="negative noise"),
        pytest.param({"prnu": 1.5}, "less than or equal to 1", id="prnu in per cent"),
        pytest.param({"full_well_e": 0}, "greater than 0", id="no well"),
        pytest.param({"gain": 0.1}, "Extra inputs", id="misspelt"),
    ],
)
def test_impossible_detectors_are_refused(changes: dict, says: str):
    with pytest.raises(ValidationError, match=says):
        Detector.model_validate(GOOD | changes)


def test_exposure_limits_are_in_order():
    with pytest.raises(ValidationError, match=r"longest_s 0\.001 lies below shortest_s 0\.01"):
        AutoExposure(type="auto", shortest_s=0.01, longest_s=0.001)
    assert AutoExposure(type="auto", shortest_s=0.01, longest_s=0.01).longest_s == 0.01


def test_an_efficiency_at_the_end_of_the_band_is_one():
    """The table is zero from 1099 nm down, the band's last wavelength is 1100 nm."""
    edge = {"wavelength_nm": (1099, 1101), "value": (0.0, 0.5)}
    assert Detector.model_validate(GOOD | {"quantum_efficiency": edge}).quantum_efficiency.on_band[-1] == pytest.approx(0.25)


def test_no_exposure_is_longer_than_an_hour():
    assert FixedExposure(time_s=3600.0).time_s == AutoExposure(longest_s=3600.0).longest_s == 3600.0
    with pytest.raises(ValidationError, match=r"time_s\n.*less than or equal to 3600"):
        FixedExposure(time_s=3600.1)
    with pytest.raises(ValidationError, match=r"longest_s\n.*less than or equal to 3600"):
        AutoExposure(longest_s=1e9)
