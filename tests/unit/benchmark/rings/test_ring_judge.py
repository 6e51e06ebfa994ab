"""Stereo answers whose errors are known because the test made them, on a ring that is not at its target's origin."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.judge import Judgement, judge
from benchmark.knowledge import declare
from benchmark.predictions import COLUMNS, Predictions
from benchmark.records import RunRecord
from benchmark.ring_ellipses import true_ellipse
from benchmark.ring_summary import RingSummary
from scenes.dataset import Dataset
from scenes.features import CircleFeature
from scenes.motion import Spin
from scenes.pose_columns import pose_columns

SENSORS = {"left": "stereo-left", "right": "stereo-right"}
MARKER_AZIMUTHS_DEG = (0.0, 75.0, -140.0)
Ellipses = Callable[..., Callable[[int], dict[str, float]]]
STILL = {"position_m": (0.05, 0.0, 4.0), "rotation_vector_deg": (0, 82, 0)}


def _turn(angle_deg: float, axis: str = "z") -> Rotation:
    """A turn in the ring's own axes: z is its normal."""
    return Rotation.from_euler(axis, angle_deg, degrees=True)


def _ring(dataset: Dataset) -> CircleFeature:
    (ring,) = (one for one in dataset.features if isinstance(one, CircleFeature))
    return ring


def _answers(
    dataset: Dataset,
    turn: Callable[[int], Rotation] = lambda _: Rotation.identity(),
    shift_m: Callable[[int], Any] = lambda _: (0.0, 0.0, 0.0),
    extras: Callable[[int], dict[str, float]] | None = None,
    missing: tuple[int, ...] = (),
) -> Predictions:
    """The true poses of the left camera, the ring turned by ``turn`` in its own axes and moved by ``shift_m`` in the camera's."""
    target_from_ring, rows, named = _ring(dataset).target_from_feature, [], []
    for frame in dataset.frames:
        true = dataset.truth(frame).sensor_from_target["stereo-left"] * target_from_ring
        moved = RigidTransform.from_components(true.translation + shift_m(frame), true.rotation * turn(frame))
        row = {"frame": frame, "sensor": "stereo-left", "outcome": "no_features", "cpu_s": 0.1, "wall_s": 0.2}
        if frame not in missing:
            row |= {"outcome": "ok"} | pose_columns(moved * target_from_ring.inv())
        rows.append(row)
        named.append({"frame": frame, "sensor": "stereo-left", "reason": ""} | (extras(frame) if extras else {}))
    record = RunRecord(
        format="hardlight-predictions", version=1, method="oracle", dataset_identity=dataset.identity,
        knowledge=declare(dataset, "ring").record,
    )  # fmt: skip
    return Predictions(record, pd.DataFrame(rows, columns=list(COLUMNS)), pd.DataFrame(named))


def _judged(dataset: Dataset, **more: Any) -> tuple[Judgement, RingSummary]:
    judgement = judge(_answers(dataset, **more), dataset)
    ring = judgement.summaries[0].ring
    assert ring is not None
    return judgement, ring


