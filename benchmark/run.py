"""Loop 1: a method answers every frame of a data set. It is handed observations and its declared knowledge, nothing else."""

import math
from collections.abc import Mapping
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from benchmark import methods, predictions
from benchmark.errors import ResultsConflict
from benchmark.knowledge import Declaration
from benchmark.machine import Stopwatch, this_machine
from benchmark.predictions import COLUMNS, QUATERNION, TRANSLATION, Predictions
from benchmark.progress import Progress
from benchmark.records import RunRecord
from estimators import registry
from estimators.api import Estimate, Estimator, Outcome
from scenes.dataset import Dataset
from scenes.recording import Knowledge, Observation

_IN_START = "start: "
_TAKEN = ("frame", "sensor", "reason")  # columns of extras.parquet that are not the method's


def estimate(
    method: str,
    parameters: Mapping[str, Any],
    dataset: Dataset,
    declaration: Declaration,
    out: Path,
    *,
    label: str = "",
    progress: Progress | None = None,
) -> Predictions:
    """Runs the registered ``method`` over ``dataset`` and writes its answers to ``out``.

    Raises ``ResultsConflict`` where ``out`` already holds the answers of something else: another method, other parameters,
    other knowledge or another data set.
    """
    estimator = registry.load(method, **parameters)
    record = RunRecord(
        format="hardlight-predictions",
        version=1,
        method=method,
        label=label,
        method_version=methods.version(method),
        parameters=dict(parameters),
        dataset_identity=dataset.identity,
        knowledge=declaration.record,
        machine=this_machine(),
    )
    refuse_to_mix(out, record)
    answers = answer(estimator, dataset, declaration.knowledge, record, progress)
    predictions.write(out, answers)
    return answers


def answer(
    estimator: Estimator, dataset: Dataset, knowledge: Knowledge, record: RunRecord, progress: Progress | None = None
) -> Predictions:
    """The loop itself: start once, then one step a frame. An exception is the outcome ``crashed`` with its text.

    So is an attempt to end the process (sys.exit); Ctrl-C is the user's and goes through.
    """
    sensor, opening = booked_under(knowledge), Stopwatch()
    broken = _start(estimator, knowledge, opening)
    rows, extras = [], []
    for done, frame in enumerate(dataset.frames, start=1):
        watch = Stopwatch()
        result = _crashed(sensor, broken) if broken else _step(estimator, dataset.observation(frame), knowledge, sensor, watch)
        rows.append(_row(frame, result, watch))
        named = {name: float(value) for name, value in result.extras.items()}
        extras.append({"frame": frame, "sensor": result.sensor, "reason": result.reason, **named})
        if progress is not None:
            progress(done, len(dataset.frames))
    timed = record.model_copy(update={"start_cpu_s": opening.cpu_s, "start_wall_s": opening.wall_s})
    return Predictions(timed, pd.DataFrame(rows, columns=list(COLUMNS)), pd.DataFrame(extras))


def booked_under(knowledge: Knowledge) -> str:
    """The sensor that a crash counts for: a rig's left camera, the first camera, or the first LIDAR where no feature is told of."""
    if knowledge.pair is not None:
        return knowledge.pair.left
    if knowledge.lidars and (knowledge.rectangle is None or not knowledge.sensors):
        return next(iter(knowledge.lidars))
    return next(iter(knowledge.sensors))


def could_not_start(answers: Predictions) -> bool:
    """Whether ``start`` itself failed, so that no frame was ever asked."""
    reasons = reasons_of_failure(answers)
    return bool(reasons) and all(reason.startswith(_IN_START) for reason in reasons)


def reasons_of_failure(answers: Predictions) -> list[str]:
    """The distinct reasons, in the order in which they came, where every frame failed; none where one was answered."""
    if answers.extras is None or (answers.table["outcome"] == Outcome.OK.value).any():
        return []
    return [reason for reason in answers.extras["reason"].unique().tolist() if reason]


