"""``stereo-ring`` on drawn rings: right from the first frames, through glare, shadow, loss and other cameras."""

from dataclasses import replace
from types import MappingProxyType

import cv2
import numpy as np
import pytest
import toy_ring as toy
from pydantic import ValidationError
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.conformance import faults
from estimators.api import Estimator, Outcome
from estimators.stereo_ring.tracked import TrackedRing
from scenes.arrays import frozen
from scenes.recording import Image, Observation, Ring, SensorModel

ASIDE = (-0.8, 0.2, 0.6)
SPIN_DEG = 2.28  # a frame, as in the paper
WITHOUT_RING = {"shadow": toy.PANEL_DN, "wall": toy.PANEL_DN, "top": toy.PANEL_DN, "inside": toy.PANEL_DN}


@pytest.fixture(scope="module", autouse=True)
def _one_thread():
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    yield
    cv2.setNumThreads(before)


def scenes(count, range_m=5.2, **changes):
    return [toy.Scene(toy.left_from_ring(range_m, 12, 7, 10 + SPIN_DEG * k), texture_dn=6.0, **changes) for k in range(count)]


def recorded(drawn):
    return [scene.observation(frame, frame) for frame, scene in enumerate(drawn)]


def answers(observations, told=None, **parameters):
    method = TrackedRing(**parameters)
    method.start(told or toy.knowledge())
    return [method.step(observation) for observation in observations]


def error_of(scene, estimate):
    """(mm of the centre, degrees of the normal, degrees about it)."""
    truth = scene.left_from_ring
    turn = (truth.rotation.inv() * estimate.sensor_from_target).as_matrix()
    normal_deg = np.degrees(np.arctan2(np.hypot(turn[0, 2], turn[1, 2]), turn[2, 2]))
    about_deg = np.degrees(np.arctan2(turn[1, 0] - turn[0, 1], turn[0, 0] + turn[1, 1]))
    return 1e3 * np.linalg.norm(estimate.translation_m - truth.translation), normal_deg, abs(about_deg)


def is_right(scene, estimate, within_px=0.5):
    for view, name in enumerate(("left", "right")):
        found = [estimate.extras[f"{name}_{key}_px"] for key in "xyab"]
        if np.abs(np.array(found) - scene.ellipse(view).parameters[:4]).max() > within_px:
            return False
    return True


@pytest.fixture(scope="module")
def spinning():
    drawn = scenes(5)
    return drawn, recorded(drawn)


def test_it_is_an_estimator():
    assert isinstance(TrackedRing(), Estimator)


@pytest.mark.parametrize("changes", [{}, {"light": ASIDE}, {"values": {"top": 140.0, "wall": 60.0}}])
def test_a_spinning_ring_is_right_in_every_frame(changes):
    """Evenly lit; with a crescent of shadow beside the ring, the largest ellipse there is; with a face hardly brighter than foil.
    """
    drawn = scenes(4, **changes)
    found = answers(recorded(drawn))
    assert sum(one.outcome is Outcome.OK for one in found) >= 3
    for scene, estimate in zip(drawn, found, strict=True):
        if estimate.outcome is Outcome.OK:
            mm, normal_deg, about_deg = error_of(scene, estimate)
            assert mm < 1.5
            assert normal_deg < 0.2
            assert about_deg < 0.25
            assert is_right(scene, estimate)
            assert estimate.extras["radius_m"] == pytest.approx(0.6, abs=2e-3)
            assert estimate.extras["from_ring"] == 1.0
            assert estimate.extras["markers"] >= 2


@pytest.mark.parametrize("range_m", [3.45, 10.0])
def test_near_and_far(range_m):
    drawn = scenes(3, range_m)
    found = answers(recorded(drawn))
    assert found[-1].outcome is Outcome.OK
    assert is_right(drawn[-1], found[-1])
    mm, normal_deg, _ = error_of(drawn[-1], found[-1])
    assert mm < 0.6 * range_m
    assert normal_deg < 0.05 * range_m


def test_it_keeps_every_promise(spinning):
    _, observations = spinning
    assert faults(TrackedRing, toy.knowledge(), observations[:3]) == []


def test_a_black_picture_is_a_failure_with_a_reason_and_is_survived(spinning):
    drawn, observations = spinning
    dark = {name: Image(np.zeros_like(image.pixels)) for name, image in observations[2].images.items()}
    found = answers([*observations[:2], replace(observations[2], images=MappingProxyType(dark)), *observations[3:]])
    assert found[2].outcome is Outcome.NO_FEATURES
    assert found[2].reason
    assert found[3].outcome is Outcome.OK
    assert is_right(drawn[3], found[3])


def test_the_x_axis_keeps_its_marker_when_that_is_covered(spinning):
    """The nearest of the others lies 118° away: the control for taking the nearest each time."""
    drawn, observations = spinning
    later = scenes(5, markers=toy.Scene(drawn[0].left_from_ring).markers[1:])
    covered = [scene.observation(frame, frame) for frame, scene in enumerate(later)]
    found = answers([*observations[:3], *covered[3:]])
    assert found[3].outcome is Outcome.OK
    assert found[3].extras["markers"] == 2
    assert error_of(drawn[3], found[3])[2] < 0.3


def test_without_the_ring_the_markers_carry_its_frame(spinning):
    """No jump to a frame of the markers' own: centre and axes stay the ring's."""
    drawn, observations = spinning
    found = answers([*observations[:3], replace(drawn[3], values=WITHOUT_RING).observation(3, 3)])
    assert found[3].outcome is Outcome.OK
    assert found[3].extras["from_ring"] == 0.0
    assert "left_x_px" not in found[3].extras
    mm, normal_deg, about_deg = error_of(drawn[3], found[3])
    assert mm < 15
    assert normal_deg < 2
    assert about_deg < 1


def test_without_markers_nothing_is_answered():
    drawn = scenes(3, markers=())
    found = answers(recorded(drawn))
    assert all(one.outcome is not Outcome.OK for one in found)
    assert "no marker" in found[-1].reason


def test_a_ring_on_a_target_with_other_axes(spinning):
    drawn, observations = spinning
    target_from_ring = RigidTransform.from_components([0.4, -0.2, 0.9], Rotation.from_euler("xyz", [20, -35, 50], degrees=True))
    found = answers(observations[:2], toy.knowledge(ring=Ring("ring", target_from_ring)))[-1]
    left_from_ring = RigidTransform.from_components(found.translation_m, found.sensor_from_target) * target_from_ring
    assert np.linalg.norm(left_from_ring.translation - drawn[1].left_from_ring.translation) < 1.5e-3


def test_sixteen_bits_are_brought_to_eight(spinning):
    drawn, observations = spinning
    deep = [
        replace(one, images={name: Image(frozen(257 * image.pixels.astype(int), np.uint16)) for name, image in one.images.items()})
        for one in observations[:2]
    ]
    sensors = {name: SensorModel(toy.LENS, 0.0, 65535.0) for name in (toy.LEFT, toy.RIGHT)}
    found = answers(deep, toy.knowledge(sensors=sensors))
    assert found[-1].outcome is Outcome.OK
    assert is_right(drawn[1], found[-1])


def test_a_missing_picture_is_skipped_and_unknown_parameters_are_refused(spinning):
    _, observations = spinning
    only_left = Observation(0, 0.0, {toy.LEFT: observations[0].images[toy.LEFT]})
    assert answers([only_left])[0].outcome is Outcome.SKIPPED
    with pytest.raises(ValidationError):
        TrackedRing(rings=2)
    with pytest.raises(ValueError, match="ring"):
        TrackedRing().start(toy.knowledge(ring=None))
