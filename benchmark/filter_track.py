"""One LIDAR's answers, scored: the poses in the target's frame, the states of the filter in the method's own."""

import numpy as np
import pandas as pd

from benchmark import bound_scores, filter_scores, symmetry
from benchmark.filter_gauge import gauge_of, in_target_frame
from benchmark.filter_summary import FilterSummary, filter_summary
from benchmark.filter_truth import true_states
from benchmark.pose_errors import attitude_errors, error_vectors, position_errors
from benchmark.predictions import TRANSLATION, Predictions, positions
from benchmark.score_table import extras_of, opened
from scenes.dataset import Dataset

# A filter that runs off may state any number just before it gives up. Squares of larger ones than this would be no numbers.
_MOST = 1e12


def filter_track(
    predictions: Predictions, dataset: Dataset, sensor: str, group: str, bounds: pd.DataFrame | None = None
) -> tuple[pd.DataFrame, int, FilterSummary]:
    """The score rows of one LIDAR, with ``bounds`` also against these, how often the labelling changed, what the states come to.

    ``group``: the target's symmetry. A method that declares no knowledge counts as one that was told no model.
    """
    truth, table, scores = opened(predictions, dataset, sensor)
    knowledge, extras = predictions.record.knowledge, _bounded(extras_of(predictions, sensor, truth.index))
    table[list(TRANSLATION)] = table[list(TRANSLATION)].clip(-_MOST, _MOST)
    gauge = gauge_of(truth, table, told_model=knowledge is not None and knowledge.model is not None, group=group)
    true = true_states(truth, dataset.manifest.scenario, gauge)
    posed, answered = in_target_frame(table, gauge), (table["outcome"] == "ok").to_numpy()
    errors, switches = attitude_errors(truth, posed, answered, symmetry.group("none"), symmetry.group(group))
    scores = scores.assign(**errors, **position_errors(positions(truth), positions(posed), errors["speed_rotation"]))
    # A frame of the method's own was laid over the truth, so what is left is no error of a pose.
    vectors = error_vectors(truth, posed, answered & (not gauge.is_own), symmetry.group("none"))
    scores = scores.assign(**bound_scores.columns(bounds, sensor, truth.index, vectors))
    scores = scores.assign(**filter_scores.columns(truth, table, extras, true, gauge))
    return scores, switches, filter_summary(scores, gauge)


def _bounded(extras: pd.DataFrame) -> pd.DataFrame:
    """The named numbers, none beyond ``_MOST``; texts are left out."""
    return extras.select_dtypes(np.number).clip(-_MOST, _MOST)
