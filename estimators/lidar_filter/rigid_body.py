"""A body that tumbles free of torque, in any axes of its own and in its principal axes, with the derivatives that filters need.

In the target's axes the inertia is known up to a factor: J = 1 + Σ j_i E_i has trace 3 (``scenes.inertia``). In principal axes it
is two ratios p = (I_y / I_x, I_z / I_x), Song et al. 2017. All functions take leading axes.
"""

from collections.abc import Callable

import numpy as np

from scenes.arrays import Floats
from scenes.inertia import BASIS

_CROSS = np.zeros((3, 9))
for _row, _column, _axis in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
    _CROSS[_axis, 3 * _row + _column], _CROSS[_axis, 3 * _column + _row] = -1, 1


def cross_matrix(vectors: Floats) -> Floats:
    """[v]× (..., 3, 3), with [v]× u = v × u."""
    return (vectors @ _CROSS).reshape((*vectors.shape[:-1], 3, 3))


def times(matrices: Floats, vectors: Floats) -> Floats:
    """Matrices (..., m, n) times vectors (..., n)."""
    return (matrices @ vectors[..., None])[..., 0]


def angular_acceleration(omega: Floats, J: Floats, J_inverse: Floats) -> Floats:
    """Euler's equation ω̇ = −J⁻¹(ω × Jω): (..., 3) rad/s², in any axes of the body."""
    return -times(J_inverse @ cross_matrix(omega), times(J, omega))


def quadratic_form(J: Floats, J_inverse: Floats) -> Floats:
    """A (..., 3, 9) with ω̇ = A (ω ⊗ ω), for those who ask often with the same inertia."""
    return np.asarray(-J_inverse @ (_CROSS.reshape(3, 3, 3).swapaxes(0, 1) @ J[..., None, :, :]).reshape((*J.shape[:-2], 3, 9)))


def quadratic(form: Floats, omega: Floats) -> Floats:
    """A (ω ⊗ ω), (..., 3)."""
    return times(form, (omega[..., :, None] * omega[..., None, :]).reshape((*omega.shape[:-1], 9)))


def angular_jacobians(omega: Floats, J: Floats, J_inverse: Floats) -> tuple[Floats, Floats]:
    """∂ω̇/∂ω (..., 3, 3) = −J⁻¹([ω]×J − [Jω]×) and ∂ω̇/∂j (..., 3, 5), column i: −J⁻¹(ω × E_iω + E_iω̇)."""
    turn, momentum = cross_matrix(omega), times(J, omega)
    slope = -J_inverse @ (turn @ J - cross_matrix(momentum))
    acceleration = angular_acceleration(omega, J, J_inverse)
    of_omega = (omega[..., None, None, :] @ BASIS)[..., 0, :]  # rows E_i ω, as E_i is symmetric
    of_acceleration = (acceleration[..., None, None, :] @ BASIS)[..., 0, :]
    columns = turn @ of_omega.swapaxes(-1, -2) + of_acceleration.swapaxes(-1, -2)
    return slope, -J_inverse @ columns


def angular_quadratic(omega: Floats, J: Floats, J_inverse: Floats, slope: Floats, by_inertia: Floats) -> Floats:
    """B (..., 3, 8, 8), symmetric: xᵀBx is what ω̇ holds of second order in the errors x = [δω, δj].

    From J ω̇ = −ω × Jω it is −J⁻¹(δω × Jδω + δω × δJω + ω × δJδω + δJ δω̇), with δω̇ of first order by ``angular_jacobians``.
    """
    of_omega = BASIS @ omega[..., None, :, None]
    mixed = cross_matrix(omega)[..., None, :, :] @ BASIS - cross_matrix(of_omega[..., 0]) + BASIS @ slope[..., None, :, :]
    inverse = -J_inverse[..., None, :, :]
    B = np.zeros((*omega.shape[:-1], 3, 8, 8))
    B[..., :3, :3] = quadratic_form(J, J_inverse).reshape((*omega.shape[:-1], 3, 3, 3))
    B[..., :3, 3:] = np.moveaxis(inverse @ mixed, -3, -1)
    B[..., 3:, 3:] = (inverse @ (BASIS @ by_inertia[..., None, :, :])).swapaxes(-3, -2)
    return (B + B.swapaxes(-1, -2)) / 2


def body_acceleration(omega_body: Floats, ratios: Floats) -> Floats:
    """f_ω of Song et al. 2017, eq. (11): (..., 3) rad/s² in principal axes, from p (..., 2)."""
    x, y, z = np.moveaxis(omega_body, -1, 0)
    p1, p2 = np.moveaxis(ratios, -1, 0)
    return np.stack([(p1 - p2) * y * z, (p2 - 1) / p1 * x * z, (1 - p1) / p2 * x * y], axis=-1)


def body_jacobians(omega_body: Floats, ratios: Floats) -> tuple[Floats, Floats]:
    """∂f_ω/∂ω (3, 3) and ∂f_ω/∂p (3, 2) of Song et al. 2017, eq. (18), for one body."""
    x, y, z = omega_body
    p1, p2 = ratios
    a, b, c = p1 - p2, (p2 - 1) / p1, (1 - p1) / p2
    slope = np.array([[0 * x, z * a, y * a], [z * b, 0 * x, x * b], [y * c, x * c, 0 * x]])
    by_ratios = np.array([[y * z, -y * z], [-x * z * (p2 - 1) / p1**2, x * z / p1], [-x * y / p2, x * y * (p1 - 1) / p2**2]])
    return slope, by_ratios


def turned(acceleration: Callable[[Floats], Floats], omega: Floats, dt: float) -> tuple[Floats, Floats]:
    """ω after ``dt`` and the rotation vector of the turn in the body's first axes, R(t + dt) = R(t) exp(turn): fourth order.

    ω by the classical Runge-Kutta formula. The turn is ∫ω dt of the cubic through ω and ω̇ at both ends plus the first
    commutator, (dt² / 12) ω₀ × ω₁, of Magnus' series (Iserles et al. 2000, § 5).
    """
    a = acceleration(omega)
    b = acceleration(omega + dt / 2 * a)
    c = acceleration(omega + dt / 2 * b)
    d = acceleration(omega + dt * c)
    after = omega + dt / 6 * (a + 2 * b + 2 * c + d)
    mean = dt / 2 * (omega + after) + dt**2 / 12 * (a - acceleration(after))
    return after, mean + dt**2 / 12 * times(cross_matrix(omega), after)
