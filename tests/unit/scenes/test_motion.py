"""Motions: the paper's sweep against its own matrices written out, spins, random views."""

from itertools import pairwise

import numpy as np
import pytest
from pydantic import ValidationError
from scipy import stats
from scipy.spatial.transform import Rotation

from scenes.motion import CHASER_FROM_PAPER, AxisSweep, RandomViews, Spin

# The paper's camera axes from ours, P_paper = M P_cv: X backward, Y right, Z up.
M = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


def _passive(axis: str, angle: float) -> np.ndarray:
    """The paper's elementary matrices (passive)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array(
        {
            "x": [[1, 0, 0], [0, c, s], [0, -s, c]],
            "y": [[c, 0, -s], [0, 1, 0], [s, 0, c]],
            "z": [[c, s, 0], [-s, c, 0], [0, 0, 1]],
        }[axis]
    )


def test_chaser_from_paper_is_the_transpose_of_m():
    assert np.array_equal(CHASER_FROM_PAPER, M.T)
    assert np.linalg.det(CHASER_FROM_PAPER) == 1.0


@pytest.mark.parametrize("axis", ["x", "y", "z"])
@pytest.mark.parametrize("time_s", [0.0, 100.0, 419.31, 838.0])
def test_a_sweep_follows_the_papers_passive_matrices(axis: str, time_s: float):
    sweep = AxisSweep(type="axis-sweep", axis=axis, start_deg=-41.931, rate_deg_s=0.1, range_m=100.0)
    theta = np.radians(-41.931 + 0.1 * time_s)
    pose = sweep.chaser_from_target(time_s, 0, 0)
    assert pose.rotation.as_matrix() == pytest.approx(M.T @ _passive(axis, theta), abs=1e-14)
    assert pose.translation == pytest.approx([0.0, 0.0, 100.0])


def test_at_zero_the_face_looks_into_the_camera_with_p1_bottom_left():
    pose = AxisSweep(type="axis-sweep", axis="y", start_deg=0.0, rate_deg_s=0.1, range_m=100.0).chaser_from_target(0.0, 0, 0)
    assert pose.rotation.apply([1.0, 0.0, 0.0]) == pytest.approx([0.0, 0.0, -1.0])  # its normal, towards the chaser
    bottom_left = pose.apply([1.5, -1.5, -1.5])
    assert bottom_left[0] < 0  # left
    assert bottom_left[1] > 0  # and down, in axes with y down


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_angular_velocity_is_the_derivative_of_the_attitude(axis: str):
    sweep = AxisSweep(type="axis-sweep", axis=axis, start_deg=20.0, rate_deg_s=3.0, range_m=10.0)
    spin = Spin(type="spin", position_m=(0, 0, 5), rotation_vector_deg=(10, 20, 30), omega_target_deg_s=(4.0, -2.0, 7.0))
    for motion in (sweep, spin):
        before, after = (motion.chaser_from_target(5.0 + step, 0, 0).rotation for step in (-5e-4, 5e-4))
        in_target = (before.inv() * after).as_rotvec() / 1e-3
        assert in_target == pytest.approx(motion.omega_target_rad_s(), abs=1e-9)


def test_a_spin_drifts_and_turns_evenly():
    spin = Spin(type="spin", position_m=(1, 2, 30), velocity_m_s=(0.1, -0.2, -0.5), omega_target_deg_s=(0, 0, 6.0))
    assert spin.chaser_from_target(10.0, 0, 0).translation == pytest.approx([2.0, 0.0, 25.0])
    assert spin.chaser_from_target(10.0, 0, 0).rotation.as_rotvec(degrees=True) == pytest.approx([0, 0, 60.0])
    turns = [spin.chaser_from_target(float(time), 0, 0).rotation for time in range(5)]
    steps = [(a.inv() * b).as_rotvec() for a, b in pairwise(turns)]
    assert np.ptp(steps, axis=0) == pytest.approx([0, 0, 0], abs=1e-12)


def _views(**changes) -> RandomViews:
    return RandomViews.model_validate(
        {"type": "random-views", "range_m": {"draw": "log-uniform", "low": 5.0, "high": 50.0}} | changes
    )


def test_random_views_have_uniform_attitudes():
    attitudes = Rotation.concatenate([_views().chaser_from_target(0.0, frame, 3).rotation for frame in range(2000)])
    # Haar measure: rotation angle has density (1 − cos φ) / π, and axes fall evenly on the sphere.
    angle = attitudes.magnitude()
    assert stats.kstest(angle, lambda phi: (phi - np.sin(phi)) / np.pi).pvalue > 1e-3
    for vector in np.eye(3):
        turned = attitudes.apply(vector)
        assert np.abs(turned.mean(axis=0)).max() < 4 / np.sqrt(3 * 2000)
        assert stats.kstest(turned[:, 2], stats.uniform(-1, 2).cdf).pvalue > 1e-3


def test_random_views_place_the_target_at_range_and_angles():
    poses = [_views(right_deg=12.0, down_deg=-7.0).chaser_from_target(0.0, frame, 3) for frame in range(200)]
    positions = np.array([pose.translation for pose in poses])
    ranges = np.linalg.norm(positions, axis=1)
    assert ranges.min() >= 5.0
    assert ranges.max() <= 50.0
    assert np.degrees(np.arctan2(positions[:, 0], positions[:, 2])) == pytest.approx(np.full(200, 12.0))
    assert np.degrees(np.arctan2(positions[:, 1], positions[:, 2])) == pytest.approx(np.full(200, -7.0))


def test_one_random_field_more_changes_no_other():
    plain, more = _views(), _views(right_deg={"draw": "uniform", "low": -5.0, "high": 5.0})
    for frame in range(5):
        first, second = plain.chaser_from_target(0.0, frame, 3), more.chaser_from_target(0.0, frame, 3)
        assert np.array_equal(first.rotation.as_quat(), second.rotation.as_quat())
        assert np.linalg.norm(first.translation) == pytest.approx(np.linalg.norm(second.translation), rel=1e-12)
        assert not np.allclose(first.translation, second.translation)


def test_a_random_view_stands_still_within_its_exposure():
    views = _views()
    assert np.array_equal(views.chaser_from_target(0.0, 4, 1).as_matrix(), views.chaser_from_target(0.5, 4, 1).as_matrix())
    assert views.omega_target_rad_s() == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("range_m", [0.0, -3.0, {"draw": "uniform", "low": -3.0, "high": 9.0}])
def test_a_view_from_no_distance_is_refused(range_m):
    with pytest.raises(ValidationError, match="greater than 0"):
        _views(range_m=range_m)
