"""Results as a bench leaves them, small: two methods on the panel, one with a name that would like to be more than a name."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmark import judge, ranking, results
from benchmark.pool import pool
from benchmark.predictions import COLUMNS, read
from benchmark.results import CaseHeading, Entry, Results
from scenes.dataset import Dataset

HOSTILE = "[bold]b[/nothing]\x1b[31m :smile:"
METHODS = {"steady": (0.5, 2), HOSTILE: (3.0, 0)}  # size of the error in degrees, frames at the end without an answer


def _answer(dataset: Dataset, folder: Path, method: str, size_deg: float, lost: int) -> None:
    """The truth turned by as much as a repeatable draw says, as another program would write it."""
    truth = dataset.truth_table()
    turns = Rotation.from_rotvec(np.radians(size_deg) * np.random.default_rng(1).normal(size=(len(truth), 3)))
    rotation = Rotation.from_quat(truth[["qw", "qx", "qy", "qz"]].to_numpy(), scalar_first=True) * turns
    table = truth[["frame", "sensor"]].assign(outcome="ok", cpu_s="0.01", wall_s="", tx_m="", ty_m="", tz_m="")
    table[["qw", "qx", "qy", "qz"]] = rotation.as_quat(scalar_first=True, canonical=True)
    table = table[list(COLUMNS)].astype(object)
    if lost:
        table.iloc[-lost:, 2:] = ["no_features", *[""] * (len(COLUMNS) - 3)]
    folder.mkdir(parents=True)
    table.to_csv(folder / "predictions.csv", index=False)
    record = {"format": "hardlight-predictions", "version": 1, "method": method, "dataset_identity": dataset.identity}
    (folder / "run.json").write_text(json.dumps(record))
    judge.write(folder, judge.judge(read(folder), dataset))


def _bench(dataset: Dataset, out: Path) -> Path:
    entries = []
    for place, (method, (size_deg, lost)) in enumerate(METHODS.items()):
        path = f"entries/panel/{place}"
        _answer(dataset, out / path, method, size_deg, lost)
        entries.append(Entry(case="panel", feature="panel", title=method, dataset="datasets/panel", answers=path, scores=path))
    index = Results(title="Two on a panel", cases=(CaseHeading(name="panel"),), entries=tuple(entries))
    results.write(out, index)
    ranking.write(out, ranking.ranking(pool(out, index)))
    (out / "report.html").write_text("<!doctype html><title>the page</title>")
    return out


@pytest.fixture(scope="session")
def make_results(make_dataset: Callable[..., Dataset]) -> Callable[..., Path]:
    """make_results(path, seed=0, ...) → the folder of a bench on a data set of its own."""

    def make(path: Path, **data: Any) -> Path:
        return _bench(make_dataset(path / "datasets" / "panel", **data), path)

    return make


@pytest.fixture(scope="session")
def _benched(make_results: Callable[..., Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_results(tmp_path_factory.mktemp("benched") / "out")


@pytest.fixture
def out(_benched: Path, tmp_path: Path) -> Path:
    """A bench's folder that a test may spoil."""
    shutil.copytree(_benched, tmp_path / "out")
    return tmp_path / "out"
