"""What the scores of a LIDAR method come to: the block ``filter`` of summary.json."""

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from pydantic import Field

from benchmark.figure import finite
from benchmark.filter_gauge import Gauge
from benchmark.filter_nees import DIMENSION, mean_bounds
from benchmark.filter_scores import STAGE
from benchmark.filter_states import STATES, State
from benchmark.metrics import WRONG_DEG
from scenes.arrays import Floats
from scenes.spec import Fraction, Spec

STEADY = 0.8  # from this share of the duration on the state counts as steady
CONVERGED_INERTIA = 0.03  # relative error of the inertia, mean over the steady state, below which it counts as found
_LAST = 0.05  # share of the frames at the end whose median is the drift's final value
_FEWEST = 3  # frames for a slope


class StateFigure(Spec):
    """One state: 3 · RMS of each component's error in the steady state, their largest, and when it had converged.

    In the unit of ``filter_states``. ``settled_s``: the first time, counted from the first frame, from which on every component
    stays within the paper's level until the end, in every frame; None if it never does. ``three_sigma`` has None where an error
    is not finite.
    """

    three_sigma: tuple[float | None, ...]
    worst: float | None
    level: float
    settled_s: float | None

    @property
    def is_met(self) -> bool:
        """Whether the steady state lies at or below the paper's level."""
        return self.worst is not None and self.worst <= self.level


class Consistency(Spec):
    """Normalised squares over ``frames``: mean, median, the mean that honest σ gives, and the 95 % bounds of it.

    NEES: the errors of one run move together, so the run counts as one sample of χ²₂₀. NIS: innovations are white, so each counts.
    """

    frames: int
    mean: float
    median: float
    expected: float
    low: float
    high: float

    @property
    def is_honest(self) -> bool:
        """Whether the mean lies within its bounds."""
        return self.low <= self.mean <= self.high


class GaugeDrift(Spec):
    """How a frame of the method's own moves on the target: least-squares slopes, and the median over the last frames."""

    attitude_deg_per_100s: float
    position_m_per_100s: float
    attitude_final_deg: float
    position_final_m: float


class FilterSummary(Spec):
    """States by key (``filter_states``), those alone that the method gives and the scenario knows.

    ``steady_from_s``: since when the state counts as steady, from the first frame. ``is_converged``: in the steady state every
    frame is answered within ``WRONG_DEG``, and the inertia, where one is given, is known to ``CONVERGED_INERTIA``.
    """

    gauge: str
    steady_from_s: float
    steady_frames: int
    steady_answered: int
    is_converged: bool
    states: dict[str, StateFigure] = Field(default_factory=dict)
    inertia_error: float | None = None
    nees: Consistency | None = None
    nis: Consistency | None = None
    accepted_fraction: Fraction | None = None
    predicted: int = 0
    infeasible: int = 0
    drift: GaugeDrift | None = None
    icp_attitude_median_deg: float | None = None
    icp_attitude_p95_deg: float | None = None
    icp_position_median_m: float | None = None
    icp_position_p95_m: float | None = None
    stage_cpu_s: dict[str, float] = Field(default_factory=dict)


def filter_summary(scores: pd.DataFrame, gauge: Gauge) -> FilterSummary:
    """The block from the score rows of one LIDAR, in frame order."""
    time_s = _numbers(scores, "time_s")
    since_s = time_s - time_s[0]
    steady = scores[since_s >= STEADY * since_s[-1]]
    inertia_error = _mean(_numbers(steady, "inertia_error"))
    fields: dict[str, object] = {
        "gauge": gauge.text,
        "steady_from_s": float(STEADY * since_s[-1]),
        "steady_frames": len(steady),
        "steady_answered": int((steady["outcome"] == "ok").sum()),
        "is_converged": _is_converged(steady, inertia_error),
        "states": {state.key: figure for state in STATES if (figure := _state(state, scores, steady, since_s)) is not None},
        "inertia_error": inertia_error,
        "drift": _drift(scores, since_s) if gauge.is_own else None,
    }
    return FilterSummary.model_validate(fields | _consistency(steady) | _counts(scores) | _registration(scores) | _cpu(scores))


def state_errors(state: State, scores: pd.DataFrame) -> Floats:
    """(n, components) errors in the state's unit, NaN where a frame has none."""
    return state.scale * scores[list(state.errors)].to_numpy(dtype=np.float64)


def three_sigma(errors: Floats) -> Floats:
    """(components,) 3 · RMS of (n, components) errors over the frames that have them."""
    return np.asarray(3.0 * np.sqrt(np.nanmean(errors**2, axis=0)))


