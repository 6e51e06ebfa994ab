"""The model of a target that a suite may grant a LIDAR method: points strewn over what can be seen of it from outside.

The points are drawn with the same probability on every part of the surface, from a stream that has nothing to do with the data
set's seed, so that every method and every run of one target is told the same cloud.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.arrays import Floats, frozen
from scenes.errors import UsageError
from scenes.provenance import sha256_of_bytes, stream
from scenes.recording import ModelCloud
from scenes.solids import solids
from scenes.target import Target

POINTS = 6000
_DIRECTIONS = 96  # of a whole sphere, in which a point looks for open space
_LIFT = 1e-5  # by which a point is lifted off the surface before it looks, of the target's size: float32 rays hit where they start
_ROUNDS = 40  # of drawing, until there are enough visible points


def model_cloud(target: Target, points: int = POINTS) -> ModelCloud:
    """``points`` points of the target's visible surface with outward normals. Raises ``UsageError`` where there is none.

    A point is visible where at least one of many directions about its normal leads away from the target without meeting it.
    """
    triangles, random = triangles_of(target), stream(0, 0, "knowledge.model")
    scene, size_m = ray_scene(triangles), float(np.ptp(triangles.reshape(-1, 3), axis=0).max())
    chosen: list[Floats] = []
    for _ in range(_ROUNDS):
        drawn, normals = _strewn(triangles, points, random)
        seen = _is_seen(scene, drawn + _LIFT * size_m * normals, normals)
        chosen.append(np.hstack([drawn, normals])[seen])
        if sum(map(len, chosen)) >= points:
            cloud = np.concatenate(chosen)[:points]
            return ModelCloud(frozen(cloud[:, :3]), frozen(cloud[:, 3:]))
    raise UsageError("nearly nothing of the target's surface can be seen from outside, so no model of it can be told")


def digest(cloud: ModelCloud) -> str:
    """SHA-256 of the points and normals."""
    return sha256_of_bytes(np.hstack([cloud.points_target, cloud.normals_target]).astype("<f8").tobytes())


def triangles_of(target: Target) -> Floats:
    """(m, 3, 3) corners of all parts' triangles, target frame."""
    return np.concatenate([solid.vertices_target[solid.faces] for solid in solids(target)])


def _strewn(triangles: Floats, count: int, random: np.random.Generator) -> tuple[Floats, Floats]:
    """``count`` points, uniform over the triangles' area, with normals (Osada et al. 2002, eq. (1))."""
    across = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = np.linalg.norm(across, axis=1)
    which = random.choice(len(triangles), size=count, p=area / area.sum())
    root, share = np.sqrt(random.random(count)), random.random(count)
    weights = np.stack([1 - root, root * (1 - share), root * share], axis=1)
    return np.einsum("ni,nij->nj", weights, triangles[which]), across[which] / area[which, None]


def ray_scene(triangles: Floats) -> Any:
    """Open3D's ray caster over (m, 3, 3) corners of triangles."""
    import open3d as o3d

    scene = o3d.t.geometry.RaycastingScene()
    vertices = o3d.core.Tensor.from_numpy(triangles.reshape(-1, 3).astype(np.float32))
    scene.add_triangles(vertices, o3d.core.Tensor.from_numpy(np.arange(3 * len(triangles), dtype=np.uint32).reshape(-1, 3)))
    return scene


def _is_seen(scene: Any, points: Floats, normals: Floats) -> NDArray[np.bool_]:
    """(n,) whether open space can be reached from a point in a direction of its normal's half space."""
    import open3d as o3d

    directions = _sphere(_DIRECTIONS)
    outward = normals @ directions.T > 0
    rays = np.empty((len(points), len(directions), 6), dtype=np.float32)
    rays[..., :3], rays[..., 3:] = points[:, None], directions
    free = ~scene.test_occlusions(o3d.core.Tensor.from_numpy(rays)).numpy()
    return np.asarray((free & outward).any(axis=1))


def _sphere(count: int) -> Floats:
    """(count, 3) unit vectors, evenly spread: the spherical Fibonacci lattice (Hannay & Nye 2004)."""
    place = np.arange(count) + 0.5
    azimuth, height = place * np.pi * (3 - np.sqrt(5)), 1 - 2 * place / count
    around = np.sqrt(1 - height**2)
    return np.stack([around * np.cos(azimuth), around * np.sin(azimuth), height], axis=1)
