"""The table of all judged frames against answers whose errors are known."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import Rotation

from benchmark import judge, predictions
from benchmark.errors import PredictionsError
from benchmark.knowledge import declare
from benchmark.pool import COLUMNS, pool
from benchmark.predictions import COLUMNS as ANSWER
from benchmark.predictions import QUATERNION, Predictions
from benchmark.records import RunRecord
from benchmark.results import CaseHeading, Entry, Results
from scenes.dataset import Dataset

_TURN_DEG = 6.0


def _answers(dataset: Dataset, turn_deg: float) -> Predictions:
    """The true attitude turned about Y, no position; the last frame is not answered."""
    truth = dataset.truth_table()
    true = Rotation.from_quat(truth[list(QUATERNION)].to_numpy(float), scalar_first=True)
    table = pd.DataFrame({"frame": truth["frame"], "sensor": "nav", "outcome": "ok", "cpu_s": 0.01, "wall_s": 0.02})
    turned = true * Rotation.from_euler("y", turn_deg, degrees=True)
    table[list(QUATERNION)] = turned.as_quat(canonical=True, scalar_first=True)
    table.loc[table.index[-1], ["outcome", *QUATERNION]] = ["no_features", *[np.nan] * 4]
    record = RunRecord(
        format="hardlight-predictions",
        version=1,
        method="oracle",
        dataset_identity=dataset.identity,
        knowledge=declare(dataset, "panel").record,
    )
    return Predictions(record, table.reindex(columns=list(ANSWER)))


def _judged(folder: Path, dataset: Dataset, settle_s: float = 0.0) -> Results:
    """Two seeds of one case: exact answers and turned ones."""
    entries = []
    for run, turn_deg in (("sweep-seed0", 0.0), ("sweep-seed1", _TURN_DEG)):
        given = _answers(dataset, turn_deg)
        predictions.write(folder / run, given)
        judge.write(folder / run, judge.judge(given, dataset, settle_s))
        entries.append(Entry(case=run, feature="panel", title="oracle", dataset="d", answers=run, scores=run))
    cases = tuple(CaseHeading(name=f"sweep-seed{seed}", base="sweep", seed=seed) for seed in (0, 1))
    return Results(title="two seeds", cases=cases, entries=tuple(entries))


def test_every_frame_is_there_with_its_error_and_its_case(dataset: Dataset, tmp_path: Path) -> None:
    frames = pool(tmp_path, _judged(tmp_path, dataset))
    assert list(frames.columns) == list(COLUMNS)
    assert len(frames) == 2 * len(dataset.frames)
    assert set(frames["case"]) == {"sweep"}
    assert list(frames["seed"].unique()) == [0.0, 1.0]
    assert set(frames["modality"]) == {"mono"}
    exact, turned = (one for _, one in frames.groupby("run"))
    assert exact["score"].max() == 0.0
    np.testing.assert_allclose(turned["score"].dropna(), np.radians(_TURN_DEG), atol=1e-12)
    assert turned["wrong"].sum() == len(dataset.frames) - 1
    assert not exact["wrong"].any()


def test_an_unanswered_frame_has_no_error_and_is_not_wrong(dataset: Dataset, tmp_path: Path) -> None:
    frames = pool(tmp_path, _judged(tmp_path, dataset))
    silent = frames[~frames["answered"]]
    assert len(silent) == 2
    assert silent[["geodesic_deg", "score", "speed_rotation"]].isna().all(axis=None)
    assert not silent["wrong"].any()


def test_frames_in_which_filters_settle_are_left_out(dataset: Dataset, tmp_path: Path) -> None:
    frames = pool(tmp_path, _judged(tmp_path, dataset, settle_s=5.0))
    assert frames["time_s"].min() == 5.0


def test_lost_scores_are_a_sentence(dataset: Dataset, tmp_path: Path) -> None:
    index = _judged(tmp_path, dataset)
    (tmp_path / "sweep-seed1" / judge.SCORES).unlink()
    with pytest.raises(PredictionsError, match=r"scores\.parquet does not exist"):
        pool(tmp_path, index)
