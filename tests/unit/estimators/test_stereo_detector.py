"""The arc-support ellipse detector on drawn pictures, its parts against plain oracles, and pictures with nothing in them."""

import cv2
import numpy as np
import pytest
import toy_ring as toy

from estimators.stereo_ring.arc_groups import arc_groups
from estimators.stereo_ring.arcs import arc_support, edge_pieces, peak_offset
from estimators.stereo_ring.clusters import alike, distinct
from estimators.stereo_ring.conics import conics_from_parameters, points_on_parameters
from estimators.stereo_ring.coverage import coverage_of
from estimators.stereo_ring.detector import detect_ellipses
from estimators.stereo_ring.detector_parameters import DetectorParameters
from estimators.stereo_ring.ellipse_fits import direct_fits, ellipse_fits, point_scatter
from estimators.stereo_ring.growth import grown
from estimators.stereo_ring.segments import in_camera_pixels, line_segments, reduced

FRONT, ASIDE = (0.0, 0.0, 1.0), (-0.8, 0.2, 0.6)


@pytest.fixture(scope="module", autouse=True)
def _one_thread():
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    yield
    cv2.setNumThreads(before)


@pytest.fixture(scope="module")
def scenes():
    """Rings at the two ends of the paper's ranges and between, lit from the front and from aside, with the left picture."""
    places = [(3.45, FRONT), (5.2, ASIDE), (10.0, FRONT), (10.0, ASIDE)]
    made = [toy.Scene(toy.left_from_ring(z, 12, 7, 10), light=light, texture_dn=4) for z, light in places]
    return [(scene, toy.expose(toy.draw(scene, 0), 1)) for scene in made]


def blank(width=600, height=500, value=40.0):
    return np.full((height, width), value, np.float32)


def drawn(parameters, inside=160.0, outside=40.0, **size):
    picture = blank(value=outside, **size)
    toy.paint_ellipse(picture, conics_from_parameters(parameters), inside)
    return toy.expose(cv2.GaussianBlur(picture, (5, 5), 0.6), 0)


def apart(candidate, ellipse):
    return np.abs(candidate.ellipse.parameters - ellipse.parameters)[:4].max()


@pytest.mark.parametrize("polarity", ["same", "any"])
def test_both_edges_of_the_ring_are_found(scenes, polarity):
    for scene, picture in scenes:
        found = detect_ellipses(picture, DetectorParameters(polarity=polarity))
        inner = min(found, key=lambda one: apart(one, scene.ellipse(0, scene.inner_m)))
        outer = min(found, key=lambda one: apart(one, scene.ellipse(0)))
        assert apart(inner, scene.ellipse(0, scene.inner_m)) < 0.25
        assert apart(outer, scene.ellipse(0)) < 0.5  # the wall behind it and the shadow beside it lean on the edge
        assert inner.bright_inside < -0.9
        assert outer.bright_inside > 0.9
        assert min(inner.coverage, outer.coverage) > 0.9
        assert inner.rms_px < 0.2


def test_the_crescent_of_the_shadow_makes_a_larger_ellipse_that_only_its_scatter_gives_away(scenes):
    """{lit edge on one side, shadow's edge on the other}: what the largest sum of axes prefers."""
    for scene, picture in scenes:
        found = detect_ellipses(picture, DetectorParameters(polarity="same"))
        outer = min(found, key=lambda one: apart(one, scene.ellipse(0)))
        larger = [one for one in found if one.ellipse.a_px + one.ellipse.b_px > outer.ellipse.a_px + outer.ellipse.b_px + 4]
        assert bool(larger) == (scene.light is ASIDE)
        assert all(one.rms_px > 2 * outer.rms_px for one in larger)


@pytest.mark.parametrize("scale", [0.4, 0.5, 0.8, 1.0])
def test_pixels_mean_the_same_at_every_scale(scale):
    truth = np.array([310.3, 240.7, 150.0, 110.0, 0.5])
    (one,) = detect_ellipses(drawn(truth), DetectorParameters(scale=scale))
    assert np.abs(one.ellipse.parameters - truth)[:4].max() < 0.1
    assert one.bright_inside == 1


