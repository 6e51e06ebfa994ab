"""The folder of a method's answers: predictions.csv, run.json, extras.parquet. The second door for outside methods.

Reading is strict, because any program in any language may have written the files: every fault is one sentence that names the
file, the line and the value. The table that comes out has one row per (frame, sensor) with unit quaternions, or none.
"""

import csv
import io
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from benchmark.errors import PredictionsError
from benchmark.files import publish
from benchmark.records import RunRecord
from estimators.api import Outcome
from scenes.arrays import Floats
from scenes.errors import unknown

COLUMNS = ("frame", "sensor", "outcome", "qw", "qx", "qy", "qz", "tx_m", "ty_m", "tz_m", "cpu_s", "wall_s")
QUATERNION, TRANSLATION, TIMES = COLUMNS[3:7], COLUMNS[7:10], COLUMNS[10:]
TABLE, RECORD, EXTRAS = "predictions.csv", "run.json", "extras.parquet"
_UNIT_TOLERANCE = 1e-4  # six printed decimals are within it; a quaternion in another order of units is not
_OUTCOMES = tuple(outcome.value for outcome in Outcome)


@dataclass(frozen=True, slots=True, eq=False)
class Predictions:
    """A method's answers: the record, the table with ``COLUMNS``, the optional named numbers per (frame, sensor)."""

    record: RunRecord
    table: pd.DataFrame
    extras: pd.DataFrame | None = None


def write(folder: Path, predictions: Predictions) -> None:
    """Writes the files into ``folder``, all or none."""
    extras = predictions.extras if predictions.extras is not None else pd.DataFrame({"frame": [], "sensor": []})
    table = predictions.table.to_csv(columns=list(COLUMNS), index=False, lineterminator="\n")
    record = predictions.record.model_dump_json(indent=2) + "\n"
    publish(folder, {EXTRAS: extras.to_parquet(index=False), TABLE: table.encode(), RECORD: record.encode()})


def read(folder: Path) -> Predictions:
    """The answers in ``folder``. Raises ``PredictionsError`` with one sentence for the first thing that is wrong."""
    record = read_record(folder)
    path = folder / TABLE
    table = parse(_text(path), str(path))
    extras = folder / EXTRAS
    try:
        return Predictions(record, table, pd.read_parquet(extras) if extras.exists() else None)
    except (OSError, ValueError) as error:
        raise PredictionsError(f"{extras} cannot be read: {error}") from error


def read_record(folder: Path) -> RunRecord:
    """run.json of ``folder``, validated."""
    path = folder / RECORD
    try:
        return RunRecord.model_validate(json.loads(_text(path)))
    except json.JSONDecodeError as error:
        raise PredictionsError(f"{path} is not JSON: {error}") from error
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"]) or "the file"
        raise PredictionsError(f"{path}: {where}: {first['msg']} (found {first['input']!r})") from error


def parse(text: str, name: str) -> pd.DataFrame:
    """The table in the CSV ``text``; ``name`` stands in the sentences. Quaternions come out normalised."""
    rows = list(csv.reader(io.StringIO(text)))
    while rows and not "".join(rows[-1]).strip() and len(rows[-1]) <= 1:  # blank lines at the end
        rows.pop()
    _check_header(rows[0] if rows else [], name)
    seen: dict[tuple[int, str], int] = {}
    records: list[dict[str, Any]] = []
    for line, row in enumerate(rows[1:], start=2):
        if len(row) != len(COLUMNS):
            raise PredictionsError(f"{name}, line {line}: {len(row)} fields where the header has {len(COLUMNS)}")
        record = _parse_row(dict(zip(COLUMNS, row, strict=True)), f"{name}, line {line}")
        key = (record["frame"], record["sensor"])
        if key in seen:
            raise PredictionsError(
                f"{name}, line {line}: frame {key[0]} of {key[1]!r} is answered twice (first on line {seen[key]})"
            )
        seen[key] = line
        records.append(record)
    return _normalised(pd.DataFrame(records, columns=list(COLUMNS)))


