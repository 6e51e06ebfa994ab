"""The algebra of bounds, and scans' bounds against differences of ranges and against fits to noisy ranges."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.information.fisher import (
    CHI2_MEDIAN_3,
    CHI2_MEDIAN_6,
    attitude_efficiency,
    bound,
    efficiency,
    in_axes,
    information,
    pose_error,
    stereo_bound,
    without_nuisance,
)
from benchmark.information.pictures import Derivatives, bounds_of
from benchmark.information.scans import jacobian, scan_bound


def _some_information(seed: int = 0) -> np.ndarray:
    rows = np.random.default_rng(seed).normal(size=(200, 6)) * [30, 20, 10, 2, 2, 0.5]
    return rows.T @ rows


def test_the_bound_is_the_inverse_and_refuses_what_is_not_positive_definite() -> None:
    matrix = _some_information()
    found = bound(matrix)
    np.testing.assert_allclose(found.covariance @ matrix, np.eye(6), atol=1e-10)
    assert found.rotation_rad == pytest.approx(np.sqrt(np.trace(np.linalg.inv(matrix)[:3, :3])))
    direction = np.linalg.qr(np.random.default_rng(1).normal(size=(6, 6)))[0][:, :1]
    flat = matrix - matrix @ direction @ direction.T @ matrix / (direction.T @ matrix @ direction)
    for degenerate in (flat, np.zeros((6, 6)), -matrix, np.full((6, 6), np.nan)):
        assert not bound(degenerate).is_determined


def test_an_unknown_scale_makes_the_direction_of_sight_undetermined() -> None:
    """Of a target of unknown size at t, growing it moves every point as coming nearer does: the seventh column is collinear."""
    rng = np.random.default_rng(2)
    points, t = rng.normal(size=(40, 3)), np.array([0.2, -0.1, 12.0])
    seen = points + t
    project = np.stack([np.stack([1 / seen[:, 2], 0 * seen[:, 2], -seen[:, 0] / seen[:, 2] ** 2], 1),
                        np.stack([0 * seen[:, 2], 1 / seen[:, 2], -seen[:, 1] / seen[:, 2] ** 2], 1)], 1)  # fmt: skip
    turns = np.stack([np.cross(np.tile(axis, (40, 1)), points) for axis in np.eye(3)], 2)
    rows = np.concatenate([project @ turns, project, project @ points[:, :, None]], axis=2).reshape(-1, 7)
    full = rows.T @ rows
    scale = 1 / np.sqrt(np.diag(full))
    assert abs(np.linalg.eigvalsh(full * np.outer(scale, scale))[0]) < 1e-12


def test_a_nuisance_takes_what_a_joint_fit_would_lose() -> None:
    rows = np.random.default_rng(3).normal(size=(300, 8))
    full = rows.T @ rows
    np.testing.assert_allclose(np.linalg.inv(without_nuisance(full, 6)), np.linalg.inv(full)[:6, :6], rtol=1e-9)


def test_two_noisy_derivatives_do_not_inflate_information_and_one_does() -> None:
    rng, n = np.random.default_rng(4), 40000
    true = rng.normal(size=(6, n)) * 0.1
    first, second = (true + rng.normal(size=(6, n)) * 0.3 for _ in range(2))
    weight = np.full(n, 2.0)
    exact = (true * weight) @ true.T
    np.testing.assert_allclose(np.diag(information(weight, first, second)), np.diag(exact), rtol=0.2)
    assert (np.diag(information(weight, first, first)) > 8 * np.diag(exact)).all()


@pytest.mark.parametrize(("read_e", "brighter", "ratio"), [(0.0, 4.0, 0.5), (1e4, 4.0, 0.25)])
def test_four_times_the_light_halves_the_spread_of_shot_noise_and_quarters_that_of_read_noise(
    read_e: float, brighter: float, ratio: float
) -> None:
    rng = np.random.default_rng(5)
    mean, slope = rng.uniform(100, 1000, 500), rng.normal(size=(6, 500)) * 50

    def spread(gain: float) -> np.ndarray:
        found = Derivatives(gain * slope, gain * slope, gain * mean, np.zeros(500))
        return bounds_of(found, 1 / (gain * mean + read_e**2)).known.sigma

    np.testing.assert_allclose(spread(brighter) / spread(1.0), ratio, rtol=2e-3)


def test_other_axes_give_the_same_ellipsoid() -> None:
    matrix, turn = _some_information(), Rotation.from_rotvec([0.3, -0.7, 0.2])
    there = in_axes(matrix, turn)
    error = np.array([0.01, -0.02, 0.03, 0.1, 0.2, -0.3])
    moved = np.concatenate([turn.apply(error[:3]), turn.apply(error[3:])])
    assert moved @ there @ moved == pytest.approx(error @ matrix @ error)


def test_two_cameras_know_what_a_joint_fit_to_both_would() -> None:
    """Rows of both cameras' readings about ξ in the left one's axes, stacked, against the sum of the two bounds."""
    rng, left_from_right = np.random.default_rng(9), Rotation.from_rotvec([0.2, 1.0, -0.4])
    left, right = (rng.normal(size=(200, 6)) * [30, 20, 10, 2, 2, 0.5] for _ in range(2))
    turn = left_from_right.inv().as_matrix()
    stacked = np.vstack([left, np.hstack([right[:, :3] @ turn, right[:, 3:] @ turn])])
    found = stereo_bound(bound(left.T @ left), bound(right.T @ right), left_from_right)
    np.testing.assert_allclose(found.covariance, np.linalg.inv(stacked.T @ stacked), rtol=1e-8)
    wrong = stereo_bound(bound(left.T @ left), bound(right.T @ right), left_from_right.inv())
    assert not np.allclose(wrong.covariance, found.covariance, rtol=0.05, atol=0)


def test_one_picture_without_an_image_leaves_what_the_other_tells() -> None:
    matrix, dark = _some_information(), bound(np.zeros((6, 6)))
    assert not dark.is_determined
    for both in (stereo_bound(bound(matrix), dark, Rotation.identity()), stereo_bound(dark, bound(matrix), Rotation.identity())):
        np.testing.assert_allclose(both.information, matrix)
        assert both.is_determined


def test_an_ideal_estimator_has_efficiency_one_and_one_of_twice_its_spread_a_quarter() -> None:
    matrix = _some_information()
    covariance = np.linalg.inv(matrix)
    errors = np.random.default_rng(6).multivariate_normal(np.zeros(6), covariance, 20000)
    many = np.broadcast_to(matrix, (20000, 6, 6))
    marginal = np.broadcast_to(covariance[:3, :3], (20000, 3, 3))
    assert efficiency(errors, many) == pytest.approx(1.0, rel=0.02)
    assert efficiency(2 * errors, many) == pytest.approx(0.25, rel=0.02)
    assert attitude_efficiency(errors[:, :3], marginal) == pytest.approx(1.0, rel=0.03)
    assert pytest.approx(5.348, abs=1e-3) == CHI2_MEDIAN_6
    assert pytest.approx(2.366, abs=1e-3) == CHI2_MEDIAN_3


def test_an_error_is_the_step_that_was_made() -> None:
    true, step = Rotation.from_rotvec([[0.1, 0.2, 0.3]]), np.array([1e-3, -2e-3, 3e-3])
    found = pose_error(true, np.zeros((1, 3)), Rotation.from_rotvec(step) * true, np.array([[0.1, 0.2, 0.3]]))
    np.testing.assert_allclose(found[0], [*step, 0.1, 0.2, 0.3], atol=1e-12)


# Three faces of a box seen from a corner, as planes n·x = c in the target's frame.
_NORMALS = np.array([[1.0, 0, 0], [0, 1.0, 0], [0, 0, -1.0]])
_OFFSETS = np.array([0.6, 0.5, 0.7])
_POSE = RigidTransform.from_components([0.3, -0.2, 9.0], Rotation.from_euler("xyz", [35, -40, 15], degrees=True))


def _ranges(pose: RigidTransform, sight: np.ndarray, face: np.ndarray) -> np.ndarray:
    """Range (n,) along ``sight`` to the plane ``face`` of the target at ``pose``."""
    normals = pose.rotation.apply(_NORMALS)[face]
    return (_OFFSETS[face] + np.einsum("ni,i->n", normals, pose.translation)) / np.einsum("ni,ni->n", normals, sight)


def _beams(count: int = 400) -> tuple[np.ndarray, np.ndarray]:
    """Directions in the sensor's axes and the faces that they are taken to meet."""
    rng = np.random.default_rng(7)
    face = rng.integers(3, size=count)
    inside = rng.uniform(-0.4, 0.4, (count, 3))
    points = np.where(np.arange(3)[None] == face[:, None], _NORMALS[face] * _OFFSETS[face, None], inside)
    hits = _POSE.apply(points)
    return hits / np.linalg.norm(hits, axis=1, keepdims=True), face


