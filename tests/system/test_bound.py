"""The information limit from end to end: kept in a data set's folder, joined to scores, and as efficiency on the leaderboard."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from benchmark import ranking
from benchmark.information import kept
from scenes.dataset import Dataset

SUITE = """
title = "efficiency"
description = "thirty-one scans, bounds of thirty of them"
quality = "draft"
bounds = "1:"
[methods.ours]
estimator = "lidar-ekf"
model = true
[[cases]]
name = "scans"
frames = "0:31"
scenario.base = "standard-lidar"
"""

pytestmark = pytest.mark.slow  # renders


@pytest.fixture(scope="module")
def data(tiny_dataset: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return Path(shutil.copytree(tiny_dataset, tmp_path_factory.mktemp("bound") / "tiny"))


def test_a_data_set_takes_its_bounds_and_verify_has_nothing_against_them(data: Path, hardlight: Callable[..., Any]) -> None:
    first = hardlight("bound", data, "--frames", "1:2", "--quiet")
    assert (first.status, first.err) == (0, "")
    assert f"{data / 'bounds.parquet'}: 1 rows" in first.out
    written = (data / kept.BOUNDS).stat().st_mtime_ns
    assert hardlight("bound", data, "--frames", "1", "--quiet").status == 0
    assert (data / kept.BOUNDS).stat().st_mtime_ns == written
    dataset = Dataset.open(data)
    found = kept.read(dataset)
    assert found is not None
    joined = dataset.truth_table().merge(found, on=["frame", "sensor"])
    assert list(joined["frame"]) == [1]
    assert (joined[[f"sigma_{axis}" for axis in ("wx", "wy", "wz", "tx", "ty", "tz")]].to_numpy() > 0).all()
    assert hardlight("verify", data).status == 0


def test_an_unknown_light_is_asked_for_and_bounds_lie_elsewhere_where_that_is_said(
    data: Path, hardlight: Callable[..., Any], tmp_path: Path
) -> None:
    assert hardlight("bound", data, "--frames", "1", "--light-direction", "--out", tmp_path, "--quiet").status == 0
    (row,) = pd.read_parquet(tmp_path / kept.BOUNDS).to_dict("records")
    assert row["sigma_rotation_rad_light_direction"] > 0.99 * row["sigma_rotation_rad"]


def test_verify_names_damaged_bounds_and_still_any_stranger(data: Path, hardlight: Callable[..., Any], tmp_path: Path) -> None:
    broken = Path(shutil.copytree(data, tmp_path / "broken"))
    (broken / "bounds.txt").write_text("mine")
    (broken / kept.BOUNDS).write_bytes(b"PAR1 and no more")
    said = hardlight("verify", broken)
    assert said.status == 1
    assert "bounds.txt: it does not belong to the data set" in said.out
    assert "bounds.parquet is damaged" in said.out
    assert "2 faults" in said.out


def test_a_suite_that_asks_for_bounds_has_efficiencies_and_finds_them_once(tmp_path: Path, hardlight: Callable[..., Any]) -> None:
    suite, out = tmp_path / "efficiency.toml", tmp_path / "out"
    suite.write_text(SUITE, encoding="utf-8")
    ended = hardlight("bench", suite, "--out", out, "--quiet")
    assert ended.status == 0
    assert "Efficiency: 1 where errors are" in ended.out
    (division,) = ranking.read(out).divisions
    (standing,) = division.methods
    assert standing.efficiency is not None
    assert standing.efficiency.value is not None
    assert standing.efficiency.low is not None
    assert 0 < standing.efficiency.low <= standing.efficiency.value < 2
    assert "1 is the limit" in (out / "report.html").read_text(encoding="utf-8")
    scores = pd.read_parquet(next(out.rglob("scores.parquet"))).set_index("frame")
    assert np.flatnonzero(scores["bound_position_m"].isna()).tolist() == [0]
    written = (out / "bounds" / "scans.parquet").stat().st_mtime_ns
    again = hardlight("bench", suite, "--out", out, "--quiet")
    assert again.status == 0
    assert (out / "bounds" / "scans.parquet").stat().st_mtime_ns == written
