"""A first ellipse grows onto all the segments that lie along it, arcs or not: foil breaks a ring's edge into many short ones.

The end of step 3 of section 2.3.1, "global search": two groups only start an ellipse. Members are the segments within a
tolerance whose direction is the ellipse's; the fit to them chooses them anew, with half the tolerance.
"""

import numpy as np
from numpy.typing import NDArray

from estimators.stereo_ring.arcs import Pieces
from estimators.stereo_ring.conics import conics_from_parameters, sampson_px
from estimators.stereo_ring.detector_parameters import DetectorParameters
from estimators.stereo_ring.ellipse_fits import direct_fits, point_scatter
from scenes.arrays import Bools, Floats

Float32s = NDArray[np.float32]
_SINE = 0.3  # of the angle between a segment and the ellipse beside it


def grown(ellipses: Floats, pieces: Pieces, parameters: DetectorParameters, scale: float) -> Floats:
    """The ellipses (n, 5), reduced pixels, drawn onto the segments along them.

    With polarity "any" each grows twice, (2n, 5): onto the segments of the sense that is more of it, and onto all.
    """
    if len(ellipses) == 0 or len(pieces.length) == 0:
        return ellipses
    one_sense = _grown(ellipses, pieces, parameters, scale, both_senses=False)
    if parameters.polarity == "same":
        return one_sense
    return np.concatenate([one_sense, _grown(ellipses, pieces, parameters, scale, both_senses=True)])


def _grown(ellipses: Floats, pieces: Pieces, parameters: DetectorParameters, scale: float, both_senses: bool) -> Floats:
    scatters = [one.reshape(len(pieces.length), 36) for one in point_scatter(pieces.points, pieces.weights)]
    for share in (1.0, 0.5):
        members = _members(ellipses, pieces, share * parameters.growth_px * scale, both_senses).astype(np.float64)
        fitted, _ = direct_fits(*((members @ one).reshape(-1, 6, 6) for one in scatters))
        kept = np.isfinite(fitted).all(axis=1, keepdims=True) & _near(fitted, ellipses)[:, None]
        ellipses = np.where(kept, fitted, ellipses)
    return ellipses


def _members(ellipses: Floats, pieces: Pieces, tolerance: float, both_senses: bool) -> Bools:
    """Which segments (n, m) lie along which ellipses; else only those of the sense that is more of it."""
    C = conics_from_parameters(ellipses)
    value, gu, gv = _along_conics(C, pieces.points[:, pieces.points.shape[1] // 2])
    length = np.maximum(np.hypot(gu, gv), np.float32(1e-12))
    brighter = pieces.brighter.astype(np.float32)
    cosine = (gu * brighter[:, 0] + gv * brighter[:, 1]) / length
    near = (np.abs(value) <= 2 * tolerance * length) & (np.abs(cosine) >= np.sqrt(1 - _SINE**2))
    row, column = np.nonzero(near)
    ends = pieces.points[column][:, [0, -1]]
    near[row, column] = (np.abs(sampson_px(C[row], ends)) <= tolerance).all(axis=1)
    if both_senses:
        return np.asarray(near)
    inside, outside = near & (cosine < 0), near & (cosine > 0)
    more = (inside @ pieces.length) >= (outside @ pieces.length)
    return np.asarray(np.where(more[:, None], inside, outside))


def _along_conics(C: Floats, points: Floats) -> tuple[Float32s, Float32s, Float32s]:
    """pᵀ C p and the two components of C p, (n, m) each, of all points (m, 2) at all conics (n, 3, 3)."""
    u, v = points.T
    monomials = np.stack([u * u, 2 * u * v, v * v, 2 * u, 2 * v, np.ones_like(u)]).astype(np.float32)
    value = C.reshape(-1, 9)[:, [0, 1, 4, 2, 5, 8]].astype(np.float32) @ monomials
    linear = monomials[[3, 4, 5]] * np.array([[0.5], [0.5], [1.0]], dtype=np.float32)
    return value, C[:, 0].astype(np.float32) @ linear, C[:, 1].astype(np.float32) @ linear


def _near(fitted: Floats, before: Floats) -> Bools:
    """A fit that has become another ellipse altogether is not taken."""
    with np.errstate(invalid="ignore"):
        moved = np.abs(fitted - before)[:, :4].max(axis=1)
        return np.asarray(moved <= 0.5 * before[:, 3])
