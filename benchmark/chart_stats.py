"""Statistics behind the charts: distribution functions, quantiles, bins and medians. A frame without an answer is infinite."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from benchmark.ranking_bootstrap import plain_quantiles
from scenes.arrays import Floats

Ints = NDArray[np.int64]

CURVE_POINTS = 200
_FIGURES = 3  # significant figures within which two values of a condition are the same one
_PLACES = 3


@dataclass(frozen=True, slots=True, eq=False)
class Bins:
    """``member`` (n,): each frame's bin, −1 for none; ``names``: one a bin; ``edges``: their borders, None for single values."""

    member: Ints
    names: tuple[str, ...]
    edges: tuple[str, ...] | None


def cdf(errors: Floats, most: int = CURVE_POINTS) -> tuple[Floats, Floats]:
    """At most ``most`` points (error, share of ALL ``errors`` up to it) of the empirical distribution function.

    Infinite errors count among all, so the curve ends at the share that was answered and not at one. Empty without an answer.
    """
    known = np.sort(errors[np.isfinite(errors)])
    index = np.unique(np.linspace(0, known.size - 1, min(most, known.size)).round().astype(np.int64))
    return known[index], (index + 1) / max(errors.size, 1)


def quantile(errors: Floats, share: float) -> float:
    """The quantile of ``errors`` (n,), linear between neighbours; infinite where it falls among the infinite ones, NaN for none."""
    if errors.size == 0:
        return float("nan")
    return float(plain_quantiles(errors, (share,))[0])


def bins(values: Floats, most: int = 6) -> Bins:
    """One bin for each value where there are at most ``most``, else bins of about equal counts; NaN belongs to none.

    No bin is empty. Values are told apart to ``_FIGURES`` significant figures and ``_PLACES`` decimal places, as they are printed;
    where most are one value there may be a single bin.
    """
    known = np.isfinite(values)
    rounded = _rounded(values)
    single = np.unique(rounded[known])
    if single.size <= most:
        names = tuple(f"{value:g}" for value in single)
        return Bins(np.where(known, np.searchsorted(single, rounded), -1), names, None)
    edges = np.unique(np.quantile(rounded[known], np.linspace(0, 1, most + 1), method="nearest"))
    member = np.clip(np.searchsorted(edges, rounded, side="right") - 1, 0, len(edges) - 2)
    texts = tuple(f"{edge:g}" for edge in edges)
    return Bins(np.where(known, member, -1), tuple(f"{low} to {high}" for low, high in pairwise(texts)), texts)


def stretches(time_s: Floats, most: int) -> tuple[Ints, Floats]:
    """(n,) which of at most ``most`` stretches of equally many instants each time falls in, and the middles of the stretches, s."""
    instants = np.unique(time_s)
    step = max(1, -(-instants.size // most))
    groups = np.arange(instants.size) // step
    middles = np.array([instants[groups == group].mean() for group in range(groups[-1] + 1)]) if instants.size else np.empty(0)
    return groups[np.searchsorted(instants, time_s)], middles


def _rounded(values: Floats) -> Floats:
    """To ``_FIGURES`` significant figures and ``_PLACES`` decimal places; what is not finite stays."""
    sizes = np.abs(np.where(np.isfinite(values) & (values != 0), values, 1.0))
    scale = 10.0 ** (_FIGURES - 1 - np.floor(np.log10(sizes)))
    return np.round(np.round(values * scale) / scale, _PLACES)
