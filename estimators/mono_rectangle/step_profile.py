"""How far is the edge, if it is a step seen by box pixels through a narrow lens? The finest of the three measures.

The column of pixels across an edge of slope m holds C(x) = step * box(1) * box(m) * [t, 1 − 2t, t]: the area that a pixel
has of the bright side, blurred by the point spread's share t in the next pixel, which is estimated from the picture. The
distance is that of maximum likelihood for one linear step: Σ g r/v ÷ Σ g²/v, with r the residual, g the slope of the
profile, v the pixels' variance. Only the two or three pixels that the edge touches weigh, the dark ones most: about half the
noise of the balance, from which it has to start.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimators.mono_rectangle.edge_sides import Side
from estimators.mono_rectangle.stations import Stations
from scenes.arrays import Floats

_LEAST_SLOPE = 0.02
_MOST_MOVE_PX = 1.0  # farther, one linear step says nothing
_REACH_PX = 1.75  # across which the profile is compared
_INSIDE_PX, _OUTSIDE_PX = 3.5, 2.0  # beyond it, over which the levels are taken
_TAP, _TAP_SIGMA, _TAP_MOST = 0.11, 0.05, 0.24


def to_step(pixels: NDArray[np.generic], stations: Stations, inside: Side, outside: Side) -> tuple[Floats, Floats]:
    """Distance outward (n,) px from the line to the edge, and the weight (n,): the square root of its information."""
    seen = _compare(pixels, stations, inside, outside)
    information = np.sum(seen.weight * seen.slope**2, axis=1)
    moved = np.sum(seen.weight * seen.slope * seen.residual, axis=1) / np.where(information > 0, information, 1.0)
    known = (information > 0) & (np.abs(moved) < _MOST_MOVE_PX)
    return np.where(known, moved, 0.0) * stations.cosine, np.sqrt(np.where(known, information, 0.0))


def step_misfit(pixels: NDArray[np.generic], stations: Stations, inside: Side, outside: Side) -> float:
    """Squared residual of the profile over the pixels' variance, the median station's mean: about 1 for a plain step."""
    seen = _compare(pixels, stations, inside, outside)
    count = np.sum(seen.weight > 0, axis=1)
    squares = np.sum(seen.weight * seen.residual**2, axis=1)[count > 0] / count[count > 0]
    return float(np.median(squares)) if squares.size else float("inf")


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """Stations × pixels: what the picture has beyond the profile, DN; its slope by a shift outward, DN a px; 1/variance."""

    residual: Floats
    slope: Floats
    weight: Floats


def _compare(pixels: NDArray[np.generic], stations: Stations, inside: Side, outside: Side) -> _Seen:
    slope = max(float(np.sqrt(1 / stations.cosine.mean() ** 2 - 1)), _LEAST_SLOPE)
    half = _REACH_PX * (1 + slope)
    reach = int(np.ceil(half + _INSIDE_PX)) + 1
    values, outward = stations.gather(pixels, reach)
    x = outward / stations.cosine[:, None]  # along the column
    inner = _mean(values, (x < -half) & (x >= -half - _INSIDE_PX))
    outer = _mean(values, (x > half) & (x <= half + _OUTSIDE_PX))
    step = inner - outer
    typical = inside.level_dn - outside.level_dn
    sound = (step * np.sign(typical) > 0.3 * abs(typical))[:, None] & (np.abs(x) <= half)
    (bright, shape), (bright_slope, shape_slope) = _profile(x, slope)
    variance = outside.noise_dn**2 + bright * (inside.noise_dn**2 - outside.noise_dn**2)
    weight = np.where(sound, 1 / np.maximum(variance, 1e-3), 0.0)
    residual = values - outer[:, None] - step[:, None] * bright
    tap = _tap(residual, step[:, None] * shape, weight)
    return _Seen(residual - tap * step[:, None] * shape, -step[:, None] * (bright_slope + tap * shape_slope), weight)


def _tap(residual: Floats, shape: Floats, weight: Floats) -> float:
    """The point spread's share in the next pixel: least squares with a weak prior."""
    top = float(np.sum(weight * residual * shape)) + _TAP / _TAP_SIGMA**2
    return float(np.clip(top / (float(np.sum(weight * shape**2)) + 1 / _TAP_SIGMA**2), 0, _TAP_MOST))


def _profile(x: Floats, slope: float) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """(C without point spread, what a tap of 1 adds to it), and both derivatives by x; columns of ``x`` are a pixel apart."""
    direction = x[:, 1] - x[:, 0]
    wide = np.concatenate([x[:, :1] - direction[:, None], x, x[:, -1:] + direction[:, None]], axis=1)
    c, d = _covered(wide, slope), _covered_slope(wide, slope)
    return tuple((f[:, 1:-1], f[:, :-2] + f[:, 2:] - 2 * f[:, 1:-1]) for f in (c, d))  # type: ignore[return-value]


def _covered(x: Floats, slope: float) -> Floats:
    """Share of a unit pixel, x beyond an edge of slope m, that lies on the bright side: step * box(1) * box(m)."""
    wide, narrow = (1 + slope) / 2, abs(1 - slope) / 2

    def half_square(z: Floats) -> Floats:
        return np.maximum(z, 0) ** 2 / 2

    fallen = half_square(x + wide) - half_square(x + narrow) - half_square(x - narrow) + half_square(x - wide)
    return np.asarray(1 - fallen / slope)


def _covered_slope(x: Floats, slope: float) -> Floats:
    wide, narrow = (1 + slope) / 2, abs(1 - slope) / 2
    fallen = np.maximum(x + wide, 0) - np.maximum(x + narrow, 0) - np.maximum(x - narrow, 0) + np.maximum(x - wide, 0)
    return np.asarray(-fallen / slope)


def _mean(values: Floats, chosen: NDArray[np.bool_]) -> Floats:
    return np.asarray(np.sum(values, axis=1, where=chosen) / np.maximum(np.sum(chosen, axis=1), 1))
