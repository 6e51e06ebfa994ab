"""Scores per level: against pandas on the same frames, in every design."""

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

from benchmark.ranking_rule import UNANSWERED_RAD
from benchmark.study.level_sets import level_sets
from benchmark.study.outcomes import Outcomes
from benchmark.study.score_record import LevelScore
from benchmark.study.scores import study_scores


def _of(found: Outcomes, factor: str, method: str = "ours") -> list[LevelScore]:
    return [one for one in study_scores(found).levels if (one.factor, one.method) == (factor, method)]


def _answers(hardness: np.ndarray) -> Callable[..., float]:
    """Harder with gain, wrong where too hard."""

    def charge(method: str, point: pd.Series, seed: int, frame: int) -> float:
        cost = 0.1 * hardness[seed, frame] * point["gain"]
        return cost if cost < 0.3 else UNANSWERED_RAD

    return charge


def _agrees(score: LevelScore, frames: pd.DataFrame) -> None:
    """With the frames of its points."""
    mine = frames[frames["point"].isin(score.points) & (frames["method"] == score.method)]
    assert score.frames == len(mine)
    assert score.charge.value == pytest.approx(mine["charge"].mean())
    assert score.availability.value == pytest.approx(mine["right"].mean())
    assert score.rotation_median_deg.value == pytest.approx(mine.loc[mine["right"], "geodesic_deg"].median())
    for one in (score.charge, score.availability, score.rotation_median_deg):
        assert one.low <= one.value <= one.high


def test_one_at_a_time_levels_are_the_scenario_and_what_is_off_it_in_that_factor(ladder: Callable, hardness: np.ndarray) -> None:
    found = ladder(levels=(4, 0.5, 2), baseline=1.0).outcomes(_answers(hardness), ("ours", "theirs"), seeds=(0.0, 1.0))
    gain = _of(found, "gain")
    assert [(one.value, one.points, one.is_baseline, one.label) for one in gain] == [
        (0.5, ("g0.5",), False, "0.5×"), (1.0, ("p0",), True, "1×"), (2.0, ("g2",), False, "2×"), (4.0, ("g4",), False, "4×"),
    ]  # fmt: skip
    base = gain[1].charge.value
    for one in gain:
        _agrees(one, found.frames)
        assert one.against == "baseline"
        assert one.charge_change.value == pytest.approx(one.charge.value - base)
    assert [one.points for one in _of(found, "idle")] == [("p0",), ("i1",), ("i2",)]


def test_a_baseline_that_is_no_level_is_compared_with_and_has_no_value(ladder: Callable, hardness: np.ndarray) -> None:
    study = ladder()
    study.points.loc[0, "gain"] = np.nan
    levels = _of(study.outcomes(lambda m, p, s, f: hardness[s, f] * (3 if np.isnan(p["gain"]) else p["gain"])), "gain")
    assert [one.value for one in levels] == [None, 2.0, 4.0, 8.0]
    assert levels[0].label == "as the scenario is"
    assert levels[0].is_baseline
    assert levels[1].charge_change.value == pytest.approx(-hardness[0, :12].mean())


def test_a_crossed_level_has_all_its_points_and_is_compared_with_the_mean_of_levels(
    crossed: Callable, hardness: np.ndarray
) -> None:
    found = crossed().outcomes(_answers(hardness))
    gain = _of(found, "gain")
    assert [one.value for one in gain] == [1.0, 2.0, 4.0]
    assert [len(one.points) for one in gain] == [7, 7, 7]
    assert [one.is_baseline for one in gain] == [False, True, False]
    assert gain[0].label == "1 m"
    mean = np.mean([one.charge.value for one in gain])
    for one in gain:
        _agrees(one, found.frames)
        assert one.against == "mean"
        assert one.charge_change.value == pytest.approx(one.charge.value - mean)


