"""A straight line through noisy distances along an edge, deaf to the stations that look at something else."""

from dataclasses import dataclass

import numpy as np

from scenes.arrays import Bools, Floats

_REWEIGHTINGS = 4
_TUKEY = 4.685
_REWEIGHTING_LOSS = 1.32  # (E[weight]/E[ψ′])² of the biweight for Gaussian noise: the sandwich takes the weights for fixed
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
    base = (strength / strength.max()) ** 2
    near, far = 1 - fraction, fraction
    shift = np.full(2, _median(distance[seen]))
    residual = distance - shift[0]
    for _ in range(_REWEIGHTINGS):
        scale = max(1.4826 * _median(np.abs(residual[seen])), _LEAST_SCALE_PX)
        weight = base * np.maximum(1 - (residual / (_TUKEY * scale)) ** 2, 0) ** 2
        solvable = _inverse_normal(weight, near, far)
        if solvable is None:
            return None
        inverse = solvable
        pull = weight * distance
        shift = inverse @ np.array([pull @ near, pull @ far])
        residual = distance - shift[0] * near - shift[1] * far
    design, pull = np.stack([near, far], axis=1), weight * residual
    moment = (pull[:, None] * design).T @ (pull[:, None] * design)
    covariance = np.asarray(_REWEIGHTING_LOSS * inverse @ moment @ inverse)
    return RobustLine(shift, covariance, scale, seen & (np.abs(residual) < max(3 * scale, _INLIER_PX)))


def _inverse_normal(weight: Floats, near: Floats, far: Floats) -> Floats | None:
    """(AᵀWA)⁻¹ of the design [near, far]; None where the stations left do not tell the two ends apart."""
    nn, nf, ff = float(weight @ near**2), float(weight @ (near * far)), float(weight @ far**2)
    determinant = nn * ff - nf**2
    if not determinant > 1e-6 * (nn + ff) ** 2:
        return None
    return np.array([[ff, -nf], [-nf, nn]]) / determinant


def _median(values: Floats) -> float:
    """The upper median: quicker than ``np.median``, and no worse for a scale."""
    middle = len(values) // 2
    return float(np.partition(values, middle)[middle])
