"""How far ``lidar-ekf`` answers from prediction alone: never past scans that contradict it, nor past what its covariance bears."""

from functools import cache
from types import MappingProxyType

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation
from toy_scans import ToyLidar, model_cloud

from estimators.api import Estimate, Outcome
from estimators.lidar_filter.bridge import Bridge
from estimators.lidar_filter.parameters import TrackParameters
from estimators.lidar_filter.tracked import LidarEkf
from scenes.recording import Knowledge, LidarModel, ModelCloud, Observation, Scan

BEAMS, FIELD_DEG = 144, 26.0
LIDAR = ToyLidar(BEAMS, FIELD_DEG)
CALIBRATION = LidarModel(BEAMS, BEAMS, RigidTransform.identity(), 0.05, float(np.deg2rad(FIELD_DEG) / BEAMS), 1.0, 150.0)
CERTAIN = (0.0, 0.0)
TRACK = TrackParameters()


def pose(frame: int, step_m: float, jump_m: float = 0.0) -> RigidTransform:
    """It flies across the field, turning by 1° a frame, and after frame 3 is ``jump_m`` farther along."""
    start = Rotation.from_euler("xyz", [20.0, 130.0, -50.0], degrees=True)
    turn = start * Rotation.from_rotvec([0.0, np.deg2rad(frame), 0.0])
    return RigidTransform.from_components([(frame - 3) * step_m + jump_m * (frame > 3), 0.3, 64.0], turn)


@cache
def scans(step_m: float, jump_m: float, count: int) -> tuple[Scan, ...]:
    rng = np.random.default_rng(7)
    return tuple(LIDAR.scan(pose(frame, step_m, jump_m), rng) for frame in range(count))


def answers(shown: tuple[Scan, ...], model: ModelCloud | None, **parameters: object) -> list[Estimate]:
    method = LidarEkf(**parameters)
    method.start(Knowledge({}, lidars=MappingProxyType({"lidar": CALIBRATION}), model=model))
    frames = enumerate(shown)
    return [method.step(Observation(frame, float(frame), scans=MappingProxyType({"lidar": scan}))) for frame, scan in frames]


def off_m(answer: Estimate, frame: int, step_m: float, jump_m: float, gauge: RigidTransform | None = None) -> float:
    """Metres off the truth; ``gauge``: target_from_own."""
    assert answer.sensor_from_target is not None
    assert answer.translation_m is not None
    found = RigidTransform.from_components(answer.translation_m, answer.sensor_from_target)
    found = found if gauge is None else found * gauge.inv()
    return float(np.linalg.norm(found.translation - pose(frame, step_m, jump_m).translation))


@pytest.mark.parametrize(("step_m", "jump_m", "count"), [(3.0, 0.0, 3), (0.0, 6.0, 7)])
def test_a_track_that_scans_contradict_is_begun_anew_on_the_model(step_m: float, jump_m: float, count: int) -> None:
    """Faster than any start allows; and a jump. A stale pose is wrong by the step times the frames that went by."""
    given = answers(scans(step_m, jump_m, count), model_cloud())
    off = [off_m(one, frame, step_m, jump_m) for frame, one in enumerate(given) if one.outcome is Outcome.OK]
    assert len(off) >= 2
    assert max(off) < 0.1
    assert step_m > 0 or given[-1].outcome is Outcome.OK


def test_stale_poses_of_a_frame_of_its_own_are_no_answers() -> None:
    given = answers(scans(0.0, 6.0, 7), None)
    assert [one.outcome for one in given] == [Outcome.OK] * 4 + [Outcome.NOT_CONVERGED] * 3
    assert "do not fit where the target is predicted" in given[6].reason
    fast = answers(scans(3.0, 0.0, 7), None)
    assert [one.outcome for one in fast] == [Outcome.OK] + [Outcome.NOT_CONVERGED] * 6


def test_where_scans_are_used_nothing_is_begun_anew() -> None:
    """The control: the same target at a speed that a start allows."""
    given = answers(scans(0.05, 0.0, 7), model_cloud())
    found, *followed = [one for one in given if one.outcome is Outcome.OK]
    assert "nis" not in found.extras
    assert len(followed) >= 3
    assert all("nis" in one.extras and one.extras["predicted"] == 0.0 for one in followed)


def test_a_bridge_bears_a_refusal_or_two_and_no_more() -> None:
    bridge = Bridge()
    for _ in range(5):
        bridge.follows()
    for expected in (False, False, True):
        bridge.misses(contradicts=True, is_registered=True)
        assert bridge.is_contradicted(TRACK) == expected
        assert bridge.breaks(CERTAIN, TRACK) == ""  # the filter doubts itself
    bridge.follows()
    assert not bridge.is_contradicted(TRACK)


def test_scans_that_say_nothing_contradict_nothing_and_are_bridged_as_far_as_is_known() -> None:
    bridge = Bridge(used=20)
    for _ in range(19):
        bridge.misses(contradicts=False, is_registered=False)
    assert not bridge.is_contradicted(TRACK)
    assert bridge.breaks(CERTAIN, TRACK) == ""
    assert "3.0° and 0.01 m" in bridge.breaks((np.deg2rad(3.0), 0.01), TRACK)
    assert "1.0° and 0.40 m" in bridge.breaks((np.deg2rad(1.0), 0.4), TRACK)
    bridge.misses(contradicts=False, is_registered=False)
    assert "over 20 scans rests on 20" in bridge.breaks(CERTAIN, TRACK)


def test_a_scan_that_does_not_fit_at_all_ends_the_answers_at_once() -> None:
    bridge = Bridge(used=20)
    bridge.misses(contradicts=True, is_registered=False)
    assert "1 of the last 1 scans do not fit" in bridge.breaks(CERTAIN, TRACK)
    assert not bridge.is_contradicted(TRACK)
    bridge.follows()
    assert bridge.breaks(CERTAIN, TRACK) == ""


def test_one_scan_bears_no_prediction() -> None:
    bridge = Bridge(used=1)
    bridge.misses(contradicts=True, is_registered=True)
    assert bridge.is_contradicted(TRACK)
    assert bridge.breaks(CERTAIN, TRACK)
    assert not Bridge().is_contradicted(TRACK)
