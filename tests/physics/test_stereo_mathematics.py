"""The mathematics of Shu et al. 2020 without noise, its misprints as negative controls, and Monte Carlo of the circle fits."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from estimators.stereo_ring.circle_cone import (
    Circle,
    circles_of_radius,
    cones_of_conics,
    conics_of_circles,
    normals_of_cones,
    poles_of_planes,
)
from estimators.stereo_ring.circle_fit import fit_circle
from estimators.stereo_ring.circle_pair import circle_of_pair, circles_of_pairs, paired_normals
from estimators.stereo_ring.conics import (
    conics_from_parameters,
    parameters_from_conics,
    points_on_parameters,
    sampson_px,
)
from estimators.stereo_ring.frame_axes import angles_xyz_rad, marker_frame, ring_frame, rotation_between
from estimators.stereo_ring.rig import Rig, epipolar_distance_px, project, triangulate

SIZE_PX, FIELD_DEG, BASELINE_M = 2048, 60.0, 1.3  # the paper's rig
FOCAL_PX = SIZE_PX / 2 / np.tan(np.radians(FIELD_DEG / 2))
K = np.array([[FOCAL_PX, 0, (SIZE_PX - 1) / 2], [0, FOCAL_PX, (SIZE_PX - 1) / 2], [0, 0, 1]])
COUNT = 10_000


def about_y(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def rig(toe_in_deg=18.0):
    tau = np.radians(toe_in_deg)
    T = [-BASELINE_M * np.cos(tau), 0, BASELINE_M * np.sin(tau)]
    return Rig(K, K, RigidTransform.from_components(T, Rotation.from_matrix(about_y(2 * tau))))


def in_left(points_rig, toe_in_deg):
    return np.add(points_rig, [BASELINE_M / 2, 0, 0]) @ about_y(-np.radians(toe_in_deg)).T


def in_rig(points_left, toe_in_deg):
    return np.asarray(points_left) @ about_y(np.radians(toe_in_deg)).T - [BASELINE_M / 2, 0, 0]


def facing(toward, direction):
    return direction * -np.sign(np.sum(toward * direction, axis=-1, keepdims=True))


def angle_deg(one, other):
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(one, other), axis=-1), np.sum(one * other, axis=-1)))


@pytest.fixture(scope="module")
def circles():
    """10⁴ random circles seen from outside by both cameras: rig, centres, normals, radii, conics."""
    pair, rng = rig(), np.random.default_rng(20)
    z = rng.uniform(3, 11, 2 * COUNT)
    centres = in_left(np.stack([rng.uniform(-0.2, 0.2, z.size) * z, rng.uniform(-0.2, 0.2, z.size) * z, z], axis=1), 18.0)
    normals = facing(centres, Rotation.random(z.size, rng=rng).as_matrix()[:, 0])
    cosine = [
        np.sum(n * x, axis=1) / np.linalg.norm(x, axis=1)
        for n, x in ((normals, centres), (normals @ pair.R.T, centres @ pair.R.T + pair.T))
    ]
    seen = np.flatnonzero(np.max(cosine, axis=0) < -0.05)[:COUNT]
    centres, normals, radii = centres[seen], normals[seen], rng.uniform(0.2, 0.8, seen.size)
    assert seen.size == COUNT
    left, right = (conics_of_circles(centres, normals, radii, projection) for projection in pair.projections)
    return pair, centres, normals, radii, left, right


@pytest.mark.parametrize(("left_factor", "right_factor"), [(1.0, 1.0), (-1.0, 1e5), (1e-5, -1e5), (-1e5, -1e-5)])
def test_a_circle_is_recovered_from_its_two_ellipses_at_any_scale_and_sign(circles, left_factor, right_factor):
    pair, centres, normals, radii, left, right = circles
    found, direction, radius = circles_of_pairs(pair, left * left_factor, right * right_factor)
    assert angle_deg(direction, normals).max() <= 1e-9
    assert np.linalg.norm(found - centres, axis=1).max() <= 1e-8
    assert np.abs(radius - radii).max() <= 1e-8


@pytest.mark.parametrize("factor", [1.0, -1.0, 1e5, -1e-5])
def test_one_view_gives_two_normals_and_with_the_radius_the_centre(circles, factor):
    _, centres, normals, radii, left, _ = circles
    cones = cones_of_conics(left * factor, K)
    both = normals_of_cones(cones)
    off = angle_deg(both, normals[:, None])
    assert off.min(axis=1).max() <= 1e-9
    assert np.linalg.norm(both, axis=-1) == pytest.approx(1.0)
    right_one = np.take_along_axis(both, off.argmin(axis=1)[:, None, None], axis=1)[:, 0]
    assert np.linalg.norm(circles_of_radius(cones, right_one, radii) - centres, axis=1).max() <= 1e-8


@pytest.mark.parametrize("factor", [1.0, -1.0, 1e5, -1e-5])
def test_conic_and_ellipse_are_the_same_thing(circles, factor):
    for conics in circles[4:]:
        parameters = parameters_from_conics(conics * factor)
        again = conics_from_parameters(parameters)
        assert np.abs(normed(again) - normed(conics)).max() <= 1e-12
        assert (parameters[:, 2] >= parameters[:, 3]).all()


def normed(conics):
    sign = np.sign(conics[:, 0, 0] + conics[:, 1, 1])
    return conics / (np.linalg.norm(conics, axis=(1, 2)) * sign)[:, None, None]


def test_the_poles_are_one_point_to_both_views_and_the_ellipse_centres_are_not(circles):
    pair, centres, normals, _, left, right = circles
    poles = poles_of_planes(left, K, normals), poles_of_planes(right, K, normals @ pair.R.T)
    seen = project(pair, centres)
    assert epipolar_distance_px(pair, *seen).max() <= 1e-9
    for pole, centre in zip(poles, seen, strict=True):
        assert np.abs(pole - centre).max() <= 1e-8
    ellipse_centres = parameters_from_conics(left)[:, :2], parameters_from_conics(right)[:, :2]
    apart = epipolar_distance_px(pair, *ellipse_centres)
    assert np.median(apart) > 0.05
    assert apart.max() > 2  # why a tolerance of 3 px loses rings


def test_triangulation_inverts_projection_and_says_nan_for_parallel_rays(circles):
    pair, centres, *_ = circles
    assert np.abs(triangulate(pair, *project(pair, centres)) - centres).max() <= 1e-11
    parallel = Rig(K, K, RigidTransform.from_translation([-BASELINE_M, 0, 0]))
    assert np.isnan(triangulate(parallel, [100.0, 200.0], [100.0, 200.0])).all()


def random_ellipses():
    rng = np.random.default_rng(5)
    a = rng.uniform(50, 600, COUNT)
    theta = rng.uniform(-np.pi / 2, np.pi / 2, COUNT)
    theta[:100] = np.pi / 4  # A = C
    return np.stack([rng.uniform(0, 2047, COUNT), rng.uniform(0, 2047, COUNT), a, a * rng.uniform(0.2, 0.98, COUNT), theta], axis=1)


def off_axis(found, theta):
    return np.abs((found - theta + np.pi / 2) % np.pi - np.pi / 2)


def test_theta_of_eq_5_is_the_major_axis_and_as_printed_is_not():
    truth = random_ellipses()
    conics = conics_from_parameters(truth) * np.where(np.arange(COUNT) % 2, -3.0, 0.2)[:, None, None]
    found = parameters_from_conics(conics)
    assert off_axis(found[:, 4], truth[:, 4]).max() <= 1e-9
    assert np.abs(found[:, :4] - truth[:, :4]).max() <= 1e-7
    A, B, C = conics[:, 0, 0], 2 * conics[:, 0, 1], conics[:, 1, 1]
    with np.errstate(divide="ignore"):
        printed = np.arctan(B / (A - C)) / 2
    wrong = np.mean(off_axis(printed, truth[:, 4])[100:] > 1e-3)
    assert wrong == pytest.approx(0.507, abs=0.02)


def test_hyperbolas_and_imaginary_ellipses_are_no_ellipses():
    conics = np.stack(
        [np.diag([1.0, -1.0, -1.0]), np.eye(3), np.diag([1.0, 0.0, -1.0]), np.zeros((3, 3)), np.diag([-1.0, -2.0, 1.0])]
    )
    assert np.isnan(parameters_from_conics(conics)).all(axis=1).tolist() == [True, True, True, True, False]
    assert np.isnan(normals_of_cones(cones_of_conics(np.eye(3), K))).all()


def test_sampson_is_the_distance_to_first_order_with_the_sign_of_outside():
    truth = np.array([900.0, 1100.0, 300.0, 180.0, 0.4])
    on = points_on_parameters(truth, 100)
    assert np.abs(sampson_px(conics_from_parameters(truth), on)).max() < 1e-9
    for offset in (-0.5, 0.5):
        moved = points_on_parameters(np.add(truth, [0, 0, offset, offset, 0]), 4)  # at the ends of the axes
        assert sampson_px(-7 * conics_from_parameters(truth), moved) == pytest.approx(offset, rel=3e-3)


def test_eq_12_as_printed_turns_the_right_normals_away(circles):
    pair, _, normals, _, left, right = circles
    printed = Rig(K, K, RigidTransform.from_components(pair.T, Rotation.from_matrix(pair.R.T)))  # its R.T is R: n_r = R ζ
    signs = np.where(np.random.default_rng(2).random((COUNT, 2, 1)) < 0.5, 1.0, -1.0)  # eigenvectors come with either sign
    in_right = normals_of_cones(cones_of_conics(right, K)) * signs
    own = np.take_along_axis(
        in_right, angle_deg(in_right * signs, (normals @ pair.R.T)[:, None]).argmin(axis=1)[:, None, None], axis=1
    )
    assert np.median(angle_deg(own[:, 0] @ pair.R.T, normals)) > 60
    mended, gap = paired_normals(pair, left, right)
    assert angle_deg(mended, normals).max() <= 1e-9
    assert gap.max() < 1e-9
    _, wrong_gap = paired_normals(printed, left, right)
    assert np.median(wrong_gap) > 0.2


@pytest.mark.parametrize(
    ("toe_in_deg", "range_m", "bias_mm"),
    [
        (18, 3.45, 178.3),
        (18, 7.5, 179.2),
        (18, 10, 179.4),
        (9, 3.45, 87.3),
        (9, 7.5, 87.6),
        (9, 10, 87.6),
        (0, 3.45, 0),
        (0, 10, 0),
    ],
)
def test_ellipse_centres_put_the_ring_too_far_by_the_same_at_every_range(toe_in_deg, range_m, bias_mm):
    pair, radius = rig(toe_in_deg), 0.6
    truth = in_left([0, 0, range_m], toe_in_deg)
    normal = about_y(-np.radians(toe_in_deg)) @ [0, 0, -1.0]
    conics = [conics_of_circles(truth, normal, radius, projection) for projection in pair.projections]
    off = {
        mode: in_rig(circle_of_pair(pair, *conics, mode).centre_m, toe_in_deg) - [0, 0, range_m]
        for mode in ("ellipse_centre", "pole")
    }
    assert np.linalg.norm(off["pole"]) <= 1e-9
    assert off["ellipse_centre"][:2] == pytest.approx([0, 0], abs=1e-9)
    assert off["ellipse_centre"][2] * 1e3 == pytest.approx(bias_mm, abs=0.1)
    assert off["ellipse_centre"][2] == pytest.approx(2 * radius**2 * np.tan(np.radians(toe_in_deg)) / BASELINE_M, rel=0.02)


def tilted(toe_in_deg, about_x_deg, about_y_deg):
    """Normal in left axes of a ring that faces the rig, then tilts."""
    turn = Rotation.from_euler("xy", [about_x_deg, about_y_deg], degrees=True)
    return about_y(-np.radians(toe_in_deg)) @ turn.apply([0, 0, -1.0])


def edge_points(pair, circle, count, rng, sigma_px):
    points = []
    for projection in pair.projections:
        parameters = parameters_from_conics(conics_of_circles(circle.centre_m, circle.normal, circle.radius_m, projection))
        on = points_on_parameters(parameters, count)
        points.append(on + rng.normal(0, sigma_px, on.shape))
    return points


def monte_carlo(circle, trials, sigma_px=0.2, points=240, loss_px=0.5):
    """Errors of X0 in the rig's axes (mm), and of the normal (deg): joint fit, and mean of the two views' normals."""
    pair, rng = rig(), np.random.default_rng(3)
    centre_mm, joint_deg, mean_deg, fits = [], [], [], []
    for _ in range(trials):
        left, right = edge_points(pair, circle, points, rng, sigma_px)
        fit = fit_circle(pair, left, right, Circle(circle.centre_m * 1.01, circle.normal, circle.radius_m * 1.01), loss_px)
        alone = [fitted_conic(points_px) for points_px in (left, right)]
        mean_deg.append(angle_deg(paired_normals(pair, *alone)[0], circle.normal))
        centre_mm.append((in_rig(fit.circle.centre_m, 18.0) - in_rig(circle.centre_m, 18.0)) * 1e3)
        joint_deg.append(angle_deg(fit.circle.normal, circle.normal))
        fits.append(fit)
    return np.array(centre_mm), rms(joint_deg), rms(mean_deg), fits


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def fitted_conic(points_px):
    """Least squares in Sampson distance of one view alone, Gauss-Newton from the algebraic fit."""
    centre, scale = points_px.mean(axis=0), 300.0
    u, v = ((points_px - centre) / scale).T
    design = np.stack([u * u, 2 * u * v, v * v, 2 * u, 2 * v, np.ones_like(u)], axis=1)
    weight = np.ones_like(u)
    for _ in range(4):
        c = np.linalg.svd(design * weight[:, None], full_matrices=False)[2][-1]
        conic = np.array([[c[0], c[1], c[3]], [c[1], c[2], c[4]], [c[3], c[4], c[5]]])
        weight = 1 / np.linalg.norm(np.stack([u, v, np.ones_like(u)], axis=1) @ conic[:, :2], axis=1)
    move = np.array([[1 / scale, 0, -centre[0] / scale], [0, 1 / scale, -centre[1] / scale], [0, 0, 1]])
    return move.T @ conic @ move


@pytest.mark.parametrize(("range_m", "z_mm", "normal_deg"), [(7.5, (0.20, 0.40), (0.02, 0.045)), (3.45, (0.0, 0.06), (0.0, 0.02))])
def test_the_joint_fit_is_as_good_as_the_pixels_allow(range_m, z_mm, normal_deg):
    """σ = 0.2 px, tilts of 12° and 7°, one edge point a pixel."""
    circle = Circle(in_left([0, 0, range_m], 18.0), tilted(18.0, 12, 7), 0.6)
    perimeter_px = int(2 * np.pi * 0.6 * FOCAL_PX / range_m)
    centre_mm, joint_deg, _, _ = monte_carlo(circle, 120, points=perimeter_px, loss_px=None)
    assert z_mm[0] < centre_mm[:, 2].std() < z_mm[1]
    assert normal_deg[0] < joint_deg < normal_deg[1]
    assert np.abs(centre_mm.mean(axis=0)).max() < 5 * centre_mm.std(axis=0).max() / np.sqrt(120)


def test_where_one_camera_sees_the_ring_face_on_only_the_joint_fit_knows_the_normal():
    centre = in_left([0, 0, 3.45], 18.0)
    circle = Circle(centre, -centre / np.linalg.norm(centre), 0.6)
    _, joint_deg, mean_deg, _ = monte_carlo(circle, 100, points=1000)
    assert joint_deg < 0.02
    assert mean_deg > 0.15


def test_the_claimed_covariance_is_the_scatter():
    circle = Circle(in_left([0.2, -0.1, 5.2], 18.0), tilted(18.0, 12, 7), 0.6)
    _, _, _, fits = monte_carlo(circle, 150)
    state = np.array(
        [
            [*(f.circle.centre_m - circle.centre_m), *(f.tangent @ (f.circle.normal - circle.normal)), f.circle.radius_m - 0.6]
            for f in fits
        ]
    )
    claimed = np.sqrt(np.mean([np.diag(f.covariance) for f in fits], axis=0))
    assert np.sqrt(np.mean(state**2, axis=0)) == pytest.approx(claimed, rel=0.2)
    assert np.mean([f.sigma_px for f in fits]) == pytest.approx(0.2, rel=0.05)


def test_a_tenth_of_outliers_hardly_moves_the_robust_fit():
    pair, rng = rig(), np.random.default_rng(8)
    circle = Circle(in_left([0, 0, 5.2], 18.0), tilted(18.0, 12, 7), 0.6)
    left, right = edge_points(pair, circle, 120, rng, 0.2)
    left[:12] += [6.0, 4.0]
    off = {
        loss: np.linalg.norm(fit_circle(pair, left, right, circle, loss).circle.centre_m - circle.centre_m) for loss in (0.5, None)
    }
    assert off[0.5] < 3e-3
    assert off[None] > 3 * off[0.5]


def test_a_circle_fit_without_a_circle_is_none():
    pair = rig()
    start = Circle(in_left([0, 0, 5.0], 18.0), tilted(18.0, 0, 0), 0.6)
    assert fit_circle(pair, np.zeros((0, 2)), np.zeros((3, 2)), start) is None
    assert fit_circle(pair, np.full((10, 2), np.nan), np.zeros((3, 2)), start) is None


def test_an_off_plane_marker_still_gives_a_rotation_and_as_printed_does_not():
    rng = np.random.default_rng(4)
    for turn in Rotation.random(200, rng=rng):
        centre, z = np.array([0.1, -0.2, 5.0]), turn.apply([0, 0, 1.0])
        marker = centre + turn.apply([0.31, 0, -0.1])
        frame = ring_frame(centre, z, marker)
        R = frame.rotation.as_matrix()
        assert np.linalg.det(R) == pytest.approx(1, abs=1e-12)
        assert np.abs(R.T @ R - np.eye(3)).max() <= 1e-12
        assert R[:, 2] @ centre < 0
        assert R[:, 0] @ (marker - centre) == pytest.approx(0.31)
        x = (marker - centre) / np.linalg.norm(marker - centre)
        assert np.linalg.det(np.stack([x, np.cross(z, x), z], axis=1)) == pytest.approx(0.906, abs=1e-3)
        assert 90 - np.degrees(np.arccos(x @ z)) == pytest.approx(-17.9, abs=0.05)
    assert ring_frame(centre, z, centre + 0.1 * z) is None


def test_three_markers_give_a_frame_that_faces_the_camera():
    b0, b1, b2 = np.array([[0.1, 0.2, 5.0], [0.5, 0.2, 5.1], [0.2, 0.7, 5.0]])
    for second, third in ((b1, b2), (b2, b1)):
        R = marker_frame(b0, second, third).rotation.as_matrix()
        assert np.linalg.det(R) == pytest.approx(1, abs=1e-12)
        assert R[:, 2] @ b0 < 0
        assert R[:, 0] @ (second - b0) == pytest.approx(np.linalg.norm(second - b0))
        assert R[:, 2] @ (third - b0) == pytest.approx(0, abs=1e-12)
    assert marker_frame(b0, b1, b0 + 2 * (b1 - b0)) is None


def test_differences_of_angles_jump_where_the_relative_rotation_does_not():
    rng = np.random.default_rng(6)
    facing_camera = Rotation.from_euler("x", 180, degrees=True)
    noisy = [facing_camera * Rotation.from_rotvec(rng.normal(0, np.radians(0.3), 3)) for _ in range(300)]
    theta_x = np.degrees([angles_xyz_rad(one)[0] for one in noisy])
    assert np.mean(np.abs(np.diff(theta_x)) > 180) > 0.4
    relative = [rotation_between(one, other).magnitude() for one, other in pairwise(noisy)]
    assert np.degrees(np.max(relative)) < 3
