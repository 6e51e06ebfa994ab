"""Plots of LIDAR filters as inline SVG: each state's error within ±3σ, honesty of σ over time, the registration of each scan."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmark.filter_states import STATES, State
from benchmark.report_plots import FAINT, INK, MARKERS, SERIES, themed
from benchmark.svg_text import labelled, prefix_of
from scenes.arrays import Floats

_STATES_IN, _WIDE_IN = (9.4, 7.2), (4.6, 3.0)
_MOST = 180  # points of a line; of each stretch of time the largest error is drawn
_DASHES = ((0, ()), (0, (5, 1.5)), (0, (1.5, 1.2)))  # of the components x, y, z


@dataclass(frozen=True, slots=True, eq=False)
class StateTrack:
    """One method's errors on one data set: state → (n, components) and their σ (n, components), None where it states none."""

    series: int
    time_s: Floats
    errors: dict[str, Floats]
    sigmas: dict[str, Floats | None]
    inertia_error: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """One method's numbers over time."""

    series: int
    time_s: Floats
    values: Floats


def state_plot(track: StateTrack, salt: str, label: str) -> str:
    """A panel for each state: components as lines, ±3σ of the least certain one as a band, the paper's level shaded."""
    with _style(salt):
        figure = Figure(figsize=_STATES_IN, layout="constrained")
        panels = figure.subplots(4, 2, sharex=True).ravel()
        for panel, state in zip(panels, STATES):
            _state_panel(panel, state, track)
        _inertia_panel(panels[len(STATES)], track)
        for panel in panels[-2:]:
            panel.set_xlabel("time (s)", color=INK)
        return labelled(themed(figure, prefix_of(salt)), label)


def honesty_plot(lines: Sequence[Line], bounds: tuple[float, float], salt: str, label: str) -> str:
    """Mean NEES over the seeds against time, one line a method; between the shaded bounds 95 % of honest means lie."""
    with _style(salt):
        figure = Figure(figsize=_WIDE_IN, layout="constrained")
        axes: Axes = figure.add_subplot()
        axes.set_yscale("log")
        axes.axhspan(*bounds, color=FAINT, alpha=0.6, linewidth=0)
        _draw_lines(axes, lines, np.nanmax)
        _dress(axes, "NEES, mean over seeds")
        _decades(axes)
        axes.set_xlabel("time (s)", color=INK)
        return labelled(themed(figure, prefix_of(salt)), label)


def registration_plot(attitude: Sequence[Line], position: Sequence[Line], salt: str, label: str) -> str:
    """Error of each scan's registration: attitude above, position below, logarithmic."""
    with _style(salt):
        figure = Figure(figsize=(_WIDE_IN[0], 4.2), layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True)
        for axes, lines, name in ((upper, attitude, "ICP attitude (deg)"), (lower, position, "ICP position (m)")):
            axes.set_yscale("log")
            for line in lines:
                colour, marker = SERIES[line.series % len(SERIES)], MARKERS[line.series % len(MARKERS)]
                time_s, values = thinned(line.time_s, line.values, np.nanmax)
                axes.plot(time_s, values, marker, color=colour, markersize=2.2, markeredgewidth=0.7, markerfacecolor="none")
            _dress(axes, name)
            _decades(axes)
        lower.set_xlabel("time (s)", color=INK)
        return labelled(themed(figure, prefix_of(salt)), label)


