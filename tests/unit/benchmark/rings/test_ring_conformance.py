"""The conformance suite on a ring: two cameras, a target frame that turns and moves, CPU times that never repeat."""

from collections.abc import Callable
from typing import Any

import pytest

from benchmark.conformance import faults
from benchmark.knowledge import declare
from estimators import registry
from estimators.api import Estimate
from scenes.dataset import Dataset
from scenes.recording import Knowledge, Observation

Recording = tuple[Knowledge, list[Observation]]


def _recording(dataset: Dataset, count: int) -> Recording:
    return declare(dataset, "ring").knowledge, [dataset.observation(frame) for frame in dataset.frames[:count]]


@pytest.fixture(scope="module")
def large(make_stereo: Callable[..., Dataset], tmp_path_factory: pytest.TempPathFactory) -> Recording:
    """The size of picture that the registered methods are made for."""
    return _recording(make_stereo(tmp_path_factory.mktemp("large") / "ring", frames=range(5), width_px=2048), 5)


@pytest.mark.parametrize("name", [name for name in registry.names() if "ring" in name])
def test_every_registered_stereo_method_conforms(name: str, large: Recording) -> None:
    assert faults(lambda: registry.load(name), *large) == []


def test_the_toy_method_conforms_although_its_times_differ(stereo: Dataset, lookup: Any) -> None:
    assert faults(lambda: lookup(stereo), *_recording(stereo, 6)) == []


def test_an_answer_that_stays_at_the_rings_centre_is_found_out(stereo: Dataset, lookup: Any) -> None:
    found = faults(lambda: lookup(stereo, mischief="own origin"), *_recording(stereo, 6))
    assert found == ["frame 0: a re-labelled target frame leaves the answer 0.616 m from where it should be"]


def test_an_extra_that_is_no_time_has_to_repeat(stereo: Dataset, lookup: Any) -> None:
    calls = iter(range(1000))
    found = faults(lambda: lookup(stereo, extras=lambda _: {"radius_m": float(next(calls))}), *_recording(stereo, 3))
    assert found == ["the same input gives another output (first in frame 0)"]


def test_both_cameras_are_blackened(stereo: Dataset, lookup: Any) -> None:
    class OneEyed(type(lookup(stereo))):  # type: ignore[misc]
        def step(self, observation: Observation) -> Estimate:
            if not observation.images["stereo-right"].pixels.any():
                raise IndexError("nothing in the right picture")
            return super().step(observation)  # type: ignore[no-any-return]

    places = lookup(stereo).places
    found = faults(lambda: OneEyed(places), *_recording(stereo, 4))
    assert any("a black picture in frame 0: it raises IndexError: nothing in the right picture" in one for one in found)
