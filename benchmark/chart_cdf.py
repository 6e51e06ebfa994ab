"""Distribution functions: which share of ALL frames has an error up to so much."""

from collections.abc import Iterator

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from benchmark.chart_frames import Division, Quantity, by_method, quantities
from benchmark.chart_group import Chart
from benchmark.chart_stats import cdf, quantile
from benchmark.chart_style import canvas, dress, finished, log_axis, look, mark, span
from benchmark.chart_words import amount, percent, told
from scenes.arrays import Floats

_SIZE_IN = (3.6, 2.1)
_STEPS_UP_TO = 100  # frames; with fewer, the function's steps show


def cdf_charts(division: Division, places: dict[str, int], prefix: str) -> Iterator[Chart]:
    """One chart for the rotation, and one for the position where the division has positions."""
    for quantity in quantities(division.frames):
        yield _chart(division, quantity, places, f"{prefix}{quantity.column[0]}")


def _chart(division: Division, quantity: Quantity, places: dict[str, int], prefix: str) -> Chart:
    title = f"{quantity.title.capitalize()}, {division.title}"
    summary = f"Share of all frames against {quantity.title}. {told(division.frames, quantity, places)}"
    with canvas(_SIZE_IN[0], [_SIZE_IN[1]]) as (figure, (axes,)):
        ends = span(division.frames[quantity.column].to_numpy(dtype=np.float64), quantity)
        log_axis(axes, "x", ends)
        mark(axes, quantity, "x")
        for _, place, part in by_method(division.frames, places):
            _draw(axes, part[quantity.column].to_numpy(dtype=np.float64), place, ends)
        axes.set_ylim(0, 1.02)
        axes.set_yticks(np.linspace(0, 1, 6), [f"{share:.0f}" for share in np.linspace(0, 100, 6)])
        dress(axes, quantity.label, "share of all frames (%)")
        return Chart(
            title, finished(figure, f"{prefix}-", f"{title}. {summary}"), summary, _rows(division.frames, quantity, places)
        )


def _draw(axes: Axes, errors: Floats, place: int, ends: tuple[float, float]) -> None:
    """From nothing at the left to the answered share, which goes on to the right end as a plateau."""
    at, share = cdf(errors)
    at = np.concatenate([[ends[0]], np.clip(at, ends[0], None), [ends[1]]])
    share = np.concatenate([[0.0], share, share[-1:] if share.size else [0.0]])
    line = {**look(place), "marker": "none"}
    style = "steps-post" if errors.size <= _STEPS_UP_TO else "default"
    axes.plot(at, share, drawstyle=style, linewidth=1.3, **line)


def _rows(frames: pd.DataFrame, quantity: Quantity, places: dict[str, int]) -> tuple[tuple[str, ...], ...]:
    marks = (quantity.speed, 1.0, quantity.wrong)
    heading = ("method", "frames", "answered", *(f"≤ {value:.3g} {quantity.unit}" for value in marks), "median", "95th percentile")
    lines = []
    for title, _, part in by_method(frames, places):
        errors = part[quantity.column].to_numpy(dtype=np.float64)
        shares = [percent(float(np.mean(errors <= value))) for value in marks]
        levels = [amount(quantile(errors, share)) for share in (0.5, 0.95)]
        lines.append((title, str(errors.size), percent(float(np.isfinite(errors).mean())), *shares, *levels))
    return heading, *lines
