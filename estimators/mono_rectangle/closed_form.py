"""Four vertices → rotation, without the rectangle's size: Zhai et al. 2014, eqs (7)-(17), in OpenCV axes.

Vertices are in the paper's order P1..P4 (Z-order: P2 = P1 + L e1, P3 = P1 + W e2, P4 = P1 + L e1 + W e2), as ideal
normalised image points (x, y) = (X/Z, Y/Z). Every function works over leading batch axes. The feature's axes are
X = outward normal, Y = length, Z = width. A degenerate quadrilateral (three vertices in line) gives NaN, not an error.

The same formulas as the paper prints them, in its own image axes, stand in ``paper_form``.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from scenes.arrays import Bools, Floats


@dataclass(frozen=True, slots=True, eq=False)
class DepthRatios:
    """Depths of P2, P3, P4 over that of P1: a, b, c of eqs (8)-(10), each (...,)."""

    a: Floats
    b: Floats
    c: Floats

    @property
    def all_positive(self) -> Bools:
        """Whether the four vertices lie on one side of the camera: false for every crossed labelling."""
        return np.asarray((self.a > 0) & (self.b > 0) & (self.c > 0))


def homogeneous(points: ArrayLike) -> Floats:
    """Rays h = (x, y, 1), (..., 3), of normalised points (..., 2)."""
    values = np.asarray(points, dtype=np.float64)
    return np.concatenate([values, np.ones_like(values[..., :1])], axis=-1)


def depth_ratios(vertices: ArrayLike) -> DepthRatios:
    """Eqs (8)-(10) for vertices (..., 4, 2): a = |134|/|234|, b = |124|/|324|, c = −|123|/|234|, |ijk| = det[hi hj hk].

    They solve h1 + c h4 = a h2 + b h3, which is eq. (7): the fourth corner of a parallelogram.
    """
    h = homogeneous(vertices)
    h1, h2, h3, h4 = (h[..., i, :] for i in range(4))
    with np.errstate(divide="ignore", invalid="ignore"):
        d234 = _determinant(h2, h3, h4)
        return DepthRatios(
            a=_determinant(h1, h3, h4) / d234, b=-_determinant(h1, h2, h4) / d234, c=-_determinant(h1, h2, h3) / d234
        )


def sides(vertices: ArrayLike) -> tuple[Floats, Floats]:
    """Eqs (11), (12): q2 = a h2 − h1 and q3 = b h3 − h1, (..., 3): the sides L e1 and W e2 over P1's depth, camera axes."""
    h, ratios = homogeneous(vertices), depth_ratios(vertices)
    q2 = ratios.a[..., None] * h[..., 1, :] - h[..., 0, :]
    q3 = ratios.b[..., None] * h[..., 2, :] - h[..., 0, :]
    return q2, q3


def raw_rotation(vertices: ArrayLike) -> Floats:
    """Eqs (15)-(17): columns r2 = q2/|q2|, r3 = q3/|q3|, r1 = r2 × r3, (..., 3, 3); camera from feature.

    With noise r2·r3 ≠ 0, so that this is not quite a rotation; ``projection`` makes it one.
    """
    q2, q3 = sides(vertices)
    with np.errstate(divide="ignore", invalid="ignore"):
        r2 = q2 / np.linalg.norm(q2, axis=-1, keepdims=True)
        r3 = q3 / np.linalg.norm(q3, axis=-1, keepdims=True)
    return np.stack([np.cross(r2, r3), r2, r3], axis=-1)


def aspect_ratio(vertices: ArrayLike) -> Floats:
    """L/W = |q2|/|q3|, (...,): eq. (13) over eq. (14)."""
    q2, q3 = sides(vertices)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.linalg.norm(q2, axis=-1) / np.linalg.norm(q3, axis=-1))


def is_seen_from_outside(vertices: ArrayLike) -> Bools:
    """Whether the outward normal r1 points to the camera: r1 · mean(h) < 0, (...,)."""
    normal = raw_rotation(vertices)[..., 0]
    return np.asarray(np.sum(normal * homogeneous(vertices).mean(axis=-2), axis=-1) < 0)


def is_possible(vertices: ArrayLike) -> Bools:
    """Whether vertices (..., 4, 2) can be a rectangle seen from outside: finite, a, b, c > 0, normal to the camera."""
    return depth_ratios(vertices).all_positive & is_seen_from_outside(vertices)


def _determinant(first: Floats, second: Floats, third: Floats) -> Floats:
    return np.asarray(np.sum(first * np.cross(second, third), axis=-1))
