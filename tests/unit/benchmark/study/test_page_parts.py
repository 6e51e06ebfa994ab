"""Parts of a study's page: maps, curves, bars, correlations, and which frames are told of."""

import re
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from scipy.stats import spearmanr

from benchmark.chart_group import Chart
from benchmark.ranking_record import Estimate
from benchmark.ranking_rule import UNANSWERED_RAD
from benchmark.study.attribution import LAYERS, attributions, spearman
from benchmark.study.chart_attribution import attribution_groups
from benchmark.study.chart_sensitivity import sensitivity_groups
from benchmark.study.curve_axes import level_axis, log_ends
from benchmark.study.outcomes import Outcomes
from benchmark.study.page_curves import curve_groups
from benchmark.study.page_maps import map_groups
from benchmark.study.record import FactorRecord
from benchmark.study.score_record import Index, Sensitivity, StudyScores
from benchmark.study.scores import study_scores
from benchmark.study.telling import _chosen

HOSTILE = "<b onclick='x'>& \"mine\""
PLACES = {"ours": 0, HOSTILE: 1}


def _cost(_: str, point: pd.Series, __: int, frame: int) -> float:
    """Wrong with a light above 0.5 behind the target, or a gain above 4; else small."""
    hard = point.get("sun_z", 0.0) > 0.5 or point.get("gain", 0.0) > 4
    return UNANSWERED_RAD if hard else 0.01 + 0.001 * frame


def _lit(found: Outcomes) -> Outcomes:
    """The frames with what was lit: ever less as the light goes behind the target."""
    lit = found.frames.merge(found.points, on="point")["sun_z"].to_numpy()
    shares = (0.5 - 0.5 * lit, 0.5 + 0.5 * lit, 0.0, np.nan)
    return Outcomes(found.record, found.points, found.frames.assign(**dict(zip(LAYERS, shares, strict=True))))


def _linked(chart: Chart) -> list[str]:
    ET.fromstring(chart.svg)
    return re.findall(r'<a href="#point-([^"]+)" tabindex="-1" aria-label=', chart.svg)


@pytest.fixture
def scored_sphere(sphere: Any) -> tuple[Outcomes, StudyScores]:
    found = _lit(sphere.outcomes(_cost, ("ours", HOSTILE), bound=lambda point, _: np.nan if point["sun_z"] > 0.9 else 1e-3))
    return found, study_scores(found)


def test_maps_cross_what_fails_and_hatch_what_is_undetermined(scored_sphere: tuple[Outcomes, StudyScores]) -> None:
    found, scores = scored_sphere
    (group,) = map_groups(found.record.factors, scores)
    bound, *others, share, error = group.maps  # methods by name
    behind, lost = (int((found.points["sun_z"] > limit).sum()) for limit in (0.5, 0.9))
    assert lost > 0
    assert [one.is_bound for one in group.maps] == [True, False, False, False, False]
    assert bound.svg.count('class="cross"') == lost
    assert share.svg.count('class="cross"') == error.svg.count('class="cross"') == behind
    assert f"Fewer than 90 % right in {behind} of 49" in share.summary
    assert f"Undetermined in {lost} of 49" in bound.summary
    assert HOSTILE in others[0].title
    assert HOSTILE not in others[0].svg
    assert "ours" in share.title
    assert others[1].classes == error.classes  # methods share the colours of their errors
    assert len(group.rows) == 1 + 49 * 2
    assert sum("undetermined" in row for row in group.rows) == 2 * lost
    for one in group.maps:
        assert set(re.findall(r'href="#point-(\w+)"', one.svg)) == set(found.points["point"])


def test_maps_are_of_directions_and_curves_of_numbers(scored_sphere: Any, ladder: Callable[..., Any]) -> None:
    found, scores = scored_sphere
    assert list(curve_groups(found.record.factors, scores, PLACES)) == []
    made = ladder().outcomes(_cost)
    assert list(map_groups(made.record.factors, study_scores(made))) == []


def test_curves_have_the_bound_the_levels_and_links_to_points(ladder: Callable[..., Any]) -> None:
    found = ladder().outcomes(_cost, ("ours", HOSTILE), bound=lambda point, _: np.nan if point["gain"] > 4 else 2e-3)
    (group,) = curve_groups(found.record.factors, study_scores(found), PLACES)
    gain, idle = group.plots
    assert {one.title for one in group.legend} == {"ours", HOSTILE}
    assert gain.title == "gain (×)"
    ours = [row for row in gain.rows if row[1] == "ours"]
    assert ours[0] == ("1 (scenario)", "ours", "100", "0.888", "0.115", "15.5")
    assert ours[-1] == ("8", "ours", "0", "—", "undetermined", "2207")
    links = _linked(gain)
    assert set(links) == {"p0", "g2", "g4", "g8"}
    assert links.count("g8") == 2  # its share of right answers, of either method; there is no error to mark
    assert links.count("g4") == 4
    assert set(_linked(idle)) == {"p0", "i1", "i2"}
    assert HOSTILE not in gain.svg
    assert "0% right at 8 ×" in gain.summary
    assert gain.svg.startswith("<svg")
    assert 'role="group"' in gain.svg


