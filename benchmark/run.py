"""Loop 1: a method answers every frame of a data set. It is handed observations and its declared knowledge, nothing else."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pandas as pd

from benchmark import methods, predictions
from benchmark.answer import Answer, Opening, crashed
from benchmark.errors import ResultsConflict
from benchmark.files import publish
from benchmark.guarded import IN_START, Answerer, Guarded, booked_under
from benchmark.isolation.session import Isolated
from benchmark.knowledge import Declaration
from benchmark.limits import Limits
from benchmark.machine import this_machine
from benchmark.predictions import COLUMNS, QUATERNION, TRANSLATION, Predictions
from benchmark.progress import Progress
from benchmark.records import RunRecord
from estimators import registry
from estimators.api import Estimator, Outcome
from scenes.dataset import Dataset
from scenes.errors import UsageError
from scenes.recording import Knowledge

__all__ = ["LOG", "answer", "booked_under", "could_not_start", "estimate", "reasons_of_failure", "refuse_to_mix"]

LOG = "log.txt"


def estimate(
    method: str,
    parameters: Mapping[str, Any],
    dataset: Dataset,
    declaration: Declaration,
    out: Path,
    *,
    label: str = "",
    progress: Progress | None = None,
    limits: Limits | None = Limits(),  # noqa: B008 - frozen
    forgiving: bool = False,
    reuse: bool = False,
) -> Predictions:
    """Runs the registered ``method`` over ``dataset`` and writes its answers to ``out``.

    With ``reuse`` answers are kept that the same sources gave to the same data set with the same parameters and knowledge.

    It runs in a process of its own within ``limits``; where these are None, in this one. With ``forgiving`` a method that cannot
    be loaded has crashed in every frame; without, that raises ``UsageError``. Raises ``ResultsConflict`` where ``out`` already
    holds the answers of something else: another method, other parameters, other knowledge or another data set.
    """
    record = RunRecord(
        format="hardlight-predictions",
        version=1,
        method=method,
        label=label,
        method_version=methods.version(method),
        method_source=methods.source_digest(method),
        parameters=dict(parameters),
        dataset_identity=dataset.identity,
        knowledge=declaration.record,
        machine=this_machine(),
    )
    refuse_to_mix(out, record)
    if reuse and _is_answered(out, record) and not could_not_start(kept := predictions.read(out)):
        return kept
    with _where_it_runs(method, parameters, dataset, limits) as one:
        answers = _answered(one, dataset, declaration.knowledge, record, progress, forgiving)
    predictions.write(out, answers)
    _write_log(out, one)
    return answers


def answer(
    estimator: Estimator, dataset: Dataset, knowledge: Knowledge, record: RunRecord, progress: Progress | None = None
) -> Predictions:
    """The loop in this process: start once, then one step a frame. An exception is the outcome ``crashed`` with its text.

    So is an attempt to end the process (sys.exit); Ctrl-C is the user's and goes through.
    """
    return _answered(Guarded(lambda: estimator), dataset, knowledge, record, progress)


def could_not_start(answers: Predictions) -> bool:
    """Whether ``start`` itself failed, so that no frame was ever asked."""
    reasons = reasons_of_failure(answers)
    return bool(reasons) and all(reason.startswith(IN_START) for reason in reasons)


def reasons_of_failure(answers: Predictions) -> list[str]:
    """The distinct reasons, in the order in which they came, where every frame failed; none where one was answered."""
    if answers.extras is None or (answers.table["outcome"] == Outcome.OK.value).any():
        return []
    return [reason for reason in answers.extras["reason"].unique().tolist() if reason]


def _is_answered(out: Path, record: RunRecord) -> bool:
    """Whether ``out`` holds what a run would write there again, but for the times."""
    if not record.method_source or not (out / predictions.RECORD).exists() or not (out / predictions.TABLE).exists():
        return False
    there = predictions.read_record(out)
    same = ("method", "label", "method_version", "method_source", "parameters", "dataset_identity", "knowledge")
    return all(getattr(there, name) == getattr(record, name) for name in same)


@contextmanager
def _where_it_runs(
    method: str, parameters: Mapping[str, Any], dataset: Dataset, limits: Limits | None
) -> Iterator[Isolated | Guarded]:
    if limits is None:
        yield Guarded(lambda: registry.load(method, **parameters), aloud=True)
        return
    with Isolated(method, parameters, limits, hidden=(dataset.path,)) as isolated:
        yield isolated


def _answered(
    one: Answerer,
    dataset: Dataset,
    knowledge: Knowledge,
    record: RunRecord,
    progress: Progress | None = None,
    forgiving: bool = False,
) -> Predictions:
    opening = _opened(one, knowledge, forgiving)
    rows, extras = [], []
    for done, frame in enumerate(dataset.frames, start=1):
        given = opening.failure or one.step(dataset.observation(frame))
        rows.append(_row(frame, given))
        extras.append({"frame": frame, "sensor": given.sensor, "reason": given.reason, **given.extras})
        if progress is not None:
            progress(done, len(dataset.frames))
    timed = record.model_copy(update={"start_cpu_s": opening.cpu_s, "start_wall_s": opening.wall_s})
    return Predictions(timed, pd.DataFrame(rows, columns=list(COLUMNS)), pd.DataFrame(extras))


def _opened(one: Answerer, knowledge: Knowledge, forgiving: bool) -> Opening:
    try:
        return one.start(knowledge)
    except UsageError as error:
        if not forgiving:
            raise
        return Opening(failure=crashed(booked_under(knowledge), f"{IN_START}{error}"))


def _row(frame: int, given: Answer) -> dict[str, object]:
    pose = dict.fromkeys((*QUATERNION, *TRANSLATION), float("nan"))
    pose |= dict(zip(QUATERNION, given.quaternion or (), strict=False))
    pose |= dict(zip(TRANSLATION, given.translation_m or (), strict=False))
    timing = {"cpu_s": given.cpu_s, "wall_s": given.wall_s}
    return {"frame": frame, "sensor": given.sensor, "outcome": given.outcome.value, **pose, **timing}


def _write_log(out: Path, one: Isolated | Guarded) -> None:
    """The end of what a method in a process of its own printed; no file where it printed nothing."""
    log = one.log if isinstance(one, Isolated) else b""
    if log:
        publish(out, {LOG: log})
    else:
        (out / LOG).unlink(missing_ok=True)


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
