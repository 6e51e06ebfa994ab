"""Where the variance of a method's score comes from: bars of each factor's share, alone and in all."""

from collections.abc import Iterator, Sequence
from typing import Any

from matplotlib.axes import Axes

from benchmark.chart_group import Chart, ChartGroup, Sign
from benchmark.chart_style import canvas, dress, finished, look, sign
from benchmark.leaderboard import minus
from benchmark.ranking_cells import figure, interval
from benchmark.ranking_record import Estimate
from benchmark.report_plots import INK
from benchmark.study.record import FactorRecord
from benchmark.study.score_record import Sensitivity, StudyScores
from benchmark.subjects import NAMES

_WIDTH_IN, _HEADING_IN, _BAR_IN = 4.4, 0.24, 0.17
_BEFORE, _MOST = -0.03, 1.05  # shares of the variance: where markers stand, where intervals are cut
_OUTPUTS = {"charge": "score", "availability": "share of right answers"}
_CAPTION = (
    "Sobol' indices: full bar, what the factor does alone (first order); pale bar, with all in which it has a part (total). "
    "Lines: 95 % intervals."
)


def sensitivity_groups(factors: Sequence[FactorRecord], scores: StudyScores, places: dict[str, int]) -> Iterator[ChartGroup]:
    """A group for each modality with a plot for each output that has indices."""
    for modality in NAMES:
        plots, shown = [], dict[str, None]()
        for output in _OUTPUTS:
            mine = [one for one in scores.sensitivity if one.modality == modality and one.output == output and one.indices]
            if mine:
                plots.append(_chart(factors, mine, places, f"s{modality[0]}{output[0]}"))
                shown |= dict.fromkeys(one.method for one in mine)
        if plots:
            legend = tuple(Sign(method, sign(places[method], f"s{modality[0]}s{places[method]}-")) for method in shown)
            yield ChartGroup(f"{modality}-sensitivity", NAMES[modality], _CAPTION, tuple(plots), legend)


def _chart(factors: Sequence[FactorRecord], found: list[Sensitivity], places: dict[str, int], prefix: str) -> Chart:
    output, titles = _OUTPUTS[found[0].output], {one.name: one.title for one in factors}
    title = f"Variance of the {output}"
    summary = f"{title}: " + "; ".join(_told(one, titles) for one in found)
    names = [index.factor for index in found[0].indices or ()]
    group_in = _HEADING_IN + _BAR_IN * len(found)
    with canvas(_WIDTH_IN, [group_in * len(names)]) as (drawing, (axes,)):
        for row, name in enumerate(names):
            top = row * group_in
            axes.text(0, top + 0.6 * _HEADING_IN, titles[name], color=INK, va="center", fontsize=8)
            for place, one in enumerate(found):
                index = next(index for index in one.indices or () if index.factor == name)
                middle = top + _HEADING_IN + (place + 0.5) * _BAR_IN
                _bars(axes, index.first, index.total, middle, look(places[one.method]))
        axes.set_ylim(group_in * len(names), 0)
        axes.set_xlim(2 * _BEFORE, _MOST)
        dress(axes, "share of the variance", "")
        axes.set_yticks([])
        axes.axvline(0, color=INK, linewidth=0.7)
        return Chart(title, finished(drawing, f"{prefix}-", summary), summary, tuple(_rows(found, titles)))


def _bars(axes: Axes, first: Estimate, total: Estimate, middle: float, style: dict[str, Any]) -> None:
    """Two bars, the full one above the pale one, each with its interval; the method's marker before them."""
    half = 0.42 * _BAR_IN
    for one, alpha, shift in ((first, 0.9, -half / 2), (total, 0.35, half / 2)):
        if one.value is None:
            continue
        axes.barh(middle + shift, max(one.value, 0.0), height=half, color=style["color"], alpha=alpha, linewidth=0)
        if one.low is not None and one.high is not None:
            axes.hlines(middle + shift, max(one.low, 0.0), min(one.high, _MOST), color=INK, linewidth=0.8)
    axes.plot([_BEFORE], [middle], markersize=4, clip_on=False, **(style | {"linestyle": "none"}))


def _told(one: Sensitivity, titles: dict[str, str]) -> str:
    most = max(one.indices or (), key=lambda index: index.total.value or 0.0)
    return f"of {one.method} most comes from {titles[most.factor]}, {figure(most.total, 100)} % in all"


def _rows(found: list[Sensitivity], titles: dict[str, str]) -> Iterator[tuple[str, ...]]:
    yield "factor", "method", "alone, %", "95 % interval", "in all, %", "95 % interval"
    for one in found:
        for index in one.indices or ():
            parts = (text for each in (index.first, index.total) for text in (figure(each, 100), interval(each, 100)))
            yield titles[index.factor], one.method, *map(minus, parts)