def test_points_of_a_reduced_picture_are_the_cameras():
    """A bright block between pixels 20 and 21 stays there when the picture is halved."""
    picture = np.zeros((64, 64), np.uint8)
    picture[20:22, 20:22] = 200
    small = reduced(picture, DetectorParameters(scale=0.5, blur_px=0.2)).blurred.astype(float)
    v, u = np.indices(small.shape)
    centroid = np.array([(u * small).sum(), (v * small).sum()]) / small.sum()
    assert in_camera_pixels(centroid, 0.5) == pytest.approx([20.5, 20.5], abs=1e-6)


def test_an_ellipse_that_changes_its_polarity_needs_polarity_any():
    """Grey on a ground that is dark on one side and bright on the other: the same edge, two senses."""
    truth = np.array([300.0, 250.0, 160.0, 130.0, 0.3])
    picture = blank()
    picture[:, 300:] = 210.0
    toy.paint_ellipse(picture, conics_from_parameters(truth), 120.0)
    picture = toy.expose(cv2.GaussianBlur(picture, (5, 5), 0.6), 0)
    (one,) = detect_ellipses(picture, DetectorParameters(polarity="any"))
    assert np.abs(one.ellipse.parameters - truth)[:4].max() < 0.3
    assert one.coverage > 0.9
    assert abs(one.bright_inside) < 0.2
    assert all(other.coverage < 0.6 for other in detect_ellipses(picture, DetectorParameters(polarity="same")))


def test_an_arc_of_two_thirds_is_enough_and_polygons_are_not():
    truth = np.array([300.0, 250.0, 160.0, 130.0, 0.3])
    picture = drawn(truth)
    picture[300:] = 40
    (one,) = detect_ellipses(picture, DetectorParameters())
    assert np.abs(one.ellipse.parameters - truth)[:4].max() < 1.0
    assert 0.5 < one.coverage < 0.8
    square = blank()
    toy.paint_polygon(square, np.array([(150, 100), (450, 120), (430, 400), (130, 380)]), 160.0)
    assert detect_ellipses(toy.expose(square, 0), DetectorParameters()) == ()


@pytest.mark.parametrize("polarity", ["same", "any"])
@pytest.mark.parametrize("picture", ["black", "white", "tiny", "line", "grain"])
def test_nothing_is_found_where_nothing_is(picture, polarity):
    rng = np.random.default_rng(0)
    pictures = {
        "black": np.zeros((400, 500), np.uint8),
        "white": np.full((400, 500), 255, np.uint8),
        "tiny": np.zeros((8, 8), np.uint8),
        "line": np.eye(300, dtype=np.uint8) * 255,
        "grain": rng.normal(50, 10, (1024, 1024)).astype(np.uint8),
    }
    assert detect_ellipses(pictures[picture], DetectorParameters(polarity=polarity)) == ()


def test_the_same_picture_gives_the_same_ellipses_and_is_left_alone(scenes):
    _, picture = scenes[1]
    copy = picture.copy()
    assert detect_ellipses(picture, DetectorParameters()) == detect_ellipses(copy, DetectorParameters())
    assert np.array_equal(picture, copy)


def test_arcs_turn_about_their_centre_and_know_which_side_is_bright():
    parameters = DetectorParameters(scale=1.0)
    for inside, sense in ((160.0, 1), (5.0, -1)):
        small = reduced(drawn([300.0, 250.0, 160.0, 130.0, 0.3], inside), parameters)
        arcs = arc_support(edge_pieces(small, line_segments(small, parameters)), parameters)
        assert len(arcs) > 8
        assert (arcs.bright_inside == sense).all()
        towards = [300.0, 250.0] - arcs.ends.mean(axis=1)
        assert (np.sum(towards * arcs.inward, axis=1) > 100).all()
        radius = np.hypot(*np.moveaxis(arcs.points - [300.0, 250.0], -1, 0))
        assert (radius[arcs.weights > 0] > 125).all()
        groups = arc_groups(arcs, parameters, 1.0)
        assert groups.members[0].sum() > 0.4 * len(arcs)


