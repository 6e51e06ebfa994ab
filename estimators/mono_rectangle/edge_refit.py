"""Fine fit of one straight edge, to about a hundredth of a pixel, in three measures of which each starts from the last.

1. ``gradient_peak``: where the gradient is largest. It needs no brightness levels and sees two pixels far, but it leans with
   the sub-pixel phase by up to 0.05 px: a pixel integrates, it does not sample.
2. ``gradient_balance``: the gradient's first moment: exact for every phase, but only for a plain step.
3. ``step_profile``: maximum likelihood for a step under box pixels: as exact, with half the noise.

Where 2 or 3 lead away from 1, or the profile of 3 does not fit, something else runs along the edge (its own thickness,
a neighbour): then the answer of 1 stays, said not to be plain and with an honest uncertainty. In all three, a robust line
through the stations' distances, weighted by the gradient, moves the current line until it rests.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from estimators.mono_rectangle.edge_sides import sides_of
from estimators.mono_rectangle.gradient_balance import to_balance
from estimators.mono_rectangle.gradient_peak import to_gradient_peak
from estimators.mono_rectangle.quadrilateral import edge_normals
from estimators.mono_rectangle.robust_line import RobustLine, robust_line
from estimators.mono_rectangle.stations import Stations, stations_along
from estimators.mono_rectangle.step_profile import step_misfit, to_step
from scenes.arrays import Floats
from scenes.intrinsics import Intrinsics

_PEAK_ROUNDS, _BALANCE_ROUNDS, _STEP_ROUNDS = 5, 2, 3
_PEAK_REST_PX, _REST_PX = 0.02, 2e-3
_MOST_STEP_PX = 1.5
_RESTLESS_PX = 0.2  # a line that still moves by as much has found nothing to rest on
_OUTSIDE_PX = (2.5, 1.0)  # where the balance takes the brightness outside: the second only if something stands close
_INNER_WEIGHT, _OUTER_WEIGHT = 1.54, 1.86  # root of the sum of squares of the balance's pixel weights on each side
_PLAIN_STEP_PX, _PLAIN_STEP_SIGMAS = 0.25, 3.0  # how far two measures may lie apart on a plain step
_MOST_MISFIT = 25.0  # of the profile of a plain step, in variances of a pixel …
_PLAIN_MISFIT, _MISFIT_VARIANCE_PX2 = 3.0, 0.008**2  # … beyond the first, each adds this to the variance of the line
_PEAK_PHASE_SIGMA_PX = 0.04

Measure = Callable[[NDArray[np.generic], Stations], tuple[Floats, Floats]]


@dataclass(frozen=True, slots=True, eq=False)
class EdgeFit:
    """A straight edge measured in a picture, in ideal px.

    ``ends_px`` (2, 2): points on the line beside the predicted ends; ``covariance`` (2, 2) px² of their distances along
    the normal; ``scale_px``: robust scatter of the stations; ``support``: fraction of the stations that see the edge;
    ``inner_dn``, ``outer_dn``: brightness on both sides; ``noise_scale_px``: the scatter that the pixels' noise alone gives;
    ``polarity`` +1 if bright inside; ``is_plain``: a single step, with nothing else running along it.
    """

    ends_px: Floats
    normal: Floats
    covariance: Floats
    scale_px: float
    support: float
    inner_dn: float
    outer_dn: float
    noise_scale_px: float
    polarity: int
    is_plain: bool


@dataclass(frozen=True, slots=True, eq=False)
class _Rest:
    """Where the line came to rest: its ends, the stations it was looked at from, and their line."""

    ends_px: Floats
    stations: Stations
    line: RobustLine

    def agrees(self, other: "_Rest", normal: Floats) -> bool:
        """Whether both mean the same line, as the measures do on a plain step."""
        spread = np.sqrt(np.diag(self.line.covariance + other.line.covariance))
        apart = np.abs((self.ends_px - other.ends_px) @ normal)
        return bool(np.all(apart < np.maximum(_PLAIN_STEP_PX, _PLAIN_STEP_SIGMAS * spread)))

    def with_variance(self, px2: float) -> "_Rest":
        """The same line, less certain by ``px2`` at both ends."""
        return replace(self, line=replace(self.line, covariance=self.line.covariance + px2 * np.eye(2)))


@dataclass(frozen=True, slots=True, eq=False)
class EdgeRefit:
    """Where and how edges are fitted: ``kernel_sigma_px`` of the gradient, ``trim`` and ``gap`` as in ``stations_along``;
    ``levels_px``: between which distances from the edge the brightness on its sides is read; ``centre_px``: what is inside."""

    intrinsics: Intrinsics
    centre_px: Floats
    kernel_sigma_px: float
    trim: tuple[float, float]
    gap: tuple[float, float] | None
    levels_px: tuple[float, float]

    def fit(self, pixels: NDArray[np.generic], ends_px: Floats, polarity: int) -> EdgeFit | None:
        """The edge near ``ends_px`` (2, 2) ideal px; None where the line runs away."""
        along_peak = partial(to_gradient_peak, sigma=self.kernel_sigma_px, polarity=polarity)
        peak = self._rest(pixels, ends_px, along_peak, _PEAK_ROUNDS, _PEAK_REST_PX)
        if peak is None:
            return None
        for outside_px in _OUTSIDE_PX:
            finest = self._finest(pixels, peak, outside_px)
            if finest is not None:
                return self._described(pixels, finest, polarity, is_plain=True)
        return self._described(pixels, peak.with_variance(_PEAK_PHASE_SIGMA_PX**2), polarity, is_plain=False)

    def _finest(self, pixels: NDArray[np.generic], peak: _Rest, outside_px: float) -> _Rest | None:
        """From the peak over the balance to maximum likelihood; None where the edge is not a plain step."""
        normal = edge_normals(peak.ends_px, self.centre_px)
        balance = self._rest(pixels, peak.ends_px, partial(to_balance, outside_px=outside_px), _BALANCE_ROUNDS, _REST_PX)
        if balance is None or not peak.agrees(balance, normal):
            return None
        inside, outside = sides_of(pixels, balance.stations, self.levels_px)
        step = self._rest(pixels, balance.ends_px, partial(to_step, inside=inside, outside=outside), _STEP_ROUNDS, _REST_PX)
        if step is None or not balance.agrees(step, normal):
            return None
        misfit = step_misfit(pixels, step.stations, inside, outside)
        return step.with_variance(_MISFIT_VARIANCE_PX2 * max(misfit - _PLAIN_MISFIT, 0.0)) if misfit < _MOST_MISFIT else None

    def _rest(self, pixels: NDArray[np.generic], ends: Floats, measure: Measure, rounds: int, rest_px: float) -> _Rest | None:
        """Moves the line by what ``measure`` says of its stations until it moves no more; half as far when it turns back."""
        found, step, share = None, np.zeros(2), 1.0
        for _ in range(rounds):
            normal = edge_normals(ends, self.centre_px)
            stations = stations_along(ends, normal, self.intrinsics, self.trim, self.gap)
            line = robust_line(stations.fraction, *measure(pixels, stations)) if len(stations.at) >= 4 else None
            if line is None:
                return None
            share = share / 2 if float(line.shift_px @ step) < 0 else share
            step = share * np.clip(line.shift_px, -_MOST_STEP_PX, _MOST_STEP_PX)
            ends = ends + step[:, None] * normal
            found = _Rest(ends, stations, line)
            if np.abs(step).max() < rest_px:
                break
        return found if np.abs(step).max() < _RESTLESS_PX else None

    def _described(self, pixels: NDArray[np.generic], found: _Rest, polarity: int, *, is_plain: bool) -> EdgeFit:
        inner, outer = sides_of(pixels, found.stations.only(found.line.inliers), self.levels_px)
        noise_dn = np.hypot(_INNER_WEIGHT * inner.noise_dn, _OUTER_WEIGHT * outer.noise_dn)
        return EdgeFit(
            ends_px=found.ends_px,
            normal=edge_normals(found.ends_px, self.centre_px),
            covariance=found.line.covariance,
            scale_px=found.line.scale_px,
            support=float(np.mean(found.line.inliers)),
            inner_dn=inner.level_dn,
            outer_dn=outer.level_dn,
            noise_scale_px=float(noise_dn / max(abs(inner.level_dn - outer.level_dn), 1e-9)),
            polarity=polarity,
            is_plain=is_plain,
        )
