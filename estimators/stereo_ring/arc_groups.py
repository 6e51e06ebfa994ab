"""Step 2 of section 2.3.1: arcs that follow one another on a convex curve form a group.

An arc links to the one whose start is nearest to its end among those that go on turning the same way, with the same side
bright; a link counts where both choose each other.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from estimators.stereo_ring.arcs import Arcs, signed_angle
from estimators.stereo_ring.detector_parameters import DetectorParameters
from scenes.arrays import Bools, Floats

_NEAR = 4.0  # reduced pixels: a gap so small has no direction
_BACK_DEG = 12.0  # noise may turn a link back by this


@dataclass(frozen=True, slots=True, eq=False)
class Groups:
    """``members`` (groups, arcs): which arcs belong together; ``bright_inside`` (groups,) ±1. The longest first."""

    members: Bools
    bright_inside: Floats


def arc_groups(arcs: Arcs, parameters: DetectorParameters, scale: float) -> Groups:
    """The groups with the greatest length of arc, ``top_groups`` at most."""
    count = len(arcs)
    if count == 0:
        return Groups(np.zeros((0, 0), dtype=bool), np.zeros(0))
    follows = _next_arcs(arcs, parameters, scale)
    linked = np.flatnonzero(follows >= 0)
    graph = coo_array((np.ones(len(linked)), (linked, follows[linked])), shape=(count, count))
    number, label = connected_components(graph, directed=False)
    length = np.bincount(label, weights=arcs.length, minlength=number)
    chosen = np.argsort(-length, kind="stable")[: parameters.top_groups]
    members = label[None, :] == chosen[:, None]
    return Groups(members, np.asarray(np.sign(members @ arcs.bright_inside)))


def _next_arcs(arcs: Arcs, parameters: DetectorParameters, scale: float) -> NDArray[np.intp]:
    """Index (n,) of the arc that follows, −1 where none does."""
    gap = arcs.ends[None, :, 0] - arcs.ends[:, None, 1]
    distance = np.hypot(gap[..., 0], gap[..., 1])
    reach = np.maximum(parameters.max_link_gap * (arcs.length[:, None] + arcs.length[None, :]) / 2, _NEAR)
    possible = (distance <= reach) & (arcs.bright_inside[:, None] == arcs.bright_inside[None, :])
    np.fill_diagonal(possible, val=False)
    first, second = np.nonzero(possible)
    cost = np.full(distance.shape, np.inf)
    cost[first, second] = _link_costs(arcs, first, second, parameters, scale)
    after, before = cost.argmin(axis=1), cost.argmin(axis=0)
    index = np.arange(len(arcs))
    mutual = np.isfinite(cost[index, after]) & (before[after] == index)
    return np.where(mutual, after, -1)


def _link_costs(
    arcs: Arcs, first: NDArray[np.intp], second: NDArray[np.intp], parameters: DetectorParameters, scale: float
) -> Floats:
    """Gap (k,) from the end of the first arcs to the start of the second, plus their turn; infinite where they cannot follow."""
    gap = arcs.ends[second, 0] - arcs.ends[first, 1]
    distance = np.hypot(gap[:, 0], gap[:, 1])
    leaving = turned(arcs.direction, arcs.half_turn)[first]
    entering = turned(arcs.direction, -arcs.half_turn)[second]
    total, into, out = signed_angle(leaving, entering), signed_angle(leaving, gap), signed_angle(gap, entering)
    even = np.abs(into - out) / 2 <= np.radians(parameters.link_tolerance_deg)
    onward = (np.abs(into) < np.pi / 2) & (np.abs(out) < np.pi / 2)
    turning = (total >= -np.radians(_BACK_DEG)) & (total <= np.radians(parameters.max_link_turn_deg))
    possible = turning & ((distance <= _NEAR) | (even & onward))
    return np.where(possible, distance + scale * np.degrees(np.abs(total)) / 4, np.inf)


def turned(vectors: Floats, angle: Floats) -> Floats:
    """Vectors (n, 2) turned by angles (n,) rad from +u towards +v."""
    c, s = np.cos(angle), np.sin(angle)
    u, v = vectors[:, 0], vectors[:, 1]
    return np.stack([c * u - s * v, s * u + c * v], axis=1)
