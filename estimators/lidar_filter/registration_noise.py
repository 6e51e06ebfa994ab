"""What noise a return has, and what a registration's error follows from it."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from estimators.lidar_filter.clouds import Surface
from scenes.arrays import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Noise:
    """1σ of a return: ``range_m`` along its beam, ``across_rad`` times the range to its sides."""

    range_m: float
    across_rad: float

    def covariances(self, points_lidar: Floats) -> Floats:
        """(n, 3, 3) m² of points in LIDAR axes."""
        distance = np.linalg.norm(points_lidar, axis=1)[:, None, None]
        beam = points_lidar / distance[:, :, 0]
        along = beam[:, :, None] * beam[:, None, :]
        across = (self.across_rad * distance) ** 2
        return np.asarray(self.range_m**2 * along + across * (np.eye(3) - along))


def pose_covariance(
    lidar_from_target: RigidTransform, points_lidar: Floats, there_target: Surface, noise: Noise, slack_m: float, scale: float
) -> Floats:
    """Covariance (6, 6) of [rotation vector in target axes, target's origin in LIDAR axes] from corresponding points (n, 3).

    A right error θ and a shift δ move the point p = Rᵀ(p_lidar − l) by p × θ − Rᵀδ (first order). Along the surface's normal that
    is measured with the beam's noise; within the surface only to ``slack_m``, because the nearest point slides along.
    Σ = scale · max(1, χ²/n) · H⁻¹ with H = Σ Jᵀ W J: the pairs are held, and ``scale`` is for that they are not.
    """
    rotation = lidar_from_target.rotation.as_matrix()
    points = lidar_from_target.inv().apply(points_lidar)
    normals = there_target.normals
    seen = np.einsum("nij,nj->ni", noise.covariances(points_lidar), normals @ rotation.T)
    variance = np.sum(seen * (normals @ rotation.T), axis=1)
    jacobian = np.hstack([np.cross(normals, points), -normals @ rotation.T])
    normal_part = np.einsum("n,ni,nj->ij", 1 / variance, jacobian, jacobian)
    residual = np.sum((points - there_target.points) * normals, axis=1)
    excess = max(1.0, float(np.median(residual**2 / variance)) / 0.455)  # the median of χ² with one degree of freedom
    tangent_part = _all_directions(points, rotation) - np.einsum("ni,nj->ij", jacobian, jacobian)
    return np.asarray(scale * excess * np.linalg.inv(normal_part + tangent_part / slack_m**2))


def _all_directions(points: Floats, rotation: Floats) -> Floats:
    """Σ JᵀJ (6, 6) of J = [[p]×, −Rᵀ]."""
    square = np.einsum("ni,ni->", points, points) * np.eye(3) - points.T @ points
    x, y, z = points.sum(axis=0)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    mixed = cross @ rotation.T
    return np.block([[square, mixed], [mixed.T, len(points) * np.eye(3)]])
