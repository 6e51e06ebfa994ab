"""The suite passes an honest method and finds out each kind of dishonest one."""

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmark.conformance import faults
from benchmark.knowledge import declare
from estimators import registry
from estimators.api import Estimate, Outcome
from scenes.dataset import Dataset
from scenes.recording import Knowledge, Observation


@pytest.fixture(scope="module")
def recording(dataset: Dataset) -> tuple[Knowledge, list[Observation]]:
    # The panel is half as large as a wing of the paper's target, so the clicks are better too.
    return declare(dataset, "panel", sigma_px=1.0).knowledge, [dataset.observation(frame) for frame in dataset.frames[:8]]


@pytest.mark.parametrize("name", [name for name in registry.names() if name.startswith("mono-")])
def test_every_registered_method_of_a_rectangle_conforms(name: str, recording: Any) -> None:
    assert faults(lambda: registry.load(name), *recording) == []


def test_the_toy_method_conforms(toy: Any, recording: Any) -> None:
    assert faults(toy, *recording) == []


def _subclass(toy: Any, kind: str) -> Any:
    class Dishonest(toy):  # type: ignore[misc]
        calls = 0

        def step(self, observation: Observation) -> Estimate:  # noqa: PLR0911 - one return a misdeed
            if kind == "writes" and observation.images["nav"].pixels.flags.writeable:
                observation.images["nav"].pixels[0, 0] += 1
            answer = super().step(observation)
            if kind == "random" and answer.sensor_from_target is not None:
                noise = Rotation.from_rotvec(np.random.default_rng().normal(scale=1e-9, size=3))
                return Estimate("nav", Outcome.OK, noise * answer.sensor_from_target)
            if kind == "identity" and answer.outcome is not Outcome.OK:
                return Estimate("nav", Outcome.OK, Rotation.identity())
            if kind == "black raises" and answer.outcome is not Outcome.OK:
                raise IndexError("list index out of range")
            if kind == "silent" and answer.outcome is not Outcome.OK:
                return Estimate("nav", answer.outcome)
            if kind == "own axes" and answer.sensor_from_target is not None:
                assert self.knowledge is not None
                assert self.knowledge.rectangle is not None
                return Estimate("nav", Outcome.OK, answer.sensor_from_target * self.knowledge.rectangle.target_from_feature)
            if kind == "sensor":
                return Estimate("left", answer.outcome, answer.sensor_from_target, reason="x")
            if kind == "nothing":
                return None  # type: ignore[return-value]
            return answer  # type: ignore[no-any-return]

    return Dishonest


@pytest.mark.parametrize(
    ("kind", "sentence"),
    [
        ("writes", "frame 0: it writes into the picture of 'nav'"),
        ("random", "the same input gives another output"),
        ("identity", "a black picture in frame 0 is answered with a pose"),
        ("black raises", "a black picture in frame 0: it raises IndexError: list index out of range after 0 frames"),
        ("silent", "a black picture in frame 0 fails without a reason"),
        ("own axes", "a re-labelled target frame turns the answer by"),
        ("sensor", "it answers for the unknown sensor 'left'"),
        ("nothing", "step returns NoneType, not an Estimate"),
    ],
)
def test_each_broken_promise_is_found(toy: Any, recording: Any, kind: str, sentence: str) -> None:
    found = faults(_subclass(toy, kind), *recording)
    assert any(sentence in fault for fault in found), found


def test_a_method_that_never_answers_does_not_pass_by_silence(toy: Any, recording: Any) -> None:
    class Mute(toy):  # type: ignore[misc]
        def step(self, observation: Observation) -> Estimate:
            return Estimate("nav", Outcome.SKIPPED, reason="not today")

    assert faults(Mute, *recording) == ["it answers none of the 8 frames, so the rest cannot be checked"]


def test_a_method_that_cannot_start_is_one_sentence(toy: Any, recording: Any) -> None:
    assert faults(lambda: toy("start"), *recording) == ["the recording: it raises RuntimeError: no licence after 0 frames"]
