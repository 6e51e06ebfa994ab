"""A camera as a person describes it: lens, detector, exposure and where it is mounted."""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.detector import Detector, Exposure
from scenes.intrinsics import Intrinsics
from scenes.recording import SensorModel
from scenes.spec import Fraction, Positive, Spec, Vector3

Pixels = Annotated[int, Field(ge=8, le=16384)]


class Mount(Spec):
    """Where a camera sits on the chaser: ``chaser_from_cam`` as a position and a rotation vector (axis · angle)."""

    position_m: Vector3 = (0.0, 0.0, 0.0)
    rotation_vector_deg: Vector3 = (0.0, 0.0, 0.0)

    @property
    def chaser_from_cam(self) -> RigidTransform:
        """Takes points from camera axes (OpenCV) into chaser axes."""
        rotation = Rotation.from_rotvec(self.rotation_vector_deg, degrees=True)
        return RigidTransform.from_components(self.position_m, rotation)


class Camera(Spec):
    """A lens, a detector behind it, an exposure rule and a mount.

    ``principal_point_px`` counts from the centre of the first pixel; left out, it is the image centre ((W−1)/2, (H−1)/2).
    ``distortion`` = (k1, k2, p1, p2, k3) of Brown-Conrady in OpenCV's order.
    """

    type: Literal["camera"] = "camera"
    description: str = ""
    source: str = ""
    width_px: Pixels
    height_px: Pixels
    pixel_pitch_m: Positive
    focal_length_m: Positive
    f_number: Positive
    transmission: Fraction = 1.0
    principal_point_px: tuple[float, float] | None = None
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    detector: Detector
    exposure: Exposure
    mount: Mount = Mount()

    @model_validator(mode="after")
    def _lens_images_every_pixel(self) -> "Camera":
        lens = self.intrinsics
        if np.isinf(lens.fold_radius):
            return self
        fold_px = lens.pixels_from_normalised([lens.fold_radius * (1 - 1e-9), 0.0])[0] - lens.cx_px
        across = [max(lens.cx_px, self.width_px - 1 - lens.cx_px), max(lens.cy_px, self.height_px - 1 - lens.cy_px)]
        if fold_px < math.hypot(*across):
            raise ValueError(
                f"distortion {self.distortion} folds the image {fold_px:.0f} px from the principal point, "
                f"but the picture's corner lies at {math.hypot(*across):.0f} px"
            )
        return self

    @property
    def intrinsics(self) -> Intrinsics:
        """The camera's calibration, f_px = focal length / pixel pitch."""
        f_px = self.focal_length_m / self.pixel_pitch_m
        centre = self.principal_point_px or ((self.width_px - 1) / 2, (self.height_px - 1) / 2)
        return Intrinsics(self.width_px, self.height_px, f_px, f_px, *centre, self.distortion)

    @property
    def model(self) -> SensorModel:
        """What an estimator is told about this camera."""
        return SensorModel(self.intrinsics, self.detector.black_level_dn, float(self.detector.white_dn))

    @property
    def pixel_solid_etendue_m2_sr(self) -> float:
        """A·Ω·τ of one pixel on the axis: electrons/s = radiance · this, with E = π·L·τ / (4 N²) (the camera equation).

        The 1 in 4N²+1 belongs to lenses focused at infinity with the exact sine condition only; N counts as the working
        f-number here. Vignetting (cos⁴) is left to a flat-field calibration, as cameras deliver it.
        """
        return self.pixel_pitch_m**2 * math.pi * self.transmission / (4 * self.f_number**2)