def test_axes_hold_the_figures_and_levels_are_not_written_over_each_other() -> None:
    assert log_ends(np.array([np.nan, 1e-3, 2.0])) == (5e-4, 4.0)
    assert log_ends(np.array([np.nan])) == (0.1, 10.0)
    figure, (axes, other) = plt.subplots(2)
    level_axis(axes, FactorRecord(name="a", title="a", scale="log", baseline=1.0), [0.01, 0.1, 1.0, 1.1])
    written = [one.get_text() for one in axes.get_xticklabels()]
    assert written == ["0.01", "0.1", "1.1"]
    level_axis(other, FactorRecord(name="a", title="a", scale="log"), [0.0, 5.0, 10.0])  # zero has no logarithm
    assert other.get_xlim() == pytest.approx((-0.4, 10.4))
    plt.close(figure)


def test_rank_correlations_are_those_of_scipy_and_have_their_sign(scored_sphere: tuple[Outcomes, StudyScores]) -> None:
    found, _ = scored_sphere
    ours = next(one for one in attributions(found) if one.method == "ours")
    assert ours.points == 49
    lit, shadow = ours.correlations["lit_fraction"], ours.correlations["shadow_fraction"]
    value, low, high = (np.nan if one is None else one for one in (lit.value, lit.low, lit.high))
    assert value < -0.5
    assert low < value < high < 0
    assert shadow.value == pytest.approx(-value)
    assert ours.correlations["specular_fraction"].value is None  # it does not vary
    assert ours.correlations["saturated_fraction"].value is None  # it is not known
    pairs = np.random.default_rng(0).integers(0, 6, size=(40, 2)).astype(np.float64)
    assert spearman(pairs) == pytest.approx(spearmanr(*pairs.T).statistic)
    (group,) = attribution_groups(found, tuple(attributions(found)), PLACES)
    assert [one.title for one in group.plots] == [f"Score against what was {LAYERS[key]}" for key in list(LAYERS)[:2]]
    assert len(_linked(group.plots[0])) == 2 * 49
    assert HOSTILE not in group.plots[0].svg


def test_bars_tell_each_factor_alone_and_in_all() -> None:
    def indices(first: float, total: float) -> Iterator[Index]:
        for name, by in (("a", 1.0), ("b", 0.5)):
            alone, whole = (Estimate(value=by * one, low=by * one - 0.1, high=by * one + 0.1) for one in (first, total))
            yield Index(factor=name, first=alone, total=whole)

    factors = [FactorRecord(name="a", title="Alpha <i>"), FactorRecord(name="b", title="Beta")]
    common: dict[str, Any] = {"modality": "mono", "output": "charge", "samples": 16}
    known = Sensitivity(method="ours", indices=tuple(indices(0.4, 0.8)), **common)
    none = Sensitivity(method=HOSTILE, lacking="it does not vary", **common)
    (group,) = sensitivity_groups(factors, StudyScores(sensitivity=(known, none)), PLACES)
    (plot,) = group.plots
    assert [one.title for one in group.legend] == ["ours"]
    assert plot.rows[1] == ("Alpha <i>", "ours", "40.0", "30.0–50.0", "80.0", "70.0–90.0")
    assert "of ours most comes from Alpha <i>, 80.0 % in all" in plot.summary
    ET.fromstring(plot.svg)
    assert "<i>" not in plot.svg
    assert list(sensitivity_groups(factors, StudyScores(sensitivity=(none,)), PLACES)) == []


def test_told_is_the_costliest_failure_under_a_good_bound_and_the_poorest_bound() -> None:
    sigma = np.array([1.0, 1.1, 1.2, 2.0, 3.0, 4.0, 5.0, 6.0, 9.0]) * 1e-3
    right = np.array([True, False, False, True, True, True, True, False, False])
    charge = np.where(right, 0.01, 2.2)
    charge[2] = 2.9
    frames = pd.DataFrame({"bound_rotation_rad": sigma, "right": right, "charge": charge})
    (is_light, failed), (also, poor) = _chosen(frames)
    assert (is_light, also) == (False, True)
    assert failed.name == 2
    assert poor.name == 8
    lost = pd.concat([frames, pd.DataFrame({"bound_rotation_rad": [np.nan], "right": [False], "charge": [2.2]})], ignore_index=True)
    assert next(row.name for is_light, row in _chosen(lost) if is_light) == 9
    flawless = frames.assign(right=True)
    assert [is_light for is_light, _ in _chosen(flawless)] == [True]
    assert list(_chosen(frames.assign(bound_rotation_rad=np.nan))) == []
