"""The two libraries that register: what they are handed, and what they hand back."""

from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from estimators.lidar_filter.clouds import Surface
from estimators.lidar_filter.registration_noise import Noise
from scenes.arrays import Floats

_RELATIVE = 1e-6  # change of overlap and of rmse at which Open3D rests
_FLAT_M = 0.02  # 1σ of a surface's point off its plane
_WIDE_M = 0.3  # and within it: the wider, the freer a scan slides along
_FREE_M, _EDGE_M = 1.0, 0.1  # the same where edges are known: elsewhere, and there


def point_to_point(points: Floats, surface: Surface, reach_m: float, most_iterations: int) -> tuple[RigidTransform, float, bool]:
    """surface_from_points by small_gicp, from the identity on; how many iterations it took, and whether it came to rest."""
    import small_gicp

    found = small_gicp.align(
        small_gicp.PointCloud(surface.points),
        small_gicp.PointCloud(points),
        registration_type="ICP",
        max_correspondence_distance=reach_m,
        max_iterations=most_iterations,
    )
    return RigidTransform.from_matrix(found.T_target_source), float(found.iterations), bool(found.converged)


def point_to_plane(
    points: Floats, surface: Surface, reach_m: float, most_iterations: int, robust_m: float | None
) -> tuple[RigidTransform, float, bool]:
    """The same by Open3D against the surface's normals, with Tukey's biweight where ``robust_m`` is given."""
    import open3d as o3d

    kinds = o3d.pipelines.registration
    loss = kinds.L2Loss() if robust_m is None else kinds.TukeyLoss(robust_m)
    estimation = kinds.TransformationEstimationPointToPlane(loss)
    source, target = _cloud(points), _cloud(surface.points, surface.normals)
    return _landed(kinds.registration_icp, source, target, reach_m, estimation, most_iterations)


def plane_to_beam(
    points: Floats, centre_lidar: Floats, surface: Surface, reach_m: float, most_iterations: int, noise: Noise, robust: float
) -> tuple[RigidTransform, float, bool]:
    """Generalised ICP by Open3D: each point has its beam's noise, each point of the surface is a small plane.

    ``robust``: Mahalanobis length beyond which a pair counts nothing.
    """
    import open3d as o3d

    kinds = o3d.pipelines.registration
    across = surface.normals[:, :, None] * surface.normals[:, None, :]
    wide = np.array([_WIDE_M]) if surface.is_edge is None else np.where(surface.is_edge, _EDGE_M, _FREE_M)
    planes = wide[:, None, None] ** 2 * (np.eye(3) - across) + _FLAT_M**2 * across
    source = _cloud(points, covariances=noise.covariances(points + centre_lidar))
    target = _cloud(surface.points, surface.normals, planes)
    estimation = kinds.TransformationEstimationForGeneralizedICP(1e-3, kinds.TukeyLoss(robust))
    return _landed(kinds.registration_generalized_icp, source, target, reach_m, estimation, most_iterations)


def _landed(
    align: Any, source: Any, target: Any, reach_m: float, estimation: Any, most_iterations: int
) -> tuple[RigidTransform, float, bool]:
    """Runs Open3D on one thread; it does not tell how many iterations it took."""
    import open3d as o3d

    criteria = o3d.pipelines.registration.ICPConvergenceCriteria(_RELATIVE, _RELATIVE, most_iterations)
    threads = o3d.utility.get_max_threads()
    o3d.utility.set_max_threads(1)  # several threads sum in another order each time
    try:
        found = align(source, target, reach_m, np.eye(4), estimation, criteria)
    finally:
        o3d.utility.set_max_threads(threads)
    if not np.isfinite(found.transformation).all():
        return RigidTransform.identity(), np.nan, False
    return RigidTransform.from_matrix(found.transformation), np.nan, found.fitness > 0


def _cloud(points: Floats, normals: Floats | None = None, covariances: Floats | None = None) -> Any:
    import open3d as o3d

    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    if normals is not None:
        cloud.normals = o3d.utility.Vector3dVector(normals)
    if covariances is not None:
        cloud.covariances = o3d.utility.Matrix3dVector(covariances)
    return cloud
