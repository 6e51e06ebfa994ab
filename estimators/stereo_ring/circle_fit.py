"""The circle in space that fits the edge points of both views best: six unknowns, one least-squares problem.

Unknowns: centre X0 (3), normal n (2, in its tangent plane), radius r. The residual is the Sampson distance of an edge point,
in pixels, from the conic of the circle in its view, so there is no hole where one camera sees the circle face-on, as there is
in the mean of two normals. Loss: soft-L1; Levenberg-Marquardt with the analytic Jacobian, both views as their dual conics
C* = r² A (I − n nᵀ) Aᵀ − b bᵀ with A = K R, b = K (R X0 + T), dC = −C dC* C.

The two edges of a ring's face have the centre and the normal in common: ``fit_circles`` takes them together.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimators.stereo_ring.circle_cone import Circle
from estimators.stereo_ring.rig import Rig
from scenes.arrays import Floats

_MOST_STEPS = 25
_SMALLEST_STEP = 1e-10  # relative decrease of the cost, and step over distance
_SYMMETRIC = np.array([0, 4, 8, 1, 2, 5])  # a conic as (uu, vv, ww, uv, uw, vw)


@dataclass(frozen=True, slots=True, eq=False)
class CircleFit:
    """The best circle and how good it is.

    ``left_px`` (n,) and ``right_px`` (m,): signed residuals. ``covariance`` (6, 6) of (X0 in metres, n along the two rows of
    ``tangent`` (2, 3), r in metres), from JᵀJ and the residuals' own robust scale ``sigma_px``.
    """

    circle: Circle
    left_px: Floats
    right_px: Floats
    covariance: Floats
    tangent: Floats
    sigma_px: float


@dataclass(frozen=True, slots=True, eq=False)
class CirclesFit:
    """The best concentric circles in one plane: the outer ``circle``, all ``radii_m`` (k,), signed residuals (left (n,), right
    (m,)) of each; ``covariance`` (5 + k, 5 + k), ``tangent`` and ``sigma_px`` as in ``CircleFit``."""

    circle: Circle
    radii_m: Floats
    residuals_px: tuple[tuple[Floats, Floats], ...]
    covariance: Floats
    tangent: Floats
    sigma_px: float


@dataclass(frozen=True, slots=True, eq=False)
class _View:
    """One camera with the points of one circle: which of them, ``A`` (3, 3), ``b`` (3,) as above in focal lengths, monomials
    (n, 6), coordinates (n, 3)."""

    circle: int
    A: Floats
    shift: Floats
    focal_px: float
    points: Floats
    monomials: Floats


def fit_circle(
    rig: Rig, left_px: Floats, right_px: Floats, start: Circle, loss_px: float | None = 0.5, smallest_step: float = _SMALLEST_STEP
) -> CircleFit | None:
    """The circle nearest to edge points (n, 2) and (m, 2), begun at ``start``; None if it does not converge to a circle in view.

    ``loss_px``: distance beyond which a residual counts about linearly (soft-L1); None for plain least squares.
    ``smallest_step``: relative decrease of the cost at which it rests.
    """
    fit = fit_circles(rig, [(left_px, right_px)], start, [start.radius_m], loss_px, smallest_step)
    if fit is None:
        return None
    left, right = fit.residuals_px[0]
    return CircleFit(fit.circle, left, right, fit.covariance, fit.tangent, fit.sigma_px)


def fit_circles(
    rig: Rig,
    edges: Sequence[tuple[Floats, Floats]],
    start: Circle,
    radii_m: Sequence[float],
    loss_px: float | None = 0.5,
    smallest_step: float = _SMALLEST_STEP,
) -> CirclesFit | None:
    """As ``fit_circle`` for concentric circles in one plane: ``edges`` (left (n, 2), right (m, 2)) and first ``radii_m`` of each.

    The first is the one that is answered as ``circle``; the radius in ``start`` is not used.
    """
    if sum(len(points) for pair in edges for points in pair) < 6 + len(edges):
        return None
    views = [
        _view(number, K, R, T, points)
        for number, pair in enumerate(edges)
        for points, (K, R, T) in zip(pair, ((rig.K_left, np.eye(3), np.zeros(3)), (rig.K_right, rig.R, rig.T)), strict=True)
    ]
    x0, n = np.asarray(start.centre_m, dtype=np.float64), np.asarray(start.normal, dtype=np.float64)
    with np.errstate(all="ignore"):
        found = _minimised(views, (x0, n, np.asarray(radii_m, dtype=np.float64)), loss_px, smallest_step)
        if found is None:
            return None
        (x0, n, radii), residual, jacobian, tangent = found
        covariance, sigma_px = _accuracy(residual, jacobian, loss_px)
    if not ((radii > 0).all() and x0[2] > 0 and np.isfinite(covariance).all()):
        return None
    parts = np.split(residual, np.cumsum([len(view.points) for view in views])[:-1])
    circle = Circle(x0, n if n @ x0 < 0 else -n, float(radii[0]))
    return CirclesFit(circle, radii, tuple(zip(parts[::2], parts[1::2], strict=True)), covariance, tangent, sigma_px)


_State = tuple[Floats, Floats, Floats]


def _minimised(
    views: Sequence[_View], state: _State, loss_px: float | None, smallest_step: float
) -> tuple[_State, Floats, Floats, Floats] | None:
    """Levenberg-Marquardt with iterated weights (Nocedal & Wright 2006, ch. 10): state, residuals, Jacobian, tangent basis."""
    residual, jacobian, tangent = _linearised(views, state)
    cost, damping = _cost(residual, loss_px), 1e-4
    for _ in range(_MOST_STEPS):
        if not np.isfinite(cost) or not np.isfinite(jacobian).all():
            return None
        weighted = jacobian * _weights(residual, loss_px)[:, None]
        normal, gradient = weighted.T @ jacobian, weighted.T @ residual
        step = np.asarray(np.linalg.lstsq(normal + damping * np.diag(np.diag(normal)), -gradient, rcond=None)[0])
        trial = _moved(state, step, tangent)
        values = _linearised(views, trial)
        trial_cost = _cost(values[0], loss_px)
        if not trial_cost <= cost:
            damping *= 10
            if damping > 1e8:
                break
            continue
        settled = cost - trial_cost <= smallest_step * cost or np.abs(step).max() < _SMALLEST_STEP
        state, (residual, jacobian, tangent), cost, damping = trial, values, trial_cost, damping / 10
        if settled:
            break
    return state, residual, jacobian, tangent


def _view(circle: int, K: Floats, R: Floats, T: Floats, points_px: Floats) -> _View:
    """Coordinates about the principal point in units of fx: well conditioned, and distances stay pixels over fx."""
    focal_px = float(K[0, 0])
    scaled = np.array([[1.0, K[0, 1] / focal_px, 0.0], [0.0, K[1, 1] / focal_px, 0.0], [0.0, 0.0, 1.0]])
    points = np.ones((len(points_px), 3))
    points[:, :2] = (points_px - K[:2, 2]) / focal_px
    u, v, w = points.T
    return _View(circle, scaled @ R, scaled @ T, focal_px, points, np.stack([u * u, v * v, w, 2 * u * v, 2 * u, 2 * v], axis=1))


def _linearised(views: Sequence[_View], state: _State) -> tuple[Floats, Floats, Floats]:
    """Residuals (n,) px, Jacobian (n, 5 + k), and the basis (2, 3) along which the normal may move."""
    _, n, _ = state
    aside = np.cross(n, np.eye(3)[np.argmin(np.abs(n))])
    first = aside / np.linalg.norm(aside)
    tangent = np.stack([first, np.cross(n, first)])
    parts = [_sampson(view, *_conic_and_slopes(view, state, tangent)) for view in views]
    return np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts]), tangent


def _conic_and_slopes(view: _View, state: _State, tangent: Floats) -> tuple[Floats, Floats]:
    """C (3, 3), positive outside, and dC (5 + k, 3, 3) by the unknowns."""
    x0, n, radii = state
    r = float(radii[view.circle])
    A, b, An = view.A, view.A @ x0 + view.shift, view.A @ n
    plane = A @ A.T - np.outer(An, An)
    dual = r * r * plane - np.outer(b, b)
    slopes = np.zeros((5 + len(radii), 3, 3))
    slopes[:3] = -(A.T[:, :, None] * b)
    slopes[3:5] = -r * r * ((tangent @ A.T)[:, :, None] * An)
    slopes[:5] += np.swapaxes(slopes[:5], 1, 2)
    slopes[5 + view.circle] = 2 * r * plane
    size = float(b @ b)
    C = np.asarray(np.linalg.inv(dual / size), dtype=np.float64)
    dC = -C @ (slopes / size) @ C
    sign = 1.0 if C[0, 0] + C[1, 1] > 0 else -1.0
    return np.asarray(sign * C), np.asarray(sign * dC)


def _sampson(view: _View, C: Floats, dC: Floats) -> tuple[Floats, Floats]:
    """Sampson distances (n,) px and their derivatives (n, 5 + k)."""
    value = view.monomials @ C.reshape(9)[_SYMMETRIC]
    d_value = view.monomials @ dC.reshape(-1, 9)[:, _SYMMETRIC].T
    gradient = view.points @ C[:, :2]
    length = np.hypot(gradient[:, 0], gradient[:, 1])
    d_length = np.einsum("nj,inj->ni", gradient / length[:, None], view.points @ dC[:, :, :2])
    residual = value / (2 * length)
    return view.focal_px * residual, view.focal_px * (d_value / 2 - residual[:, None] * d_length) / length[:, None]


def _moved(state: _State, step: Floats, tangent: Floats) -> _State:
    n = state[1] + step[3:5] @ tangent
    return state[0] + step[:3], n / np.linalg.norm(n), state[2] + step[5:]


def _weights(residual: Floats, loss_px: float | None) -> Floats:
    return np.ones_like(residual) if loss_px is None else 1 / np.sqrt(1 + (residual / loss_px) ** 2)


def _cost(residual: Floats, loss_px: float | None) -> float:
    if loss_px is None:
        return float(residual @ residual)
    return float(np.sum(2 * loss_px**2 * (np.sqrt(1 + (residual / loss_px) ** 2) - 1)))


def _accuracy(residual: Floats, jacobian: Floats, loss_px: float | None) -> tuple[Floats, float]:
    """Covariance of an M-estimate (Huber & Ronchetti 2009, sec. 7.6), and the scale in pixels that it stands for."""
    weight = _weights(residual, loss_px)
    bend = weight if loss_px is None else weight**3  # the slope of the weighted residual
    pull = float(np.sum((weight * residual) ** 2)) / max(len(residual) - 6, 1)
    sigma_px = np.sqrt(pull) / float(np.mean(bend))
    inverse = np.asarray(np.linalg.pinv(jacobian.T @ jacobian, hermitian=True), dtype=np.float64)
    return inverse * float(sigma_px) ** 2, float(sigma_px)
