"""One method on all seeds of a case: how many runs converged, what their steady states pool to, whether σ is honest."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmark.filter_nees import mean_bounds
from benchmark.filter_states import STATES, State
from benchmark.filter_summary import Consistency, FilterSummary, StateFigure
from benchmark.leaderboard import Row


@dataclass(frozen=True, slots=True, eq=False)
class Pooled:
    """One state over all runs that give it: 3 · RMS pooled over runs of the worst component, and the median of the runs' own.

    ``settled``: how many runs came to stay within the paper's level, and ``settled_s`` the median of their times; None where
    none did. ``lost``: runs without a figure, because no frame of their steady state has one.
    """

    state: State
    worst: float | None
    median: float | None
    runs: int
    lost: int
    settled: int
    settled_s: float | None

    @property
    def is_met(self) -> bool:
        """Whether the pooled figure of all runs lies at or below the paper's level."""
        return self.worst is not None and self.lost == 0 and self.worst <= self.state.level


@dataclass(frozen=True, slots=True, eq=False)
class SeedsLine:
    """One method on one case: its rows (one a seed), and what they come to together."""

    case: str
    title: str
    rows: tuple[Row, ...]
    converged: int
    states: dict[str, Pooled]
    inertia_error: float | None
    nees: Consistency | None
    nis: Consistency | None
    accepted_fraction: float | None
    icp_attitude_median_deg: float | None
    icp_position_median_m: float | None
    cpu_s_per_frame: float | None

    @property
    def blocks(self) -> tuple[FilterSummary, ...]:
        """The filter blocks of the rows."""
        return tuple(row.summary.filter for row in self.rows if row.summary.filter is not None)

    @property
    def answered(self) -> int:
        """Answered frames of all seeds."""
        return sum(row.summary.answered for row in self.rows)

    @property
    def frames(self) -> int:
        """Frames of all seeds."""
        return sum(row.summary.frames for row in self.rows)

    @property
    def stage_cpu_s(self) -> dict[str, float]:
        """Stage → CPU seconds a scan, mean over the seeds that have it."""
        stages = dict.fromkeys(stage for block in self.blocks for stage in block.stage_cpu_s)
        return {one: _mean([block.stage_cpu_s.get(one) for block in self.blocks]) or 0.0 for one in stages}


def seeds_lines(rows: Sequence[Row], bases: dict[str, str]) -> list[SeedsLine]:
    """A line per case and method, in order of appearance, of the ``rows`` with a filter block.

    ``bases``: the name of a data set's case → that of the case whose seeds it is one of, for those that are.
    """
    groups: dict[tuple[str, str, str], list[Row]] = {}
    for row in rows:
        if row.summary.filter is not None:
            key = bases.get(row.entry.case, row.entry.case), row.entry.title, row.summary.sensor
            groups.setdefault(key, []).append(row)
    return [_line(case, title, group) for (case, title, _), group in groups.items()]


def _line(case: str, title: str, rows: Sequence[Row]) -> SeedsLine:
    blocks = [row.summary.filter for row in rows if row.summary.filter is not None]
    states = {state.key: _pooled(state, [block.states.get(state.key) for block in blocks]) for state in STATES}
    return SeedsLine(
        case=case,
        title=title,
        rows=tuple(rows),
        converged=sum(block.is_converged for block in blocks),
        states={key: one for key, one in states.items() if one is not None},
        inertia_error=_median([block.inertia_error for block in blocks]),
        nees=_joint([block.nees for block in blocks], of_runs=True),
        nis=_joint([block.nis for block in blocks], of_runs=False),
        accepted_fraction=_mean([block.accepted_fraction for block in blocks]),
        icp_attitude_median_deg=_median([block.icp_attitude_median_deg for block in blocks]),
        icp_position_median_m=_median([block.icp_position_median_m for block in blocks]),
        cpu_s_per_frame=_mean([row.summary.cpu_s_per_frame for row in rows]),
    )


def _pooled(state: State, figures: Sequence[StateFigure | None]) -> Pooled | None:
    given = [one for one in figures if one is not None]
    if not given:
        return None
    whole = [one for one in given if one.worst is not None]
    squares = np.array([one.three_sigma for one in whole], dtype=np.float64) ** 2
    times = [one.settled_s for one in given if one.settled_s is not None]
    return Pooled(
        state=state,
        worst=float(np.sqrt(squares.mean(axis=0)).max()) if whole else None,
        median=_median([one.worst for one in given]),
        runs=len(figures),
        lost=len(figures) - len(whole),
        settled=len(times),
        settled_s=_median(times),
    )


def _joint(squares: Sequence[Consistency | None], *, of_runs: bool) -> Consistency | None:
    """NEES: each run is one sample of χ²₂₀, so the bounds are χ²₂₀ₙ / n. NIS: each innovation is one."""
    given = [one for one in squares if one is not None]
    if not given:
        return None
    frames, expected = sum(one.frames for one in given), float(np.mean([one.expected for one in given]))
    weights = None if of_runs else [one.frames for one in given]
    low, high = mean_bounds(expected, len(given) if of_runs else frames)
    mean = float(np.average([one.mean for one in given], weights=weights))
    median = float(np.median([one.median for one in given]))
    return Consistency(frames=frames, mean=mean, median=median, expected=expected, low=low, high=high)


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None


def _median(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return float(np.median(known)) if known else None
