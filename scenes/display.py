"""A screen that shows the target to a camera: the ground test of Zhai et al. 2014, section 2.

Two pictures in a row. A virtual camera draws the target as plain computer graphics do, one value a dot; the screen shines with
these values, and the real camera films the screen. The virtual camera looks out of the real camera's place along its axis, so
that, at ``true_distance_m`` and without tilt or offset, each displayed point is seen where the target's point would be. The
truth of such a data set is the virtual target's pose; what the screen's place and dots change about the picture is an error of
the test stand, which the truth does not follow.
"""

import math
from typing import Annotated, Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import AfterValidator, Field, model_validator
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.arrays import Floats, frozen
from scenes.luminosity import lumens_per_watt
from scenes.spec import Fraction, Positive, Spec, Vector3
from scenes.spectrum import NonNegativeQuantity, band_irradiance, on_band, sends_light

Dots = Annotated[int, Field(ge=8, le=16384)]
_LARGEST_TILT_COS = 0.1


class Display(Spec):
    """A flat screen of square dots, ``dots`` = (columns, rows), one grey value each, Lambertian.

    ``field_deg``: horizontal field of the picture that spans ``field_dots`` of its dots; so the picture's focal length is
    ``field_dots`` / (2 tan(field/2)) dots. ``distance_m``: from the camera to the screen's middle along the optical axis, left
    out: ``true_distance_m``. ``offset_m``: of that middle to the right and down. ``tilt_deg``: rotation vector in camera axes
    that turns the screen about its middle (+x: its top comes nearer, +y: its right, +z: clockwise as the camera sees it).
    ``fill_factor``: share of a dot's area that shines, a square in its middle; the rest is a black grid.

    White has ``luminance_cd_m2`` or, in its place, ``radiance_w_m2_sr`` (300 to 1100 nm), as a mean over dot and grid, in
    the colour ``relative_spectrum``; black is ``contrast`` times darker. Of ``bits`` each, levels shine as level^``gamma``.
    With ``gamma_encoded`` the picture is drawn for that, and shines in proportion to what was drawn; without, levels are what
    was drawn, and grey comes out too dark.

    Drawn is grey · (``ambient`` + (1 − ``ambient``) · cos of the light's incidence), without shadows of one part on another
    unless ``cast_shadows``; empty space is ``background``. ``anti_aliasing``: how many samples of a dot are averaged, spread
    over its area; 1: its centre alone.
    """

    type: Literal["display"] = "display"
    description: str = ""
    source: str = ""
    dots: tuple[Dots, Dots]
    pitch_m: Positive
    field_deg: Annotated[float, Field(gt=0, lt=170)]
    field_dots: Positive
    distance_m: Positive | None = None
    offset_m: tuple[float, float] = (0.0, 0.0)
    tilt_deg: Vector3 = (0.0, 0.0, 0.0)
    fill_factor: Annotated[float, Field(gt=0, le=1)] = 1.0
    luminance_cd_m2: Positive | None = None
    radiance_w_m2_sr: Positive | None = None
    relative_spectrum: Annotated[NonNegativeQuantity, AfterValidator(sends_light)]
    contrast: Annotated[float, Field(gt=1)] = 1000.0
    bits: Annotated[int, Field(ge=1, le=16)] = 8
    gamma: Annotated[float, Field(ge=0.2, le=5)] = 2.2
    gamma_encoded: bool = True
    ambient: Fraction = 0.1
    background: Fraction = 0.0
    cast_shadows: bool = False
    anti_aliasing: Literal[1, 2, 4, 8, 16, 32, 64, 128, 256] = 1

    @model_validator(mode="after")
    def _shines_and_faces_the_camera(self) -> "Display":
        if (self.luminance_cd_m2 is None) == (self.radiance_w_m2_sr is None):
            both = f"{self.luminance_cd_m2} and {self.radiance_w_m2_sr}"
            raise ValueError(f"give luminance_cd_m2 or radiance_w_m2_sr, one of them, not {both}")
        if self.luminance_cd_m2 is not None and lumens_per_watt(on_band(self.relative_spectrum)) == 0:
            raise ValueError("luminance_cd_m2: nobody sees a light of this relative_spectrum; give radiance_w_m2_sr")
        cosine = self.cam_from_screen.rotation.as_matrix()[2, 2]
        if cosine < _LARGEST_TILT_COS:
            off_deg = math.degrees(math.acos(cosine))
            raise ValueError(f"tilt_deg {self.tilt_deg} turns the screen by {off_deg:.0f} deg off the camera")
        return self

    @property
    def focal_dots(self) -> float:
        """Focal length of the picture, in dots: one over the tangent of the angle that a dot is to subtend."""
        return self.field_dots / (2 * math.tan(math.radians(self.field_deg) / 2))

    @property
    def true_distance_m(self) -> float:
        """Where the picture subtends the angles that it shows: d = S · r / (2 tan(field/2)), the paper's d with S = S_H − 30."""
        return self.focal_dots * self.pitch_m

    @property
    def cam_from_screen(self) -> RigidTransform:
        """Takes points on the screen (x along a row to the right, y down, z away from the camera, origin in its middle)."""
        distance_m = self.true_distance_m if self.distance_m is None else self.distance_m
        return RigidTransform.from_components((*self.offset_m, distance_m), Rotation.from_rotvec(self.tilt_deg, degrees=True))

    @property
    def white_w_m2_sr(self) -> float:
        """Radiance of white in the band, mean over a dot and its share of the grid."""
        if self.radiance_w_m2_sr is not None:
            return self.radiance_w_m2_sr
        assert self.luminance_cd_m2 is not None  # see _shines_and_faces_the_camera
        return self.luminance_cd_m2 / lumens_per_watt(on_band(self.relative_spectrum))

    @property
    def spectrum(self) -> Floats:
        """Spectral radiance of white on ``BAND_NM``, W m⁻² sr⁻¹ nm⁻¹."""
        shape = on_band(self.relative_spectrum)
        return frozen(shape * (self.white_w_m2_sr / band_irradiance(shape)))

    def levels(self, drawn: ArrayLike) -> Floats:
        """Whole numbers, 0 to 2^bits − 1, for values as ``drawn``, 0 to 1; what lies beyond is cut."""
        value = np.clip(np.asarray(drawn, dtype=np.float64), 0.0, 1.0)
        encoded = value ** (1 / self.gamma) if self.gamma_encoded else value
        return np.asarray(np.floor(encoded * (2**self.bits - 1) + 0.5))

    def radiance(self, levels: ArrayLike) -> Floats:
        """What dots of these levels shine, W m⁻² sr⁻¹ in the band, mean over a dot and its share of the grid."""
        share = (np.asarray(levels, dtype=np.float64) / (2**self.bits - 1)) ** self.gamma
        return np.asarray(self.white_w_m2_sr * (1 / self.contrast + (1 - 1 / self.contrast) * share))

    def places_from_sight(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Where rays (x, y, 1), camera axes, meet the screen's plane: column and row as numbers, whole in a dot's middle.

        NaN for rays that do not meet it before the camera. Ray t·d, plane n·(t·d − c) = 0: t = n·c / n·d.
        """
        right, down, away = self.cam_from_screen.rotation.as_matrix().T
        middle = self.cam_from_screen.translation
        slope = away[0] * x + away[1] * y + away[2]
        reach = (away @ middle / self.pitch_m) / np.where(slope > 0, slope, np.nan)
        column, row = (
            reach * (axis[0] * x + axis[1] * y + axis[2]) + ((count - 1) / 2 - axis @ middle / self.pitch_m)
            for axis, count in zip((right, down), self.dots)
        )
        return np.asarray(column), np.asarray(row)
