"""Errors of single frames and statistics of their samples: pure functions, radians and metres.

Nothing here sees a failure: availability and the rest of the counting is in ``benchmark.summary``.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from scenes.arrays import Floats

WRONG_DEG = 5.0  # an answer further off than this is wrong, whatever its method thinks of it
# Thresholds below which the SPEED+ competition counts an error as zero (Park et al. 2022, the hardware-in-the-loop score).
SPEED_ROTATION_RAD = float(np.radians(0.169))
SPEED_POSITION = 2.173e-3

Statistic = Callable[[Floats], float]


@dataclass(frozen=True, slots=True)
class Interval:
    """A statistic with its bootstrap interval."""

    value: float
    low: float
    high: float


def geodesic(truth: Rotation, estimate: Rotation) -> Floats:
    """(n,) angles in radians of the rotations that take the truth to the estimate."""
    return np.atleast_1d((truth.inv() * estimate).magnitude())


def speed_rotation(error_rad: Floats) -> Floats:
    """SPEED's rotation score: the geodesic angle in radians, zero where it is strictly below 0.169°."""
    return np.where(error_rad < SPEED_ROTATION_RAD, 0.0, error_rad)


def speed_position(truth_m: Floats, estimate_m: Floats) -> Floats:
    """SPEED's position score |t̂ − t| / |t| of (n, 3) positions, zero where it is strictly below 2.173e-3."""
    relative = np.linalg.norm(estimate_m - truth_m, axis=-1) / np.linalg.norm(truth_m, axis=-1)
    return np.where(relative < SPEED_POSITION, 0.0, relative)


def lag1_autocorrelation(errors: Floats, adjacent: Floats) -> float:
    """Correlation of successive errors about their common mean, over the pairs (i, i+1) for which ``adjacent[i]`` is true.

    ``errors`` (n,), ``adjacent`` (n−1,) bool. NaN with fewer than three pairs or without spread.
    """
    centred = errors - errors.mean() if errors.size else errors
    pairs = np.asarray(adjacent, dtype=bool)
    power = float(np.mean(centred**2)) if errors.size else 0.0
    if np.count_nonzero(pairs) < 3 or power == 0.0:
        return float("nan")
    return float(np.mean(centred[:-1][pairs] * centred[1:][pairs]) / power)


def response_slope(truth_rad: Floats, answer_rad: Floats) -> float:
    """Least-squares slope of the answered angle against the true one: 1 follows the motion, 0 answers a constant.

    NaN where the truth does not vary or fewer than three frames were answered.
    """
    if truth_rad.size < 3 or np.ptp(truth_rad) == 0.0:
        return float("nan")
    return float(np.polyfit(truth_rad, answer_rad, 1)[0])


def bootstrap(values: Floats, statistic: Statistic, rng: np.random.Generator, resamples: int = 1000) -> Interval:
    """``statistic`` of ``values`` (n,) with the 95 % interval of a circular block bootstrap (Politis & Romano 1992).

    Blocks of ⌈n^(1/3)⌉ successive frames keep the correlation between neighbours, which single frames would lose and so
    promise too narrow an interval. NaN bounds for fewer than three values.
    """
    value = float(statistic(values)) if values.size else float("nan")
    if values.size < 3:
        return Interval(value, float("nan"), float("nan"))
    length = int(np.ceil(values.size ** (1 / 3)))
    starts = rng.integers(values.size, size=(resamples, -(-values.size // length)))
    chosen = (starts[:, :, None] + np.arange(length)) % values.size
    samples = values[chosen.reshape(resamples, -1)[:, : values.size]]
    low, high = np.percentile([statistic(sample) for sample in samples], [2.5, 97.5])
    return Interval(value, float(low), float(high))
