"""The mathematics of Zhai et al. 2014 without noise, and what noise must do to it: bounds, slopes, Monte Carlo."""

from itertools import permutations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from estimators.mono_rectangle.angles import rotation_from_zyx, zyx_covariance, zyx_from_rotation
from estimators.mono_rectangle.closed_form import aspect_ratio, depth_ratios, is_possible, is_seen_from_outside, raw_rotation
from estimators.mono_rectangle.labels import CYCLIC_LABELLINGS, quarter_turn
from estimators.mono_rectangle.paper_form import (
    PAPER_FROM_CV,
    paper_depth_ratios,
    paper_from_normalised,
    paper_pitch,
    paper_rotation,
)
from estimators.mono_rectangle.projection import project_to_so3
from estimators.mono_rectangle.rectangle_fit import closed_form_pose, fit_rectangle, rotation_covariance_bound

F_PX, RANGE_M = 8e-3 / 3.75e-6, 100.0
REGIONS = {"face": (3.0, 3.0, (1.5, 0.0, 0.0)), "wing": (10.0, 3.0, (0.03, 7.0, 0.0)), "span": (23.0, 3.0, (0.03, 0.0, 0.0))}
SWEEP_DEG = {1: np.linspace(-41.931, 41.931, 839), 2: np.linspace(-36.0, 36.0, 721)}  # the paper's two cases at 1 Hz
SWEPT = {1: 1, 2: 0}  # case 1 turns about Y (θ2), case 2 about Z (θ1)
SIGNS = np.array([(-1, -1), (1, -1), (-1, 1), (1, 1)]) / 2


def corners_cam(cam_from_target, length, width, centre, offset):
    """P1..P4, (n, 4, 3), camera axes, of rectangles with ``length``, ``width`` (n,) and offsets (n, 3)."""
    zero = np.zeros((len(length), 4))
    local = np.stack([zero, SIGNS[:, 0] * length[:, None], SIGNS[:, 1] * width[:, None]], axis=-1) + centre
    return np.einsum("nij,nkj->nki", cam_from_target, local) + offset[:, None]


def image(points_cam):
    return points_cam[..., :2] / points_cam[..., 2:]


def in_cv(R_ct):
    return PAPER_FROM_CV.T @ R_ct


def sweep_vertices(case, region, theta_deg):
    """(rotation in OpenCV axes, normalised vertices) of a region along a sweep."""
    length, width, centre = REGIONS[region]
    angles = np.zeros((len(theta_deg), 3))
    angles[:, SWEPT[case]] = np.deg2rad(theta_deg)
    R = in_cv(rotation_from_zyx(angles))
    n = np.ones(len(theta_deg))
    return R, image(corners_cam(R, length * n, width * n, np.array(centre), np.array([0, 0, RANGE_M]) * n[:, None]))


def swept_error_deg(vertices, case, theta_deg):
    R = project_to_so3(raw_rotation(vertices))
    found = np.rad2deg(zyx_from_rotation(PAPER_FROM_CV @ R)[..., SWEPT[case]])
    return (found - theta_deg + 180) % 360 - 180


def angle_between(A, B):
    """Geodesic angle (rad) from the chord, which keeps its digits near zero where an arccos has none."""
    return 2 * np.arcsin(np.clip(np.linalg.norm(A - B, axis=(-2, -1)) / np.sqrt(8), 0, 1))


@pytest.fixture(scope="module")
def random_poses():
    """1e5 visible rectangles: sides 1-10 m, 20-200 m away, up to 0.25 off the axis; seen at most nearly edge-on."""
    rng, n = np.random.default_rng(1), 260_000
    R = Rotation.random(n, rng=rng).as_matrix()
    length, width, depth = rng.uniform(1, 10, n), rng.uniform(1, 10, n), rng.uniform(20, 200, n)
    aside = rng.uniform(-0.25, 0.25, (n, 2))
    offset = np.concatenate([aside, np.ones((n, 1))], axis=1) * depth[:, None]
    points = corners_cam(R, length, width, np.zeros(3), offset)
    cos_view = -np.sum(R[..., 0] * offset, axis=-1) / np.linalg.norm(offset, axis=-1)
    facing = np.flatnonzero(cos_view > 0.01)[:100_000]
    assert len(facing) == 100_000
    return {
        "R": R[facing], "points": points[facing], "vertices": image(points[facing]), "cos_view": cos_view[facing],
        "aspect": (length / width)[facing],
    }  # fmt: skip


