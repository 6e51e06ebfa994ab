"""Registration: known transforms come back, source and target can change places, covariances and frames keep their promises."""

from dataclasses import replace
from functools import cache
from typing import get_args

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation
from toy_scans import ToyLidar, at_range, model_cloud

from estimators.lidar_filter import registration_libraries
from estimators.lidar_filter.clouds import Returns, Surface, planes_through, returns_of
from estimators.lidar_filter.deskew import deskewed
from estimators.lidar_filter.parameters import Kind, RegistrationParameters, VisibilityParameters
from estimators.lidar_filter.registration import Registration, register
from estimators.lidar_filter.registration_noise import Noise, pose_covariance
from estimators.lidar_filter.visibility import seen
from scenes.arrays import Floats
from scenes.recording import LidarModel, Scan

KINDS = get_args(Kind)
POSE = at_range(Rotation.from_euler("xyz", [20.0, 130.0, -50.0], degrees=True))
NOISE = Noise(0.05, float(np.deg2rad(10.0) / 128 / np.sqrt(12)))
OFF = RigidTransform.from_components([0.05, -0.04, 0.06], Rotation.from_rotvec([0.02, -0.015, 0.01]))


def surface() -> Surface:
    model = model_cloud()
    return Surface(model.points_target, model.normals_target)


def visible(pose: RigidTransform) -> Surface:
    return surface().at(seen(surface().moved(pose), VisibilityParameters()))


@cache
def scan(sigma_m: float = 0.05) -> Scan:
    return ToyLidar(sigma_m=sigma_m).scan(POSE, np.random.default_rng(4))


def points(sigma_m: float = 0.05) -> Floats:
    calibration = LidarModel(128, 128, RigidTransform.identity(), sigma_m, 1e-3, 1.0, 150.0)
    return returns_of(scan(sigma_m), calibration).points_lidar


def laid(cloud: Floats, onto: Surface, start: RigidTransform, kind: str = "gicp", **others: float) -> Registration:
    found = register(cloud, onto, start, NOISE, RegistrationParameters.model_validate({"kind": kind, **others}))
    assert isinstance(found, Registration), found
    return found


def close(one: RigidTransform, other: RigidTransform, turn_deg: float, shift_m: float) -> bool:
    wrong = one.inv() * other
    return bool(np.rad2deg(wrong.rotation.magnitude()) < turn_deg and np.linalg.norm(wrong.translation) < shift_m)


@pytest.mark.parametrize("kind", KINDS)
def test_a_surface_moved_by_a_known_transform_is_laid_back(kind: str) -> None:
    """Points of the surface itself, without noise; small_gicp rests at 0.1° and 1 mm."""
    there = visible(POSE)
    exact = POSE.apply(there.points)
    found = laid(exact, there, POSE * OFF, kind, most_iterations=100)
    assert close(found.lidar_from_target, POSE, 0.1, 0.005)
    assert not close(POSE * OFF, POSE, 1.0, 0.05)


@pytest.mark.parametrize("kind", KINDS)
def test_a_scan_comes_within_half_a_degree_of_the_truth(kind: str) -> None:
    found = laid(points(), visible(POSE * OFF), POSE * OFF, kind)
    assert close(found.lidar_from_target, POSE, 0.7, 0.05)
    assert found.overlap > 0.95
    assert found.points == len(points())
    assert found.rmse_m < 0.15


def test_source_and_target_change_places_and_the_answer_is_the_inverse() -> None:
    there = visible(POSE)
    cloud = POSE.apply(there.points)
    forth = laid(cloud, there, POSE * OFF, most_iterations=100).lidar_from_target
    turned = Surface(cloud, POSE.rotation.apply(there.normals))
    distant = RigidTransform.from_translation([0.0, 0.0, 64.0])  # beams that look at the target's points need a place to look from
    back = laid(distant.apply(there.points), turned, distant * (POSE * OFF).inv(), most_iterations=100).lidar_from_target
    assert close(distant.inv() * back, forth.inv(), 0.05, 0.005)


