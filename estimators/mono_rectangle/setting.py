"""What a rectangle method is told before the first frame, checked, and how it gets at a frame's picture."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimators.mono_rectangle.quadrilateral import edge_ends
from estimators.told import sensors_of
from scenes.arrays import Floats
from scenes.recording import CornerPrior, Knowledge, Observation, Rectangle, SensorModel

_WHITE_8_BIT = 255
_LEAST_SIDE_PX = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Setting:
    """The one sensor that is looked through, the rectangle, and the corners in the first frame."""

    sensor_name: str
    sensor: SensorModel
    rectangle: Rectangle
    prior: CornerPrior

    def pixels(self, observation: Observation) -> NDArray[np.generic] | str:
        """The sensor's picture (height, width), or a sentence why there is none to use."""
        if self.sensor_name not in observation.images:
            return f"frame {observation.frame} has no picture of {self.sensor_name!r}"
        pixels = observation.images[self.sensor_name].pixels
        expected = (self.sensor.intrinsics.height_px, self.sensor.intrinsics.width_px)
        if pixels.shape != expected:
            return f"the picture is {pixels.shape} px (rows, columns), the calibration says {expected}"
        return pixels

    def eight_bit(self, pixels: NDArray[np.generic]) -> NDArray[np.uint8]:
        """The picture with white at 255, for methods that work on eight bits."""
        if pixels.dtype == np.uint8 and self.sensor.white_dn == _WHITE_8_BIT:
            return pixels.view(np.uint8)
        scaled = pixels.astype(np.float32) * np.float32(_WHITE_8_BIT / self.sensor.white_dn)
        return np.asarray(np.clip(np.rint(scaled), 0, _WHITE_8_BIT), dtype=np.uint8)


def setting_from(knowledge: Knowledge) -> Setting:
    """The checked setting. Raises ``ValueError`` naming what is missing."""
    if knowledge.rectangle is None:
        raise ValueError(
            "this method measures a rectangle with one camera, and no Knowledge.rectangle is told: name a rectangle of the target "
            f"with --feature; there are {sensors_of(knowledge)}"
        )
    if knowledge.corner_prior is None:
        raise ValueError("a rectangle method needs Knowledge.corner_prior: the four corners in the first frame")
    name = knowledge.corner_prior.sensor
    if name not in knowledge.sensors:
        raise ValueError(f"the corner prior is for sensor {name!r}, but the sensors are {sorted(knowledge.sensors)}")
    if np.shape(knowledge.corner_prior.corners_px) != (4, 2):
        raise ValueError(f"the corner prior has shape {np.shape(knowledge.corner_prior.corners_px)}, expected (4, 2)")
    if fault := _no_quadrilateral(np.asarray(knowledge.corner_prior.corners_px, dtype=np.float64)):
        raise ValueError(f"the corner prior is no quadrilateral: {fault}")
    return Setting(name, knowledge.sensors[name], knowledge.rectangle, knowledge.corner_prior)


def _no_quadrilateral(corners_px: Floats) -> str:
    """Why four corners cannot be looked for, or ""."""
    if not np.isfinite(corners_px).all():
        return f"its corners are {corners_px.tolist()} px"
    ends = edge_ends(corners_px)
    shortest_px = float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=-1).min())
    return f"its shortest side is {shortest_px:.2f} px" if shortest_px < _LEAST_SIDE_PX else ""
