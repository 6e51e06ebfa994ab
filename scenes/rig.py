"""A stereo rig as a person describes it: one kind of camera twice, a baseline and a toe-in.

Rig axes are a forward camera's (x right, y down, z forward) with their origin halfway along the baseline, which lies along x.
"""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.arrays import Floats, frozen
from scenes.camera import Camera, Mount
from scenes.spec import Positive, Spec

LEFT, RIGHT = "left", "right"
_SIGN = {LEFT: 1.0, RIGHT: -1.0}


class StereoRig(Spec):
    """Two equal cameras side by side, each turned inwards by ``toe_in_deg`` (negative: outwards).

    ``camera.mount`` has to stay empty, as the rig places its cameras; ``mount`` places the rig on the chaser.
    """

    type: Literal["stereo"] = "stereo"
    description: str = ""
    source: str = ""
    baseline_m: Positive
    toe_in_deg: Annotated[float, Field(gt=-90, lt=90)] = 0.0
    camera: Camera
    mount: Mount = Mount()

    @model_validator(mode="after")
    def _is_a_pair(self) -> "StereoRig":
        if self.camera.mount != Mount():
            raise ValueError("camera.mount must be left out: baseline_m, toe_in_deg and the rig's own mount place its cameras")
        half_field_deg = _half_field_deg(self.camera)
        if self.toe_in_deg <= -half_field_deg:
            raise ValueError(
                f"toe_in_deg {self.toe_in_deg:g} turns the cameras outwards by more than half their field of view, "
                f"{half_field_deg:.1f} deg: their views do not overlap anywhere"
            )
        return self

    def sensors(self, name: str) -> dict[str, Camera]:
        """Both cameras with their mounts, called ``<name>-left`` and ``<name>-right``."""
        return {f"{name}-{side}": self._placed(side) for side in (LEFT, RIGHT)}

    @property
    def right_from_left(self) -> RigidTransform:
        """Takes points from the left camera's axes into the right one's."""
        return self.rig_from_cam(RIGHT).inv() * self.rig_from_cam(LEFT)

    @property
    def fundamental_matrix(self) -> Floats:
        """F (3, 3), p_rightᵀ F p_left = 0 for ideal (undistorted) homogeneous pixels: K⁻ᵀ [t]× R K⁻¹, unit Frobenius norm.

        Hartley & Zisserman, Multiple View Geometry, eq. (9.12).
        """
        right_from_left, inverse = self.right_from_left, np.linalg.inv(self.camera.intrinsics.matrix)
        x, y, z = right_from_left.translation
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        matrix = inverse.T @ cross @ right_from_left.rotation.as_matrix() @ inverse
        return frozen(matrix / np.linalg.norm(matrix))

    def rig_from_cam(self, side: str) -> RigidTransform:
        """Where one camera sits in the rig: half a baseline aside, turned inwards about the rig's y axis."""
        sign = _SIGN[side]
        rotation = Rotation.from_rotvec([0.0, sign * self.toe_in_deg, 0.0], degrees=True)
        return RigidTransform.from_components([-sign * self.baseline_m / 2, 0.0, 0.0], rotation)

    def _placed(self, side: str) -> Camera:
        chaser_from_cam = self.mount.chaser_from_cam * self.rig_from_cam(side)
        x, y, z = chaser_from_cam.translation.tolist()
        a, b, c = chaser_from_cam.rotation.as_rotvec(degrees=True).tolist()
        return self.camera.model_copy(update={"mount": Mount(position_m=(x, y, z), rotation_vector_deg=(a, b, c))})


def _half_field_deg(camera: Camera) -> float:
    """Half the horizontal field of view on the wider side of the principal point."""
    lens = camera.intrinsics
    ends = lens.normalised_from_pixels([[-0.5, lens.cy_px], [lens.width_px - 0.5, lens.cy_px]])[:, 0]
    return math.degrees(math.atan(float(np.abs(ends).max())))
