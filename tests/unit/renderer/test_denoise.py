import numpy as np
import pytest

from renderer.denoise import denoise_indirect


def _noisy(seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A smooth layer on a round target, its noisy version, and the coverage."""
    rows, columns = np.mgrid[0:64, 0:96].astype(np.float32)
    coverage = (np.hypot(rows - 32, columns - 48) < 25).astype(np.float32)
    smooth = (2 + np.sin(rows / 9) + columns / 96) * coverage
    gain = np.random.default_rng(seed).gamma(4.0, 0.25, rows.shape)
    return smooth.astype(np.float32), (smooth * gain).astype(np.float32), coverage


def test_energy_is_kept_and_nothing_leaks_off_the_target():
    _, noisy, coverage = _noisy()
    filtered = denoise_indirect(noisy, coverage)
    assert filtered.sum(dtype=float) == pytest.approx(noisy.sum(dtype=float), rel=1e-5)
    assert (filtered[coverage == 0] == 0).all()
    assert (filtered >= 0).all()
    assert filtered.dtype == np.float32


def test_noise_falls_by_much_more_than_it_biases():
    smooth, noisy, coverage = _noisy()
    filtered = denoise_indirect(noisy, coverage)
    inside = coverage > 0
    before, after = (np.sqrt(np.mean((layer - smooth)[inside] ** 2)) for layer in (noisy, filtered))
    assert after < before / 4


def test_the_same_layer_gives_the_same_bytes():
    _, noisy, coverage = _noisy()
    assert np.array_equal(denoise_indirect(noisy, coverage), denoise_indirect(noisy.copy(), coverage.copy()))


def test_a_dark_layer_stays_dark():
    dark = np.zeros((16, 16), np.float32)
    assert np.array_equal(denoise_indirect(dark, np.ones_like(dark)), dark)
