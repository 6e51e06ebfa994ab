"""The panel and the paired bootstrap: against NumPy on what was drawn, and whether differences are paired."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from benchmark.errors import PredictionsError
from benchmark.ranking_rule import UNANSWERED_RAD, UNANSWERED_SHARE
from benchmark.study.level_sets import level_sets
from benchmark.study.outcomes import Outcomes
from benchmark.study.paired import LevelDraws, level_draws, medians, paired
from benchmark.study.panel import panels
from benchmark.study.scores import study_scores


def _draws(found: Outcomes, factor: int = 0) -> LevelDraws:
    (panel,) = panels(found.frames)
    levels = level_sets(found.record, found.points)[factor].of(panel)
    assert levels is not None
    return level_draws(paired(panel), levels)


@pytest.mark.parametrize("lost", [0.0, 0.3, 0.9, 1.0])
def test_medians_are_those_of_what_was_drawn(lost: float) -> None:
    rng = np.random.default_rng(0)
    values = rng.exponential(size=(40, 3)).round(2)
    values[rng.random(values.shape) < lost] = np.nan
    counts = rng.integers(0, 3, size=(40, 600)).astype(np.uint16)
    found = medians(counts, values)
    for draw in range(600):
        drawn = np.repeat(values, counts[:, draw], axis=0)
        drawn = drawn[~np.isnan(drawn)]
        assert found[draw] == pytest.approx(np.median(drawn) if drawn.size else np.nan, nan_ok=True)


def test_a_panel_is_the_same_whatever_the_order_of_the_rows(ladder: Callable, hardness: np.ndarray) -> None:
    found = ladder().outcomes(lambda m, p, s, f: hardness[s, f] * p["gain"], ("a", "b"), seeds=(0.0, 1.0), bound=lambda p, f: f)
    (one,) = panels(found.frames)
    (other,) = panels(found.frames.sample(frac=1.0, random_state=1))
    assert (one.methods, one.tracks) == (other.methods, other.tracks)
    for name in ("charge", "right", "rotation_deg", "bound_rad", "bound_asked"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    place = one.column["g4"]
    np.testing.assert_array_equal(one.charge[:12, place, 1], 4 * hardness[0, :12])
    np.testing.assert_array_equal(one.charge[12:, place, 1], 4 * hardness[1, :12])
    np.testing.assert_array_equal(one.bound_rad[12:, place], np.arange(12))


def test_frames_that_a_method_says_nothing_of_cost_what_silence_does(ladder: Callable) -> None:
    found = ladder().outcomes(lambda *_: 0.1, ("a", "b"), modality="stereo")
    silent = found.frames[(found.frames["method"] == "a") | (found.frames["frame"] != 3)]
    (panel,) = panels(silent)
    assert (panel.charge[3, :, 1] == UNANSWERED_RAD + UNANSWERED_SHARE).all()
    assert (panel.right[3] == [1, 0]).all()
    assert (panel.right[4] == 1).all()
    with pytest.raises(PredictionsError, match="two entries are called 'a' and answer frame 0"):
        panels(pd.concat([found.frames, found.frames.head(1)]))


def test_a_draw_takes_the_same_frames_at_all_levels_of_all_methods_and_sensors(ladder: Callable, hardness: np.ndarray) -> None:
    study = ladder()
    mono = study.outcomes(lambda m, p, s, f: hardness[s, f], seeds=(0.0, 1.0), modality="mono")
    lidar = study.outcomes(lambda m, p, s, f: hardness[s, f], seeds=(0.0, 1.0), modality="lidar")
    one, other = panels(pd.concat([lidar.frames, mono.frames]))
    assert (one.modality, other.modality) == ("mono", "lidar")
    np.testing.assert_array_equal(paired(one).counts, paired(other).counts)


@pytest.mark.parametrize("design", ["ladder", "crossed"])
def test_a_factor_that_cannot_matter_makes_exactly_no_difference(
    design: str, request: pytest.FixtureRequest, hardness: np.ndarray
) -> None:
    """Whatever the others do: means of seven equal levels, sums over settings and draws must not round to something else."""
    study = request.getfixturevalue(design)()
    found = study.outcomes(lambda m, p, s, f: 0.7 * hardness[s, f] * p["gain"], ("a", "b"), seeds=(0.0, 1.0), frames=17)
    idle, gain = _draws(found, factor=1), _draws(found, factor=0)
    for name in ("charge_change", "availability_change"):
        assert (getattr(idle, name) == 0.0).all()
    assert np.abs(gain.charge_change).max() > 0.1
    for score in study_scores(found).levels:
        if score.factor == "idle":
            assert (score.charge_change.value, score.charge_change.low, score.charge_change.high) == (0.0, 0.0, 0.0)


def test_equal_directions_make_exactly_no_difference(sphere: object, hardness: np.ndarray) -> None:
    draws = _draws(sphere.outcomes(lambda m, p, s, f: hardness[s, f]))  # type: ignore[attr-defined]
    assert (draws.charge_change == 0.0).all()
    assert draws.charge.std() > 0


def test_differences_are_surer_than_levels_because_they_are_paired(ladder: Callable, hardness: np.ndarray) -> None:
    """Frames differ by 1, levels by 0.1 ± 0.01: the interval of the difference knows only the latter."""
    noise = np.random.default_rng(3).normal(scale=0.01, size=(9, 100))
    study = ladder()
    found = study.outcomes(lambda m, p, s, f: hardness[s, f] + 0.1 * p["gain"] + noise[int(p["gain"]), f], frames=100)
    for score in study_scores(found).levels:
        if score.factor == "gain" and not score.is_baseline:
            widths = [one.high - one.low for one in (score.charge, score.charge_change)]
            assert widths[1] < 0.15 * widths[0]
            assert score.charge_change.low < 0.1 * (score.value - 1) < score.charge_change.high


def test_the_interval_of_a_difference_holds_the_truth_about_as_often_as_it_says(ladder: Callable) -> None:
    """What a level adds is a first-order process over the frames, with mean 0."""
    rng, held, trials = np.random.default_rng(8), 0, 60
    study = ladder(levels=(1, 2))
    for _ in range(trials):
        steps = rng.normal(size=120)
        drift = np.zeros(120)
        for at in range(1, 120):
            drift[at] = 0.5 * drift[at - 1] + steps[at]
        found = study.outcomes(lambda m, p, s, f, drift=drift: 1.0 + 0.02 * drift[f] * (p["gain"] - 1), frames=120)
        frames = found.frames[found.frames["point"].isin(["p0", "g2"])]
        draws = _draws(replace(found, frames=frames))
        low, high = np.quantile(draws.charge_change[1:, 1, 0], [0.025, 0.975])
        held += low <= 0.0 <= high
    assert 0.85 <= held / trials <= 1.0


def test_two_frames_have_no_interval(ladder: Callable) -> None:
    (score, *_) = study_scores(ladder().outcomes(lambda m, p, s, f: 0.1 * f, frames=2)).levels
    assert score.charge.value == pytest.approx(0.05)
    assert score.charge.low is score.charge.high is None
