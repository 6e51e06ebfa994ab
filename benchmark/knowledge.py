"""What a method is told in advance. This is the only place where truth flows to an estimator, and all of it is recorded.

The corner prior plays the operator who clicks the rectangle's four corners in the first picture: the true corner pixels plus
Gaussian noise, from a stream of the data set's seed and the feature's name, so that every method gets the same clicks.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from benchmark.records import CornerPriorRecord, KnowledgeRecord
from scenes.arrays import Floats, frozen
from scenes.dataset import Dataset
from scenes.errors import UsageError, unknown
from scenes.features import RectangleFeature
from scenes.intrinsics import Intrinsics
from scenes.provenance import stream
from scenes.recording import CornerPrior, Knowledge, Rectangle

PRIOR_SIGMA_PX = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class Declaration:
    """The knowledge itself and its record for run.json."""

    knowledge: Knowledge
    record: KnowledgeRecord


def declare(
    dataset: Dataset,
    feature_name: str | None = None,
    sigma_px: float = PRIOR_SIGMA_PX,
    grant_aspect: bool = False,
    frame: int | None = None,
) -> Declaration:
    """Calibration of every sensor, the feature ``feature_name``, and its corner pixels in ``frame`` (default: the first).

    ``grant_aspect`` adds the rectangle's L/W. A data set whose target has one feature needs no name. Raises ``UsageError``
    for an unknown feature, or one whose four corners nobody could click in that frame: behind the camera, outside the picture,
    or on a side that is turned away.
    """
    if not 0 <= sigma_px < np.inf:
        raise UsageError(f"the corner prior's sigma is {sigma_px} px; it must be a finite number, at least 0")
    sensors = dict(dataset.sensors)
    feature = _feature(dataset, feature_name)
    if feature is None:
        return Declaration(Knowledge(sensors), KnowledgeRecord(sensors=tuple(sensors)))
    first = dataset.frames[0] if frame is None else frame
    sensor = next(iter(sensors))
    aspect = feature.length_m / feature.width_m if grant_aspect else None
    prior = CornerPrior(sensor, frozen(_clicked_corners(dataset, feature, sensor, first, sigma_px)), sigma_px)
    rectangle = Rectangle(feature.name, feature.target_from_feature, feature.gap, feature.free_standing, aspect)
    record = KnowledgeRecord(
        sensors=tuple(sensors),
        feature=feature.name,
        gap=feature.gap,
        free_standing=feature.free_standing,
        aspect=aspect,
        corner_prior=CornerPriorRecord(sensor=sensor, frame=first, corners_px=prior.corners_px.tolist(), sigma_px=sigma_px),
    )
    return Declaration(Knowledge(sensors, rectangle, prior), record)


def _feature(dataset: Dataset, name: str | None) -> RectangleFeature | None:
    by_name = {feature.name: feature for feature in dataset.features}
    if name is None and len(by_name) > 1:
        raise UsageError(f"the target has several features; choose one with --feature: {', '.join(by_name)}")
    if name is None:
        return next(iter(by_name.values()), None)
    if name not in by_name:
        raise UsageError(f"{dataset.path}: {unknown('feature', name, by_name)}")
    return by_name[name]


def _clicked_corners(dataset: Dataset, feature: RectangleFeature, sensor: str, frame: int, sigma_px: float) -> Floats:
    cam_from_target = dataset.truth(frame).sensor_from_target[sensor]
    corners = dataset.sensors[sensor].intrinsics.project(cam_from_target.apply(feature.corners_target))
    fault = _why_unseen(feature, cam_from_target, corners, dataset.sensors[sensor].intrinsics)
    if fault:
        raise UsageError(
            f"feature {feature.name!r} {fault} {sensor!r} in frame {frame}, so its corners cannot be clicked there; "
            "begin with another frame or choose another feature"
        )
    clicks = stream(dataset.manifest.seed, frame, f"knowledge.corner_prior.{feature.name}")
    return np.asarray(corners + clicks.normal(scale=sigma_px, size=corners.shape)) if sigma_px > 0 else corners


def _why_unseen(feature: RectangleFeature, cam_from_target: RigidTransform, corners_px: Floats, lens: Intrinsics) -> str:
    """Why the camera does not see all four corners, ending in front of the sensor's name; empty if it does.

    Seen is judged by the geometry of the rectangle alone: whether another part hides a corner is not asked.
    """
    if np.isnan(corners_px).any():
        return "is not in front of"
    normal_cam = cam_from_target.rotation.apply(feature.target_from_feature.apply([1.0, 0.0, 0.0]))
    if normal_cam @ cam_from_target.apply(np.asarray(feature.centre_m)) >= 0:
        return "faces away from"
    beyond_px = np.array([lens.width_px, lens.height_px]) - 0.5  # integers are pixel centres
    if ((corners_px < -0.5) | (corners_px > beyond_px)).any():
        return "is not wholly in the picture of"
    return ""
