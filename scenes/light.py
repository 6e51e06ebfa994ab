"""Lights in absolute units: those of space here, those of a laboratory in ``scenes.lamp``.

Directions point from the target to the light.
"""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from scenes.arrays import Floats, frozen
from scenes.constants import EARTH_RADIUS_M, SOLAR_CONSTANT_W_M2, SUN_HALF_ANGLE_DEG
from scenes.draw import Direction, PositiveScalar, lowest_of
from scenes.lamp import Frame, HalogenLamp, LightPanels
from scenes.spec import Positive, Spec, kind_of
from scenes.spectrum import BAND_NM, FractionQuantity, on_band, sends_light

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
    frame: Frame = "chaser"
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
    def spectrum(self) -> Floats:
        """E(λ) at 1 au on ``BAND_NM``; scaled with ``total_irradiance_w_m2`` over the standard's 1366.1 W/m²."""
        return frozen(_sun_w_m2_nm() * self.total_irradiance_w_m2 / SOLAR_CONSTANT_W_M2)


class Earthshine(Spec):
    """Sunlight from the Earth below: a uniform Lambertian disk, as large as the Earth looks from ``altitude_m``.

    ``direction``: to the Earth's centre in ``frame`` axes. ``albedo``: of the ground and clouds (0.3 is the mean of the Earth,
    a cloud deck has 0.7). ``sun_zenith_deg``: how far from overhead the sun stands where the Earth is seen; its radiance is
    albedo · E_sun · cos(zenith) / π everywhere. Limb, ocean glint and terminator are left out.
    """

    type: Literal["earthshine"]
    description: str = ""
    source: str = "ASTM E490-00a sun on a Lambertian Earth"
    frame: Frame = "chaser"
    direction: Direction
    altitude_m: Positive = 500e3
    albedo: Annotated[FractionQuantity, AfterValidator(sends_light)] = 0.3
    sun_zenith_deg: Annotated[float, Field(ge=0, lt=90)] = 0.0

    @property
    def half_angle_rad(self) -> float:
        """Half the angle under which the Earth is seen: asin(R / (R + h))."""
        return math.asin(EARTH_RADIUS_M / (EARTH_RADIUS_M + self.altitude_m))

    @property
    def spectrum(self) -> Floats:
        """Irradiance on ``BAND_NM`` of a surface that faces the Earth: π L sin²α, L = albedo · E_sun · cos(zenith) / π."""
        sunlit = on_band(self.albedo) * _sun_w_m2_nm() * math.cos(math.radians(self.sun_zenith_deg))
        return frozen(sunlit * math.sin(self.half_angle_rad) ** 2)


def _sun_w_m2_nm() -> Floats:
    return np.asarray(np.interp(BAND_NM, _SUN_NM, _SUN_W_M2_UM) * 1e-3)


Light = Annotated[
    Annotated[Sun, Tag("sun")]
    | Annotated[Earthshine, Tag("earthshine")]
    | Annotated[HalogenLamp, Tag("halogen")]
    | Annotated[LightPanels, Tag("panels")],
    Discriminator(kind_of("sun")),
]
