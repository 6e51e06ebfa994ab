"""The true states of a tumbling target at every frame of a track, in the frame that a method answers in."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.filter_gauge import Gauge
from benchmark.filter_states import AXES
from benchmark.predictions import rotations
from scenes.arrays import Floats
from scenes.dataset_layout import POSE_COLUMNS
from scenes.inertia import MassProperties, components_of
from scenes.pose_columns import pose

_SCAN = ("scan_qw", "scan_qx", "scan_qy", "scan_qz"), ("scan_tx_m", "scan_ty_m", "scan_tz_m")


@dataclass(frozen=True, slots=True, eq=False)
class TrueStates:
    """``lidar_from_own``: rotations (n) at the observations' times. Vectors (n, 3), NaN where the scenario does not say.

    ``omega_own``: inertial, rad/s. ``rel_m``, ``rel_v_m_s``: of the centres of mass, in the servicer's LVLH. ``rho_own_m`` (3,):
    from the centre of mass to the frame's origin. ``inertia`` (5,): components at trace 3. ``scan_rotation``, ``scan_m``:
    lidar_from_target at the scans' reference instants, None where the truth has none.
    """

    lidar_from_own: Rotation
    omega_own: Floats
    rel_m: Floats
    rel_v_m_s: Floats
    rho_own_m: Floats
    inertia: Floats
    principal: Floats
    own_from_body: Rotation | None
    scan_rotation: Rotation | None
    scan_m: Floats


def true_states(truth: pd.DataFrame, scenario: Mapping[str, Any], gauge: Gauge) -> TrueStates:
    """The states from the truth rows of one LIDAR and from what the scenario says of the target's mass."""
    mass, own_from_target = mass_of(scenario), gauge.target_from_own.inv()
    body = None if mass is None else own_from_target * mass.target_from_body
    scans = _columns(truth, _SCAN[0])
    return TrueStates(
        lidar_from_own=rotations(truth) * gauge.target_from_own.rotation,
        omega_own=_omega(truth, body, own_from_target),
        rel_m=_columns(truth, tuple(f"rel_{axis}_m" for axis in AXES)),
        rel_v_m_s=_columns(truth, tuple(f"rel_v{axis}_m_s" for axis in AXES)),
        rho_own_m=np.full(3, np.nan) if body is None else -np.asarray(body.translation),
        inertia=np.full(5, np.nan) if mass is None or body is None else _inertia(mass, body.rotation),
        principal=np.full(3, np.nan) if mass is None else np.array(mass.principal_kg_m2),
        own_from_body=None if body is None else body.rotation,
        scan_rotation=None if np.isnan(scans).any() else Rotation.from_quat(scans, scalar_first=True),
        scan_m=_columns(truth, _SCAN[1]),
    )


def mass_of(scenario: Mapping[str, Any]) -> MassProperties | None:
    """What a resolved scenario says of its target's mass; None where it says nothing."""
    mass = scenario.get("target", {}).get("mass")
    return None if mass is None else MassProperties.model_validate(mass)


def _inertia(mass: MassProperties, own_from_body: Rotation) -> Floats:
    axes = own_from_body.as_matrix()
    return components_of(axes @ np.diag(mass.principal_kg_m2) @ axes.T)


def _omega(truth: pd.DataFrame, own_from_body: RigidTransform | None, own_from_target: RigidTransform) -> Floats:
    """Inertial, in the method's axes. Where the motion is no orbit the servicer is at rest, so the relative rate is inertial."""
    inertial = _columns(truth, tuple(f"omega_body_{axis}_rad_s" for axis in AXES))
    if own_from_body is not None and np.isfinite(inertial).all():
        return np.asarray(own_from_body.rotation.apply(inertial))
    return np.asarray(own_from_target.rotation.apply(_columns(truth, tuple(f"omega_{axis}_rad_s" for axis in AXES))))


def _columns(truth: pd.DataFrame, names: tuple[str, ...]) -> Floats:
    return np.array(truth.reindex(columns=list(names)), dtype=np.float64)


def scan_pose(row: Mapping[str, float]) -> RigidTransform | None:
    """lidar_from_target at the scan's reference instant, at the frame's time where the truth has no other, None without one."""
    for prefix in ("scan_", ""):
        columns = {name: float(row.get(f"{prefix}{name}", np.nan)) for name in POSE_COLUMNS}
        if np.isfinite(list(columns.values())).all():
            return pose(columns)
    return None