def test_a_point_that_could_not_be_rendered_makes_no_difference_between_levels(crossed: Callable, hardness: np.ndarray) -> None:
    """Settings of ``idle`` that not every gain has are in the levels, but not in what is compared; ``idle`` weighs here."""
    whole = crossed()
    study = type(whole)(whole.record, whole.points.drop(index=6))  # gain 1, idle 6
    found = study.outcomes(lambda m, p, s, f: hardness[s, f] * (1 + p["idle"] * 0.1))
    gain = _of(found, "gain")
    assert [len(one.points) for one in gain] == [6, 7, 7]
    assert gain[0].charge.value != gain[1].charge.value
    for one in gain:
        assert (one.charge_change.low, one.charge_change.high) == (0.0, 0.0)


def test_every_direction_is_a_level(sphere: object, hardness: np.ndarray) -> None:
    found = sphere.outcomes(lambda m, p, s, f: hardness[s, f] * (2 + p["sun_z"]))  # type: ignore[attr-defined]
    levels = _of(found, "sun")
    assert len(levels) == 49
    for one, (_, point) in zip(levels, found.points.iterrows()):
        assert one.points == (point["point"],)
        assert one.value is None
        assert one.direction == pytest.approx((point["sun_x"], point["sun_y"], point["sun_z"]))
        assert one.charge.value == pytest.approx(hardness[0, :12].mean() * (2 + point["sun_z"]))
        assert one.label.startswith(f"phase {np.degrees(np.arccos(-point['sun_z'])):.0f}°")
    assert sum(one.charge_change.value for one in levels if one.charge_change) == pytest.approx(0.0, abs=1e-12)


def test_the_bound_is_of_the_frames_that_were_asked_and_is_known(ladder: Callable, hardness: np.ndarray) -> None:
    bound = lambda p, f: np.nan if p["gain"] > 2 and f % 4 > 2 else 0.01 * p["gain"] * (1 + f)  # noqa: E731
    found = ladder().outcomes(_answers(hardness), frames=12, bound=bound)
    asked = found.frames["frame"] < 8
    frames = found.frames.assign(bound_asked=asked, bound_determined=found.frames["bound_determined"] & asked)
    first, *_, last = _of(Outcomes(found.record, found.points, frames), "gain")
    assert first.bound_median_rad.value == pytest.approx(0.01 * np.median(1 + np.arange(8)))
    assert (first.bound_determined.value, first.bound_determined.low) == (1.0, 1.0)
    assert last.bound_median_rad.value == pytest.approx(0.08 * np.median([1, 2, 3, 5, 6, 7, np.inf, np.inf]))
    assert last.bound_determined.value == pytest.approx(6 / 8)
    most = frames.assign(bound_rotation_rad=frames["bound_rotation_rad"].where(frames["frame"] < 3))
    lost = _of(Outcomes(found.record, found.points, most), "gain")[0]
    assert (lost.bound_median_rad.value, lost.bound_median_rad.high) == (None, None)
    (nothing, *_) = _of(ladder().outcomes(_answers(hardness)), "gain")
    assert nothing.bound_median_rad.value is nothing.bound_determined.value is None


def test_a_method_that_is_never_right_has_no_median(ladder: Callable) -> None:
    (one, *_) = _of(ladder().outcomes(lambda *_: UNANSWERED_RAD), "gain")
    assert (one.availability.value, one.availability.high) == (0.0, 0.0)
    assert one.charge.value == pytest.approx(UNANSWERED_RAD)
    assert one.rotation_median_deg.value is one.rotation_median_deg.low is None


def test_a_study_over_all_its_points_counts_each_once(ladder: Callable, hardness: np.ndarray) -> None:
    study = ladder()
    found = study.outcomes(_answers(hardness))
    (one,) = study_scores(found).overall
    assert one.frames == len(found.frames)
    assert one.charge.value == pytest.approx(found.frames["charge"].mean())
    assert one.availability.value == pytest.approx(found.frames["right"].mean())


def test_a_sobol_design_has_no_levels(ladder: Callable) -> None:
    study = ladder()
    assert not level_sets(study.record.model_copy(update={"design": "sobol"}), study.points)