def _start(estimator: Estimator, knowledge: Knowledge, watch: Stopwatch) -> str:
    """Why the method could not start, empty if it did."""
    try:
        with watch.running():
            estimator.start(knowledge)
    except (Exception, SystemExit) as error:
        return f"{_IN_START}{type(error).__name__}: {error}"
    return ""


def _step(estimator: Estimator, observation: Observation, knowledge: Knowledge, sensor: str, watch: Stopwatch) -> Estimate:
    try:
        with watch.running():
            result = estimator.step(observation)
    except (Exception, SystemExit) as error:
        return _crashed(sensor, f"{type(error).__name__}: {error}")
    return _checked(result, knowledge, sensor)


def _checked(result: object, knowledge: Knowledge, sensor: str) -> Estimate:
    """``result`` where it keeps the contract, else a crash that says how it breaks it."""
    if not isinstance(result, Estimate):
        return _crashed(sensor, f"step returned {type(result).__name__}, not an Estimate")
    if result.sensor not in {*knowledge.sensors, *knowledge.lidars}:
        return _crashed(sensor, f"step answered for the unknown sensor {result.sensor!r}")
    pose = [] if result.sensor_from_target is None else result.sensor_from_target.as_quat().ravel().tolist()
    position = [] if result.translation_m is None else np.asarray(result.translation_m).ravel().tolist()
    if len(pose) not in (0, 4) or len(position) not in (0, 3) or not all(math.isfinite(x) for x in pose + position):
        return _crashed(sensor, "step answered with a pose that is not one finite rotation and position")
    fault = _fault_of_extras(result.extras)
    return _crashed(sensor, f"step answered with {fault}") if fault else result


def _fault_of_extras(extras: object) -> str:
    """What is wrong with a method's extras, empty if they are named numbers under names of their own."""
    if not isinstance(extras, Mapping):
        return f"extras that are a {type(extras).__name__}, not named numbers"
    for name, value in extras.items():
        if not isinstance(name, str) or name in _TAKEN:
            return f"the extra {name!r}; a name is a text other than {', '.join(_TAKEN)}"
        if not _is_number(value):
            return f"the extra {name!r} = {value!r}, which is not a number"
    return ""


def _is_number(value: object) -> bool:
    if not isinstance(value, Real | np.bool_):
        return False
    try:
        float(value)
    except (OverflowError, ValueError):  # a whole number of more than 308 digits
        return False
    return True


def _crashed(sensor: str, reason: str) -> Estimate:
    return Estimate(sensor, Outcome.CRASHED, reason=reason)


def _row(frame: int, result: Estimate, watch: Stopwatch) -> dict[str, object]:
    empty = dict.fromkeys((*QUATERNION, *TRANSLATION), float("nan"))
    if result.sensor_from_target is not None:
        quaternion = result.sensor_from_target.as_quat(canonical=True, scalar_first=True)
        empty |= dict(zip(QUATERNION, np.ravel(quaternion).tolist(), strict=True))
    if result.sensor_from_target is not None and result.translation_m is not None:
        empty |= dict(zip(TRANSLATION, np.ravel(result.translation_m).tolist(), strict=True))
    timing = {"cpu_s": watch.cpu_s, "wall_s": watch.wall_s}
    return {"frame": frame, "sensor": result.sensor, "outcome": result.outcome.value, **empty, **timing}


def refuse_to_mix(out: Path, record: RunRecord) -> None:
    """Raises ``ResultsConflict`` where ``out`` holds answers that ``record`` does not describe; a run may be repeated."""
    if not (out / predictions.RECORD).exists():
        if out.exists() and any(out.iterdir()):
            raise ResultsConflict(f"{out} is not empty and holds no run.json; choose another folder")
        return
    there = predictions.read_record(out)
    for name in ("method", "parameters", "dataset_identity", "knowledge"):
        old, new = getattr(there, name), getattr(record, name)
        if old != new:
            raise ResultsConflict(f"{out} holds the answers of another run ({name}: {old} there, {new} now); choose another folder")
