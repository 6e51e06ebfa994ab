"""The paper's states in the terms of the recommended filter, so that both are judged alike.

Everything goes to the target's own axes: ω_P = R_PBᵀ ω_B and J = 3 R_PBᵀ diag(1, p₁, p₂) R_PB / (1 + p₁ + p₂), and the covariance
by the derivatives of these.
"""

import numpy as np

from estimators.lidar_filter import paper_filter_equations as paper
from estimators.lidar_filter import tumble_filter_state as at
from estimators.lidar_filter.filter_extras import tumble_extras
from estimators.lidar_filter.paper_filter_equations import PaperState
from estimators.lidar_filter.rigid_body import cross_matrix
from scenes.arrays import Floats
from scenes.inertia import BASIS, is_feasible


def inertia_target(ratios: Floats, body_from_target: Floats) -> Floats:
    """J (3, 3) with trace 3 in target axes, from p (2,) and R(q_PB)."""
    moments = np.array([1.0, *ratios])
    return np.asarray(3 * body_from_target.T @ np.diag(moments) @ body_from_target / moments.sum())


def errors_map(state: PaperState) -> Floats:
    """∂[θ, ω_P, j, r, v, ρ] / ∂[a, ω_B, p, r, v, b, ρ] (20, 20)."""
    axes = state.body_from_target.as_matrix()
    J, moments = inertia_target(state.ratios, axes), np.array([1.0, *state.ratios])
    T = np.zeros((paper.STATES, paper.STATES))
    T[at.ATTITUDE, paper.ATTITUDE] = 2 * np.eye(3)
    T[at.OMEGA, paper.OMEGA] = axes.T
    T[at.OMEGA, paper.BODY] = 2 * cross_matrix(axes.T @ state.omega_body_rad_s)
    turns = cross_matrix(np.eye(3))  # of R_PB exp(2b): δJ = 2 (J [b]× − [b]× J)
    T[at.INERTIA, paper.BODY] = _components(2 * (J @ turns - turns @ J))
    scaled = [3 * (np.diag(np.eye(3)[k]) - np.diag(moments) / moments.sum()) / moments.sum() for k in (1, 2)]
    T[at.INERTIA, paper.RATIOS] = _components(axes.T @ np.array(scaled) @ axes)
    for ours, theirs in ((at.POSITION, paper.POSITION), (at.VELOCITY, paper.VELOCITY), (at.OFFSET, paper.OFFSET)):
        T[ours, theirs] = np.eye(3)
    return T


def _components(matrices: Floats) -> Floats:
    """tr(E_i M_k) (5, k)."""
    return np.asarray(np.einsum("iab,kab->ik", BASIS, matrices))


def paper_extras(state: PaperState) -> dict[str, float]:
    """Named numbers of a state, with the labels of its own principal axes."""
    axes, T = state.body_from_target.as_matrix(), errors_map(state)
    omega, J = axes.T @ state.omega_body_rad_s, inertia_target(state.ratios, axes)
    named = tumble_extras(omega, J, state.position_m, state.velocity_m_s, state.offset_m, T @ state.covariance @ T.T)
    x, y, z, w = state.body_from_target.inv().as_quat(canonical=True).tolist()
    p1, p2 = state.ratios.tolist()
    infeasible = float(not is_feasible([1.0, p1, p2]))
    return named | {"p1": p1, "p2": p2, "infeasible_inertia": infeasible, "body_qw": w, "body_qx": x, "body_qy": y, "body_qz": z}
