"""One point a method: how far off it is, how often it answers, and what it costs."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from benchmark.chart_frames import ROTATION, Division, Quantity, by_method, quantities
from benchmark.chart_group import Chart
from benchmark.chart_stats import quantile
from benchmark.chart_style import canvas, dress, finished, log_axis, look, mark, span
from benchmark.chart_words import NONE, amount, percent, told
from benchmark.report_plots import INK

_SIZE_IN = (3.6, 1.9)
_BESIDE = 0.1  # share of the axes' width for methods without a median


@dataclass(frozen=True, slots=True, eq=False)
class Point:
    """One method: the median over all frames (infinite where most have no answer), its interval, and what it is drawn against."""

    title: str
    place: int
    median: float
    low: float
    high: float
    against: float


def overview_charts(division: Division, places: dict[str, int], prefix: str) -> Iterator[Chart]:
    """Availability against each median error, then CPU time against the median rotation error where it is known."""
    for quantity in quantities(division.frames):
        points = list(_points(division, quantity, places, "answered", 1.0))
        yield _chart(division, quantity, points, places, f"{prefix}{quantity.column[0]}", is_cost=False)
    costs = [point for point in _points(division, ROTATION, places, "cpu_s", 1e3) if np.isfinite(point.against)]
    if costs:
        yield _chart(division, ROTATION, costs, places, f"{prefix}c", is_cost=True)


def _points(division: Division, quantity: Quantity, places: dict[str, int], column: str, scale: float) -> Iterator[Point]:
    for title, place, part in by_method(division.frames, places):
        errors, against = part[quantity.column].to_numpy(dtype=np.float64), part[column].to_numpy(dtype=np.float64)
        known = against[np.isfinite(against)]
        mean = scale * float(known.mean()) if known.size else float("nan")
        interval = division.draws.median_interval(errors, part["place"].to_numpy())
        yield Point(title, place, quantile(errors, 0.5), *interval, mean)


def _chart(division: Division, quantity: Quantity, points: Sequence[Point], places: dict[str, int], prefix: str,
           is_cost: bool) -> Chart:  # fmt: skip
    what = "CPU time" if is_cost else "Answered share"
    title = f"{what} and median {quantity.title}, {division.title}"
    costs = "; ".join(f"{point.title}: {amount(point.against)} ms a frame" for point in points)
    summary = f"{told(division.frames, quantity, places)}" + (f" CPU: {costs}." if is_cost else "")
    with canvas(_SIZE_IN[0], [_SIZE_IN[1]]) as (figure, (axes,)):
        ends = span(np.array([value for point in points for value in (point.median, point.low, point.high)]), quantity)
        log_axis(axes, "x", ends)
        if is_cost:
            log_axis(axes, "y", _decades([point.against for point in points]))
        else:
            axes.set_ylim(0, 1.04)
            axes.set_yticks(np.linspace(0, 1, 6), [f"{share:.0f}" for share in np.linspace(0, 100, 6)])
        mark(axes, quantity, "x")
        dress(axes, f"median {quantity.label}", "CPU (ms per frame)" if is_cost else "answered (%)")
        _draw(axes, points, ends)
        svg = finished(figure, f"{prefix}-", f"{title}. {summary}")
    return Chart(title, svg, summary, _rows(points, quantity, is_cost))


def _draw(axes: Axes, points: Sequence[Point], ends: tuple[float, float]) -> None:
    """A point with its interval; right of the axis those that have no median, because most frames have no answer."""
    low, high = ends
    if any(np.isinf(point.median) for point in points):
        wide = high * (high / low) ** (_BESIDE / (1 - _BESIDE))
        axes.set_xlim(low, wide)
        axes.axvline(high, color=INK, linewidth=0.5, linestyle=(0, (2, 2)))
        axes.text(1 - _BESIDE / 2, -0.03, "none", transform=axes.transAxes, ha="center", va="top", color=INK, fontsize=7.5)
        ends = (low, wide)
    for point in points:
        style = {**look(point.place), "linestyle": "none"}
        beside = float(np.sqrt(high * ends[1]))
        at = float(np.clip(point.median, low, None)) if np.isfinite(point.median) else beside
        if np.isfinite(point.median) and np.isfinite(point.low):
            axes.hlines(point.against, max(point.low, low), min(point.high, ends[1]), color=style["color"], linewidth=1.2)
        axes.plot([at], [point.against], markersize=6.5, clip_on=False, **style)


def _decades(values: Sequence[float]) -> tuple[float, float]:
    """Ends of a logarithmic axis around ``values``, at least a factor of ten apart."""
    known = np.array([value for value in values if value > 0] or [1.0])
    middle, reach = np.sqrt(known.min() * known.max()), max(np.sqrt(10), 1.4 * np.sqrt(known.max() / known.min()))
    return float(middle / reach), float(middle * reach)


def _rows(points: Sequence[Point], quantity: Quantity, is_cost: bool) -> tuple[tuple[str, ...], ...]:
    heading = ("method", "CPU (ms per frame)" if is_cost else "answered", f"median ({quantity.unit})", "95 % interval")
    lines = [
        (point.title, amount(point.against) if is_cost else percent(point.against), amount(point.median),
         NONE if np.isnan(point.low) else f"{amount(point.low)} to {amount(point.high)}")
        for point in points
    ]  # fmt: skip
    return heading, *lines