@pytest.mark.parametrize("kind", KINDS)
def test_the_same_input_gives_the_same_bits(kind: str) -> None:
    """Open3D's sums are not the same twice where it runs on several threads."""
    once, again = (laid(points(), visible(POSE), POSE * OFF, kind) for _ in range(2))
    assert once.lidar_from_target.as_matrix().tobytes() == again.lidar_from_target.as_matrix().tobytes()
    assert once.covariance.tobytes() == again.covariance.tobytes()


@pytest.mark.parametrize("kind", KINDS)
def test_another_name_for_the_targets_axes_moves_the_answer_with_it(kind: str) -> None:
    renamed = RigidTransform.from_components([0.3, -0.2, 0.5], Rotation.from_euler("xyz", [20.0, -35.0, 50.0], degrees=True))
    there = visible(POSE * OFF)
    one = laid(points(), there, POSE * OFF, kind)
    two = laid(points(), there.moved(renamed), POSE * OFF * renamed.inv(), kind)
    assert close(two.lidar_from_target * renamed, one.lidar_from_target, 1e-6, 1e-6)


@pytest.mark.parametrize(("cloud", "onto"), [(0, 500), (19, 500), (500, 0), (500, 19)])
def test_too_few_points_of_either_are_a_sentence(cloud: int, onto: int) -> None:
    found = register(points()[:cloud], visible(POSE).at(np.arange(onto)), POSE, NOISE, RegistrationParameters())
    assert isinstance(found, str)
    assert str(cloud) in found


def test_points_far_from_the_surface_are_a_sentence() -> None:
    found = register(points(), visible(POSE), RigidTransform.from_translation([30.0, 0, 0]) * POSE, NOISE, RegistrationParameters())
    assert isinstance(found, str)


