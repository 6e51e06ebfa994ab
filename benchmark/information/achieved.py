"""How near a method's answers come to the bound of their frames: efficiency."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from benchmark.information.fisher import CHI2_MEDIAN_3, CHI2_MEDIAN_6, FEWEST
from benchmark.judge import judge
from benchmark.predictions import Predictions
from scenes.dataset import Dataset


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
    """A line per sensor with answers and bounds; frames without an answer, or whose pose is undetermined, are left out.

    Errors are the judge's: of a target that looks alike from elsewhere those of the attitude that suits the whole track.
    """
    scores = judge(predictions, dataset, bounds=bounds).scores
    known = scores[np.isfinite(scores["bound_chi2_attitude"].to_numpy(dtype=np.float64))]
    return [_line(str(sensor), rows) for sensor, rows in known.groupby("sensor", sort=False)]


def _line(sensor: str, rows: pd.DataFrame) -> Achieved:
    turned, posed = (rows[name].to_numpy(dtype=np.float64) for name in ("bound_chi2_attitude", "bound_chi2_pose"))
    excess = np.radians(rows["geodesic_deg"].to_numpy(dtype=np.float64)) / rows["bound_rotation_rad"].to_numpy(dtype=np.float64)
    enough = len(rows) >= FEWEST
    return Achieved(
        sensor=sensor,
        frames=len(rows),
        pose=CHI2_MEDIAN_6 / float(np.median(posed)) if enough and np.isfinite(posed).all() else None,
        attitude=CHI2_MEDIAN_3 / float(np.median(turned)) if enough else None,
        excess=float(np.median(excess)),
    )
