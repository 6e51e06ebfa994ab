"""The markers of ``stereo-ring``: their own edges, the turn that follows from them, the memory that keeps the X axis' marker."""

import cv2
import numpy as np
import pytest
import toy_ring as toy
from scipy.spatial.transform import RigidTransform, Rotation

from estimators.stereo_ring.circle_cone import Circle
from estimators.stereo_ring.constellation import Constellation
from estimators.stereo_ring.fallback import laid_onto, smallest_height
from estimators.stereo_ring.marker_parameters import ConstellationParameters, MarkerParameters
from estimators.stereo_ring.marker_points import Sighting, is_regular
from estimators.stereo_ring.marker_sweep import grey_levels, swept
from estimators.stereo_ring.marker_view import marker_view
from estimators.stereo_ring.marker_watch import MarkerWatch
from estimators.stereo_ring.outlines import disc_outline, square_outline
from estimators.stereo_ring.parameters import TrackedParameters
from estimators.stereo_ring.turn import solved_turn, voted_pairs

MARKERS, MEMORY = MarkerParameters(), ConstellationParameters()
KNOWN = np.array([[0.31, 0.0, -0.09], [-0.07, 0.41, -0.09], [-0.33, -0.23, -0.09], [0.52, 0.52, -0.09]])
SQUARE = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])


def turned(points, angle_rad):
    return Rotation.from_rotvec([0, 0, angle_rad]).apply(points)


def drawn(paint, seed=1, sigma_dn=0.7):
    """A small picture, four times oversampled in both directions: ``paint`` draws on coordinates u, v of the fine grid."""
    fine = (np.arange(4 * 80) + 0.5) / 4 - 0.5
    u, v = np.meshgrid(fine, fine)
    coarse = cv2.resize(paint(u, v).astype(np.float32), (80, 80), interpolation=cv2.INTER_AREA)
    return toy.expose(cv2.GaussianBlur(coarse, (5, 5), 0.6), seed, sigma_dn)


def inside_square(u, v, centre, half, turn_rad):
    c, s = np.cos(turn_rad), np.sin(turn_rad)
    x, y = c * (u - centre[0]) + s * (v - centre[1]), c * (v - centre[1]) - s * (u - centre[0])
    return np.maximum(np.abs(x), np.abs(y)) < half


def inside_disc(u, v, centre, radius):
    return np.hypot(u - centre[0], v - centre[1]) < radius


def corners(centre, half, turn_rad):
    c, s = np.cos(turn_rad), np.sin(turn_rad)
    return centre + half * SQUARE @ np.array([[c, s], [-s, c]])


def round_about(centre, radius):
    angle = np.arange(64) * (2 * np.pi / 64)
    return centre + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def view_of(picture):
    return marker_view(picture, np.array([40.0, 40.0]), 60.0, MARKERS)


@pytest.mark.parametrize(("marker_dn", "ground_dn"), [(12.0, 80.0), (180.0, 40.0)])
def test_a_marker_dark_or_bright_is_centred_to_a_twentieth_of_a_pixel(marker_dn, ground_dn):
    centre = np.array([39.3, 40.6])
    square = drawn(lambda u, v: np.where(inside_square(u, v, centre, 9.2, 0.3), marker_dn, ground_dn))
    disc = drawn(lambda u, v: np.where(inside_disc(u, v, centre, 10.4), marker_dn, ground_dn))
    near = centre + np.array([1.2, -0.8])
    found = square_outline(view_of(square), corners(near, 9.6, 0.28), MARKERS.windows_px, MARKERS)
    assert found.centre_px == pytest.approx(centre, abs=0.05)
    assert found.bright == (marker_dn > ground_dn)
    found = disc_outline(view_of(disc), round_about(near, 10.0), MARKERS.windows_px, MARKERS)
    assert found.centre_px == pytest.approx(centre, abs=0.05)
    assert found.area_px == pytest.approx(np.pi * 10.4**2, rel=0.03)


def with_shadow(u, v, centre, offset):
    """A dark disc of 12 DN on a ground of 60, with its own shadow of 4 DN beside it."""
    ground = np.where(inside_disc(u, v, centre + offset, 10.4), 4.0, 60.0)
    return np.where(inside_disc(u, v, centre, 10.4), 12.0, ground)


