"""How near a method's answers come to the bound of their frames: efficiency."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from benchmark.information.fisher import attitude_efficiency, bound, efficiency, pose_error
from benchmark.information.table import informations
from benchmark.predictions import Predictions, positions, rotations
from scenes.arrays import Floats
from scenes.dataset import Dataset

FEWEST = 30  # frames from which an efficiency is a figure: one frame's error is a random draw


@dataclass(frozen=True, slots=True)
class Achieved:
    """Of one sensor: ``frames`` with an answer and a bound; efficiencies, None with too few of them or without positions.

    ``excess``: median of the attitude's error over its bound's σ (√ of the traces); an ideal estimator has about 0.9.
    """

    sensor: str
    frames: int
    pose: float | None
    attitude: float | None
    excess: float


def achieved(predictions: Predictions, dataset: Dataset, bounds: pd.DataFrame) -> list[Achieved]:
    """A line per sensor with answers and bounds; frames without an answer, or whose pose is undetermined, are left out."""
    truth = dataset.truth_table().set_index(["frame", "sensor"])
    found = []
    for sensor, rows in bounds.dropna(subset=["sigma_rotation_rad"]).groupby("sensor"):
        given = predictions.table[(predictions.table["sensor"] == sensor) & (predictions.table["outcome"] == "ok")]
        both = rows.merge(given, on=["frame", "sensor"])
        if len(both):
            true = truth.loc[list(zip(both["frame"], both["sensor"]))]
            errors = pose_error(rotations(true), positions(true), rotations(both), positions(both))
            found.append(_line(str(sensor), errors, informations(both)))
    return found


def _line(sensor: str, errors: Floats, matrices: Floats) -> Achieved:
    covariances = np.array([bound(one).covariance for one in matrices])
    sigma = np.sqrt(np.trace(covariances[:, :3, :3], axis1=1, axis2=2))
    excess = float(np.median(np.linalg.norm(errors[:, :3], axis=1) / sigma))
    enough, placed = len(errors) >= FEWEST, bool(np.isfinite(errors).all())
    return Achieved(
        sensor=sensor,
        frames=len(errors),
        pose=efficiency(errors, matrices) if enough and placed else None,
        attitude=attitude_efficiency(errors[:, :3], covariances[:, :3, :3]) if enough else None,
        excess=excess,
    )
