"""Error against frame for rings: the centre's distance error and the normal's angle, one above the other, as inline SVG."""

from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from benchmark.report_plots import FAINT, INK, MARKERS, SERIES, themed
from benchmark.svg_text import labelled, prefix_of
from scenes.arrays import Bools, Floats

LINEAR_TO_MM = 1.0  # the position axis is linear up to here and logarithmic beyond
_LEAST_DEG = 1e-3  # the lowest angle that is drawn
_SIZE_IN = (4.6, 4.2)
_FOOT = 0.05  # height of the row of failures, of the axes' height
_DECADES = tuple(10.0**power for power in range(-3, 6))


@dataclass(frozen=True, slots=True, eq=False)
class RingTrack:
    """One method's errors by frame: along the optical axis in mm, of the normal in degrees; ``answered`` (n,) marks answers."""

    title: str
    series: int
    frames: Floats
    z_error_mm: Floats
    normal_error_deg: Floats
    answered: Bools


def ring_plot(tracks: Sequence[RingTrack], salt: str, label: str) -> str:
    """Both errors for all methods of one case; unanswered frames are crosses at the foot of the lower panel.

    ``salt`` keeps the element ids of several plots on one page apart; ``label`` says to a reader who cannot see it what it is.
    """
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": salt, "font.size": 8.5}):
        figure = Figure(figsize=_SIZE_IN, layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True)
        upper.set_yscale("symlog", linthresh=LINEAR_TO_MM, linscale=0.8)
        lower.set_yscale("log")
        for track in tracks:
            _draw(upper, track, track.z_error_mm)
            _draw(lower, track, np.maximum(track.normal_error_deg, _LEAST_DEG))
        _dress(upper, "z error (mm)")
        _dress(lower, "normal error (deg)")
        _limit(upper, lower, tracks)
        for row, track in enumerate(track for track in tracks if not track.answered.all()):
            _mark_failures(lower, track, row)
        lower.set_xlabel("frame", color=INK)
        lower.xaxis.set_major_locator(MaxNLocator(integer=True))
        return labelled(themed(figure, prefix_of(salt)), label)


def _draw(axes: Axes, track: RingTrack, values: Floats) -> None:
    colour, marker = SERIES[track.series % len(SERIES)], MARKERS[track.series % len(MARKERS)]
    here = track.answered & np.isfinite(values)
    axes.plot(
        track.frames[here], values[here], marker, color=colour, markersize=2.5 if here.size > 60 else 4,
        markerfacecolor=colour if track.series else "none", markeredgewidth=1.0, label=track.title,
    )  # fmt: skip


def _limit(upper: Axes, lower: Axes, tracks: Sequence[RingTrack]) -> None:
    """Limits and ticks that hold every error; whole decades, so that the figures of two cases compare at a glance."""
    worst_mm = max([LINEAR_TO_MM, *(float(np.nanmax(np.abs(one.z_error_mm), initial=0.0)) for one in tracks)])
    angles = np.concatenate([one.normal_error_deg[one.answered & (one.normal_error_deg > 0)] for one in tracks])
    low = max(_LEAST_DEG, float(angles.min())) if angles.size else 0.1
    high = float(angles.max()) if angles.size else 1.0
    ticks = [-tick for tick in _DECADES[::-1] if LINEAR_TO_MM <= tick <= worst_mm] + [0.0]
    ticks += [tick for tick in _DECADES if LINEAR_TO_MM <= tick <= worst_mm]
    upper.set_ylim(-1.6 * worst_mm, 1.6 * worst_mm)
    upper.set_yticks(ticks, [f"{tick:g}".replace("-", "−") for tick in ticks])
    upper.axhline(0.0, color=INK, linewidth=0.8)
    upper.axhspan(-LINEAR_TO_MM, LINEAR_TO_MM, color=FAINT, alpha=0.35, linewidth=0)
    bottom, top = 10 ** np.floor(np.log10(low)), 10 ** np.ceil(np.log10(max(high, 1.01 * low)))
    lower.set_ylim(bottom / 2.5, top)
    shown = [tick for tick in _DECADES if bottom <= tick <= top]
    lower.set_yticks(shown, [f"{tick:g}" for tick in shown])


def _mark_failures(axes: Axes, track: RingTrack, row: int) -> None:
    colour, missing = SERIES[track.series % len(SERIES)], track.frames[~track.answered]
    height = (row + 0.7) * _FOOT
    across = axes.get_xaxis_transform()
    axes.plot(missing, [height] * len(missing), "x", color=colour, markersize=4, markeredgewidth=1.2, transform=across)


def _dress(axes: Axes, label: str) -> None:
    axes.grid(visible=True, color=FAINT, linewidth=0.6)
    axes.set_ylabel(label, color=INK)
    axes.tick_params(colors=INK, length=0, which="both")
    axes.minorticks_off()
    for name, spine in axes.spines.items():
        spine.set_visible(name in ("left", "bottom"))
        spine.set_color(FAINT)
