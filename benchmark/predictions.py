"""The folder of a method's answers: predictions.csv, run.json, extras.parquet. The second door for outside methods.

Reading is strict, because any program in any language may have written the files: every fault is one sentence that names the
file, the line and the value. The table that comes out has one row per (frame, sensor) with unit quaternions, or none.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from benchmark.errors import PredictionsError
from benchmark.files import publish
from benchmark.records import RunRecord
from benchmark.table_faults import COLUMNS, QUATERNION, TRANSLATION, header_faults, lines, rows_of
from scenes.arrays import Floats

__all__ = ["COLUMNS", "QUATERNION", "TRANSLATION", "Predictions", "parse", "positions", "read", "read_record", "rotations", "write"]

TABLE, RECORD, EXTRAS = "predictions.csv", "run.json", "extras.parquet"


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
    table = parse(text_of(folder / TABLE), str(folder / TABLE))
    extras = read_extras(folder)
    for fault in extras_faults(extras, folder / EXTRAS):
        raise PredictionsError(fault)
    return Predictions(record, table, extras)


def read_record(folder: Path) -> RunRecord:
    """run.json of ``folder``, validated."""
    record, faults = record_and_faults(folder)
    if record is None:
        raise PredictionsError(faults[0])
    return record


def record_and_faults(folder: Path) -> tuple[RunRecord | None, list[str]]:
    """run.json of ``folder`` if nothing is wrong with it, else every fault. Raises ``PredictionsError`` where it is no JSON."""
    path = folder / RECORD
    try:
        return RunRecord.model_validate(json.loads(text_of(path))), []
    except json.JSONDecodeError as error:
        raise PredictionsError(f"{path} is not JSON: {error}") from error
    except ValidationError as error:
        where = [(".".join(str(part) for part in one["loc"]) or "the file", one) for one in error.errors()]
        return None, [f"{path}: {place}: {one['msg']} (found {one['input']!r})" for place, one in where]


def read_extras(folder: Path) -> pd.DataFrame | None:
    """extras.parquet of ``folder``, None where there is none. Raises ``PredictionsError`` where it is no Parquet file."""
    path = folder / EXTRAS
    try:
        return pd.read_parquet(path) if path.exists() else None
    except (OSError, ValueError) as error:
        raise PredictionsError(f"{path} cannot be read: {error}") from error


def extras_faults(extras: pd.DataFrame | None, path: Path) -> list[str]:
    """What is wrong with the named numbers: a column that must be there and is not, one that is no number, a frame given twice."""
    if extras is None:
        return []
    missing = [f"{path} lacks the column {name!r}" for name in ("frame", "sensor") if name not in extras]
    if missing or extras.empty:
        return missing
    numbers = [name for name in extras if name not in ("sensor", "reason")]
    faults = [
        f"{path}: column {str(name)!r} holds {extras[name].dtype} values, not numbers"
        for name in numbers
        if not pd.api.types.is_numeric_dtype(extras[name])
    ]
    twice = extras[extras.duplicated(["frame", "sensor"])]
    return faults + [f"{path}: frame {row.frame} of {row.sensor!r} is there twice" for row in twice.itertuples()]


def parse(text: str, name: str) -> pd.DataFrame:
    """The table in the CSV ``text``; ``name`` stands in the sentences. Quaternions come out normalised."""
    rows = rows_of(text, name)
    read = [] if header_faults(rows, name) else list(lines(rows, name))
    for fault in (*header_faults(rows, name), *(fault for line in read for fault in line.faults)):
        raise PredictionsError(fault)
    return _normalised(pd.DataFrame([line.values for line in read], columns=list(COLUMNS)))


def rotations(table: pd.DataFrame) -> Rotation:
    """The rotations in the quaternion columns of a table of answers, or of the truth."""
    return Rotation.from_quat(table[list(QUATERNION)].to_numpy(dtype=np.float64), scalar_first=True)


def positions(table: pd.DataFrame) -> Floats:
    """(n, 3) positions in metres of a table of answers, or of the truth; NaN where none was given."""
    return table[list(TRANSLATION)].to_numpy(dtype=np.float64)


def _normalised(table: pd.DataFrame) -> pd.DataFrame:
    quaternions = table[list(QUATERNION)].to_numpy(dtype=np.float64)
    length = np.linalg.norm(quaternions, axis=1, keepdims=True)
    length[np.abs(length - 1) < 1e-12] = 1.0  # so that what this program wrote is read to the last bit
    table[list(QUATERNION)] = quaternions / (length * np.where(quaternions[:, :1] < 0, -1.0, 1.0))
    return table


def text_of(path: Path) -> str:
    """The text of a file. Raises ``PredictionsError`` where it is not there, or no text."""
    try:
        return path.read_text(encoding="utf-8-sig")  # a spreadsheet begins its UTF-8 with a byte-order mark
    except FileNotFoundError:
        raise PredictionsError(f"{path} does not exist") from None
    except UnicodeDecodeError as error:
        raise PredictionsError(f"{path} is not UTF-8 text: {error}") from error
