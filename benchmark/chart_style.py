"""How charts look: small enough for a phone, methods told apart by colour, marker and dash."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import Affine2D, Transform, blended_transform_factory

from benchmark.chart_frames import Quantity
from benchmark.report_plots import FAINT, INK, MARKERS, SERIES, themed
from benchmark.svg_text import labelled
from scenes.arrays import Floats

LOWEST = 1e-3  # no logarithmic axis goes further down; smaller errors are drawn at its foot
DASHES: tuple[tuple[int, tuple[float, ...]], ...] = (
    (0, ()), (0, (5, 1.6)), (0, (1.3, 1.3)), (0, (6, 1.5, 1.3, 1.5)), (0, (3, 3)), (0, (6, 1.3, 1.3, 1.3, 1.3, 1.3)),
)  # fmt: skip
_STYLE = {
    "svg.fonttype": "none", "svg.hashsalt": "chart", "font.size": 8.5, "path.simplify_threshold": 0.3, "text.parse_math": False,
}  # fmt: skip
_MARGINS_IN = (0.58, 0.17, 0.40, 0.10)  # left, right, below, above


@contextmanager
def canvas(width_in: float, heights_in: Sequence[float]) -> Iterator[tuple[Figure, list[Axes]]]:
    """A figure with axes one above the other of these heights and a common x axis; margins are fixed, so that plots line up."""
    left, right, below, above = _MARGINS_IN
    gap = 0.14
    height = below + above + sum(heights_in) + gap * (len(heights_in) - 1)
    with mpl.rc_context(_STYLE):
        figure, top = Figure(figsize=(width_in, height)), height - above
        axes: list[Axes] = []
        for each in heights_in:
            box = (left / width_in, (top - each) / height, (width_in - left - right) / width_in, each / height)
            axes.append(figure.add_axes(box, sharex=axes[0] if axes else None))
            top -= each + gap
        for one in axes[:-1]:
            one.tick_params(labelbottom=False)
        yield figure, axes


def look(place: int) -> dict[str, Any]:
    """Line2D properties of the method at ``place``: six colours, each with a marker and a dash; the next six hollow."""
    colour = SERIES[place % len(SERIES)]
    hollow = place // len(SERIES) % 2 == 1
    return {
        "color": colour, "marker": MARKERS[place % len(MARKERS)], "linestyle": DASHES[(place + place // len(SERIES)) % len(DASHES)],
        "markerfacecolor": "none" if hollow else colour, "markeredgewidth": 0.9,
    }  # fmt: skip


def sign(place: int, prefix: str) -> str:
    """The method's line and marker for a legend, drawn as in the charts; ``prefix`` begins its ids."""
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(0.44, 0.15))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.plot([0, 0.5, 1], [0, 0, 0], markersize=5, linewidth=1.5, markevery=[1], **look(place))
        axes.set_axis_off()
        axes.set_xlim(-0.02, 1.02)
        svg = themed(figure, prefix)
    return svg.replace('role="img" class="plot"', 'class="sign" aria-hidden="true"', 1)


def span(errors: Floats, quantity: Quantity) -> tuple[float, float]:
    """Ends of a logarithmic axis that holds the finite ``errors`` but the least hundredth, and the line of wrong answers."""
    known = errors[np.isfinite(errors) & (errors > 0)]
    least, most = (np.quantile(known, 0.01), known.max()) if known.size else (quantity.speed, quantity.wrong)
    low = max(LOWEST, min(0.7 * least, 0.5 * quantity.speed))
    return float(low), float(max(1.2 * most, 1.5 * quantity.wrong))


def log_axis(axes: Axes, which: str, ends: tuple[float, float]) -> None:
    """A logarithmic axis ``which`` ("x", "y") between ``ends`` with plain numbers at the decades, and at 3 where these are few."""
    low, high = ends
    factors = (1, 3) if high / low < 300 else (1,)
    ticks = [step for power in range(-4, 6) for factor in factors if low <= (step := factor * 10.0**power) <= high]
    getattr(axes, f"set_{which}scale")("log")
    getattr(axes, f"set_{which}lim")(low, high)
    getattr(axes, f"set_{which}ticks")(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()


def mark(axes: Axes, quantity: Quantity, which: str) -> None:
    """Thin lines at SPEED's threshold (dotted) and at the error that counts as wrong (dashed), across the axis ``which``."""
    draw = axes.axvline if which == "x" else axes.axhline
    for value, dash in ((quantity.speed, (0, (1, 1.5))), (quantity.wrong, (0, (4, 2)))):
        draw(value, color=INK, linewidth=0.7, linestyle=dash, alpha=0.75)


def dress(axes: Axes, x_label: str, y_label: str) -> None:
    """Light grid, no frame, labels."""
    axes.grid(visible=True, color=FAINT, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_xlabel(x_label, color=INK, labelpad=2)
    axes.set_ylabel(y_label, color=INK)
    axes.yaxis.set_label_coords(-0.42, 0.5, transform=_inches(axes))
    axes.tick_params(colors=INK, length=0, which="both", pad=2)
    axes.minorticks_off()
    for name, spine in axes.spines.items():
        spine.set_visible(name in ("left", "bottom"))
        spine.set_color(FAINT)


def finished(figure: Figure, prefix: str, label: str) -> str:
    """The SVG with a text for readers who cannot see it; ``prefix`` begins its ids and is no other plot's on the page."""
    return labelled(themed(figure, prefix), label)


def _inches(axes: Axes) -> Transform:
    """x in inches right of the axes' left end, y in shares of their height: labels of all plots stand at the same place."""
    figure = axes.get_figure(root=True)
    assert figure is not None  # canvas put them there
    left = Affine2D().translate(axes.get_position().x0 * figure.get_figwidth(), 0)
    return blended_transform_factory(left + figure.dpi_scale_trans, axes.transAxes)