@pytest.mark.parametrize("width_px", [1.5, 3.0, 5.0])
def test_a_disc_is_told_from_its_own_shadow(width_px):
    """The outermost edge is that of both, half the shadow's width aside: the control."""
    centre, offset = np.array([40.2, 39.7]), width_px * np.array([0.8, 0.6])
    picture = drawn(lambda u, v: with_shadow(u, v, centre, offset))
    found = disc_outline(view_of(picture), round_about(centre + offset / 2, 10.8), MARKERS.windows_px, MARKERS)
    assert np.linalg.norm(found.centre_px - centre) < 0.35
    dark = np.argwhere(cv2.GaussianBlur(picture, (3, 3), 0.7) < 30)[:, ::-1].mean(axis=0)
    assert np.linalg.norm(dark - centre) > 0.35


def test_a_plain_picture_has_no_outline():
    plain = drawn(lambda u, v: np.full_like(u, 50.0))
    assert square_outline(view_of(plain), corners(np.array([40.0, 40.0]), 9.0, 0.0), MARKERS.windows_px, MARKERS) is None
    assert disc_outline(view_of(plain), round_about(np.array([40.0, 40.0]), 9.0), MARKERS.windows_px, MARKERS) is None


def test_levels_are_ratios_over_the_darkest_and_a_blank_picture_has_none():
    ramp = np.tile(np.linspace(4, 250, 64), (64, 1)).astype(np.float32)
    levels = grey_levels(ramp, MARKERS)
    above = levels - np.percentile(ramp, MARKERS.low_percent)
    assert above[0] == pytest.approx(MARKERS.first_level_dn)
    assert above[1:] / above[:-1] == pytest.approx(above[1] / above[0])
    assert grey_levels(np.full((64, 64), 9, np.float32), MARKERS).size == 0


@pytest.mark.parametrize("exposure", [1.0, 0.15])
def test_all_markers_are_found_whatever_the_exposure(exposure):
    """The fixed threshold of the paper is a statement about the exposure; ratios of grey levels are not."""
    scene = toy.Scene(toy.left_from_ring(5.2, 12, 7, 20))
    pictures = tuple(toy.expose(exposure * toy.draw(scene, view), (3, view), 0.5) for view in range(2))
    ellipses = (scene.ellipse(0), scene.ellipse(1))
    ring = Circle(scene.left_from_ring.translation, scene.left_from_ring.rotation.as_matrix()[:, 2], 0.6)
    seen = MarkerWatch.of(pictures, ellipses, ring, toy.rig(), TrackedParameters()).swept()
    found = scene.left_from_ring.inv().apply(np.array([one.point_left for one in seen]))
    for x, y, _, shape in scene.markers:
        distance = np.linalg.norm(found - [x, y, -toy.HEIGHT_M], axis=1)
        assert distance.min() < 2e-3
        assert seen[int(np.argmin(distance))].square == (shape == "square")
    assert swept(np.zeros((2048, 2048), np.uint8), ellipses[0], MARKERS) == []


def test_a_square_is_regular_and_a_kite_is_not():
    square = 0.05 * np.column_stack([SQUARE, np.zeros(4)])
    assert is_regular(square, True, MARKERS)
    assert not is_regular(square * [1.0, 1.5, 1.0], True, MARKERS)
    kite = square + np.array([[0, 0, 0], [0.04, 0.04, 0], [0, 0, 0], [0, 0, 0]])
    assert not is_regular(kite, True, MARKERS)


def test_the_turn_is_exact_without_noise():
    angle = np.radians(17.0)
    turn = solved_turn(turned(KNOWN, angle)[:, :2], KNOWN[:, :2], np.full(4, 1e-4), 1e-4, MEMORY)
    assert turn.angle_rad == pytest.approx(angle, abs=1e-12)
    assert turn.used.all()


def test_a_ring_off_its_place_does_not_look_like_a_turn_to_markers_all_round():
    """The ring's centre is off by 0.1 mm: one marker 0.31 m out reads 0.018°, four all round read almost nothing."""
    seen = turned(KNOWN, 0.2)[:, :2] + [0.0, 1e-4]
    both = solved_turn(seen, KNOWN[:, :2], np.full(4, 5e-5), 1e-4, MEMORY)
    one = solved_turn(seen[:1], KNOWN[:1, :2], np.full(1, 5e-5), 1e-4, MEMORY)
    assert abs(both.angle_rad - 0.2) < 0.2 * abs(one.angle_rad - 0.2)
    assert both.sigma_rad < one.sigma_rad


def test_a_marker_in_a_wrong_place_is_left_out():
    seen = turned(KNOWN, 0.1)[:, :2]
    seen[3] += 0.02
    turn = solved_turn(seen, KNOWN[:, :2], np.full(4, 1e-4), 1e-4, MEMORY)
    assert turn.angle_rad == pytest.approx(0.1, abs=1e-4)
    assert turn.used.tolist() == [True, True, True, False]


