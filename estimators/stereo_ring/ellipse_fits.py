"""Step 3 of section 2.3.1: ellipses through single groups, and through all pairs of groups that can lie on one.

A fit needs only the sums of the monomials' products, 6 × 6, so a pair's is the sum of two; each is moved to its own centroid
and size first. Direct least squares with 4AC − B² = 1 (Fitzgibbon et al. 1999 in Halír & Flusser's 1998 form), in one batch.
"""

import numpy as np

from estimators.stereo_ring.arc_groups import Groups
from estimators.stereo_ring.arcs import Arcs
from estimators.stereo_ring.conics import parameters_from_conics
from estimators.stereo_ring.detector_parameters import DetectorParameters
from scenes.arrays import Bools, Floats

_FROM_CONSTRAINT = np.array([[0.0, 0.0, 0.5], [0.0, -1.0, 0.0], [0.5, 0.0, 0.0]])  # inverse of 4AC − B² as a form in (A, B, C)
_SMALLEST_SIZE_PX, _SMALLEST_SPREAD = 0.5, 1e-7


def ellipse_fits(arcs: Arcs, groups: Groups, parameters: DetectorParameters, scale: float) -> Floats:
    """Possible ellipses (n, 5), reduced pixels, of single groups and of pairs."""
    if len(groups.members) == 0:
        return np.zeros((0, 5))
    monomials, slopes = point_scatter(arcs.points, arcs.weights)
    members = groups.members.astype(np.float64)
    of_group = [np.tensordot(members, scatter, axes=1) for scatter in (monomials, slopes)]
    first, second = np.nonzero(np.triu(_compatible(arcs, groups, parameters, scale), 1))
    fitted, rms = direct_fits(*(np.concatenate([one, one[first] + one[second]]) for one in of_group))
    a, b = fitted[:, 2], fitted[:, 3]
    with np.errstate(invalid="ignore"):
        good = (rms <= parameters.fit_rms_px * scale) & (b >= parameters.min_semi_axis_px * scale)
        good &= (a <= parameters.max_semi_axis_px * scale) & (b >= parameters.min_axis_ratio * a)
    return fitted[good]


