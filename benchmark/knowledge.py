"""What a method is told in advance. This is the only place where truth flows to an estimator, and all of it is recorded.

The corner prior plays the operator who clicks the rectangle's four corners in the first picture: the true corner pixels plus
Gaussian noise, from a stream of the data set's seed and the feature's name, so that every method gets the same clicks.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.spatial.transform import RigidTransform

from benchmark.model_cloud import digest, model_cloud
from benchmark.records import CornerPriorRecord, KnowledgeRecord, ModelRecord, PairRecord
from scenes.arrays import Floats, frozen
from scenes.dataset import Dataset
from scenes.errors import UsageError, unknown
from scenes.features import CircleFeature, MarkerFeature, RectangleFeature
from scenes.intrinsics import Intrinsics
from scenes.provenance import canonical_json, stream
from scenes.recording import CornerPrior, Knowledge, ModelCloud, Rectangle, Ring, StereoPair
from scenes.target import Target

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
    grant_radius: bool = False,
    rig: str | None = None,
    lidar: str | None = None,
    grant_model: bool = False,
) -> Declaration:
    """Calibration of every sensor, and the feature ``feature_name``: a rectangle, or a circle, which two cameras measure.

    Of a rectangle: its corner pixels in ``frame`` (default: the first); ``grant_aspect`` adds L/W. Of a circle: the stereo rig
    ``rig``, which needs no name where there is one; ``grant_radius`` adds the radius. Markers are not told of. A data set whose
    target has one rectangle or circle needs no name. Of a data set without cameras, or where ``lidar`` names one of several
    LIDARs, nothing is told of the target, but with ``grant_model`` a cloud of its surface. Raises ``UsageError`` for an unknown
    feature, rig or LIDAR, for a rectangle whose four corners nobody could click in that frame (behind the camera, outside the
    picture, or on a side that is turned away), for a circle without a rig, and for a model that no LIDAR could use.
    """
    if lidar is not None or (dataset.lidars and not dataset.sensors):
        if rig is not None:
            raise UsageError("a stereo rig is told of with a circle, not with a LIDAR")
        return _of_lidar(dataset, feature_name, lidar, grant_model)
    if grant_model:
        raise UsageError("a model of the target is told to methods for a LIDAR; name one with --lidar, where the data set has one")
    if not 0 <= sigma_px < np.inf:
        raise UsageError(f"the corner prior's sigma is {sigma_px} px; it must be a finite number, at least 0")
    feature = _feature(dataset, feature_name)
    if isinstance(feature, CircleFeature):
        return _of_ring(dataset, feature, grant_radius, rig)
    if rig is not None:
        named = "without a feature" if feature is None else f"with the rectangle {feature.name!r}"
        raise UsageError(f"a stereo rig is told of with a circle, not {named}")
    if feature is None:
        sensors, lidars = dict(dataset.sensors), dict(dataset.lidars)
        return Declaration(Knowledge(sensors, lidars=lidars), KnowledgeRecord(sensors=tuple(sensors), lidars=tuple(lidars)))
    return _of_rectangle(dataset, feature, sigma_px, grant_aspect, dataset.frames[0] if frame is None else frame)


def _of_lidar(dataset: Dataset, feature_name: str | None, name: str | None, grant_model: bool) -> Declaration:
    """The one LIDAR that a method is to answer for, or all where none is named."""
    if feature_name is not None:
        raise UsageError(f"feature {feature_name!r} is told of to methods for cameras, not for a LIDAR")
    if name is not None and name not in dataset.lidars:
        raise UsageError(f"{dataset.path}: {unknown('LIDAR', name, dataset.lidars)}")
    sensors, lidars = dict(dataset.sensors), {key: one for key, one in dataset.lidars.items() if name in (None, key)}
    model, told = _model(canonical_json(dataset.scenario["target"])) if grant_model else (None, None)
    record = KnowledgeRecord(sensors=tuple(sensors), lidars=tuple(lidars), model=told)
    return Declaration(Knowledge(sensors, lidars=lidars, model=model), record)


@lru_cache(maxsize=2)
def _model(target: str) -> tuple[ModelCloud, ModelRecord]:
    """The cloud of a target, given as JSON, and its record; the data sets of a suite mostly share one target."""
    cloud = model_cloud(Target.model_validate_json(target))
    return cloud, ModelRecord(points=len(cloud.points_target), digest=digest(cloud))


def _of_rectangle(
    dataset: Dataset, feature: RectangleFeature, sigma_px: float, grant_aspect: bool, first: int
) -> Declaration:
    sensors = dict(dataset.sensors)
    sensor = _single_camera(dataset)
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
        lidars=tuple(dataset.lidars),
    )
    return Declaration(Knowledge(sensors, rectangle, prior, lidars=dict(dataset.lidars)), record)


def _single_camera(dataset: Dataset) -> str:
    """The camera that a rectangle is looked at through: the first that belongs to no rig, else the first."""
    paired = {name for pair in dataset.rigs.values() for name in (pair.left, pair.right)}
    return next((name for name in dataset.sensors if name not in paired), next(iter(dataset.sensors)))


def _of_ring(dataset: Dataset, feature: CircleFeature, grant_radius: bool, rig: str | None) -> Declaration:
    """No corner is clicked and no marker told of: a method finds the ring by itself."""
    pair, sensors = _pair(dataset, feature, rig), dict(dataset.sensors)
    radius_m = feature.radius_m if grant_radius else None
    record = KnowledgeRecord(
        sensors=tuple(sensors),
        feature=feature.name,
        pair=PairRecord(left=pair.left, right=pair.right),
        radius_m=radius_m,
        lidars=tuple(dataset.lidars),
    )
    ring = Ring(feature.name, feature.target_from_feature, radius_m)
    return Declaration(Knowledge(sensors, pair=pair, ring=ring, lidars=dict(dataset.lidars)), record)


def _pair(dataset: Dataset, feature: CircleFeature, name: str | None) -> StereoPair:
    rigs = dataset.rigs
    if not rigs:
        raise UsageError(f"feature {feature.name!r} is a circle, which two cameras measure, and {dataset.path} has no stereo rig")
    if name is None and len(rigs) > 1:
        raise UsageError(f"the data set has several stereo rigs; choose one with --rig: {', '.join(rigs)}")
    if name is not None and name not in rigs:
        raise UsageError(f"{dataset.path}: {unknown('stereo rig', name, rigs)}")
    return rigs[next(iter(rigs)) if name is None else name]


def _feature(dataset: Dataset, name: str | None) -> RectangleFeature | CircleFeature | None:
    told = {one.name: one for one in dataset.features if not isinstance(one, MarkerFeature)}
    if name is None and len(told) > 1:
        raise UsageError(f"the target has several features; choose one with --feature: {', '.join(told)}")
    if name is None:
        return next(iter(told.values()), None)
    if name in {one.name for one in dataset.features} - told.keys():
        choice = ", ".join(told) or "none here"
        raise UsageError(f"feature {name!r} is a marker; a method is told of a rectangle or a circle ({choice})")
    if name not in told:
        raise UsageError(f"{dataset.path}: {unknown('feature', name, told)}")
    return told[name]


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
