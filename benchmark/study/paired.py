"""The paired bootstrap of studies: units are drawn in blocks of successive frames, the same at all levels and of all methods.

Of every statistic the first row is that of the units as they are, the others are those of the draws.
"""

from dataclasses import dataclass

import numpy as np

from benchmark.ranking_bootstrap import SHORTEST, Counts, between, bounds, counted, draw, sums
from benchmark.ranking_record import Estimate
from benchmark.ranking_rule import RESAMPLES, SEED
from benchmark.study.level_sets import LevelSet
from benchmark.study.panel import Panel
from scenes.arrays import Floats

_AT_ONCE = 250  # draws, which bounds the memory of medians


@dataclass(frozen=True, slots=True, eq=False)
class Paired:
    """A panel with its draws. ``counts`` (units, 1 + draws): how often each draw took each unit; the first takes each once."""

    panel: Panel
    counts: Counts

    def estimate(self, samples: Floats) -> Estimate:
        """From a statistic's rows (1 + draws,): NaN means that there is none, and a draw without one is left out.

        Infinite is what no figure is above: None, as an upper end of an interval too.
        """
        value, drawn = samples[0], samples[1:][~np.isnan(samples[1:])]
        if not np.isfinite(value):
            return Estimate(value=None)
        if self.panel.units < SHORTEST or not drawn.size:
            return Estimate(value=float(value))
        low, high = bounds(drawn)
        return Estimate(value=float(value), low=low, high=high if np.isfinite(high) else None)

    def means(self, values: Floats) -> Floats:
        """(1 + draws, ...) means over the units of ``values`` (units, ...)."""
        shape = values.shape[1:]
        return (sums(self.counts, values.reshape(len(values), -1)) / self.panel.units).reshape(-1, *shape)


@dataclass(frozen=True, slots=True, eq=False)
class LevelDraws:
    """Of each level and method (1 + draws, levels, methods): the share of right answers, the mean charge.

    ``..._change``: their paired differences from what ``LevelSet.against`` says; None where there is nothing to compare with.
    """

    levels: LevelSet
    availability: Floats
    charge: Floats
    availability_change: Floats | None
    charge_change: Floats | None


def paired(panel: Panel) -> Paired:
    """``panel`` with the published number of draws; the same frames give the same draws."""
    each = np.ones((panel.units, 1), dtype=np.uint16)
    return Paired(panel, np.concatenate([each, *counted(draw(panel.tracks, RESAMPLES, SEED), RESAMPLES)], axis=1))


def level_draws(study: Paired, levels: LevelSet) -> LevelDraws:
    """The levels' shares and charges in every draw.

    ``levels`` is the panel's own (``LevelSet.of``). A level's frames are those of all its points. Differences are between points
    that agree in all other factors, taken before anything is averaged: where a factor changes nothing they are exactly zero.
    """
    panel = study.panel
    totals = [_level_means(values, levels) for values in (panel.right, panel.charge)]
    changes = [_changes(values, levels) for values in (panel.right, panel.charge)]
    return LevelDraws(
        levels,
        *(study.means(total) / levels.sizes[:, None] for total in totals),
        *(None if change is None else study.means(change) / levels.complete.shape[1] for change in changes),
    )


def medians(counts: Counts, values: Floats) -> Floats:
    """(draws,) medians of those of ``values`` (units, k) that are not NaN, over the units of each draw; NaN where it has none."""
    flat = values.ravel()
    there = np.flatnonzero(~np.isnan(flat))
    ascending = there[np.argsort(flat[there], kind="stable")]
    if not len(there):
        return np.full(counts.shape[1], np.nan)
    parts = np.split(counts, range(_AT_ONCE, counts.shape[1], _AT_ONCE), axis=1)
    return np.concatenate([_medians(part[ascending // values.shape[1]], flat[ascending]) for part in parts])


def _medians(counts: Counts, ascending: Floats) -> Floats:
    """(draws,) halfway between the two middle ones of ``ascending`` (n,), each as often as ``counts`` (n, draws) says."""
    cumulative = counts.cumsum(axis=0, dtype=np.int32)
    total = cumulative[-1]
    below, above = (
        ascending[np.minimum(np.count_nonzero(cumulative <= place, axis=0), len(ascending) - 1)]
        for place in ((total - 1) // 2, total // 2)
    )
    return np.where(total > 0, between(below, above, 0.5), np.nan)


def _level_means(values: Floats, levels: LevelSet) -> Floats:
    """(units, levels, methods) sums over each level's points of ``values`` (units, points, methods)."""
    return np.stack([values[:, row[row >= 0]].sum(axis=1) for row in levels.columns], axis=1)


def _changes(values: Floats, levels: LevelSet) -> Floats | None:
    """(units, levels, methods) sums, over settings of the other factors, of what a level adds to what it is compared with."""
    settings = levels.complete
    if levels.against is None or not settings.size:
        return None
    first = levels.baseline if levels.against == "baseline" and levels.baseline is not None else 0
    added: Floats = (values[:, settings] - values[:, settings[first]][:, None]).sum(axis=2)
    return added if levels.against == "baseline" else np.asarray(added - added.mean(axis=1, keepdims=True))
