"""Sub-pixel edges: exact for every phase and slant without noise, and with it as good as they claim."""

from dataclasses import replace
from functools import partial

import cv2
import numpy as np
import pytest
import toy_renderer as toy
from toy_sweep import INTRINSICS

from estimators.mono_rectangle.edge_refit import EdgeRefit
from estimators.mono_rectangle.gradient_peak import to_gradient_peak
from estimators.mono_rectangle.stations import image_fraction, stations_along

CAMERA = replace(INTRINSICS, width_px=200, height_px=120, cx_px=99.5, cy_px=59.5)
QUAD = np.array([[40.0, 90.0], [160.0, 90.0], [40.0, 30.0], [160.0, 30.0]])
EDGE = 1  # P3P4, the upper one


def picture(quad, inside_dn=150.0, outside_dn=6.0, psf_px=0.5, seed=None, strip_dn=None, strip_px=0.8):
    """A quadrilateral of exact area coverage, blurred; optionally a bright strip above its upper edge."""
    signal = np.full((CAMERA.height_px, CAMERA.width_px), outside_dn)
    toy._add(signal, toy._hull(quad), [], inside_dn - outside_dn)
    if strip_dn is not None:
        upper = quad[2:]
        band = np.concatenate([upper, upper - [0, strip_px]])
        toy._add(signal, toy._hull(band), [], strip_dn - outside_dn)
    signal = cv2.GaussianBlur(signal, (9, 9), psf_px) if psf_px else signal
    if seed is None:
        return signal
    rng = np.random.default_rng(seed)
    noisy = rng.poisson(np.clip(signal, 0, None) * 25) / 25 + rng.normal(0, 0.4, signal.shape)
    return np.clip(np.rint(noisy), 0, 255).astype(np.uint8)


def fitted(pixels, quad, start_shift=0.0, polarity=1, camera=CAMERA, trim=(0.02, 2.5)):
    refit = EdgeRefit(camera, quad.mean(axis=0), 1.0, trim, None, (2.5, 4.5))
    ends = quad[[2, 3]]
    return refit.fit(pixels, ends + np.array([0, start_shift]), polarity)


def off_px(fit, quad):
    """Distance of both true ends from the fitted line, outward positive."""
    return (fit.ends_px - quad[[2, 3]]) @ fit.normal


@pytest.mark.parametrize("slope", [0.0, 0.003, 0.02, 0.1, 0.31, 0.75])
@pytest.mark.parametrize("psf_px", [0.4, 0.5, 0.7])
def test_no_bias_at_any_phase_slant_and_blur(slope, psf_px):
    for phase in np.linspace(-0.5, 0.5, 9):
        quad = QUAD + np.array([0.2, phase])
        quad[3, 1] += slope * 120 * (1 if slope < 0.5 else -0.3)
        fit = fitted(picture(quad, psf_px=psf_px), quad, start_shift=0.7)
        assert fit.is_plain
        assert np.abs(off_px(fit, quad)).max() < 0.012


def test_the_gradient_peak_alone_leans_with_the_phase():
    """The control: what the balance and the profile are there for."""
    quad = QUAD + np.array([0.2, 0.0])
    quad[3, 1] += 0.4
    pixels = picture(quad)
    one = EdgeRefit(CAMERA, quad.mean(axis=0), 1.0, (0.02, 2.5), None, (2.5, 4.5))
    rest = one._rest(pixels, quad[[2, 3]], partial(to_gradient_peak, sigma=1.0, polarity=1), 10, 1e-3)
    leaning = np.abs((rest.ends_px - quad[[2, 3]]) @ [0, 1]).max()
    assert leaning > 0.02
    assert np.abs(off_px(fitted(pixels, quad), quad)).max() < leaning / 5


@pytest.mark.parametrize(("inside_dn", "outside_dn"), [(150.0, 6.0), (40.0, 6.0), (150.0, 110.0)])
def test_claimed_and_real_scatter_agree(inside_dn, outside_dn):
    quad = QUAD + np.array([0.2, 0.3])
    fits = [fitted(picture(quad, inside_dn, outside_dn, seed=s), quad) for s in range(60)]
    errors = np.array([off_px(fit, quad) for fit in fits])
    claimed = np.sqrt(np.mean([np.diag(fit.covariance) for fit in fits], axis=0))
    assert errors.std(axis=0) == pytest.approx(claimed, rel=0.35)
    noise = np.hypot(np.sqrt((inside_dn + 0.0) / 25), 0.5) / (inside_dn - outside_dn)
    assert errors.std(axis=0).max() < 2 * 1.9 * noise / np.sqrt(110)  # twice the scatter at the middle, stations 1.9 σ/Δ
    assert np.abs(errors.mean(axis=0)).max() < 4 * errors.std() / np.sqrt(60) + 0.004