def test_depth_ratios_are_exact(random_poses):
    ratios, depth = depth_ratios(random_poses["vertices"]), random_poses["points"][..., 2]
    for found, vertex in ((ratios.a, 1), (ratios.b, 2), (ratios.c, 3)):
        assert np.abs(found - depth[:, vertex] / depth[:, 0]).max() < 1e-11


def test_rotation_and_aspect_are_exact(random_poses):
    open_view = random_poses["cos_view"] > 0.2
    found = raw_rotation(random_poses["vertices"])
    apart = angle_between(found, random_poses["R"])
    assert apart[open_view].max() < 1e-10
    assert np.median(apart) < 1e-13
    aspect = aspect_ratio(random_poses["vertices"])
    assert np.abs(aspect / random_poses["aspect"] - 1)[open_view].max() < 1e-10
    assert is_possible(random_poses["vertices"]).all()


def test_angles_round_trip(random_poses):
    R_ct = PAPER_FROM_CV @ random_poses["R"]
    assert angle_between(rotation_from_zyx(zyx_from_rotation(R_ct)), R_ct).max() < 1e-9


@pytest.mark.parametrize("sign", [1, -1])
def test_angles_at_the_gimbal_lock_of_either_sign(sign):
    """At θ2 = ±90° only θ1 ± θ3 exists: θ3 = 0 is chosen and the rotation comes back."""
    angles = np.random.default_rng(2).uniform(-np.pi, np.pi, (1000, 3))
    angles[:, 1] = sign * np.pi / 2
    R = rotation_from_zyx(angles)
    found = zyx_from_rotation(R)
    assert np.all(found[:, 2] == 0)
    assert np.allclose(found[:, 1], sign * np.pi / 2, atol=1e-7)
    assert angle_between(rotation_from_zyx(found), R).max() < 1e-9
    nearly = rotation_from_zyx(angles + np.array([0, -sign * 1e-5, 0]))
    assert angle_between(rotation_from_zyx(zyx_from_rotation(nearly)), nearly).max() < 1e-9


def test_angles_are_passive_in_the_order_of_the_paper():
    """R_ct = Rx(θ3) Ry(θ2) Rz(θ1) with passive matrices is the product of SciPy's active rotations by −θ."""
    angles = np.random.default_rng(3).uniform(-1, 1, (100, 3))
    expected = [Rotation.from_euler("XYZ", [-t3, -t2, -t1]).as_matrix() for t1, t2, t3 in angles]
    assert np.allclose(rotation_from_zyx(angles), expected, atol=1e-14)


def test_the_papers_form_and_opencvs_are_one(random_poses):
    seen = random_poses["cos_view"] > 0.02
    vertices = random_poses["vertices"][seen]
    uv = paper_from_normalised(vertices, F_PX)
    R_ct = paper_rotation(uv, F_PX)
    assert angle_between(in_cv(R_ct), raw_rotation(vertices)).max() < 1e-9
    for printed, ours in zip(
        (paper_depth_ratios(uv).a, paper_depth_ratios(uv).b, paper_depth_ratios(uv).c),
        (depth_ratios(vertices).a, depth_ratios(vertices).b, depth_ratios(vertices).c),
        strict=True,
    ):
        assert np.abs(printed - ours).max() < 1e-9
    assert np.abs(paper_pitch(uv, F_PX) - zyx_from_rotation(R_ct)[:, 1]).max() < 1e-9


