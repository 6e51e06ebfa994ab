"""Loop 2 against answers whose errors are known because the test made them."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from benchmark import judge as judging
from benchmark.errors import PredictionsError
from benchmark.judge import judge
from benchmark.knowledge import declare
from benchmark.predictions import COLUMNS, QUATERNION, TRANSLATION, Predictions, read, write
from benchmark.records import RunRecord
from benchmark.run import answer
from benchmark.summary import Summary
from scenes.dataset import Dataset
from scenes.features import RectangleFeature
from scenes.motion import Spin


def _answers(
    dataset: Dataset, error: Callable[[int], Rotation], outcomes: dict[int, str] | None = None, labelled: bool = True
) -> Predictions:
    """Predictions that turn the true attitude by ``error(frame)`` in the target frame; positions are exact."""
    truth = dataset.truth_table().set_index("frame")
    rows = []
    for frame in dataset.frames:
        outcome = (outcomes or {}).get(frame, "ok")
        row: dict[str, Any] = {"frame": frame, "sensor": "nav", "outcome": outcome, "cpu_s": 0.01, "wall_s": 0.02}
        if outcome == "ok":
            true = Rotation.from_quat(truth.loc[frame, list(QUATERNION)].to_numpy(float), scalar_first=True)
            quaternion = (true * error(frame)).as_quat(canonical=True, scalar_first=True)
            row |= dict(zip(QUATERNION, quaternion, strict=True))
            row |= {name: truth.loc[frame, name] for name in TRANSLATION}
        if outcome != "missing":
            rows.append(row)
    record = RunRecord(
        format="hardlight-predictions",
        version=1,
        method="oracle",
        dataset_identity=dataset.identity,
        knowledge=declare(dataset, "panel").record if labelled else None,
    )
    return Predictions(record, pd.DataFrame(rows, columns=list(COLUMNS)))


def _nothing(_: int) -> Rotation:
    return Rotation.identity()


def _about_y(angle_deg: float) -> Rotation:
    """A target turned by +angle about Y in the paper's passive sense, as in R_axis(θ)."""
    return Rotation.from_euler("y", -angle_deg, degrees=True)


def _summary(dataset: Dataset, answers: Predictions) -> Summary:
    (summary,) = judge(answers, dataset).summaries
    return summary


def test_the_truth_itself_has_no_error(dataset: Dataset) -> None:
    judgement = judge(_answers(dataset, _nothing), dataset)
    assert judgement.scores["geodesic_deg"].max() < 1e-6
    assert judgement.scores["speed_score"].max() == 0.0
    summary = judgement.summaries[0]
    assert (summary.answered, summary.frames, summary.wrong, summary.label_switches) == (21, 21, 0, 0)
    assert summary.swept is not None
    assert summary.swept.name == "theta2"
    assert summary.swept.response_slope == pytest.approx(1.0)


def test_true_angles_are_the_motions(dataset: Dataset) -> None:
    scores = judge(_answers(dataset, _nothing), dataset).scores
    assert_allclose(scores["theta2_deg"], -20.0 + 2.0 * scores["frame"], atol=1e-9)
    assert_allclose(scores[["theta1_deg", "theta3_deg"]], 0.0, atol=1e-9)


def test_signed_statistics_of_the_swept_angle(dataset: Dataset) -> None:
    errors = np.random.default_rng(0).normal(0.3, 0.8, size=21)
    summary = _summary(dataset, _answers(dataset, lambda frame: _about_y(errors[frame])))
    swept = summary.swept
    assert swept is not None
    assert swept.mean_deg.value == pytest.approx(errors.mean())
    assert swept.sd_deg.value == pytest.approx(errors.std(ddof=1))
    assert swept.mae_deg.value == pytest.approx(np.abs(errors).mean())
    assert swept.max_deg == pytest.approx(np.abs(errors).max())
    assert swept.mean_deg.low is not None
    assert swept.mean_deg.high is not None
    assert swept.mean_deg.low < errors.mean() < swept.mean_deg.high
    assert summary.geodesic_median_deg is not None
    assert summary.geodesic_median_deg.value == pytest.approx(np.median(np.abs(errors)))


