"""The score columns of a LIDAR method: each state's error, the error of the scan's registration, and whether its σ is honest.

Errors are answer minus truth, in the frame that the method answers in (``benchmark.filter_gauge``), in SI and radians. The
attitude's is the rotation vector of truthᵀ · answer in that frame's axes. Labels of principal axes are never compared raw: an
inertia has 24 equally good ones, of which the nearest to the truth is taken.
"""

import re

import numpy as np
import pandas as pd
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.filter_gauge import Gauge
from benchmark.filter_inertia import inertia_columns
from benchmark.filter_nees import nees
from benchmark.filter_states import AXES, SIGMAS, VECTOR
from benchmark.filter_truth import TrueStates
from benchmark.predictions import rotations
from scenes.arrays import Floats

STAGE = re.compile(r"cpu_(\w+)_s")
KEPT = (
    "nis", "nis_dof", "accepted", "predicted", "infeasible_inertia", "keyframes", "map_points", "icp_rmse_m", "icp_overlap",
    "icp_iterations", "icp_points",
)  # fmt: skip
_ICP = ("icp_qw", "icp_qx", "icp_qy", "icp_qz"), ("icp_tx_m", "icp_ty_m", "icp_tz_m")


def columns(truth: pd.DataFrame, table: pd.DataFrame, extras: pd.DataFrame, true: TrueStates, gauge: Gauge) -> dict[str, Floats]:
    """The columns of one sensor's frames; ``truth``, ``table`` and ``extras`` have one row a frame, in the same order.

    NaN where a frame has no answer, the answer no such number, or the scenario no such truth.
    """
    answered = (table["outcome"] == "ok").to_numpy()
    given = extras.where(pd.Series(answered, index=extras.index), np.nan, axis=0) if len(extras.columns) else extras
    found = _attitude(table, true, answered) | _vectors(given, true) | inertia_columns(given, true)
    found |= {name: _extra(given, name) for name in (*SIGMAS, *KEPT)}
    found |= _registration(truth, given, true, gauge)
    found["nees"] = nees(np.stack([found[name] for name in VECTOR], axis=1), given)
    found["returns"] = _extra(truth, "returns")
    taken = [str(name) for name in extras if STAGE.fullmatch(str(name))]
    return found | {name: _extra(extras, name) for name in taken}


def _attitude(table: pd.DataFrame, true: TrueStates, answered: np.ndarray) -> dict[str, Floats]:
    error = np.full((len(table), 3), np.nan)
    if answered.any():
        given = rotations(table[answered])
        error[answered] = (true.lidar_from_own[answered].inv() * given).as_rotvec().reshape(-1, 3)
    return {f"attitude_{axis}_error_rad": error[:, place] for place, axis in enumerate(AXES)}


def _vectors(given: pd.DataFrame, true: TrueStates) -> dict[str, Floats]:
    """ω, r, v, ρ; of ρ a method states its negative, the centre of mass in its frame."""
    found: dict[str, Floats] = {}
    for place, axis in enumerate(AXES):
        found[f"omega_{axis}_error_rad_s"] = _extra(given, f"omega_{axis}_rad_s") - true.omega_own[:, place]
        found[f"rel_{axis}_error_m"] = _extra(given, f"rel_{axis}_m") - true.rel_m[:, place]
        found[f"rel_v{axis}_error_m_s"] = _extra(given, f"rel_v{axis}_m_s") - true.rel_v_m_s[:, place]
        found[f"rho_{axis}_error_m"] = -_extra(given, f"com_{axis}_m") - true.rho_own_m[place]
    return found


def _registration(truth: pd.DataFrame, given: pd.DataFrame, true: TrueStates, gauge: Gauge) -> dict[str, Floats]:
    """How far the scan's own registration is off at the scan's reference instant, of the target's origin and attitude."""
    attitude_deg, position_m = np.full(len(truth), np.nan), np.full(len(truth), np.nan)
    quaternion = given.reindex(columns=list(_ICP[0])).to_numpy(dtype=np.float64)
    origin_m = given.reindex(columns=list(_ICP[1])).to_numpy(dtype=np.float64)
    here = np.isfinite(np.hstack([quaternion, origin_m])).all(axis=1)
    if here.any() and true.scan_rotation is not None:
        lidar_from_own = RigidTransform.from_components(origin_m[here], Rotation.from_quat(quaternion[here], scalar_first=True))
        lidar_from_target = lidar_from_own * gauge.target_from_own.inv()
        attitude_deg[here] = np.degrees((true.scan_rotation[here].inv() * lidar_from_target.rotation).magnitude())
        position_m[here] = np.linalg.norm(lidar_from_target.translation - true.scan_m[here], axis=1)
    return {"icp_attitude_error_deg": attitude_deg, "icp_position_error_m": position_m}


def _extra(table: pd.DataFrame, name: str) -> Floats:
    """One column as numbers, NaN where there is none."""
    return table[name].to_numpy(dtype=np.float64) if name in table else np.full(len(table), np.nan)
