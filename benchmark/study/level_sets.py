"""Which points belong to which level of which factor, and with which they are compared."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from benchmark.study.directions import angles_deg, side
from benchmark.study.panel import Panel
from benchmark.study.record import FactorRecord, StudyRecord

Value = float | tuple[float, float, float] | None
"""A number in the factor's unit, a direction to the light, or None: the scenario's own, which is no level of the factor."""


@dataclass(frozen=True, slots=True, eq=False)
class LevelSet:
    """One factor's levels, numbers in rising order.

    ``names`` (levels, settings): the point that has this level and that setting of the other factors, "" where there is none.
    ``columns``: the same as places in a panel, −1 where there is none. ``baseline``: which level the scenario itself has.
    ``against``: whether levels are compared with the baseline or with the mean of all levels; None where the former is lacking.
    """

    factor: FactorRecord
    values: tuple[Value, ...]
    names: NDArray[np.object_]
    columns: NDArray[np.int64]
    baseline: int | None
    against: Literal["baseline", "mean"] | None

    @property
    def sizes(self) -> NDArray[np.int64]:
        """(levels,) how many points each has."""
        return np.asarray(np.count_nonzero(self.columns >= 0, axis=1))

    @property
    def complete(self) -> NDArray[np.int64]:
        """(levels, settings) of ``columns``: those settings that every level has, which make a fair comparison."""
        return self.columns[:, (self.columns >= 0).all(axis=0)]

    @property
    def off_baseline(self) -> NDArray[np.int64]:
        """Places of the levels that the scenario itself does not have."""
        return np.array([place for place in range(len(self.values)) if place != self.baseline], dtype=np.int64)

    def label(self, place: int) -> str:
        """A level as a person reads it."""
        value, unit = self.values[place], self.factor.unit
        if value is None:
            return "as the scenario is"
        if isinstance(value, tuple):
            phase_deg, azimuth_deg = angles_deg(np.array(value))
            return f"phase {phase_deg:.0f}°, {side(azimuth_deg)}" if 0.5 < phase_deg < 179.5 else f"phase {phase_deg:.0f}°"
        return f"{value:.4g}{'' if unit in ('', '×', '°') else ' '}{unit}"

    def of(self, panel: Panel) -> "LevelSet | None":
        """The levels of which ``panel`` has frames, with their places in it; None where it has none."""
        column = panel.column
        columns = np.array([[column.get(name, -1) for name in row] for row in self.names], dtype=np.int64).reshape(self.names.shape)
        kept = np.flatnonzero((columns >= 0).any(axis=1))
        if not len(kept):
            return None
        places = [int(place) for place in kept]
        baseline = places.index(self.baseline) if self.baseline in places else None
        return replace(
            self,
            values=tuple(self.values[place] for place in places),
            names=self.names[kept],
            columns=columns[kept],
            baseline=baseline,
            against=None if self.against == "baseline" and baseline is None else self.against,
        )


def level_sets(record: StudyRecord, points: pd.DataFrame) -> list[LevelSet]:
    """The levels of every factor; none of a Sobol design, whose points share no levels."""
    if record.design == "sobol" or points.empty:
        return []
    return list(_one_at_a_time(record, points) if record.design == "one-at-a-time" else _crossed(record, points))


def _one_at_a_time(record: StudyRecord, points: pd.DataFrame) -> Iterator[LevelSet]:
    """Of each factor the scenario as it is, and the points that are off it in this factor alone."""
    for factor in record.factors:
        chosen = points[points["moved"].isin(["", factor.name])]
        values = _values(factor, chosen)
        order = _order(values)
        moved = chosen["moved"].to_numpy()[order]
        own = np.flatnonzero(moved == "")
        if not (moved != "").any():
            continue
        yield _level_set(
            factor,
            [values[place] for place in order],
            chosen["point"].to_numpy(dtype=object)[order][:, None],
            int(own[0]) if len(own) else None,
            "baseline",
        )


def _crossed(record: StudyRecord, points: pd.DataFrame) -> Iterator[LevelSet]:
    """Of each factor all points by its level, and by the setting of the others."""
    for factor in record.factors:
        others = [name for other in record.factors if other is not factor for name in _names(other)]
        setting = points.groupby(others, dropna=False).ngroup().to_numpy() if others else np.zeros(len(points), dtype=np.int64)
        values = _values(factor, points)
        levels = list(dict.fromkeys(values))
        levels = [levels[place] for place in _order(levels)]
        place_of = {value: place for place, value in enumerate(levels)}
        names = np.full((len(levels), setting.max() + 1), "", dtype=object)
        names[[place_of[value] for value in values], setting] = points["point"].to_numpy(dtype=object)
        close = [place for place, value in enumerate(levels) if _is_baseline(factor, value)]
        yield _level_set(factor, levels, names, close[0] if close else None, "mean")


def _level_set(
    factor: FactorRecord,
    values: list[Value],
    names: NDArray[np.object_],
    baseline: int | None,
    against: Literal["baseline", "mean"],
) -> LevelSet:
    return LevelSet(factor, tuple(values), names, np.full(names.shape, -1), baseline, against)


def _names(factor: FactorRecord) -> list[str]:
    return [f"{factor.name}_{axis}" for axis in "xyz"] if factor.kind == "direction" else [factor.name]


def _values(factor: FactorRecord, points: pd.DataFrame) -> list[Value]:
    """Of each point the factor's value."""
    table = points[_names(factor)].to_numpy(dtype=np.float64)
    plain = [tuple(float(one) for one in row) for row in table]
    return [None if np.isnan(row[0]) else (row[0] if len(row) == 1 else (row[0], row[1], row[2])) for row in plain]


def _order(values: list[Value]) -> list[int]:
    """Numbers rise after what has none; directions stay in the design's order."""
    return sorted(range(len(values)), key=lambda place: value if isinstance(value := values[place], float) else -np.inf)


def _is_baseline(factor: FactorRecord, value: Value) -> bool:
    """Whether a level is the scenario's own; levels have six digits."""
    own = factor.baseline
    return isinstance(value, float) and own is not None and bool(np.isclose(value, own, rtol=1e-6, atol=1e-12))
