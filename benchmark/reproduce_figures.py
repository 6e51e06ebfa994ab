"""What a summary states with bounds, and whether another summary keeps to it.

Figures with an interval have their own bounds, shares of frames Wilson's 95 % interval, and figures without one a tolerance of 5 %:
of a LIDAR's filter these are the states, the inertia, the consistency and the registration, and only where it converged; one that
did not is at the mercy of rounding. CPU seconds have no bounds: machines differ.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from benchmark.figure import Figure
from benchmark.filter_summary import Consistency, FilterSummary
from benchmark.ranking_record import Estimate
from benchmark.summary import Summary
from scenes.spec import Spec

TOLERANCE = 0.05  # relative, of figures without an interval
_SAME = 1e-6  # relative; below this two figures are the same number
_ZERO = 1e-9  # and below this, in the figure's own unit, both are zero
_REGISTRATION = ("icp_attitude_median_deg", "icp_attitude_p95_deg", "icp_position_median_m", "icp_position_p95_m")
Verdict = Literal["identical", "inside", "outside"]


@dataclass(frozen=True, slots=True)
class Stated:
    """A figure of a reference with the bounds that a re-run's has to keep; infinite where a quantile is beyond all answers."""

    value: float
    low: float
    high: float

    def verdict(self, found: float | None) -> Verdict:
        """Of a re-run's figure; None is one that it does not have."""
        if found is None:
            return "outside"
        if math.isclose(found, self.value, rel_tol=_SAME, abs_tol=_ZERO):
            return "identical"
        return "inside" if self.low <= found <= self.high else "outside"


def stated(summary: Summary) -> dict[str, Stated]:
    """The figures of ``summary`` by name."""
    return dict(_counts(summary)) | dict(_figures("", summary)) | dict(_filter(summary.filter))


def stated_of(standing: Spec) -> dict[str, Stated]:
    """Those of what is said of one method, or of the difference of two, in a ranking."""
    estimates = {name: getattr(standing, name) for name in type(standing).model_fields if name != "cpu_ms"}
    return {name: of_estimate(name, one) for name, one in estimates.items() if isinstance(one, Estimate)}


def of_estimate(name: str, one: Estimate) -> Stated:
    """A ranking's statistic with its bounds. A quantile without a value lies among frames without an answer: beyond any error."""
    if "_median_" not in name and "_p95_" not in name:
        return _bounded(0.0 if one.value is None else one.value, one.low, one.high)
    value, low, high = (math.inf if number is None else number for number in (one.value, one.low, one.high))
    return Stated(value, low, high)


def _counts(summary: Summary) -> Iterator[tuple[str, Stated]]:
    yield "frames", _exactly(summary.frames)
    yield "availability", _share(summary.availability, summary.frames)
    yield "wrong_but_confident", _share(summary.wrong_but_confident, summary.frames)
    if summary.ring is not None and summary.ring.ring_judged:
        yield "ring.ring_right_fraction", _share(summary.ring.ring_right_fraction, summary.frames)


def _figures(name: str, value: object) -> Iterator[tuple[str, Stated]]:
    """Every ``Figure`` in a tree of specs and tuples, called after where it stands."""
    if isinstance(value, Figure):
        yield name, _bounded(value.value, value.low, value.high)
    elif isinstance(value, Spec):
        for field in type(value).model_fields:
            yield from _figures(f"{name}.{field}" if name else field, getattr(value, field))
    elif isinstance(value, tuple):
        for index, one in enumerate(value):
            yield from _figures(f"{name}.{index}", one)


def _filter(block: FilterSummary | None) -> Iterator[tuple[str, Stated]]:
    if block is None:
        return
    yield "filter.is_converged", _exactly(float(block.is_converged))
    if not block.is_converged:
        return
    numbers = {f"states.{key}.worst": state.worst for key, state in block.states.items()}
    numbers |= {"inertia_error": block.inertia_error} | {name: getattr(block, name) for name in _REGISTRATION}
    numbers |= {f"{name}.mean": one.mean for name, one in _consistencies(block).items()}
    yield from ((f"filter.{name}", _bounded(value, None, None)) for name, value in numbers.items() if value is not None)


def _consistencies(block: FilterSummary) -> Mapping[str, Consistency]:
    return {name: one for name, one in (("nees", block.nees), ("nis", block.nis)) if one is not None}


def _exactly(value: float) -> Stated:
    return Stated(float(value), float(value), float(value))


def _bounded(value: float, low: float | None, high: float | None) -> Stated:
    if low is not None and high is not None:
        return Stated(value, low, high)
    return Stated(value, value - TOLERANCE * abs(value), value + TOLERANCE * abs(value))


def _share(share: float, frames: int) -> Stated:
    """Wilson's interval of ``share`` of ``frames``."""
    from scipy.stats import binomtest

    interval = binomtest(round(share * frames), frames).proportion_ci(0.95, method="wilson")
    return Stated(share, float(interval.low), float(interval.high))
