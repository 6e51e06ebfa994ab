"""A suite over seeds from end to end with a toy method: data sets, entries and their index, by one process or by two."""

import json
from pathlib import Path

import pytest

from benchmark import results
from benchmark.bench import bench
from benchmark.leaderboard import rows
from benchmark.suite import load_suite

METHOD = '''
"""Answers the middle of the cloud and no attitude that changes."""
import numpy as np
from scipy.spatial.transform import Rotation
from estimators.api import Estimate, Outcome


class Centroid:
    """The mean of a scan's points as the position, and an attitude that never changes: a toy."""

    def __init__(self, shift_m=(0.0, 0.0)):
        self.shift_m = shift_m

    def start(self, knowledge):
        (self.name,) = knowledge.lidars
        self.told = knowledge.model is not None

    def step(self, observation):
        points = observation.scans[self.name].points_lidar
        points = points[np.isfinite(points).all(axis=-1)].astype(float)
        told = {"told": float(self.told), "cpu_icp_s": 1e-3}
        return Estimate(self.name, Outcome.OK, Rotation.identity(), points.mean(axis=0), extras=told)
'''
SUITE = """
title = "t"
description = "d"
[methods.told]
estimator = "toy_centroid:Centroid"
model = true
parameters = { shift_m = [0.5, 0.25] }
[methods.untold]
estimator = "toy_centroid:Centroid"
[[cases]]
name = "near"
scenario = "near.toml"
seeds = [3, 5]
"""
SCENARIO = """
frame_count = 3
[target]
[[target.parts]]
name = "body"
shape = { type = "box", size_m = [2.0, 1.5, 1.0] }
material = "white-paint"
[lidars.lidar]
gate_m = [1, 150]
[lidars.lidar.pattern]
type = "flash"
columns = 16
rows = 16
field_deg = [10.0, 10.0]
[lidars.lidar.beam]
wavelength_nm = 1064.0
divergence_mrad = 1.0
sub_rays = 1
[lidars.lidar.ranging]
type = "paper"
sigma_m = 0.05
[motion]
type = "spin"
position_m = [0.0, 0.0, 20.0]
"""


@pytest.mark.slow
def test_seeds_are_data_sets_and_entries_whoever_makes_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "toy_centroid.py").write_text(METHOD)
    (tmp_path / "suite.toml").write_text(SUITE)
    (tmp_path / "near.toml").write_text(SCENARIO)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    suite = load_suite(str(tmp_path / "suite.toml"))
    alone, both = tmp_path / "alone", tmp_path / "both"
    index = bench(suite, alone)
    assert [(one.case, one.title) for one in index.entries] == [(f"near-seed{s}", t) for s in (3, 5) for t in ("told", "untold")]
    assert index.bases == {"near-seed3": "near", "near-seed5": "near"}
    assert results.read(alone) == index
    every = list(rows(alone, index))
    assert [row.summary.answered for row in every] == [3, 3, 3, 3]
    gauges = [row.summary.filter.gauge for row in every if row.summary.filter is not None]
    assert gauges == ["target", "own, aligned on frame 0"] * 2
    seeds = [json.loads((alone / f"datasets/near-seed{seed}/manifest.json").read_text())["seed"] for seed in (3, 5)]
    assert seeds == [3, 5]
    bench(suite, both, workers=2)
    for entry in index.entries:  # times differ, answers do not
        one, two = ((folder / entry.answers / "predictions.csv").read_text().splitlines() for folder in (alone, both))
        assert [line.split(",")[:10] for line in one] == [line.split(",")[:10] for line in two]
    assert bench(suite, both) == results.read(both)  # once more into the same folder: the same runs