def test_bins_show_the_odd_bias_that_the_mean_of_a_symmetric_sweep_hides(dataset: Dataset) -> None:
    summary = _summary(dataset, _answers(dataset, lambda frame: _about_y(0.1 * (-20.0 + 2.0 * frame))))
    swept = summary.swept
    assert swept is not None
    assert swept.mean_deg.value == pytest.approx(0.0, abs=1e-9)
    means = [one.mean_deg for one in swept.bins if one.mean_deg is not None]
    assert means[0] < -1.0
    assert means[-1] > 1.0
    assert sum(one.frames for one in swept.bins) == 21


def test_a_constant_answer_of_zero_is_unmasked_by_its_slope(dataset: Dataset) -> None:
    summary = _summary(dataset, _answers(dataset, lambda frame: _about_y(20.0 - 2.0 * frame)))
    swept = summary.swept
    assert swept is not None
    assert swept.mean_deg.value == pytest.approx(0.0, abs=1e-9)
    assert swept.max_deg == pytest.approx(20.0)
    assert swept.response_slope == pytest.approx(0.0, abs=1e-9)
    assert swept.near_zero_answers == 21
    assert summary.wrong == 16  # |θ| > 5°


def test_failures_are_counted_and_never_averaged(dataset: Dataset) -> None:
    outcomes = {0: "no_features", 1: "crashed", 2: "missing", 20: "diverged"}
    judgement = judge(_answers(dataset, lambda _: _about_y(1.0), outcomes), dataset)
    summary = judgement.summaries[0]
    assert summary.outcomes == {"ok": 17, "no_features": 1, "crashed": 1, "skipped": 1, "diverged": 1}
    assert summary.availability == pytest.approx(17 / 21)
    assert summary.swept is not None
    assert summary.swept.mean_deg.value == pytest.approx(1.0)
    failed = judgement.scores[judgement.scores["outcome"] != "ok"]
    assert failed[["geodesic_deg", "theta2_error_deg", "speed_rotation"]].isna().all(axis=None)
    assert len(judgement.scores) == 21


def test_a_method_that_never_answers_has_a_summary(dataset: Dataset) -> None:
    summary = _summary(dataset, _answers(dataset, _nothing, dict.fromkeys(range(21), "timed_out")))
    assert (summary.answered, summary.availability, summary.wrong_but_confident) == (0, 0.0, 0.0)
    assert summary.swept is None
    assert summary.geodesic_median_deg is None


def test_a_labelled_method_is_not_forgiven_a_half_turn_and_an_unlabelled_one_is(dataset: Dataset) -> None:
    half_turn = Rotation.from_euler("x", 180, degrees=True)
    labelled = _summary(dataset, _answers(dataset, lambda _: half_turn))
    assert (labelled.symmetry, labelled.wrong) == ("none", 21)
    free = _summary(dataset, _answers(dataset, lambda _: half_turn, labelled=False))
    assert (free.symmetry, free.wrong) == ("d2", 0)


def test_one_symmetry_element_serves_the_whole_track(dataset: Dataset) -> None:
    half_turn = Rotation.from_euler("x", 180, degrees=True)
    hopping = _answers(dataset, lambda frame: half_turn if 8 <= frame < 12 else Rotation.identity(), labelled=False)
    summary = _summary(dataset, hopping)
    assert summary.wrong == 4
    assert summary.label_switches == 2


def test_a_slipped_label_of_a_rectangle_is_counted_also_where_it_costs_the_error_anyway(dataset: Dataset) -> None:
    quarter = Rotation.from_euler("x", 90, degrees=True)
    summary = _summary(dataset, _answers(dataset, lambda frame: quarter if frame >= 15 else Rotation.identity()))
    assert summary.label_switches == 1
    assert summary.wrong == 6


def test_position_errors_and_speed_score(dataset: Dataset) -> None:
    answers = _answers(dataset, lambda _: _about_y(1.0))
    answers.table["tz_m"] += 0.12  # 1 % of 12 m
    scores = judge(answers, dataset).scores
    assert_allclose(scores["position_error_m"], 0.12, rtol=1e-9)
    assert_allclose(scores["speed_score"], np.radians(1.0) + 0.01, rtol=1e-6)
    answers.table[list(TRANSLATION)] = np.nan
    judgement = judge(answers, dataset)
    assert judgement.scores["speed_score"].isna().all()
    assert judgement.summaries[0].speed_score is None
    assert judgement.summaries[0].speed_rotation is not None
    assert judgement.summaries[0].speed_rotation.value == pytest.approx(np.radians(1.0), rel=1e-6)


