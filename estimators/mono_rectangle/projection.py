"""The closed form's columns made a rotation: with noise r2·r3 ≠ 0, and |r1| = sqrt(1 − (r2·r3)²)."""

from typing import Literal

import numpy as np

from scenes.arrays import Floats

Projection = Literal["raw", "svd", "gs2", "gs3"]


def project_to_so3(raw: Floats, how: Projection = "svd") -> Floats:
    """Rotation matrices (..., 3, 3) from the closed form's (..., 3, 3) = [r1 r2 r3].

    ``raw`` leaves it as the paper does; ``svd`` takes the nearest rotation in the Frobenius norm (orthogonal Procrustes,
    Schönemann 1966, with det +1); ``gs2`` and ``gs3`` keep r2 or r3 and turn the other (Gram-Schmidt).
    Matrices that are not finite stay NaN.
    """
    if how == "raw":
        return raw
    if how == "svd":
        return _nearest_rotation(raw)
    r2, r3 = raw[..., 1], raw[..., 2]
    if how == "gs2":
        r3 = _orthogonal_to(r2, r3)
    else:
        r2 = _orthogonal_to(r3, r2)
    return np.stack([np.cross(r2, r3), r2, r3], axis=-1)


def _nearest_rotation(raw: Floats) -> Floats:
    finite = np.isfinite(raw).all(axis=(-2, -1), keepdims=True)
    safe = np.where(finite, raw, np.eye(3))
    u, _, vt = np.linalg.svd(safe)
    u[..., :, 2] *= np.linalg.det(u @ vt)[..., None]
    return np.where(finite, u @ vt, np.nan)


def _orthogonal_to(kept: Floats, turned: Floats) -> Floats:
    rest = turned - np.sum(kept * turned, axis=-1, keepdims=True) * kept
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(rest / np.linalg.norm(rest, axis=-1, keepdims=True))
