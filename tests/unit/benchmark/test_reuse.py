"""Answers are kept while nothing that they depend on has changed, and no longer."""

import sys
from pathlib import Path

import pytest

from benchmark import methods
from benchmark.knowledge import declare
from benchmark.predictions import Predictions
from benchmark.run import estimate
from scenes.dataset import Dataset
from scenes.errors import UsageError

SOURCE = """from estimators.api import Estimate, Outcome


class Silent:
    def __init__(self, word: str = "nothing") -> None:
        self._word = word

    def start(self, knowledge: object) -> None:
        if self._word == "ill":
            raise RuntimeError("ill today")

    def step(self, observation: object) -> Estimate:
        return Estimate("nav", Outcome.NO_FEATURES, reason=self._word)
"""


@pytest.fixture
def silent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A method of its own in the working directory."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "silent_method", raising=False)
    (tmp_path / "silent_method.py").write_text(SOURCE)
    return tmp_path


def _answers(dataset: Dataset, out: Path, *, reuse: bool, word: str = "nothing") -> Predictions:
    declared = declare(dataset, "panel")
    return estimate("silent_method:Silent", {"word": word}, dataset, declared, out, limits=None, forgiving=True, reuse=reuse)


def test_answers_are_kept_to_the_bit_and_given_again_when_asked(dataset: Dataset, silent: Path) -> None:
    first = _answers(dataset, silent / "out", reuse=False)
    kept, again = (_answers(dataset, silent / "out", reuse=reuse) for reuse in (True, False))
    assert kept.table["wall_s"].tolist() == first.table["wall_s"].tolist()
    assert again.table["wall_s"].tolist() != first.table["wall_s"].tolist()


def test_an_edited_method_answers_anew(dataset: Dataset, silent: Path) -> None:
    first = _answers(dataset, silent / "out", reuse=False)
    before = methods.source_digest("silent_method:Silent")
    (silent / "silent_method.py").write_text(SOURCE + "# edited\n")
    assert methods.source_digest("silent_method:Silent") != before
    assert _answers(dataset, silent / "out", reuse=True).table["wall_s"].tolist() != first.table["wall_s"].tolist()


def test_a_method_that_could_not_start_is_tried_again(dataset: Dataset, silent: Path) -> None:
    for _ in range(2):
        answers = _answers(dataset, silent / "out", reuse=True, word="ill")
        assert set(answers.table["outcome"]) == {"crashed"}
        assert answers.record.start_wall_s is not None
    first = answers.record.start_wall_s
    assert _answers(dataset, silent / "out", reuse=True, word="ill").record.start_wall_s != first


def test_every_method_of_ours_has_a_source() -> None:
    digests = {methods.source_digest(name) for name in ("mono-rectangle", "stereo-ring", "lidar-ekf")}
    assert len(digests) == 3
    assert "" not in digests
    assert methods.source_digest("no_such_module_anywhere:Class") == ""


def test_parameters_in_groups_and_names_that_are_both() -> None:
    given = methods.parameters_of(["filter.noise.rotation=1e-9", "filter.scale=2", "word=x"])
    assert given == {"filter": {"noise": {"rotation": 1e-9}, "scale": 2}, "word": "x"}
    with pytest.raises(UsageError, match="'word' was given a value"):
        methods.parameters_of(["word=x", "word.more=1"])
