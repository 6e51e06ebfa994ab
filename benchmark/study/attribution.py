"""How much of a frame was lit, shadowed, specular, saturated against what it cost a method: rank correlations over points."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from benchmark.ranking_bootstrap import bounds
from benchmark.ranking_record import Estimate
from benchmark.ranking_rule import RESAMPLES, SEED
from benchmark.study.outcomes import Outcomes
from scenes.arrays import Floats

LAYERS = {
    "lit_fraction": "lit",
    "shadow_fraction": "in shadow",
    "specular_fraction": "specular",
    "saturated_fraction": "saturated",
}
_FEWEST = 8  # points for a rank correlation


@dataclass(frozen=True, slots=True, eq=False)
class Attribution:
    """Of one method: Spearman's ρ between its mean charge at a point and each layer's share of the target there."""

    modality: str
    method: str
    points: int
    correlations: dict[str, Estimate]


def attributions(found: Outcomes) -> Iterator[Attribution]:
    """A line per method whose frames say how they were lit; ρ is None where a layer or the charge does not vary."""
    for (modality, method), frames in found.frames.groupby(["modality", "method"], sort=False):
        means = frames.groupby("point")[["charge", *LAYERS]].mean()
        if len(means) < _FEWEST or means[list(LAYERS)].isna().all(axis=None):
            continue
        ranked = {layer: _correlated(means, layer) for layer in LAYERS}
        yield Attribution(str(modality), str(method), len(means), ranked)


def _correlated(means: pd.DataFrame, layer: str) -> Estimate:
    """ρ with its bootstrap interval over points."""
    pairs = means[[layer, "charge"]].dropna().to_numpy(dtype=np.float64)
    if len(pairs) < _FEWEST or (np.ptp(pairs, axis=0) == 0).any():
        return Estimate(value=None)
    rng = np.random.default_rng(SEED)
    drawn = np.array([spearman(pairs[rng.integers(len(pairs), size=len(pairs))]) for _ in range(RESAMPLES)])
    low, high = bounds(drawn[np.isfinite(drawn)])
    return Estimate(value=spearman(pairs), low=low, high=high)


def spearman(pairs: Floats) -> float:
    """Spearman's rank correlation of (n, 2), ties sharing their mean rank; NaN where one of the two does not vary."""
    from scipy.stats import rankdata

    first, second = (rankdata(column) for column in pairs.T)
    if np.ptp(first) == 0 or np.ptp(second) == 0:
        return float("nan")
    return float(np.corrcoef(first, second)[0, 1])
