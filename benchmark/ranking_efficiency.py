"""How near methods come to the information limit, with what other draws of the frames would have given."""

import numpy as np
import pandas as pd

from benchmark.information.fisher import CHI2_MEDIAN_3, CHI2_MEDIAN_6, FEWEST
from benchmark.ranking_bootstrap import Counts
from benchmark.subjects import Modality
from scenes.arrays import Floats

_OF_WHAT: dict[str, tuple[str, float]] = {"mono": ("bound_chi2_attitude", CHI2_MEDIAN_3)}
_OF_POSE = ("bound_chi2_pose", CHI2_MEDIAN_6)


def squares(frames: pd.DataFrame) -> Floats:
    """(n,) squared errors in units of their bound, of ``mono`` the attitude's, else the pose's; infinite where there is none."""
    own = [frames.get(name, pd.Series(np.nan, frames.index)) for name in ("bound_chi2_attitude", "bound_chi2_pose")]
    attitude, pose = (one.to_numpy(dtype=np.float64) for one in own)
    return np.nan_to_num(np.where(frames["modality"] == "mono", attitude, pose), nan=np.inf)


def efficiencies(counts: Counts, squared: Floats, modality: Modality) -> Floats:
    """(draws, methods) η: the median that an ideal estimator would have, over the median of ``squared`` (frames, methods).

    ``counts``: (frames, draws). Only frames with an answer and a bound count; NaN where a method has fewer than 30 of them.
    """
    ideal = _OF_WHAT.get(modality, _OF_POSE)[1]
    with np.errstate(divide="ignore"):
        return np.stack([ideal / _medians(counts, one) for one in squared.T], axis=1)


def _medians(counts: Counts, values: Floats) -> Floats:
    """(draws,) medians of the finite ``values`` (frames,), each as often as it was drawn; NaN in draws without any."""
    known = np.flatnonzero(np.isfinite(values))
    if len(known) < FEWEST:
        return np.full(counts.shape[1], np.nan)
    ascending = known[np.argsort(values[known], kind="stable")]
    cumulative = np.cumsum(counts[ascending], axis=0, dtype=np.int64)
    last = cumulative[-1] - 1
    below, above = (values[ascending][_first(cumulative > place)] for place in (last // 2, (last + 1) // 2))
    return np.where(last < 0, np.nan, (below + above) / 2)


def _first(reached: np.ndarray) -> np.ndarray:
    return np.asarray(np.argmax(reached, axis=0))
