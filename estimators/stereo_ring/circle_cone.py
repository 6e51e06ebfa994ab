"""A circle in space and the cone through its picture: Shu et al. 2020, eq. (11), mended.

Q = Kᵀ C K is the cone of the rays that meet the conic C. With eigenvalues λ1 ≥ λ2 > 0 > λ3 of Q (scaled to that signature)
the planes that cut it in circles have the normals

    ζ = √((λ1 − λ2)/(λ1 − λ3)) ξ1 ± √((λ2 − λ3)/(λ1 − λ3)) ξ3.

Eq. (11) prints the first root as √((λ1 − λ2)/(λ1 − λ2)) = 1, calls the eigenvalues eigenvectors, and gives no signs: both
normals here point to the camera.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from estimators.stereo_ring.rig import homogeneous
from scenes.arrays import Bools, Floats


@dataclass(frozen=True, slots=True, eq=False)
class Circle:
    """``centre_m`` (3,) and unit ``normal`` (3,) in the left camera's axes, the normal towards the camera; ``radius_m``."""

    centre_m: Floats
    normal: Floats
    radius_m: float


def cones_of_conics(conics: ArrayLike, K: Floats) -> Floats:
    """Q = Kᵀ C K (..., 3, 3), symmetric, of unit norm and signature (+, +, −); NaN where C is no cone of an ellipse."""
    C = np.asarray(conics, dtype=np.float64)
    Q = K.T @ (C / np.linalg.norm(C, axis=(-2, -1), keepdims=True)) @ K
    Q = (Q + np.swapaxes(Q, -1, -2)) / 2
    Q = Q / np.linalg.norm(Q, axis=(-2, -1), keepdims=True)
    eigenvalues = np.linalg.eigvalsh(np.nan_to_num(Q))
    sign = np.where(eigenvalues[..., 1] > 0, 1.0, -1.0)  # two of the three have the middle one's sign
    real = (eigenvalues[..., 0] < 0) & (eigenvalues[..., 2] > 0) & _known(Q)
    return np.asarray(np.where(real, sign, np.nan)[..., None, None] * Q)


def normals_of_cones(cones: ArrayLike) -> Floats:
    """The two unit normals (..., 2, 3) of circular sections, eq. (11) mended, turned to the camera (n · X < 0)."""
    Q = np.asarray(cones, dtype=np.float64)
    known = _known(Q)
    values, vectors = np.linalg.eigh(np.where(known[..., None, None], Q, np.diag([1.0, 1.0, -1.0])))
    axis = vectors[..., :, 0] * np.where(vectors[..., 2:, 0] < 0, -1.0, 1.0)  # of λ3: the ray in the middle of the cone
    across = vectors[..., :, 2]
    l3, l2, l1 = np.moveaxis(values, -1, 0)
    sine = np.sqrt(np.maximum(l1 - l2, 0) / (l1 - l3))[..., None]
    cosine = np.sqrt((l2 - l3) / (l1 - l3))[..., None]
    both = np.stack([sine * across - cosine * axis, -sine * across - cosine * axis], axis=-2)
    return np.where(known[..., None, None], both, np.nan)


def circles_of_radius(cones: ArrayLike, normals: ArrayLike, radius_m: ArrayLike) -> Floats:
    """Centres (..., 3) of the circles of ``radius_m`` (...,) that cones (..., 3, 3) cut from planes with ``normals`` (..., 3)."""
    centre, scale = _unit_section(cones, normals)
    return np.asarray(centre * (np.asarray(radius_m) / scale)[..., None])


def radii_at(cones: ArrayLike, normals: ArrayLike, centres_m: ArrayLike) -> Floats:
    """Radii (...,) of the circles about ``centres_m`` (..., 3): r = ρ |n · X0|, ρ that of the section n · x = 1."""
    _, scale = _unit_section(cones, normals)
    return np.asarray(scale * np.abs(np.sum(np.asarray(normals) * np.asarray(centres_m), axis=-1)))


def poles_of_planes(conics: ArrayLike, K: Floats, normals: ArrayLike) -> Floats:
    """Pixels (..., 2) where the centres of the circles are seen: p ~ C⁻¹ K⁻ᵀ n, the pole of the plane's vanishing line."""
    lines = np.asarray(normals, dtype=np.float64) @ np.linalg.inv(K)
    C = np.asarray(conics, dtype=np.float64)
    C = C / np.linalg.norm(C, axis=(-2, -1), keepdims=True)
    # the adjugate is the inverse up to a scale, and exists for every conic
    adjugate = np.stack([np.cross(C[..., 1], C[..., 2]), np.cross(C[..., 2], C[..., 0]), np.cross(C[..., 0], C[..., 1])], axis=-2)
    poles = np.einsum("...ij,...j->...i", adjugate, lines)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(poles[..., :2] / poles[..., 2:])


def conics_of_circles(centres_m: ArrayLike, normals: ArrayLike, radius_m: ArrayLike, projection: Floats) -> Floats:
    """C (..., 3, 3) of circles seen through M (3, 4): the dual conic is M Q* Mᵀ (Hartley & Zisserman 2004, sec. 8.3).

    Q* = [r² (I − n nᵀ), 0; 0, 0] − X0 X0ᵀ is the dual quadric of a circle, X0 homogeneous.
    """
    n, r = np.asarray(normals, dtype=np.float64), np.asarray(radius_m, dtype=np.float64)
    plane = np.eye(3) - n[..., :, None] * n[..., None, :]
    edge = r[..., None, None] ** 2 * (projection[:, :3] @ plane @ projection[:, :3].T)
    centre = homogeneous(centres_m) @ projection.T
    return np.asarray(np.linalg.inv(edge - centre[..., :, None] * centre[..., None, :]))


def _unit_section(cones: ArrayLike, normals: ArrayLike) -> tuple[Floats, Floats]:
    """Centre (..., 3) and radius (...,) of the section of the plane n · x = −1: the one in front of a camera that n looks at."""
    Q, n = np.asarray(cones, dtype=np.float64), np.asarray(normals, dtype=np.float64)
    known = _known(Q)
    Q = np.where(known[..., None, None], Q, np.diag([1.0, 1.0, -1.0]))
    polar = np.linalg.solve(Q, n[..., None])[..., 0]
    centre = -polar / np.sum(n * polar, axis=-1, keepdims=True)
    middle = np.linalg.eigvalsh(Q)[..., 1]
    square = -np.einsum("...i,...ij,...j->...", centre, Q, centre) / middle
    radius = np.sqrt(np.where(square > 0, square, np.nan))
    return np.where(known[..., None], centre, np.nan), np.where(known, radius, np.nan)


def _known(matrices: Floats) -> Bools:
    return np.asarray(np.isfinite(matrices).all(axis=(-2, -1)))
