"""A rigid transform as the seven columns of the truth table and back."""

from collections.abc import Mapping

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.dataset_layout import POSE_COLUMNS


def pose_columns(sensor_from_target: RigidTransform) -> dict[str, float]:
    """The seven pose columns: unit quaternion with qw ≥ 0, translation in metres."""
    quaternion = sensor_from_target.rotation.as_quat(canonical=True, scalar_first=True)
    numbers = np.concatenate([quaternion, sensor_from_target.translation])
    return {name: float(number) for name, number in zip(POSE_COLUMNS, numbers, strict=True)}


def pose(columns: Mapping[str, float]) -> RigidTransform:
    """``sensor_from_target`` back from the seven pose columns."""
    numbers = [columns[name] for name in POSE_COLUMNS]
    return RigidTransform.from_components(numbers[4:], Rotation.from_quat(numbers[:4], scalar_first=True))
