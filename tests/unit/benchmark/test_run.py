"""Loop 1: observations only, exceptions become rows, timings are kept apart, nothing is mixed."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmark.errors import ResultsConflict
from benchmark.knowledge import declare
from benchmark.predictions import Predictions, write
from benchmark.records import RunRecord
from benchmark.run import answer, refuse_to_mix
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
