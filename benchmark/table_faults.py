"""Reading predictions.csv: the rows that it holds and every fault, one sentence each with file, line, field and value."""

import csv
import io
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmark.errors import PredictionsError
from estimators.api import Outcome
from scenes.errors import unknown

COLUMNS = ("frame", "sensor", "outcome", "qw", "qx", "qy", "qz", "tx_m", "ty_m", "tz_m", "cpu_s", "wall_s")
QUATERNION, TRANSLATION, TIMES = COLUMNS[3:7], COLUMNS[7:10], COLUMNS[10:]
_UNIT_TOLERANCE = 1e-4  # six printed decimals are within it; a quaternion in another order of units is not
_MOST_DIGITS = 15  # of a frame number
_OUTCOMES = tuple(outcome.value for outcome in Outcome)


@dataclass(frozen=True, slots=True)
class Line:
    """One line of the table: its number, counted from 1, the values that could be read, and what is wrong with it."""

    number: int
    values: dict[str, Any]
    faults: tuple[str, ...]


def header_faults(rows: list[list[str]], name: str) -> list[str]:
    """What is wrong with the first line; without a fault the rest can be read."""
    header = rows[0] if rows else []
    missing = [column for column in COLUMNS if column not in header]
    unexpected = [column for column in header if column not in COLUMNS]
    if missing or unexpected:
        told = [f"lacks the column {missing[0]!r}"] if missing else []
        told += [f"has the unknown column {unexpected[0]!r}"] if unexpected else []
        first = f"{name} {' and '.join(told)}; the columns are {','.join(COLUMNS)}"
        further = [f"{name} lacks the column {column!r}" for column in missing[1:]]
        return [first, *further, *(f"{name} has the unknown column {column!r}" for column in unexpected[1:])]
    if tuple(header) != COLUMNS:
        return [f"{name} has its columns in the order {','.join(header)}; the order is {','.join(COLUMNS)}"]
    return []


def rows_of(text: str, name: str) -> list[list[str]]:
    """The fields of each line, without blank lines at the end. Raises ``PredictionsError`` where they cannot be told apart."""
    try:
        rows = list(csv.reader(io.StringIO(text)))
    except csv.Error as error:
        raise PredictionsError(f"{name} is not a table of comma-separated values: {error}") from error
    while rows and not "".join(rows[-1]).strip() and len(rows[-1]) <= 1:
        rows.pop()
    return rows


def lines(rows: list[list[str]], name: str) -> Iterator[Line]:
    """The lines after the header; a frame that is answered twice is a fault of the second answer."""
    seen: dict[tuple[int, str], int] = {}
    for number, row in enumerate(rows[1:], start=2):
        where = f"{name}, line {number}"
        if len(row) != len(COLUMNS):
            yield Line(number, {}, (f"{where}: {len(row)} fields where the header has {len(COLUMNS)}",))
            continue
        values, faults = _read(dict(zip(COLUMNS, row, strict=True)), where)
        key = (values.get("frame", -number), values["sensor"])
        if key in seen:
            faults.append(f"{where}: frame {key[0]} of {key[1]!r} is answered twice (first on line {seen[key]})")
        seen.setdefault(key, number)
        yield Line(number, values, tuple(faults))


def _read(row: dict[str, str], where: str) -> tuple[dict[str, Any], list[str]]:
    faults: list[str] = []
    values: dict[str, Any] = {"sensor": row["sensor"], "outcome": row["outcome"]}
    if row["outcome"] not in _OUTCOMES:
        faults.append(f"{where}: {unknown('outcome', row['outcome'], _OUTCOMES)}")
    if row["frame"].isdecimal() and len(row["frame"]) <= _MOST_DIGITS:
        values["frame"] = int(row["frame"])
    else:
        faults.append(f"{where}: frame is {row['frame']!r}, not a whole number from 0")
    numbers = {column: _number(row[column], column, where, faults) for column in COLUMNS[3:]}
    if not faults:
        faults += _pose_faults(numbers, row["outcome"], where)
    faults += [f"{where}: {name} is {row[name]}, a negative time" for name in TIMES if numbers[name] < 0]
    return values | numbers, faults


def _number(text: str, column: str, where: str, faults: list[str]) -> float:
    if not text:
        return float("nan")
    try:
        value = float(text)
    except ValueError:
        faults.append(f"{where}: {column} is {text!r}, not a number")
        return float("nan")
    if not np.isfinite(value):
        faults.append(f"{where}: {column} is {text}; leave the field empty where a method gives no value")
    return value


def _pose_faults(numbers: dict[str, float], outcome: str, where: str) -> Iterator[str]:
    quaternion = np.array([numbers[column] for column in QUATERNION])
    translation = np.array([numbers[column] for column in TRANSLATION])
    given = ~np.isnan(quaternion)
    if outcome == Outcome.OK.value and not given.all():
        yield f"{where}: outcome is ok but {QUATERNION[int(np.argmin(given))]} is empty"
    if outcome != Outcome.OK.value and (given.any() or not np.isnan(translation).all()):
        yield f"{where}: outcome is {outcome} but the line gives a pose; only ok has one"
    if np.isnan(translation).any() and not np.isnan(translation).all():
        yield f"{where}: tx_m, ty_m, tz_m are given in part; give all three or none"
    norm = math.hypot(*quaternion)
    if given.all() and abs(norm - 1) > _UNIT_TOLERANCE:
        yield f"{where}: the quaternion has length {norm:.6g}, not 1"
