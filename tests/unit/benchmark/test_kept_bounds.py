"""Bounds that are kept: found once, gone on with after a kill, never another data set's, and read by the judge."""

from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import Rotation

from benchmark import freshness, judge, predictions
from benchmark.errors import PredictionsError
from benchmark.information import kept, table
from benchmark.information.achieved import achieved
from benchmark.information.fisher import AXES
from scenes.dataset import Dataset

_TURN_RAD = 1e-3


@pytest.fixture
def found(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The frames whose bounds were found, in order; every one has σ = 1 mrad and 1 mm about each axis."""
    frames: list[int] = []

    def rows(
        dataset: Dataset, lacking: Sequence[int], sensors: Sequence[str], progress: Any = None, **how: Any
    ) -> Iterator[list[dict[str, Any]]]:
        upper = {f"information_{AXES[a]}_{AXES[b]}": 1e6 * (a == b) for a, b in table.UPPER}
        sums = {"sigma_rotation_rad": np.sqrt(3) * 1e-3, "sigma_position_m": np.sqrt(3) * 1e-3}
        for frame in lacking:
            frames.append(frame)
            yield [{"frame": frame, "sensor": sensor, **upper, **sums} for sensor in sensors]

    monkeypatch.setattr(table, "frame_rows", rows)
    return frames


@pytest.fixture
def dataset(make_dataset: Callable[..., Dataset], tmp_path: Path) -> Dataset:
    return make_dataset(tmp_path / "data", frames=range(8))


def test_what_is_there_is_not_found_again_and_what_is_not_is_added(dataset: Dataset, found: list[int]) -> None:
    first = kept.completed(dataset, dataset.path, [0, 4], ["nav"], samples=8)
    whole = kept.completed(dataset, dataset.path, [0, 2, 4], ["nav"], samples=8)
    again = kept.completed(dataset, dataset.path, [0, 2], ["nav"], samples=8)
    assert (found, list(first["frame"]), list(whole["frame"]), list(again["frame"])) == ([0, 4, 2], [0, 4], [0, 2, 4], [0, 2])
    there = kept.read(dataset)
    assert there is not None
    assert list(there["frame"]) == [0, 2, 4]
    truth = dataset.truth_table().merge(there, on=["frame", "sensor"], how="left")
    assert truth["sigma_rotation_rad"].notna().sum() == 3


def test_another_number_of_samples_begins_anew(dataset: Dataset, found: list[int]) -> None:
    for samples in (8, 16):
        kept.completed(dataset, dataset.path, [0, 1], ["nav"], samples=samples)
    assert found == [0, 1, 0, 1]


def test_a_run_that_was_ended_goes_on(dataset: Dataset, found: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept, "_OFTEN_S", 0.0)
    whole_run = table.frame_rows

    def killed(*asked: Any, **how: Any) -> Iterator[list[dict[str, Any]]]:
        yield from islice(whole_run(*asked, **how), 5)
        raise KeyboardInterrupt

    monkeypatch.setattr(table, "frame_rows", killed)
    with pytest.raises(KeyboardInterrupt):
        kept.completed(dataset, dataset.path, dataset.frames, ["nav"], samples=8)
    monkeypatch.setattr(table, "frame_rows", whole_run)
    whole = kept.completed(dataset, dataset.path, dataset.frames, ["nav"], samples=8)
    assert found == dataset.frames
    assert list(whole["frame"]) == dataset.frames


def test_bounds_of_another_data_set_and_damaged_ones_are_refused(
    dataset: Dataset, make_dataset: Callable[..., Dataset], found: list[int], tmp_path: Path
) -> None:
    assert kept.read(dataset) is None
    other = make_dataset(tmp_path / "other", frames=range(8), seed=1)
    kept.completed(other, dataset.path, [0], ["nav"], samples=8)
    with pytest.raises(PredictionsError, match="not of this data set"):
        kept.read(dataset)
    (dataset.path / kept.BOUNDS).write_bytes(b"PAR1 and no more")
    with pytest.raises(PredictionsError, match="damaged"):
        kept.read(dataset)


def test_the_judge_reads_the_data_sets_own_bounds_and_judges_again_when_there_are_any(
    dataset: Dataset, found: list[int], submit: Callable[..., Path], tmp_path: Path
) -> None:
    """Answers that are one milliradian off, the σ of each axis: ωᵀ C⁻¹ ω = 1."""
    folder = submit(dataset, tmp_path / "a", "a", Rotation.from_rotvec([_TURN_RAD, 0, 0]))
    given = predictions.read(folder)
    judge.write(folder, judge.judge(given, dataset))
    freshness.mark_judged(folder, dataset, 0.0)
    assert freshness.is_judged(folder, dataset, 0.0)
    assert "bound_rotation_rad" not in pd.read_parquet(folder / judge.SCORES)
    kept.completed(dataset, dataset.path, [0, 3], ["nav"], samples=8)
    assert not freshness.is_judged(folder, dataset, 0.0)
    scores = judge.judge(given, dataset).scores.set_index("frame")
    assert list(scores.index[scores["bound_rotation_rad"].notna()]) == [0, 3]
    assert scores["bound_chi2_attitude"][[0, 3]].to_numpy() == pytest.approx(1.0, rel=1e-6)


def test_answers_that_take_another_labelling_are_held_against_the_bound_as_the_judge_takes_them(
    dataset: Dataset, found: list[int], submit: Callable[..., Path], tmp_path: Path
) -> None:
    bounds = kept.completed(dataset, dataset.path, dataset.frames, ["nav"], samples=8)
    turned = Rotation.from_rotvec([np.pi, 0, 0]) * Rotation.from_rotvec([0, _TURN_RAD, 0])
    (line,) = achieved(predictions.read(submit(dataset, tmp_path / "a", "a", turned)), dataset, bounds)
    assert (line.sensor, line.frames, line.pose, line.attitude) == ("nav", 8, None, None)  # of eight frames there is no efficiency
    assert line.excess == pytest.approx(1 / np.sqrt(3), rel=1e-6)
