"""Where a factor breaks a method: the level at which its availability falls below 90 %, up from the baseline and down from it."""

from collections.abc import Iterator
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from benchmark.ranking_bootstrap import SHORTEST, bounds
from benchmark.study.paired import LevelDraws, Paired
from benchmark.study.score_record import AVAILABLE, BreakPoint, Crossing
from scenes.arrays import Floats

StartIs = Literal["baseline", "nearest", "best"]


def break_points(study: Paired, draws: LevelDraws) -> tuple[BreakPoint, ...]:
    """Those of every method; none of directions, which have no order, and none where there are no levels to that side."""
    if draws.levels.factor.kind == "direction":
        return ()
    return tuple(one for method in range(len(study.panel.methods)) for one in _of_method(study, draws, method))


def _of_method(study: Paired, draws: LevelDraws, method: int) -> Iterator[BreakPoint]:
    levels = draws.levels
    numbered = [place for place, value in enumerate(levels.values) if isinstance(value, float)]
    if not numbered:
        return
    values = np.array([levels.values[place] for place in numbered], dtype=np.float64)
    availability = draws.availability[:, numbered, method]
    is_log = levels.factor.scale == "log" and bool(values.min() > 0)
    places = np.log(values) if is_log else values
    baseline = None if levels.baseline is None or levels.baseline not in numbered else numbered.index(levels.baseline)
    start, start_is = _start(levels.factor.baseline, values, baseline, availability[0])
    for going, step in (("up", 1), ("down", -1)):
        onward = np.arange(start, len(values) if step > 0 else -1, step)
        if len(onward) < 2:
            continue
        passed = _passed(step * places[onward], availability[:, onward])
        said = [_crossing(one, step, is_log) for one in (passed[0], *_interval(study, passed))]
        yield BreakPoint(
            modality=study.panel.modality,
            method=study.panel.methods[method],
            factor=levels.factor.name,
            going="up" if going == "up" else "down",
            start=float(values[start]),
            start_is=start_is,
            found=said[0],
            **dict(zip(("nearest", "farthest"), said[1:])),
        )


def _start(own: float | None, values: Floats, baseline: int | None, availability: Floats) -> tuple[int, StartIs]:
    """The baseline's level; else the one nearest to it; where the scenario has no such number, the most available one."""
    if baseline is not None:
        return baseline, "baseline"
    if own is not None:
        return int(np.argmin(np.abs(values - own))), "nearest"
    return int(np.argmax(availability)), "best"


def _passed(onward: Floats, availability: Floats) -> Floats:
    """(draws,) how far one comes: the place on the rising axis ``onward`` (levels,) where ``availability`` (draws, levels) first

    falls below the threshold, linear between levels; −∞ where it is there already, ∞ where it never does.
    """
    below = availability < AVAILABLE
    after: NDArray[np.int64] = np.maximum(np.argmax(below, axis=1), 1)
    each = np.arange(len(availability))
    high, low = availability[each, after - 1], availability[each, after]
    share = np.divide(high - AVAILABLE, high - low, out=np.zeros_like(high), where=high > low)
    found = onward[after - 1] + share * (onward[after] - onward[after - 1])
    return np.where(below[:, 0], -np.inf, np.where(below.any(axis=1), found, np.inf))


def _interval(study: Paired, passed: Floats) -> tuple[float, ...]:
    return () if study.panel.units < SHORTEST else bounds(passed[1:])


def _crossing(passed: float, step: int, is_log: bool) -> Crossing:
    if np.isinf(passed):
        return Crossing(kind="never" if passed > 0 else "already")
    return Crossing(kind="at", value=float(np.exp(step * passed) if is_log else step * passed))
