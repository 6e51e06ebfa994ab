"""A ray caster in plain float64 numpy (Möller and Trumbore 1997), to hold the renderer's geometry against."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from scenes.arrays import Bools, Floats
from scenes.exr import Window
from scenes.intrinsics import Intrinsics
from scenes.solids import solids
from scenes.target import Target

_CHUNK = 8192


@dataclass(frozen=True, slots=True, eq=False)
class Triangles:
    """``corners`` (n, 3, 3) in the target frame and the 1-based number of the part that each belongs to."""

    corners: Floats
    part_id: NDArray[np.uint32]

    @classmethod
    def of(cls, target: Target) -> "Triangles":
        """All triangles of a target."""
        parts = solids(target)
        corners = np.concatenate([part.vertices_target[part.faces] for part in parts])
        numbers = np.repeat(np.arange(1, len(parts) + 1, dtype=np.uint32), [len(part.faces) for part in parts])
        return cls(corners, numbers)

    @property
    def normals(self) -> Floats:
        """Outward unit normals (n, 3)."""
        a, b, c = self.corners.transpose(1, 0, 2)
        normal = np.cross(b - a, c - a)
        return normal / np.linalg.norm(normal, axis=1, keepdims=True)


@dataclass(frozen=True, slots=True, eq=False)
class Hits:
    """Per ray: distance (inf = none), index of the triangle (−1 = none)."""

    distance: Floats
    triangle: NDArray[np.int64]

    @property
    def valid(self) -> Bools:
        """Which rays met something."""
        return np.isfinite(self.distance)


def cast(triangles: Triangles, origins: Floats, directions: Floats, nearest: float = 0.0) -> Hits:
    """The first triangle beyond ``nearest`` along each of n rays (origins and unit directions (n, 3))."""
    chunks = [
        _first(triangles.corners, origins[i : i + _CHUNK], directions[i : i + _CHUNK], nearest)
        for i in range(0, len(directions), _CHUNK)
    ]
    return Hits(np.concatenate([one[0] for one in chunks]), np.concatenate([one[1] for one in chunks]))


def _first(corners: Floats, origins: Floats, directions: Floats, nearest: float) -> tuple[Floats, NDArray[np.int64]]:
    a, edge1, edge2 = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    p = np.cross(directions[:, None], edge2[None])
    determinant = np.einsum("rtk,tk->rt", p, edge1)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = origins[:, None] - a[None]
        u = np.einsum("rtk,rtk->rt", s, p) / determinant
        q = np.cross(s, edge1[None])
        v = np.einsum("rk,rtk->rt", directions, q) / determinant
        t = np.einsum("tk,rtk->rt", edge2, q) / determinant
        met = (np.abs(determinant) > 1e-14) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > nearest)
    t = np.where(met, t, np.inf)
    first = t.argmin(axis=1)
    distance = t[np.arange(len(t)), first]
    return distance, np.where(np.isfinite(distance), first, -1)


def pixel_rays(intrinsics: Intrinsics, cam_from_target: RigidTransform, window: Window) -> tuple[Floats, Floats]:
    """Origins and unit directions (h·w, 3), target frame, through the pixel centres of ``window``, row by row."""
    rows, columns = np.mgrid[window.slices]
    pixels = np.stack([columns, rows], axis=-1).reshape(-1, 2).astype(np.float64)
    target_from_cam = cam_from_target.inv()
    directions = target_from_cam.rotation.apply(intrinsics.rays(pixels))
    return np.broadcast_to(target_from_cam.translation, directions.shape), directions
