"""What the last frames say of the next one, and when a ring is believed."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from estimators.stereo_ring.centre_filter import filtered
from estimators.stereo_ring.circle_cone import Circle
from estimators.stereo_ring.circle_fit import CirclesFit
from estimators.stereo_ring.confirmation import Confirmation
from estimators.stereo_ring.conics import Ellipse
from estimators.stereo_ring.measurement import Measured
from estimators.stereo_ring.motion import Motion, circle_at, followed, turned_to
from estimators.stereo_ring.parameters import TrackParameters

TRACK = TrackParameters()


def frame(angle_deg, x=0.0):
    return RigidTransform.from_components([x, 0.1, 5.0], Rotation.from_euler("xz", [170, angle_deg], degrees=True))


def measured(radius_m=0.6, share=0.9, rms_px=0.2):
    circle = Circle(np.array([0, 0, 5.0]), np.array([0, 0, -1.0]), radius_m)
    fit = CirclesFit(circle, np.array([radius_m]), (), np.eye(6), np.eye(2, 3), 0.1)
    ellipse = Ellipse(0.0, 0.0, 200.0, 190.0, 0.0)
    return Measured(fit, (ellipse, ellipse), (share, share), (rms_px, rms_px))


def test_a_uniform_motion_is_predicted_exactly_and_a_long_gap_not_at_all():
    motion = followed(Motion(frame(10.0), 0.0), frame(12.28, 0.01), 1.0, 5.0)
    ahead = motion.at(2.0, 5.0)
    turn = ahead.rotation.inv() * frame(14.56).rotation
    assert turn.magnitude() == pytest.approx(0, abs=1e-12)
    assert ahead.translation[0] == pytest.approx(0.02)
    assert motion.at(30.0, 5.0).translation[0] == pytest.approx(0.01)
    assert followed(motion, frame(40.0), 30.0, 5.0).rate_rad_s is None


def test_one_frame_predicts_its_own_place():
    assert Motion(frame(10.0), 0.0).at(1.0, 5.0).translation[0] == 0.0


def test_a_frame_is_turned_to_a_normal_the_shortest_way():
    start = frame(10.0)
    normal = Rotation.from_rotvec([0.02, -0.01, 0.0]).apply(start.rotation.as_matrix()[:, 2])
    there = turned_to(start, Circle(np.array([1.0, 2.0, 3.0]), normal, 0.6))
    assert there.rotation.as_matrix()[:, 2] == pytest.approx(normal, abs=1e-12)
    assert there.translation.tolist() == [1.0, 2.0, 3.0]
    angle = np.arccos(normal @ start.rotation.as_matrix()[:, 2])
    assert (there.rotation * start.rotation.inv()).magnitude() == pytest.approx(angle)
    same = turned_to(start, circle_at(start, 0.6))
    assert np.abs(same.as_matrix() - start.as_matrix()).max() < 1e-12


def test_overwhelming_evidence_is_believed_at_once_and_other_in_two_of_three_frames():
    assert Confirmation().seen(measured(), TRACK).believed
    weak = measured(share=0.5, rms_px=0.5)
    once = Confirmation().seen(weak, TRACK)
    assert not once.believed
    assert once.missed(TRACK).seen(weak, TRACK).believed
    assert not once.missed(TRACK).missed(TRACK).missed(TRACK).seen(weak, TRACK).believed


def test_the_radius_is_remembered_as_a_mean_and_judges():
    memory = Confirmation().seen(measured(0.598), TRACK).seen(measured(0.602), TRACK)
    assert memory.radius_m == pytest.approx(0.6)
    assert memory.agrees(0.61, TRACK)
    assert not memory.agrees(0.56, TRACK)  # the face's inner edge
    assert not memory.agrees(0.63, TRACK)  # a shadow
    assert Confirmation().agrees(0.3, TRACK)


def path(measurements, gain, farthest_m=0.05):
    state, found = None, []
    for time_s, centre in enumerate(measurements):
        state = filtered(state, centre, float(time_s), gain, 5.0, farthest_m)
        found.append(state.centre_m)
    return np.array(found)


def test_the_filter_does_not_lag_behind_a_uniform_motion_and_is_none_at_gain_one():
    straight = np.arange(60)[:, None] * np.array([0.001, -0.002, 0.026])
    assert np.abs(path(straight, 0.3) - straight).max() < 1e-12
    noisy = straight + np.random.default_rng(1).normal(0, 1e-3, straight.shape)
    assert np.array_equal(path(noisy, 1.0), noisy)


def test_the_filter_divides_the_noise_from_frame_to_frame_as_it_says():
    """White noise; √2/α, to a third of it, since the speed is corrected, too."""
    noise = np.random.default_rng(2).normal(0, 1e-3, (4000, 3))
    ratio = np.std(np.diff(noise, axis=0)) / np.std(np.diff(path(noise, 0.2), axis=0)[100:])
    assert ratio == pytest.approx(np.sqrt(2) / 0.2, rel=0.35)


def test_a_jump_begins_a_new_path():
    jump = np.zeros((20, 3))
    jump[1:] += 1e-6
    jump[10:] += 0.2
    assert np.abs(path(jump, 0.2) - jump).max() < 0.01
