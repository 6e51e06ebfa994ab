"""The rectangle that fits four noisy vertices best: orthogonality built in (maximum likelihood), size still unknown.

Eight image coordinates against seven unknowns: the ray of P1 (2), L and W over P1's depth (2), the rotation (3); six
unknowns where the aspect L/W is known. Levenberg-Marquardt over a whole batch (Nocedal & Wright 2006, ch. 10). The same
Jacobian gives the Cramér-Rao bound.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from estimators.mono_rectangle.closed_form import homogeneous, raw_rotation, sides
from estimators.mono_rectangle.projection import project_to_so3
from scenes.arrays import Floats

_ALONG = np.array([0.0, 1.0, 0.0, 1.0])  # how many L e1 lie between P1 and P1..P4
_ACROSS = np.array([0.0, 0.0, 1.0, 1.0])


@dataclass(frozen=True, slots=True, eq=False)
class RectanglePose:
    """A rectangle up to scale: ``rotation`` (..., 3, 3) camera from feature, ``first`` (..., 2) normalised image point of
    P1, ``log_length`` and ``log_width`` (...,) of L and W over P1's depth."""

    rotation: Floats
    first: Floats
    log_length: Floats
    log_width: Floats

    def points_cam(self) -> Floats:
        """P1..P4 over P1's depth, (..., 4, 3), camera axes."""
        along = (np.exp(self.log_length)[..., None] * self.rotation[..., 1])[..., None, :] * _ALONG[:, None]
        across = (np.exp(self.log_width)[..., None] * self.rotation[..., 2])[..., None, :] * _ACROSS[:, None]
        return np.asarray(homogeneous(self.first)[..., None, :] + along + across)

    def vertices(self) -> Floats:
        """Normalised image points of P1..P4, (..., 4, 2)."""
        points = self.points_cam()
        return np.asarray(points[..., :2] / points[..., 2:])

    def moved(self, step: Floats) -> "RectanglePose":
        """The rectangle after a step (..., 7) = (x, y, log L, log W, rotation vector in camera axes)."""
        turn = Rotation.from_rotvec(step[..., 4:].reshape(-1, 3)).as_matrix().reshape(*step.shape[:-1], 3, 3)
        return RectanglePose(
            turn @ self.rotation, self.first + step[..., :2], self.log_length + step[..., 2], self.log_width + step[..., 3]
        )


def closed_form_pose(vertices: ArrayLike) -> RectanglePose:
    """The closed form with SVD projection as a ``RectanglePose``: where the iteration starts."""
    q2, q3 = sides(vertices)
    return RectanglePose(
        rotation=project_to_so3(raw_rotation(vertices)),
        first=np.array(np.asarray(vertices, dtype=np.float64)[..., 0, :]),
        log_length=np.log(np.linalg.norm(q2, axis=-1)),
        log_width=np.log(np.linalg.norm(q3, axis=-1)),
    )


def with_aspect(pose: RectanglePose, aspect: float) -> RectanglePose:
    """The pose with L/W set to ``aspect`` and its area kept."""
    log_area = pose.log_length + pose.log_width
    return replace(pose, log_length=(log_area + np.log(aspect)) / 2, log_width=(log_area - np.log(aspect)) / 2)


def fit_rectangle(
    vertices: ArrayLike, start: RectanglePose | None = None, aspect: float | None = None, steps: int = 25
) -> RectanglePose:
    """The rectangle nearest to ``vertices`` (..., 4, 2) in the least-squares sense, begun at ``start`` or the closed form.

    With ``aspect`` = L/W the size ratio is held, and the answer has a bas-relief twin of opposite tilt (Schweighofer &
    Pinz 2006): the start decides which.
    """
    measured = np.asarray(vertices, dtype=np.float64)
    batch = measured.reshape(-1, 4, 2)
    begin = start if start is not None else closed_form_pose(measured)
    pose = _reshaped(begin if aspect is None else with_aspect(begin, aspect), (len(batch),))
    damping = np.full(len(batch), 1e-4)
    cost = _cost(pose, batch)
    for _ in range(steps):
        trial = pose.moved(_damped_step(pose, batch, damping, aspect is not None))
        trial_cost = _cost(trial, batch)
        better = trial_cost < cost
        pose, cost = _chosen(better, trial, pose), np.where(better, trial_cost, cost)
        damping = np.where(better, damping / 10, damping * 10)
    return _reshaped(pose, measured.shape[:-2])