def point_scatter(points: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Sums over points (..., k, 2) of m mᵀ and of ∂ᵤm ∂ᵤmᵀ + ∂ᵥm ∂ᵥmᵀ, m = (u², uv, v², u, v, 1): two of (..., 6, 6)."""
    u, v = points[..., 0], points[..., 1]
    one, none = np.ones_like(u), np.zeros_like(u)
    m = np.stack([u * u, u * v, v * v, u, v, one], axis=-1)
    by_u = np.stack([2 * u, v, none, one, none, none], axis=-1)
    by_v = np.stack([none, u, 2 * v, none, one, none], axis=-1)
    weighted = [np.swapaxes(part * weights[..., None], -1, -2) @ part for part in (m, by_u, by_v)]
    return weighted[0], weighted[1] + weighted[2]


def direct_fits(scatter: Floats, slopes: Floats) -> tuple[Floats, Floats]:
    """Ellipses (n, 5) of scatter matrices (n, 6, 6), and the rms distance (n,) of their points in pixels; NaN: there is none."""
    with np.errstate(all="ignore"):
        back = _normalising(scatter)
        local = back @ scatter @ np.swapaxes(back, 1, 2)
        coefficients = _direct(local)
        found = np.einsum("nji,nj->ni", back, coefficients)
        square = np.einsum("ni,nij,nj->n", coefficients, local, coefficients) / np.einsum("ni,nij,nj->n", found, slopes, found)
        return parameters_from_conics(conics_of_coefficients(found)), np.sqrt(np.maximum(square, 0))


def conics_of_coefficients(coefficients: Floats) -> Floats:
    """C (..., 3, 3) of (A, B, C, D, E, F) (..., 6), eq. (3)."""
    A, B, C, D, E, F = np.moveaxis(coefficients, -1, 0)
    rows = [np.stack([A, B / 2, D / 2], -1), np.stack([B / 2, C, E / 2], -1), np.stack([D / 2, E / 2, F], -1)]
    return np.stack(rows, axis=-2)


def _normalising(scatter: Floats) -> Floats:
    """W (n, 6, 6) with m' = W m for u' = (u − ū)/s, v' = (v − v̄)/s: centroid and size are among the sums."""
    weight = scatter[:, 5, 5]
    u, v = scatter[:, 3, 5] / weight, scatter[:, 4, 5] / weight
    square = ((scatter[:, 0, 5] + scatter[:, 2, 5]) / weight - u * u - v * v) / 2
    size = np.sqrt(np.where(square > _SMALLEST_SIZE_PX**2, square, np.nan))
    W = np.zeros((len(scatter), 6, 6))
    p, q, k = u / size, v / size, 1 / size
    W[:, 0, 0], W[:, 0, 3], W[:, 0, 5] = k * k, -2 * p * k, p * p
    W[:, 1, 1], W[:, 1, 3], W[:, 1, 4], W[:, 1, 5] = k * k, -q * k, -p * k, p * q
    W[:, 2, 2], W[:, 2, 4], W[:, 2, 5] = k * k, -2 * q * k, q * q
    W[:, 3, 3], W[:, 3, 5], W[:, 4, 4], W[:, 4, 5], W[:, 5, 5] = k, -p, k, -q, 1.0
    return W


def _direct(scatter: Floats) -> Floats:
    """Coefficients (n, 6) of the ellipses; NaN where the points determine none."""
    quadratic, mixed, linear = scatter[:, :3, :3], scatter[:, :3, 3:], scatter[:, 3:, 3:]
    spread = np.linalg.det(np.nan_to_num(linear)) / np.maximum(scatter[:, 5, 5], 1e-9) ** 3  # of points of size one: 0 on a line
    solvable = np.isfinite(scatter).all(axis=(1, 2)) & (spread > _SMALLEST_SPREAD)
    safe = np.where(solvable[:, None, None], linear, np.eye(3))
    onto = -np.linalg.solve(safe, np.swapaxes(np.where(solvable[:, None, None], mixed, 0.0), 1, 2))
    system = _FROM_CONSTRAINT @ np.where(solvable[:, None, None], quadratic + mixed @ onto, np.eye(3))
    vectors = np.real(np.linalg.eig(system)[1])
    constraint = 4 * vectors[:, 0] * vectors[:, 2] - vectors[:, 1] ** 2
    best = np.argmax(constraint, axis=1)[:, None, None]
    chosen = np.take_along_axis(vectors, best, axis=2)[..., 0]
    both = np.concatenate([chosen, np.einsum("nij,nj->ni", onto, chosen)], axis=1)
    return np.where((solvable & (constraint.max(axis=1) > 0))[:, None], both, np.nan)


def _compatible(arcs: Arcs, groups: Groups, parameters: DetectorParameters, scale: float) -> Bools:
    """Which groups (g, g) can lie on one convex curve: each within the other's tangents; of one polarity if that is asked."""
    middle = np.einsum("nkc,nk->nc", arcs.points, arcs.weights + 1e-9) / (arcs.weights + 1e-9).sum(axis=1)[:, None]
    ends = np.concatenate([arcs.points[:, [0, -1]], middle[:, None]], axis=1)
    depth = np.einsum("jkc,ic->ijk", ends, arcs.inward) - np.sum(middle * arcs.inward, axis=1)[:, None, None]
    beyond = np.mean(depth < -parameters.convexity_px * scale, axis=2)
    members = groups.members.astype(np.float64)
    sizes = members.sum(axis=1)
    share = members @ beyond @ members.T / (sizes[:, None] * sizes[None, :])
    convex = np.maximum(share, share.T) <= parameters.convexity_share
    alike = groups.bright_inside[:, None] == groups.bright_inside[None, :]
    return np.asarray(convex & alike if parameters.polarity == "same" else convex)
