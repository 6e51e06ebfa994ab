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

from estimators.mono_rectangle.quadrilateral import edge_normals
from estimators.mono_rectangle.robust_line import RobustLine, robust_line
from estimators.mono_rectangle.stations import Stations, stations_along
from scenes.arrays import Bools, Floats
from scenes.intrinsics import Intrinsics

_PEAK_ROUNDS, _BALANCE_ROUNDS = 5, 3
_PEAK_REST_PX, _BALANCE_REST_PX = 0.02, 2e-3
_MAX_STEP_PX = 1.5
_PSF_VARIANCE = 0.35  # px²: of a sharp lens and a box pixel; it only sets the length of a step, not where it ends
_TRANSITION_PX = 1.75  # half-width of a step after box pixel and point spread
_INSIDE_PX = 4.25  # beyond it, over how many pixels the brightness is taken, inside …
_OUTSIDE_PX = (2.5, 1.0)  # … and outside: the second only if something stands close to the edge
_INNER_WEIGHT, _OUTER_WEIGHT = 1.54, 1.86  # root of the sum of squares of the balance's pixel weights on each side
_PLAIN_STEP_PX, _PLAIN_STEP_SIGMAS = 0.25, 3.0  # how far the balance may lie from the peak if the step is plain
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
            pixels, ends_px, centre_px, lambda p, s: _to_gradient_peak(p, s, self.kernel_sigma_px, polarity), _PEAK_ROUNDS, _PEAK_REST_PX
        )
        if peak is None:
            return None
        normal = edge_normals(peak[0], centre_px)
        for outside_px in _OUTSIDE_PX:
            balance = self._rest(
                pixels, peak[0], centre_px, lambda p, s, o=outside_px: _to_balance(p, s, o), _BALANCE_ROUNDS, _BALANCE_REST_PX
            )
            if balance is not None and _agree(peak, balance, normal):
                return self._described(pixels, balance, normal, polarity, is_plain=True)
        return self._described(pixels, peak, normal, polarity, is_plain=False)

    def _rest(
        self, pixels: NDArray[np.generic], ends: Floats, centre: Floats, measure: Measure, rounds: int, rest_px: float
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
        inner, outer = self._sides(pixels, replace(stations, **_only(stations, line)))
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

    def _sides(self, pixels: NDArray[np.generic], stations: Stations) -> tuple["_Side", "_Side"]:
        """What the picture is like inside and outside of the edge."""
        reach = int(np.ceil(self.levels_px[1] / float(stations.cosine.min()))) + 1
        values, outward = stations.gather(pixels, reach)
        near = (np.abs(outward) > self.levels_px[0]) & (np.abs(outward) < self.levels_px[1])
        return _side(values, near & (outward < 0)), _side(values, near & (outward > 0))


@dataclass(frozen=True, slots=True)
class _Side:
    level_dn: float
    noise_dn: float


def _side(values: Floats, chosen: Bools) -> _Side:
    """Median of the chosen pixels, and their noise from the differences of neighbours along the edge; NaN if there is none."""
    if not chosen.any():
        return _Side(float("nan"), float("nan"))
    steps = np.diff(values, axis=0)[chosen[1:] & chosen[:-1]]
    noise = 1.4826 * float(np.median(np.abs(steps))) / np.sqrt(2) if steps.size else float("nan")
    return _Side(float(np.median(values[chosen])), noise)


def _agree(peak: Rest, balance: Rest, normal: Floats) -> bool:
    """Whether both measures mean the same line, as they do on a plain step."""
    spread = np.sqrt(np.diag(peak[2].covariance + balance[2].covariance))
    apart = np.abs((balance[0] - peak[0]) @ normal)
    return bool(np.all(apart < np.maximum(_PLAIN_STEP_PX, _PLAIN_STEP_SIGMAS * spread)))


def _only(stations: Stations, line: RobustLine) -> dict[str, Floats]:
    keep = line.inliers
    return {name: getattr(stations, name)[keep] for name in ("at", "crossing", "fraction", "cosine")}


def _to_gradient_peak(
    pixels: NDArray[np.generic], stations: Stations, sigma: float, polarity: int
) -> tuple[Floats, Floats]:
    """Distance outward (n,) px from the line to the gradient's maximum, and the weight (n,): the gradient there."""
    reach = int(np.ceil(4 * sigma / float(stations.cosine.min()))) + 1
    values, outward = stations.gather(pixels, reach)
    values = values - values[:, reach : reach + 1]
    u = outward / sigma
    bell = np.exp(-(u**2) / 2)
    scale = polarity * stations.cosine / (sigma**2 * np.sqrt(2 * np.pi))
    strength = -np.sum(values * u * bell, axis=1) * scale
    change = -np.sum(values * (u**2 - 1) * bell, axis=1) * scale / sigma
    typical = max(float(np.median(strength)), 1e-9)
    distance = (sigma**2 + _PSF_VARIANCE) * change / np.maximum(strength, 0.3 * typical)
    weight = np.where(strength > 0.3 * typical, np.minimum(strength, 3 * typical), 0.0)
    return np.clip(distance, -2 * sigma, 2 * sigma), weight


def _to_balance(pixels: NDArray[np.generic], stations: Stations, outside_px: float) -> tuple[Floats, Floats]:
    """Distance outward (n,) px from the line to the gradient's balance, and the weight (n,): the step across the edge.

    Σ D F(u) / Σ D over the differences D of neighbouring pixels at distances u. F(u) = u across the whole transition, so
    that the quotient is the first moment; beyond, F sinks to 0, which takes the brightness on both sides from the
    pixels at hand: farther inside, where there are more of them and their shot noise is larger.
    """
    slant = float(np.sqrt(1 / stations.cosine.min() ** 2 - 1))
    full = _TRANSITION_PX * (1 + slant) / np.hypot(1, slant)
    reach = int(np.ceil((full + max(_INSIDE_PX, outside_px)) / float(stations.cosine.min()))) + 1
    values, outward = stations.gather(pixels, reach)
    fall, at = -np.diff(values, axis=1), (outward[:, 1:] + outward[:, :-1]) / 2
    fall = fall * stations.outward
    ramp = np.interp(at, [-full - _INSIDE_PX, -full, full, full + outside_px], [0.0, -full, full, 0.0])
    step = np.sum(fall, axis=1, where=np.abs(at) < full + 1)
    typical = float(np.median(step))
    sound = step * np.sign(typical) > 0.3 * abs(typical)
    distance = np.sum(fall * ramp, axis=1) / np.where(sound, step, 1.0)
    return np.clip(np.where(sound, distance, 0.0), -2, 2), np.where(sound, np.minimum(np.abs(step), 3 * abs(typical)), 0.0)
