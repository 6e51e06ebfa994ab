"""A beam's sub-rays stand for equal shares of its spot and together have the spot's own variance."""

import numpy as np
import pytest
from pydantic import ValidationError

from scenes.laser_beam import Beam, sub_ray_directions


def beam(profile="top-hat", sub_rays=19, divergence_mrad=4.0) -> Beam:
    return Beam(wavelength_nm=1064.0, divergence_mrad=divergence_mrad, profile=profile, sub_rays=sub_rays)


@pytest.mark.parametrize("profile", ["gaussian", "top-hat"])
@pytest.mark.parametrize("sub_rays", [7, 19])
def test_sub_rays_have_the_variance_of_the_spot(profile, sub_rays):
    """A quarter of the full angle: of a Gaussian by the 1/e² width, of a uniform disk since its variance is r²/4."""
    offsets = beam(profile, sub_rays).offsets_rad
    assert offsets.shape == (sub_rays, 2)
    assert np.abs(offsets.mean(axis=0)).max() < 1e-18
    assert np.cov(offsets.T, bias=True) == pytest.approx(np.diag([1e-6, 1e-6]), abs=1e-18)
    assert offsets[0].tolist() == [0.0, 0.0]


def test_a_top_hat_s_rays_stay_within_its_rim_and_fill_it():
    radii = np.hypot(*beam().offsets_rad.T)
    assert radii.max() < 2e-3
    assert radii.max() > 0.75 * 2e-3


def test_a_gaussian_reaches_further_than_a_disk():
    far, near = (np.hypot(*beam(profile).offsets_rad.T).max() for profile in ("gaussian", "top-hat"))
    assert far > near


def test_one_ray_is_the_axis_and_a_beam_without_divergence_a_line():
    assert beam(sub_rays=1).offsets_rad.tolist() == [[0.0, 0.0]]
    assert beam(sub_rays=1).spacing_rad == 0.0
    assert not beam(divergence_mrad=0.0).offsets_rad.any()


def test_opposite_rays_of_a_ring_are_half_a_ring_apart():
    for sub_rays in (7, 19):
        offsets = beam(sub_rays=sub_rays).offsets_rad
        assert offsets[1:4] == pytest.approx(-offsets[4:7])
    assert offsets[7:13] == pytest.approx(-offsets[13:19])


def test_no_neighbour_is_further_than_the_spacing():
    offsets = beam().offsets_rad
    apart = np.linalg.norm(offsets[:, None] - offsets[None], axis=-1) + np.diag(np.full(19, np.inf))
    assert apart.min(axis=1).max() == pytest.approx(beam().spacing_rad)


def test_directions_are_at_the_offsets_from_their_axes():
    axes = np.array([[0.0, 0.0, 1.0], [0.6, -0.3, 0.5], [-0.2, 0.9, 0.3]])
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    offsets = beam().offsets_rad
    rays = sub_ray_directions(axes, offsets)
    assert rays.shape == (3, 19, 3)
    assert np.abs(rays[:, 0] - axes).max() < 1e-15
    angle = np.arccos(np.clip(np.einsum("bsi,bi->bs", rays, axes), -1, 1))
    assert np.abs(np.tan(angle) - np.hypot(*offsets.T)).max() < 1e-7  # arccos near 1 resolves no better
    assert rays[0, :, :2] / rays[0, :, 2:] == pytest.approx(offsets)


@pytest.mark.parametrize("changes", [{"sub_rays": 5}, {"divergence_mrad": -1.0}, {"wavelength_nm": 10_600.0}])
def test_what_no_beam_can_be_is_refused(changes):
    with pytest.raises(ValidationError):
        Beam(**({"wavelength_nm": 1064.0, "divergence_mrad": 1.0} | changes))
