"""Eqs (8)-(17) of Zhai et al. 2014 in the paper's own axes, and the way between these and OpenCV's.

The paper's camera frame C: X along the optical axis but BACKWARDS (the target has x_c < 0), Y along u, Z along v, with
u = −f y/x and v = −f z/x. Right-handedness then forces u to the right and v UP. Feeding v down gives a proper rotation
that is wrong: it leaves the pitch θ2 as it is and turns θ1 into π − θ1, which a pitch-only test does not notice.

The depth ratio c is eq. (10) mended: the printed denominator has (u2 − u1) where (u2 − u4) belongs, and the printed
result is named b. It plays no part in the rotation, but it does in telling a convex quadrilateral from a crossed one.
"""

import numpy as np
from numpy.typing import ArrayLike

from estimators.mono_rectangle.closed_form import DepthRatios
from scenes.arrays import Floats, frozen

PAPER_FROM_CV = frozen([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""M, (3, 3), det +1: vectors in OpenCV camera axes (x right, y down, z forward) into the paper's (backward, right, up)."""


def paper_from_normalised(points: ArrayLike, focal_px: float) -> Floats:
    """The paper's image coordinates (u, v), (..., 2), in pixels, v up, of OpenCV-normalised points (x, y)."""
    return np.asarray(np.asarray(points, dtype=np.float64) * np.array([focal_px, -focal_px]))


def paper_depth_ratios(uv_px: ArrayLike) -> DepthRatios:
    """Eqs (8), (9) as printed and (10) mended, for vertices (..., 4, 2) = (u_i, v_i)."""
    (u1, u2, u3, u4), (v1, v2, v3, v4) = _coordinates(uv_px)
    with np.errstate(divide="ignore", invalid="ignore"):
        a = ((u3 - u1) * (v3 - v4) - (u3 - u4) * (v3 - v1)) / ((u3 - u2) * (v3 - v4) - (u3 - u4) * (v3 - v2))
        b = ((u2 - u1) * (v2 - v4) - (u2 - u4) * (v2 - v1)) / ((u2 - u3) * (v2 - v4) - (u2 - u4) * (v2 - v3))
        c = ((u2 - u3) * (v2 - v1) - (u2 - u1) * (v2 - v3)) / ((u2 - u4) * (v2 - v3) - (u2 - u3) * (v2 - v4))
    return DepthRatios(a=a, b=b, c=c)


def paper_rotation(uv_px: ArrayLike, focal_px: float) -> Floats:
    """Eqs (11)-(17): R_ct, (..., 3, 3), the paper's camera frame from the target frame.

    The minus signs of (13)-(16) stand because x_1c is negative. With noise the columns are not quite orthogonal.
    """
    (u1, u2, u3, _), (v1, v2, v3, _) = _coordinates(uv_px)
    ratios = paper_depth_ratios(uv_px)
    with np.errstate(divide="ignore", invalid="ignore"):
        q2 = np.stack([ratios.a - 1, (u1 - ratios.a * u2) / focal_px, (v1 - ratios.a * v2) / focal_px], axis=-1)
        q3 = np.stack([ratios.b - 1, (u1 - ratios.b * u3) / focal_px, (v1 - ratios.b * v3) / focal_px], axis=-1)
        r2 = -q2 / np.linalg.norm(q2, axis=-1, keepdims=True)
        r3 = -q3 / np.linalg.norm(q3, axis=-1, keepdims=True)
    return np.stack([np.cross(r2, r3), r2, r3], axis=-1)


def paper_pitch(uv_px: ArrayLike, focal_px: float) -> Floats:
    """θ2, (...,), radians, from r3 alone: tan θ2 = (b − 1) f / hypot(u1 − b u3, v1 − b v3) (from eqs (12), (16))."""
    (u1, _, u3, _), (v1, _, v3, _) = _coordinates(uv_px)
    b = paper_depth_ratios(uv_px).b
    return np.asarray(np.arctan2((b - 1) * focal_px, np.hypot(u1 - b * u3, v1 - b * v3)))


def _coordinates(uv_px: ArrayLike) -> tuple[Floats, Floats]:
    values = np.asarray(uv_px, dtype=np.float64)
    return np.moveaxis(values[..., 0], -1, 0), np.moveaxis(values[..., 1], -1, 0)
