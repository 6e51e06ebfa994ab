"""A suite that includes others: nothing of what they ask for changes by it."""

from pathlib import Path

import pytest

from benchmark import bench
from benchmark.case import Case, CaseRun
from benchmark.entries import Task
from benchmark.suite import Suite, load_suite
from scenes.errors import ConfigError

PARTS = ("zhai2014", "zhai2014-display", "shu2020", "song2017")
ONE = """
title = "one"
description = "the first"
prior_sigma_px = 1.0
quality = "fast"
limits = { step_timeout_s = 5.0 }
bounds = "3"
bound_samples = 16
[methods.ours]
estimator = "mono-rectangle"
[methods.second]
estimator = "mono-rectangle-paper"
[[cases]]
name = "turn"
scenario = "zhai2014-in-plane"
frames = "0:10"
features = ["wing"]
[[published]]
case = "turn"
source = "p"
angle = "theta2"
mean_deg = 0.1
max_deg = 1.0
[[notes]]
title = "n"
text = "of one"
"""
TWO = (
    ONE.replace('"fast"', '"draft"')
    .replace("1.0\nquality", "2.0\nquality")
    .replace("0:10", "0:12")
    .replace("bound_samples = 16", "bound_samples = 32")
    .replace("[methods.second]", "[methods.third]")
)


def _write(folder: Path, **texts: str) -> None:
    for name, text in texts.items():
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")


def _both(folder: Path, one: str = ONE, two: str = TWO, more: str = "") -> Suite:
    _write(folder, one=one, two=two, both=f'title = "t"\ndescription = "d"\ninclude = ["./one.toml", "./two.toml"]\n{more}')
    return load_suite(str(folder / "both.toml"))


def test_seeds_is_the_three_papers_and_the_ground_test_as_they_are() -> None:
    seeds, parts = load_suite("seeds"), [load_suite(name) for name in PARTS]
    assert [case.name for case in seeds.cases] == [case.name for part in parts for case in part.cases]
    cases = {case.name: case for case in seeds.cases}
    for part in parts:
        for own in part.cases:
            case = cases[own.name]
            assert case.scenario == own.scenario
            assert (case.selected, case.runs, case.features, case.settle_s) == (own.selected, own.runs, own.features, own.settle_s)
            assert (case.quality or seeds.quality) == (own.quality or part.quality)
            assert case.prior_sigma_px == part.prior_sigma_px
            assert case.limits == part.limits
            assert seeds.methods_of(case) == part.methods_of(own)
        assert {*part.notes} <= {*seeds.notes}
        assert {*part.published} <= {*seeds.published}
        assert all(one in seeds.published_rings for one in part.published_rings)
        assert all(one in seeds.published_filters for one in part.published_filters)


def test_what_is_rendered_and_answered_is_the_same_with_or_without_seeds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Data sets by scenario, frames, seed and quality; entries by everything that their answers depend on."""
    rendered: list[object] = []
    tasks: list[Task] = []

    def render(suite: Suite, case: Case, run: CaseRun, path: Path, *_: object) -> None:
        rendered.append((case.scenario, case.selected, run, path, case.quality or suite.quality))

    monkeypatch.setattr(bench, "render_run", render)
    monkeypatch.setattr(bench, "done_here", lambda mine, _: tasks.extend(mine))
    bench.bench(load_suite("seeds"), tmp_path)
    together, rendered[:] = (list(rendered), list(tasks)), []
    tasks.clear()
    for name in PARTS:
        bench.bench(load_suite(name), tmp_path)
    assert len(tasks) > 100
    assert together == (rendered, tasks)


def test_cases_of_one_name_are_told_apart_by_their_suites_and_keep_its_rules(tmp_path: Path) -> None:
    suite = _both(tmp_path)
    assert [(case.name, len(case.selected)) for case in suite.cases] == [("one-turn", 10), ("two-turn", 12)]
    assert [(case.quality, case.prior_sigma_px) for case in suite.cases] == [("fast", 1.0), ("draft", 2.0)]
    assert [case.limits.step_timeout_s for case in suite.cases if case.limits] == [5.0, 5.0]
    assert [(case.bounds, case.bound_samples) for case in suite.cases] == [("3", 16), ("3", 32)]
    assert [list(suite.methods_of(case)) for case in suite.cases] == [["ours", "second"], ["ours", "third"]]
    assert [one.case for one in suite.published] == ["one-turn", "two-turn"]
    assert len(suite.notes) == 1  # the same note twice is one


def test_a_case_that_is_equal_in_everything_is_one(tmp_path: Path) -> None:
    suite = _both(tmp_path, two=ONE)
    assert [case.name for case in suite.cases] == ["turn"]
    assert len(suite.published) == 1


def test_a_suite_adds_cases_of_its_own_and_may_speak_of_those_it_includes(tmp_path: Path) -> None:
    own = '[[cases]]\nname = "own"\nscenario = "zhai2014-in-plane"\nframes = "0:3"\nfeatures = ["face"]\n'
    suite = _both(tmp_path, two=TWO.replace('"turn"', '"other"'), more=f'[methods.mine]\nestimator = "a:B"\n{own}')
    assert [case.name for case in suite.cases] == ["turn", "other", "own"]
    assert list(suite.methods_of(suite.cases[-1])) == ["mine"]  # without names: those of the suite that the case stands in
    _write(tmp_path, nested='title = "t"\ndescription = "d"\ninclude = ["both.toml"]\n')
    assert [case.name for case in load_suite(str(tmp_path / "nested.toml")).cases] == ["turn", "other", "own"]


@pytest.mark.parametrize(
    ("two", "more", "sentence"),
    [
        (TWO.replace('"mono-rectangle"', '"lidar-ekf"'), "", r"the method 'ours' is one thing in 'one' and another in 'two'"),
        (TWO.replace("0:12", "12:0"), "", r"include\.1\.cases\.0: .*selects no frame"),
        (TWO, 'include_more = ["x"]', r"include_more: no such key"),
        ('title = "t"\ndescription = "d"\ninclude = ["both.toml"]', "", r"include\.1.*names itself by way of"),
        ('title = "t"\ndescription = "d"', "", r"a suite has at least one \[methods"),
        ("[methods", "", r"two\.toml: it is not valid TOML"),
    ],
)
def test_each_mistake_is_a_sentence(tmp_path: Path, two: str, more: str, sentence: str) -> None:
    with pytest.raises(ConfigError, match=sentence):
        _both(tmp_path, two=two, more=more)
