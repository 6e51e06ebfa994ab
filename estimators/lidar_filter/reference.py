"""What scans are laid over: a surface in a frame of the method's own, told beforehand or made of scans.

The own frame has the target frame's axes, where there is one, and its origin at the surface's centroid: so nothing depends on where
a model has its origin.
"""

from typing import Protocol

import numpy as np
from scipy.spatial.transform import RigidTransform

from estimators.lidar_filter.acquisition import Acquisition
from estimators.lidar_filter.clouds import Surface, planes_through
from estimators.lidar_filter.keyframe_map import KeyframeMap
from estimators.lidar_filter.parameters import LidarParameters, VisibilityParameters
from estimators.lidar_filter.setting import Setting
from estimators.lidar_filter.visibility import seen
from scenes.arrays import Floats
from scenes.recording import ModelCloud

Anchored = tuple[int, RigidTransform]


class Reference(Protocol):
    """A surface in the method's own frame."""

    @property
    def target_from_own(self) -> RigidTransform:
        """Where the own frame lies in the frame that is answered for."""

    @property
    def holds_what_is_seen(self) -> bool:
        """Whether a scan from a pose that is right fits it, or may show sides that are not in it."""

    def begin(self, points_lidar: Floats) -> RigidTransform | str:
        """lidar_from_own of a scan of which nothing is known beforehand; a sentence where it is not found, or not yet."""

    def visible(self, lidar_from_own: RigidTransform) -> Surface:
        """The part that can be seen from such a pose, own frame."""

    def learn(self, points_lidar: Floats, lidar_from_own: RigidTransform) -> bool:
        """Takes in a scan whose pose is believed, and says whether the surface has moved by it."""

    def anchored(self, lidar_from_own: RigidTransform) -> Anchored:
        """A pose that moves with the surface where that moves in the own frame."""

    def released(self, anchored: Anchored) -> RigidTransform:
        """lidar_from_own of such a pose as the surface now lies."""

    def extras(self) -> dict[str, float]:
        """Its size, as named numbers."""


class ModelReference:
    """The target's model, told beforehand."""

    def __init__(
        self, acquisition: Acquisition, surface_own: Surface, centroid_target: Floats, visibility: VisibilityParameters
    ) -> None:
        """``surface_own``: about its centroid, which lies at ``centroid_target`` (3,)."""
        self._acquisition, self._surface, self._visibility = acquisition, surface_own, visibility
        self._target_from_own = RigidTransform.from_translation(centroid_target)

    @property
    def target_from_own(self) -> RigidTransform:
        """The own frame is the target's, moved to the centroid."""
        return self._target_from_own

    @property
    def holds_what_is_seen(self) -> bool:
        """A model holds every side."""
        return True

    def begin(self, points_lidar: Floats) -> RigidTransform | str:
        """Looks over all attitudes."""
        return self._acquisition.step(points_lidar)

    def visible(self, lidar_from_own: RigidTransform) -> Surface:
        """What faces the LIDAR and is not hidden."""
        return self._surface.at(seen(self._surface.moved(lidar_from_own), self._visibility))

    def learn(self, points_lidar: Floats, lidar_from_own: RigidTransform) -> bool:  # noqa: ARG002
        """A model learns nothing."""
        return False

    def anchored(self, lidar_from_own: RigidTransform) -> Anchored:
        """A model does not move."""
        return 0, lidar_from_own

    def released(self, anchored: Anchored) -> RigidTransform:
        """A model does not move."""
        return anchored[1]

    def extras(self) -> dict[str, float]:
        """Its number of points."""
        return {"map_points": float(len(self._surface))}


class FirstScan:
    """The first scan and nothing else: what the target shows later is not in it."""

    def __init__(self, neighbours: int) -> None:
        """``neighbours``: of a point, that its normal is made from."""
        self._neighbours = neighbours
        self._surface = Surface(np.zeros((0, 3)), np.zeros((0, 3)))

    @property
    def target_from_own(self) -> RigidTransform:
        """The method's own frame is the one that is answered for."""
        return RigidTransform.identity()

    @property
    def holds_what_is_seen(self) -> bool:
        """It holds one side alone."""
        return False

    def begin(self, points_lidar: Floats) -> RigidTransform | str:
        """The first scan lies where it lies: LIDAR axes, origin at its centroid."""
        centroid = points_lidar.mean(axis=0)
        points = points_lidar - centroid
        self._surface = planes_through(points, -centroid, self._neighbours)
        return RigidTransform.from_translation(centroid)

    def visible(self, lidar_from_own: RigidTransform) -> Surface:  # noqa: ARG002
        """All of it."""
        return self._surface

    def learn(self, points_lidar: Floats, lidar_from_own: RigidTransform) -> bool:  # noqa: ARG002
        """Nothing is added."""
        return False

    def anchored(self, lidar_from_own: RigidTransform) -> Anchored:
        """The first scan does not move."""
        return 0, lidar_from_own

    def released(self, anchored: Anchored) -> RigidTransform:
        """The first scan does not move."""
        return anchored[1]

    def extras(self) -> dict[str, float]:
        """One keyframe."""
        return {"keyframes": 1.0, "map_points": float(len(self._surface))}


def centred(model: ModelCloud) -> tuple[Surface, Floats]:
    """A model about its centroid, and where that lies in the target frame (3,)."""
    centroid = model.points_target.mean(axis=0)
    return Surface(model.points_target - centroid, np.array(model.normals_target)), centroid


def reference_for(setting: Setting, parameters: LidarParameters) -> Reference:
    """The reference that is asked for. Raises ``ValueError`` where it is to be a model and none is told."""
    wanted = parameters.reference
    if wanted == "auto":
        wanted = "map" if setting.model is None else "model"
    if wanted == "first":
        return FirstScan(parameters.normal_neighbours)
    if wanted == "map":
        return KeyframeMap(setting.noise, parameters.map, parameters.registration)
    if setting.model is None:
        raise ValueError("the reference is to be the target's model, and the knowledge holds none")
    surface, centroid = centred(setting.model)
    acquisition = Acquisition(surface, setting.noise, parameters.acquisition, parameters.registration, parameters.visibility)
    return ModelReference(acquisition, surface, centroid, parameters.visibility)
