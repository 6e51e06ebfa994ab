"""summary.json: what the scores of one method on one sensor come to, with bootstrap intervals. Failures are counted.

Statistics are over answered frames only; how many frames those were stands beside them (``answered`` of ``frames``), so a
method cannot look better by answering less without its availability showing it.
"""

from typing import Literal

import numpy as np
import pandas as pd

from benchmark import metrics
from benchmark.figure import Figure, figure_of, finite, mean, median, p95, sd
from benchmark.filter_summary import FilterSummary
from benchmark.metrics import WRONG_DEG
from benchmark.records import KnowledgeRecord
from benchmark.ring_summary import RingSummary
from scenes.arrays import Floats
from scenes.spec import Fraction, Spec

BIN_DEG = 10.0


class AngleBin(Spec):
    """Signed error of the swept angle among the frames whose true angle lies in [from_deg, to_deg)."""

    from_deg: float
    to_deg: float
    frames: int
    answered: int
    mean_deg: float | None
    sd_deg: float | None


class SweptAngle(Spec):
    """The paper's statistic: answered minus true swept angle.

    ``response_slope``: slope of the answered angle on the true one (1 follows the motion, 0 is a constant answer).
    ``lag1_autocorrelation``: of successive errors; a filter that assumes white noise needs it near 0.
    """

    name: Literal["theta1", "theta2", "theta3"]
    mean_deg: Figure
    sd_deg: Figure
    mae_deg: Figure
    max_deg: float
    response_slope: float | None
    near_zero_answers: int
    lag1_autocorrelation: float | None
    bins: tuple[AngleBin, ...]


class Summary(Spec):
    """How one method did on one sensor of one data set."""

    format: Literal["hardlight-summary"] = "hardlight-summary"
    version: Literal[1] = 1
    method: str
    title: str
    sensor: str
    dataset_identity: str
    knowledge: KnowledgeRecord | None
    symmetry: str
    settle_s: float = 0.0
    frames: int
    answered: int
    outcomes: dict[str, int]
    availability: Fraction
    wrong_threshold_deg: float = WRONG_DEG
    wrong: int
    wrong_but_confident: Fraction
    label_switches: int
    geodesic_median_deg: Figure | None = None
    geodesic_p95_deg: Figure | None = None
    swept: SweptAngle | None = None
    ring: RingSummary | None = None
    filter: FilterSummary | None = None
    speed_rotation: Figure | None = None
    speed_score: Figure | None = None
    cpu_s_per_frame: float | None = None
    start_cpu_s: float | None = None


def figures(scores: pd.DataFrame, swept: str | None) -> dict[str, object]:
    """The counted and computed fields of ``Summary`` from the score rows of one sensor, in frame order."""
    answered = scores[scores["outcome"] == "ok"]
    error_deg = answered["geodesic_deg"].to_numpy(dtype=np.float64)
    wrong = int(np.count_nonzero(error_deg > WRONG_DEG))
    cpu_s = scores["cpu_s"].to_numpy(dtype=np.float64)
    return {
        "frames": len(scores),
        "answered": len(answered),
        "outcomes": {str(name): int(count) for name, count in scores["outcome"].value_counts().sort_index().items()},
        "availability": len(answered) / len(scores),
        "wrong": wrong,
        "wrong_but_confident": wrong / len(scores),
        "geodesic_median_deg": figure_of(error_deg, median),
        "geodesic_p95_deg": figure_of(error_deg, p95),
        "swept": _swept(scores, swept) if swept is not None and len(answered) else None,
        "speed_rotation": figure_of(answered["speed_rotation"].to_numpy(dtype=np.float64), mean),
        "speed_score": figure_of(answered["speed_score"].dropna().to_numpy(dtype=np.float64), mean),
        "cpu_s_per_frame": None if np.isnan(cpu_s).all() else float(np.nanmean(cpu_s)),
    }


def _swept(scores: pd.DataFrame, name: str) -> SweptAngle:
    answered = scores["outcome"].to_numpy() == "ok"
    truth_deg = scores[f"{name}_deg"].to_numpy(dtype=np.float64)
    all_error_deg = scores[f"{name}_error_deg"].to_numpy(dtype=np.float64)
    error_deg, true_deg = all_error_deg[answered], truth_deg[answered]
    adjacent = np.diff(np.flatnonzero(answered)) == 1
    return SweptAngle.model_validate(
        {
            "name": name,
            "mean_deg": figure_of(error_deg, mean),
            "sd_deg": figure_of(error_deg, sd),
            "mae_deg": figure_of(np.abs(error_deg), mean),
            "max_deg": float(np.abs(error_deg).max()),
            "response_slope": finite(metrics.response_slope(np.radians(true_deg), np.radians(true_deg + error_deg))),
            "near_zero_answers": int(np.count_nonzero(np.abs(true_deg + error_deg) < 0.5)),
            "lag1_autocorrelation": finite(metrics.lag1_autocorrelation(error_deg, adjacent)),
            "bins": _bins(truth_deg, all_error_deg, answered),
        }
    )


def _bins(truth_deg: Floats, error_deg: Floats, answered: np.ndarray) -> tuple[AngleBin, ...]:
    """Signed error per 10° of the true angle: a symmetric sweep hides odd biases in its overall mean."""
    index = np.floor(truth_deg / BIN_DEG)
    bins = []
    for one in np.unique(index):
        here = index == one
        errors = error_deg[here & answered]
        bins.append(
            AngleBin(
                from_deg=one * BIN_DEG,
                to_deg=(one + 1) * BIN_DEG,
                frames=int(here.sum()),
                answered=errors.size,
                mean_deg=float(errors.mean()) if errors.size else None,
                sd_deg=sd(errors) if errors.size > 1 else None,
            )
        )
    return tuple(bins)
