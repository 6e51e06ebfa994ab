"""A LIDAR as a person describes it: where its beams point, what a beam is, what the receiver makes of it, where it is mounted."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from scenes.camera import Mount
from scenes.laser_beam import Beam
from scenes.ranging_model import PaperRanging, RangingModel
from scenes.recording import LidarModel
from scenes.scan_pattern import MOST_BEAMS, ScanPattern
from scenes.spec import NonNegative, Spec

_MOST_RAYS = 2**24


class Lidar(Spec):
    """A LIDAR and where it is mounted. Its axes are a camera's: x right, y down, z along the middle of its field.

    ``gate_m``: least and most range at which the receiver listens. ``returns``: which return of a beam is delivered;
    ``strongest-and-last`` delivers two, the last (where that is the strongest: the next strongest) as a second block of rows
    below the first. ``delay_s``: by how much the middle of a scan lies before the frame's time.
    """

    type: Literal["lidar"] = "lidar"
    description: str = ""
    source: str = ""
    pattern: ScanPattern
    beam: Beam
    ranging: RangingModel
    returns: Literal["strongest", "first", "last", "strongest-and-last"] = "strongest"
    gate_m: tuple[NonNegative, Annotated[float, Field(gt=0, le=1e5)]]
    delay_s: NonNegative = 0.0
    mount: Mount = Mount()

    @model_validator(mode="after")
    def _is_possible(self) -> "Lidar":
        rows, columns = self.pattern.shape
        if rows * columns > MOST_BEAMS or rows * columns * self.beam.sub_rays > _MOST_RAYS:
            rays = rows * columns * self.beam.sub_rays
            raise ValueError(f"{rows} × {columns} beams of {self.beam.sub_rays} sub-rays are {rays} rays, at most {_MOST_RAYS}")
        if self.gate_m[0] >= self.gate_m[1]:
            raise ValueError(f"gate_m: the least range {self.gate_m[0]:g} is not below the most {self.gate_m[1]:g}")
        if isinstance(self.ranging, PaperRanging) and self.returns == "strongest-and-last":
            raise ValueError("returns: ranging of type 'paper' knows one return a beam, not 'strongest-and-last'")
        return self

    @property
    def blocks(self) -> int:
        """How many returns of a beam are delivered."""
        return 2 if self.returns == "strongest-and-last" else 1

    @property
    def model(self) -> LidarModel:
        """What an estimator is told about this LIDAR."""
        rows, columns = self.pattern.shape
        return LidarModel(
            rows=self.blocks * rows,
            columns=columns,
            chaser_from_lidar=self.mount.chaser_from_cam,
            range_sigma_m=self.ranging.stated_sigma_m,
            divergence_rad=self.beam.divergence_rad,
            least_range_m=self.gate_m[0],
            most_range_m=self.gate_m[1],
            duration_s=self.pattern.duration_s,
            delay_s=self.delay_s,
        )
