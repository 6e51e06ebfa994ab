"""Sub-ray hits sorted into the pulses that a receiver can tell apart."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from renderer.beams import Echoes
from scenes.arrays import Bools, Floats

_STEEPEST = 0.05  # cosine of the incidence up to which a tilted surface counts as filling the gaps between its sub-rays


@dataclass(frozen=True, slots=True, eq=False)
class Pulses:
    """Every pulse that comes back, (p,) each: by beam, then from near to far.

    ``beam``: its row in the echoes. ``place``: its place among the beam's pulses. ``source``: its sub-ray nearest to the beam's
    axis. ``electrons``: expected photo-electrons. ``range_m``: energy-weighted mean, ``stretch_m``: standard deviation about it.
    ``fraction``: share of the spot.
    """

    beam: NDArray[np.int64]
    place: NDArray[np.int64]
    source: NDArray[np.int64]
    electrons: Floats
    range_m: Floats
    stretch_m: Floats
    fraction: Floats


def pulses(echoes: Echoes, electrons: Floats, live: Bools, resolution_m: float, spacing_rad: float) -> Pulses:
    """Pulses of the sub-rays that are ``live`` and send back ``electrons``, both (beams, sub-rays).

    Hits of one beam that lie no further apart than ``resolution_m`` make one pulse, whose range is their mean weighted with
    energy: a mixed pixel. Along a tilted surface the hits of sub-rays ``spacing_rad`` apart may lie further apart by
    spacing · range · tan(incidence), as the surface sends light from all of the way between them.
    """
    range_m = np.where(live, echoes.range_m, np.inf)
    order = np.argsort(range_m, axis=1, kind="stable")
    range_m, cosine, electrons = (np.take_along_axis(values, order, axis=1) for values in (range_m, echoes.cosine, electrons))
    within = np.isfinite(range_m)
    row = np.nonzero(within)[0]
    if not len(row):
        none, nothing = np.zeros(0, np.int64), np.zeros(0)
        return Pulses(none, none, none, nothing, nothing, nothing, nothing)
    first = np.flatnonzero(_starts(np.where(within, range_m, 0.0), cosine, resolution_m, spacing_rad)[within])
    count = np.diff(np.append(first, len(row)))
    mean_m, stretch_m = _moments(range_m[within], electrons[within], first, count)
    return Pulses(
        beam=row[first],
        place=_places(row[first]),
        source=np.minimum.reduceat(order[within], first),
        electrons=np.add.reduceat(electrons[within], first),
        range_m=mean_m,
        stretch_m=stretch_m,
        fraction=count / live.shape[1],
    )


def _starts(range_m: Floats, cosine: NDArray[np.float32], resolution_m: float, spacing_rad: float) -> Bools:
    """Where a new pulse begins in ranges sorted along each row (m, n)."""
    steep = np.clip(cosine.astype(np.float64), _STEEPEST, 1.0)
    reach = spacing_rad * range_m * np.sqrt(1 - steep**2) / steep
    filled = resolution_m + (reach[:, :-1] + reach[:, 1:]) / 2
    return np.concatenate([np.ones((len(range_m), 1), np.bool_), np.diff(range_m, axis=1) > filled], axis=1)


def _moments(range_m: Floats, electrons: Floats, first: NDArray[np.int64], count: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Mean and standard deviation of each pulse's ranges, weighted with energy (equally where there is none)."""
    total, many = (np.repeat(values, count) for values in (np.add.reduceat(electrons, first), count))
    weight = np.where(total > 0, electrons / np.where(total > 0, total, 1.0), 1 / many)
    mean_m = np.add.reduceat(weight * range_m, first)
    variance = np.add.reduceat(weight * (range_m - np.repeat(mean_m, count)) ** 2, first)
    return mean_m, np.sqrt(variance)


def _places(beam: NDArray[np.int64]) -> NDArray[np.int64]:
    """0, 1, … among equal neighbours of ``beam``."""
    here = np.arange(len(beam))
    is_new = np.append(True, np.diff(beam) > 0)
    return np.asarray(here - np.maximum.accumulate(np.where(is_new, here, 0)))
