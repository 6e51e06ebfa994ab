"""Suites of LIDAR cases: seeds, granted models, printed figures, and each mistake as a sentence."""

from pathlib import Path
from typing import Any

import pytest

from benchmark.suite import Suite, load_suite
from scenes.errors import ConfigError

GOOD = """
title = "t"
description = "d"
[methods.told]
estimator = "lidar-ekf"
model = true
[methods.untold]
estimator = "lidar-ekf"
[[cases]]
name = "tumble"
scenario = "tumble.toml"
frames = "0:10"
seeds = 3
[[published_filters]]
case = "tumble"
source = "a paper"
attitude_deg = 1.5
r_m = 0.3
reasons = { r = "because" }
"""
SCENARIO = """
frame_count = 20
target = "small-satellite"
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
[lidars.lidar.ranging]
type = "paper"
sigma_m = 0.05
[motion]
type = "spin"
position_m = [0.0, 0.0, 30.0]
"""
CAMERA = """
[cameras.nav]
base = "lab-4mp"
[lights.sun]
base = "sun"
frame = "chaser"
direction = [0.0, 0.0, -1.0]
"""


def _load(tmp_path: Path, text: str, scenario: str = SCENARIO) -> Suite:
    (tmp_path / "tumble.toml").write_text(scenario, encoding="utf-8")
    path = tmp_path / "suite.toml"
    path.write_text(text, encoding="utf-8")
    return load_suite(str(path))


def test_seeds_expand_a_case_into_data_sets_that_keep_its_name(tmp_path: Path) -> None:
    suite = _load(tmp_path, GOOD)
    (case,) = suite.cases
    assert [(run.name, run.base, run.seed) for run in case.runs] == [(f"tumble-seed{k}", "tumble", k) for k in range(3)]
    assert (case.features, case.lidar) == ((), None)
    assert (suite.methods["told"].model, suite.methods["untold"].model) == (True, False)
    listed = _load(tmp_path, GOOD.replace("seeds = 3", "seeds = [7, 11]"))
    assert [run.seed for run in listed.cases[0].runs] == [7, 11]
    single = _load(tmp_path, GOOD.replace("seeds = 3", "seed = 5"))
    assert [(run.name, run.base, run.seed) for run in single.cases[0].runs] == [("tumble", "tumble", 5)]


def test_printed_figures_are_in_the_units_of_the_states(tmp_path: Path) -> None:
    (printed,) = _load(tmp_path, GOOD).published_filters
    figures = {key: value for key, value in printed.figures.items() if value is not None}
    assert figures == {"attitude": 1.5, "r": 0.3}
    assert printed.reasons == {"r": "because"}


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("seeds = 3", "seeds = 3\nseed = 4", r"cases.0: a case has a seed or seeds, not both"),
        ("seeds = 3", "seeds = [1, 2, 1]", r"cases.0: seeds: the seed 1 is there twice"),
        ("seeds = 3", "seeds = 0", r"cases.0.seeds"),
        ("seeds = 3", "seeds = [-1]", r"cases.0.seeds"),
        ("seeds = 3", 'seeds = 3\nlidar = "ladar"', r"no LIDAR of the scenario is called 'ladar'; did you mean 'lidar'\?"),
        ("seeds = 3", 'seeds = 3\nfeatures = ["wing"]', r"no feature of the scenario's target is called 'wing'"),
        ("a paper", 'a paper"\nreasons2 = "', r"reasons2: no such key; did you mean 'reasons'\?"),
        ('reasons = { r = "because" }', 'reasons = { rr = "because" }', r"reasons: no state is called 'rr'"),
        ("attitude_deg = 1.5", "attitude_deg = 0.0", r"published_filters.0.attitude_deg: got 0.0, must be greater than 0"),
        ('case = "tumble"', 'case = "tumbles"', r"published: no case of this suite is called 'tumbles'; did you mean 'tumble'\?"),
        ("model = true", 'model = "yes, please"', r"methods.told.model"),
    ],
)
def test_each_mistake_is_a_sentence(tmp_path: Path, old: str, new: str, sentence: str) -> None:
    assert old in GOOD
    with pytest.raises(ConfigError, match=sentence):
        _load(tmp_path, GOOD.replace(old, new))


def test_a_case_called_like_one_seed_of_another_is_refused(tmp_path: Path) -> None:
    again = GOOD[GOOD.index("[[cases]]") : GOOD.index("[[published_filters]]")]
    with pytest.raises(ConfigError, match="two cases are called 'tumble-seed1'"):
        _load(tmp_path, GOOD + again.replace('"tumble"', '"tumble-seed1"').replace("seeds = 3", ""))


def test_beside_a_camera_the_lidar_has_to_be_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="the scenario has several sensors; name features or the lidar, one of lidar"):
        _load(tmp_path, GOOD, CAMERA_AND_LIDAR)
    named = _load(tmp_path, GOOD.replace("seeds = 3", 'lidar = "lidar"'), CAMERA_AND_LIDAR)
    assert named.cases[0].lidar == "lidar"


def test_methods_for_features_and_for_a_lidar_are_told_apart(tmp_path: Path) -> None:
    suite: Any = GOOD.replace('scenario = "tumble.toml"', 'scenario = { base = "tumble.toml", target = "zhai2014-target" }')
    with pytest.raises(ConfigError, match="features are measured by cameras, and the scenario has none"):
        _load(tmp_path, suite.replace("seeds = 3", 'features = ["wing"]'))
    words = "asks for features and for what the LIDAR 'lidar' measures, and method 'told' does not say"
    with pytest.raises(ConfigError, match=words):
        _load(tmp_path, suite.replace("seeds = 3", 'features = ["wing"]\nlidar = "lidar"'), CAMERA_AND_LIDAR)
    with pytest.raises(ConfigError, match="method 'told' is granted a model of the target, which is for a LIDAR"):
        _load(tmp_path, suite.replace("seeds = 3", 'features = ["wing"]'), CAMERA_AND_LIDAR)


CAMERA_AND_LIDAR = SCENARIO + CAMERA
