"""Loop 1: observations only, exceptions become rows, timings are kept apart, nothing is mixed."""

import dataclasses
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmark.errors import ResultsConflict
from benchmark.knowledge import declare
from benchmark.predictions import Predictions, read, write
from benchmark.records import RunRecord
from benchmark.run import answer, could_not_start, reasons_of_failure, refuse_to_mix
from estimators.api import Estimate, Outcome
from scenes.dataset import Dataset
from scenes.recording import Knowledge, Observation


def _record(dataset: Dataset, **more: Any) -> RunRecord:
    return RunRecord(format="hardlight-predictions", version=1, method="toy", dataset_identity=dataset.identity, **more)


def _run(dataset: Dataset, estimator: Any) -> Predictions:
    return answer(estimator, dataset, declare(dataset, "panel").knowledge, _record(dataset))


def test_the_toy_method_answers_every_frame_near_the_truth(dataset: Dataset, toy: Any) -> None:
    answers = _run(dataset, toy())
    assert answers.table["frame"].tolist() == dataset.frames
    assert set(answers.table["outcome"]) == {"ok"}
    assert (answers.table["qw"] >= 0).all()
    assert (answers.table["wall_s"] > 0).all()
    assert answers.extras is not None
    assert answers.extras["corner_px"].between(0, 160).all()


@pytest.mark.parametrize(
    ("mischief", "frames", "reason"),
    [
        ("raise", [3], "ZeroDivisionError: division by zero"),
        ("nothing", [3], "step returned NoneType, not an Estimate"),
        ("start", list(range(21)), "start: RuntimeError: no licence"),
        ("sensor", list(range(21)), "step answered for the unknown sensor 'left'"),
        ("mutate", list(range(21)), "ValueError: assignment destination is read-only"),
    ],
)
def test_misbehaviour_is_a_row_with_its_reason(dataset: Dataset, toy: Any, mischief: str, frames: list[int], reason: str) -> None:
    answers = _run(dataset, toy(mischief))
    crashed = answers.table[answers.table["outcome"] == "crashed"]
    assert crashed["frame"].tolist() == frames
    assert crashed[["qw", "qx", "qy", "qz", "tx_m"]].isna().all(axis=None)
    assert answers.extras is not None
    assert set(answers.extras.loc[crashed.index, "reason"]) == {reason}
    assert len(answers.table) == len(dataset.frames)


def test_an_infinite_position_is_a_crash(dataset: Dataset, toy: Any) -> None:
    class Lost(toy):  # type: ignore[misc]
        def step(self, observation: Observation) -> Estimate:
            answer = super().step(observation)
            return Estimate("nav", Outcome.OK, answer.sensor_from_target, np.array([0.0, 0.0, np.inf]))

    assert set(_run(dataset, Lost()).table["outcome"]) == {"crashed"}


def test_start_and_step_are_timed_apart(dataset: Dataset, toy: Any) -> None:
    class Slow(toy):  # type: ignore[misc]
        def start(self, knowledge: Knowledge) -> None:
            super().start(knowledge)
            np.linalg.eigvals(np.random.default_rng(0).normal(size=(400, 400)))

    answers = _run(dataset, Slow())
    assert answers.record.start_wall_s is not None
    assert answers.record.start_wall_s > answers.table["wall_s"].median() * 5


def test_an_estimator_is_handed_nothing_but_observations_and_knowledge(dataset: Dataset, toy: Any) -> None:
    handed: list[object] = []

    class Spy(toy):  # type: ignore[misc]
        def start(self, *args: object) -> None:
            handed.extend(args)
            super().start(*args)

        def step(self, *args: object) -> Estimate:
            handed.extend(args)
            return super().step(*args)  # type: ignore[no-any-return]

    _run(dataset, Spy())
    assert {type(one) for one in handed} == {Knowledge, Observation}


@pytest.mark.parametrize("where", ["start", "step"])
def test_a_method_that_ends_the_process_crashes_only_itself(dataset: Dataset, toy: Any, where: str) -> None:
    class Quitter(toy):  # type: ignore[misc]
        pass

    def leave(*_: object) -> None:
        sys.exit("no licence")

    setattr(Quitter, where, leave)
    answers = _run(dataset, Quitter())
    assert set(answers.table["outcome"]) == {"crashed"}
    assert reasons_of_failure(answers) == [("start: " if where == "start" else "") + "SystemExit: no licence"]
    assert could_not_start(answers) == (where == "start")


def _with_extras(toy: Any, extras: Any) -> Any:
    class Talkative(toy):  # type: ignore[misc]
        def step(self, observation: Observation) -> Estimate:
            return dataclasses.replace(super().step(observation), extras=extras)

    return Talkative()


@pytest.mark.parametrize(
    ("extras", "reason"),
    [
        ({"frame": 3.0}, "step answered with the extra 'frame'; a name is a text other than frame, sensor, reason"),
        ({"reason": 1}, "the extra 'reason'; a name"),
        ({7: 1.0}, "the extra 7; a name is a text"),
        ({"edges": "four"}, "the extra 'edges' = 'four', which is not a number"),
        ({"edges": None}, "the extra 'edges' = None, which is not a number"),
        ({"edges": 10**400}, "which is not a number"),
        ([1.0], "step answered with extras that are a list, not named numbers"),
    ],
)
def test_extras_are_named_numbers_beside_our_columns(dataset: Dataset, toy: Any, tmp_path: Path, extras: Any, reason: str) -> None:
    answers = _run(dataset, _with_extras(toy, extras))
    assert set(answers.table["outcome"]) == {"crashed"}
    (told,) = reasons_of_failure(answers)
    assert reason in told
    write(tmp_path, answers)
    again = read(tmp_path).extras
    assert again is not None
    assert again.columns.tolist() == ["frame", "sensor", "reason"]
    assert again["frame"].tolist() == dataset.frames


def test_every_kind_of_number_is_an_extra(dataset: Dataset, toy: Any, tmp_path: Path) -> None:
    given = {"count": 4, "small": np.float32(0.5), "big": 10**30, "seen": np.bool_(True), "unknown": float("nan")}
    write(tmp_path, _run(dataset, _with_extras(toy, given)))
    extras = read(tmp_path).extras
    assert extras is not None
    assert extras[["count", "small", "big", "seen"]].iloc[3].tolist() == [4.0, 0.5, 1e30, 1.0]
    assert extras["unknown"].isna().all()


def test_ctrl_c_is_not_swallowed(dataset: Dataset, toy: Any) -> None:
    class Interrupted(toy):  # type: ignore[misc]
        def step(self, observation: Observation) -> Estimate:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        _run(dataset, Interrupted())


def test_the_same_run_may_be_repeated_and_another_is_refused(dataset: Dataset, toy: Any, tmp_path: Path) -> None:
    write(tmp_path, _run(dataset, toy()))
    refuse_to_mix(tmp_path, _record(dataset))
    with pytest.raises(ResultsConflict, match=r"parameters: \{\} there, \{'sigma': 2\} now"):
        refuse_to_mix(tmp_path, _record(dataset, parameters={"sigma": 2}))
    with pytest.raises(ResultsConflict, match="dataset_identity: "):
        refuse_to_mix(tmp_path, _record(dataset).model_copy(update={"dataset_identity": "other"}))


def test_a_folder_with_other_things_in_it_is_left_alone(dataset: Dataset, tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("precious")
    with pytest.raises(ResultsConflict, match=r"is not empty and holds no run.json"):
        refuse_to_mix(tmp_path, _record(dataset))