@pytest.fixture(scope="module")
def long(make_stereo: Callable[..., Dataset], tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """120 frames of a ring at rest, without pictures."""
    motion = Spin(type="spin", **STILL)
    return make_stereo(tmp_path_factory.mktemp("long") / "still", frames=range(120), motion=motion, draws=False, width_px=16)


def test_the_truth_itself_has_no_error_anywhere(stereo: Dataset, exact_ellipses: Ellipses) -> None:
    judgement, ring = _judged(stereo, extras=exact_ellipses(stereo))
    summary, scores = judgement.summaries[0], judgement.scores
    assert (summary.answered, summary.frames, summary.wrong, summary.label_switches, summary.symmetry) == (12, 12, 0, 0, "markers")
    zero = ["geodesic_deg", "normal_error_deg", "about_normal_error_deg", "radius_error_m", "position_error_m"]
    zero += [f"ring_{axis}_error_m" for axis in "xyz"] + [f"step_error_{axis}_m" for axis in "xyz"]
    assert scores[zero].abs().max(axis=None) < 1e-6
    assert (ring.ring_judged, ring.ring_right, ring.ring_right_fraction) == (12, 12, 1.0)
    assert ring.wrong_reasons == {"ring": 0, "attitude": 0, "position": 0}
    assert ring.frame_to_frame is not None
    assert ring.frame_to_frame.pairs == 11
    assert_allclose(ring.frame_to_frame.difference.position_cm, 0.0, atol=1e-9)
    assert_allclose(ring.frame_to_frame.difference.rotation_deg, 0.0, atol=1e-6)


def test_a_constant_offset_is_exactly_that_bias_and_invisible_from_frame_to_frame(stereo: Dataset) -> None:
    """What triangulated ellipse centres do: 160 mm off in every frame, and the paper's statistic does not see it."""
    _, ring = _judged(stereo, shift_m=lambda _: (-0.05, -0.003, 0.16))
    assert ring.bias_mm is not None
    assert ring.sd_mm is not None
    assert_allclose([one.value for one in ring.bias_mm], [-50, -3, 160], atol=1e-9)
    assert_allclose([one.value for one in ring.sd_mm], 0.0, atol=1e-9)
    assert ring.frame_to_frame is not None
    assert_allclose(ring.frame_to_frame.difference.position_cm, 0.0, atol=1e-9)
    assert ring.wrong_reasons["position"] == 12  # 0.168 m is more than 2 % of 4 m


@pytest.mark.parametrize("azimuth_deg", MARKER_AZIMUTHS_DEG)
def test_another_marker_on_the_x_axis_costs_nothing_if_it_is_kept(stereo: Dataset, azimuth_deg: float) -> None:
    judgement, ring = _judged(stereo, turn=lambda _: _turn(azimuth_deg))
    summary = judgement.summaries[0]
    assert (summary.wrong, summary.label_switches) == (0, 0)
    assert judgement.scores[["geodesic_deg", "about_normal_error_deg", "position_error_m"]].abs().max(axis=None) < 1e-6
    assert ring.about_normal_max_deg == pytest.approx(0.0, abs=1e-6)


def test_hopping_between_markers_is_counted_and_costs_the_frames_of_the_rarer_one(stereo: Dataset) -> None:
    judgement, ring = _judged(stereo, turn=lambda frame: _turn(75.0 if frame in (3, 4, 8) else 0.0))
    summary = judgement.summaries[0]
    assert (summary.wrong, summary.label_switches) == (3, 4)
    assert ring.about_normal_max_deg == pytest.approx(75.0)
    assert ring.normal_max_deg == pytest.approx(0.0, abs=1e-6)
    assert ring.wrong_reasons == {"ring": 0, "attitude": 3, "position": 0}


def test_a_turn_that_is_no_markers_azimuth_is_an_error(stereo: Dataset) -> None:
    judgement, _ = _judged(stereo, turn=lambda _: _turn(180.0))
    assert judgement.summaries[0].wrong == 12
    assert_allclose(judgement.scores["geodesic_deg"], 40.0, atol=1e-6)  # to the nearest marker, at −140°


def test_the_error_is_split_into_the_normal_and_the_turn_about_it(stereo: Dataset) -> None:
    judgement, ring = _judged(stereo, turn=lambda _: _turn(1.5, "x"))
    assert_allclose(judgement.scores["normal_error_deg"], 1.5, atol=1e-6)
    assert_allclose(judgement.scores["about_normal_error_deg"], 0.0, atol=1e-6)
    signed, _ = _judged(stereo, turn=lambda frame: _turn(-2.0 if frame % 2 else 2.0))
    assert_allclose(signed.scores["about_normal_error_deg"], np.where(np.arange(12) % 2, -2.0, 2.0), atol=1e-6)
    assert_allclose(signed.scores["normal_error_deg"], 0.0, atol=1e-6)
    assert ring.normal_median_deg is not None
    assert ring.normal_median_deg.value == pytest.approx(1.5)


def test_the_true_ellipse_passes_through_the_projected_points_of_the_circle(stereo: Dataset) -> None:
    ring = _ring(stereo)
    for sensor in SENSORS.values():
        lens, pose = stereo.sensors[sensor].intrinsics, stereo.truth(5).sensor_from_target[sensor]
        ellipse = true_ellipse(ring, pose, lens)
        assert ellipse is not None
        uv = lens.project(pose.apply(ring.points_target(90))) - [ellipse.x_px, ellipse.y_px]
        c, s = np.cos(ellipse.theta_rad), np.sin(ellipse.theta_rad)
        along, across = uv @ [c, s], uv @ [-s, c]
        assert_allclose((along / ellipse.a_px) ** 2 + (across / ellipse.b_px) ** 2, 1.0, atol=1e-10)


def test_a_circle_seen_edge_on_or_from_within_has_no_ellipse(stereo: Dataset) -> None:
    ring, lens = _ring(stereo), stereo.sensors["stereo-left"].intrinsics
    edge_on = RigidTransform.from_components([0.0, 0.0, 4.0], Rotation.identity()) * ring.target_from_feature.inv()
    turned = RigidTransform.from_components([0.0, 0.0, 4.0], Rotation.from_euler("x", 90, degrees=True))
    assert true_ellipse(ring, edge_on, lens) is not None
    assert true_ellipse(ring, turned * ring.target_from_feature.inv(), lens) is None
    near = RigidTransform.from_components([0.0, 0.0, 0.3], Rotation.from_euler("x", 60, degrees=True))
    assert true_ellipse(ring, near * ring.target_from_feature.inv(), lens) is None


def test_the_inner_edge_is_the_wrong_ring_although_its_pose_is_right(
    make_stereo: Callable[..., Dataset], tmp_path: Path, exact_ellipses: Ellipses
) -> None:
    """Concentric and coplanar: 4 cm of radius tell it, the pose does not. The pictures are large, so that 4 cm are pixels."""
    dataset = make_stereo(tmp_path / "large", frames=range(4), width_px=2048, draws=False)
    judgement, ring = _judged(dataset, extras=exact_ellipses(dataset, radius_m=0.56))
    summary = judgement.summaries[0]
    assert (summary.wrong, ring.ring_judged, ring.ring_right) == (4, 4, 0)
    assert judgement.scores["geodesic_deg"].max() < 1e-6
    assert ring.radius_bias_mm is not None
    assert ring.radius_bias_mm.value == pytest.approx(-40.0)
    right, _ = _judged(dataset, extras=exact_ellipses(dataset, radius_m=0.5995))
    assert right.summaries[0].wrong == 0


def test_without_the_ellipses_of_both_views_nothing_is_said_of_the_ring(stereo: Dataset, exact_ellipses: Ellipses) -> None:
    exact = exact_ellipses(stereo)

    def one_eyed(frame: int) -> dict[str, float]:
        return {name: value for name, value in exact(frame).items() if not name.startswith("right")}

    judgement, ring = _judged(stereo, extras=one_eyed)
    assert judgement.scores["ring_right"].isna().all()
    assert (ring.ring_judged, ring.ring_right, judgement.summaries[0].wrong) == (0, 0, 0)
    _, without = _judged(stereo)
    assert (without.ring_judged, without.radius_bias_mm) == (0, None)


def test_a_uniform_spin_is_no_noise(make_stereo: Callable[..., Dataset], tmp_path: Path) -> None:
    motion = Spin(type="spin", velocity_m_s=(0.01, 0.0, -0.02), omega_target_deg_s=(2.28, 0.0, 0.0), **STILL)
    features = (_ring_at_origin(), )
    dataset = make_stereo(tmp_path / "spin", motion=motion, features=features, draws=False)
    _, ring = _judged(dataset)
    assert ring.frame_to_frame is not None
    assert ring.frame_to_frame.is_uniform
    assert_allclose(ring.frame_to_frame.answer.position_cm, 0.0, atol=1e-9)
    assert_allclose(ring.frame_to_frame.answer.rotation_deg, 0.0, atol=1e-6)


def _ring_at_origin() -> CircleFeature:
    return CircleFeature(type="circle", name="ring", normal=(1, 0, 0), x_axis=(0, 1, 0), radius_m=0.6)


def test_motion_that_is_not_uniform_counts_in_the_papers_statistic_alone(stereo: Dataset) -> None:
    """The ring's centre lies off the axis of rotation, so it moves on a circle: exact answers vary from frame to frame."""
    _, ring = _judged(stereo)
    both = ring.frame_to_frame
    assert both is not None
    assert not both.is_uniform
    assert max(both.answer.position_cm) > 0.01
    assert_allclose(both.answer.position_cm, both.target.position_cm, rtol=1e-6)
    assert_allclose(both.noise.position_cm, 0.0, atol=1e-9)


def test_white_noise_is_root_two_from_frame_to_frame(long: Dataset) -> None:
    """var(e(t+1) − e(t)) = 2 σ². Over 119 overlapping pairs the standard error of that sd is √(3/119)/2 = 8 %."""
    rng = np.random.default_rng(7)
    noise_m, noise_deg = rng.normal(scale=(1e-3, 2e-3, 5e-3), size=(120, 3)), rng.normal(scale=0.1, size=(120, 3))

    def turn(frame: int) -> Rotation:
        return Rotation.from_rotvec(noise_deg[frame], degrees=True)

    _, ring = _judged(long, turn=turn, shift_m=lambda frame: noise_m[frame])
    assert ring.frame_to_frame is not None
    assert ring.sd_mm is not None
    assert_allclose(ring.frame_to_frame.answer.position_cm, np.sqrt(2) * np.array([0.1, 0.2, 0.5]), rtol=0.2)
    assert_allclose(ring.frame_to_frame.answer.rotation_deg, np.sqrt(2) * 0.1, rtol=0.2)
    assert_allclose([one.value for one in ring.sd_mm], 1e3 * noise_m.std(axis=0, ddof=1), rtol=1e-6)


def test_a_drift_is_its_slope_and_hides_from_the_frame_to_frame_statistic(long: Dataset) -> None:
    _, ring = _judged(long, turn=lambda frame: _turn(0.01 * frame), shift_m=lambda frame: (0.0, -2e-5 * frame, 1e-4 * frame))
    assert ring.drift is not None
    assert_allclose(ring.drift.position_mm, [0.0, -2.0, 10.0], atol=1e-6)
    assert ring.drift.about_normal_deg == pytest.approx(1.0)
    assert ring.drift.normal_deg == pytest.approx(0.0, abs=1e-6)
    assert ring.frame_to_frame is not None
    assert_allclose(ring.frame_to_frame.difference.position_cm, 0.0, atol=1e-9)


def test_a_gap_breaks_the_pairs_and_failures_are_not_averaged(stereo: Dataset, exact_ellipses: Ellipses) -> None:
    judgement, ring = _judged(stereo, shift_m=lambda _: (0.01, 0.0, 0.0), extras=exact_ellipses(stereo), missing=(0, 5))
    summary = judgement.summaries[0]
    assert (summary.answered, ring.ring_judged, ring.ring_right_fraction) == (10, 10, pytest.approx(10 / 12))
    assert ring.frame_to_frame is not None
    assert ring.frame_to_frame.pairs == 8  # 1-2-3-4 and 6-…-11
    assert ring.bias_mm is not None
    assert ring.bias_mm[0].value == pytest.approx(10.0)
    failed = judgement.scores[judgement.scores["outcome"] != "ok"]
    assert failed[["ring_x_error_m", "ring_right", "radius_error_m", "wrong", "step_x_m"]].isna().all(axis=None)


def test_a_method_that_never_answers_or_gives_no_position_has_a_summary(stereo: Dataset) -> None:
    _, silent = _judged(stereo, missing=tuple(range(12)))
    assert (silent.bias_mm, silent.normal_median_deg, silent.frame_to_frame, silent.drift) == (None, None, None, None)
    answers = _answers(stereo)
    answers.table[["tx_m", "ty_m", "tz_m"]] = np.nan
    ring = judge(answers, stereo).summaries[0].ring
    assert ring is not None
    assert (ring.bias_mm, ring.frame_to_frame) == (None, None)
    assert ring.normal_max_deg == pytest.approx(0.0, abs=1e-6)


def test_cpu_time_is_kept_by_stage_and_by_acquisition_and_tracking(stereo: Dataset) -> None:
    def extras(frame: int) -> dict[str, float]:
        return {"acquired": 1.0, "cpu_detect_s": 0.4} if frame < 2 else {"acquired": 0.0, "cpu_track_s": 0.05}

    answers = _answers(stereo, extras=extras)
    answers.table["cpu_s"] = [0.5] * 2 + [0.08] * 10
    ring = judge(answers, stereo).summaries[0].ring
    assert ring is not None
    assert ring.stage_cpu_s == pytest.approx({"detect": 0.4, "track": 0.05})
    assert (ring.acquisition_frames, ring.acquisition_cpu_s) == (2, pytest.approx(0.5))
    assert (ring.tracking_frames, ring.tracking_cpu_s) == (10, pytest.approx(0.08))


def test_without_a_word_on_it_acquisition_is_where_time_was_spent_on_acquiring(stereo: Dataset) -> None:
    answers = _answers(stereo, extras=lambda frame: {"cpu_acquire_s": 0.3} if frame < 2 else {"cpu_track_s": 0.05}, missing=(0, 11))
    ring = judge(answers, stereo).summaries[0].ring
    assert ring is not None
    assert (ring.acquisition_frames, ring.tracking_frames) == (2, 9)  # a failed acquisition costs its time too
    without = judge(_answers(stereo, extras=lambda _: {"cpu_detect_s": 0.3}), stereo).summaries[0].ring
    assert without is not None
    assert (without.acquisition_cpu_s, without.tracking_cpu_s) == (None, None)


def test_frames_in_which_a_filter_settles_are_not_summarised(stereo: Dataset) -> None:
    answers = _answers(stereo, shift_m=lambda frame: (0.5, 0.0, 0.0) if frame < 4 else (0.01, 0.0, 0.0))
    judgement = judge(answers, stereo, settle_s=4.0)
    summary, ring = judgement.summaries[0], judgement.summaries[0].ring
    assert ring is not None
    assert ring.bias_mm is not None
    assert (len(judgement.scores), summary.frames, summary.wrong) == (12, 8, 0)
    assert ring.bias_mm[0].value == pytest.approx(10.0)


def test_an_outside_method_that_declares_no_pair_is_judged_with_the_only_rig(stereo: Dataset, exact_ellipses: Ellipses) -> None:
    answers = _answers(stereo, extras=exact_ellipses(stereo))
    assert answers.record.knowledge is not None
    knowledge = answers.record.knowledge.model_copy(update={"pair": None})
    record = answers.record.model_copy(update={"knowledge": knowledge})
    ring = judge(Predictions(record, answers.table, answers.extras), stereo).summaries[0].ring
    assert ring is not None
    assert ring.ring_right == 12
