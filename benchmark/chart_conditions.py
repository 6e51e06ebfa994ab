"""Error and availability against what varies: range, phase angle, light. Bins hold equally many frames, or one value each."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from benchmark.chart_draws import Draws, Places
from benchmark.chart_frames import Division, Quantity, by_method, quantities
from benchmark.chart_group import Chart
from benchmark.chart_stats import Bins, bins, quantile
from benchmark.chart_style import canvas, dress, finished, log_axis, look, mark, span
from benchmark.chart_words import NONE, amount, percent, told
from scenes.arrays import Floats

_WIDTH_IN, _ERROR_IN, _SHARE_IN = 3.6, 1.45, 0.6
_SPREAD = 0.5  # of a bin's width, over which the methods stand side by side


@dataclass(frozen=True, slots=True, eq=False)
class Condition:
    """A column of the pooled frames, its name and scale, and how far it must vary (in its own unit) to be worth a chart."""

    column: str
    title: str
    unit: str
    scale: float
    least_change: float
    is_relative: bool = False

    def varies(self, values: Floats) -> bool:
        """Whether ``values`` change by ``least_change``, of the largest where it is relative."""
        known = values[np.isfinite(values)]
        return known.size > 0 and float(np.ptp(known)) > self.least_change * (float(known.max()) if self.is_relative else 1.0)


CONDITIONS = (
    Condition("range_m", "range", "m", 1.0, 0.03, is_relative=True),
    Condition("phase_angle_deg", "phase angle", "deg", 1.0, 2.0),
    Condition("lit_fraction", "lit share of the target", "%", 100.0, 0.05),
    Condition("saturated_fraction", "saturated share of the target", "%", 100.0, 0.01),
)


@dataclass(frozen=True, slots=True, eq=False)
class Binned:
    """Per bin of one method: how many frames, the answered share, and the median of all frames with its 95 % interval.

    ``median``, ``low``, ``high`` are infinite where most frames have no answer, NaN without frames.
    """

    count: Floats
    available: Floats
    median: Floats
    low: Floats
    high: Floats


def binned(errors: Floats, member: np.ndarray, count: int, draws: Draws, places: Places) -> Binned:
    """``errors`` (n,) in ``count`` bins; ``member`` (n,) says which, ``places`` (n,) which frames of the ``draws`` they are.

    Medians as in the ranking: no answer is the largest error.
    """
    inside = [member == number for number in range(count)]
    parts = [errors[here] for here in inside]
    lows, highs = zip(*(draws.median_interval(errors[here], places[here]) for here in inside))
    return Binned(
        np.array([part.size for part in parts], dtype=np.float64),
        np.array([np.isfinite(part).mean() if part.size else np.nan for part in parts]),
        np.array([quantile(part, 0.5) for part in parts]),
        np.array(lows),
        np.array(highs),
    )


def condition_charts(division: Division, places: dict[str, int], prefix: str) -> Iterator[Chart]:
    """A chart for each condition that varies in the division and each error."""
    for number, condition in enumerate(CONDITIONS):
        values = division.frames[condition.column].to_numpy(dtype=np.float64)
        if condition.varies(values):
            shared = bins(condition.scale * values)
            for quantity in quantities(division.frames) if len(shared.names) > 1 else ():
                yield _chart(division, condition, quantity, shared, places, f"{prefix}{number}{quantity.column[0]}")


def _chart(division: Division, condition: Condition, quantity: Quantity, shared: Bins, places: dict[str, int],
           prefix: str) -> Chart:  # fmt: skip
    frames = division.frames.assign(bin=shared.member)
    table = {
        title: (place, _of_method(part, quantity, division.draws, len(shared.names)))
        for title, place, part in by_method(frames, places)
    }
    title = f"{quantity.title.capitalize()} against {condition.title}, {division.title}"
    summary = f"Medians in {len(shared.names)} bins of {condition.title}. {told(frames, quantity, places)}"
    with canvas(_WIDTH_IN, [_ERROR_IN, _SHARE_IN]) as (figure, (upper, lower)):
        finite = np.concatenate([np.concatenate([one.median, one.low, one.high]) for _, one in table.values()])
        ends = span(finite, quantity)
        log_axis(upper, "y", ends)
        mark(upper, quantity, "y")
        for number, (place, one) in enumerate(table.values()):
            aside = _SPREAD * ((number + 0.5) / len(table) - 0.5)
            _draw(upper, lower, one, place, aside, ends)
        _axes(upper, lower, shared, condition, quantity)
        svg = finished(figure, f"{prefix}-", f"{title}. {summary}")
    return Chart(title, svg, summary, _rows(table, shared, condition, quantity))


def _of_method(part: pd.DataFrame, quantity: Quantity, draws: Draws, count: int) -> Binned:
    errors = part[quantity.column].to_numpy(dtype=np.float64)
    return binned(errors, part["bin"].to_numpy(), count, draws, part["place"].to_numpy())


def _draw(upper: Axes, lower: Axes, one: Binned, place: int, aside: float, ends: tuple[float, float]) -> None:
    """Medians with their intervals above, the answered share below; no median is drawn where there is none."""
    at, style = np.arange(one.median.size) + aside, look(place)
    there = np.isfinite(one.median) & np.isfinite(one.low)
    upper.vlines(at[there], np.clip(one.low[there], *ends), np.clip(one.high[there], *ends), color=style["color"], linewidth=1.2)
    median = np.where(np.isfinite(one.median), np.clip(one.median, *ends), np.nan)
    upper.plot(at, median, markersize=3.6, linewidth=0.7, **style)
    lower.plot(at, one.available, markersize=3.0, linewidth=0.7, clip_on=False, **style)


def _axes(upper: Axes, lower: Axes, shared: Bins, condition: Condition, quantity: Quantity) -> None:
    count = len(shared.names)
    dress(upper, "", quantity.label.replace(" error", ""))
    dress(lower, f"{condition.title} ({condition.unit})", "answered (%)")
    lower.yaxis.label.set_fontsize(7.5)
    lower.set_xlim(-0.5, count - 0.5)
    if shared.edges is None:
        lower.set_xticks(np.arange(count), shared.names)
    else:
        lower.set_xticks(np.arange(count + 1) - 0.5, shared.edges)
    lower.set_ylim(-0.04, 1.04)
    lower.set_yticks([0, 0.5, 1], ["0", "50", "100"])


def _rows(
    table: dict[str, tuple[int, Binned]], shared: Bins, condition: Condition, quantity: Quantity
) -> tuple[tuple[str, ...], ...]:
    heading = (
        "method",
        f"{condition.title} ({condition.unit})",
        "frames",
        "answered",
        f"median ({quantity.unit})",
        "95 % interval",
    )
    lines = [
        (title, name, f"{one.count[row]:.0f}", percent(one.available[row]) if one.count[row] else NONE,
         amount(one.median[row]), f"{amount(one.low[row])} to {amount(one.high[row])}")
        for title, (_, one) in table.items()
        for row, name in enumerate(shared.names)
    ]  # fmt: skip
    return heading, *lines
