"""Answers held against the bound of their frames: columns of a score table from which a method's efficiency is made."""

import numpy as np
import pandas as pd

from benchmark.information.columns import informations
from benchmark.information.fisher import bound, nees
from scenes.arrays import Floats
from scenes.dataset import Dataset

SIGMAS = {"sigma_rotation_rad": "bound_rotation_rad", "sigma_position_m": "bound_position_m"}


def columns(bounds: pd.DataFrame | None, sensor: str, frames: pd.Index, errors: Floats) -> dict[str, Floats]:
    """``bound_rotation_rad``, ``bound_position_m`` (√ traces), ``bound_chi2_attitude`` (ωᵀ C_R⁻¹ ω), ``bound_chi2_pose`` (eᵀ I e).

    ``bounds``: ``benchmark.information.table.bounds_table``, None for no columns. ``sensor``: the camera, rig or LIDAR whose bound
    counts. ``errors`` (n, 6): ``benchmark.pose_errors.error_vectors`` at ``frames``. NaN in frames without a bound, whose pose is
    undetermined, or without an answer, and in the last where it gives no position. An ideal estimator's squares are χ² of three
    and of six degrees of freedom.
    """
    if bounds is None:
        return {}
    mine = bounds[bounds["sensor"] == sensor].set_index("frame").reindex(frames)
    found = {name: mine[sigma].to_numpy(dtype=np.float64) for sigma, name in SIGMAS.items()}
    determined = np.isfinite(found["bound_rotation_rad"])
    attitude, pose = np.full(len(mine), np.nan), np.full(len(mine), np.nan)
    if determined.any():
        matrices, made = informations(mine[determined]), errors[determined]
        marginal = np.stack([np.linalg.inv(bound(one).covariance[:3, :3]) for one in matrices])
        attitude[determined], pose[determined] = nees(made[:, :3], marginal), nees(made, matrices)
    return found | {"bound_chi2_attitude": attitude, "bound_chi2_pose": pose}


def seen_by(dataset: Dataset, sensor: str) -> str:
    """Who sees what a method for two cameras answers from: the rig with ``sensor`` on its left, where there is one."""
    return next((name for name, pair in dataset.rigs.items() if pair.left == sensor), sensor)
