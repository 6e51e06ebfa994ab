"""A statistic with its bootstrap interval, as it stands in summary.json, and the plain statistics it is made of."""

from collections.abc import Callable

import numpy as np

from benchmark import metrics
from scenes.arrays import Floats
from scenes.spec import Spec

BOOTSTRAP_SEED = 0


class Figure(Spec):
    """A statistic with its 95 % interval; None where too few frames were answered for one."""

    value: float
    low: float | None = None
    high: float | None = None


def figure_of(values: Floats, statistic: Callable[[Floats], float]) -> Figure | None:
    """``statistic`` of ``values`` (n,) with its interval, None without values."""
    if values.size == 0:
        return None
    interval = metrics.bootstrap(values, statistic, np.random.default_rng(BOOTSTRAP_SEED))
    return Figure(value=interval.value, low=finite(interval.low), high=finite(interval.high))


def mean(values: Floats) -> float:
    """The mean."""
    return float(values.mean())


def median(values: Floats) -> float:
    """The median."""
    return float(np.median(values))


def p95(values: Floats) -> float:
    """The 95th percentile."""
    return float(np.percentile(values, 95))


def sd(values: Floats) -> float:
    """Standard deviation about the mean, n − 1; 0 for a single value."""
    return float(values.std(ddof=1)) if values.size > 1 else 0.0


def finite(value: float) -> float | None:
    """The value, None for NaN and infinity, which JSON has no word for."""
    return value if np.isfinite(value) else None
