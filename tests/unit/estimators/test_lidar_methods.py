"""Both LIDAR methods on scans that owe nothing to the renderer: what they answer, say of themselves, and survive."""

from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform
from toy_scans import ToyLidar, ToyTumble, model_cloud

from estimators.api import Estimate, Estimator, Outcome
from estimators.lidar_filter.paper import PaperLidarEkf
from estimators.lidar_filter.tracked import LidarEkf
from scenes.recording import Knowledge, LidarModel, ModelCloud, Observation, Scan

LIDAR = ToyLidar(beams=96, field_deg=11.0)
SECONDS = 60


@cache
def poses() -> list[RigidTransform]:
    """lidar_from_target, one a second."""
    return ToyTumble(seconds=SECONDS).poses()


@cache
def scans() -> tuple[Scan, ...]:
    """What the LIDAR sees of them."""
    rng = np.random.default_rng(1)
    return tuple(LIDAR.scan(pose, rng) for pose in poses())


def told(model: ModelCloud | None = None) -> Knowledge:
    pitch_rad = np.deg2rad(LIDAR.field_deg) / LIDAR.beams
    calibration = LidarModel(LIDAR.beams, LIDAR.beams, RigidTransform.identity(), LIDAR.sigma_m, float(pitch_rad), 1.0, 150.0)
    return Knowledge({}, lidars=MappingProxyType({"lidar": calibration}), model=model)


def answers(method: Estimator, knowledge: Knowledge, shown: tuple[Scan, ...]) -> list[Estimate]:
    method.start(knowledge)
    frames = enumerate(shown)
    return [method.step(Observation(frame, float(frame), scans=MappingProxyType({"lidar": scan}))) for frame, scan in frames]


def pose_of(answer: Estimate) -> RigidTransform:
    assert answer.sensor_from_target is not None, answer.reason
    assert answer.translation_m is not None
    return RigidTransform.from_components(answer.translation_m, answer.sensor_from_target)


def off(answer: Estimate, frame: int, gauge: RigidTransform | None = None) -> tuple[float, float]:
    """Degrees and metres off the truth; ``gauge``: target_from_own."""
    found = pose_of(answer) if gauge is None else pose_of(answer) * gauge.inv()
    wrong = poses()[frame].inv() * found
    return float(np.rad2deg(wrong.rotation.magnitude())), float(np.linalg.norm(found.translation - poses()[frame].translation))


def nothing() -> Scan:
    blank = np.full((LIDAR.beams, LIDAR.beams), np.nan, np.float32)
    return Scan(np.repeat(blank[..., None], 3, axis=2), blank, np.zeros_like(blank))


def test_a_model_is_found_from_any_attitude_and_followed() -> None:
    given = answers(LidarEkf(), told(model_cloud()), scans()[:20])
    errors = np.array([off(answer, frame) for frame, answer in enumerate(given)])
    assert errors[:, 0].max() < 2.0
    assert np.median(errors[:, 1]) < 0.05


def test_without_a_model_the_answer_stays_fixed_to_the_target() -> None:
    """In a frame of its own, laid over the true one in the first answer. A frame that does not turn with it is far off."""
    given = answers(LidarEkf(), told(), scans())
    gauge = poses()[0].inv() * pose_of(given[0])
    errors = np.array([off(answer, frame, gauge) for frame, answer in enumerate(given)])
    assert errors[:, 0].max() < 3.0
    assert np.percentile(errors[:, 0], 95) < 2.5  # 2.3° of 96 beams over 11°; 0.3° on song2017's target with 128 over 10°
    assert np.percentile(errors[:, 1], 95) < 0.04
    assert errors[:, 1].max() < 0.2
    assert off(given[0], SECONDS - 1, gauge)[0] > 30.0


def test_scans_without_a_return_are_predicted_and_said_to_be() -> None:
    shown = (*scans()[:25], *[nothing()] * 6, *scans()[31:36])
    given = answers(LidarEkf(), told(model_cloud()), shown)
    assert [answer.extras["predicted"] for answer in given[25:]] == [1.0] * 6 + [0.0] * 5
    assert off(given[30], 30)[0] < 5.0
    assert off(given[35], 35)[0] < 2.0


def test_too_many_empty_scans_end_in_no_answer_until_the_target_is_seen_again() -> None:
    method = LidarEkf(track={"most_predictions": 3})
    given = answers(method, told(model_cloud()), (*scans()[:8], *[nothing()] * 5, scans()[13]))
    assert [answer.outcome for answer in given[8:13]] == [Outcome.OK] * 3 + [Outcome.DIVERGED, Outcome.NO_FEATURES]
    assert "4 scans" in given[11].reason
    assert off(given[13], 13)[0] < 3.0


def test_a_frame_of_its_own_that_was_lost_is_not_replaced_by_another() -> None:
    method = LidarEkf(track={"most_predictions": 2})
    given = answers(method, told(), (*scans()[:3], *[nothing()] * 4, *scans()[7:9]))
    assert [answer.outcome for answer in given[3:]] == [Outcome.OK] * 2 + [Outcome.DIVERGED] * 4


@pytest.mark.parametrize("method", [LidarEkf, PaperLidarEkf])
def test_a_first_scan_without_returns_has_no_features(method: Any) -> None:
    (answer,) = answers(method(), told(model_cloud()), (nothing(),))
    assert answer.outcome is Outcome.NO_FEATURES
    assert answer.reason


@pytest.mark.parametrize("method", [LidarEkf, PaperLidarEkf])
def test_the_same_scans_give_the_same_answers_and_stay_as_they_are(method: Any) -> None:
    shown = tuple(Scan(*(np.array(part) for part in (one.points_lidar, one.intensity, one.time_s))) for one in scans()[:4])
    for part in (part for one in shown for part in (one.points_lidar, one.intensity, one.time_s)):
        part.flags.writeable = False
    first, again = (answers(method(), told(model_cloud()), shown) for _ in range(2))
    assert [pose_of(one).as_matrix().tolist() for one in first] == [pose_of(one).as_matrix().tolist() for one in again]


def test_the_papers_filter_mended_follows_and_as_printed_breaks() -> None:
    mended = answers(PaperLidarEkf(), told(model_cloud()), scans()[:50])
    assert {answer.outcome for answer in mended} == {Outcome.OK}
    assert np.median([off(answer, frame)[0] for frame, answer in enumerate(mended)]) < 2.0
    printed = answers(PaperLidarEkf(filter={"printed": True}), told(model_cloud()), scans())
    assert printed[-1].outcome is Outcome.DIVERGED
    assert printed[-1].reason


def test_a_guess_that_no_body_can_have_is_reported() -> None:
    """150 % of the ratios 2 and 3 of Song et al. 2017: 3 and 4.5, against I_z ≤ I_x + I_y."""
    given = answers(PaperLidarEkf(filter={"guess": {"p": [3.0, 4.5]}}), told(model_cloud()), scans()[:3])
    assert all(answer.extras["infeasible_guess"] == 1.0 for answer in given)
    feasible = answers(PaperLidarEkf(filter={"guess": {"p": [2.0, 3.0]}}), told(model_cloud()), scans()[:1])
    assert "infeasible_guess" not in feasible[0].extras


def test_a_model_is_needed_where_it_is_asked_for() -> None:
    with pytest.raises(ValueError, match="model"):
        LidarEkf(reference="model").start(told())
    with pytest.raises(ValueError, match="LIDAR"):
        LidarEkf().start(Knowledge({}))
