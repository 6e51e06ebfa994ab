"""Motions: the paper's sweep against its own matrices written out, spins, random views."""

from itertools import pairwise

import numpy as np
import pytest
from pydantic import ValidationError
from scipy import stats
from scipy.spatial.transform import Rotation

from scenes.motion import CHASER_FROM_PAPER, AxisSweep, NutationApproach, RandomViews, Spin

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
        assert in_target == pytest.approx(motion.omega_target_rad_s(5.0), abs=1e-9)


def test_a_spin_drifts_and_turns_evenly():
    spin = Spin(type="spin", position_m=(1, 2, 30), velocity_m_s=(0.1, -0.2, -0.5), omega_target_deg_s=(0, 0, 6.0))
    assert spin.chaser_from_target(10.0, 0, 0).translation == pytest.approx([2.0, 0.0, 25.0])
    assert spin.chaser_from_target(10.0, 0, 0).rotation.as_rotvec(degrees=True) == pytest.approx([0, 0, 60.0])
    turns = [spin.chaser_from_target(float(time), 0, 0).rotation for time in range(5)]
    steps = [(a.inv() * b).as_rotvec() for a, b in pairwise(turns)]
    assert np.ptp(steps, axis=0) == pytest.approx([0, 0, 0], abs=1e-12)


def _nutation(**changes) -> NutationApproach:
    tree = {"type": "nutation-approach", "position_m": (0.1, -0.2, 10.0), "velocity_m_s": (0.0, 0.01, -0.05)}
    tree |= {"rotation_vector_deg": (170.0, 5.0, 20.0), "nutation_deg": 6.0, "period_s": 30.0, "phase_deg": 40.0}
    return NutationApproach.model_validate(tree | changes)


@pytest.mark.parametrize("spin_deg_s", [0.0, 3.0, -20.0])
@pytest.mark.parametrize("time_s", [0.0, 7.3, 100.0])
def test_nutation_has_the_angular_velocity_of_its_attitude(spin_deg_s: float, time_s: float):
    motion = _nutation(spin_deg_s=spin_deg_s)
    before, after = (motion.chaser_from_target(time_s + step, 0, 0).rotation for step in (-5e-4, 5e-4))
    assert (before.inv() * after).as_rotvec() / 1e-3 == pytest.approx(motion.omega_target_rad_s(time_s), abs=1e-8)
    assert np.linalg.norm(motion.omega_target_rad_s(time_s)) == pytest.approx(np.linalg.norm(motion.omega_target_rad_s(1.0)))


def test_z_keeps_its_angle_to_the_cones_axis_and_goes_round_it_evenly():
    motion = _nutation(spin_deg_s=11.0)
    times = np.arange(0.0, 30.0, 3.0)
    cone = Rotation.from_rotvec(motion.rotation_vector_deg, degrees=True)
    z_axes = np.array([motion.chaser_from_target(time, 0, 0).rotation.apply([0.0, 0.0, 1.0]) for time in times])
    in_cone = cone.inv().apply(z_axes)
    assert np.degrees(np.arccos(in_cone[:, 2])) == pytest.approx(np.full(10, 6.0))
    azimuth = np.unwrap(np.arctan2(in_cone[:, 1], in_cone[:, 0]))
    assert np.degrees(np.diff(azimuth)) == pytest.approx(np.full(9, 36.0))


def test_without_spin_nutation_comes_back_and_without_nutation_it_is_a_spin():
    motion = _nutation()
    start, later = motion.chaser_from_target(4.0, 0, 0), motion.chaser_from_target(34.0, 0, 0)
    assert (start.rotation.inv() * later.rotation).magnitude() == pytest.approx(0.0, abs=1e-9)
    assert later.translation - start.translation == pytest.approx([0.0, 0.3, -1.5])
    turns = [motion.chaser_from_target(time, 0, 0).rotation for time in np.linspace(0, 30, 50, endpoint=False)]
    mean = Rotation.concatenate(turns).mean()
    assert (mean.inv() * Rotation.from_rotvec(motion.rotation_vector_deg, degrees=True)).magnitude() < 1e-7
    flat = _nutation(nutation_deg=0.0, spin_deg_s=6.0)
    spin = Spin(
        type="spin",
        position_m=flat.position_m,
        velocity_m_s=flat.velocity_m_s,
        rotation_vector_deg=flat.rotation_vector_deg,
        omega_target_deg_s=(0, 0, 6.0),
    )
    for time_s in (0.0, 3.0, 50.0):
        apart = flat.chaser_from_target(time_s, 0, 0).inv() * spin.chaser_from_target(time_s, 0, 0)
        assert np.abs(apart.as_matrix() - np.eye(4)).max() < 1e-12
        assert flat.omega_target_rad_s(time_s) == pytest.approx(spin.omega_target_rad_s(time_s))


@pytest.mark.parametrize("changes", [{"nutation_deg": 90.0}, {"nutation_deg": -1.0}, {"period_s": 0.0}])
def test_impossible_nutation_is_refused(changes: dict):
    with pytest.raises(ValidationError):
        _nutation(**changes)


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
    assert views.omega_target_rad_s(0.25) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("range_m", [0.0, -3.0, {"draw": "uniform", "low": -3.0, "high": 9.0}])
def test_a_view_from_no_distance_is_refused(range_m):
    with pytest.raises(ValidationError, match="greater than 0"):
        _views(range_m=range_m)
