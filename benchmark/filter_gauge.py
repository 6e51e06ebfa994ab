"""In which frame a LIDAR method answers, and how that frame lies in the target's.

A method that is told a model of the target answers in the model's frame. One that is not has to choose a frame of its own (its
gauge), of which nobody can say where it lies on the target: it is laid over the truth once, on the first answered frame, and
never again, so that whatever moves afterwards is seen.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark import symmetry
from benchmark.predictions import QUATERNION, TRANSLATION, positions, rotations
from scenes.arrays import Floats

TARGET = "target"


@dataclass(frozen=True, slots=True, eq=False)
class Gauge:
    """``target_from_own``: how the method's frame lies on the target. ``text``: what the summary says of it."""

    text: str
    target_from_own: RigidTransform

    @property
    def is_own(self) -> bool:
        """Whether the method chose its frame itself."""
        return not self.text.startswith(TARGET)


def gauge_of(truth: pd.DataFrame, table: pd.DataFrame, *, told_model: bool, group: str) -> Gauge:
    """The gauge of the answers ``table``, whose rows are those of ``truth``; ``group`` is the target's symmetry.

    Own frames: target_from_own = truth⁻¹ · answer on the first answered frame. Of a symmetric model a method may have found any
    of the attitudes that look alike; there target_from_own is the group's element that suits the whole track.
    """
    answered = np.flatnonzero(table["outcome"] == "ok")
    if answered.size == 0:
        return Gauge(TARGET if told_model else "own", RigidTransform.identity())
    if told_model:
        return _of_symmetry(truth.iloc[answered], table.iloc[answered], group)
    first = [int(answered[0])]
    sensor_from_target, sensor_from_own = (_transform(one.iloc[first]) for one in (truth, table))
    return Gauge(f"own, aligned on frame {truth.index[first[0]]}", sensor_from_target.inv() * sensor_from_own)


def in_target_frame(table: pd.DataFrame, gauge: Gauge) -> pd.DataFrame:
    """The answers as poses of the target's frame: sensor_from_own · own_from_target."""
    posed = table["qw"].notna().to_numpy()
    changed = table.copy()
    if not posed.any():
        return changed
    own_from_target = gauge.target_from_own.inv()
    turned, rows = rotations(table[posed]), table.index[posed]
    origin_m = positions(table[posed]) + turned.apply(own_from_target.translation)
    quaternion = (turned * own_from_target.rotation).as_quat(canonical=True, scalar_first=True)
    changed.loc[rows, list(QUATERNION)] = quaternion
    changed.loc[rows, list(TRANSLATION)] = origin_m
    return changed


def _of_symmetry(truth: pd.DataFrame, table: pd.DataFrame, group: str) -> Gauge:
    elements = symmetry.group(group)
    chosen = elements[symmetry.track_element(rotations(truth), rotations(table), elements)]
    alike = "" if chosen.magnitude() == 0.0 else f", in an attitude that looks alike ({group})"
    return Gauge(TARGET + alike, RigidTransform.from_rotation(chosen))


def _transform(row: pd.DataFrame) -> RigidTransform:
    """The pose in a table of one row; an answer without a position counts as one at the sensor."""
    position_m: Floats = np.nan_to_num(positions(row)[0])
    rotation: Rotation = rotations(row)[0]
    return RigidTransform.from_components(position_m, rotation)
