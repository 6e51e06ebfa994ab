"""The objective of a search: the point of the study at a place of the unit cube, rendered, answered, judged, bounded."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd

from benchmark.files import publish
from benchmark.progress import Progress
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
    """The objective: the point at a place of the unit cube, done in full. ``usual_rad``: what dark lights are told by."""

    hunt: Hunt
    out: Path
    tree: Tree
    usual_rad: float = np.inf
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
        return 0.0 if self._is_dark(bound_rad(frames)) else cost(frames)

    def look(self, units: Floats, progress: Progress | None = None) -> None:
        """Takes the median bound of the places (n, dimensions) where it is determined for the usual one.

        They are spread evenly and known before the search, so that what is dark does not hang on the order of its trials.
        """
        if not (points := self._points(units)):
            return
        frames = self._frames(points, progress=progress)
        bounds = np.array([bound_rad(mine) for _, mine in frames.groupby("point")])
        known = bounds[np.isfinite(bounds)]
        self.usual_rad = float(np.median(known)) if known.size else np.inf

    def all_of(self, tried: Sequence[Tried], command: str) -> tuple[pd.DataFrame, tuple[TrialRecord, ...]]:
        """The frames of all trials, and what is said of each trial; leaves the folder as a study of all of them would."""
        points = self._points(one.unit for one in tried)
        frames = self._frames(points, command=command) if points else pd.DataFrame(columns=["point"])  # no suite is empty
        record.write(self.out, record.record_of(self.hunt.study, command, self.refused))
        return frames, tuple(self._told(one, frames) for one in tried)

    def _points(self, units: Iterable[Floats]) -> list[Point]:
        found = []
        for unit in units:
            try:
                found.append(self.point(unit))
            except UsageError:
                continue
        return found

    def _frames(self, points: Sequence[Point], command: str = "", progress: Progress | None = None) -> pd.DataFrame:
        """A row for each of the points' frames (``Outcomes.frames``)."""
        _, refused = run_points(self.hunt.study, points, self.out, command=command, progress=progress)
        self.refused |= refused
        publish(self.out, {record.POINTS: table(self.hunt.study, tuple(points)).to_parquet(index=False)})
        return outcomes(self.out).frames

    def _told(self, one: Tried, frames: pd.DataFrame) -> TrialRecord:
        unit = tuple(one.unit.tolist())
        try:
            point = self.point(one.unit)
        except UsageError as error:
            return TrialRecord(unit=unit, value=one.value, refused=str(error))
        mine = frames[frames["point"] == point.name]
        if mine.empty:
            why = self.refused.get(point.name, "no frames")
            return TrialRecord(unit=unit, point=point.name, label=point.label, value=one.value, refused=why)
        bound = bound_rad(mine) if self.hunt.avoid_dark else np.inf  # else one may lie there of a search that ended before
        return TrialRecord(
            unit=unit,
            point=point.name,
            label=point.label,
            values={name: value for name, value in point.values.items() if value is not None},
            value=one.value,
            charge=float(mine["charge"].mean()),
            frames=len(mine),
            answered=int(mine["answered"].sum()),
            right=int(mine["right"].sum()),
            rotation_median_deg=median_error_deg(mine),
            bound_rotation_rad=bound if np.isfinite(bound) else None,
            is_dark=self.hunt.avoid_dark and self._is_dark(bound),
        )

    def _is_dark(self, bound: float) -> bool:
        return not np.isfinite(bound) or bound > DARK * self.usual_rad