def test_a_quarter_of_outliers_moves_a_robust_registration_little() -> None:
    rng = np.random.default_rng(0)
    spoiled = points().copy()
    hit = rng.choice(len(spoiled), len(spoiled) // 4, replace=False)
    spoiled[hit] += rng.uniform(-3, 3, (len(hit), 3))
    assert close(laid(spoiled, visible(POSE), POSE * OFF).lidar_from_target, POSE, 1.0, 0.08)


def test_inputs_stay_as_they_were() -> None:
    cloud, there = points().copy(), visible(POSE)
    before = cloud.copy(), there.points.copy(), there.normals.copy()
    for array in (cloud, there.points, there.normals):
        array.flags.writeable = False
    laid(cloud, there, POSE * OFF)
    assert all(np.array_equal(one, other) for one, other in zip((cloud, there.points, there.normals), before, strict=True))


def test_a_library_that_answers_no_number_is_not_believed(monkeypatch: pytest.MonkeyPatch) -> None:
    import open3d as o3d

    class NoNumber:
        transformation = np.full((4, 4), np.nan)
        fitness = 1.0

    monkeypatch.setattr(o3d.pipelines.registration, "registration_generalized_icp", lambda *_: NoNumber())
    moved, _, converged = registration_libraries.plane_to_beam(points(), np.zeros(3), visible(POSE), 0.6, 5, NOISE, 3.0)
    assert not converged
    assert np.array_equal(moved.as_matrix(), np.eye(4))


def test_the_covariance_is_that_of_least_squares_with_the_pairs_held() -> None:
    """Point-to-plane least squares on noisy points, linear in the error, 4000 draws; the control has its axes exchanged."""
    rng = np.random.default_rng(1)
    there = visible(POSE)
    exact = POSE.apply(there.points)
    stated = pose_covariance(POSE, exact, there, NOISE, slack_m=1e4, scale=1.0)
    normals = there.normals
    R = POSE.rotation.as_matrix()
    jacobian = np.hstack([np.cross(normals, there.points), -normals @ R.T])
    sigma = np.sqrt(np.einsum("ni,nij,nj->n", normals @ R.T, NOISE.covariances(exact), normals @ R.T))
    weighted = jacobian / sigma[:, None]
    errors = rng.normal(size=(4000, len(sigma))) @ weighted @ np.linalg.inv(weighted.T @ weighted)
    nees = np.mean(np.einsum("ki,ij,kj->k", errors, np.linalg.inv(stated), errors))
    assert nees == pytest.approx(6.0, abs=0.25)
    exchanged = stated[np.ix_([3, 4, 5, 0, 1, 2], [3, 4, 5, 0, 1, 2])]
    assert not 3.0 < np.mean(np.einsum("ki,ij,kj->k", errors, np.linalg.inv(exchanged), errors)) < 12.0


def test_the_covariances_jacobian_is_that_of_the_pose() -> None:
    """R exp(θ), l + δ moves the point Rᵀ(p − l) by p × θ − Rᵀδ: against finite differences."""
    point = np.array([0.4, -0.8, 64.3])
    here = POSE.inv().apply(point)
    R = POSE.rotation.as_matrix()
    analytic = np.hstack([np.cross(here, np.eye(3)).T, -R.T])
    step = 1e-6
    numeric = np.empty((3, 6))
    for axis in range(6):
        error = step * np.eye(6)[axis]
        moved = RigidTransform.from_components(POSE.translation + error[3:], POSE.rotation * Rotation.from_rotvec(error[:3]))
        numeric[:, axis] = (moved.inv().apply(point) - here) / step
    assert np.allclose(analytic, numeric, atol=1e-4)


def test_only_what_faces_the_lidar_and_is_not_hidden_is_seen() -> None:
    """Two plates, one behind the other, both with a back: of four sides the LIDAR sees one."""
    y, x = np.mgrid[-1:1:0.05, -1:1:0.05].reshape(2, -1)
    sides = [np.stack([x, y, np.full_like(x, depth)], axis=1) for depth in (20.0, 20.02, 22.0, 22.02)]
    normals = [np.tile([0.0, 0.0, z], (len(x), 1)) for z in (-1.0, 1.0, -1.0, 1.0)]
    whole = Surface(np.concatenate(sides), np.concatenate(normals))
    mask = seen(whole, VisibilityParameters()).reshape(4, -1)
    assert mask[0].all()
    assert not mask[1].any()
    assert mask[2].mean() < 0.2  # the rim, past which the LIDAR looks, may be seen
    assert not mask[3].any()


def test_points_are_moved_onto_their_plane_and_normals_look_at_the_eye() -> None:
    """The scatter about a plane falls with the root of the neighbours' number, and the normals' error with it."""
    rng = np.random.default_rng(3)
    flat = np.hstack([rng.uniform(-1, 1, (2000, 2)), 0.05 * rng.normal(size=(2000, 1))])
    fitted = planes_through(flat, np.array([0.0, 0.0, 10.0]), 40)
    inside = np.abs(flat[:, :2]).max(axis=1) < 0.8
    assert np.std(fitted.points[inside, 2]) < 0.05 / np.sqrt(40) * 2
    assert np.all(fitted.normals[:, 2] > 0)


def test_a_scan_that_took_time_is_freed_of_the_motion() -> None:
    """The target turns and moves while the beams fire one after the other. Left as it is, the scan is off by the motion."""
    rng = np.random.default_rng(2)
    screw = np.array([0.05, -0.02, 0.08, 0.1, -0.2, 0.3])  # per second
    body = rng.uniform(-3, 3, (500, 3))
    times = np.linspace(-0.6, 0.4, 500)

    def pose(time_s: float) -> RigidTransform:
        return RigidTransform.from_exp_coords(time_s * screw) * POSE

    returned = np.array([pose(t).apply(p) for t, p in zip(times, body, strict=True)])
    freed = deskewed(Returns(returned, times), pose(-0.1), pose(0.4), 0.5, -0.1)
    assert np.allclose(freed, pose(-0.1).apply(body), atol=1e-9)
    assert np.abs(returned - pose(-0.1).apply(body)).max() > 0.3
    assert deskewed(Returns(returned, times), pose(-0.1), pose(0.4), 0.0, -0.1) is returned


def test_returns_outside_the_window_and_not_numbers_are_left_out() -> None:
    spoiled = scan().points_lidar.copy()
    rows, columns = np.nonzero(np.isfinite(spoiled[..., 0]))
    spoiled[rows[0], columns[0]] = [0.0, 0.0, 0.5]
    spoiled[rows[1], columns[1]] = [0.0, 0.0, 1e4]
    spoiled[rows[2], columns[2]] = [np.inf, 0.0, 60.0]
    calibration = LidarModel(128, 128, RigidTransform.identity(), 0.05, 1e-3, 1.0, 150.0)
    assert len(returns_of(replace(scan(), points_lidar=spoiled), calibration)) == len(rows) - 3
