"""A folder of answers that any program wrote: all its faults at once, each with file, line, field and both values."""

import json
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from benchmark import predictions, submission
from benchmark.errors import PredictionsError
from benchmark.predictions import COLUMNS, read
from scenes.dataset import Dataset

HEADER = ",".join(COLUMNS)
GOOD = "0,nav,ok,1,0,0,0,0,0,12,0.01,0.01"


def _folder(path: Path, dataset: Dataset, lines: list[str], header: str = HEADER, **record: Any) -> Path:
    full = {"format": "hardlight-predictions", "version": 1, "method": "mine", "dataset_identity": dataset.identity} | record
    path.mkdir(exist_ok=True)
    (path / "run.json").write_text(json.dumps({key: value for key, value in full.items() if value is not None}))
    (path / "predictions.csv").write_text("\n".join([header, *lines]) + "\n")
    return path


def _complete(dataset: Dataset) -> list[str]:
    return [f"{frame},nav,{'ok,1,0,0,0,,,' if frame % 2 else 'no_features,,,,,,,'},," for frame in dataset.frames]


def test_a_good_folder_has_no_fault_and_nothing_to_note(dataset: Dataset, tmp_path: Path) -> None:
    found = submission.examine(_folder(tmp_path, dataset, _complete(dataset)), dataset)
    assert (found.faults, found.notes) == ((), ())


def test_every_fault_is_there_at_once_and_each_has_its_line(dataset: Dataset, tmp_path: Path) -> None:
    lines = [
        GOOD,
        "1,nav,okay,1,0,0,0,,,,,",
        "2,nva,ok,2,0,0,0,,,,,",
        "99,nav,ok,1,0,0,0,1,2,,,",
        "x,nav,ok,one,nan,0,0,,,,-1,",
        "0,nav,no_features,1,0,0,0,,,,,",
        "3,nav,ok",
        "4,nav,ok,1,0,,0,,,,,",
    ]
    folder = _folder(tmp_path, dataset, lines, dataset_identity="abc", paramters={}, version=2)
    table, record = folder / "predictions.csv", folder / "run.json"
    choices = "(there are: crashed, diverged, no_features, not_converged, ok, skipped, timed_out)"
    assert list(submission.examine(folder, dataset).faults) == [
        f"{record}: version: Input should be 1 (found 2)",
        f"{record}: paramters: Extra inputs are not permitted (found {{}})",
        f"{table}, line 3: no outcome is called 'okay'; did you mean 'ok'? {choices}",
        f"{table}, line 4: the quaternion has length 2, not 1",
        f"{table}, line 4: sensor: no sensor is called 'nva'; did you mean 'nav'? (there are: nav)",
        f"{table}, line 5: tx_m, ty_m, tz_m are given in part; give all three or none",
        f"{table}, line 5: frame is 99, which {dataset.path} does not have (0 to 20)",
        f"{table}, line 6: frame is 'x', not a whole number from 0",
        f"{table}, line 6: qw is 'one', not a number",
        f"{table}, line 6: qx is nan; leave the field empty where a method gives no value",
        f"{table}, line 6: cpu_s is -1, a negative time",
        f"{table}, line 7: outcome is no_features but the line gives a pose; only ok has one",
        f"{table}, line 7: frame 0 of 'nav' is answered twice (first on line 2)",
        f"{table}, line 8: 3 fields where the header has 12",
        f"{table}, line 9: outcome is ok but qy is empty",
    ]


def test_answers_to_another_data_set_are_named_with_both_identities(dataset: Dataset, tmp_path: Path) -> None:
    told = {"sensors": ["nav"], "feature": "pannel"}
    folder = _folder(tmp_path, dataset, _complete(dataset), dataset_identity="abc", knowledge=told)
    assert list(submission.examine(folder, dataset).faults) == [
        f"{folder / 'run.json'}: dataset_identity is abc, and {dataset.path} is data set {dataset.identity}",
        f"{folder / 'run.json'}: knowledge.feature: no feature is called 'pannel'; did you mean 'panel'? (there are: panel)",
    ]