def test_v_down_is_noticed_by_case_2_and_not_by_case_1():
    """The control that must fail: v pointing down leaves the pitch and turns θ1 into 180° − θ1."""
    for case in (1, 2):
        theta = np.array([-30.0, -12.0, 7.0, 25.0])
        _, vertices = sweep_vertices(case, "wing", theta)
        upside_down = paper_from_normalised(vertices, F_PX) * [1, -1]
        R_ct = paper_rotation(upside_down, F_PX)
        assert np.allclose(np.linalg.det(R_ct), 1)
        angles = np.rad2deg(zyx_from_rotation(R_ct))
        if case == 1:
            assert np.allclose(angles[:, 1], theta, atol=1e-9)
        else:
            assert np.allclose((angles[:, 0] - (180 - theta) + 180) % 360 - 180, 0, atol=1e-9)
        R_right = paper_rotation(paper_from_normalised(vertices, F_PX), F_PX)
        assert np.allclose(np.rad2deg(zyx_from_rotation(R_right))[:, SWEPT[case]], theta, atol=1e-9)


def test_the_printed_equation_10_is_wrong_and_the_mended_one_right(random_poses):
    (u1, v1), (u2, v2), (u3, v3), (_, v4) = np.moveaxis(paper_from_normalised(random_poses["vertices"], F_PX), 0, -1)
    printed = ((u2 - u3) * (v2 - v1) - (u2 - u1) * (v2 - v3)) / ((u2 - u1) * (v2 - v3) - (u2 - u3) * (v2 - v4))
    true = random_poses["points"][:, 3, 2] / random_poses["points"][:, 0, 2]
    assert np.median(np.abs(printed - true)) > 1