def settled_time(within: NDArray[np.bool_], time_s: Floats) -> float | None:
    """The first of ``time_s`` (n,) from which on ``within`` (n,) holds to the end, None if it does not at the end."""
    outside = np.flatnonzero(~within)
    first = 0 if outside.size == 0 else int(outside[-1]) + 1
    return float(time_s[first]) if first < within.size else None


def _state(state: State, scores: pd.DataFrame, steady: pd.DataFrame, since_s: Floats) -> StateFigure | None:
    """None where no frame has a number of it, so that a state that was never given differs from one that was lost."""
    errors, last = state_errors(state, scores), state_errors(state, steady)
    if np.isnan(errors).all():
        return None
    given = ~np.isnan(last).all(axis=0)
    figures = [finite(float(value)) for value in three_sigma(last)] if given.all() else [None] * last.shape[1]
    known = [value for value in figures if value is not None]
    worst = max(known) if len(known) == len(figures) else None
    within = np.asarray((np.abs(errors) <= state.level).all(axis=1))
    return StateFigure(three_sigma=tuple(figures), worst=worst, level=state.level, settled_s=settled_time(within, since_s))


def _is_converged(steady: pd.DataFrame, inertia_error: float | None) -> bool:
    answered, off_deg = (steady["outcome"] == "ok").all(), steady["geodesic_deg"].to_numpy(dtype=np.float64)
    return bool(answered and (off_deg <= WRONG_DEG).all() and (inertia_error is None or inertia_error <= CONVERGED_INERTIA))


def _consistency(steady: pd.DataFrame) -> dict[str, object]:
    errors, used = _numbers(steady, "nees"), steady[steady["accepted"] != 0.0].dropna(subset=["nis", "nis_dof"])
    found: dict[str, object] = {}
    if errors.size:
        found["nees"] = _squares(errors, DIMENSION, samples=1)
    if len(used):
        found["nis"] = _squares(_numbers(used, "nis"), float(used["nis_dof"].mean()), samples=len(used))
    return found


def _squares(values: Floats, expected: float, samples: int) -> Consistency:
    low, high = mean_bounds(expected, samples)
    mean, median = float(values.mean()), float(np.median(values))
    return Consistency(frames=values.size, mean=mean, median=median, expected=expected, low=low, high=high)


def _counts(scores: pd.DataFrame) -> dict[str, object]:
    accepted = _numbers(scores, "accepted")
    return {
        "accepted_fraction": _mean(accepted),
        "predicted": int((_numbers(scores, "predicted") == 1.0).sum()),
        "infeasible": int((_numbers(scores, "infeasible_inertia") == 1.0).sum()),
    }


def _registration(scores: pd.DataFrame) -> dict[str, object]:
    found: dict[str, object] = {}
    for what, unit in (("attitude", "deg"), ("position", "m")):
        values = _numbers(scores, f"icp_{what}_error_{unit}")
        if values.size:
            found[f"icp_{what}_median_{unit}"] = float(np.median(values))
            found[f"icp_{what}_p95_{unit}"] = float(np.percentile(values, 95))
    return found


def _cpu(scores: pd.DataFrame) -> dict[str, object]:
    """Mean CPU seconds of each stage, over the frames in which it ran."""
    stages = {match[1]: _numbers(scores, str(name)) for name in scores if (match := STAGE.fullmatch(str(name)))}
    return {"stage_cpu_s": {stage: float(values.mean()) for stage, values in stages.items() if values.size}}


def _drift(scores: pd.DataFrame, since_s: Floats) -> GaugeDrift | None:
    names = ["geodesic_deg", "position_error_m"]
    rows = scores.assign(since_s=since_s).dropna(subset=names)
    if len(rows) < _FEWEST or rows["since_s"].nunique() < _FEWEST:
        return None
    errors = rows[names].to_numpy(dtype=np.float64)
    slopes = 100.0 * np.polyfit(rows["since_s"].to_numpy(dtype=np.float64), errors, 1)[0]
    final = np.median(errors[-max(1, round(_LAST * len(rows))) :], axis=0)
    numbers = [float(value) for value in (*slopes, *final)]
    return GaugeDrift(
        attitude_deg_per_100s=numbers[0], position_m_per_100s=numbers[1], attitude_final_deg=numbers[2], position_final_m=numbers[3]
    )


def _numbers(scores: pd.DataFrame, name: str) -> Floats:
    return scores[name].dropna().to_numpy(dtype=np.float64) if name in scores else np.empty(0)


def _mean(values: Floats) -> float | None:
    return float(values.mean()) if values.size else None