def test_a_header_is_told_completely_and_the_rest_not_guessed_at(dataset: Dataset, tmp_path: Path) -> None:
    header = HEADER.replace("qw", "w").replace("qx", "x")
    faults = submission.examine(_folder(tmp_path, dataset, ["nonsense"], header), dataset).faults
    table = tmp_path / "predictions.csv"
    assert faults[0].startswith(f"{table} lacks the column 'qw' and has the unknown column 'w'; the columns are frame,sensor")
    assert faults[1:] == (f"{table} lacks the column 'qx'", f"{table} has the unknown column 'x'")


def test_files_that_are_none_are_one_sentence_each(dataset: Dataset, tmp_path: Path) -> None:
    tmp_path.joinpath("run.json").write_text("{")
    tmp_path.joinpath("extras.parquet").write_text("PAR1")
    faults = submission.examine(tmp_path, dataset).faults
    assert len(faults) == 3
    for fault, start in zip(faults, ("run.json is not JSON", "predictions.csv does not exist", "extras.parquet cannot be read")):
        assert start in fault
    (tmp_path / "predictions.csv").write_text(HEADER + "\n" + "x" * 200_000)
    assert "is not a table of comma-separated values: field larger" in submission.examine(tmp_path, dataset).faults[1]


def test_frames_without_a_line_are_noted_and_none_at_all_is_a_fault(dataset: Dataset, tmp_path: Path) -> None:
    found = submission.examine(_folder(tmp_path, dataset, [GOOD]), dataset)
    assert found.faults == ()
    assert found.notes == ("nav: 20 of 21 frames have no line (the first is 1) and count as skipped",)
    empty = submission.examine(_folder(tmp_path, dataset, []), dataset)
    assert empty.faults == (f"{tmp_path / 'predictions.csv'} has no line; a method answers every frame, if only with 'skipped'",)


@pytest.mark.parametrize(
    ("extras", "sentence"),
    [
        ({"sensor": ["nav"], "a": [1.0]}, "lacks the column 'frame'"),
        ({"frame": [0, 0], "sensor": ["nav", "nav"], "a": [1.0, 2.0]}, "frame 0 of 'nav' is there twice"),
        ({"frame": [0], "sensor": ["nav"], "note": ["x"]}, "column 'note' holds .* values, not numbers"),
    ],
)
def test_extras_that_cannot_be_joined_are_refused_by_check_and_judge(
    dataset: Dataset, tmp_path: Path, extras: dict[str, list[Any]], sentence: str
) -> None:
    folder = _folder(tmp_path, dataset, _complete(dataset))
    pd.DataFrame(extras).to_parquet(folder / predictions.EXTRAS)
    with pytest.raises(PredictionsError, match=f"extras.parquet.* {sentence}"):
        read(folder)
    (fault,) = submission.examine(folder, dataset).faults
    assert "extras.parquet" in fault


def test_extras_of_a_frame_that_was_not_answered_are_found(dataset: Dataset, tmp_path: Path) -> None:
    folder = _folder(tmp_path, dataset, _complete(dataset)[:3])
    pd.DataFrame({"frame": [0, 5], "sensor": "nav", "reason": ["", "x"], "a": [1.0, 2.0]}).to_parquet(folder / predictions.EXTRAS)
    (fault,) = submission.examine(folder, dataset).faults
    assert fault == f"{folder / 'extras.parquet'}: frame 5 of 'nav' has no line in predictions.csv"


def test_numbers_beyond_all_measure_are_sentences_too(dataset: Dataset, tmp_path: Path) -> None:
    lines = ["9" * 40 + ",nav,ok,1,0,0,0,,,,,", "1,nav,ok,1e300,1e300,1e300,0,,,,,"]
    faults = submission.examine(_folder(tmp_path, dataset, lines), dataset).faults
    assert "frame is '9999" in faults[0]
    assert "not a whole number" in faults[0]
    assert "the quaternion has length 1.73205e+300, not 1" in faults[1]
