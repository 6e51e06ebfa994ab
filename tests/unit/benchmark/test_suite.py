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
