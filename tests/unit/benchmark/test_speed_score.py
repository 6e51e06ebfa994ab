"""What a submission scores is what it should: the truth is perfect, a known error is worth what one computes by hand.

SPEED's score is that of the SPEED+ competition (Park et al. 2022): rotation error in radians plus position error over distance,
each zero strictly below what the competition's own truth is uncertain by, 0.169° and 2.173 mm per metre.
"""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from benchmark import metrics, submission
from benchmark.judge import Judgement, judge
from benchmark.predictions import COLUMNS, read
from scenes.dataset import Dataset


@pytest.mark.parametrize(
    ("error_deg", "score"), [(0.0, 0.0), (0.168, 0.0), (0.1689999, 0.0), (0.169, 0.002950), (0.170, 0.002967), (180.0, np.pi)]
)
def test_a_rotation_below_the_threshold_is_perfect_and_above_it_counts_in_full(error_deg: float, score: float) -> None:
    assert metrics.speed_rotation(np.radians([error_deg]))[0] == pytest.approx(score, abs=5e-7)


@pytest.mark.parametrize(("off_m", "score"), [(0.0, 0.0), (0.02172, 0.0), (0.02174, 2.174e-3), (0.1, 0.01), (20.0, 2.0)])
def test_a_position_counts_by_its_distance(off_m: float, score: float) -> None:
    """At 10 m, in a direction of its own."""
    truth_m = np.array([[6.0, 0.0, 8.0]])
    off = off_m * np.array([[0.48, 0.6, 0.64]])
    assert metrics.speed_position(truth_m, truth_m + off)[0] == pytest.approx(score, abs=1e-12)


def _submitted(
    dataset: Dataset, folder: Path, turn: Rotation | None = None, shift_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> Judgement:
    """The truth as a folder of answers that another program wrote, turned in the target's axes and shifted in the sensor's."""
    truth = dataset.truth_table()
    rotation = Rotation.from_quat(truth[["qw", "qx", "qy", "qz"]].to_numpy(), scalar_first=True)
    answered = rotation * (Rotation.identity() if turn is None else turn)
    table = truth[["frame", "sensor"]].assign(outcome="ok", cpu_s="", wall_s="")
    table[["qw", "qx", "qy", "qz"]] = answered.as_quat(scalar_first=True)
    table[["tx_m", "ty_m", "tz_m"]] = truth[["tx_m", "ty_m", "tz_m"]].to_numpy() + shift_m
    folder.mkdir()
    table[list(COLUMNS)].to_csv(folder / "predictions.csv", index=False)
    record = {"format": "hardlight-predictions", "version": 1, "method": "oracle", "dataset_identity": dataset.identity}
    (folder / "run.json").write_text(json.dumps(record))
    assert submission.examine(folder, dataset).faults == ()
    return judge(read(folder), dataset)


def test_the_truth_is_perfect_in_every_metric(dataset: Dataset, tmp_path: Path) -> None:
    judgement = _submitted(dataset, tmp_path / "a")
    (summary,) = judgement.summaries
    assert (summary.availability, summary.wrong, summary.wrong_but_confident, summary.label_switches) == (1.0, 0, 0.0, 0)
    assert summary.outcomes == {"ok": len(dataset.frames)}
    for figure in (summary.speed_rotation, summary.speed_score):
        assert figure is not None
        assert (figure.value, figure.low, figure.high) == (0.0, 0.0, 0.0)
    for figure in (summary.geodesic_median_deg, summary.geodesic_p95_deg):
        assert figure is not None
        assert figure.value < 1e-6
    swept = summary.swept
    assert swept is not None
    assert swept.max_deg < 1e-6
    assert swept.response_slope == pytest.approx(1.0, abs=1e-9)
    errors = [name for name in judgement.scores if "error" in str(name) or "geodesic" in str(name) or "speed" in str(name)]
    assert len(errors) >= 6
    assert judgement.scores[errors].abs().max().max() < 1e-6


def test_a_known_turn_and_shift_score_what_one_computes_by_hand(dataset: Dataset, tmp_path: Path) -> None:
    """2° about (1, 2, 2)/3 in the target's axes, and (0.3, 0.4, 0) m at 12 m: 0.5 m off, 0.5/12 of the distance."""
    turn = Rotation.from_rotvec(2.0 * np.array([1.0, 2.0, 2.0]) / 3.0, degrees=True)
    judgement = _submitted(dataset, tmp_path / "a", turn, (0.3, 0.4, 0.0))
    scores, (summary,) = judgement.scores, judgement.summaries
    assert_allclose(dataset.truth_table()[["tx_m", "ty_m", "tz_m"]].to_numpy(), [[0.0, 0.0, 12.0]] * len(scores), atol=1e-9)
    assert_allclose(scores["geodesic_deg"], 2.0, rtol=1e-9)
    assert_allclose(scores["position_error_m"], 0.5, rtol=1e-9)
    assert_allclose(scores["speed_rotation"], 2.0 * np.pi / 180.0, rtol=1e-9)
    assert_allclose(scores["speed_score"], 2.0 * np.pi / 180.0 + 0.5 / 12.0, rtol=1e-9)
    for figure, value in (
        (summary.geodesic_median_deg, 2.0),
        (summary.geodesic_p95_deg, 2.0),
        (summary.speed_rotation, 0.0349066),
        (summary.speed_score, 0.0349066 + 0.0416667),
    ):
        assert figure is not None
        assert figure.value == pytest.approx(value, rel=1e-5)
    assert (summary.wrong, summary.availability) == (0, 1.0)


@pytest.mark.parametrize(("turn_deg", "shift_m", "score"), [(0.168, 0.026, 0.0), (0.170, 0.026, 0.002967), (0.168, 0.0264, 0.0022)])
def test_the_thresholds_hold_for_a_submission(
    dataset: Dataset, tmp_path: Path, turn_deg: float, shift_m: float, score: float
) -> None:
    """2.173 mm per metre are 26.076 mm at 12 m."""
    judgement = _submitted(dataset, tmp_path / "a", Rotation.from_rotvec([0.0, turn_deg, 0.0], degrees=True), (shift_m, 0.0, 0.0))
    assert isinstance(judgement.scores, pd.DataFrame)
    assert_allclose(judgement.scores["speed_score"], score, atol=5e-7)


def test_an_error_beyond_five_degrees_is_wrong(dataset: Dataset, tmp_path: Path) -> None:
    (summary,) = _submitted(dataset, tmp_path / "a", Rotation.from_rotvec([0.0, 0.0, 6.0], degrees=True)).summaries
    assert (summary.wrong, summary.wrong_but_confident) == (len(dataset.frames), 1.0)
