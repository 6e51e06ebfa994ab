"""Results as a bench leaves them, small: two methods on the panel, one with a name that would like to be more than a name."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmark import judge, ranking, results
from benchmark.pool import pool
from benchmark.predictions import read
from benchmark.results import CaseHeading, Entry, Results
from scenes.dataset import Dataset

HOSTILE = "[bold]b[/nothing]\x1b[31m :smile:"
METHODS = {"steady": (0.5, 2), HOSTILE: (3.0, 0)}  # size of the error in degrees, frames at the end without an answer


def _bench(dataset: Dataset, out: Path, submit: Callable[..., Path]) -> Path:
    """Each method's answers are the truth turned by as much as a repeatable draw says."""
    entries = []
    for place, (method, (size_deg, lost)) in enumerate(METHODS.items()):
        path = f"entries/panel/{place}"
        drawn = np.random.default_rng(1).normal(size=(len(dataset.frames), 3))
        turns = Rotation.from_rotvec(np.radians(size_deg) * drawn)
        folder = submit(dataset, out / path, method, turns, lost, cpu_s="0.01")
        judge.write(folder, judge.judge(read(folder), dataset))
        entries.append(Entry(case="panel", feature="panel", title=method, dataset="datasets/panel", answers=path, scores=path))
    index = Results(title="Two on a panel", cases=(CaseHeading(name="panel"),), entries=tuple(entries))
    results.write(out, index)
    ranking.write(out, ranking.ranking(pool(out, index)))
    (out / "report.html").write_text("<!doctype html><title>the page</title>")
    return out


@pytest.fixture(scope="session")
def make_results(make_dataset: Callable[..., Dataset], submit: Callable[..., Path]) -> Callable[..., Path]:
    """make_results(path, seed=0, ...) → the folder of a bench on a data set of its own."""

    def make(path: Path, **data: Any) -> Path:
        return _bench(make_dataset(path / "datasets" / "panel", **data), path, submit)

    return make


@pytest.fixture(scope="session")
def _benched(make_results: Callable[..., Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_results(tmp_path_factory.mktemp("benched") / "out")


@pytest.fixture
def out(_benched: Path, tmp_path: Path) -> Path:
    """A bench's folder that a test may spoil."""
    shutil.copytree(_benched, tmp_path / "out")
    return tmp_path / "out"
