"""One division: methods that answered the same tracks, compared on the same draws of the same frames."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
import pandas as pd

from benchmark.ranking_bootstrap import SHORTEST, Counts, bounds, counted, draw, quantiles, sums
from benchmark.ranking_efficiency import efficiencies
from benchmark.ranking_record import Difference, Division, Estimate, Standing
from benchmark.ranking_rule import RESAMPLES, SEED
from benchmark.ranking_table import Table, table_of
from scenes.arrays import Floats

_LEVELS = (0.5, 0.95)


@dataclass(frozen=True, slots=True, eq=False)
class _Draws:
    """Each statistic of the frames as they are and then of every draw, (1 + draws, methods), by its name in a ``Standing``.

    ``differences``: of the mean charges of each pair of methods, (1 + draws, pairs).
    """

    differences: Floats
    statistics: Mapping[str, Floats]


def division(frames: pd.DataFrame) -> Division:
    """The standings of rows of ``benchmark.pool.pool`` of one modality, where each track was answered by the same methods."""
    table = table_of(frames)
    draws = _draws(table)
    pairs = [(table.methods[one], table.methods[other]) for one, other in _pairs(table)]
    are_enough = table.frames >= SHORTEST
    differences = [
        Difference(first=first, second=second, charge=_estimate(column, are_enough))
        for (first, second), column in zip(pairs, draws.differences.T, strict=True)
    ]
    beaten = [one.worse for one in differences]
    ranks = [1 + beaten.count(method) for method in table.methods]
    standings = [_standing(table, draws, place, ranks, are_enough) for place in range(len(ranks))]
    return Division(
        modality=table.modality,
        cases=tuple(sorted(frames["case"].unique())),
        subjects=tuple(sorted(frames["subject"].unique())),
        tracks=len(table.tracks),
        frames=table.frames,
        methods=tuple(sorted(standings, key=lambda one: (one.rank, one.charge.value, one.method))),
        differences=tuple(differences),
    )


def _pairs(table: Table) -> list[tuple[int, int]]:
    return list(combinations(range(len(table.methods)), 2))


def _draws(table: Table) -> _Draws:
    """The statistics of all draws, and before them those of the frames themselves, as if drawn once each."""
    each = np.ones((table.frames, 1), dtype=np.uint16)
    parts = [_of_counts(table, counts) for counts in (each, *counted(draw(table.tracks, RESAMPLES, SEED), RESAMPLES))]
    names = parts[0].statistics
    return _Draws(
        np.concatenate([part.differences for part in parts]),
        {name: np.concatenate([part.statistics[name] for part in parts]) for name in names},
    )


def _of_counts(table: Table, counts: Counts) -> _Draws:
    pairs = _pairs(table)
    # Differences are taken before they are averaged: of equal methods exactly zero, whatever the order of the sums.
    charge = table.values["charge"]
    differences = charge[:, [one for one, _ in pairs]] - charge[:, [other for _, other in pairs]]
    columns = [differences, charge, *(table.values[name] for name in ("answered", "wrong", "cpu_ms", "timed"))]
    widths = np.cumsum([column.shape[1] for column in columns])[:-1]
    apart, charged, answered, wrong, cpu_ms, timed = np.split(sums(counts, np.hstack(columns)), widths, axis=1)
    means = {
        "charge": charged / table.frames,
        "availability": answered / table.frames,
        "wrong": wrong / table.frames,
        "cpu_ms": np.where(timed > 0, cpu_ms / np.maximum(timed, 1), np.nan),
    }
    squared = table.values["bound_squares"]
    bounded = {"efficiency": efficiencies(counts, squared, table.modality)} if np.isfinite(squared).any() else {}
    return _Draws(apart / table.frames, means | bounded | _quantiles(table, counts))


def _quantiles(table: Table, counts: Counts) -> dict[str, Floats]:
    """Medians and 95th percentiles of the errors; the only camera's rectangle has no distance."""
    errors = {"rotation_{}_deg": "rotation_deg"}
    if table.modality != "mono":
        errors |= {"position_{}_m": "position_m", "position_{}_share": "position_share"}
    found: dict[str, Floats] = {}
    for name, error in errors.items():
        of_methods = np.stack([quantiles(counts, column, _LEVELS) for column in table.values[error].T], axis=1)
        found |= {name.format("median"): of_methods[..., 0], name.format("p95"): of_methods[..., 1]}
    return found


def _standing(table: Table, draws: _Draws, place: int, ranks: Sequence[int], are_enough: bool) -> Standing:
    figures: dict[str, Any] = {name: _estimate(one[:, place], are_enough) for name, one in draws.statistics.items()}
    if not table.values["timed"][:, place].any():
        figures["cpu_ms"] = None
    if (near := figures.get("efficiency")) is not None and near.value is None:
        figures["efficiency"] = None
    return Standing(
        method=table.methods[place],
        rank=ranks[place],
        is_tied=ranks.count(ranks[place]) > 1,
        frames=table.frames,
        answered=int(table.values["answered"][:, place].sum()),
        **figures,
    )


def _estimate(samples: Floats, are_enough: bool) -> Estimate:
    """From a statistic of the frames as they are and then of each draw (NaN: a draw without any, left out)."""
    value, drawn = samples[0], samples[1:]
    low, high = bounds(drawn[~np.isnan(drawn)]) if are_enough and not np.isnan(value) else (np.nan, np.nan)
    return Estimate(value=_finite(value), low=_finite(low), high=_finite(high))


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
