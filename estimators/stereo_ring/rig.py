"""The calibrated pair of cameras: epipolar lines and triangulation, Shu et al. 2020, eqs (1) and (2).

X_r = R X_l + T. Eq. (2) prints F = (K_r⁻¹)ᵀ R T K_l⁻¹ with a vector T between matrices; meant is F = K_r⁻ᵀ [T]× R K_l⁻¹
(Hartley & Zisserman 2004, eq. 9.2). Pixels here are those of a lens without distortion.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import RigidTransform

from scenes.arrays import Floats, frozen
from scenes.recording import Knowledge


@dataclass(frozen=True, eq=False)
class Rig:
    """``K_left``, ``K_right`` (3, 3) and ``right_from_left``, metres."""

    K_left: Floats
    K_right: Floats
    right_from_left: RigidTransform

    @cached_property
    def R(self) -> Floats:
        """Rotation (3, 3) from left into right camera axes."""
        return frozen(self.right_from_left.rotation.as_matrix())

    @cached_property
    def T(self) -> Floats:
        """The left camera's centre (3,) in the right camera's axes, metres."""
        return frozen(self.right_from_left.translation)

    @cached_property
    def fundamental(self) -> Floats:
        """F (3, 3) with p_rᵀ F p_l = 0, eq. (2) mended."""
        x, y, z = self.T
        across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        return frozen(np.linalg.inv(self.K_right).T @ across @ self.R @ np.linalg.inv(self.K_left))

    @cached_property
    def projections(self) -> Floats:
        """M of both cameras, (2, 3, 4): K_l [I | 0] and K_r [R | T]."""
        left = np.hstack([self.K_left, np.zeros((3, 1))])
        return frozen(np.stack([left, self.K_right @ np.hstack([self.R, self.T[:, None]])]))


def rig_from_knowledge(knowledge: Knowledge) -> Rig:
    """The rig of the declared pair. Raises ``ValueError`` naming what is missing."""
    pair = knowledge.pair
    if pair is None:
        raise ValueError("a stereo method needs Knowledge.pair: which two cameras form the rig")
    missing = {pair.left, pair.right} - knowledge.sensors.keys()
    if missing:
        raise ValueError(f"the pair names {sorted(missing)}, but the sensors are {sorted(knowledge.sensors)}")
    left, right = (knowledge.sensors[name].intrinsics for name in (pair.left, pair.right))
    if not np.linalg.norm(pair.right_from_left.translation) > 0:
        raise ValueError("the pair's cameras have the same centre; without a baseline nothing can be triangulated")
    return Rig(left.matrix, right.matrix, pair.right_from_left)


def epipolar_distance_px(rig: Rig, left_px: ArrayLike, right_px: ArrayLike) -> Floats:
    """How far (...,) two pixels (..., 2) are from being one point's: the larger of their distances from the epipolar lines."""
    left, right = homogeneous(left_px), homogeneous(right_px)
    line_right, line_left = left @ rig.fundamental.T, right @ rig.fundamental
    value = np.abs(np.sum(right * line_right, axis=-1))
    narrow = np.minimum(np.hypot(line_right[..., 0], line_right[..., 1]), np.hypot(line_left[..., 0], line_left[..., 1]))
    return np.asarray(value / np.maximum(narrow, 1e-300))


def triangulate(rig: Rig, left_px: ArrayLike, right_px: ArrayLike) -> Floats:
    """Points (..., 3), metres, left camera frame, of matched pixels (..., 2): eq. (1) in the least-squares sense.

    NaN for parallel rays. Solved twice, the second time with the rows over their depths, so that the residuals are pixels.
    """
    pixels = np.stack(np.broadcast_arrays(np.asarray(left_px, dtype=np.float64), np.asarray(right_px, dtype=np.float64)), axis=-2)
    rows = pixels[..., None] * rig.projections[:, 2:3] - rig.projections[:, :2]  # (..., camera, u or v, 4)
    first = _solved(rows)
    depth = np.einsum("ij,...j->...i", rig.projections[:, 2], homogeneous(first))
    return _solved(rows / np.where(np.abs(depth) > 1e-9, depth, 1.0)[..., None, None])


def project(rig: Rig, points_left: ArrayLike) -> tuple[Floats, Floats]:
    """Pixels (..., 2) in both views of points (..., 3), metres, left camera frame; NaN for what is behind a camera."""
    seen = np.einsum("cij,...j->...ci", rig.projections, homogeneous(points_left))
    depth = np.where(seen[..., 2:] > 0, seen[..., 2:], np.nan)
    pixels = seen[..., :2] / depth
    return pixels[..., 0, :], pixels[..., 1, :]


def homogeneous(points: ArrayLike) -> Floats:
    """(..., n) with a 1 behind, (..., n + 1)."""
    values = np.asarray(points, dtype=np.float64)
    return np.concatenate([values, np.ones_like(values[..., :1])], axis=-1)


def _solved(rows: Floats) -> Floats:
    """Least squares of the four equations by an orthogonal factor: normal equations would square the condition."""
    system = rows.reshape(*rows.shape[:-3], 4, 4)
    q, r = np.linalg.qr(np.nan_to_num(system[..., :3]))
    pivots = np.abs(np.einsum("...ii->...i", r))
    parallel = ~(pivots.min(axis=-1) > 1e-12 * pivots.max(axis=-1))
    right = -np.einsum("...ij,...i->...j", q, system[..., 3])
    points = np.linalg.solve(np.where(parallel[..., None, None], np.eye(3), r), right[..., None])[..., 0]
    return np.asarray(np.where(parallel[..., None], np.nan, points))
