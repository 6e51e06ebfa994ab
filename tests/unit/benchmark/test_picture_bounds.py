"""Where noise of the rendering hides a pose, the variant is taken that counts it as noise of the picture."""

import numpy as np
import pytest

from benchmark.information.pictures import Derivatives, PictureBounds, bounds_of


def _bounds(brightness_e: float, noise: float, signal: float = 1.0) -> PictureBounds:
    """Six pixels tell one parameter each; a seventh, that tells nothing, is rendered with noise of opposite signs."""
    first = np.hstack([signal * np.eye(6), np.full((6, 1), noise)])
    second = np.hstack([signal * np.eye(6), np.full((6, 1), -noise)])
    mean, variance = np.full(7, brightness_e), np.array([*np.full(6, 1e-3), 1e3])
    return bounds_of(Derivatives(first, second, mean, variance), np.ones(7))


def test_a_determined_bound_is_taken_as_it_is() -> None:
    found = _bounds(100.0, noise=0.1)
    assert found.taken is found.known
    assert found.known.rotation_rad == pytest.approx(np.sqrt(3), rel=0.1)


def test_one_that_noise_hides_is_the_rendered_one() -> None:
    found = _bounds(100.0, noise=0.9)
    assert found.known.least_eigenvalue <= 0
    assert found.taken is found.rendered
    assert found.taken.is_determined
    assert found.taken.rotation_rad == pytest.approx(np.sqrt(3), rel=0.02)


def test_what_no_pixel_tells_stays_undetermined() -> None:
    assert not _bounds(0.0, noise=0.0, signal=0.0).taken.is_determined
