"""The closed form's derivatives, projections, fits and gates against independent oracles."""

import cv2
import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from estimators.mono_rectangle.accuracy import closed_form_sensitivity, fit_sensitivity, vertex_covariance_px
from estimators.mono_rectangle.angles import zyx_covariance, zyx_from_cam_rotation
from estimators.mono_rectangle.closed_form import aspect_ratio, raw_rotation
from estimators.mono_rectangle.projection import project_to_so3
from estimators.mono_rectangle.quadrilateral import edge_ends, edge_normals, intersections
from estimators.mono_rectangle.rectangle_fit import (
    RectanglePose,
    closed_form_pose,
    fit_rectangle,
    vertex_jacobian,
    vertex_residual,
)

F_PX = 2133.33
CORNERS = np.array([[0, -5, -1.5], [0, 5, -1.5], [0, -5, 1.5], [0, 5, 1.5]], dtype=float)
FACING = np.array([[0, 1, 0], [0, 0, -1], [-1, 0, 0]], dtype=float)


def posed(euler_deg=(12.0, -25.0, 8.0), offset=(2.0, -1.0, 60.0)):
    R = Rotation.from_euler("xyz", euler_deg, degrees=True).as_matrix() @ FACING
    points = CORNERS @ R.T + offset
    return R, points[:, :2] / points[:, 2:]


def noisy(vertices, sigma_px, seed, count=1):
    return vertices + np.random.default_rng(seed).normal(0, sigma_px / F_PX, (count, 4, 2))


def test_the_closed_form_agrees_with_cv2_which_knows_the_size():
    _, vertices = posed()
    ok, turn, _ = cv2.solvePnP(CORNERS, vertices * F_PX, np.diag([F_PX, F_PX, 1.0]), None)
    assert ok
    assert np.abs(cv2.Rodrigues(turn)[0] - raw_rotation(vertices)).max() < 1e-5
    assert aspect_ratio(vertices) == pytest.approx(10 / 3)


@pytest.mark.parametrize("how", ["svd", "gs2", "gs3"])
def test_projections_give_rotations_that_keep_what_they_promise(how):
    _, vertices = posed()
    raw = raw_rotation(noisy(vertices, 0.3, 0, 200))
    R = project_to_so3(raw, how)
    assert np.abs(R @ np.swapaxes(R, -1, -2) - np.eye(3)).max() < 1e-12
    assert np.linalg.det(R) == pytest.approx(1)
    if how == "gs2":
        assert np.abs(R[..., 1] - raw[..., 1]).max() < 1e-12
    if how == "gs3":
        assert np.abs(R[..., 2] - raw[..., 2]).max() < 1e-12
    if how == "svd":  # nearest: no other rotation is nearer
        other = Rotation.from_rotvec(np.random.default_rng(1).normal(0, 0.01, (200, 3))).as_matrix() @ R
        assert np.all(np.linalg.norm(R - raw, axis=(1, 2)) <= np.linalg.norm(other - raw, axis=(1, 2)))


def test_a_degenerate_quadrilateral_is_nan_and_stays_so():
    line = np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]])
    both = np.stack([line, posed()[1]])
    R = project_to_so3(raw_rotation(both))
    assert np.isnan(R[0]).any()
    assert np.isfinite(R[1]).all()


def test_the_jacobian_is_the_derivative():
    pose = closed_form_pose(posed()[1])
    numeric = np.empty((8, 7))
    for i, step in enumerate(1e-6 * np.eye(7)):
        numeric[:, i] = np.ravel(pose.moved(step).vertices() - pose.moved(-step).vertices()) / 2e-6
    assert vertex_jacobian(pose) == pytest.approx(numeric, abs=1e-8)


@pytest.mark.parametrize("aspect", [None, 10 / 3])
def test_the_fit_is_scipys_least_squares(aspect):
    _, vertices = posed()
    for each in noisy(vertices, 0.3, 2, 5):
        start = closed_form_pose(each)

        def residual(x, start=start, each=each):
            pose = _moved(start, x, aspect)
            return F_PX * np.ravel(pose.vertices() - each)

        solved = least_squares(residual, np.zeros(7 if aspect is None else 6), xtol=1e-14, ftol=1e-14, gtol=1e-14)
        ours = fit_rectangle(each, aspect=aspect)
        assert F_PX * vertex_residual(ours, each) == pytest.approx(np.sqrt(2 * solved.cost / 4), rel=1e-5)


