"""Curves over a study's number factors: availability, and the error beside the bound: what the light took and the method left."""

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.axes import Axes

from benchmark.chart_group import Chart, ChartGroup, Sign
from benchmark.chart_style import canvas, dress, finished, look, sign
from benchmark.ranking_cells import figure, short
from benchmark.report_plots import INK
from benchmark.study.chart_links import Target, linked, place
from benchmark.study.curve_axes import level_axis, log_ends, plain_numbers
from benchmark.study.record import FactorRecord
from benchmark.study.score_record import AVAILABLE, LevelScore, StudyScores
from benchmark.subjects import NAMES
from scenes.arrays import Floats

_WIDTH_IN, _ERROR_IN, _SHARE_IN = 4.4, 1.9, 0.9
_CAPTION = (
    "Above: median attitude error of the right answers over the σ of the attitude that the light allows. Into the grey nobody "
    "gets without a prior; the median of a method that uses all there is lies a little below its edge. × at the foot: "
    "undetermined. Below: share of frames answered right; dotted: 90 %. Bars: 95 % intervals. Stripe: what the scenario has. A "
    "marker leads to its pictures."
)


def curve_groups(factors: Sequence[FactorRecord], scores: StudyScores, places: dict[str, int]) -> Iterator[ChartGroup]:
    """A group for each modality with a plot for each number factor that has several levels."""
    for modality in NAMES:
        plots, shown = [], dict[str, None]()
        for number, factor in enumerate(factors):
            mine = [one for one in scores.levels if (one.factor, one.modality) == (factor.name, modality) and one.value is not None]
            if factor.kind == "number" and len({one.value for one in mine}) > 1:
                plots.append(_chart(factor, mine, places, f"c{modality[0]}{number}"))
                shown |= dict.fromkeys(one.method for one in mine)
        if plots:
            legend = tuple(Sign(method, sign(places[method], f"c{modality[0]}s{places[method]}-")) for method in shown)
            yield ChartGroup(f"{modality}-curves", f"{NAMES[modality]}: what each factor does", _CAPTION, tuple(plots), legend)


def _chart(factor: FactorRecord, levels: list[LevelScore], places: dict[str, int], prefix: str) -> Chart:
    title = factor.title + (f" ({factor.unit})" if factor.unit else "")
    methods = list(dict.fromkeys(one.method for one in levels))
    summary = f"{factor.title}: " + "; ".join(_told(method, levels, factor) for method in methods)
    targets: list[Target] = []
    with canvas(_WIDTH_IN, [_ERROR_IN, _SHARE_IN]) as (drawing, (errors, shares)):
        level_axis(errors, factor, sorted({one.value for one in levels if one.value is not None}))
        ends = log_ends(np.concatenate([_values(levels, "rotation_median_deg")[0], _sigma_deg(levels)]))
        errors.set_yscale("log")
        _bound(errors, [one for one in levels if one.method == methods[0]], ends[0])
        for method in methods:
            mine = [one for one in levels if one.method == method]
            for axes, name, scale in ((errors, "rotation_median_deg", 1.0), (shares, "availability", 100.0)):
                _line(axes, mine, name, places[method], scale, len(targets))
                targets += [(one.points[0], f"{method} at {one.label}") for one in mine]
        shares.axhline(100 * AVAILABLE, color=INK, linewidth=0.7, linestyle=(0, (1, 1.5)))
        shares.set_ylim(-4, 104)
        shares.set_yticks([0, 50, 100])
        dress(errors, "", "error (deg)")
        dress(shares, title, "right (%)")
        plain_numbers(errors, ends)
        return Chart(title, linked(finished(drawing, f"{prefix}-", summary), targets), summary, _rows(levels, factor))


def _sigma_deg(levels: Sequence[LevelScore]) -> Floats:
    """(n,) the bound, NaN where there is none."""
    return np.array([np.nan if one.bound_median_rad.value is None else np.degrees(one.bound_median_rad.value) for one in levels])


def _values(levels: Sequence[LevelScore], name: str) -> tuple[Floats, Floats, Floats]:
    """(n,) each: a figure, the lower and the upper end of its interval, NaN where there is none."""
    parts = [[getattr(getattr(one, name), which) for one in levels] for which in ("value", "low", "high")]
    value, low, high = (np.array([np.nan if one is None else one for one in part], dtype=np.float64) for part in parts)
    return value, low, high


def _bound(axes: Axes, levels: list[LevelScore], foot: float) -> None:
    at, sigma = np.array([one.value for one in levels], dtype=np.float64), _sigma_deg(levels)
    axes.plot(at, sigma, color=INK, linewidth=2.2, alpha=0.4, solid_capstyle="round")
    axes.fill_between(at, sigma, np.full(len(at), foot), color=INK, alpha=0.1, linewidth=0)
    lost = at[[one.bound_determined.value is not None and one.bound_median_rad.value is None for one in levels]]
    axes.plot(lost, np.full(len(lost), 0.03), "x", color=INK, markersize=6, transform=axes.get_xaxis_transform(), clip_on=False)


def _line(axes: Axes, levels: list[LevelScore], name: str, number: int, scale: float, first: int) -> None:
    """A method's values with their intervals, joined where neighbours are known; targets from number ``first`` on."""
    at = np.array([one.value for one in levels], dtype=np.float64)
    value, low, high = (scale * part for part in _values(levels, name))
    style = look(number)
    axes.plot(at, value, linewidth=1.3, markersize=4, **style)
    sure = np.isfinite(value) & np.isfinite(low) & np.isfinite(high)
    axes.vlines(at[sure], low[sure], high[sure], color=style["color"], linewidth=1.0, alpha=0.7)
    place(axes, at, value, first)


def _told(method: str, levels: list[LevelScore], factor: FactorRecord) -> str:
    mine = [one for one in levels if one.method == method]
    worst = min(mine, key=lambda one: one.availability.value or 0.0)
    return f"{method} has {worst.availability.value or 0.0:.0%} right at {worst.value:g} {factor.unit}, its least"


def _rows(levels: list[LevelScore], factor: FactorRecord) -> tuple[tuple[str, ...], ...]:
    heading = (factor.unit or "level", "method", "% right", "error, ° median", "bound, ° σ", "score × 1000")
    lines = [
        (
            f"{one.value:g}{' (scenario)' if one.is_baseline else ''}",
            one.method,
            figure(one.availability, 100),
            figure(one.rotation_median_deg),
            _bound_text(one),
            figure(one.charge, 1000),
        )
        for one in levels
    ]
    return heading, *lines


def _bound_text(one: LevelScore) -> str:
    if one.bound_median_rad.value is not None:
        return short(float(np.degrees(one.bound_median_rad.value)))
    return "—" if one.bound_determined.value is None else "undetermined"
