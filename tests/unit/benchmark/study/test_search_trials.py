"""A search's trials with frames that were made up: what counts, what is left out as dark, what an earlier process learnt."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from benchmark.study import search_trials
from benchmark.study.points import Point
from benchmark.study.search_hunt import Hunt, narrowed
from benchmark.study.search_proposals import Tried
from benchmark.study.search_trials import Trials
from benchmark.study.spec import Study, case_of, load_study, suite_of
from scenes.errors import UsageError
from tests.fly_around import FLY_AROUND

STUDY = """
title = "made up"
design = "factorial"
frames = "0:2"
features = ["wing"]

[methods.one]
estimator = "mono-rectangle"

[methods.two]
estimator = "mono-rectangle"
modality = "mono"

[factors.range]
title = "Range"
unit = "m"
paths = ["motion.range_m"]
range = [100.0, 200.0]

[factors.sun]
type = "direction"
title = "Sun"
light = "sun"

[scenario]
frame_count = 2
quality = "draft"
target = "zhai2014-target"
"""
STUDY += FLY_AROUND
Frames = Callable[[float], tuple[float, float]]
"""metres → what a frame costs, its bound in rad"""


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    path = tmp_path_factory.mktemp("study") / "made-up.toml"
    path.write_text(STUDY, encoding="utf-8")
    return load_study(str(path))


@pytest.fixture
def trials(study: Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Trials]:
    """trials(frames, avoid_dark) → the objective, whose points are not rendered but made up by ``frames``."""

    def make(frames: Frames, avoid_dark: bool = True) -> Trials:
        def made(_: Trials, points: Sequence[Point], **_more: object) -> pd.DataFrame:
            rows = []
            for point in points:
                charge, bound = frames(float(point.values["range"]))  # type: ignore[arg-type]
                rows += [(point.name, "mono", charge, charge, True, charge < 1, True, bound)] * 2
            columns = ["point", "modality", "charge", "geodesic_deg", "answered", "right", "bound_asked", "bound_rotation_rad"]
            return pd.DataFrame(rows, columns=columns)

        monkeypatch.setattr(Trials, "_frames", made)
        hunt = Hunt(narrowed(study, "one", None, avoid_dark), "one", None, 4, 0, "tpe", avoid_dark)
        return Trials(hunt, tmp_path, study.scenario.model_dump(mode="json"))

    return make


def at(metres: float) -> np.ndarray:
    return np.array([(metres - 100) / 100, 0.5, 0.5])


def test_lights_too_dark_for_anybody_count_nothing(trials: Callable[..., Trials]) -> None:
    objective = trials(lambda metres: (2.0, {100: 0.01, 110: 0.02, 120: 0.03, 140: 0.09, 150: 0.11, 160: np.nan}[round(metres)]))
    objective.look(np.array([at(metres) for metres in (100, 110, 120, 160)]))  # of the three that are determined, 0.02 rad
    assert objective(at(160)) == 0.0  # undetermined
    assert objective(at(100)) == objective(at(140)) == pytest.approx(2.0, abs=2e-2)  # 4.5 times the median
    assert objective(at(150)) == 0.0  # 5.5 times


def test_they_count_where_they_are_not_to_be_left_out(trials: Callable[..., Trials]) -> None:
    assert trials(lambda _: (2.0, np.nan), avoid_dark=False)(at(160)) == pytest.approx(2.0, abs=1e-3)


def test_what_is_dark_hangs_on_no_order(trials: Callable[..., Trials]) -> None:
    """Nor on what a process did before: the evenly spread places are the same ones for all."""
    values = []
    for order in ((200, 100, 120), (100, 120, 200)):
        objective = trials(lambda metres: (2.0, 0.5 if metres > 150 else 0.01))
        objective.look(np.array([at(metres) for metres in (100, 130, 190)]))
        values.append({metres: objective(at(metres)) for metres in order})
    assert values[0] == values[1]
    assert values[0][200] == 0.0 < values[0][100]


def test_where_no_evenly_spread_place_is_determined_only_the_undetermined_are_dark(trials: Callable[..., Trials]) -> None:
    objective = trials(lambda metres: (2.0, 0.5 if metres > 150 else np.nan))
    objective.look(np.array([at(110), at(120)]))
    assert objective(at(120)) == 0.0 < objective(at(200))


def test_the_record_says_where_a_trial_was_and_what_was_dark(trials: Callable[..., Trials]) -> None:
    objective = trials(lambda metres: (2.0, 0.5 if metres > 150 else 0.01))
    objective.look(np.array([at(100)]))
    tried = [Tried(at(metres), objective(at(metres))) for metres in (200, 100)]
    _, told = objective.all_of(tried, "")
    assert [one.is_dark for one in told] == [True, False]
    assert told[0].unit == (1.0, 0.5, 0.5)
    assert told[0].values["range"] == 200.0
    assert np.linalg.norm(told[0].values["sun"]) == pytest.approx(1.0)


def test_a_scenario_that_is_refused_costs_nothing_and_is_told(
    trials: Callable[..., Trials], monkeypatch: pytest.MonkeyPatch
) -> None:
    objective = trials(lambda _: (2.0, 0.01), avoid_dark=False)

    def refused(*_: object) -> Point:
        raise UsageError("it points nowhere")

    monkeypatch.setattr(search_trials, "point_at", refused)
    assert objective(at(100)) == 0.0
    _, (told,) = objective.all_of([Tried(at(100), 0.0)], "")
    assert told.refused == "it points nowhere"
    assert not told.is_failure


def test_a_direction_is_a_line_and_a_circle(study: Study) -> None:
    hunt = Hunt(narrowed(study, "one", None, False), "one", None, 4, 0, "tpe", False)
    assert hunt.axes == ("line", "line", "circle")


def test_only_the_method_runs_and_bounds_only_where_they_are_needed(study: Study) -> None:
    plain, dark = (narrowed(study, "two", None, avoid_dark) for avoid_dark in (False, True))
    assert list(plain.methods) == ["two"]
    assert plain.bound_frames is None
    assert dark.bound_frames == "1"  # the last: the first ones may be a filter's to settle in
    assert narrowed(study, "one", "mono", False).methods["one"].modality == "mono"


def test_searches_of_different_things_are_not_the_same(study: Study) -> None:
    def identity(name: str, avoid_dark: bool) -> str:
        return Hunt(narrowed(study, name, None, avoid_dark), name, None, 4, 0, "tpe", avoid_dark).identity

    assert len({identity("one", False), identity("two", False), identity("one", True)}) == 3
    assert identity("one", False) == identity("one", False)


@pytest.mark.parametrize(
    ("method", "modality", "says"), [("ona", None, "did you mean 'one'"), ("two", "lidar", "two is a method for mono")]
)
def test_what_cannot_be_searched_is_refused(study: Study, method: str, modality: str | None, says: str) -> None:
    with pytest.raises(UsageError, match=says):
        narrowed(study, method, modality, False)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["sun-sphere", "halogen-arc", "exposure-ladder", "roughness", "lidar-grazing", "all-factors"])
def test_every_method_of_the_library_can_be_searched_alone(name: str) -> None:
    """A study asks for rectangles and rings; its search for what the one method answers."""
    whole = load_study(name)
    for title, method in whole.methods.items():
        alone = narrowed(whole, title, None, True)
        case = case_of(alone, "p0", "", alone.scenario)
        assert {subject.modality for subject in case.subjects} <= {method.modality or "lidar"}
        assert list(suite_of(alone, (case,)).methods) == [title]


def test_what_nobody_is_asked_for_is_no_search(study: Study) -> None:
    with pytest.raises(UsageError, match="asks for nothing that a method for lidar answers"):
        narrowed(study, "one", "lidar", False)
