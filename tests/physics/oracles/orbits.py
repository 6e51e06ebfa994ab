"""The set-up of Song et al. 2017, section 5.1, and an integration of it that shares no formula with the product's.

Attitude by a rotation matrix and the constant angular momentum instead of a quaternion and Euler's equations; orbits one craft at
a time; SciPy's DOP853 at its tightest tolerance.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from scenes.inertia import MassProperties
from scenes.orbit_motion import TumbleInOrbit
from scenes.orbit_trajectory import TumbleTrajectory

MU = 3.986004418e14
POSITION, VELOCITY = np.array([6_998_450.0, 0.0, 0.0]), np.array([0.0, 7545.7, 131.7])
OMEGA = np.array([0.02, 0.01, -0.015])
PRINCIPAL = np.array([500.0, 1000.0, 1500.0])
WXYZ = np.array([0.7303, 0.1826, 0.3651, 0.5477])
Floats = NDArray[np.float64]


def song(**changes) -> TumbleInOrbit:
    """The paper's motion, with the mean motion as its rate."""
    tree = {
        "type": "tumble-in-orbit",
        "target_position_m": POSITION.tolist(),
        "target_velocity_m_s": VELOCITY.tolist(),
        "relative": {"type": "ellipse", "amplitude_m": 30.0},
        "inertial_from_body_wxyz": WXYZ.tolist(),
        "omega_body_rad_s": OMEGA.tolist(),
    }
    return TumbleInOrbit.model_validate(tree | changes)


def trajectory(principal=PRINCIPAL, mass=None, **changes) -> TumbleTrajectory:
    """The paper's trajectory; body and target frame are the same unless ``mass`` says otherwise."""
    return TumbleTrajectory(song(**changes), mass or MassProperties(principal_kg_m2=tuple(principal)))


def _solved(rates, start: Floats, times_s: Floats, atol: float) -> Floats:
    done = solve_ivp(rates, (0.0, times_s[-1]), start, "DOP853", times_s, rtol=2.3e-14, atol=atol)
    return np.asarray(done.y.T)


def free_turning(times_s: Floats) -> tuple[Floats, Floats]:
    """inertial_from_body (n, 3, 3) and ω in body axes (n, 3) of a free body: Ċ = C [ω]×, ω = I⁻¹ Cᵀ H with H constant."""
    start = Rotation.from_quat(WXYZ, scalar_first=True).as_matrix()
    momentum = start @ (PRINCIPAL * OMEGA)

    def rates(_, flat):
        axes = flat.reshape(3, 3)
        a, b, c = (axes.T @ momentum) / PRINCIPAL
        return (axes @ np.array([[0, -c, b], [c, 0, -a], [-b, a, 0]])).ravel()

    axes = _solved(rates, start.ravel(), times_s, 1e-15).reshape(-1, 3, 3)
    return axes, np.einsum("nji,j->ni", axes, momentum) / PRINCIPAL


def kepler(position: Floats, velocity: Floats, times_s: Floats) -> Floats:
    """States (n, 6) of one point mass about another."""

    def rates(_, state):
        return np.concatenate([state[3:], -MU * state[:3] / np.linalg.norm(state[:3]) ** 3])

    return _solved(rates, np.concatenate([position, velocity]), times_s, 1e-9)