def test_8_of_24_labellings_are_uncrossed_4_visible_and_these_are_quarter_turns(random_poses):
    vertices, R = random_poses["vertices"][:200], random_poses["R"][:200]
    orders = list(permutations(range(4)))
    uncrossed = {o for o in orders if depth_ratios(vertices[:, o]).all_positive.all()}
    visible = {o for o in uncrossed if is_seen_from_outside(vertices[:, o]).all()}
    assert sum(depth_ratios(vertices[:, o]).all_positive.any() for o in orders) == len(uncrossed) == 8
    assert not any(is_seen_from_outside(vertices[:, o]).any() for o in uncrossed - visible)
    assert visible == set(CYCLIC_LABELLINGS)
    for k, order in enumerate(CYCLIC_LABELLINGS):
        assert angle_between(raw_rotation(vertices[:, order]), R @ quarter_turn(k).as_matrix()).max() < 1e-8
    passive_x = [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
    assert np.allclose(quarter_turn(1).as_matrix(), passive_x, atol=1e-15)


def test_geometry_of_the_papers_experiment():
    assert pytest.approx(615.79, abs=0.01) == (1280 - 30) * 0.264 / (2 * np.tan(np.deg2rad(15)))
    assert pytest.approx(53.59, abs=0.005) == 2 * 100 * np.tan(np.deg2rad(15))
    assert pytest.approx(0.9146, abs=1e-4) == 0.264 / 615.79 * F_PX
    for region, size_px in (("face", (64.97, 64.97)), ("wing", (213.3, 64.0))):
        _, vertices = sweep_vertices(1, region, np.zeros(1))
        length_px = np.linalg.norm(vertices[0, 1] - vertices[0, 0]) * F_PX
        width_px = np.linalg.norm(vertices[0, 2] - vertices[0, 0]) * F_PX
        assert (length_px, width_px) == pytest.approx(size_px, abs=0.1)  # the wing's front is 3 cm nearer than 100 m


@pytest.mark.parametrize(("region", "sd_deg"), [("face", 2.64), ("wing", 0.82), ("span", 0.36)])
def test_monte_carlo_of_the_swept_angle_at_a_twentieth_of_a_pixel(region, sd_deg):
    theta = SWEEP_DEG[1][::10]
    _, vertices = sweep_vertices(1, region, theta)
    noise = np.random.default_rng(4).normal(0, 0.05 / F_PX, (400, *vertices.shape))
    error = swept_error_deg(vertices + noise, 1, theta)
    assert error.std() == pytest.approx(sd_deg, rel=0.05)
    assert abs(error.mean()) < 5 * sd_deg / np.sqrt(error.size)


@pytest.mark.parametrize(("region", "deg_per_px"), [("face", 57.9), ("span", 7.78)])
def test_bound_and_formula_of_the_sensitivity_at_fronto_parallel(region, deg_per_px):
    """Cramér-Rao, size unknown, and sd = 2 σ d² cos θ/(f L W), agree at θ = 0."""
    length, width, centre = REGIONS[region]
    _, vertices = sweep_vertices(1, region, np.zeros(1))
    bound = zyx_covariance(rotation_covariance_bound(closed_form_pose(vertices), 1 / F_PX), np.zeros((1, 3)))
    assert np.rad2deg(np.sqrt(bound[0, 1, 1])) == pytest.approx(deg_per_px, rel=0.005)
    formula = np.rad2deg(2 * (RANGE_M - centre[0]) ** 2 / (F_PX * length * width))
    assert formula == pytest.approx(deg_per_px, rel=0.03)


def test_the_closed_form_reaches_the_bound_of_the_face():
    """Efficiency: at θ = 0 and small noise the closed form's sd is the bound's, and it falls with cos θ."""
    rng, sigma_px = np.random.default_rng(5), 0.005
    for theta in (0.0, 30.0):
        _, vertices = sweep_vertices(1, "face", np.array([theta]))
        error = swept_error_deg(vertices + rng.normal(0, sigma_px / F_PX, (20_000, 4, 2)), 1, theta)
        assert error.std() / sigma_px == pytest.approx(57.9 * np.cos(np.deg2rad(theta)), rel=0.03)


@pytest.mark.parametrize(("case", "sigma_px", "max_deg"), [(1, 0.046, 2.6), (2, 0.053, 3.0)])
def test_the_vertex_noise_that_gives_the_papers_maxima_on_the_wing(case, sigma_px, max_deg):
    _, vertices = sweep_vertices(case, "wing", SWEEP_DEG[case])
    noise = np.random.default_rng(6).normal(0, sigma_px / F_PX, (100, *vertices.shape))
    error = np.abs(swept_error_deg(vertices + noise, case, SWEEP_DEG[case]))
    assert error.max(axis=1).mean() == pytest.approx(max_deg, rel=0.10)


def test_orthogonality_built_in_reaches_the_bound_where_the_projection_does_not():
    R = in_cv(rotation_from_zyx(np.deg2rad([[25.0, -30.0, 10.0]])))
    one = np.ones(1)
    vertices = image(corners_cam(R, 3 * one, 3 * one, np.array([1.5, 0, 0]), np.array([[0, 0, RANGE_M]])))
    noisy = vertices + np.random.default_rng(7).normal(0, 0.01 / F_PX, (4000, 4, 2))
    bound = np.rad2deg(np.sqrt(np.trace(rotation_covariance_bound(closed_form_pose(vertices), 0.01 / F_PX)[0])))
    fitted = np.rad2deg(np.sqrt(np.mean(angle_between(fit_rectangle(noisy).rotation, R) ** 2)))
    projected = np.rad2deg(np.sqrt(np.mean(angle_between(project_to_so3(raw_rotation(noisy)), R) ** 2)))
    assert bound == pytest.approx(0.487, rel=0.01)
    assert fitted == pytest.approx(bound, rel=0.04)
    assert projected == pytest.approx(0.75, rel=0.06)


def test_a_known_aspect_lowers_the_bound_only_when_tilted():
    """57.9°/px at θ = 0 with or without the size; 2.30 instead of 50 at 30° (bas-relief)."""
    for theta, deg_per_px in ((0.0, 57.9), (10.0, 6.97), (30.0, 2.30), (41.9, 1.63)):
        _, vertices = sweep_vertices(1, "face", np.array([theta]))
        covariance = rotation_covariance_bound(closed_form_pose(vertices), 1 / F_PX, known_aspect=True)
        angles = np.deg2rad([[0.0, theta, 0.0]])
        assert np.rad2deg(np.sqrt(zyx_covariance(covariance, angles)[0, 1, 1])) == pytest.approx(deg_per_px, rel=0.01)