def test_straight_edges_support_no_arc():
    picture = blank()
    toy.paint_polygon(picture, np.array([(150, 100), (450, 120), (430, 400), (130, 380)]), 160.0)
    parameters = DetectorParameters(scale=1.0)
    small = reduced(toy.expose(picture, 0), parameters)
    segments = line_segments(small, parameters)
    assert len(segments) >= 4
    assert len(arc_support(edge_pieces(small, segments), parameters)) <= 1


def test_two_arcs_of_one_ellipse_are_fitted_together():
    """A ring hidden above and below leaves two groups; their pair is the ellipse."""
    truth = np.array([300.0, 250.0, 160.0, 130.0, 0.0])
    picture = drawn(truth)
    picture[:195] = 40
    picture[305:] = 40
    parameters = DetectorParameters(min_coverage=0.2)
    small = reduced(picture, parameters)
    arcs = arc_support(edge_pieces(small, line_segments(small, parameters)), parameters)
    fits = ellipse_fits(arcs, arc_groups(arcs, parameters, small.scale), parameters, small.scale)
    best = min(detect_ellipses(picture, parameters), key=lambda one: np.abs(one.ellipse.parameters - truth)[:4].max())
    assert len(fits) > 0
    assert (np.abs(best.ellipse.parameters - truth)[:4] < [0.3, 0.3, 0.5, 4.0]).all()  # what is hidden is half known


