"""The edges of ``stereo-ring``: where they are to a hundredth of a pixel, what a true one looks like, and the joint circles."""

from dataclasses import replace

import numpy as np
import pytest
import toy_ring as toy
from scipy.spatial.transform import Rotation

from estimators.stereo_ring.circle_cone import Circle
from estimators.stereo_ring.circle_fit import fit_circle, fit_circles
from estimators.stereo_ring.conics import points_on_ellipse
from estimators.stereo_ring.edge_peaks import edge_peaks, peaks_in
from estimators.stereo_ring.measurement import measured
from estimators.stereo_ring.parameters import RefineParameters, TrackedParameters
from estimators.stereo_ring.pictures import Smoothed, smoothed
from estimators.stereo_ring.promotion import inner_share_of, promoted
from estimators.stereo_ring.refine import refined, scaled_window
from estimators.stereo_ring.robust import median_of_known, tukey_weights

PARAMETERS = TrackedParameters()


@pytest.fixture(scope="module")
def scene():
    return toy.Scene(toy.left_from_ring(5.2, 12, 7, 20))


@pytest.fixture(scope="module")
def views(scene):
    return tuple(
        smoothed(image.pixels, scene.ellipse(view).centre_px, 400, 1.0)
        for view, image in enumerate(scene.observation().images.values())
    )


def true_circle(scene, radius_m=0.6):
    return Circle(scene.left_from_ring.translation, scene.left_from_ring.rotation.as_matrix()[:, 2], radius_m)


def disturbed(circle, by_m=0.003, by_deg=0.3):
    turn = Rotation.from_rotvec([np.radians(by_deg), 0, 0])
    return Circle(circle.centre_m + np.array([by_m, -by_m, 3 * by_m]), turn.apply(circle.normal), circle.radius_m * 1.002)


def test_a_step_is_found_where_it_is_at_every_phase():
    """A blurred step through a bilinear picture: the parabola is good to a few hundredths of a pixel, either sign."""
    columns = np.arange(40.0)
    for place in 18 + np.linspace(0, 1, 11):
        picture = 1 / (1 + np.exp(-(columns - place) / 0.6))
        for sign in (1, -1):
            view = smoothed(np.tile(sign * 50 * picture, (9, 1)), None, 0, 1.0)
            peaks = edge_peaks(view, np.array([[18.5, 4.0]]), np.array([[1.0, 0.0]]), 3.0, 1.0)
            assert peaks.found.all()
            assert peaks.distance_px[0] == pytest.approx(place - 18.5, abs=0.03)
            assert np.sign(peaks.gradient[0]) == sign


def test_an_edge_at_the_end_of_the_reach_is_none():
    ramp = Smoothed(np.tile(np.arange(40.0) ** 2, (9, 1)).astype(np.float32), np.zeros(2))
    assert not edge_peaks(ramp, np.array([[18.5, 4.0]]), np.array([[1.0, 0.0]]), 3.0, 1.0).found.any()


def test_the_first_edge_is_not_the_steepest():
    distance = np.arange(-4, 4.5, 0.5)
    profile = (-3 * np.exp(-((distance + 1) ** 2)) + 20 * np.exp(-((distance - 2) ** 2))).astype(np.float32)[None]
    assert peaks_in(profile, distance, 3.0, 1.0).distance_px[0] == pytest.approx(2.0, abs=0.1)
    assert peaks_in(profile, distance, 3.0, 1.0, first=True).distance_px[0] == pytest.approx(-1.0, abs=0.2)
    assert peaks_in(profile, distance, 3.0, 5.0, first=True).distance_px[0] == pytest.approx(2.0, abs=0.1)


