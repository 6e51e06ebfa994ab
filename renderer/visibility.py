"""How much of the target the picture holds: 1 unless it reaches over the border."""

from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from renderer.window import outline_px
from scenes.arrays import Floats
from scenes.intrinsics import Intrinsics

_RAYS_PER_SIDE = 192  # the fraction is good to about 1 %


def visible_fraction(scene: Any, cam_from_target: RigidTransform, points_target: Floats, intrinsics: Intrinsics) -> float:
    """Share of the target's silhouette that lies inside the picture, as seen by a camera of the same lens without borders.

    ``points_target`` (n, 3) enclose the target. NaN where part of them lies beside or behind the camera's plane.
    """
    points_cam = cam_from_target.apply(points_target)
    if np.any(points_cam[:, 2] <= 0):
        return float("nan")
    ideal = points_cam[:, :2] / points_cam[:, 2:]
    low, high = ideal.min(axis=0), ideal.max(axis=0)
    if _inside(outline_px(intrinsics, ideal), intrinsics).all():
        return 1.0
    steps = (np.arange(_RAYS_PER_SIDE) + 0.5) / _RAYS_PER_SIDE
    grid = low + np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2) * (high - low)
    hit = _hits(scene, cam_from_target.inv(), grid)
    inside = _inside(intrinsics.pixels_from_normalised(grid), intrinsics)
    return float(np.count_nonzero(hit & inside) / max(int(np.count_nonzero(hit)), 1))


def _inside(pixels: Floats, intrinsics: Intrinsics) -> Any:
    size = np.array([intrinsics.width_px, intrinsics.height_px])
    return np.all((pixels >= -0.5) & (pixels < size - 0.5), axis=-1)


def _hits(scene: Any, target_from_cam: RigidTransform, ideal: Floats) -> Any:
    """Which of the rays through ideal normalised points (n, 2) meet the target."""
    import drjit as dr
    import mitsuba as mi

    directions = target_from_cam.rotation.apply(np.column_stack([ideal, np.ones(len(ideal))]))
    origin = mi.Point3f(target_from_cam.translation.tolist())
    if dr.is_jit_v(mi.Float):
        rays = mi.Ray3f(origin, dr.normalize(mi.Vector3f(directions.T.astype(np.float32))))
        return np.array(scene.ray_test(rays))
    return np.array([scene.ray_test(mi.Ray3f(origin, dr.normalize(mi.Vector3f(d.tolist())))) for d in directions])
