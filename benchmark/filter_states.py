"""The states of a tumbling target that a filter estimates, by the names of their score columns, with the paper's levels.

The levels are the steady-state errors, 3σ, that Song et al. 2017, section 5.2, give for each. They are told per component.
"""

import math
from dataclasses import dataclass

AXES = ("x", "y", "z")


@dataclass(frozen=True, slots=True)
class State:
    """One state: ``errors`` and ``sigmas`` are columns in SI and radians; times ``scale`` they are in ``unit``, as ``level`` is.

    ``symbol``: its short name. ``form`` prints one of its figures. A state without ``sigmas`` is derived, and no method states how
    uncertain it is.
    """

    key: str
    symbol: str
    title: str
    unit: str
    level: float
    errors: tuple[str, ...]
    sigmas: tuple[str, ...] = ()
    scale: float = 1.0
    form: str = "%.3f"


def _vector(error: str, sigma: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    return tuple(error.format(axis) for axis in AXES), tuple(sigma.format(axis) for axis in AXES)


INERTIA = tuple(f"inertia_{number}_error" for number in range(1, 6)), tuple(f"sigma_inertia_{number}" for number in range(1, 6))
_ATTITUDE = _vector("attitude_{}_error_rad", "sigma_attitude_{}_rad")
_OMEGA = _vector("omega_{}_error_rad_s", "sigma_omega_{}_rad_s")
_REL = _vector("rel_{}_error_m", "sigma_rel_{}_m")
_REL_V = _vector("rel_v{}_error_m_s", "sigma_rel_v{}_m_s")
_RHO = _vector("rho_{}_error_m", "sigma_com_{}_m")
_TURN = tuple(f"q_pb_{axis}_error_rad" for axis in AXES)

STATES = (
    State("attitude", "attitude", "attitude", "deg", 1.5, *_ATTITUDE, scale=math.degrees(1.0), form="%.2f"),
    State("omega", "ω", "angular velocity", "rad/s", 0.01, *_OMEGA, form="%.5f"),
    State("p", "p", "inertia ratios", "", 0.05, ("p1_error", "p2_error")),
    State("r", "r", "relative position", "m", 0.3, *_REL),
    State("v", "v", "relative velocity", "m/s", 0.005, *_REL_V, form="%.4f"),
    State("q_pb", "{P}→{B}", "{P} against the principal axes {B}", "rad", 0.02, _TURN),
    State("rho", "ρ", "from the centre of mass to {P}", "m", 0.1, *_RHO),
)
KEYS = tuple(state.key for state in STATES)

# The error of the 20-state filter in the order of its covariance: attitude, ω, j (inertia), r, v, ρ.
VECTOR = (*_ATTITUDE[0], *_OMEGA[0], *INERTIA[0], *_REL[0], *_REL_V[0], *_RHO[0])
SIGMAS = (*_ATTITUDE[1], *_OMEGA[1], *INERTIA[1], *_REL[1], *_REL_V[1], *_RHO[1])
