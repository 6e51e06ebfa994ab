"""The turn about the ring's normal from markers whose places in the ring's frame are known.

Observed in a frame whose X axis is only predicted, marker i is at o_i = Rz(δ) k_i + t + noise. The turn δ comes with the shift t
in the plane, of which the ring's own accuracy says how large it may be: a ring's centre that is off by 0.05 mm looks like a turn
of 0.01° to a marker 0.3 m out, but not to several all round.
"""

from dataclasses import dataclass

import numpy as np

from estimators.stereo_ring.marker_parameters import ConstellationParameters
from scenes.arrays import Bools, Floats

_STEPS = 6


@dataclass(frozen=True, slots=True, eq=False)
class Turn:
    """``angle_rad`` with its ``sigma_rad``; ``shift_m`` (2,) in the plane; ``used`` (n,): the pairs that agree."""

    angle_rad: float
    sigma_rad: float
    shift_m: Floats
    used: Bools


def voted_pairs(
    observed: Floats, known: Floats, alike: Bools, radius_m: float, p: ConstellationParameters
) -> list[tuple[int, int]]:
    """Which of observed (n, 3) is which of known (m, 3): the turn on which most agree, the smallest of equals.

    ``alike`` (n, m): pairs that may be one by their looks. Pairs (observed, known), each at most once.
    """
    tolerance = p.same_share * radius_m
    out, known_out = np.hypot(*observed[:, :2].T), np.hypot(*known[:, :2].T)
    possible = alike & (np.abs(out[:, None] - known_out) < tolerance)
    possible &= np.abs(observed[:, None, 2] - known[:, 2]) < tolerance
    angle = np.arctan2(*observed[:, 1::-1].T)[:, None] - np.arctan2(*known[:, 1::-1].T)
    turns = (angle + np.pi) % (2 * np.pi) - np.pi
    possible &= np.abs(turns) < np.deg2rad(p.most_turn_deg)
    best: list[tuple[int, int]] = []
    for turn in sorted(turns[possible], key=abs):
        pairs = _agreeing(observed, known, possible, float(turn), p.vote_share * radius_m)
        if len(pairs) > len(best):
            best = pairs
    return best


def solved_turn(observed: Floats, known: Floats, sigma_m: Floats, ring_sigma_m: float, p: ConstellationParameters) -> Turn | None:
    """δ and t by least squares from pairs (n, 2), robust; ``sigma_m`` (n,) of each pair, ``ring_sigma_m`` of the centre."""
    used = np.ones(len(observed), dtype=bool)
    angle, shift = _first_angle(observed, known), np.zeros(2)
    for number in range(_STEPS):
        if not used.any():
            return None
        c, s = np.cos(angle), np.sin(angle)
        turned = known @ np.array([[c, s], [-s, c]])
        weight = np.where(used, 1 / sigma_m**2, 0.0)
        across = np.stack([-turned[:, 1], turned[:, 0]], axis=1)
        residual = observed - turned - shift
        normal = np.diag([1e-12, 1 / ring_sigma_m**2, 1 / ring_sigma_m**2])
        normal[0, 0] += np.sum(weight * np.sum(across**2, axis=1))
        normal[0, 1:] = normal[1:, 0] = weight @ across
        normal[[1, 2], [1, 2]] += np.sum(weight)
        pull = weight @ residual
        right = np.array([np.sum(weight * np.sum(across * residual, axis=1)), *(pull - shift / ring_sigma_m**2)])
        step = np.linalg.solve(normal, right)
        angle, shift = angle + float(step[0]), shift + step[1:]
        left = np.linalg.norm(residual - step[0] * across - step[1:], axis=1)
        gate = np.maximum(p.gate_sigmas * np.hypot(sigma_m, ring_sigma_m), p.gate_m)
        used = left <= np.maximum(gate, 1.5 * np.median(left) if number < _STEPS - 2 else 0.0)  # at first the far ones pull, too
    if not used.any():
        return None
    return Turn(angle, float(np.sqrt(np.linalg.inv(normal)[0, 0])), shift, used)


def _first_angle(observed: Floats, known: Floats) -> float:
    """The median of the pairs' own turns, weighted by none."""
    turns = np.arctan2(known[:, 0] * observed[:, 1] - known[:, 1] * observed[:, 0], np.sum(known * observed, axis=1))
    return float(np.median(turns))


def _agreeing(observed: Floats, known: Floats, possible: Bools, turn: float, within_m: float) -> list[tuple[int, int]]:
    """The pairs that lie within reach of each other after this turn, the nearest first."""
    c, s = np.cos(turn), np.sin(turn)
    turned = np.column_stack([known[:, :2] @ np.array([[c, s], [-s, c]]), known[:, 2]])
    distance = np.where(possible, np.linalg.norm(observed[:, None] - turned, axis=-1), np.inf)
    pairs: list[tuple[int, int]] = []
    while distance.size and (least := distance.min()) <= within_m:
        i, j = (int(index[0]) for index in np.nonzero(distance == least))
        pairs.append((i, j))
        distance[i], distance[:, j] = np.inf, np.inf
    return pairs
