"""Lights in absolute units. Directions point from the target to the light."""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from scenes.arrays import Floats, frozen
from scenes.constants import SOLAR_CONSTANT_W_M2, SUN_HALF_ANGLE_DEG
from scenes.draw import Direction, PositiveScalar, lowest_of
from scenes.spec import Positive, Spec
from scenes.spectrum import BAND_NM

# ASTM E490-00a spectral irradiance at 1 au in W m-2 um-1, means over 20 nm about each wavelength.
_SUN_NM = np.arange(300.0, 1101.0, 20.0)
_SUN_W_M2_UM = np.array(
    [500, 730, 920, 1013, 1045, 1419, 1695, 1801, 2026, 1970, 1930, 1849, 1877, 1847, 1824, 1771, 1695, 1632, 1544, 1491,
     1415, 1350, 1291, 1235, 1188, 1132, 1089, 1040, 964, 961, 926, 884, 849, 812, 778, 744, 712, 677, 645, 620, 594],
    dtype=np.float64,
)


class Sun(Spec):
    """The sun as a uniform disk.

    ``direction``: unit vector to the sun in ``frame`` axes; ``distance_au`` scales irradiance by the inverse square and the
    disk's angle by the inverse. The spectrum is ASTM E490-00a's.
    """

    type: Literal["sun"] = "sun"
    description: str = ""
    source: str = "ASTM E490-00a"
    frame: Literal["chaser", "target"] = "chaser"
    direction: Direction
    distance_au: PositiveScalar = 1.0
    half_angle_deg: Annotated[float, Field(gt=0, le=20)] = SUN_HALF_ANGLE_DEG
    total_irradiance_w_m2: Positive = SOLAR_CONSTANT_W_M2

    @model_validator(mode="after")
    def _stays_a_disk(self) -> "Sun":
        nearest_au, radius_au = lowest_of(self.distance_au), math.sin(math.radians(self.half_angle_deg))
        if nearest_au <= radius_au:
            raise ValueError(
                f"distance_au reaches down to {nearest_au:g}, inside of the light: "
                f"half_angle_deg {self.half_angle_deg:g} at 1 au makes its radius {radius_au:.6g} au"
            )
        return self

    @property
    def spectral_irradiance_w_m2_nm(self) -> Floats:
        """E(λ) at 1 au on ``BAND_NM``; scaled with ``total_irradiance_w_m2`` over the standard's 1366.1 W/m²."""
        scale = self.total_irradiance_w_m2 / SOLAR_CONSTANT_W_M2
        return frozen(np.interp(BAND_NM, _SUN_NM, _SUN_W_M2_UM) * 1e-3 * scale)


Light = Sun  # a tagged union on `type` as soon as there is a second kind
