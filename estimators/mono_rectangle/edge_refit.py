"""Fine fit of one straight edge, to about a hundredth of a pixel: first where the gradient is largest, then its balance.

1. At every station the picture is correlated with the first and second derivative of a Gaussian at the current line;
   their quotient is the station's distance from its own gradient maximum. It needs no brightness levels and finds the
   edge from two pixels away, but it leans with the sub-pixel phase by up to 0.05 px: a pixel integrates, it does not sample.
2. From there the first moment of the gradient (summed by parts: the area under the profile, Tabatabai & Mitchell 1984):
   exact for every phase, every symmetric point spread and box pixels, but only for a plain step. Where it moves far from 1 (a bright strip along the edge), the answer of 1 stays, with an honest uncertainty.

In both, a line through the stations' distances, weighted by the gradient and made robust by Tukey's biweight (Huber &
Ronchetti 2009, ch. 4), moves the current line until it rests.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from estimators.mono_rectangle.edge_sides import sides_of
from estimators.mono_rectangle.gradient_balance import to_balance
from estimators.mono_rectangle.gradient_peak import to_gradient_peak
from estimators.mono_rectangle.quadrilateral import edge_normals
from estimators.mono_rectangle.robust_line import RobustLine, robust_line
from estimators.mono_rectangle.step_profile import step_misfit, to_step
from estimators.mono_rectangle.stations import Stations, stations_along
from scenes.arrays import Floats
from scenes.intrinsics import Intrinsics

_PEAK_ROUNDS, _BALANCE_ROUNDS, _STEP_ROUNDS = 5, 2, 3
_PEAK_REST_PX, _REST_PX = 0.02, 2e-3
_MAX_STEP_PX = 1.5
_OUTSIDE_PX = (2.5, 1.0)  # where the balance takes the brightness outside: the second only if something stands close
_INNER_WEIGHT, _OUTER_WEIGHT = 1.54, 1.86  # root of the sum of squares of the balance's pixel weights on each side
_PLAIN_STEP_PX, _PLAIN_STEP_SIGMAS = 0.25, 3.0  # how far the balance may lie from the peak if the step is plain
_MOST_MISFIT = 25.0  # of the profile of a plain step, in variances of a pixel …
_PLAIN_MISFIT, _MISFIT_VARIANCE_PX2 = 3.0, 0.008**2  # … beyond the first, each adds this to the variance of the line
_PEAK_PHASE_SIGMA_PX = 0.04

Measure = Callable[[NDArray[np.generic], Stations], tuple[Floats, Floats]]
Rest = tuple[Floats, Stations, RobustLine]  # where the line came to rest: its ends, the stations, their line


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
class EdgeRefit:
    """Where and how edges are fitted: ``kernel_sigma_px`` of the gradient, ``trim`` and ``gap`` as in ``stations_along``;
    ``levels_px``: between which distances from the edge the brightness on its sides is read."""

    intrinsics: Intrinsics
    kernel_sigma_px: float
    trim: tuple[float, float]
    gap: tuple[float, float] | None
    levels_px: tuple[float, float]

    def fit(self, pixels: NDArray[np.generic], ends_px: Floats, centre_px: Floats, polarity: int) -> EdgeFit | None:
        """The edge near ``ends_px`` (2, 2) of the quadrilateral about ``centre_px``; None where the line runs away."""
        peak = self._rest(
            pixels, ends_px, centre_px, lambda p, s: to_gradient_peak(p, s, self.kernel_sigma_px, polarity), _PEAK_ROUNDS, _PEAK_REST_PX
        )
        if peak is None:
            return None
        normal = edge_normals(peak[0], centre_px)
        for outside_px in _OUTSIDE_PX:
            balance = self._rest(pixels, peak[0], centre_px, lambda p, s, o=outside_px: to_balance(p, s, o), _BALANCE_ROUNDS)
            finest = self._finest(pixels, balance, centre_px) if balance is not None and _agree(peak, balance, normal) else None
            if finest is not None:
                return self._described(pixels, finest, normal, polarity, is_plain=True)
        return self._described(pixels, peak, normal, polarity, is_plain=False)

    def _finest(self, pixels: NDArray[np.generic], balance: Rest, centre: Floats) -> Rest | None:
        """From the balance to maximum likelihood; None where the profile is not a plain step's after all."""
        inside, outside = sides_of(pixels, balance[1], self.levels_px)
        step = self._rest(pixels, balance[0], centre, lambda p, s: to_step(p, s, inside, outside), _STEP_ROUNDS)
        if step is None or not _agree(balance, step, edge_normals(balance[0], centre)):
            return None
        misfit = step_misfit(pixels, step[1], inside, outside)
        extra = _MISFIT_VARIANCE_PX2 * max(misfit - _PLAIN_MISFIT, 0.0) * np.eye(2)
        line = replace(step[2], covariance=step[2].covariance + extra)
        return (step[0], step[1], line) if misfit < _MOST_MISFIT else None

    def _rest(
        self, pixels: NDArray[np.generic], ends: Floats, centre: Floats, measure: Measure, rounds: int, rest_px: float = _REST_PX
    ) -> Rest | None:
        """Moves the line by what ``measure`` says of its stations until it moves no more."""
        for _ in range(rounds):
            normal = edge_normals(ends, centre)
            stations = stations_along(ends, normal, self.intrinsics, self.trim, self.gap)
            line = robust_line(stations.fraction, *measure(pixels, stations)) if len(stations.at) >= 4 else None
            if line is None:
                return None
            step = np.clip(line.shift_px, -_MAX_STEP_PX, _MAX_STEP_PX)
            ends = ends + step[:, None] * normal
            if np.abs(step).max() < rest_px:
                break
        return ends, stations, line

    def _described(
        self, pixels: NDArray[np.generic], found: Rest, normal: Floats, polarity: int, *, is_plain: bool
    ) -> EdgeFit:
        ends, stations, line = found
        inner, outer = sides_of(pixels, replace(stations, **_only(stations, line)), self.levels_px)
        noise_dn = np.hypot(_INNER_WEIGHT * inner.noise_dn, _OUTER_WEIGHT * outer.noise_dn)
        extra = 0.0 if is_plain else _PEAK_PHASE_SIGMA_PX**2
        return EdgeFit(
            ends_px=ends,
            normal=normal,
            covariance=line.covariance + extra * np.eye(2),
            scale_px=line.scale_px,
            support=float(np.mean(line.inliers)),
            inner_dn=inner.level_dn,
            outer_dn=outer.level_dn,
            noise_scale_px=float(noise_dn / max(abs(inner.level_dn - outer.level_dn), 1e-9)),
            polarity=polarity,
            is_plain=is_plain,
        )


def _agree(peak: Rest, balance: Rest, normal: Floats) -> bool:
    """Whether both measures mean the same line, as they do on a plain step."""
    spread = np.sqrt(np.diag(peak[2].covariance + balance[2].covariance))
    apart = np.abs((balance[0] - peak[0]) @ normal)
    return bool(np.all(apart < np.maximum(_PLAIN_STEP_PX, _PLAIN_STEP_SIGMAS * spread)))


def _only(stations: Stations, line: RobustLine) -> dict[str, Floats]:
    keep = line.inliers
    return {name: getattr(stations, name)[keep] for name in ("at", "crossing", "fraction", "cosine")}