def _moved(start, x, aspect):
    if aspect is None:
        return start.moved(x)
    moved = start.moved(np.insert(x, 3, 0.0))
    return RectanglePose(moved.rotation, moved.first, moved.log_width + np.log(aspect) + x[2], moved.log_width + x[2])


def test_a_known_aspect_has_a_twin_and_the_start_chooses():
    R, vertices = posed((0.0, -20.0, 0.0), (0.0, 0.0, 60.0))
    twin_start = closed_form_pose(posed((0.0, 20.0, 0.0), (0.0, 0.0, 60.0))[1])
    right, twin = fit_rectangle(vertices, aspect=10 / 3), fit_rectangle(vertices, twin_start, aspect=10 / 3)
    assert vertex_residual(right, vertices) < 1e-9
    assert Rotation.from_matrix(right.rotation @ R.T).magnitude() < 1e-6
    assert F_PX * vertex_residual(twin, vertices) > 0.3


@pytest.mark.parametrize("aspect_known", [False, True])
def test_predicted_covariances_are_those_of_monte_carlo(aspect_known):
    R, vertices = posed()
    sigma_px = 0.05
    many = noisy(vertices, sigma_px, 3, 4000)
    fitted = fit_rectangle(many, aspect=10 / 3 if aspect_known else None).rotation
    closed = project_to_so3(raw_rotation(many))
    for found, slopes in (
        (closed, closed_form_sensitivity(vertices).rotation),
        (fitted, fit_sensitivity(closed_form_pose(vertices), known_aspect=aspect_known)),
    ):
        turns = Rotation.from_matrix(found @ R.T).as_rotvec()
        assert np.cov(turns.T) == pytest.approx(slopes @ slopes.T * (sigma_px / F_PX) ** 2, rel=0.15, abs=2e-7)


def test_scalar_slopes_and_angle_covariance_are_those_of_monte_carlo():
    R, vertices = posed()
    many = noisy(vertices, 0.02, 4, 8000)
    slopes, variance = closed_form_sensitivity(vertices), (0.02 / F_PX) ** 2
    raw = raw_rotation(many)
    assert np.sum(raw[..., 1] * raw[..., 2], axis=-1).std() == pytest.approx(
        np.linalg.norm(slopes.skew) * np.sqrt(variance), rel=0.04
    )
    assert np.log(aspect_ratio(many)).std() == pytest.approx(np.linalg.norm(slopes.log_aspect) * np.sqrt(variance), rel=0.04)
    angles = zyx_from_cam_rotation(Rotation.from_matrix(project_to_so3(raw)))
    expected = zyx_covariance(slopes.rotation @ slopes.rotation.T * variance, zyx_from_cam_rotation(Rotation.from_matrix(R)))
    assert np.cov(angles.T) == pytest.approx(expected, rel=0.15, abs=0.03 * np.abs(expected).max())


def test_vertex_covariance_is_that_of_monte_carlo():
    quad = np.array([[40.0, 90.0], [160.0, 80.0], [50.0, 30.0], [158.0, 33.0]])
    ends, normals = edge_ends(quad), edge_normals(edge_ends(quad), quad.mean(axis=0))
    rng = np.random.default_rng(5)
    factors = rng.normal(0, 0.05, (4, 2, 2))
    covariances = factors @ np.swapaxes(factors, -1, -2)
    shifts = np.einsum("eij,nej->nei", factors, rng.normal(size=(20_000, 4, 2)))
    moved = intersections(ends + shifts[..., None] * normals[:, None, :])
    expected = vertex_covariance_px(normals, covariances)
    assert np.cov(moved.reshape(-1, 8).T) == pytest.approx(expected, rel=0.1, abs=0.04 * np.abs(expected).max())
