"""A straight line through noisy distances along an edge, deaf to the stations that look at something else."""

from dataclasses import dataclass

import numpy as np

from scenes.arrays import Bools, Floats

_REWEIGHTINGS = 4
_TUKEY = 4.685
_LEAST_SCALE_PX = 0.01
_INLIER_PX = 0.3


@dataclass(frozen=True, slots=True, eq=False)
class RobustLine:
    """``shift_px`` (2,): distances at the edge's two ends; ``covariance`` (2, 2) px² of these; ``scale_px``: robust scatter;
    ``inliers`` (n,): the stations that lie on the line."""

    shift_px: Floats
    covariance: Floats
    scale_px: float
    inliers: Bools


def robust_line(fraction: Floats, distance: Floats, strength: Floats) -> RobustLine | None:
    """Iteratively reweighted least squares, Tukey's biweight, begun with the median (Huber & Ronchetti 2009, ch. 4).

    ``fraction`` (n,) of the way from the first end to the second, ``distance`` (n,) px, ``strength`` (n,): stations weigh
    with its square, none at all where it is 0. None if fewer than four stations or too short a piece is left.
    """
    seen = strength > 0
    if np.count_nonzero(seen) < 4:
        return None
    design = np.stack([1 - fraction, fraction], axis=1)
    base = (strength / strength.max()) ** 2
    shift = np.full(2, np.median(distance[seen]))
    for _ in range(_REWEIGHTINGS):
        residual = distance - design @ shift
        scale = max(1.4826 * float(np.median(np.abs(residual[seen]))), _LEAST_SCALE_PX)
        weight = base * np.clip(1 - (residual / (_TUKEY * scale)) ** 2, 0, None) ** 2
        normal = design.T @ (weight[:, None] * design)
        if not np.linalg.det(normal) > 1e-6 * np.trace(normal) ** 2:
            return None
        shift = np.linalg.solve(normal, design.T @ (weight * distance))
    residual = distance - design @ shift
    inverse = np.linalg.inv(normal)
    covariance = inverse @ (design.T @ ((weight * residual)[:, None] ** 2 * design)) @ inverse
    return RobustLine(shift, covariance, scale, seen & (np.abs(residual) < max(3 * scale, _INLIER_PX)))
