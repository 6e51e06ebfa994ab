"""The part of a score table that all kinds of answers share: one row a frame, its outcome, its cost, its light and view."""

import numpy as np
import pandas as pd

from benchmark.predictions import Predictions
from scenes.dataset import Dataset

# What the truth table says of a frame's light and view; kept beside the errors so that studies can ask what drove them.
CONDITIONS = (
    "time_s", "range_m", "phase_angle_deg", "visible_fraction", "lit_fraction", "shadow_fraction", "specular_fraction",
    "saturated_fraction",
)  # fmt: skip


def opened(predictions: Predictions, dataset: Dataset, sensor: str) -> tuple[pd.DataFrame, pd.DataFrame, pd.DataFrame]:
    """The truth of one sensor by frame, the answers in the same order (``skipped`` where one is missing), the first columns."""
    truth = dataset.truth_table()
    truth = truth[truth["sensor"] == sensor].set_index("frame").sort_index()
    table = in_order(predictions.table, sensor, truth.index)
    table["outcome"] = table["outcome"].fillna("skipped")
    scores = pd.DataFrame({"frame": truth.index, "sensor": sensor, "method": predictions.record.title})
    scores["outcome"] = table["outcome"].to_numpy()
    scores[["cpu_s", "wall_s"]] = table[["cpu_s", "wall_s"]].to_numpy(dtype=np.float64)
    for name in CONDITIONS:
        scores[name] = truth[name].to_numpy() if name in truth else np.nan
    return truth, table, scores


def in_order(table: pd.DataFrame, sensor: str, frames: pd.Index) -> pd.DataFrame:
    """The rows of one sensor, one for each of ``frames``."""
    return table[table["sensor"] == sensor].set_index("frame").reindex(frames)


def extras_of(predictions: Predictions, sensor: str, frames: pd.Index) -> pd.DataFrame:
    """The named numbers of one sensor, a row for each of ``frames``; without columns where a method has none."""
    return pd.DataFrame(index=frames) if predictions.extras is None else in_order(predictions.extras, sensor, frames)
