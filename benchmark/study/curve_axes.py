"""The axes of a study's curves: levels that are not written over each other, errors whose ends their figures set."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from benchmark.report_plots import INK
from benchmark.study.record import FactorRecord
from scenes.arrays import Floats

_BESIDE = 0.04  # of the levels' span, either side
_APART = 0.085  # of the span between two written levels at least
_FEW = 300  # from the least to the largest: up to here a tick at 3 as well


def level_axis(axes: Axes, factor: FactorRecord, levels: Sequence[float]) -> None:
    """The common axis of ``levels``, rising, logarithmic where the factor is; a stripe at the one that the scenario has."""
    is_log = factor.scale == "log" and levels[0] > 0
    if is_log:
        axes.set_xscale("log")
    at = np.log(levels) if is_log else np.asarray(levels, dtype=np.float64)
    beside = _BESIDE * (at[-1] - at[0])
    ends = np.array([at[0] - beside, at[-1] + beside])
    axes.set_xlim(*(np.exp(ends) if is_log else ends))
    written = _written(at, at[-1] - at[0])
    axes.set_xticks([levels[place] for place in written], [f"{levels[place]:.4g}" for place in written])
    if factor.baseline is not None:
        for one in axes.figure.axes:
            one.axvline(factor.baseline, color=INK, linewidth=6, alpha=0.1)


def log_ends(figures: Floats) -> tuple[float, float]:
    """Ends of a logarithmic axis that holds the finite ``figures`` (n,); intervals may run out of it."""
    known = figures[np.isfinite(figures) & (figures > 0)]
    if not known.size:
        return 0.1, 10.0
    return float(known.min() / 2), float(2 * known.max())


def plain_numbers(axes: Axes, ends: tuple[float, float]) -> None:
    """Plain numbers at the decades between ``ends``, and at 3 where these are few."""
    low, high = ends
    steps = (1, 3) if high / low < _FEW else (1,)
    ticks = [step * 10.0**power for power in range(-7, 4) for step in steps if low <= step * 10.0**power <= high]
    axes.set_ylim(low, high)
    axes.set_yticks(ticks, [f"{tick:g}" if tick >= 1e-4 else f"{tick:.0e}" for tick in ticks])
    axes.minorticks_off()


def _written(at: Floats, span: float) -> list[int]:
    """The levels with room beside each other, from the first on; the last one always."""
    chosen = [len(at) - 1]
    for place in range(len(at) - 1):
        room_before = all(abs(at[place] - at[other]) >= _APART * span for other in chosen)
        if room_before:
            chosen.append(place)
    return sorted(chosen)
