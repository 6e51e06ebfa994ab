"""Plots for the page as inline SVG whose colours are the page's CSS variables, so that they follow its light and dark."""

import io
import re
from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmark.svg_text import labelled, prefix_of, slim
from scenes.arrays import Bools, Floats

LINEAR_TO_DEG = 1.0  # the error axis is linear up to here and logarithmic beyond
MARKERS = "osD^vP"
_SIZE_IN = (4.6, 3.0)
_BAND = 0.055  # height of one method's row of failures, of the axes' height
# Colours that stand for CSS variables; matplotlib wants real ones, the SVG text is edited afterwards.
INK, FAINT = "#010101", "#020202"
SERIES = tuple(f"#0304{index:02d}" for index in range(len(MARKERS)))
_VARIABLES = {INK: "var(--ink)", FAINT: "var(--rule)"} | {
    colour: f"var(--series-{index})" for index, colour in enumerate(SERIES)
}


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """One method's signed errors against the true swept angle, degrees; ``answered`` (n,) marks where there is an answer."""

    title: str
    series: int
    truth_deg: Floats
    error_deg: Floats
    answered: Bools


def error_plot(tracks: Sequence[Track], salt: str, label: str) -> str:
    """Error against angle for all methods of one case and feature; unanswered frames are crosses in a band at the foot.

    ``salt`` keeps the element ids of several plots on one page apart; ``label`` says to a reader who cannot see it what it is.
    """
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": salt, "font.size": 8.5}):
        figure = Figure(figsize=_SIZE_IN, layout="constrained")
        axes: Axes = figure.add_subplot()
        axes.set_yscale("symlog", linthresh=LINEAR_TO_DEG, linscale=1.2)
        for track in tracks:
            _draw(axes, track)
        failing = [track for track in tracks if not track.answered.all()]
        _dress(axes, _limit(tracks), rows=len(failing))
        for row, track in enumerate(failing):
            _mark_failures(axes, track, row)
        return labelled(themed(figure, prefix_of(salt)), label)


def _limit(tracks: Sequence[Track]) -> float:
    """Half the height of the plot: what holds every error, and at least the linear part."""
    worst = [float(abs(track.error_deg[track.answered]).max()) for track in tracks if track.answered.any()]
    return max([LINEAR_TO_DEG, *worst]) * 1.15


def _draw(axes: Axes, track: Track) -> None:
    colour, marker = SERIES[track.series % len(SERIES)], MARKERS[track.series % len(MARKERS)]
    here = track.answered
    many = here.size > 60
    axes.plot(
        track.truth_deg[here], track.error_deg[here], marker, color=colour, markersize=2.5 if many else 4,
        markerfacecolor=colour if track.series else "none", markeredgewidth=1.0, label=track.title,
    )  # fmt: skip


def _mark_failures(axes: Axes, track: Track, row: int) -> None:
    """A row of crosses in the band below the errors, where the frames without an answer are."""
    colour, missing = SERIES[track.series % len(SERIES)], track.truth_deg[~track.answered]
    height = (row + 0.7) * _BAND
    across = axes.get_xaxis_transform()
    axes.plot(missing, [height] * len(missing), "x", color=colour, markersize=4, markeredgewidth=1.2, transform=across)


def _dress(axes: Axes, limit_deg: float, rows: int) -> None:
    """Axes, grid and labels; the lowest ``rows`` · ``_BAND`` of the height is kept free for the failures."""
    scale = axes.yaxis.get_transform()
    top = float(scale.transform(np.array([limit_deg]))[0])
    upper = float(scale.inverted().transform(np.array([1.06 * top]))[0])
    share = (rows + 0.4) * _BAND if rows else 0.0
    bottom = -top - 2.06 * top * share / (1 - share)
    axes.set_ylim(float(scale.inverted().transform(np.array([bottom]))[0]), upper)
    if rows:
        axes.axhline(-limit_deg, color=INK, linewidth=0.5, linestyle=(0, (2, 2)))
        axes.text(-0.012, share / 2, "none", transform=axes.transAxes, ha="right", va="center", color=INK)
    axes.axhline(0.0, color=INK, linewidth=0.8)
    axes.axhspan(-LINEAR_TO_DEG, LINEAR_TO_DEG, color=FAINT, alpha=0.35, linewidth=0)
    axes.grid(visible=True, color=FAINT, linewidth=0.6)
    ticks = [tick for tick in (-100, -30, -10, -3, -1, -0.5, 0, 0.5, 1, 3, 10, 30, 100) if abs(tick) <= limit_deg]
    axes.set_yticks(ticks, [f"{tick:g}".replace("-", "−") for tick in ticks])
    axes.minorticks_off()
    axes.set_xlabel("true swept angle (deg)", color=INK)
    axes.set_ylabel("answer − truth (deg)", color=INK)
    axes.tick_params(colors=INK, length=0)
    for name, spine in axes.spines.items():
        spine.set_visible(name in ("left", "bottom"))
        spine.set_color(FAINT)


def themed(figure: Figure, prefix: str) -> str:
    """The SVG element alone, transparent, with CSS variables for colours; ``prefix`` begins its ids and is no other plot's."""
    text = io.StringIO()
    figure.savefig(text, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    svg = text.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r'<svg [^>]*?viewBox="([^"]+)"[^>]*>', r'<svg viewBox="\1" role="img" class="plot">', svg, count=1)
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    svg = re.sub(r"font: ([0-9.]+)px [^;\"]*", r"font-size: \1px", svg)
    for colour, variable in _VARIABLES.items():
        svg = svg.replace(colour, variable)
    return slim(svg, prefix)
