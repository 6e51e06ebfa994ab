"""How good is this attitude? The uncertainty of four fitted lines carried through the vertices and the solution."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from estimators.mono_rectangle.closed_form import aspect_ratio, raw_rotation
from estimators.mono_rectangle.projection import project_to_so3
from estimators.mono_rectangle.quadrilateral import EDGES, EDGES_AT_VERTEX
from estimators.mono_rectangle.rectangle_fit import RectanglePose, pose_sensitivity
from scenes.arrays import Floats

_STEP = 1e-7


def vertex_covariance_px(normals: Floats, covariances: Floats) -> Floats:
    """Covariance (8, 8) px² of x1, y1, …, x4, y4 where four lines meet.

    ``normals`` (4, 2) of the lines; ``covariances`` (4, 2, 2) px² of the distances of each line's two ends along its
    normal. A vertex moves by N⁻¹ (distances), N holding the normals of its two lines.
    """
    lines = np.zeros((8, 8))
    vertices = np.zeros((8, 8))
    for edge in range(4):
        lines[2 * edge : 2 * edge + 2, 2 * edge : 2 * edge + 2] = covariances[edge]
    for vertex, pair in enumerate(EDGES_AT_VERTEX):
        inverse = np.linalg.inv(normals[list(pair)])
        for column, edge in enumerate(pair):
            vertices[2 * vertex : 2 * vertex + 2, 2 * edge + EDGES[edge].index(vertex)] = inverse[:, column]
    return np.asarray(vertices @ lines @ vertices.T)


@dataclass(frozen=True, slots=True, eq=False)
class Sensitivity:
    """Derivatives of the closed form by x1, y1, …, x4, y4: of the rotation vector in camera axes (3, 8), of r2·r3 (8,) and
    of log(L/W) (8,)."""

    rotation: Floats
    skew: Floats
    log_aspect: Floats


def closed_form_sensitivity(vertices: Floats) -> Sensitivity:
    """By central differences about vertices (4, 2), all sixteen at once."""
    shifted = vertices + _STEP * np.concatenate([np.eye(8), -np.eye(8)]).reshape(16, 4, 2)
    raw = raw_rotation(shifted)
    rotations = Rotation.from_matrix(project_to_so3(raw))
    turns = (rotations[:8] * rotations[8:].inv()).as_rotvec().T
    scalars = np.stack([np.sum(raw[..., 1] * raw[..., 2], axis=-1), np.log(aspect_ratio(shifted))])
    slopes = (scalars[:, :8] - scalars[:, 8:]) / (2 * _STEP)
    return Sensitivity(turns / (2 * _STEP), slopes[0], slopes[1])


def fit_sensitivity(pose: RectanglePose, *, known_aspect: bool) -> Floats:
    """d(rotation vector in camera axes)/d(x1 … y4), (3, 8), of the least-squares rectangle: rows of (JᵀJ)⁻¹Jᵀ."""
    return np.asarray(np.linalg.pinv(pose_sensitivity(pose, known_aspect=known_aspect))[-3:])
