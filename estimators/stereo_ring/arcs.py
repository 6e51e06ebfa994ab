"""Step 1 of section 2.3.1, second half: segments that support an arc (Lu et al. 2020, sec. III).

Where a segment lies along an arc, the mean gradients of its two halves turn from that of the whole in opposite senses; along a
straight edge they do not. All arcs are then run through so that they turn from +u towards +v: their centre lies at +90° of
their direction, and the sense in which a ring is brighter is a sign of its own.
"""

from dataclasses import dataclass

import numpy as np

from estimators.stereo_ring.detector_parameters import DetectorParameters
from estimators.stereo_ring.segments import Reduced
from scenes.arrays import Bools, Floats

_ALONG_HALF, _ASIDE = 8, np.array([-1.0, 0.0, 1.0])  # samples of each half along the segment and beside it
_POINTS = 7  # edge points that stand for a segment
_REACH, _REACH_OF_LENGTH = 1.5, 0.06  # how far from the chord the edge is looked for: a 45° arc bulges by 0.05 of its length
_MOST_REACH = 8


@dataclass(frozen=True, slots=True, eq=False)
class Pieces:
    """n segments in reduced pixels: ``ends`` (n, 2, 2), ``length`` (n,), unit ``brighter`` (n, 2) across the chord to the bright
    side, ``turns`` (n, 2) rad of the halves' mean gradients from that of the whole, edge ``points`` (n, 7, 2), ``weights`` (n, 7).
    """

    ends: Floats
    length: Floats
    brighter: Floats
    turns: Floats
    points: Floats
    weights: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Arcs:
    """n arcs in reduced pixels: ``ends`` (n, 2, 2) first to last, unit ``direction`` (n, 2) of the chord, ``length`` (n,),
    ``half_turn`` (n,) rad from its middle to its end, ``bright_inside`` (n,) ±1, edge ``points`` (n, 7, 2) and ``weights`` (n, 7).
    """

    ends: Floats
    direction: Floats
    length: Floats
    half_turn: Floats
    bright_inside: Floats
    points: Floats
    weights: Floats

    def __len__(self) -> int:
        """How many."""
        return len(self.length)

    @property
    def inward(self) -> Floats:
        """Unit vectors (n, 2) from the chord towards the arc's centre."""
        return quarter_turned(self.direction)


def edge_pieces(picture: Reduced, segments: Floats) -> Pieces:
    """What the gradient says of segments (n, 2, 2)."""
    along = segments[:, 1] - segments[:, 0]
    length = np.linalg.norm(along, axis=1)
    across = quarter_turned(along / length[:, None])
    halves = _half_gradients(picture, segments, across)
    whole = halves.sum(axis=1)
    brighter = across * np.where(np.sum(whole * across, axis=1) < 0, -1.0, 1.0)[:, None]
    points, weights = _edge_points(picture, segments, brighter, length)
    return Pieces(segments, length, brighter, signed_angle(whole[:, None], halves), points, weights)


def arc_support(pieces: Pieces, parameters: DetectorParameters) -> Arcs:
    """The longest pieces that support an arc."""
    before, after = pieces.turns.T
    least = np.radians(parameters.min_half_turn_deg)
    keep = np.flatnonzero((before * after < 0) & (np.abs(pieces.turns).min(axis=1) >= least))
    keep = np.sort(keep[np.argsort(-pieces.length[keep], kind="stable")[: parameters.most_arcs]])
    ends = np.where((after[keep] < 0)[:, None, None], pieces.ends[keep][:, ::-1], pieces.ends[keep])
    direction = (ends[:, 1] - ends[:, 0]) / pieces.length[keep][:, None]
    bright_inside = np.sign(np.sum(pieces.brighter[keep] * quarter_turned(direction), axis=1))
    half_turn = np.abs(pieces.turns[keep]).sum(axis=1)  # a half's mean is that of its middle: twice as far to its end
    return Arcs(ends, direction, pieces.length[keep], half_turn, bright_inside, pieces.points[keep], pieces.weights[keep])


def quarter_turned(vectors: Floats) -> Floats:
    """Vectors (..., 2) turned by +90°, from +u to +v."""
    return np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)


def signed_angle(first: Floats, second: Floats) -> Floats:
    """Angle (...,) rad from ``first`` to ``second`` (..., 2), positive from +u to +v."""
    cross = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
    return np.asarray(np.arctan2(cross, np.sum(first * second, axis=-1)))


def _half_gradients(picture: Reduced, segments: Floats, across: Floats) -> Floats:
    """Sums (n, 2 halves, 2) of the gradient along the segment and one pixel to both sides."""
    share = (np.arange(2 * _ALONG_HALF) + 0.5) / (2 * _ALONG_HALF)
    on = segments[:, None, 0] + share[:, None] * (segments[:, None, 1] - segments[:, None, 0])
    along = picture.sampled(on[:, :, None] + _ASIDE[:, None] * across[:, None, None]).sum(axis=2)
    return np.stack([along[:, :_ALONG_HALF].sum(axis=1), along[:, _ALONG_HALF:].sum(axis=1)], axis=1)


def _edge_points(picture: Reduced, segments: Floats, brighter: Floats, length: Floats) -> tuple[Floats, Floats]:
    """Where the gradient to the bright side is strongest across the chord: points (n, 7, 2), weights 1 or 0 (n, 7)."""
    share = (np.arange(_POINTS) + 0.5) / _POINTS
    on = segments[:, None, 0] + share[:, None] * (segments[:, None, 1] - segments[:, None, 0])
    offsets = np.arange(-_MOST_REACH, _MOST_REACH + 1.0)
    across = on[:, :, None] + offsets[:, None] * brighter[:, None, None]
    slope = np.einsum("nkoc,nc->nko", picture.sampled(across), brighter)
    far = np.abs(offsets) > np.minimum(_REACH + _REACH_OF_LENGTH * length, _MOST_REACH - 1)[:, None, None]
    offset, found = peak_offset(np.where(far, -np.inf, slope), slope)
    return on + (offset - _MOST_REACH)[..., None] * brighter[:, None], found.astype(np.float64)


def peak_offset(allowed: Floats, values: Floats) -> tuple[Floats, Bools]:
    """Index (...,) of the largest ``allowed`` value along the last axis, made finer by the parabola through ``values``."""
    top = np.clip(np.argmax(allowed, axis=-1), 1, values.shape[-1] - 2)[..., None]
    low, mid, high = (np.take_along_axis(values, top + step, axis=-1)[..., 0] for step in (-1, 0, 1))
    bend = low - 2 * mid + high
    is_peak = (bend < 0) & (mid > 0) & (mid >= low) & (mid >= high)
    fine = np.where(is_peak, (low - high) / (2 * np.where(is_peak, bend, -1.0)), 0.0)
    return top[..., 0] + fine, np.asarray(is_peak)
