"""Where a target's frame lies among its parts, where they are drawn in other axes."""

from typing import Literal

from pydantic import Field
from scipy.spatial.transform import RigidTransform

from scenes.quaternion import Quaternion, rotation
from scenes.spec import Spec, Vector3, is_empty


class ReferenceFrame(Spec):
    """The target frame against the axes that parts, features and mass are drawn in.

    ``quaternion_wxyz`` = parts_from_target: v_parts = R v_target. ``origin_m``: from the origin of the drawing to that of the
    target frame, its components along the axes of the ``parts`` or of the ``target``. ``applied``: the program writes it once
    parts, features and mass have been taken over into the target frame; what is listed beside it then is in that frame.
    """

    origin_m: Vector3 = (0.0, 0.0, 0.0)
    origin_in: Literal["target", "parts"] = "parts"
    quaternion_wxyz: Quaternion = (1.0, 0.0, 0.0, 0.0)
    applied: bool = Field(default=False, exclude_if=is_empty)

    @property
    def target_from_parts(self) -> RigidTransform:
        """Takes points of the drawing into the target frame."""
        turn = rotation(self.quaternion_wxyz)
        origin = turn.apply(self.origin_m) if self.origin_in == "target" else self.origin_m
        return RigidTransform.from_components(origin, turn).inv()
