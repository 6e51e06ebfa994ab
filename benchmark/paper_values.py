"""A figure of ours by its path: from the summary of a method on a case, or from its seeds together where it is a LIDAR's."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import reduce
from statistics import median
from typing import Any

from benchmark.figure import Figure
from benchmark.filter_seeds import Pooled, SeedsLine, seeds_lines
from benchmark.leaderboard import Row
from benchmark.summary import Summary

Key = tuple[str, str | None, str]  # case, feature (None for a LIDAR), method


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """What one method came to on one feature of one case: its summary, or for a LIDAR what its runs come to together.

    ``frames`` are those of one data set; ``answered`` of ``asked`` are those of all.
    """

    source: Summary | Mapping[str, object]
    frames: int
    answered: int
    asked: int

    def value(self, path: str) -> float | None:
        """The number at ``path``, parts of which are attributes, keys and places; None where it leads to nothing.

        A statistic counts with its value, one of the states with its pooled error unless a run lost it, several numbers with the
        largest magnitude among them.
        """
        return _number(_at(self.source, path))

    def interval(self, path: str) -> tuple[float, float] | None:
        """The 95 % interval of the statistic at ``path``, where it has one."""
        found = _at(self.source, path)
        return (found.low, found.high) if isinstance(found, Figure) and found.low is not None and found.high is not None else None


def measured(rows: Iterable[Row], bases: dict[str, str]) -> dict[Key, Measured]:
    """All that ``rows`` hold; ``bases``: the name of one seed's case → the case's. Of several sensors the first one counts."""
    found: dict[Key, Measured] = {}
    of_lidars = []
    for row in rows:
        if row.summary.filter is not None:
            of_lidars.append(row)
            continue
        one = row.summary
        key = bases.get(row.entry.case, row.entry.case), row.entry.feature, row.entry.title
        found.setdefault(key, Measured(one, one.frames, one.answered, one.frames))
    for line in seeds_lines(of_lidars, bases):
        frames = line.rows[0].summary.frames
        found.setdefault((line.case, None, line.title), Measured(_together(line), frames, line.answered, line.frames))
    return found


def _together(line: SeedsLine) -> dict[str, object]:
    """The runs of a LIDAR's method by names: pooled states, the share that converged, medians over runs, CPU seconds."""
    errors = [row.summary.geodesic_median_deg.value for row in line.rows if row.summary.geodesic_median_deg is not None]
    return {
        "states": line.states,
        "converged_fraction": line.converged / len(line.rows),
        "attitude_median_deg": median(errors) if errors else None,
        "icp_attitude_median_deg": line.icp_attitude_median_deg,
        "cpu_s_per_frame": line.cpu_s_per_frame,
    }


def _at(source: object, path: str) -> object:
    return reduce(_step, path.split("."), source)


def _step(value: Any, part: str) -> Any:
    if isinstance(value, Mapping):
        return value.get(part)
    if isinstance(value, tuple):
        return value[int(part)]
    return None if value is None else getattr(value, part)


def _number(found: Any) -> float | None:
    if isinstance(found, tuple):
        numbers = [_number(one) for one in found]
        return None if not numbers or None in numbers else max(abs(one) for one in numbers if one is not None)
    if isinstance(found, Pooled):
        return found.worst if found.lost == 0 else None
    if isinstance(found, Figure):
        return found.value
    return None if found is None else float(found)
