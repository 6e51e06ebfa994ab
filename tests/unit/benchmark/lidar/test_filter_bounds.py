"""A LIDAR's answers against the bound: those in the target's frame are, those in a frame of the method's own cannot be."""

from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial.transform import RigidTransform

from benchmark.information.columns import columns_of
from benchmark.information.fisher import bound
from benchmark.judge import judge
from scenes.dataset import Dataset

_SIGMA = np.array([1e-3, 2e-3, 3e-3, 0.01, 0.02, 0.03])


def _bounds(dataset: Dataset) -> pd.DataFrame:
    row = dict(columns_of(bound(np.diag(_SIGMA**-2.0))))
    return pd.DataFrame([{"frame": frame, "sensor": "lidar", **row} for frame in dataset.frames])


def test_answers_of_a_method_that_was_told_the_model_are_held_against_the_bound(lidar_dataset: Dataset, fabricate: Any) -> None:
    """θ of a filter turns the target in its own axes: |ω|² is the same in the sensor's where σ is the same about all axes."""
    errors = np.zeros((40, 20))
    errors[:, 0] = 0.01
    answers = fabricate(lidar_dataset).answers(errors=errors)
    bounds = _bounds(lidar_dataset)
    scores = judge(answers, lidar_dataset, bounds=bounds).scores
    turns = scores["bound_chi2_attitude"].to_numpy()
    assert ((turns > (0.01 / _SIGMA[2]) ** 2 * 0.999) & (turns < (0.01 / _SIGMA[0]) ** 2 * 1.001)).all()
    np.testing.assert_allclose(scores["bound_chi2_pose"], turns, rtol=1e-6)  # nothing couples the two, and the place is exact
    np.testing.assert_allclose(scores["bound_position_m"], np.linalg.norm(_SIGMA[3:]))


def test_answers_in_a_frame_of_the_methods_own_have_no_efficiency(lidar_dataset: Dataset, fabricate: Any) -> None:
    """The frame is laid over the truth on the first answer, which would have no error at all."""
    own = RigidTransform.from_components([0.7, -0.4, 1.1], RigidTransform.identity().rotation)
    scores = judge(fabricate(lidar_dataset).answers(own), lidar_dataset, bounds=_bounds(lidar_dataset)).scores
    assert scores[["bound_chi2_attitude", "bound_chi2_pose"]].isna().all(axis=None)
    assert scores["bound_rotation_rad"].notna().all()
