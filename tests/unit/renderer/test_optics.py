import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from renderer.optics import blurred, psf_kernel


@pytest.mark.parametrize("sigma_px", [0.05, 0.1, 0.3, 0.5, 0.8, 1.0, 2.5, 20.0])
def test_the_kernel_has_sum_one_mean_zero_and_exactly_its_variance(sigma_px: float):
    kernel = psf_kernel(sigma_px)
    offsets = np.arange(len(kernel)) - len(kernel) // 2
    assert kernel.sum() == pytest.approx(1.0, abs=1e-14)
    assert np.array_equal(kernel, kernel[::-1])
    assert (kernel >= 0).all()
    assert (kernel * offsets**2).sum() == pytest.approx(sigma_px**2, rel=1e-7)


def test_a_sampled_gaussian_would_have_too_little_variance():
    offsets = np.arange(-6, 7)
    sampled = np.exp(-(offsets**2) / (2 * 0.5**2))
    assert (sampled * offsets**2).sum() / sampled.sum() < 0.9 * 0.5**2


@pytest.mark.parametrize(("first", "second"), [(0.3, 0.4), (0.5, 1.2), (0.7, 0.7)])
def test_two_blurs_make_one(first: float, second: float):
    twice = np.convolve(psf_kernel(first), psf_kernel(second))
    once = psf_kernel(np.hypot(first, second))
    reach = min(len(twice), len(once)) // 2
    middle = slice(len(twice) // 2 - reach, len(twice) // 2 + reach + 1)
    assert np.abs(twice[middle] - once[len(once) // 2 - reach : len(once) // 2 + reach + 1]).max() < 1e-9


def test_a_blur_keeps_the_light_and_its_centre():
    picture = np.zeros((41, 51), np.float32)
    picture[18:22, 20:29] = np.random.default_rng(0).random((4, 9))
    soft = blurred(picture, 0.8)
    rows, columns = np.mgrid[0:41, 0:51]
    assert soft.sum() == pytest.approx(picture.sum(), rel=1e-6)
    for axis in (rows, columns):
        assert (soft * axis).sum() == pytest.approx((picture * axis).sum(), rel=1e-6)
    assert soft.dtype == np.float32


def test_a_wide_blur_is_the_gaussian_one():
    picture = np.random.default_rng(1).random((60, 60)).astype(np.float32)
    # Both are Gaussians of σ = 4 px up to terms of order 1 / (8 σ²).
    error = blurred(picture, 4.0) - gaussian_filter(picture, 4.0, mode="constant", truncate=6.0)
    assert np.abs(error).max() < 0.003


def test_no_blur_changes_nothing():
    picture = np.random.default_rng(2).random((5, 6)).astype(np.float32)
    assert np.array_equal(blurred(picture, 0.0), picture)