def test_another_motion_has_no_swept_angle(make_dataset: Callable[..., Dataset], tmp_path: Path) -> None:
    motion = Spin(type="spin", position_m=(0.0, 0.0, 12.0), rotation_vector_deg=(10.0, 20.0, 30.0))
    dataset = make_dataset(tmp_path / "spin", motion=motion)
    assert _summary(dataset, _answers(dataset, _nothing)).swept is None


def test_judging_from_files_equals_judging_in_memory(dataset: Dataset, toy: Any, tmp_path: Path) -> None:
    declared = declare(dataset, "panel")
    record = _answers(dataset, _nothing).record
    answers = answer(toy(), dataset, declared.knowledge, record)
    write(tmp_path / "a", answers)
    direct, again = judge(answers, dataset), judge(read(tmp_path / "a"), dataset)
    pd.testing.assert_frame_equal(direct.scores, again.scores)
    assert direct.summaries == again.summaries
    judging.write(tmp_path / "s", direct)
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "s" / "scores.parquet"), direct.scores)


def test_answers_of_another_data_set_are_refused_with_both_identities(
    dataset: Dataset, make_dataset: Callable[..., Dataset], tmp_path: Path
) -> None:
    other = make_dataset(tmp_path / "other", seed=1)
    assert other.manifest.digest == dataset.manifest.digest
    with pytest.raises(PredictionsError, match=f"made on data set {dataset.identity}, but .* is data set {other.identity}"):
        judge(_answers(dataset, _nothing), other)


@pytest.mark.parametrize(
    ("column", "value", "sentence"),
    [
        ("frame", 99, "answer frame 99, which .* does not have"),
        ("sensor", "nva", r"no sensor is called 'nva'; did you mean 'nav'\?"),
    ],
)
def test_strange_frames_and_sensors_are_refused(dataset: Dataset, column: str, value: object, sentence: str) -> None:
    answers = _answers(dataset, _nothing)
    answers.table.loc[20, column] = value
    with pytest.raises(PredictionsError, match=sentence):
        judge(answers, dataset)


def test_an_empty_table_is_refused(dataset: Dataset) -> None:
    answers = _answers(dataset, _nothing)
    with pytest.raises(PredictionsError, match="have no line"):
        judge(Predictions(answers.record, answers.table.iloc[:0]), dataset)


def test_a_feature_that_is_turned_on_the_target_still_counts_its_own_labels(
    make_dataset: Callable[..., Dataset], tmp_path: Path
) -> None:
    side = RectangleFeature(
        name="panel", centre_m=(0, 0, 0), length_m=3.0, width_m=1.5, length_axis=(-1, 1, 0), width_axis=(0, 0, 1)
    )
    dataset = make_dataset(tmp_path / "side", features=(side,))
    slip = side.target_from_feature * Rotation.from_euler("x", 90, degrees=True) * side.target_from_feature.inv()
    summary = _summary(dataset, _answers(dataset, lambda frame: slip if frame > 10 else Rotation.identity()))
    assert summary.label_switches == 1


def test_frames_within_the_settling_time_have_rows_but_no_say(dataset: Dataset) -> None:
    start_s = dataset.truth(0).time_s
    last_s = dataset.truth(dataset.frames[-1]).time_s
    half_s = (last_s - start_s) / 2
    early = [frame for frame in dataset.frames if dataset.truth(frame).time_s < start_s + half_s]
    answers = _answers(dataset, lambda frame: _about_y(4.0 if frame in early else 1.0))
    judgement = judge(answers, dataset, settle_s=half_s)
    summary = judgement.summaries[0]
    assert len(judgement.scores) == 21
    assert (summary.frames, summary.settle_s) == (21 - len(early), half_s)
    assert summary.swept is not None
    assert summary.swept.max_deg == pytest.approx(1.0)
    with pytest.raises(PredictionsError, match="no frame after them"):
        judge(answers, dataset, settle_s=last_s - start_s + 1)
