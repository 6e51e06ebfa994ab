"""Point clouds as the registration sees them: the returns of a scan, surfaces with normals, and how they are thinned."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.spatial.transform import RigidTransform

from scenes.arrays import Bools, Floats
from scenes.recording import LidarModel, Scan

Indices = NDArray[np.intp]
_ALL = slice(None)


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Points (n, 3), metres, with outward unit normals (n, 3), in one frame that the variable's name says.

    ``is_edge`` (n,): where the surface ends, if that is known: there a point is told apart from its neighbours on all sides.
    """

    points: Floats
    normals: Floats
    is_edge: Bools | None = None

    def __len__(self) -> int:
        """How many points there are."""
        return len(self.points)

    def at(self, which: Bools | Indices) -> "Surface":
        """The points that a mask or indices choose."""
        return Surface(self.points[which], self.normals[which], None if self.is_edge is None else self.is_edge[which])

    def moved(self, a_from_b: RigidTransform) -> "Surface":
        """The same surface in frame a, given in frame b."""
        return Surface(a_from_b.apply(self.points), self.normals @ a_from_b.rotation.as_matrix().T, self.is_edge)


@dataclass(frozen=True, slots=True, eq=False)
class Returns:
    """The beams of one scan that came back: points (n, 3) in LIDAR axes at each beam's own time (n,), seconds."""

    points_lidar: Floats
    time_s: Floats

    def __len__(self) -> int:
        """How many beams came back."""
        return len(self.points_lidar)


def returns_of(scan: Scan, model: LidarModel) -> Returns:
    """Finite returns between the LIDAR's least and most range, as float64 copies in the order of the beams."""
    points = scan.points_lidar.reshape(-1, 3).astype(np.float64)
    range_m = np.linalg.norm(points, axis=1)
    with np.errstate(invalid="ignore"):
        kept = np.isfinite(range_m) & (range_m >= model.least_range_m) & (range_m <= model.most_range_m)
    return Returns(points[kept], scan.time_s.reshape(-1)[kept].astype(np.float64))


def voxels(points: Floats, voxel_m: float) -> tuple[Indices, int]:
    """The number of each point's voxel (n,) and how many voxels there are; numbered in the order of their coordinates."""
    if not len(points):
        return np.zeros(0, dtype=np.intp), 0
    cells = np.floor(points / voxel_m).astype(np.int64)
    cells -= cells.min(axis=0)
    size = cells.max(axis=0) + 1
    keys = (cells[:, 0] * size[1] + cells[:, 1]) * size[2] + cells[:, 2]
    _, number = np.unique(keys, return_inverse=True)
    return number, int(number.max()) + 1


def voxel_means(values: Floats, number: Indices, count: int) -> Floats:
    """Means (count, k) of ``values`` (n, k) over the voxels ``number`` (n,)."""
    held = np.bincount(number, minlength=count)
    sums = np.stack([np.bincount(number, weights=column, minlength=count) for column in values.T], axis=1)
    return np.asarray(sums / held[:, None])


def thinned(surface: Surface, voxel_m: float) -> Surface:
    """One point a voxel: the mean of those in it, with their mean normal."""
    number, count = voxels(surface.points, voxel_m)
    normals = voxel_means(surface.normals, number, count)
    length = np.linalg.norm(normals, axis=1)
    kept = length > 1e-6  # where both sides of a sheet fall in one voxel the normals cancel
    points = voxel_means(surface.points, number, count)
    return Surface(points[kept], normals[kept] / length[kept, None])


def nearest_in(tree: cKDTree, points: Floats) -> tuple[Floats, Indices]:
    """Distance and number (n,) of the tree's point nearest to each of ``points`` (n, 3)."""
    distance, number = tree.query(points)
    return np.asarray(distance, dtype=np.float64), np.asarray(number, dtype=np.intp)


def neighbours_of(points: Floats, count: int, of: Bools | slice = _ALL) -> tuple[Floats, Indices]:
    """Distance and number (m, k) of the nearest ``count`` of the points (n, d) to those that ``of`` chooses, itself first."""
    k = min(count, len(points))
    distance, number = cKDTree(points).query(points[of], k=k)
    return np.asarray(distance, dtype=np.float64).reshape(-1, k), np.asarray(number, dtype=np.intp).reshape(-1, k)


def every(points: Floats, most: int) -> Floats:
    """At most ``most`` of the points, evenly spread over their order."""
    if len(points) <= most:
        return points
    return points[np.linspace(0, len(points) - 1, most).round().astype(np.intp)]


def planes_through(points: Floats, eye: Floats, neighbours: int) -> Surface:
    """Each point moved onto the plane through its nearest ``neighbours``, with that plane's normal, turned towards ``eye`` (3,).

    The normal is the eigenvector of the neighbours' scatter with the least eigenvalue (Hoppe et al. 1992, §3.1).
    """
    _, near = neighbours_of(points, neighbours)
    around = points[near]
    middle = around.mean(axis=1)
    around = around - middle[:, None]
    _, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", around, around))
    normals = axes[:, :, 0]
    away = np.sum(normals * (eye - points), axis=1) < 0
    normals = np.where(away[:, None], -normals, normals)
    off = np.sum((middle - points) * normals, axis=1, keepdims=True)
    return Surface(points + off * normals, normals)


def filled(surface: Surface, neighbours: int = 4) -> Surface:
    """The points, and the middles between each and its nearest ``neighbours``, where these are not far for a neighbour.

    Where both clouds of a registration lie on the grid of the beams, nearest points hold the grids together and not the target.
    """
    distance, near = neighbours_of(surface.points, neighbours + 1)
    usual = np.median(distance[:, 1])
    one, rank = np.nonzero(distance[:, 1:] < 3 * usual)
    pairs = np.unique(np.sort(np.stack([one, near[one, rank + 1]], axis=1), axis=1), axis=0)
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    points = surface.points[pairs].mean(axis=1)
    normals = surface.normals[pairs].sum(axis=1)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    kept = length[:, 0] > 0.5  # the two sides of a corner have no middle
    return Surface(
        np.concatenate([surface.points, points[kept]]), np.concatenate([surface.normals, normals[kept] / length[kept]])
    )
