"""The judge's angles against scipy's Euler angles, the paper's sweeps and the gimbal pole."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from benchmark.angles import PAPER_FROM_CAM, angle_of_axis, paper_angles, wrapped


def _passive(axis: str, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return {
        "x": np.array([[1, 0, 0], [0, c, s], [0, -s, c]]),
        "y": np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]]),
        "z": np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]),
    }[axis]


def test_angles_invert_the_papers_product_of_passive_matrices() -> None:
    rng = np.random.default_rng(0)
    for theta1, theta2, theta3 in rng.uniform([-3.1, -1.5, -3.1], [3.1, 1.5, 3.1], size=(200, 3)):
        r_ct = _passive("x", theta3) @ _passive("y", theta2) @ _passive("z", theta1)
        cam_from_target = Rotation.from_matrix(PAPER_FROM_CAM.T @ r_ct)
        assert_allclose(paper_angles(cam_from_target)[0], [theta1, theta2, theta3], atol=1e-12)


def test_angles_equal_scipys_intrinsic_xyz_of_the_paper_frame_with_the_passive_sign() -> None:
    attitudes = Rotation.random(1000, rng=1)
    in_paper_frame = Rotation.from_matrix(PAPER_FROM_CAM) * attitudes
    assert_allclose(paper_angles(attitudes), -in_paper_frame.as_euler("XYZ")[:, ::-1], atol=1e-9)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_at_the_pole_theta3_is_zero_and_the_attitude_is_kept(sign: float) -> None:
    r_ct = _passive("x", 0.4) @ _passive("y", sign * np.pi / 2) @ _passive("z", -0.7)
    theta1, theta2, theta3 = paper_angles(Rotation.from_matrix(PAPER_FROM_CAM.T @ r_ct))[0]
    assert theta3 == 0.0
    again = _passive("x", theta3) @ _passive("y", theta2) @ _passive("z", theta1)
    assert_allclose(again, r_ct, atol=1e-7)


@pytest.mark.parametrize(("axis", "column"), [("z", 0), ("y", 1), ("x", 2)])
def test_a_sweep_about_one_axis_shows_in_its_angle_alone(axis: str, column: int) -> None:
    for theta in np.radians([-41.931, -10.0, 0.0, 30.0]):
        angles = paper_angles(Rotation.from_matrix(PAPER_FROM_CAM.T @ _passive(axis, theta)))[0]
        expected = np.zeros(3)
        expected[column] = theta
        assert_allclose(angles, expected, atol=1e-12)
        assert angle_of_axis(axis) == f"theta{column + 1}"


def test_wrapped_is_the_half_open_circle() -> None:
    assert_allclose(wrapped(np.array([0.0, np.pi, -np.pi, 3 * np.pi, 7.0])), [0, np.pi, np.pi, np.pi, 7 - 2 * np.pi])
