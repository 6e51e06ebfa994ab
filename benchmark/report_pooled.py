"""The same few figures for every modality: one method on one subject of one case, its seeds pooled, as a line of a table."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from benchmark.ranking_bootstrap import plain_quantiles
from benchmark.ranking_cells import short

_NONE = "—"


@dataclass(frozen=True, slots=True, eq=False)
class PooledLine:
    """Counts over all judged frames; the errors' medians and 95th percentiles are texts.

    A frame without an answer is larger than any error, so a quantile that falls among them is a dash, as is a place that a modality
    does not ask for.
    """

    case: str
    subject: str
    modality: str
    method: str
    series: int
    seeds: int
    frames: int
    answered: int
    wrong: int
    rotation_median_deg: str
    rotation_p95_deg: str
    position_median_m: str
    position_p95_m: str
    cpu_ms: str


def pooled_lines(frames: pd.DataFrame, titles: Sequence[str]) -> Iterator[PooledLine]:
    """Lines of rows of ``benchmark.pool.pool`` by case, subject and method, in order of appearance.

    A method's place in ``titles`` is its colour.
    """
    for (case, subject, method), rows in frames.groupby(["case", "subject", "method"], sort=False):
        modality, answered = str(rows["modality"].iloc[0]), rows["answered"].to_numpy(dtype=bool)
        rotation = _quantiles(rows["geodesic_deg"], answered)
        position = (_NONE, _NONE) if modality == "mono" else _quantiles(rows["position_error_m"], answered)
        cpu_s = rows["cpu_s"].mean()
        yield PooledLine(
            case=str(case),
            subject=str(subject),
            modality=modality,
            method=str(method),
            series=titles.index(str(method)),
            seeds=int(rows["run"].nunique()),
            frames=len(rows),
            answered=int(answered.sum()),
            wrong=int(rows["wrong"].sum()),
            rotation_median_deg=rotation[0],
            rotation_p95_deg=rotation[1],
            position_median_m=position[0],
            position_p95_m=position[1],
            cpu_ms=_NONE if np.isnan(cpu_s) else short(1e3 * float(cpu_s)),
        )


def _quantiles(errors: pd.Series, answered: np.ndarray) -> tuple[str, str]:
    """Median and 95th percentile of all frames, those without an answer (or without this part of one) as infinite."""
    values = errors.to_numpy(dtype=np.float64)
    known = np.where(answered & ~np.isnan(values), values, np.inf)
    found = plain_quantiles(known, (0.5, 0.95))
    median, p95 = (short(float(one)) if np.isfinite(one) else _NONE for one in found)
    return median, p95
