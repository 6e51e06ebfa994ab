"""The objective of a search: the point of the study at a place of the unit cube, rendered, answered, judged, bounded."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd

from benchmark.files import publish
from benchmark.study import record
from benchmark.study.edits import Tree
from benchmark.study.outcomes import outcomes
from benchmark.study.points import Point, point_at, table
from benchmark.study.run import run_points
from benchmark.study.search_cost import bound_rad, cost, median_error_deg
from benchmark.study.search_hunt import Hunt
from benchmark.study.search_proposals import Tried
from benchmark.study.search_record import DARK, TrialRecord
from scenes.arrays import Floats
from scenes.errors import UsageError


@dataclass(slots=True, eq=False)
class Trials:
    """The objective: the point at a place of the unit cube, done in full. ``best_rad``: the best bound so far."""

    hunt: Hunt
    out: Path
    tree: Tree
    best_rad: float = np.inf
    refused: dict[str, str] = field(default_factory=dict)

    def point(self, unit: Floats) -> Point:
        """The study's point there. Raises ``UsageError`` where the scenario is refused."""
        return point_at(self.hunt.study, unit, self.tree)

    def __call__(self, unit: Floats) -> float:
        """What the place costs; nothing where there is no such scenario, or where it is to be left out for its darkness."""
        try:
            frames = self._frames([self.point(unit)])
        except UsageError:
            return 0.0
        if not self.hunt.avoid_dark:
            return cost(frames)
        bound = bound_rad(frames)
        self.best_rad = min(self.best_rad, bound)
        return 0.0 if _is_dark(bound, self.best_rad) else cost(frames)

    def recall(self, tried: Sequence[Tried]) -> None:
        """Learns the best bound of trials that an earlier process did."""
        if self.hunt.avoid_dark and tried:
            frames = self._frames(self._points(tried))
            self.best_rad = min((bound_rad(mine) for _, mine in frames.groupby("point")), default=np.inf)

    def all_of(self, tried: Sequence[Tried], command: str) -> tuple[pd.DataFrame, tuple[TrialRecord, ...]]:
        """The frames of all trials, and what is said of each trial; leaves the folder as a study of all of them would."""
        frames = self._frames(self._points(tried), command)
        record.write(self.out, record.record_of(self.hunt.study, command, self.refused))
        told = [self._told(one, frames) for one in tried]
        best = min((one.bound_rotation_rad for one in told if one.bound_rotation_rad is not None), default=np.inf)
        if self.hunt.avoid_dark:
            told = [one.model_copy(update={"is_dark": _is_dark(one.bound_rotation_rad or np.inf, best)}) for one in told]
        return frames, tuple(told)

    def _points(self, tried: Sequence[Tried]) -> list[Point]:
        found = []
        for one in tried:
            try:
                found.append(self.point(one.unit))
            except UsageError:
                continue
        return found

    def _frames(self, points: Sequence[Point], command: str = "") -> pd.DataFrame:
        """A row for each of the points' frames (``Outcomes.frames``)."""
        _, refused = run_points(self.hunt.study, points, self.out, command=command)
        self.refused |= refused
        publish(self.out, {record.POINTS: table(self.hunt.study, tuple(points)).to_parquet(index=False)})
        return outcomes(self.out).frames

    def _told(self, one: Tried, frames: pd.DataFrame) -> TrialRecord:
        try:
            point = self.point(one.unit)
        except UsageError as error:
            return TrialRecord(value=one.value, refused=str(error))
        mine = frames[frames["point"] == point.name]
        if mine.empty:
            why = self.refused.get(point.name, "no frames")
            return TrialRecord(point=point.name, label=point.label, value=one.value, refused=why)
        bound = bound_rad(mine) if self.hunt.avoid_dark else np.inf  # else one may lie there of a search that ended before
        return TrialRecord(
            point=point.name,
            label=point.label,
            value=one.value,
            charge=float(mine["charge"].mean()),
            frames=len(mine),
            answered=int(mine["answered"].sum()),
            right=int(mine["right"].sum()),
            rotation_median_deg=median_error_deg(mine),
            bound_rotation_rad=bound if np.isfinite(bound) else None,
        )


def _is_dark(bound: float, best: float) -> bool:
    return not np.isfinite(bound) or bound > DARK * best
