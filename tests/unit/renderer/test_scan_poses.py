"""A LIDAR's pose at each beam's own instant, from knots."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from renderer.scan_poses import INTERVALS, BeamTimes, ScanPoses

TIMES = BeamTimes.of(np.linspace(-0.7, 0.7, 501))


def spinning(instant_s: float) -> RigidTransform:
    """lidar_from_target of a target that turns at 0.6 rad/s about a skew axis and drifts."""
    turn = Rotation.from_rotvec(np.array([0.2, -0.5, 0.26]) * instant_s) * Rotation.from_rotvec([1.0, 0.3, -2.0])
    return RigidTransform.from_components([0.3 * instant_s, -1.0, 60.0 - 2.0 * instant_s], turn)


def test_knots_span_the_scan_and_fractions_lie_within_an_interval():
    assert len(TIMES.knots_s) == INTERVALS + 1
    assert TIMES.moving
    assert TIMES.interval.min() == 0
    assert TIMES.interval.max() == INTERVALS - 1
    assert (TIMES.fraction >= 0).all()
    assert (TIMES.fraction <= 1).all()
    back = TIMES.knots_s[TIMES.interval] + TIMES.fraction * (TIMES.knots_s[1] - TIMES.knots_s[0])
    assert back == pytest.approx(np.linspace(-0.7, 0.7, 501))


def test_beams_fired_at_once_need_one_knot():
    times = BeamTimes.of(np.zeros(9))
    assert not times.moving
    calls = []
    poses = ScanPoses.at(times, lambda at: calls.append(at) or spinning(at))
    assert calls == [0.0]
    points = np.random.default_rng(1).normal(size=(9, 3))
    assert poses.target_points(np.arange(9), points) == pytest.approx(spinning(0.0).inv().apply(points))
    assert poses.at_reference(np.arange(9), points) is points


def test_a_target_that_spins_and_drifts_evenly_is_followed_exactly():
    poses = ScanPoses.at(TIMES, spinning)
    points = np.random.default_rng(2).normal(size=(501, 3)) + np.array([0, 0, 60.0])
    instants = np.linspace(-0.7, 0.7, 501)
    wanted = np.array([spinning(at).inv().apply(point) for at, point in zip(instants, points)])
    assert np.abs(poses.target_points(np.arange(501), points) - wanted).max() < 1e-11
    assert poses.at_reference(np.arange(501), points) == pytest.approx(spinning(0.0).apply(wanted), abs=1e-11)


def test_a_tumbling_target_is_followed_to_second_order():
    """Between knots h apart a rotation whose rate changes by ω̇ is off by ω̇ h² / 8 at most: here 5e-5 m, at 36 deg/s."""

    def wobbling(at: float) -> RigidTransform:
        turn = Rotation.from_euler("ZXZ", [2 * np.pi * at / 10, 0.4, -0.3 * at])
        return RigidTransform.from_components([0.0, 0.0, 60.0], turn)

    poses = ScanPoses.at(TIMES, wobbling)
    points = np.array([[2.0, -1.0, 58.0]] * 501)
    wanted = np.array([wobbling(at).inv().apply(points[0]) for at in np.linspace(-0.7, 0.7, 501)])
    error_m = np.linalg.norm(poses.target_points(np.arange(501), points) - wanted, axis=1).max()
    change_rad_s2, lever_m, knot_s = 2 * np.pi / 10 * 0.3 * np.sin(0.4), 3.0, 1.4 / INTERVALS
    bound_m = change_rad_s2 * knot_s**2 / 8 * lever_m
    assert 0.1 * bound_m < error_m < 1.01 * bound_m
