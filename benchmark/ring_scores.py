"""The score columns of a method that was told of a ring: its centre, its normal, the turn about it, its radius, the right ring."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from benchmark import symmetry
from benchmark.angles import wrapped
from benchmark.frame_motion import steps
from benchmark.metrics import WRONG_DEG
from benchmark.predictions import rotations
from benchmark.ring_ellipses import is_the_ring, measured_ellipse, true_ellipse
from benchmark.ring_subject import RingSubject
from scenes.arrays import Floats
from scenes.dataset import Dataset

WRONG_OF_RANGE = 0.02  # a position further off than this share of the range is wrong
KEPT = ("acquired", "from_ring", "markers")  # extras that stand beside the errors; so do the CPU times of stages
STAGE = re.compile(r"cpu_(\w+)_s")


@dataclass(frozen=True, slots=True, eq=False)
class _Track:
    """The answered frames: their places among all, and per frame the attitude (one label for all) and the ring's centre."""

    here: NDArray[np.int64]
    given: Rotation
    given_m: Floats
    true: Rotation
    true_m: Floats


def columns(
    subject: RingSubject, dataset: Dataset, truth: pd.DataFrame, table: pd.DataFrame, extras: pd.DataFrame | None
) -> dict[str, Floats]:
    """The columns of one sensor's frames; ``truth``, ``table`` and ``extras`` have one row a frame, in the same order.

    Lengths in metres, in the sensor frame; angles in degrees; NaN where a frame has no answer, or the answer no such number.
    """
    found = {name: np.full(len(truth), np.nan) for name in ("normal_error_deg", "about_normal_error_deg")}
    found |= {f"ring_{axis}_error_m": np.full(len(truth), np.nan) for axis in "xyz"}
    found |= _of_extras(subject, table, extras)
    found["ring_right"] = _ring_right(subject, dataset, table, extras)
    track = _track(subject, truth, table)
    if track is None:
        return found
    for axis, error_m in zip("xyz", (track.given_m - track.true_m).T, strict=True):
        found[f"ring_{axis}_error_m"][track.here] = error_m
    tilt, turn = split(track.true * subject.target_from_ring, track.given * subject.target_from_ring)
    found["normal_error_deg"][track.here], found["about_normal_error_deg"][track.here] = np.degrees(tilt), np.degrees(turn)
    return found | steps(len(truth), track.here, (track.given, track.given_m), (track.true, track.true_m))


def split(true: Rotation, given: Rotation) -> tuple[Floats, Floats]:
    """The turn from ``true`` to ``given`` as the angle between their Z axes and the signed rest about Z, radians.

    The swing-twist decomposition of D = trueᵀ · given: swing = angle(Z, D Z), twist = 2 atan2(q_z, q_w).
    """
    off = true.inv() * given
    normal, quaternion = off.apply([0.0, 0.0, 1.0]), off.as_quat()
    twist = wrapped(2 * np.arctan2(quaternion[:, 2], quaternion[:, 3]))
    return np.arctan2(np.hypot(normal[:, 0], normal[:, 1]), normal[:, 2]), twist


def wrong(scores: pd.DataFrame) -> Floats:
    """1 where an answer is wrong: another ring, more than ``WRONG_DEG``, or more than ``WRONG_OF_RANGE``; NaN without an answer."""
    reasons = wrong_reasons(scores)
    return np.where(scores["outcome"] == "ok", np.any(list(reasons.values()), axis=0), np.nan)


def wrong_reasons(scores: pd.DataFrame) -> dict[str, NDArray[np.bool_]]:
    """For each way of being wrong the frames where an answer is."""
    answered = (scores["outcome"] == "ok").to_numpy()
    off_m = scores["position_error_m"].to_numpy(dtype=np.float64)
    return {
        "ring": answered & (scores["ring_right"].to_numpy() == 0.0),
        "attitude": answered & (scores["geodesic_deg"].to_numpy(dtype=np.float64) > WRONG_DEG),
        "position": answered & (off_m > WRONG_OF_RANGE * scores["range_m"].to_numpy(dtype=np.float64)),
    }


def _track(subject: RingSubject, truth: pd.DataFrame, table: pd.DataFrame) -> _Track | None:
    """What was answered, every attitude with the one label that suits the whole track; None where nothing was."""
    here = np.flatnonzero(table["outcome"] == "ok")
    if here.size == 0:
        return None
    true, given = rotations(truth.iloc[here]), rotations(table.iloc[here])
    label = subject.labels[symmetry.track_element(true, given, subject.labels)]
    return _Track(here, given * label.inv(), subject.centres(table.iloc[here]), true, subject.centres(truth.iloc[here]))


def _ring_right(subject: RingSubject, dataset: Dataset, table: pd.DataFrame, extras: pd.DataFrame | None) -> Floats:
    """1 where the measured ellipses of both views are the true ring's, 0 where one is not, NaN where one is missing."""
    right = np.full(len(table), np.nan)
    if extras is None or not subject.views:
        return right
    frames = table.index.to_list()
    for place in np.flatnonzero(table["outcome"] == "ok"):
        row = {str(name): value for name, value in extras.iloc[place].items()}
        right[place] = _both_right(subject, dataset, frames[place], row)
    return right


def _both_right(subject: RingSubject, dataset: Dataset, frame: int, row: Mapping[str, float]) -> float:
    measured = {view: measured_ellipse(row, view) for view in subject.views}
    if any(one is None for one in measured.values()):
        return float("nan")
    poses = dataset.truth(frame).sensor_from_target
    agree = []
    for view, camera in subject.views.items():
        true = true_ellipse(subject.circle, poses[camera], dataset.sensors[camera].intrinsics)
        ellipse = measured[view]
        agree.append(ellipse is not None and is_the_ring(ellipse, true))
    return float(all(agree))


def _of_extras(subject: RingSubject, table: pd.DataFrame, extras: pd.DataFrame | None) -> dict[str, Floats]:
    """What is taken over from the extras, and the error of the radius where there is an answer."""
    missing = np.full(len(table), np.nan)
    if extras is None:
        return {"radius_error_m": missing}
    taken = [str(name) for name in extras if name in KEPT or STAGE.fullmatch(str(name))]
    kept = {name: extras[name].to_numpy(dtype=np.float64) for name in taken}
    radius_m = extras["radius_m"].to_numpy(dtype=np.float64) if "radius_m" in extras else missing
    return kept | {"radius_error_m": np.where(table["outcome"] == "ok", radius_m - subject.circle.radius_m, np.nan)}