def thinned(time_s: Floats, values: Floats, choose: Callable[..., Floats], most: int = _MOST) -> tuple[Floats, Floats]:
    """At most ``most`` stretches of time and the chosen value (``np.nanmax`` ...) of each; stretches without a number are left out.

    ``values`` (n, ...) along the first axis.
    """
    step = max(1, -(-len(time_s) // most))
    whole = len(time_s) // step * step
    count = whole // step if whole == len(time_s) else whole // step + 1
    padded = np.full((count * step, *values.shape[1:]), np.nan)
    padded[: len(values)] = values
    stretches = padded.reshape(count, step, *values.shape[1:])
    there = np.isfinite(stretches).any(axis=tuple(range(1, stretches.ndim)))
    middles = time_s[np.minimum(np.arange(count) * step + step // 2, len(time_s) - 1)]
    if not there.any():
        return np.empty(0), np.empty((0, *values.shape[1:]))
    return middles[there], choose(np.where(np.isfinite(stretches[there]), stretches[there], np.nan), axis=1)


def largest(stretches: Floats, axis: int) -> Floats:
    """The value of the largest magnitude along ``axis``, with its sign; NaN where there is none."""
    sizes = np.where(np.isnan(stretches), -1.0, np.abs(stretches))
    return np.take_along_axis(stretches, np.expand_dims(sizes.argmax(axis=axis), axis), axis=axis).squeeze(axis)


def _state_panel(axes: Axes, state: State, track: StateTrack) -> None:
    axes.set_yscale("symlog", linthresh=state.level, linscale=1.0)
    axes.axhspan(-state.level, state.level, color=FAINT, alpha=0.55, linewidth=0)
    axes.axhline(0.0, color=INK, linewidth=0.5)
    colour, sigma = SERIES[track.series % len(SERIES)], track.sigmas[state.key]
    if sigma is not None:
        time_s, widest = thinned(track.time_s, _widest(sigma), np.nanmax)
        axes.fill_between(time_s, -3 * widest, 3 * widest, color=colour, alpha=0.18, linewidth=0)
    time_s, errors = thinned(track.time_s, track.errors[state.key], largest)
    for column, dash in zip(errors.T, _DASHES):
        axes.plot(time_s, column, color=colour, linewidth=0.9, linestyle=dash)
    _limit(axes, state.level, errors)
    _dress(axes, state.symbol + (f" ({state.unit})" if state.unit else ""))


def _widest(sigma: Floats) -> Floats:
    """(n,) the largest σ of a row's components; NaN where the row has none."""
    known = np.where(np.isfinite(sigma), sigma, -1.0).max(axis=1)
    return np.where(known < 0, np.nan, known)


def _inertia_panel(axes: Axes, track: StateTrack) -> None:
    axes.set_yscale("log")
    time_s, values = thinned(track.time_s, track.inertia_error, np.nanmax)
    axes.plot(time_s, np.maximum(values, 1e-4), color=SERIES[track.series % len(SERIES)], linewidth=0.9)
    _dress(axes, "inertia, relative error")
    _decades(axes)


def _limit(axes: Axes, level: float, errors: Floats) -> None:
    """The axis holds every error and the paper's level; ticks at the level and at decades beyond."""
    worst = float(np.nanmax(np.abs(errors), initial=0.0)) if np.isfinite(errors).any() else 0.0
    top = 1.3 * max(1.5 * level, min(worst, 1e4 * level))
    ticks = [level * 10**power for power in range(5) if level * 10**power < top]
    axes.set_ylim(-top, top)
    axes.set_yticks([-tick for tick in ticks[::-1]] + [0.0, *ticks])
    axes.set_yticklabels([f"{tick:g}".replace("-", "−") for tick in axes.get_yticks()])


def _draw_lines(axes: Axes, lines: Sequence[Line], choose: Callable[..., Floats]) -> None:
    for line in lines:
        time_s, values = thinned(line.time_s, line.values, choose)
        axes.plot(time_s, values, color=SERIES[line.series % len(SERIES)], linewidth=1.0)


def _decades(axes: Axes) -> None:
    """Ticks of a logarithmic axis: whole decades, with 2 and 5 between them where there are few."""
    low, high = axes.get_ylim()
    fine = high / low < 50
    steps = [factor * 10.0**power for power in range(-9, 13) for factor in ((1, 2, 5) if fine else (1,))]
    shown = [step for step in steps if low <= step <= high]
    axes.set_yticks(shown, [f"{step:g}" for step in shown])
    axes.set_ylim(low, high)
    axes.minorticks_off()


def _style(salt: str) -> AbstractContextManager[None]:
    return mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": salt, "font.size": 8.5, "path.simplify_threshold": 0.3})


def _dress(axes: Axes, label: str) -> None:
    axes.grid(visible=True, color=FAINT, linewidth=0.6)
    axes.set_ylabel(label, color=INK)
    axes.tick_params(colors=INK, length=0, which="both")
    axes.minorticks_off()
    for name, spine in axes.spines.items():
        spine.set_visible(name in ("left", "bottom"))
        spine.set_color(FAINT)
