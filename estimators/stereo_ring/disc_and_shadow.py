"""A disc and its own shadow: one outline, of which a half is the disc's and a half is the shadow's.

A thin plate throws a shadow of its own shape and size, displaced by d. Together they have the outline n·c + h(n) + max(0, n·d) in
every direction n. That is also the outline of a disc at c + d with a shadow at c: which of both the disc is, the picture just
inside the edge tells, which is darker along the shadow.
"""

import numpy as np

from estimators.stereo_ring.marker_parameters import MarkerParameters
from estimators.stereo_ring.robust import tukey_weights
from scenes.arrays import Bools, Floats

_DIRECTIONS = 24
_FIT_STEPS = 4


def lit_part(
    border: Floats, outward: Floats, distance_px: Floats, used: Bools, darkness_dn: Floats, p: MarkerParameters
) -> tuple[Floats, Floats] | None:
    """The disc's own border (n, 2), and the residuals (n,) of the outline; None if too few points are used.

    ``border`` (n, 2) with normals ``outward``: a curve of the disc's shape; ``distance_px`` (n,) from it to the edge, where
    ``used``; ``darkness_dn`` (n,): how much darker than the disc it is just inside the edge.
    """
    if used.sum() < p.least_points:
        return None
    middle = border.mean(axis=0)
    plain = np.column_stack([outward, np.sum(outward * (border - middle), axis=1)])
    (step,), (residual,), _ = _robust(plain[None], distance_px, used, p)
    if used.mean() >= p.whole_share:
        shifted = _with_shadow(plain, outward, distance_px, used, darkness_dn, p)
        step, residual = (step, residual) if shifted is None else shifted
    return middle + step[:2] + (1 + step[2]) * (border - middle), residual


def _with_shadow(
    plain: Floats, outward: Floats, distance_px: Floats, used: Bools, darkness_dn: Floats, p: MarkerParameters
) -> tuple[Floats, Floats] | None:
    """Shift and growth (3,) of the disc beside its shadow, and the residuals (n,); None if there is no such displacement."""
    angle = np.arange(_DIRECTIONS) * (2 * np.pi / _DIRECTIONS)
    towards = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    shadow = np.maximum(outward @ towards.T, 0.0).T
    rows = np.concatenate([np.broadcast_to(plain, (_DIRECTIONS, *plain.shape)), shadow[..., None]], axis=-1)
    steps, residuals, cost = _robust(rows, distance_px, used, p)
    best = int(np.argmin(np.where(steps[:, 3] > 0, cost, np.inf)))
    offset_px = float(steps[best, 3])
    if not p.least_offset_px <= offset_px <= p.most_offset_px:
        return None
    step = steps[best, :3]
    if _dark(darkness_dn, used, shadow[best]) < _dark(darkness_dn, used, np.maximum(-outward @ towards[best], 0.0)):
        step = step + np.array([*(offset_px * towards[best]), 0.0])
    return np.asarray(step), residuals[best]


def _robust(rows: Floats, distance_px: Floats, used: Bools, p: MarkerParameters) -> tuple[Floats, Floats, Floats]:
    """Least squares with Tukey's weights for k sets of rows (k, n, m): (k, m), residuals (k, n), robust cost (k,)."""
    known = np.broadcast_to(used, rows.shape[:2])
    weight = known.astype(np.float64)
    steps: Floats = np.zeros((len(rows), rows.shape[2]))
    residual: Floats = np.broadcast_to(distance_px, rows.shape[:2])
    for number in range(_FIT_STEPS):
        if number:
            weight = tukey_weights(residual, known, p.least_sigma_px)
        weighted = rows * weight[..., None]
        normal = np.swapaxes(weighted, 1, 2) @ rows
        normal += 1e-9 * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(rows.shape[2])
        steps = np.asarray(np.linalg.solve(normal, np.swapaxes(weighted, 1, 2) @ distance_px[:, None])[..., 0])
        residual = distance_px - np.einsum("knm,km->kn", rows, steps)
    return steps, residual, np.sum(np.where(known, np.minimum(np.abs(residual), p.near_px), 0.0), axis=1)


def _dark(darkness_dn: Floats, used: Bools, weight: Floats) -> float:
    return float(np.sum(darkness_dn * weight * used) / max(float(np.sum(weight * used)), 1e-9))
