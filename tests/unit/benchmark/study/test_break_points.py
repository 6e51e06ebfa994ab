"""Break-points: where they must be for availabilities that are known."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import pytest

from benchmark.ranking_rule import UNANSWERED_RAD
from benchmark.study.score_record import BreakPoint, Crossing
from benchmark.study.scores import study_scores

_FRAMES = 100


def _points(study: Any, right: dict[float, int], factor: str = "gain", frames: int = _FRAMES) -> dict[str, BreakPoint]:
    """By direction, where of so many frames ``right[level]`` are right."""
    order = np.random.default_rng(0).permutation(frames)

    def charge(method: str, point: pd.Series, seed: int, frame: int) -> float:
        return 0.01 if order[frame] < right[point["gain"]] else UNANSWERED_RAD

    found = study.outcomes(charge, frames=frames)
    return {one.going: one for one in study_scores(found).break_points if one.factor == factor}


def test_between_two_levels_it_is_interpolated(ladder: Callable) -> None:
    right = {1: 100, 2: 98, 4: 82, 8: 10}
    linear, log = (_points(ladder(scale=scale), right)["up"] for scale in ("linear", "log"))
    assert linear.found.kind == log.found.kind == "at"
    assert linear.found.value == pytest.approx(3.0)
    assert log.found.value == pytest.approx(2 * 2**0.5)
    for one in (linear, log):
        assert (one.start, one.start_is) == (1.0, "baseline")
        assert 1.5 < one.nearest.value < one.found.value < one.farthest.value < 4.5


def test_it_is_sought_on_both_sides_of_the_baseline(ladder: Callable) -> None:
    found = _points(ladder(levels=(1, 2, 4, 8), baseline=4.0, scale="linear"), {1: 0, 2: 80, 4: 100, 8: 100})
    assert found["down"].found.value == pytest.approx(3.0)
    assert found["up"].found == found["up"].nearest == found["up"].farthest == Crossing(kind="never")
    down = found["down"]
    assert down.farthest.value < 3.0 < down.nearest.value  # nearest as seen from the baseline


def test_exactly_nine_in_ten_is_not_below(ladder: Callable) -> None:
    assert _points(ladder(), dict.fromkeys((1, 2, 4, 8), 90))["up"].found.kind == "never"
    assert _points(ladder(), {1: 90, 2: 90, 4: 90, 8: 0})["up"].found.value == pytest.approx(4.0)
    assert _points(ladder(), dict.fromkeys((1, 2, 4, 8), 89))["up"].found.kind == "already"


def test_the_first_time_counts(ladder: Callable) -> None:
    assert _points(ladder(scale="linear"), {1: 100, 2: 80, 4: 100, 8: 0})["up"].found.value == pytest.approx(1.5)


def test_an_interval_may_reach_the_start_or_beyond_the_range(ladder: Callable) -> None:
    one = _points(ladder(), {1: 92, 2: 91, 4: 90, 8: 88})["up"]
    assert one.found.kind == "at"
    assert one.nearest == Crossing(kind="already")
    assert one.farthest == Crossing(kind="never")


def test_what_cannot_matter_breaks_nothing_and_has_one_side(ladder: Callable) -> None:
    found = _points(ladder(), {1: 100, 2: 0, 4: 0, 8: 0}, factor="idle")
    assert {going: one.found.kind for going, one in found.items()} == {"up": "never"}  # the baseline, 0, is the lowest level


def test_two_frames_have_no_interval_here_either(ladder: Callable) -> None:
    one = _points(ladder(), {1: 2, 2: 2, 4: 0, 8: 0}, frames=2)["up"]
    assert one.found.kind == "at"
    assert one.nearest is one.farthest is None


def test_in_crossed_designs_one_starts_at_the_level_next_to_the_baseline(crossed: Callable) -> None:
    right = {1.0: 100, 2.0: 100, 4.0: 0, 9.0: 0}
    assert _points(crossed(), right)["up"].start_is == "baseline"
    found = _points(crossed(first=(1, 4, 9)), right)
    assert {one.start for one in found.values()} == {1.0}
    assert found["up"].start_is == "nearest"
    assert found["up"].found.value == pytest.approx(1.3)


def test_without_a_baseline_one_starts_where_the_method_is_best(crossed: Callable) -> None:
    study = crossed(first=(1, 2, 3, 4))
    factors = tuple(one.model_copy(update={"baseline": None}) for one in study.record.factors)
    bare = type(study)(study.record.model_copy(update={"factors": factors}), study.points)
    found = _points(bare, {1: 50, 2: 95, 3: 100, 4: 80})
    assert {(one.start, one.start_is) for one in found.values()} == {(3.0, "best")}
    assert found["up"].found.value == pytest.approx(3.5)
    assert found["down"].found.value == pytest.approx(2 - 5 / 45)


def test_directions_have_no_order(sphere: Any) -> None:
    assert not study_scores(sphere.outcomes(lambda *_: 0.1)).break_points
