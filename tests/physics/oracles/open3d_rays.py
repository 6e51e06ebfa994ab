"""Rays traced by Open3D (Embree), independent of Mitsuba: visibility, shadows, what another camera sees."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from scenes.arrays import Bools, Floats
from scenes.exr import Window
from scenes.intrinsics import Intrinsics
from scenes.solids import solids
from scenes.target import Target

_AWAY_M = 1e-4  # from the surface, where a second ray starts


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What pixel centres see, (h, w): whether they hit, which part (1-based), the point and outward normal, target frame."""

    hit: Bools
    part_id: NDArray[np.uint32]
    points_target: Floats
    normals_target: Floats
    range_m: Floats


class Open3dScene:
    """A target as Open3D meshes."""

    def __init__(self, target: Target) -> None:
        """One geometry a part, in order."""
        import open3d as o3d

        self._o3d = o3d
        self._scene = o3d.t.geometry.RaycastingScene()
        for solid in solids(target):
            vertices = o3d.core.Tensor(solid.vertices_target.astype(np.float32))
            self._scene.add_triangles(vertices, o3d.core.Tensor(solid.faces.astype(np.uint32)))

    def seen(self, lens: Intrinsics, cam_from_target: RigidTransform, window: Window) -> Seen:
        """The pixels of ``window`` at their centres."""
        rows, columns = np.mgrid[window.slices]
        pixels = np.stack([columns, rows], axis=-1).astype(np.float64)
        target_from_cam = cam_from_target.inv()
        flat = target_from_cam.rotation.apply(lens.rays(pixels).reshape(-1, 3))
        directions = flat.reshape(*rows.shape, 3)
        origin = target_from_cam.translation
        found = self._cast(np.broadcast_to(origin, directions.shape), directions)
        hit = np.isfinite(found["t_hit"].numpy())
        range_m = np.where(hit, found["t_hit"].numpy(), 0.0).astype(np.float64)
        part_id = np.where(hit, found["geometry_ids"].numpy() + 1, 0).astype(np.uint32)
        normals = found["primitive_normals"].numpy().astype(np.float64)
        return Seen(hit, part_id, origin + directions * range_m[..., None], normals, range_m)

    def reaches(self, seen: Seen, place_target: Floats) -> Bools:
        """Whether nothing stands between the seen points and a place (3,), for points that are turned to it."""
        start = seen.points_target + _AWAY_M * seen.normals_target
        towards = place_target - start
        distance = np.linalg.norm(towards, axis=-1, keepdims=True)
        found = self._cast(start, towards / distance)["t_hit"].numpy()
        return np.asarray(found > distance[..., 0] - 2 * _AWAY_M)

    def facing(self, seen: Seen, place_target: Floats) -> Bools:
        """Whether the seen points' outsides are turned to a place (3,)."""
        return np.asarray(np.sum(seen.normals_target * (place_target - seen.points_target), axis=-1) > 0)

    def _cast(self, origins: Floats, directions: Floats) -> dict[str, Any]:
        rays = np.concatenate([origins, directions], axis=-1).astype(np.float32)
        return dict(self._scene.cast_rays(self._o3d.core.Tensor(rays)))
