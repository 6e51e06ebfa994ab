"""Suites are data: what a file may say, and each mistake as a sentence with its key path."""

from pathlib import Path

import pytest

from benchmark.suite import load_suite
from scenes.config import list_library
from scenes.errors import ConfigError

GOOD = """
title = "t"
description = "d"
[methods.ours]
estimator = "mono-rectangle"
[[cases]]
name = "one"
scenario = "zhai2014-in-plane"
frames = "0:10"
features = ["wing"]
"""


def _load(tmp_path: Path, text: str) -> object:
    path = tmp_path / "suite.toml"
    path.write_text(text, encoding="utf-8")
    return load_suite(str(path))


@pytest.mark.parametrize("name", sorted(list_library("suite")))
def test_every_library_suite_loads_and_names_what_exists(name: str) -> None:
    suite = load_suite(name)
    assert suite.description
    for case in suite.cases:
        assert len(case.selected) > 0
        assert suite.methods_of(case)


def test_the_papers_suite_is_two_cases_three_regions_two_methods_and_the_glints() -> None:
    suite = load_suite("zhai2014")
    cases = {case.name: case for case in suite.cases}
    for name in ("in-plane", "out-of-plane"):
        assert len(cases[name].selected) == 41
        assert cases[name].features == ("face", "wing", "span")
        assert {"mono-rectangle-paper", "mono-rectangle"} <= set(suite.methods_of(cases[name]))
        assert len(cases[f"{name}-glint"].selected) == 41
    dense = cases["in-plane-dense"]
    assert (dense.selected, dense.settle_s, dense.features) == (range(60, 220), 60.0, ("wing",))
    filters = [method.parameters.get("filter", False) for method in suite.methods_of(dense).values()]
    assert sorted(filters) == [False, True]
    printed = {(one.case, one.mean_deg, one.max_deg) for one in suite.published}
    assert printed == {("in-plane", 0.23, 2.6), ("out-of-plane", 0.05, 3.0)}


def test_a_case_without_methods_meets_all_in_the_suites_order(tmp_path: Path) -> None:
    suite = _load(tmp_path, GOOD.replace("[methods.ours]", '[methods.b]\nestimator = "b"\n[methods.a]'))
    assert list(suite.methods_of(suite.cases[0])) == ["b", "a"]  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('frames = "0:10"', 'frames = "0:10000"', r"cases.0: frames '0:10000' lies outside the scenario, which has .* 838"),
        ('frames = "0:10"', 'frames = "10:0"', r"selects no frame"),
        ('features = ["wing"]', 'features = ["wnig"]', r"no feature .* is called 'wnig'; did you mean 'wing'\?"),
        ('features = ["wing"]', "features = []", r"cases.0: features: a case names at least one feature"),
        ('scenario = "zhai2014-in-plane"', 'scenario = "zhai2014-inplane"', r"did you mean 'zhai2014-in-plane'\?"),
        ('name = "one"', 'name = "One/../two"', r"cases.0.name: got 'One/../two'"),
        ("estimator =", "estimater =", r"methods.ours.estimater: no such key; did you mean 'estimator'\?"),
        ('name = "one"', 'name = "one"\nmethods = ["theirs"]', r"no method of this suite is called 'theirs'"),
        ('title = "t"', 'title = "t"\nprior_sigma_px = -3', r"prior_sigma_px: got -3, must be at least 0"),
        ('title = "t"', 'title = "t"\nquality = "best"', r"quality: got 'best', must be one of reference, standard, fast, draft"),
    ],
)
def test_each_mistake_is_a_sentence(tmp_path: Path, old: str, new: str, sentence: str) -> None:
    assert old in GOOD
    with pytest.raises(ConfigError, match=sentence):
        _load(tmp_path, GOOD.replace(old, new))


def test_two_cases_of_one_name_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="two cases are called 'one'"):
        _load(tmp_path, GOOD + GOOD[GOOD.index("[[cases]]") :])


MIXED = """
title = "t"
description = "d"
[methods.one]
estimator = "mono-rectangle"
modality = "mono"
[methods.two]
estimator = "stereo-ring"
modality = "stereo"
[methods.scans]
estimator = "lidar-ekf"
modality = "lidar"
model = true
[[cases]]
name = "all"
scenario = "standard-sun"
frames = "0:2"
features = ["ring", "panel"]
lidar = "lidar"
"""


def test_in_a_mixed_case_each_method_meets_what_its_modality_says(tmp_path: Path) -> None:
    suite = _load(tmp_path, MIXED)
    (case,) = suite.cases  # type: ignore[attr-defined]
    met = {str(subject): list(suite.methods_for(case, subject)) for subject in case.subjects}  # type: ignore[attr-defined]
    assert met == {"the ring 'ring'": ["two"], "the rectangle 'panel'": ["one"], "the LIDAR 'lidar'": ["scans"]}


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('modality = "mono"', "", r"features and for what the LIDAR 'lidar' measures, and method 'one' does not say"),
        ('modality = "mono"', 'modality = "radar"', r"methods.one.modality: got 'radar', must be one of mono, stereo, lidar"),
        ('modality = "mono"', 'modality = "stereo"', r"no method answers the rectangle 'panel'; one with modality = 'mono'"),
        ('modality = "lidar"', 'modality = "mono"', r"methods.scans: model is granted to methods for scans, .* is 'mono'"),
        ('modality = "stereo"', 'modality = "stereo"\naspect = true', r"methods.two: aspect is granted to methods for rectangles"),
        ('modality = "mono"', 'modality = "mono"\nradius = true', r"methods.one: radius is granted to methods for rings"),
        ('lidar = "lidar"', 'lidar = "ladar"', r"no LIDAR of the scenario is called 'ladar'; did you mean 'lidar'\?"),
    ],
)
def test_each_mistake_of_a_mixed_case_is_a_sentence(tmp_path: Path, old: str, new: str, sentence: str) -> None:
    assert old in MIXED
    with pytest.raises(ConfigError, match=sentence):
        _load(tmp_path, MIXED.replace(old, new))


def test_standard_shows_one_trajectory_to_three_modalities_in_five_lights_from_three_ranges() -> None:
    suite = load_suite("standard")
    cases = {case.name: case for case in suite.cases}
    lights, ranges = ("sun", "halogen", "grazing", "glint", "earthshine"), ("near", "mid", "far")
    assert set(cases) == {f"{light}-{place}" for light in lights for place in ranges}
    for name, case in cases.items():
        assert [run.seed for run in case.runs] == [0, 1, 2]
        assert [subject.modality for subject in case.subjects] == ["mono", "stereo", "lidar"]
        alike = cases[f"sun-{name.partition('-')[2]}"].scenario
        assert case.scenario.motion == alike.motion
        assert case.scenario.target == alike.target
    assert {name for name, method in suite.methods.items() if method.modality is None} == set()


def test_quick_is_the_standard_in_small() -> None:
    quick, standard = load_suite("quick"), load_suite("standard")
    whole = {case.name: case for case in standard.cases}
    for case in quick.cases:
        assert case.scenario == whole[f"{case.name}-mid"].scenario
    assert {name: standard.methods[name] for name in quick.methods} == quick.methods
