"""What came out of a study: its points, and a row for every method and frame, with what it cost and how well one could know."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from benchmark import results, run_bounds
from benchmark.bound_scores import SIGMAS
from benchmark.errors import PredictionsError
from benchmark.pool import pool
from benchmark.ranking_rule import charges
from benchmark.study import record
from benchmark.study.record import StudyRecord


@dataclass(frozen=True, slots=True, eq=False)
class Outcomes:
    """``points``: points.parquet, in the design's order. ``frames``: rows of ``benchmark.pool.pool``, and

    ``point`` (the case), ``charge`` (``benchmark.ranking_rule``), ``right`` (answered, and not wrong), ``bound_rotation_rad`` and
    ``bound_position_m`` (√ of the traces; NaN where undetermined or not asked for), ``bound_asked``, ``bound_determined``.
    """

    record: StudyRecord
    points: pd.DataFrame
    frames: pd.DataFrame


def read_points(folder: Path) -> pd.DataFrame:
    """points.parquet of a study's folder. Raises ``PredictionsError`` where it is lost."""
    path = folder / record.POINTS
    if not path.is_file():
        raise PredictionsError(f"{folder} holds no {record.POINTS}; run hardlight study again")
    return pd.read_parquet(path)


def outcomes(folder: Path) -> Outcomes:
    """Reads a study's folder; data sets need not be there. Raises ``PredictionsError`` for lost files."""
    said, index = record.read(folder), results.read(folder)
    frames = pool(folder, index)
    frames = frames.assign(
        point=frames["case"], charge=charges(frames), right=frames["answered"].astype(bool) & ~frames["wrong"].astype(bool)
    )
    return Outcomes(said, read_points(folder), _bounded(folder, frames))


def _bounded(folder: Path, frames: pd.DataFrame) -> pd.DataFrame:
    """``frames`` with the bound of what each answer was made from: one camera's, both of a rig's, a LIDAR's."""
    tables = {run: run_bounds.read(folder, run) for run in frames["run"].unique()}
    found = [one.assign(run=run) for run, one in tables.items() if one is not None]
    columns = ["run", "frame", "seen_by", *SIGMAS.values()]
    if found:
        known = pd.concat(found, ignore_index=True).rename(columns={**SIGMAS, "sensor": "seen_by"})[columns]
    else:
        known = pd.DataFrame(columns=columns)
    merged = frames.assign(seen_by=_seen_by(frames)).merge(known.assign(bound_asked=True), on=columns[:3], how="left")
    asked = merged["bound_asked"].notna().to_numpy()
    determined = asked & np.isfinite(merged["bound_rotation_rad"].to_numpy(dtype=np.float64))
    return merged.assign(bound_asked=asked, bound_determined=determined).drop(columns="seen_by")


def _seen_by(frames: pd.DataFrame) -> pd.Series:
    """The sensor whose bound counts: of ``<rig>-left`` the rig."""
    stereo = frames["modality"] == "stereo"
    return frames["sensor"].where(~stereo, frames["sensor"].str.replace(r"-(left|right)$", "", regex=True))
