"""From a folder of answers to its rank: SPEED's thresholds, a CSV without times, what the verbs write and print."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmark import judge, results, verbs
from benchmark.console import Console
from benchmark.pool import pool
from benchmark.predictions import read
from benchmark.ranking import read as read_ranking
from benchmark.results import CaseHeading, Entry, Results
from scenes.dataset import Dataset


def _about_y(turn_deg: float) -> Rotation:
    """A turn about the target's Y."""
    return Rotation.from_euler("y", turn_deg, degrees=True)


@pytest.mark.parametrize(("turn_deg", "score"), [(0.0, 0.0), (0.168, 0.0), (0.170, 0.002967), (4.0, 0.069813)])
def test_speeds_threshold_holds_from_the_answers_to_the_ranking(
    dataset: Dataset, submit: Callable[..., Path], tmp_path: Path, turn_deg: float, score: float
) -> None:
    answers = submit(dataset, tmp_path / "answers", "oracle", _about_y(turn_deg))
    verbs.judge(answers, dataset.path, tmp_path / "out", 0.0, Console(quiet=True))
    ((standing,),) = (division.methods for division in read_ranking(tmp_path / "out").divisions)
    assert standing.charge.value == pytest.approx(score, abs=5e-7)
    assert standing.rotation_median_deg.value == pytest.approx(turn_deg, abs=1e-6)
    assert (standing.rank, standing.answered, standing.wrong.value) == (1, len(dataset.frames), float(turn_deg > 5.0))
    assert standing.cpu_ms is None
    assert standing.position_median_m is None


def test_three_submissions_are_ranked_and_printed_whatever_they_are_called(
    dataset: Dataset, submit: Callable[..., Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two within the threshold tie; one that leaves out two frames of 21 is charged two guesses."""
    entries = []
    for place, (method, turn_deg, lost) in enumerate([("[bold]a[/nothing]", 0.1, 0), ("b\x1b[31m", 0.05, 0), ("c", 1.0, 2)]):
        folder = submit(dataset, tmp_path / str(place), method, _about_y(turn_deg), lost)
        judge.write(folder, judge.judge(read(folder), dataset))
        entries.append(Entry(case="panel", feature="panel", title=method, dataset="d", answers=str(place), scores=str(place)))
    index = Results(title="three", cases=(CaseHeading(name="panel"),), entries=tuple(entries))
    results.write(tmp_path, index)
    assert len(pool(tmp_path, index)) == 3 * len(dataset.frames)
    verbs._rank(tmp_path, index, Console(quiet=True))
    (division,) = read_ranking(tmp_path).divisions
    assert [(one.rank, one.is_tied) for one in division.methods] == [(1, True), (1, True), (3, False)]
    guess, frames = np.pi / 2 + 2 / np.pi, len(dataset.frames)
    assert division.methods[2].charge.value == pytest.approx(((frames - 2) * np.radians(1.0) + 2 * guess) / frames)
    printed = capsys.readouterr().out
    assert "1= [bold]a[/nothing]" in printed
    assert "1= b\N{REPLACEMENT CHARACTER}[31m" in printed
    assert "\x1b" not in printed
    assert "3  c" in printed
    assert "mono: panel (panel); 1 track, 21 frames" in printed
