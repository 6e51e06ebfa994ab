"""Reading is strict: whatever program wrote the files, each fault is one sentence with file, line and value."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from benchmark.errors import PredictionsError
from benchmark.predictions import COLUMNS, QUATERNION, Predictions, parse, read, write
from benchmark.records import RunRecord
from scenes.errors import StorageError

HEADER = ",".join(COLUMNS)
GOOD = "0,nav,ok,1,0,0,0,,,,0.01,0.01"
RECORD = RunRecord(format="hardlight-predictions", version=1, method="mine", dataset_identity="abc")


def _table(rows: int = 5) -> pd.DataFrame:
    quaternions = Rotation.random(rows, rng=0).as_quat(canonical=True, scalar_first=True)
    table = pd.DataFrame({"frame": range(rows), "sensor": "nav", "outcome": "ok"})
    table[list(QUATERNION)] = quaternions
    table[["tx_m", "ty_m", "tz_m"]] = np.random.default_rng(0).normal(size=(rows, 3))
    table[["cpu_s", "wall_s"]] = 0.012345678901234567
    return table


def test_what_was_written_is_read_to_the_last_bit(tmp_path: Path) -> None:
    table = _table()
    table.loc[2, ["qw", "qx", "qy", "qz", "tx_m", "ty_m", "tz_m"]] = np.nan
    table.loc[2, "outcome"] = "no_features"
    extras = pd.DataFrame({"frame": [0, 1], "sensor": "nav", "reason": ["", "a"], "sigma_deg": [0.1, np.nan]})
    write(tmp_path, Predictions(RECORD, table, extras))
    again = read(tmp_path)
    assert again.record == RECORD
    assert again.extras is not None
    pd.testing.assert_frame_equal(again.extras, extras)
    pd.testing.assert_frame_equal(again.table, table, check_exact=True)
    first = (tmp_path / "predictions.csv").read_bytes()
    write(tmp_path, again)
    assert (tmp_path / "predictions.csv").read_bytes() == first


def test_a_quaternion_of_either_sign_and_six_decimals_is_normalised() -> None:
    table = parse(f"{HEADER}\n0,nav,ok,-0.707107,0.707107,0,0,,,,,\n", "p.csv")
    assert_allclose(table[list(QUATERNION)].to_numpy()[0], [0.5**0.5, -(0.5**0.5), 0, 0], atol=1e-12)
    assert np.isnan(table["cpu_s"][0])


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", r"p.csv lacks the column 'frame'"),
        (HEADER.replace("qw", "w") + "\n" + GOOD, r"lacks the column 'qw' and has the unknown column 'w'"),
        (HEADER + ",note\n" + GOOD + ",x", r"has the unknown column 'note'; the columns are frame,sensor"),
        (",".join(reversed(COLUMNS)), r"columns in the order wall_s,cpu_s.*; the order is frame,sensor"),
        (f"{HEADER}\n0,nav,ok,1,0,0,0", r"p.csv, line 2: 7 fields where the header has 12"),
        (f"{HEADER}\n0,nav,okay,1,0,0,0,,,,,", r"line 2: no outcome is called 'okay'; did you mean 'ok'\?"),
        (f"{HEADER}\n{GOOD}\n-1,nav,ok,1,0,0,0,,,,,", r"line 3: frame is '-1', not a whole number from 0"),
        (f"{HEADER}\n1.5,nav,ok,1,0,0,0,,,,,", r"line 2: frame is '1.5'"),
        (f"{HEADER}\n{GOOD}\n{GOOD}", r"line 3: frame 0 of 'nav' is answered twice \(first on line 2\)"),
        (f"{HEADER}\n0,nav,ok,one,0,0,0,,,,,", r"line 2: qw is 'one', not a number"),
        (f"{HEADER}\n0,nav,ok,nan,0,0,0,,,,,", r"line 2: qw is nan; leave the field empty"),
        (f"{HEADER}\n0,nav,ok,1,0,0,0,inf,0,0,,", r"line 2: tx_m is inf"),
        (f"{HEADER}\n0,nav,ok,1,1,0,0,,,,,", r"line 2: the quaternion has length 1.41421, not 1"),
        (f"{HEADER}\n0,nav,ok,0,0,0,0,,,,,", r"line 2: the quaternion has length 0, not 1"),
        (f"{HEADER}\n0,nav,ok,1,0,,0,,,,,", r"line 2: outcome is ok but qy is empty"),
        (f"{HEADER}\n0,nav,ok,,,,,,,,,", r"line 2: outcome is ok but qw is empty"),
        (f"{HEADER}\n0,nav,no_features,1,0,0,0,,,,,", r"line 2: outcome is no_features but the line gives a pose"),
        (f"{HEADER}\n0,nav,skipped,,,,,0,0,9,,", r"line 2: outcome is skipped but the line gives a pose"),
        (f"{HEADER}\n0,nav,ok,1,0,0,0,0,,9,,", r"line 2: tx_m, ty_m, tz_m are given in part"),
        (f"{HEADER}\n0,nav,ok,1,0,0,0,,,,-0.1,", r"line 2: cpu_s is -0.1, a negative time"),
    ],
)
def test_each_fault_of_a_table_is_one_sentence(text: str, sentence: str) -> None:
    with pytest.raises(PredictionsError, match=sentence) as caught:
        parse(text, "p.csv")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("{", r"run.json is not JSON"),
        ("[]", r"run.json: the file: "),
        ('{"format": "hardlight-predictions", "version": 1, "method": "x"}', r"dataset_identity: Field required"),
        ('{"format": "csv", "version": 1, "method": "x", "dataset_identity": "a"}', r"format: .*'hardlight-predictions'"),
        ('{"format": "hardlight-predictions", "version": 2, "method": "x", "dataset_identity": "a"}', r"version: .*found 2"),
        (
            '{"format": "hardlight-predictions", "version": 1, "method": "x", "dataset_identity": "a", "paramters": {}}',
            r"paramters: Extra inputs",
        ),
        (
            '{"format": "hardlight-predictions", "version": 1, "method": "x", "dataset_identity": "a", "start_cpu_s": -1}',
            r"start_cpu_s: .*greater than or equal to 0",
        ),
    ],
)
def test_each_fault_of_a_record_is_one_sentence(tmp_path: Path, text: str, sentence: str) -> None:
    (tmp_path / "run.json").write_text(text)
    (tmp_path / "predictions.csv").write_text(f"{HEADER}\n{GOOD}\n")
    with pytest.raises(PredictionsError, match=sentence):
        read(tmp_path)


def test_missing_files_and_bytes_that_are_no_text(tmp_path: Path) -> None:
    with pytest.raises(PredictionsError, match=r"run.json does not exist"):
        read(tmp_path)
    write(tmp_path, Predictions(RECORD, _table()))
    (tmp_path / "predictions.csv").write_bytes(b"frame\xff\xfe")
    with pytest.raises(PredictionsError, match="is not UTF-8 text"):
        read(tmp_path)
    write(tmp_path, Predictions(RECORD, _table()))
    (tmp_path / "extras.parquet").write_bytes(b"PAR1")
    with pytest.raises(PredictionsError, match=r"extras.parquet cannot be read"):
        read(tmp_path)


def test_a_failed_write_leaves_what_was_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path, Predictions(RECORD, _table()))
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(StorageError, match="No space left on device"):
        write(tmp_path, Predictions(RECORD, _table(3)))
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_table_saved_by_a_spreadsheet_is_read(tmp_path: Path) -> None:
    """Excel writes a byte-order mark and CRLF; blank lines at the end are no answers, one in between is a fault."""
    write(tmp_path, Predictions(RECORD, _table()))
    table, plain = tmp_path / "predictions.csv", read(tmp_path).table
    text = table.read_text()
    table.write_bytes(b"\xef\xbb\xbf" + (text + "\n  \n\n").replace("\n", "\r\n").encode())
    pd.testing.assert_frame_equal(read(tmp_path).table, plain, check_exact=True)
    head, _, rest = text.partition("\n")
    table.write_text(f"{head}\n\n{rest}")
    with pytest.raises(PredictionsError, match="line 2: 0 fields where the header has 12"):
        read(tmp_path)