def test_markers_are_told_apart_by_their_places_with_some_missing_and_some_false():
    angle = np.radians(-21.0)
    seen = np.concatenate([turned(KNOWN[[3, 1]], angle), [[0.1, -0.5, -0.09]]])
    pairs = voted_pairs(seen, KNOWN, np.ones((3, 4), dtype=bool), 0.6, MEMORY)
    assert sorted(pairs) == [(0, 3), (1, 1)]


def test_of_turns_that_explain_as_much_the_smallest_is_taken():
    symmetric = turned(np.array([[0.3, 0, 0]]), 0)[0] * np.ones((1, 3))
    ring_of_six = np.concatenate([turned(symmetric, k * np.pi / 3) for k in range(6)])
    pairs = voted_pairs(turned(ring_of_six, 0.04), ring_of_six, np.ones((6, 6), dtype=bool), 0.6, MEMORY)
    assert sorted(pairs) == [(index, index) for index in range(6)]


def sighting(point):
    border = np.asarray(point) + 0.05 * np.column_stack([SQUARE, np.zeros(4)])
    return Sighting(np.asarray(point), border, True, False, 5e-4)


def taught(places, parameters=MEMORY):
    memory = Constellation(parameters)
    memory.learn([], [(one, one.point_left, one.border_left) for one in map(sighting, places)])
    return memory


def see(memory, indices, noise=0.0, rng=None):
    rows = []
    for index in indices:
        shift = rng.normal(0, noise, 3) if rng is not None else np.zeros(3)
        rows.append((index, memory.landmarks[index].point_ring + shift, memory.landmarks[index].border_ring + shift))
    memory.learn(rows, [])


def test_the_main_marker_is_the_nearest_to_the_axis_and_keeps_its_name_when_it_is_hidden():
    memory = taught(KNOWN)
    assert memory.main == 0
    for _ in range(3):
        see(memory, range(4))
    for _ in range(40):
        see(memory, [1, 2])
    assert memory.main is not None
    assert memory.landmarks[memory.main].point_ring == pytest.approx(KNOWN[0])


def test_a_nearer_marker_that_was_missed_in_the_first_frame_becomes_the_main_one_soon_or_never():
    memory = taught(KNOWN[1:])
    memory.learn([], [(sighting(KNOWN[0]), KNOWN[0], sighting(KNOWN[0]).border_left)])
    for _ in range(3):
        see(memory, range(4))
    assert memory.landmarks[memory.main].point_ring == pytest.approx(KNOWN[0])
    late = taught(KNOWN[1:])
    for _ in range(MEMORY.settle_frames):
        see(late, range(3))
    kept = late.main
    late.learn([], [(sighting(KNOWN[0]), KNOWN[0], sighting(KNOWN[0]).border_left)])
    for _ in range(5):
        see(late, range(4))
    assert late.main == kept


def test_memory_is_a_mean_and_trusts_the_steady_marker():
    memory, rng = taught(KNOWN), np.random.default_rng(2)
    for _ in range(60):
        steady = [(0, KNOWN[0] + rng.normal(0, 2e-5, 3), memory.landmarks[0].border_ring)]
        shaky = [(1, KNOWN[1] + rng.normal(0, 2e-3, 3), memory.landmarks[1].border_ring)]
        memory.learn(steady + shaky, [])
    assert np.linalg.norm(memory.landmarks[1].point_ring - KNOWN[1]) < 1e-3
    assert memory.sigmas_m([1])[0] > 5 * memory.sigmas_m([0])[0]


def test_a_marker_that_is_never_seen_again_is_forgotten():
    memory = taught(KNOWN)
    for _ in range(10):
        see(memory, [index for index, one in enumerate(memory.landmarks) if not np.allclose(one.point_ring, KNOWN[3])])
    assert len(memory.landmarks) == 3


def test_without_the_ring_three_markers_give_the_rings_frame():
    frame = RigidTransform.from_components([0.2, -0.3, 5.0], Rotation.from_rotvec([2.9, 0.2, 0.1]))
    found = laid_onto(KNOWN[:3], frame.apply(KNOWN[:3]), 0.2, 0.005)
    assert np.abs(found.as_matrix() - frame.as_matrix()).max() < 1e-12


def test_markers_on_a_line_too_few_or_in_other_places_are_refused():
    line = np.array([[0.1, 0, 0], [0.3, 0, 0], [0.6, 0.02, 0]])
    assert smallest_height(line) < 0.02
    assert "line" in laid_onto(line, line, 0.2, 0.005)
    assert "three are needed" in laid_onto(KNOWN[:2], KNOWN[:2], 0.2, 0.005)
    assert "mm from where" in laid_onto(KNOWN, KNOWN + np.diag([0.03, 0, 0, 0])[:, :3], 0.2, 0.005)
