"""LIDAR methods in the loop: which sensor a crash is booked under, and the promises that every one of them has to keep."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.conformance import faults
from benchmark.judge import judge
from benchmark.knowledge import declare
from benchmark.records import RunRecord
from benchmark.run import answer, booked_under
from estimators.api import Estimate, Outcome
from scenes.dataset import Dataset
from scenes.recording import Knowledge, ModelCloud, Observation


class Lookup:
    """A toy method that looks the pose up by the frame's number, and finds the axes of the model that it is told by Kabsch."""

    def __init__(self, places: dict[int, RigidTransform], known: ModelCloud | None, mischief: str = "") -> None:
        self._places, self._known, self._mischief, self._begun = places, known, mischief, False
        self._told_from_known = RigidTransform.identity()

    def start(self, knowledge: Knowledge) -> None:
        self._begun = False
        (self._name,) = knowledge.lidars
        if self._known is None or self._mischief == "own axes":
            return
        assert knowledge.model is not None
        if self._mischief == "writes" and knowledge.model.points_target.flags.writeable:
            knowledge.model.points_target[0] += 1.0
        told, known = knowledge.model.points_target, self._known.points_target
        turned, _ = Rotation.align_vectors(told - told.mean(axis=0), known - known.mean(axis=0))
        self._told_from_known = RigidTransform.from_components(told.mean(axis=0) - turned.apply(known.mean(axis=0)), turned)

    def step(self, observation: Observation) -> Estimate:
        scan = observation.scans[self._name]
        if self._mischief == "raise" and observation.frame == 1:
            raise ZeroDivisionError("division by zero")
        if self._mischief == "nothing":
            return None  # type: ignore[return-value]
        if self._mischief == "mutate" and scan.points_lidar.flags.writeable:
            scan.points_lidar[:] = 0.0
        sensor = "nav" if self._mischief == "sensor" else self._name
        seen = np.isfinite(scan.points_lidar).any()
        if not seen and self._mischief == "empty raises":
            raise IndexError("list index out of range")
        if not seen and not self._begun and self._mischief != "identity":
            return Estimate(sensor, Outcome.NO_FEATURES, reason="" if self._mischief == "silent" else "no return")
        self._begun = True
        pose = self._places[observation.frame] * self._told_from_known.inv()
        told = {"predicted": float(not seen)} if self._mischief != "identity" else {}
        times = {"cpu_icp_s": float(np.random.default_rng().random())}
        return Estimate(sensor, Outcome.OK, pose.rotation, pose.translation, extras=told | times)


def _places(dataset: Dataset) -> dict[int, RigidTransform]:
    return {frame: dataset.truth(frame).sensor_from_target["lidar"] for frame in dataset.frames}


@pytest.fixture(scope="module")
def recording(lidar_dataset: Dataset) -> tuple[Knowledge, Sequence[Observation]]:
    told = declare(lidar_dataset, grant_model=True).knowledge
    return told, [lidar_dataset.observation(frame) for frame in lidar_dataset.frames[:6]]


def test_answers_for_a_lidar_are_kept_and_judged(lidar_dataset: Dataset) -> None:
    declared = declare(lidar_dataset, grant_model=True)
    record = RunRecord(
        format="hardlight-predictions", version=1, method="toy", dataset_identity=lidar_dataset.identity, knowledge=declared.record
    )
    answers = answer(Lookup(_places(lidar_dataset), declared.knowledge.model), lidar_dataset, declared.knowledge, record)
    assert set(answers.table["sensor"]) == {"lidar"}
    assert (answers.table["outcome"] == "ok").all()
    (summary,) = judge(answers, lidar_dataset).summaries
    assert summary.filter is not None
    assert (summary.wrong, summary.filter.gauge) == (0, "target")


@pytest.mark.parametrize(
    ("mischief", "frames", "sentence"),
    [
        ("raise", [1], "ZeroDivisionError: division by zero"),
        ("nothing", range(40), "step returned NoneType, not an Estimate"),
        ("sensor", range(40), "step answered for the unknown sensor 'nav'"),
    ],
)
def test_a_crash_is_booked_under_the_lidar(lidar_dataset: Dataset, mischief: str, frames: Sequence[int], sentence: str) -> None:
    declared = declare(lidar_dataset)
    record = RunRecord(format="hardlight-predictions", version=1, method="toy", dataset_identity=lidar_dataset.identity)
    answers = answer(Lookup(_places(lidar_dataset), None, mischief), lidar_dataset, declared.knowledge, record)
    crashed = answers.table[answers.table["outcome"] == "crashed"]
    assert set(crashed["sensor"]) == {"lidar"}
    assert crashed["frame"].to_list() == list(frames)
    assert answers.extras is not None
    assert sentence in set(answers.extras["reason"])


def test_which_sensor_a_crash_counts_for(dataset: Dataset, lidar_dataset: Dataset) -> None:
    camera, lidar = declare(dataset, "panel").knowledge, declare(lidar_dataset).knowledge
    assert booked_under(camera) == "nav"
    assert booked_under(lidar) == "lidar"
    assert booked_under(replace(camera, lidars=lidar.lidars)) == "nav"  # it is told of a rectangle, which cameras measure
    assert booked_under(replace(lidar, sensors=camera.sensors)) == "lidar"


def test_an_honest_method_conforms(recording: Any, lidar_dataset: Dataset) -> None:
    known = recording[0].model
    assert faults(lambda: Lookup(_places(lidar_dataset), known), *recording) == []


@pytest.mark.parametrize(
    ("mischief", "sentence"),
    [
        ("mutate", "frame 0: it writes into the scan of 'lidar'"),
        ("writes", "it writes into the model that it is told"),
        ("empty raises", "a scan without a return in frame 0: it raises IndexError: list index out of range after 0 frames"),
        ("silent", "a scan without a return in frame 0 fails without a reason"),
        ("identity", "a scan without a return in frame 3 is answered with a pose"),
        ("own axes", "frame 0: a re-labelled target frame turns the answer by"),
        ("sensor", "it answers for the unknown sensor 'nav'"),
    ],
)
def test_each_broken_promise_is_found(recording: Any, lidar_dataset: Dataset, mischief: str, sentence: str) -> None:
    known = recording[0].model
    found = faults(lambda: Lookup(_places(lidar_dataset), known, mischief), *recording)
    assert any(sentence in fault for fault in found), found


def test_a_method_without_a_model_conforms_too(lidar_dataset: Dataset, recording: Any) -> None:
    knowledge = replace(recording[0], model=None)
    assert faults(lambda: Lookup(_places(lidar_dataset), None), knowledge, recording[1]) == []


def test_parameters_with_lists_compare_with_what_was_read_back() -> None:
    """TOML's arrays come as tuples and JSON's as lists; a run that is repeated is the same run."""
    parameters = {"filter": {"guess": {"p": (3.0, 4.5), "omega": (0.1, (1, 2))}}}
    record = RunRecord(format="hardlight-predictions", version=1, method="m", dataset_identity="d", parameters=parameters)
    assert RunRecord.model_validate_json(record.model_dump_json()).parameters == record.parameters
