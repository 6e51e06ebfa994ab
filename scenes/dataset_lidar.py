"""What a data set says of a LIDAR: its entry in the manifest, the chaser's state in a frame."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from scenes.arrays import frozen
from scenes.errors import DatasetError
from scenes.pose_columns import pose, pose_columns
from scenes.recording import ChaserState, LidarModel

KIND = "lidar"
_WHOLE = ("rows", "columns")
_NUMBERS = ("range_sigma_m", "divergence_rad", "least_range_m", "most_range_m", "duration_s", "delay_s")
_VECTORS = ("position_inertial_m", "velocity_inertial_m_s", "omega_chaser_rad_s")
_QUATERNION = ("qw", "qx", "qy", "qz")


def is_lidar(entry: Mapping[str, Any]) -> bool:
    """Whether an entry of ``Manifest.sensors`` is a LIDAR's; one without a kind is a camera's."""
    return entry.get("kind") == KIND


def lidar_entry(model: LidarModel, **more: Any) -> dict[str, Any]:
    """A LIDAR's entry of ``Manifest.sensors``; ``more`` is kept beside its calibration."""
    numbers = {name: getattr(model, name) for name in (*_WHOLE, *_NUMBERS)}
    return {"kind": KIND, "chaser_from_lidar": pose_columns(model.chaser_from_lidar), **numbers, **more}


def lidar_model(entry: Mapping[str, Any], where: str) -> LidarModel:
    """The calibration back from an entry of ``Manifest.sensors``. Raises ``DatasetError`` naming ``where``."""
    try:
        numbers: dict[str, Any] = {name: float(entry[name]) for name in _NUMBERS} | {name: int(entry[name]) for name in _WHOLE}
        return LidarModel(chaser_from_lidar=pose(entry["chaser_from_lidar"]), **numbers)
    except (KeyError, TypeError, ValueError) as error:
        raise DatasetError(f"{where}: it is no LIDAR calibration ({error!r})") from None


def chaser_entry(chaser: ChaserState) -> dict[str, Any]:
    """``state.chaser`` of a frame.json."""
    quaternion = chaser.inertial_from_chaser.as_quat(canonical=True, scalar_first=True).tolist()
    vectors = {name: np.asarray(getattr(chaser, name)).tolist() for name in _VECTORS}
    return {"time_s": chaser.time_s, "inertial_from_chaser": dict(zip(_QUATERNION, quaternion)), **vectors}


def chaser_state(state: Mapping[str, Any], where: str) -> ChaserState | None:
    """The chaser's own state back from a frame's ``state``, None where it has none. Raises ``DatasetError`` naming ``where``."""
    entry = state.get("chaser")
    if entry is None:
        return None
    try:
        rotation = Rotation.from_quat([entry["inertial_from_chaser"][name] for name in _QUATERNION], scalar_first=True)
        return ChaserState(float(entry["time_s"]), rotation, *(frozen(entry[name]) for name in _VECTORS))
    except (KeyError, TypeError, ValueError) as error:
        raise DatasetError(f"{where}: state.chaser is no state of a chaser ({error!r})") from None