def rotations(table: pd.DataFrame) -> Rotation:
    """The rotations in the quaternion columns of a table of answers, or of the truth."""
    return Rotation.from_quat(table[list(QUATERNION)].to_numpy(dtype=np.float64), scalar_first=True)


def positions(table: pd.DataFrame) -> Floats:
    """(n, 3) positions in metres of a table of answers, or of the truth; NaN where none was given."""
    return table[list(TRANSLATION)].to_numpy(dtype=np.float64)


def _check_header(header: list[str], name: str) -> None:
    missing = [column for column in COLUMNS if column not in header]
    unexpected = [column for column in header if column not in COLUMNS]
    if missing or unexpected:
        told = [f"lacks the column {missing[0]!r}"] if missing else []
        told += [f"has the unknown column {unexpected[0]!r}"] if unexpected else []
        raise PredictionsError(f"{name} {' and '.join(told)}; the columns are {','.join(COLUMNS)}")
    if tuple(header) != COLUMNS:
        raise PredictionsError(f"{name} has its columns in the order {','.join(header)}; the order is {','.join(COLUMNS)}")


def _parse_row(row: dict[str, str], where: str) -> dict[str, Any]:
    outcome = row["outcome"]
    if outcome not in _OUTCOMES:
        raise PredictionsError(f"{where}: {unknown('outcome', outcome, _OUTCOMES)}")
    if not row["frame"].isdecimal():
        raise PredictionsError(f"{where}: frame is {row['frame']!r}, not a whole number from 0")
    numbers = {column: _number(row[column], column, where) for column in COLUMNS[3:]}
    _check_pose(numbers, outcome, where)
    for column in TIMES:
        if numbers[column] < 0:
            raise PredictionsError(f"{where}: {column} is {row[column]}, a negative time")
    return {"frame": int(row["frame"]), "sensor": row["sensor"], "outcome": outcome, **numbers}


def _number(text: str, column: str, where: str) -> float:
    if not text:
        return float("nan")
    try:
        value = float(text)
    except ValueError:
        raise PredictionsError(f"{where}: {column} is {text!r}, not a number") from None
    if not np.isfinite(value):
        raise PredictionsError(f"{where}: {column} is {text}; leave the field empty where a method gives no value")
    return value


def _check_pose(numbers: dict[str, float], outcome: str, where: str) -> None:
    quaternion = np.array([numbers[column] for column in QUATERNION])
    translation = np.array([numbers[column] for column in TRANSLATION])
    given = ~np.isnan(quaternion)
    if outcome == Outcome.OK.value and not given.all():
        raise PredictionsError(f"{where}: outcome is ok but {QUATERNION[int(np.argmin(given))]} is empty")
    if outcome != Outcome.OK.value and (given.any() or not np.isnan(translation).all()):
        raise PredictionsError(f"{where}: outcome is {outcome} but the line gives a pose; only ok has one")
    if np.isnan(translation).any() and not np.isnan(translation).all():
        raise PredictionsError(f"{where}: tx_m, ty_m, tz_m are given in part; give all three or none")
    norm = float(np.linalg.norm(quaternion))
    if given.all() and abs(norm - 1) > _UNIT_TOLERANCE:
        raise PredictionsError(f"{where}: the quaternion has length {norm:.6g}, not 1")


def _normalised(table: pd.DataFrame) -> pd.DataFrame:
    quaternions = table[list(QUATERNION)].to_numpy(dtype=np.float64)
    length = np.linalg.norm(quaternions, axis=1, keepdims=True)
    length[np.abs(length - 1) < 1e-12] = 1.0  # so that what this program wrote is read to the last bit
    table[list(QUATERNION)] = quaternions / (length * np.where(quaternions[:, :1] < 0, -1.0, 1.0))
    return table


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")  # a spreadsheet begins its UTF-8 with a byte-order mark
    except FileNotFoundError:
        raise PredictionsError(f"{path} does not exist") from None
    except UnicodeDecodeError as error:
        raise PredictionsError(f"{path} is not UTF-8 text: {error}") from error
