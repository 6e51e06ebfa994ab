"""A target: parts (shape × material × placement) and the named features that estimators may be told about."""

from collections import Counter
from typing import Annotated, Literal

from pydantic import Field, model_validator
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.features import Feature
from scenes.inertia import MassProperties
from scenes.material import Material
from scenes.reference_frame import ReferenceFrame
from scenes.shapes import Shape
from scenes.spec import Spec, Vector3, is_empty

# Rotation groups under which a target looks the same; the judge takes the best element, one for a whole track.
SymmetryGroup = Literal["none", "c2-x", "c2-y", "c2-z", "c4-x", "c4-y", "c4-z", "d2", "octahedral"]


class Part(Spec):
    """One solid of one material, placed in the target frame: p_target = rotation · p_shape + centre_m."""

    name: str
    shape: Shape
    material: Material
    centre_m: Vector3 = (0.0, 0.0, 0.0)
    rotation_vector_deg: Vector3 = (0.0, 0.0, 0.0)

    @property
    def target_from_shape(self) -> RigidTransform:
        """Placement of the shape in the target frame."""
        return RigidTransform.from_components(self.centre_m, Rotation.from_rotvec(self.rotation_vector_deg, degrees=True))


class Target(Spec):
    """A spacecraft or another body as a list of parts. Its frame is the frame of every pose in this project.

    ``mass``: where the target falls freely. ``reference_frame``: where the target frame lies, if the rest is drawn in other axes.
    """

    type: Literal["assembly"] = "assembly"
    description: str = ""
    source: str = ""
    parts: Annotated[tuple[Part, ...], Field(min_length=1, max_length=4096)]
    features: tuple[Feature, ...] = ()
    symmetry: SymmetryGroup = "none"
    mass: MassProperties | None = Field(default=None, exclude_if=is_empty)
    reference_frame: ReferenceFrame | None = Field(default=None, exclude_if=is_empty)

    @model_validator(mode="after")
    def _names_are_unique(self) -> "Target":
        for kind, named in (("part", self.parts), ("feature", self.features)):
            twice = [name for name, count in Counter(one.name for one in named).items() if count > 1]
            if twice:
                raise ValueError(f"two {kind}s are called {twice[0]!r}")
        return self
