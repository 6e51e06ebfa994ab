"""What a point costs the search: how much it hurts a method, by the published rule; and how well the pose could be known there."""

import numpy as np
import pandas as pd

from benchmark.ranking_rule import unanswered

SLOPE = 1e-3
"""What an error of 180° adds: less than any frame that fails, enough to lead the search towards one."""


def cost(frames: pd.DataFrame) -> float:
    """Mean charge of the rows (``benchmark.study.outcomes``), each at most what silence costs, plus a slope from the median error.

    Without that limit one answer that is absurdly far off would outweigh a light under which every frame fails.
    """
    if frames.empty:
        return 0.0
    most = frames["modality"].map(unanswered).to_numpy(dtype=np.float64)
    mean = float(np.mean(np.minimum(frames["charge"].to_numpy(dtype=np.float64), most)))
    median_deg = median_error_deg(frames)
    return mean + (0.0 if median_deg is None else SLOPE * min(median_deg, 180.0) / 180.0)


def median_error_deg(frames: pd.DataFrame) -> float | None:
    """Median attitude error of the answered frames, None without one."""
    errors = frames.loc[frames["answered"].astype(bool), "geodesic_deg"].to_numpy(dtype=np.float64)
    errors = errors[np.isfinite(errors)]
    return float(np.median(errors)) if errors.size else None


def bound_rad(frames: pd.DataFrame) -> float:
    """Median bound of the attitude over the frames that were asked; infinite where that is undetermined, or none was asked."""
    asked = frames.loc[frames["bound_asked"].astype(bool), "bound_rotation_rad"].to_numpy(dtype=np.float64)
    return float(np.median(np.nan_to_num(asked, nan=np.inf))) if asked.size else np.inf