def test_medians_of_rows_with_holes_are_those_of_their_known_values():
    values = np.random.default_rng(3).uniform(size=(20, 9))
    known = np.random.default_rng(4).uniform(size=(20, 9)) < 0.6
    for row, keep, median in zip(values, known, median_of_known(values, known), strict=True):
        expected = np.sort(row[keep])[(keep.sum() - 1) // 2] if keep.any() else 0.0
        assert median == expected


def test_a_far_outlier_weighs_nothing_and_an_unknown_value_neither():
    residual = np.array([0.1, -0.1, 0.05, 0.02, 9.0, 0.0])
    weight = tukey_weights(residual, np.array([True] * 5 + [False]), 0.05)
    assert weight[4:].tolist() == [0, 0]
    assert (weight[:4] > 0.5).all()


@pytest.mark.parametrize("radius_m", [0.6, 0.56])
def test_ellipses_settle_on_the_edge_to_a_tenth_of_a_pixel(scene, views, radius_m):
    for view, picture in enumerate(views):
        truth = scene.ellipse(view, radius_m).parameters
        starts = truth + np.array([[1.0, -0.8, 0.7, -0.6, 0.01], [60, 60, -40, -40, 0]])
        fit = refined(picture, starts, (4.0, 3.0), RefineParameters())
        assert np.abs(fit.parameters[0, :4] - truth[:4]).max() < 0.1
        assert fit.share[0] > 0.8
        assert fit.rms_px[0] < 0.3
        assert fit.share[1] < 0.4  # an ellipse somewhere else has no edge all round


def test_windows_shrink_with_the_ring_but_not_to_nothing():
    assert scaled_window(6.0, np.array([20.0, 125.0, 800.0])) == pytest.approx([1.5, 3.0, 6.0])


@pytest.mark.parametrize("radius_m", [0.6, 0.56])
def test_the_joint_circle_is_right_to_a_part_in_ten_thousand(scene, views, radius_m):
    truth = true_circle(scene, radius_m)
    found = measured(views, toy.rig(), disturbed(truth), (4.0, 2.0), PARAMETERS.measure)
    assert np.linalg.norm(found.circle.centre_m - truth.centre_m) < 5e-4
    assert np.degrees(np.linalg.norm(np.cross(found.circle.normal, truth.normal))) < 0.08
    assert found.circle.radius_m == pytest.approx(radius_m, abs=4e-4)
    assert found.is_within(0.8, 0.3)


def test_a_circle_elsewhere_is_not_supported(scene, views):
    wrong = replace(true_circle(scene), radius_m=0.5)
    found = measured(views, toy.rig(), wrong, (2.0,), PARAMETERS.measure)
    assert found is None or not found.is_within(PARAMETERS.acquire.share, PARAMETERS.acquire.rms_px)


def test_pictures_without_edges_give_no_circle(scene):
    blank = Smoothed(np.full((900, 900), 40, np.float32), np.array([300.0, 500.0]))
    assert measured((blank, blank), toy.rig(), true_circle(scene), (4.0,), PARAMETERS.measure) is None


def test_the_inner_edge_is_promoted_to_the_outer_and_the_outer_to_nothing(scene, views):
    inner = measured(views, toy.rig(), true_circle(scene, 0.56), (3.0, 2.0), PARAMETERS.measure)
    outer = promoted(views, toy.rig(), inner, PARAMETERS)
    assert outer.circle.radius_m == pytest.approx(0.6, abs=3e-4)
    assert promoted(views, toy.rig(), outer, PARAMETERS) is outer
    assert inner_share_of(views, toy.rig(), outer, PARAMETERS) == pytest.approx(0.56 / 0.6, abs=1e-3)


def edge_points(scene, radius_m, sigma_px, rng, count=200):
    return tuple(
        points_on_ellipse(scene.ellipse(view, radius_m), count) + rng.normal(0, sigma_px, (count, 2)) for view in range(2)
    )


def test_two_circles_in_one_plane_are_fitted_together_and_better_than_one(scene):
    """Noise of one size on both: the variance of what they share falls, by about two for equal numbers of points."""
    rng, truth = np.random.default_rng(11), true_circle(scene)
    one, both = [], []
    for _ in range(40):
        outer, inner = edge_points(scene, 0.6, 0.2, rng), edge_points(scene, 0.56, 0.2, rng)
        alone = fit_circle(toy.rig(), *outer, truth)
        together = fit_circles(toy.rig(), [outer, inner], truth, [0.6, 0.57])
        one.append(alone.circle.centre_m - truth.centre_m)
        both.append(together.circle.centre_m - truth.centre_m)
        assert together.radii_m == pytest.approx([0.6, 0.56], abs=1e-3)
        assert together.covariance.shape == (7, 7)
    ratio = np.var(both, axis=0).sum() / np.var(one, axis=0).sum()
    assert 0.3 < ratio < 0.75


def test_one_circle_is_a_special_case_of_several(scene):
    points = edge_points(scene, 0.6, 0.1, np.random.default_rng(5))
    alone = fit_circle(toy.rig(), *points, true_circle(scene))
    several = fit_circles(toy.rig(), [points], true_circle(scene), [0.6])
    assert np.array_equal(alone.circle.centre_m, several.circle.centre_m)
    assert np.array_equal(alone.left_px, several.residuals_px[0][0])
