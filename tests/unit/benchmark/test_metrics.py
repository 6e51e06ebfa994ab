"""Geodesic laws, SPEED's strict thresholds, and what the bootstrap promises: its coverage."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from benchmark import metrics


def test_geodesic_is_the_angle_of_the_turn_and_is_invariant() -> None:
    truth, turn = Rotation.random(50, rng=0), Rotation.from_rotvec([0.0, 0.3, 0.4])
    assert_allclose(metrics.geodesic(truth, truth * turn), 0.5, atol=1e-12)
    common = Rotation.random(rng=1)
    other = Rotation.random(50, rng=2)
    assert_allclose(metrics.geodesic(common * truth, common * other), metrics.geodesic(truth, other), atol=1e-7)
    assert_allclose(metrics.geodesic(truth, other), metrics.geodesic(other, truth), atol=1e-12)


def test_geodesic_resolves_small_angles() -> None:
    truth, turn = Rotation.random(rng=0), Rotation.from_rotvec([1e-9, 0.0, 0.0])
    assert_allclose(metrics.geodesic(truth, truth * turn), 1e-9, rtol=1e-3)


def test_speed_thresholds_are_strict() -> None:
    limit = metrics.SPEED_ROTATION_RAD
    below, above = np.nextafter(limit, 0), np.nextafter(limit, 1)
    assert_allclose(metrics.speed_rotation(np.array([0.0, below, limit, above])), [0.0, 0.0, limit, above], rtol=1e-15)
    truth = np.array([[0.0, 0.0, 1000.0]] * 2)
    scores = metrics.speed_position(truth, truth + np.array([[0, 0, 2.172], [0, 0, 2.174]]))
    assert_allclose(scores, [0.0, 2.174e-3], rtol=1e-12)


def test_autocorrelation_of_an_ar1_process_is_its_coefficient_and_of_white_noise_zero() -> None:
    rng, n = np.random.default_rng(0), 20_000
    white = rng.normal(size=n)
    coloured = np.zeros(n)
    for i in range(1, n):
        coloured[i] = 0.6 * coloured[i - 1] + white[i]
    everywhere = np.ones(n - 1, dtype=bool)
    assert metrics.lag1_autocorrelation(white, everywhere) == pytest.approx(0.0, abs=0.03)
    assert metrics.lag1_autocorrelation(coloured, everywhere) == pytest.approx(0.6, abs=0.03)


def test_autocorrelation_skips_pairs_across_a_gap() -> None:
    rng = np.random.default_rng(0)
    errors = np.repeat(rng.normal(size=2000), 2)  # pairs equal inside, independent across
    inside = np.arange(errors.size - 1) % 2 == 0
    assert metrics.lag1_autocorrelation(errors, inside) == pytest.approx(1.0, abs=1e-9)
    assert metrics.lag1_autocorrelation(errors, ~inside) == pytest.approx(0.0, abs=0.05)
    assert np.isnan(metrics.lag1_autocorrelation(errors[:3], inside[:2]))


def test_response_slope_tells_a_follower_from_a_constant() -> None:
    truth = np.linspace(-0.7, 0.7, 41)
    assert metrics.response_slope(truth, truth + 0.3) == pytest.approx(1.0)
    assert metrics.response_slope(truth, np.full(41, 0.1)) == pytest.approx(0.0, abs=1e-12)
    assert np.isnan(metrics.response_slope(np.zeros(41), truth))


def test_bootstrap_covers_the_true_mean_95_times_in_100_on_white_noise() -> None:
    covered = 0
    for trial in range(300):
        rng = np.random.default_rng(trial)
        interval = metrics.bootstrap(rng.normal(1.0, 2.0, size=60), lambda v: float(v.mean()), rng, resamples=300)
        covered += interval.low <= 1.0 <= interval.high
    assert 0.88 <= covered / 300 <= 0.98


def test_bootstrap_in_blocks_is_wider_than_single_frames_would_allow_when_errors_are_correlated() -> None:
    rng, n = np.random.default_rng(0), 400
    noise = rng.normal(size=n)
    coloured = np.zeros(n)
    for i in range(1, n):
        coloured[i] = 0.8 * coloured[i - 1] + noise[i]
    blocks = metrics.bootstrap(coloured, lambda v: float(v.mean()), np.random.default_rng(1))
    naive_width = 2 * 1.96 * coloured.std() / np.sqrt(n)
    assert blocks.high - blocks.low > 1.5 * naive_width


def test_bootstrap_is_seeded_and_honest_about_too_few_values() -> None:
    values = np.arange(20.0)
    first = metrics.bootstrap(values, np.median, np.random.default_rng(7))
    assert first == metrics.bootstrap(values, np.median, np.random.default_rng(7))
    assert first.value == 9.5
    two = metrics.bootstrap(values[:2], np.mean, np.random.default_rng(0))
    assert two.value == 0.5
    assert np.isnan(two.low)
    assert np.isnan(metrics.bootstrap(values[:0], np.mean, np.random.default_rng(0)).value)
