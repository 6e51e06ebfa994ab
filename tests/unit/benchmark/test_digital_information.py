"""The detector's Fisher information against closed forms and against the spread of an ideal estimate."""

import numpy as np
import pytest

from benchmark.information.digital import digital_information
from scenes.detector import Detector

_EVERYWHERE = {"wavelength_nm": [300, 1100], "value": [0.5, 0.5]}


def _detector(**changes: object) -> Detector:
    plain = {"full_well_e": 10000, "gain_dn_per_e": 0.4, "bits": 12, "black_level_dn": 50, "read_noise_e": 8.0}
    return Detector.model_validate({"quantum_efficiency": _EVERYWHERE} | plain | changes)


def _at(mean_e: float, **changes: object) -> float:
    return float(digital_information(_detector(**changes), 1e-3)(np.array([mean_e]))[0])


def test_shot_noise_alone_gives_one_over_the_mean() -> None:
    for mean_e in (50.0, 500.0, 5000.0):
        assert _at(mean_e, read_noise_e=0.0, gain_dn_per_e=1.0, bits=14, full_well_e=12000) == pytest.approx(1 / mean_e, rel=2e-3)


def test_read_noise_alone_gives_one_over_its_variance_and_that_of_rounding() -> None:
    rounding = (1 / 0.4) ** 2 / 12
    assert _at(3000.0, shot_noise=False) == pytest.approx(1 / (64 + rounding), rel=2e-3)


@pytest.mark.parametrize("mean_e", [0.0, 30.0, 1000.0, 9000.0])
def test_both_together_are_those_of_a_gaussian_with_signal_in_its_variance(mean_e: float) -> None:
    """1/v + 1/(2 v²), v = μ + r² + q²/12 (Kay 1993, eq. 3.31 with ∂v/∂μ = 1)."""
    variance = mean_e + 64 + (1 / 0.4) ** 2 / 12
    assert _at(mean_e) == pytest.approx(1 / variance + 1 / (2 * variance**2), rel=4e-3)


def test_a_full_well_says_little_and_beyond_it_nothing() -> None:
    assert _at(10000.0) < 0.9 / 10000
    assert _at(11500.0) < 1e-3 / 10000


def test_black_level_zero_loses_half_of_the_dark_side() -> None:
    """Without a pedestal every negative reading is zero: what is left is more than half and less than all of it."""
    with_pedestal, without = _at(0.0), _at(0.0, black_level_dn=0)
    assert 0.5 * with_pedestal < without < 0.95 * with_pedestal


def test_an_unknown_gain_bounds_what_bright_pixels_tell() -> None:
    assert _at(8000.0, prnu=0.02) == pytest.approx(1 / (8000 + 64 + (1 / 0.4) ** 2 / 12 + 160.0**2), rel=0.02)


def test_the_spread_of_the_mean_of_many_readings_reaches_the_bound() -> None:
    """Monte-Carlo: readings of μ = 400, averaged over 64 pixels, spread by 1/√(64 w)."""
    rng, mean_e, detector = np.random.default_rng(0), 400.0, _detector()
    charge = rng.poisson(mean_e, (4000, 64)) + rng.normal(scale=8.0, size=(4000, 64))
    dn = np.clip(np.floor(charge * 0.4 + 50 + 0.5), 0, 4095)
    estimate = ((dn - 50) / 0.4).mean(axis=1)
    bound = 1 / np.sqrt(64 * digital_information(detector, 1e-3)(np.array([mean_e]))[0])
    assert estimate.std() == pytest.approx(bound, rel=0.04)