def vertex_residual(pose: RectanglePose, vertices: ArrayLike) -> Floats:
    """Root mean square distance, (...,), of the pose's vertices from ``vertices``, normalised units."""
    gap = pose.vertices() - np.asarray(vertices, dtype=np.float64)
    return np.asarray(np.sqrt(np.mean(np.sum(gap**2, axis=-1), axis=-1)))


def vertex_jacobian(pose: RectanglePose) -> Floats:
    """d(x1, y1, …, x4, y4) / d(x, y, log L, log W, rotation vector), (..., 8, 7)."""
    points = pose.points_cam()
    shape = points.shape[:-1]
    along = (points[..., 1, :] - points[..., 0, :])[..., None, :] * _ALONG[:, None]
    across = (points[..., 2, :] - points[..., 0, :])[..., None, :] * _ACROSS[:, None]
    d_points = np.zeros((*shape, 3, 7))
    d_points[..., 0, 0] = d_points[..., 1, 1] = 1.0
    d_points[..., :, 2], d_points[..., :, 3] = along, across
    for axis, unit_vector in enumerate(np.eye(3)):
        d_points[..., :, 4 + axis] = np.cross(unit_vector, along + across)
    depth = points[..., 2, None, None]
    d_image = (d_points[..., :2, :] - (points[..., :2] / points[..., 2:])[..., None] * d_points[..., 2:, :]) / depth
    return np.asarray(d_image.reshape(*shape[:-1], 8, 7))


def pose_sensitivity(pose: RectanglePose, *, known_aspect: bool) -> Floats:
    """The Jacobian in the unknowns that are free: (..., 8, 7), or (..., 8, 6) with L/W held; rotation vector last."""
    jacobian = vertex_jacobian(pose)
    return _aspect_held(jacobian) if known_aspect else jacobian


def rotation_covariance_bound(pose: RectanglePose, sigma: float, *, known_aspect: bool = False) -> Floats:
    """Cramér-Rao bound of the rotation vector in camera axes, (..., 3, 3) rad², for iid vertex noise ``sigma`` (normalised)."""
    jacobian = pose_sensitivity(pose, known_aspect=known_aspect)
    information = np.swapaxes(jacobian, -1, -2) @ jacobian / sigma**2
    return np.asarray(np.linalg.inv(information)[..., -3:, -3:])


def _aspect_held(jacobian: Floats) -> Floats:
    merged = jacobian[..., 2:3] + jacobian[..., 3:4]
    return np.concatenate([jacobian[..., :2], merged, jacobian[..., 4:]], axis=-1)


def _damped_step(pose: RectanglePose, measured: Floats, damping: Floats, hold_aspect: bool) -> Floats:
    jacobian = pose_sensitivity(pose, known_aspect=hold_aspect)
    residual = (measured - pose.vertices()).reshape(-1, 8)
    normal = np.swapaxes(jacobian, -1, -2) @ jacobian
    diagonal = np.einsum("...ii->...i", normal)
    damped = normal + damping[:, None, None] * diagonal[..., None] * np.eye(normal.shape[-1])
    gradient = np.einsum("nij,ni->nj", jacobian, residual)
    step = np.linalg.solve(damped, gradient[..., None])[..., 0]
    return np.insert(step, 3, step[:, 2], axis=1) if hold_aspect else step


def _cost(pose: RectanglePose, measured: Floats) -> Floats:
    return np.asarray(np.sum((pose.vertices() - measured) ** 2, axis=(-2, -1)))


def _chosen(better: np.ndarray, new: RectanglePose, old: RectanglePose) -> RectanglePose:
    return RectanglePose(
        np.where(better[:, None, None], new.rotation, old.rotation),
        np.where(better[:, None], new.first, old.first),
        np.where(better, new.log_length, old.log_length),
        np.where(better, new.log_width, old.log_width),
    )


def _reshaped(pose: RectanglePose, lead: tuple[int, ...]) -> RectanglePose:
    return RectanglePose(
        np.reshape(pose.rotation, (*lead, 3, 3)),
        np.reshape(pose.first, (*lead, 2)),
        np.reshape(pose.log_length, lead),
        np.reshape(pose.log_width, lead),
    )
