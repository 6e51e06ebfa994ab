"""Error against time, a small panel for each case and subject: the median of its seeds in a band from the least to the largest."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from benchmark.chart_frames import Quantity, by_method, quantities
from benchmark.chart_group import Chart
from benchmark.chart_stats import Ints, quantile, stretches
from benchmark.chart_style import canvas, dress, finished, log_axis, look, mark, span
from benchmark.chart_words import NONE, amount, percent, told
from benchmark.report_plots import INK
from scenes.arrays import Bools, Floats

MOST_PANELS = 12
_WIDTH_IN, _ALONE_IN, _PAIRED_IN = 3.2, 1.6, 1.15
_MOST = 48  # stretches of time of a line
_COLUMNS = 4  # stretches of time of the table
_BAND = 0.075  # height of one method's row of failures, of the axes' height
_FOOT = 0.3  # of a row, which stays free


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """Errors over time: of each stretch its middle (s), the least, median and largest error, whether a frame has no answer.

    The three are NaN where nothing is answered. ``is_single``: no stretch holds more than one frame.
    """

    time_s: Floats
    least: Floats
    median: Floats
    largest: Floats
    failing: Bools
    is_single: bool


def panels(frames: pd.DataFrame, most: int = MOST_PANELS) -> tuple[dict[str, pd.DataFrame], tuple[str, ...]]:
    """Title → frames of at most ``most`` pairs of case and subject, and the titles that are left out.

    First every case with its first subject, then with its second, and so on; of too many in one round those evenly spaced.
    """
    several = [column for column in ("subject", "sensor") if frames[column].nunique() > 1]
    groups = {tuple(str(name) for name in key): part for key, part in frames.groupby(["case", *several], sort=False)}
    rounds: dict[int, list[tuple[str, ...]]] = {}
    for key in groups:
        before = sum(other[0] == key[0] for one in rounds.values() for other in one)
        rounds.setdefault(before, []).append(key)
    chosen: list[tuple[str, ...]] = []
    for one in rounds.values():
        room = min(most - len(chosen), len(one))
        chosen += [one[int(index)] for index in np.linspace(0, len(one) - 1, room).round()] if room else []
    titles = {key: ", ".join(key) for key in groups}
    return {titles[key]: groups[key] for key in groups if key in chosen}, tuple(titles[key] for key in groups if key not in chosen)


def time_charts(shown: dict[str, pd.DataFrame], frames: pd.DataFrame, places: dict[str, int], prefix: str) -> Iterator[Chart]:
    """A chart for each of ``shown``; all on the axes of error that hold all ``frames`` of the modality, so that they compare."""
    asked = quantities(frames)
    ends = {one.column: span(frames[one.column].to_numpy(dtype=np.float64), one) for one in asked}
    for number, (title, part) in enumerate(shown.items()):
        yield _chart(title, part, asked, ends, places, f"{prefix}{number}")


def course(times: Ints, middles_s: Floats, errors: Floats) -> Course:
    """What is drawn of one method: ``times`` (n,) are the stretches of its ``errors`` (n,), infinite without an answer."""
    known = np.isfinite(errors)
    parts = pd.Series(errors[known]).groupby(times[known]).agg(["min", "median", "max"]).reindex(range(middles_s.size))
    failing = np.bincount(times[~known], minlength=middles_s.size) > 0
    least, median, largest = (parts[name].to_numpy(dtype=np.float64) for name in ("min", "median", "max"))
    return Course(middles_s, least, median, largest, failing, bool(np.bincount(times).max(initial=0) <= 1))


def _chart(title: str, part: pd.DataFrame, asked: tuple[Quantity, ...], ends: dict[str, tuple[float, float]],
           places: dict[str, int], prefix: str) -> Chart:  # fmt: skip
    summary = f"Error against time. {told(part, asked[0], places)}"
    times, middles_s = stretches(part["time_s"].to_numpy(dtype=np.float64), _MOST)
    part = part.assign(stretch=times)
    heights = [_ALONE_IN] if len(asked) == 1 else [_PAIRED_IN] * len(asked)
    with canvas(_WIDTH_IN, heights) as (figure, all_axes):
        for axes, quantity in zip(all_axes, asked):
            courses = {
                place: course(one["stretch"].to_numpy(), middles_s, one[quantity.column].to_numpy(dtype=np.float64))
                for _, place, one in by_method(part, places)
            }
            _panel(axes, courses, quantity, ends[quantity.column], is_last=axes is all_axes[-1])
        svg = finished(figure, f"{prefix}-", f"{title}. {summary}")
    return Chart(title, svg, summary, _rows(part, asked[0], places))


def _panel(axes: Axes, courses: dict[int, Course], quantity: Quantity, ends: tuple[float, float], is_last: bool) -> None:
    failing = {place: one for place, one in courses.items() if one.failing.any()} if is_last else {}
    log_axis(axes, "y", ends)
    mark(axes, quantity, "y")
    dress(axes, "time (s)" if is_last else "", quantity.label.replace("rotation error", "rotation").replace(" error", ""))
    for place, one in courses.items():
        _draw(axes, one, place, ends[0])
    _foot(axes, failing, ends)


def _draw(axes: Axes, one: Course, place: int, low: float) -> None:
    style = look(place)
    if one.is_single:
        axes.plot(one.time_s, np.maximum(one.median, low), markersize=2.6, **{**style, "linestyle": "none"})
        return
    axes.fill_between(one.time_s, np.maximum(one.least, low), np.maximum(one.largest, low),
                      color=style["color"], alpha=0.16, linewidth=0)  # fmt: skip
    axes.plot(one.time_s, np.maximum(one.median, low), linewidth=1.1, **{**style, "marker": "none"})


def _foot(axes: Axes, failing: dict[int, Course], ends: tuple[float, float]) -> None:
    """A row of crosses for each method below the lowest error, where frames have no answer."""
    if not failing:
        return
    low, high = ends
    share = (len(failing) + _FOOT) * _BAND
    kept = [tick for tick in axes.get_yticks() if tick > 2 * low]  # one lower would run into the word below
    axes.set_yticks(kept, [f"{tick:g}" for tick in kept])
    axes.minorticks_off()
    axes.set_ylim(low / (high / low) ** (share / (1 - share)), high)
    axes.axhline(low, color=INK, linewidth=0.5, linestyle=(0, (2, 2)))
    axes.text(-0.02, share / 2, "none", transform=axes.transAxes, ha="right", va="center", color=INK, fontsize=7.5)
    for row, (place, one) in enumerate(failing.items()):
        missing = one.time_s[one.failing]
        height = np.full(missing.size, (row + 0.5 + _FOOT / 2) * _BAND)
        axes.plot(missing, height, "x", color=look(place)["color"], markersize=3.2, markeredgewidth=0.9,
                  transform=axes.get_xaxis_transform())  # fmt: skip


def _rows(part: pd.DataFrame, quantity: Quantity, places: dict[str, int]) -> tuple[tuple[str, ...], ...]:
    """Of each method the answered share, and the median over all frames in stretches of time."""
    times, _ = stretches(part["time_s"].to_numpy(dtype=np.float64), _COLUMNS)
    grouped = part["time_s"].groupby(times).agg(["min", "max"])
    heading = tuple(f"median {row['min']:.4g} to {row['max']:.4g} s ({quantity.unit})" for _, row in grouped.iterrows())
    lines = []
    for title, _, one in by_method(part.assign(stretch=times), places):
        parts = {stretch: group.to_numpy(dtype=np.float64) for stretch, group in one.groupby("stretch")[quantity.column]}
        medians = [amount(quantile(parts[key], 0.5)) if key in parts else NONE for key in grouped.index]
        lines.append((title, str(one["run"].nunique()), percent(float(one["answered"].mean())), *medians))
    return ("method", "runs", "answered", *heading), *lines