def _moved(xi: np.ndarray) -> RigidTransform:
    return RigidTransform.from_components(_POSE.translation + xi[3:], Rotation.from_rotvec(xi[:3]) * _POSE.rotation)


def _rows(sight: np.ndarray, face: np.ndarray) -> np.ndarray:
    return jacobian(_ranges(_POSE, sight, face)[:, None] * sight, _POSE.rotation.apply(_NORMALS)[face], _POSE.translation)


def test_ranges_move_with_the_pose_as_the_jacobian_says() -> None:
    sight, face = _beams()
    rows = _rows(sight, face)
    for axis in range(6):
        step = 1e-6 * np.eye(6)[axis]
        slope = (_ranges(_moved(step), sight, face) - _ranges(_moved(-step), sight, face)) / 2e-6
        np.testing.assert_allclose(rows[:, axis], slope, rtol=1e-6, atol=1e-7)


def test_a_fit_to_noisy_ranges_reaches_the_scans_bound() -> None:
    """300 scans of σ = 2 cm, Gauss-Newton from a tenth of a radian off; the standard error of a spread is 4 %."""
    (sight, face), sigma, rng = _beams(), 0.02, np.random.default_rng(8)
    found = scan_bound(_rows(sight, face), np.full(len(face), sigma))
    errors = []
    for _ in range(300):
        measured = _ranges(_POSE, sight, face) + rng.normal(scale=sigma, size=len(face))
        pose = _moved(0.01 * rng.normal(size=6))
        for _ in range(4):
            hits = _ranges(pose, sight, face)[:, None] * sight
            rows = jacobian(hits, pose.rotation.apply(_NORMALS)[face], pose.translation)
            xi = np.linalg.lstsq(rows, measured - _ranges(pose, sight, face), rcond=None)[0]
            pose = RigidTransform.from_components(pose.translation + xi[3:], Rotation.from_rotvec(xi[:3]) * pose.rotation)
        errors.append(pose_error(_POSE.rotation, _POSE.translation, pose.rotation, pose.translation)[0])
    np.testing.assert_allclose(np.std(errors, axis=0) / found.bound.sigma, 1.0, atol=0.1)
    nees = np.einsum("ni,ij,nj->n", errors, found.bound.information, errors)
    assert nees.mean() / 6 == pytest.approx(1.0, abs=0.1)
    assert 0.0 < found.leverage < 0.2
