"""A filter's answer as named numbers: states, 1σ, covariance, and what follows from the inertia."""

from collections.abc import Iterable

import numpy as np

from estimators.lidar_filter import tumble_filter_state as at
from scenes.arrays import Floats
from scenes.inertia import components_of, is_feasible, principal_axes

_UPPER = np.triu_indices(at.STATES)
_COVARIANCE_NAMES = [f"cov_{i}_{j}" for i, j in zip(*_UPPER, strict=True)]
_INERTIA_NAMES = [f"inertia_{i}" for i in range(1, 6)]
_SIGMA_NAMES = (
    [f"sigma_{name}_{axis}{unit}" for name, unit in (("attitude", "_rad"), ("omega", "_rad_s")) for axis in "xyz"]
    + [f"sigma_{name}" for name in _INERTIA_NAMES]
    + [f"sigma_{name}{axis}{unit}" for name, unit in (("rel_", "_m"), ("rel_v", "_m_s"), ("com_", "_m")) for axis in "xyz"]
)


def tumble_extras(
    omega_target: Floats, J: Floats, position_lvlh: Floats, velocity_lvlh: Floats, offset_target: Floats, covariance: Floats
) -> dict[str, float]:
    """Named numbers from ω (3,), J (3, 3), r, v, ρ (3,) each, and the covariance (20, 20) of [θ, ω, j, r, v, ρ]."""
    named = _vector("omega_", omega_target, "_rad_s")
    named |= _vector("rel_", position_lvlh, "_m") | _vector("rel_v", velocity_lvlh, "_m_s") | _vector("com_", -offset_target, "_m")
    named |= _named(_INERTIA_NAMES, components_of(J))
    named |= _named(_SIGMA_NAMES, np.sqrt(np.maximum(np.diagonal(covariance), 0.0)))
    named |= _named(_COVARIANCE_NAMES, covariance[_UPPER])
    return named | principal_extras(J)


def principal_extras(J: Floats) -> dict[str, float]:
    """Inertia ratios and principal axes of J (3, 3), labelled by size, and whether no body has them; nothing of NaN."""
    if not np.isfinite(J).all():
        return {}
    moments, target_from_body = principal_axes(J)
    x, y, z, w = target_from_body.as_quat(canonical=True)
    named = {"infeasible_inertia": float(not is_feasible(moments)), "body_qw": w, "body_qx": x, "body_qy": y, "body_qz": z}
    if moments[0] > 0:
        named |= {"p1": moments[1] / moments[0], "p2": moments[2] / moments[0]}
    return {name: float(value) for name, value in named.items()}


def _vector(head: str, values: Floats, unit: str) -> dict[str, float]:
    return _named([f"{head}{axis}{unit}" for axis in "xyz"], values)


def _named(names: Iterable[str], values: Floats) -> dict[str, float]:
    return dict(zip(names, values.tolist(), strict=True))
