"""Curves over a study's number factors: availability, and the error beside the bound: what the light took and the method left."""

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.axes import Axes

from benchmark.chart_group import Chart, ChartGroup, Sign
from benchmark.chart_style import canvas, dress, finished, look, sign
from benchmark.ranking_cells import figure, short
from benchmark.ranking_record import Estimate
from benchmark.report_plots import INK
from benchmark.study.record import FactorRecord
from benchmark.study.score_record import AVAILABLE, LevelScore, StudyScores
from benchmark.subjects import NAMES
from scenes.arrays import Floats

_WIDTH_IN, _ERROR_IN, _SHARE_IN = 4.4, 1.9, 0.9
_CAPTION = (
    "Above: median attitude error of the right answers, and the σ that the pictures allow (thick grey line), below which nobody "
    "gets without a prior; × at its foot: undetermined. Below: the share of frames answered right; dotted: 90 %. Bars: 95 % "
    "intervals. Grey stripe: what the scenario has."
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
    with canvas(_WIDTH_IN, [_ERROR_IN, _SHARE_IN]) as (drawing, (errors, shares)):
        _scale(errors, factor, levels)
        _bound(errors, [one for one in levels if one.method == methods[0]])
        for method in methods:
            mine = [one for one in levels if one.method == method]
            _line(errors, mine, "rotation_median_deg", places[method], 1.0)
            _line(shares, mine, "availability", places[method], 100.0)
        errors.set_yscale("log")
        shares.axhline(100 * AVAILABLE, color=INK, linewidth=0.7, linestyle=(0, (1, 1.5)))
        shares.set_ylim(-4, 104)
        shares.set_yticks([0, 50, 100])
        dress(errors, "", "error (deg)")
        dress(shares, title, "right (%)")
        _plain_numbers(errors)
        return Chart(title, finished(drawing, f"{prefix}-", summary), summary, _rows(levels, factor))


def _scale(axes: Axes, factor: FactorRecord, levels: list[LevelScore]) -> None:
    """The common axis of levels, and a stripe at the one that the scenario has."""
    values = sorted({one.value for one in levels if one.value is not None})
    if factor.scale == "log":
        axes.set_xscale("log")
        ticks, margin = values[:: 1 + len(values) // 8], (values[-1] / values[0]) ** 0.04
        axes.set_xticks(ticks, [f"{one:.3g}" for one in ticks])
        axes.set_xlim(values[0] / margin, values[-1] * margin)
    if factor.baseline is not None:
        for one in axes.figure.axes:
            one.axvline(factor.baseline, color=INK, linewidth=6, alpha=0.1)


def _bound(axes: Axes, levels: list[LevelScore]) -> None:
    known = [one for one in levels if one.bound_median_rad.value is not None]
    at = _values(known)
    sigma = [float(np.degrees(one.bound_median_rad.value or np.nan)) for one in known]
    axes.plot(at, sigma, color=INK, linewidth=3.2, alpha=0.3, solid_capstyle="round")
    lost = _values([one for one in levels if one.bound_determined.value is not None and one.bound_median_rad.value is None])
    axes.plot(lost, [0.02] * len(lost), "x", color=INK, markersize=6, transform=axes.get_xaxis_transform(), clip_on=False)


def _line(axes: Axes, levels: list[LevelScore], name: str, place: int, scale: float) -> None:
    """A method's values with their intervals, joined where neighbours are known."""
    at = _values(levels)
    estimates: list[Estimate] = [getattr(one, name) for one in levels]
    value, low, high = (
        np.array([np.nan if (end := getattr(one, which)) is None else scale * end for one in estimates])
        for which in ("value", "low", "high")
    )
    style = look(place)
    axes.plot(at, value, linewidth=1.3, markersize=4, **style)
    sure = np.isfinite(value) & np.isfinite(low) & np.isfinite(high)
    axes.vlines(at[sure], low[sure], high[sure], color=style["color"], linewidth=1.0, alpha=0.7)


def _values(levels: Sequence[LevelScore]) -> Floats:
    return np.array([np.nan if one.value is None else one.value for one in levels])


def _plain_numbers(axes: Axes) -> None:
    low, high = axes.get_ylim()
    ticks = [factor * 10.0**power for power in range(-6, 4) for factor in (1, 3) if low <= factor * 10.0**power <= high]
    if high / low > 300:
        ticks = [tick for tick in ticks if f"{tick:e}".startswith("1")]
    axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.set_ylim(low, high)
    axes.minorticks_off()


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
            "—" if one.bound_median_rad.value is None else short(float(np.degrees(one.bound_median_rad.value))),
            figure(one.charge, 1000),
        )
        for one in levels
    ]
    return heading, *lines
