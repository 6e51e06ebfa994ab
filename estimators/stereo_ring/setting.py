"""What a ring method is told before the first frame, checked, and how it gets at a frame's two pictures."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from estimators.stereo_ring.rig import Rig, rig_from_knowledge
from estimators.told import sensors_of
from scenes.intrinsics import Intrinsics
from scenes.recording import Knowledge, Observation, Ring, SensorModel

Picture = NDArray[np.uint8]
_WHITE_8_BIT = 255


@dataclass(frozen=True, slots=True, eq=False)
class Setting:
    """The rig, the ring, and both cameras in the order (left, right); ``maps`` undo their distortion where there is any."""

    names: tuple[str, str]
    sensors: tuple[SensorModel, SensorModel]
    rig: Rig
    ring: Ring
    maps: tuple[tuple[NDArray[np.generic], NDArray[np.generic]] | None, tuple[NDArray[np.generic], NDArray[np.generic]] | None]

    def pictures(self, observation: Observation) -> tuple[Picture, Picture] | str:
        """Both pictures (height, width), white at 255, without distortion; or a sentence why there are none to use."""
        found = []
        for name, sensor, table in zip(self.names, self.sensors, self.maps, strict=True):
            if name not in observation.images:
                return f"frame {observation.frame} has no picture of {name!r}"
            pixels = observation.images[name].pixels
            expected = (sensor.intrinsics.height_px, sensor.intrinsics.width_px)
            if pixels.shape != expected:
                return f"the picture of {name!r} is {pixels.shape} px (rows, columns), the calibration says {expected}"
            picture = eight_bit(pixels, sensor)
            found.append(picture if table is None else np.asarray(cv2.remap(picture, *table, cv2.INTER_LINEAR), dtype=np.uint8))
        return found[0], found[1]

    def left_from_target(self, left_from_ring: RigidTransform) -> RigidTransform:
        """The answer for the left sensor: where the target is, if the ring's frame is there."""
        return left_from_ring * self.ring.target_from_feature.inv()


def setting_from(knowledge: Knowledge) -> Setting:
    """The checked setting. Raises ``ValueError`` naming what is missing."""
    if knowledge.ring is None:
        raise ValueError(
            "this method measures a ring with the two cameras of a stereo rig, and no Knowledge.ring is told: name a circle of the "
            f"target with --feature; there are {sensors_of(knowledge)}"
        )
    rig = rig_from_knowledge(knowledge)
    if knowledge.pair is None:  # rig_from_knowledge has refused it; said again for the type
        raise ValueError("a stereo method needs Knowledge.pair")
    names = (knowledge.pair.left, knowledge.pair.right)
    left, right = knowledge.sensors[names[0]], knowledge.sensors[names[1]]
    return Setting(names, (left, right), rig, knowledge.ring, (_table(left.intrinsics), _table(right.intrinsics)))


def eight_bit(pixels: NDArray[np.generic], sensor: SensorModel) -> Picture:
    """The picture with white at 255; eight bits as they are, so that a threshold in DN means what it says."""
    if pixels.dtype == np.uint8 and sensor.white_dn == _WHITE_8_BIT:
        return pixels.view(np.uint8)
    scaled = pixels.astype(np.float32) * np.float32(_WHITE_8_BIT / sensor.white_dn)
    return np.asarray(np.clip(np.rint(scaled), 0, _WHITE_8_BIT), dtype=np.uint8)


def _table(lens: Intrinsics) -> tuple[NDArray[np.generic], NDArray[np.generic]] | None:
    """Where each pixel of the picture without distortion is in the camera's, for ``cv2.remap``."""
    if not lens.is_distorted:
        return None
    u, v = np.meshgrid(np.arange(lens.width_px), np.arange(lens.height_px))
    ideal = np.stack([(u - lens.cx_px) / lens.fx_px, (v - lens.cy_px) / lens.fy_px], axis=-1)
    raw = np.nan_to_num(lens.pixels_from_normalised(ideal), nan=-1.0).astype(np.float32)
    whole, fraction = cv2.convertMaps(raw, None, cv2.CV_16SC2)
    return np.asarray(whole), np.asarray(fraction)
