"""Takes a target that is drawn in other axes over into its own frame."""

from scipy.spatial.transform import RigidTransform

from scenes.arrays import Floats
from scenes.features import Feature, RectangleFeature
from scenes.inertia import MassProperties
from scenes.spec import Vector3
from scenes.target import Part, Target


def reframed(target: Target) -> Target:
    """The same target with parts, features and mass in the target frame, and its ``reference_frame`` marked as applied."""
    frame = target.reference_frame
    if frame is None or frame.applied:
        return target
    change = frame.target_from_parts
    return target.model_copy(
        update={
            "parts": tuple(_part(part, change) for part in target.parts),
            "features": tuple(_feature(feature, change) for feature in target.features),
            "mass": None if target.mass is None else _mass(target.mass, change),
            "reference_frame": frame.model_copy(update={"applied": True}),
        }
    )


def _part(part: Part, target_from_parts: RigidTransform) -> Part:
    placed = target_from_parts * part.target_from_shape
    turn = _triple(placed.rotation.as_rotvec(degrees=True))
    return part.model_copy(update={"centre_m": _triple(placed.translation), "rotation_vector_deg": turn})


def _feature(feature: Feature, target_from_parts: RigidTransform) -> Feature:
    axes = ("length_axis", "width_axis") if isinstance(feature, RectangleFeature) else ("normal", "x_axis")
    turned = {axis: _triple(target_from_parts.rotation.apply(getattr(feature, axis))) for axis in axes}
    return feature.model_copy(update={"centre_m": _triple(target_from_parts.apply(feature.centre_m)), **turned})


def _mass(mass: MassProperties, target_from_parts: RigidTransform) -> MassProperties:
    placed = target_from_parts * mass.target_from_body
    w, x, y, z = placed.rotation.as_quat(canonical=True, scalar_first=True).tolist()
    return mass.model_copy(update={"centre_of_mass_m": _triple(placed.translation), "quaternion_wxyz": (w, x, y, z)})


def _triple(vector: Floats) -> Vector3:
    x, y, z = vector.tolist()
    return x, y, z