def foil(seed=3, size=700):
    """Facets of random grey, as crinkled foil shows them: nearest of 1500 points."""
    rng = np.random.default_rng(seed)
    facets = np.full((size, size), -1, np.int32)
    mask = np.full((size, size), 255, np.uint8)
    points = rng.integers(0, size, (1500, 2))
    mask[points[:, 1], points[:, 0]] = 0
    _, facets = cv2.distanceTransformWithLabels(mask, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
    return rng.gamma(1.0, 40.0, facets.max() + 1).clip(5, 230).astype(np.float32)[facets]


def test_a_rings_inner_edge_on_foil_is_grown_from_pieces():
    """Both sides of its edge change from facet to facet; photon noise as of two electrons a DN."""
    truth, picture = np.array([350.0, 350.0, 260.0, 230.0, 0.3]), foil()
    toy.paint_ellipse(picture, conics_from_parameters(truth), 60.0)
    toy.paint_ellipse(picture, conics_from_parameters(truth - [0, 0, 24, 24, 0]), foil(4))
    signal = cv2.GaussianBlur(picture, (5, 5), 0.6)
    noisy = np.clip(np.random.default_rng(1).poisson(2 * signal) / 2, 0, 255).astype(np.uint8)
    found = detect_ellipses(noisy, DetectorParameters(polarity="any"))
    assert min(np.abs(one.ellipse.parameters - truth + [0, 0, 24, 24, 0])[:4].max() for one in found) < 1.0


def test_the_root_of_the_grey_values_brings_out_a_dark_edge_and_does_not_move_it():
    """A ring of 14 DN on 5: below the threshold as it is."""
    truth = np.array([300.0, 250.0, 160.0, 130.0, 0.3])
    picture = drawn(truth, inside=14.0, outside=5.0)
    assert detect_ellipses(picture, DetectorParameters(root_dn=None)) == ()
    (one,) = detect_ellipses(picture, DetectorParameters())
    assert np.abs(one.ellipse.parameters - truth)[:4].max() < 0.25


def test_growth_collects_what_lies_along_an_ellipse():
    truth = np.array([300.0, 250.0, 160.0, 130.0, 0.3])
    parameters = DetectorParameters(scale=1.0)
    small = reduced(drawn(truth), parameters)
    pieces = edge_pieces(small, line_segments(small, parameters))
    start = np.add(truth, [2.0, -1.5, 2.0, -2.0, 0.0])
    one, far = grown(np.stack([start, np.add(start, [60.0, 0, 0, 0, 0])]), pieces, parameters, 1.0)
    assert np.abs(one - truth)[:4].max() < 0.2
    assert np.abs(far - truth)[:4].max() > 10
    assert grown(np.zeros((0, 5)), pieces, parameters, 1.0).shape == (0, 5)


def test_direct_fits_of_summed_scatter_are_the_fits_of_all_points():
    rng = np.random.default_rng(1)
    truth = np.stack(
        [
            rng.uniform(0, 2000, 50),
            rng.uniform(0, 2000, 50),
            rng.uniform(100, 400, 50),
            rng.uniform(40, 90, 50),
            rng.uniform(-1.5, 1.5, 50),
        ],
        1,
    )
    points = points_on_parameters(truth, 60)
    half = [point_scatter(points[:, part], np.ones((50, 30))) for part in (slice(0, 30), slice(30, 60))]
    fitted, rms = direct_fits(half[0][0] + half[1][0], half[0][1] + half[1][1])
    assert np.abs(conics_from_parameters(fitted) / conics_from_parameters(truth) - 1).max() < 1e-4
    assert rms.max() < 5e-3
    noisy = points + rng.normal(0, 0.3, points.shape)
    _, rms = direct_fits(*point_scatter(noisy, np.ones((50, 60))))
    assert np.median(rms) == pytest.approx(0.3, rel=0.08)


def test_points_on_a_line_or_too_few_have_no_ellipse():
    line = np.stack([np.arange(20.0), 2 * np.arange(20.0)], axis=1)
    for points, weights in ((line, np.ones(20)), (line, np.zeros(20)), (line[:3], np.ones(3))):
        fitted, _ = direct_fits(*point_scatter(points[None], weights[None]))
        assert not (np.isfinite(fitted).all() and 1 < fitted[0, 3] < fitted[0, 2] < 1e3)


def test_coverage_counts_one_sense_or_both():
    truth = np.array([[300.0, 250.0, 160.0, 130.0, 0.3]])
    picture = blank()
    picture[:, 300:] = 210.0
    toy.paint_ellipse(picture, conics_from_parameters(truth[0]), 120.0)
    for polarity, share in (("same", 0.5), ("any", 1.0)):
        parameters = DetectorParameters(scale=1.0, polarity=polarity)
        small = reduced(toy.expose(picture, 0), parameters)
        covered, _ = coverage_of(small, truth, parameters, 90)
        assert covered[0] == pytest.approx(share, abs=0.08)
        beside, _ = coverage_of(small, np.add(truth, [0, 0, 12, 12, 0]), parameters, 90)
        assert beside[0] < 0.2


def test_clusters_keep_the_best_of_each():
    ellipses = np.array(
        [
            [100, 100, 50, 40, 0.1],
            [101, 100, 50.5, 40, 0.1],
            [100, 100, 60, 50, 0.1],
            [100, 100, 50, 49.9, 1.0],
            [100, 100, 50, 49.9, -0.5],
        ]
    )
    same = alike(ellipses, 4.0)
    assert same[0, 1]
    assert same[3, 4]  # round: the axis means nothing
    assert not same[0, 2]
    assert not same[0, 3]
    assert distinct(ellipses, np.array([0.5, 0.9, 0.7, 0.3, 0.4]), 4.0, 9).tolist() == [1, 2, 4]
    assert distinct(ellipses, np.array([0.5, 0.9, 0.7, 0.3, 0.4]), 4.0, 2).tolist() == [1, 2]
    assert len(distinct(np.zeros((0, 5)), np.zeros(0), 4.0, 5)) == 0


def test_the_peak_is_the_parabolas():
    x = np.arange(9.0)
    values = -((x - np.array([[3.3], [5.75]])) ** 2) + 20
    at, found = peak_offset(values, values)
    assert at == pytest.approx([3.3, 5.75])
    assert found.all()
    assert not peak_offset(x[None], x[None])[1].any()  # a slope has no peak
