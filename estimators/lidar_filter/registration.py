"""Iterative closest points between a scan and the part of a surface that it can see, through small_gicp and Open3D.

Besl & McKay 1992 (point to point), Chen & Medioni 1992 (point to plane), Segal et al. 2009 (gicp). Both libraries run on one
thread here: only then are Open3D's sums the same bits in every run.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import RigidTransform

from estimators.lidar_filter.clouds import Surface, nearest_in
from estimators.lidar_filter.parameters import RegistrationParameters
from estimators.lidar_filter.registration_libraries import plane_to_beam, point_to_plane, point_to_point
from estimators.lidar_filter.registration_noise import Noise, pose_covariance
from scenes.arrays import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Registration:
    """Where a scan lies on a surface.

    ``rmse_m``: of the distances between corresponding points. ``overlap``: share of the returns that have one. ``iterations``: NaN
    where the library does not tell. ``covariance`` (6, 6): of the rotation vector in target axes (right error) and of the target's
    origin in LIDAR axes.
    """

    lidar_from_target: RigidTransform
    rmse_m: float
    overlap: float
    iterations: float
    converged: bool
    points: int
    covariance: Floats


def register(
    points_lidar: Floats, surface_target: Surface, start: RigidTransform, noise: Noise, parameters: RegistrationParameters
) -> Registration | str:
    """Lays the points (n, 3) over the surface, from ``start`` (lidar_from_target) on; a sentence where there is nothing to lay.

    The surface is first brought to where ``start`` has it, about the points' centroid: so the arithmetic is the same whatever the
    target's frame is called.
    """
    least = parameters.least_points
    if min(len(points_lidar), len(surface_target)) < least:
        return f"{len(points_lidar)} returns on {len(surface_target)} points of the surface; it takes {least} of both"
    centre = points_lidar.mean(axis=0)
    lidar_from_centred = RigidTransform.from_translation(centre)
    surface = surface_target.moved(lidar_from_centred.inv() * start)
    centred = points_lidar - centre
    surface_from_points, iterations, converged = _aligned(centred, centre, surface, noise, parameters)
    distance_m, nearest = nearest_in(cKDTree(surface.points), surface_from_points.apply(centred))
    held = distance_m < reach_m(noise, parameters)
    if held.sum() < least:
        return f"{held.sum()} of {len(points_lidar)} returns lie near the surface; it takes {least}"
    pose = lidar_from_centred * surface_from_points.inv() * lidar_from_centred.inv() * start
    pairs = points_lidar[held], surface_target.at(nearest[held])
    covariance = pose_covariance(pose, *pairs, noise, parameters.slack_m, parameters.covariance_scale)
    rmse_m = float(np.sqrt(np.mean(distance_m[held] ** 2)))
    return Registration(pose, rmse_m, float(held.mean()), iterations, converged, len(points_lidar), covariance)


def reach_m(noise: Noise, parameters: RegistrationParameters) -> float:
    """Distance beyond which two points do not correspond."""
    return max(parameters.reach_m, parameters.reach_sigmas * noise.range_m)


def _aligned(
    points: Floats, centre_lidar: Floats, surface: Surface, noise: Noise, parameters: RegistrationParameters
) -> tuple[RigidTransform, float, bool]:
    """surface_from_points, the number of iterations, and whether it came to rest."""
    reach, most = reach_m(noise, parameters), parameters.most_iterations
    match parameters.kind:
        case "point-to-point":
            return point_to_point(points, surface, reach, most)
        case "gicp":
            return plane_to_beam(points, centre_lidar, surface, reach, most, noise, parameters.robust_sigmas)
        case "point-to-plane":
            return point_to_plane(points, surface, reach, most, None)
        case "robust-plane":
            robust_m = max(parameters.robust_m, parameters.robust_sigmas * noise.range_m)
            return point_to_plane(points, surface, reach, most, robust_m)
