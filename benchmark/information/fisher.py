"""Fisher information of a pose and what follows from it: bounds, nuisances, other parametrisations, efficiency.

Parameters are ξ = (ω, δt) in the sensor's axes: R ← exp(ω) R about the target's origin, t ← t + δt, radians and metres. The bound
is that of an unbiased estimator which knows shape, materials and light, near the truth (Kay, Estimation Theory, 1993, chapter 3).
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from scenes.arrays import Floats, frozen

AXES = ("wx", "wy", "wz", "tx", "ty", "tz")
# Medians of χ² with six and with three degrees of freedom (Abramowitz & Stegun, table 26.8): what NEES of an ideal estimator has.
CHI2_MEDIAN_6, CHI2_MEDIAN_3 = 5.348, 2.366
FEWEST = 30  # frames from which an efficiency is a figure: one frame's error is a random draw
_LEAST_EIGENVALUE = 1e-9  # of the information with unit diagonal: below it a direction is not determined


@dataclass(frozen=True, slots=True, eq=False)
class Bound:
    """``information`` (6, 6) about ξ, its inverse ``covariance``, NaN throughout where it is undetermined.

    ``least_eigenvalue``: of the information scaled to a unit diagonal; not above zero where nobody could estimate the pose, or
    where Monte-Carlo noise hides whether anybody could.
    """

    information: Floats
    covariance: Floats
    least_eigenvalue: float

    @property
    def is_determined(self) -> bool:
        """Whether every direction of ξ is bounded."""
        return bool(np.isfinite(self.covariance).all())

    @property
    def sigma(self) -> Floats:
        """(6,) standard deviations, radians and metres."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def rotation_rad(self) -> float:
        """√ trace of the attitude's covariance."""
        return float(np.sqrt(np.trace(self.covariance[:3, :3])))

    @property
    def position_m(self) -> float:
        """√ trace of the position's covariance."""
        return float(np.sqrt(np.trace(self.covariance[3:, 3:])))


def bound(information: Floats) -> Bound:
    """The bound of an information matrix (6, 6), undetermined where it is not positive definite."""
    symmetric = (information + information.T) / 2
    diagonal = np.diag(symmetric)
    nothing = Bound(frozen(symmetric), frozen(np.full((6, 6), np.nan)), float("nan"))
    if not np.isfinite(symmetric).all() or (diagonal <= 0).any():
        return nothing
    scale = 1 / np.sqrt(diagonal)
    least = float(np.linalg.eigvalsh(symmetric * np.outer(scale, scale))[0])
    if least <= _LEAST_EIGENVALUE:
        return Bound(nothing.information, nothing.covariance, least)
    normalised = np.linalg.inv(symmetric * np.outer(scale, scale))
    return Bound(nothing.information, frozen(normalised * np.outer(scale, scale)), least)


def information(weight: Floats, first: Floats, second: Floats) -> Floats:
    """I = sym Σ w J_a J_bᵀ from two independent estimates (k, n) of the derivatives, w (n,).

    A product of one noisy estimate with itself would count its noise as information; that of two does not on average.
    """
    product = (first * weight) @ second.T
    return np.asarray((product + product.T) / 2)


def without_nuisance(information: Floats, kept: int) -> Floats:
    """What is left about the first ``kept`` parameters where the others are unknown too: the Schur complement."""
    wanted, cross, rest = information[:kept, :kept], information[:kept, kept:], information[kept:, kept:]
    return np.asarray(wanted - cross @ np.linalg.solve(rest, cross.T))


def in_axes(information: Floats, other_from_own: Rotation) -> Floats:
    """The same information about ξ in another sensor's axes: Tᵀ I T with ξ_own = T ξ_other.

    ξ turns about the target's origin wherever the sensor stands, so no lever couples the two: both vectors only change axes.
    """
    turn = other_from_own.inv().as_matrix()
    change = np.zeros((6, 6))
    change[:3, :3] = change[3:, 3:] = turn
    return np.asarray(change.T @ information @ change)


def stereo_bound(left: Bound, right: Bound, left_from_right: Rotation) -> Bound:
    """What the pictures of two cameras tell together, in the left one's axes: their noises are independent, informations add.

    Both turn about the target's origin and shift it, so the baseline does not enter; it is in what each picture tells.
    """
    return bound(left.information + in_axes(right.information, left_from_right))


def pose_error(true: Rotation, true_m: Floats, given: Rotation, given_m: Floats) -> Floats:
    """(n, 6) errors ξ that take true ``sensor_from_target`` to estimated ones; (n, 3) positions, NaN where there is none."""
    return np.hstack([(given * true.inv()).as_rotvec().reshape(-1, 3), np.asarray(given_m - true_m).reshape(-1, 3)])


def nees(errors: Floats, informations: Floats) -> Floats:
    """(n,) eᵀ I e."""
    return np.asarray(np.einsum("ni,nij,nj->n", errors, informations, errors))


def efficiency(errors: Floats, informations: Floats) -> float:
    """η = 5.348 / median(eᵀ I e): 1 for an ideal estimator, 1/4 at twice its spread; above 1 hints at a prior, a bias or a leak."""
    return CHI2_MEDIAN_6 / float(np.median(nees(errors, informations)))


def attitude_efficiency(turns_rad: Floats, covariances: Floats) -> float:
    """η_R = 2.366 / median(ωᵀ C_R⁻¹ ω), C_R (n, 3, 3) the marginal covariances of the attitude."""
    return CHI2_MEDIAN_3 / float(np.median(nees(turns_rad, np.asarray(np.linalg.inv(covariances), dtype=np.float64))))
