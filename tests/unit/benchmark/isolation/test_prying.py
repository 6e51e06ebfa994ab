"""A method that goes looking finds no truth and no way to the data set, where it would find both in the judge's own process."""

import pickle
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from benchmark.knowledge import declare
from benchmark.limits import Limits
from benchmark.run import estimate
from scenes.dataset import Dataset

Found = tuple[set[str], set[float]]


@pytest.fixture(scope="module")
def _prying_is_found(dataset: Dataset) -> Iterator[None]:
    """It can be imported, and the environment names the data set."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(Path(__file__).parent)
        patch.setenv("DATA", str(dataset.path))
        yield


@pytest.fixture(scope="module")
def apart(dataset: Dataset, tmp_path_factory: pytest.TempPathFactory, _prying_is_found: None) -> Found:
    """What it found in a process of its own."""
    return _found(dataset, tmp_path_factory.mktemp("apart"), Limits())


def _found(dataset: Dataset, folder: Path, limits: Limits | None) -> Found:
    parameters = {"notes": str(folder / "notes"), "from_frame": dataset.frames[-1]}
    answers = estimate("prying:Prying", parameters, dataset, declare(dataset, "panel"), folder / "out", limits=limits)
    assert set(answers.table["outcome"]) == {"skipped"}, answers.extras
    texts, numbers = pickle.loads((folder / "notes").read_bytes())
    return texts, {abs(number) for number in numbers}


def _truths(dataset: Dataset) -> set[float]:
    """Numbers that nothing but the truth has: parts of the frames' attitudes with many decimals."""
    poses = [dataset.truth(frame).sensor_from_target["nav"] for frame in dataset.frames]
    values = {abs(float(value)) for pose in poses for value in (*pose.rotation.as_quat(), *pose.rotation.as_matrix().ravel())}
    return {value for value in values if abs(value - round(value, 6)) > 1e-9}


def test_in_a_process_of_its_own_it_finds_neither(dataset: Dataset, apart: Found) -> None:
    texts, numbers = apart
    assert len(texts) > 1000
    assert len(_truths(dataset)) > 40
    assert [text for text in texts if str(dataset.path) in text or dataset.identity in text] == []
    assert numbers & _truths(dataset) == set()


def test_its_folder_is_empty_and_gone_afterwards(apart: Found) -> None:
    (folder,) = (text for text in apart[0] if re.fullmatch(r".*/hardlight-method-[^/]*", text))
    assert [text for text in apart[0] if text.startswith(f"{folder}/")] == []
    assert not Path(folder).exists()


@pytest.mark.usefixtures("_prying_is_found")
def test_the_control_in_the_judges_process_finds_both(dataset: Dataset, tmp_path: Path) -> None:
    truths = [dataset.truth(frame) for frame in dataset.frames]
    texts, numbers = _found(dataset, tmp_path, None)
    assert any(str(dataset.path) in text for text in texts)
    assert numbers & _truths(dataset)
    assert len(truths) == len(dataset.frames)  # they are there until now
