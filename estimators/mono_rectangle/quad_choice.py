"""Which candidate line on each edge? The set of four that fits the prediction best and can be a rectangle at all."""

from itertools import product

import numpy as np

from estimators.mono_rectangle.aspect_memory import AspectMemory
from estimators.mono_rectangle.closed_form import aspect_ratio, is_possible, raw_rotation
from estimators.mono_rectangle.edge_finder import Candidate, Sighting
from estimators.mono_rectangle.quadrilateral import intersections, normalised_from_ideal
from scenes.intrinsics import Intrinsics

_SKEW_SIGMA = 0.05  # what r2·r3 may well be by noise: twice the face's at 0.05 px …
_LOG_ASPECT_SIGMA = 0.03  # … and log(L/W)


def choose_lines(sightings: list[Sighting], intrinsics: Intrinsics, aspect: AspectMemory) -> list[Candidate | None]:
    """One candidate (or None) for each edge: the cheapest set, where all four are seen the cheapest possible rectangle.

    A set of four costs the sum of its candidates, (r2·r3/σ)², by which a shadow's slanted border is told from an edge, and
    the squared sigmas by which its L/W departs from the track's, by which a neighbour's parallel edge is.
    """
    cheapest = [sighting.candidates[0] if sighting.candidates else None for sighting in sightings]
    sets = list(product(*(sighting.candidates for sighting in sightings)))
    if len(sets) < 2:
        return cheapest
    ends = np.array([[candidate.fit.ends_px for candidate in chosen] for chosen in sets])
    vertices = normalised_from_ideal(intersections(ends), intrinsics)
    raw = raw_rotation(vertices)
    skew = np.sum(raw[..., 1] * raw[..., 2], axis=-1)
    cost = np.array([sum(candidate.cost for candidate in chosen) for chosen in sets]) + (skew / _SKEW_SIGMA) ** 2
    cost += aspect.squared_sigmas(np.log(aspect_ratio(vertices)), _LOG_ASPECT_SIGMA)
    cost = np.where(is_possible(vertices), cost, np.inf)
    return list(sets[int(np.argmin(cost))]) if np.isfinite(cost).any() else cheapest
