"""Every judged frame of a folder of results as one table: what rankings, charts and galleries are made of.

A *run* is one data set; a case that is run with several seeds has several. A *subject* is what was asked for: a rectangle's or a
ring's name, or a LIDAR's. A *track* is one sensor's answers on one subject of one run, in frame order.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from benchmark import results
from benchmark.errors import PredictionsError
from benchmark.judge import SCORES
from benchmark.metrics import WRONG_DEG
from benchmark.results import Entry, Results
from benchmark.ring_scores import WRONG_OF_RANGE
from benchmark.subjects import Modality
from benchmark.summary import Summary

TRACK = ["run", "subject", "sensor"]
_LIGHT = ["lit_fraction", "shadow_fraction", "specular_fraction", "saturated_fraction", "visible_fraction"]
BOUND = ["bound_chi2_attitude", "bound_chi2_pose"]
_ERRORS = ["geodesic_deg", "position_error_m", "speed_rotation", "speed_position"]
COLUMNS = (
    "case", "run", "seed", *TRACK[1:], "modality", "method", "frame", "time_s", "outcome", "answered", *_ERRORS, "score", "wrong",
    "cpu_s", "range_m", "phase_angle_deg", *_LIGHT, *BOUND, "dataset", "answers", "scores",
)  # fmt: skip


def pool(folder: Path, index: Results) -> pd.DataFrame:
    """A row per (run, subject, sensor, method, frame) of all entries, with the columns ``COLUMNS``, in the index's order.

    Reads scores and summaries alone, so it works without data sets. Frames in which a suite lets filters settle are left out.
    ``score``: SPEED's rotation score plus its position score; of ``mono`` the rotation's alone, since a rectangle of unknown size
    has no distance. ``bound_…``: ``benchmark.bound_scores``. NaN where a frame has no answer, or a quantity does not apply. Raises
    ``PredictionsError`` for lost files.
    """
    parts = [_entry(folder, index, entry, one) for entry in index.entries for one in results.summaries(folder, entry)]
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=list(COLUMNS))


def modality_of(summary: Summary) -> Modality:
    """What kind of sensor answered: the two cameras of a ring, a LIDAR, or one camera."""
    if summary.ring is not None:
        return "stereo"
    return "lidar" if summary.filter is not None else "mono"


def _entry(folder: Path, index: Results, entry: Entry, summary: Summary) -> pd.DataFrame:
    """The rows of one entry on one sensor."""
    scores, modality = _settled(folder, entry, summary), modality_of(summary)
    answered = (scores["outcome"] == "ok").to_numpy()
    rows = scores.reindex(columns=["frame", "time_s", "outcome", *_ERRORS, "cpu_s", "range_m", "phase_angle_deg", *_LIGHT, *BOUND])
    rows.loc[~answered, [*_ERRORS, *BOUND]] = np.nan
    heading = next((case for case in index.cases if case.name == entry.case), None)
    rows = rows.assign(
        case=index.bases.get(entry.case, entry.case),
        run=entry.case,
        seed=np.nan if heading is None or heading.seed is None else float(heading.seed),
        subject=entry.feature or summary.sensor,
        sensor=summary.sensor,
        modality=modality,
        method=entry.title,
        answered=answered,
        score=rows["speed_rotation"] + (0.0 if modality == "mono" else rows["speed_position"]),
        wrong=_wrong(scores, answered, modality),
        dataset=entry.dataset,
        answers=entry.answers,
        scores=entry.scores,
    )
    return rows[list(COLUMNS)].reset_index(drop=True)


def _settled(folder: Path, entry: Entry, summary: Summary) -> pd.DataFrame:
    path = folder / entry.scores / SCORES
    try:
        scores = pd.read_parquet(path)
    except FileNotFoundError:
        raise PredictionsError(f"{path} does not exist; run the judge again") from None
    mine: pd.DataFrame = scores[scores["sensor"] == summary.sensor].sort_values("frame", kind="stable")
    settled: pd.DataFrame = mine[mine["time_s"] >= mine["time_s"].min() + summary.settle_s]
    return settled


def _wrong(scores: pd.DataFrame, answered: np.ndarray, modality: Modality) -> np.ndarray:
    """Answers that are confidently wrong: the judge's own word for rings; else the attitude, for LIDARs also the place."""
    if modality == "stereo" and "wrong" in scores:
        return answered & (scores["wrong"].to_numpy(dtype=np.float64) > 0)
    off = scores["geodesic_deg"].to_numpy(dtype=np.float64) > WRONG_DEG
    if modality == "lidar":
        astray = scores["position_error_m"].to_numpy(dtype=np.float64) / scores["range_m"].to_numpy(dtype=np.float64)
        off |= astray > WRONG_OF_RANGE
    return answered & off
