"""Which part of the sphere is nearest to which direction: Voronoi cells, each cut in two where the sphere is.

Nearest by the angle between them, so that borders are great circles (Okabe et al. 2000, section 3.7).
"""

import numpy as np

from scenes.arrays import Floats

_CORNERS = 48  # of the small circle that a cell is cut from
_STEP = np.radians(4.0)  # along a border, which the map bends
_REACH = 0.8  # of the distance between neighbours: cells of an even grid reach no further, and what was not studied stays empty
_WIDEST = np.radians(80.0)  # a circle that planes through the middle can cut


def cells(directions: Floats) -> list[tuple[Floats, Floats]]:
    """Of each of (n, 3) unit vectors the outline of its cell with z ≤ 0, and of the part with z ≥ 0, (k, 3) each.

    A part that is not there has no rows. A cell ends where another direction is nearer, and at 0.8 of the usual distance
    between neighbours, so that a study of part of the sphere does not colour the rest.
    """
    own = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    reach = _reach(own)
    return [_halves(_cell(own, number, reach)) for number in range(len(own))]


def _reach(own: Floats) -> float:
    if len(own) < 2:
        return float(np.radians(20.0))
    angles = np.arccos(np.clip(own @ own.T - 2 * np.eye(len(own)), -1, 1))
    return float(min(_REACH * np.median(angles.min(axis=1)), _WIDEST))


def _cell(own: Floats, number: int, reach: float) -> Floats:
    """(k, 3) the small circle about a direction, cut where another one is nearer."""
    middle = own[number]
    outline = _circle(middle, reach)
    apart = np.arccos(np.clip(own @ middle, -1, 1))
    for other in np.flatnonzero((apart < 2 * reach) & (apart > 1e-6)):
        outline = _cut(outline, middle - own[other])
    return outline


def _circle(middle: Floats, radius: float) -> Floats:
    aside = np.cross(middle, np.eye(3)[np.argmin(np.abs(middle))])
    aside /= np.linalg.norm(aside)
    turn = 2 * np.pi * np.arange(_CORNERS)[:, None] / _CORNERS
    return np.asarray(np.cos(radius) * middle + np.sin(radius) * (np.cos(turn) * aside + np.sin(turn) * np.cross(middle, aside)))


def _cut(outline: Floats, normal: Floats) -> Floats:
    """What of a convex outline (k, 3) lies on the side of ``normal`` of a plane through the middle (Sutherland & Hodgman 1974)."""
    if not len(outline):
        return outline
    side = outline @ normal
    there = side > 0
    crosses = there != np.roll(there, -1)
    after, gap = np.roll(outline, -1, axis=0), side - np.roll(side, -1)
    share = np.divide(side, gap, out=np.zeros_like(side), where=crosses)
    border = outline + share[:, None] * (after - outline)
    kept = np.stack([outline, border], axis=1)[np.stack([there, crosses], axis=1)]
    return np.asarray(kept / np.linalg.norm(kept, axis=1, keepdims=True))


def _halves(outline: Floats) -> tuple[Floats, Floats]:
    toward, away = (_dense(_cut(outline, np.array([0.0, 0.0, sign]))) for sign in (-1.0, 1.0))
    return toward, away


def _dense(outline: Floats) -> Floats:
    """The same outline with corners at most ``_STEP`` apart."""
    if not len(outline):
        return outline
    after = np.roll(outline, -1, axis=0)
    angles = np.arccos(np.clip((outline * after).sum(axis=1), -1, 1))
    steps = np.maximum(np.ceil(angles / _STEP), 1).astype(int)
    edge = np.repeat(np.arange(len(outline)), steps)
    share = np.concatenate([np.arange(count) / count for count in steps])[:, None]
    dense = (1 - share) * outline[edge] + share * after[edge]
    return np.asarray(dense / np.linalg.norm(dense, axis=1, keepdims=True))