def test_a_strip_along_the_edge_is_said_not_to_be_plain():
    fit = fitted(picture(QUAD, inside_dn=40.0, strip_dn=140.0), QUAD)
    assert not fit.is_plain
    assert fit.covariance[0, 0] > 0.03**2
    slope = np.ptp(off_px(fit, QUAD))
    assert slope < 0.02  # shifted by the strip, but not turned


def test_polarity_and_a_line_without_an_edge():
    dark = picture(QUAD, inside_dn=30.0, outside_dn=150.0)
    assert np.abs(off_px(fitted(dark, QUAD, polarity=-1), QUAD)).max() < 0.01
    flat = np.full((120, 200), 80, np.uint8)
    nothing = fitted(flat, QUAD)
    assert nothing is None or nothing.inner_dn == nothing.outer_dn


def test_an_edge_crossed_by_a_boom_is_found_beside_it():
    pixels = picture(QUAD)
    pixels[:30, 70:76] = 120.0
    assert np.abs(off_px(fitted(pixels, QUAD), QUAD)).max() < 0.01


def test_an_edge_that_leaves_the_picture_and_one_outside():
    quad = QUAD + np.array([60.0, 0.0])  # its right end is beyond the border at x = 199.5
    signal = picture(QUAD)
    moved = np.concatenate([np.full((120, 60), 6.0), signal[:, :-60]], axis=1)
    assert np.abs(off_px(fitted(moved, quad), quad)).max() < 0.01
    assert fitted(signal, QUAD + np.array([300.0, 0.0])) is None
    assert fitted(signal, QUAD - np.array([0.0, 500.0])) is None


def test_stations_stand_on_whole_columns_and_leave_gaps_and_ends_out():
    ends, normal = np.array([[20.3, 40.0], [120.3, 45.0]]), np.array([0.0, -1.0])
    stations = stations_along(ends, normal, CAMERA, (0.02, 2.5), (0.4, 0.6))
    assert stations.upright
    assert np.issubdtype(stations.at.dtype, np.integer)
    assert stations.crossing == pytest.approx(40 + (stations.at - 20.3) * 0.05)
    assert stations.fraction == pytest.approx((stations.at - 20.3) / 100)
    assert stations.at.min() == 25
    assert not np.any((stations.fraction > 0.4) & (stations.fraction < 0.6))
    assert stations.cosine == pytest.approx(1 / np.hypot(1, 0.05))
    values, outward = stations.gather(np.arange(120)[:, None] * np.ones(200), 3)
    assert outward == pytest.approx(-(values - stations.crossing[:, None]) * stations.cosine[:, None])


def test_stations_follow_a_lens():
    """Stations of a straight line lie where the distorted line is: on cv2's projection of its points."""
    lens = replace(CAMERA, fx_px=150.0, fy_px=150.0, distortion=(-0.2, 0.05, 0.001, -0.002, 0.0))
    ends, normal = np.array([[20.0, 20.0], [180.0, 30.0]]), np.array([0.0, -1.0])
    stations = stations_along(ends, normal, lens, (0.0, 0.0))
    ideal = ends[0] + stations.fraction[:, None] * (ends[1] - ends[0])
    raw = lens.pixels_from_normalised((ideal - [lens.cx_px, lens.cy_px]) / 150.0)
    assert np.stack([stations.at, stations.crossing], axis=1) == pytest.approx(raw, abs=0.02)


def test_image_fraction_is_the_projective_map():
    """The middle of an edge twice as deep at its end is seen at two thirds of the way."""
    near, far = np.array([0.0, 0.0, 1.0]), np.array([2.0, 0.0, 2.0])
    for fraction in (0.0, 0.25, 0.5, 1.0):
        point = near + fraction * (far - near)
        assert image_fraction(fraction, 2.0) == pytest.approx(point[0] / point[2])
