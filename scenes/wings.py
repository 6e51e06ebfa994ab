"""A body with two solar wings, the target of Zhai et al. 2014: a description with few numbers that becomes a list of parts."""

from typing import Literal

from scenes.features import RectangleFeature
from scenes.material import Material
from scenes.shapes import Box
from scenes.spec import Positive, Spec
from scenes.target import Part, Target


class CubeWithWings(Spec):
    """A cube with a wing on either side along y; each wing is a thin box in the plane x = 0 on a yoke.

    Features: ``face`` (the cube's +x face), ``wing`` (front of the +y wing) and ``span`` (fronts of both wings as one
    rectangle, its long edges missing where the body stands). All have their normal along +x, length along +y, width along +z.
    """

    type: Literal["cube-with-wings"]
    description: str = ""
    source: str = ""
    body_m: Positive = 3.0
    wing_length_m: Positive = 10.0
    wing_width_m: Positive = 3.0
    wing_thickness_m: Positive = 0.06
    yoke_length_m: Positive = 0.5
    yoke_width_m: Positive = 0.1
    body_material: Material
    wing_material: Material
    yoke_material: Material

    def assembled(self) -> Target:
        """The same target as parts and named features."""
        return Target(
            description=self.description,
            source=self.source,
            parts=(self._body(), *self._wing_with_yoke("+y", 1.0), *self._wing_with_yoke("-y", -1.0)),
            features=(self._face(), self._wing(), self._span()),
            symmetry="none",
        )

    def _body(self) -> Part:
        return Part(name="body", shape=Box(type="box", size_m=(self.body_m,) * 3), material=self.body_material)

    def _wing_with_yoke(self, name: str, side: float) -> tuple[Part, Part]:
        wing = Box(type="box", size_m=(self.wing_thickness_m, self.wing_length_m, self.wing_width_m))
        yoke = Box(type="box", size_m=(self.wing_thickness_m, self.yoke_length_m, self.yoke_width_m))
        root = self.body_m / 2
        yoke_centre, wing_centre = root + self.yoke_length_m / 2, self._wing_centre_m
        return (
            Part(name=f"wing{name}", shape=wing, material=self.wing_material, centre_m=(0, side * wing_centre, 0)),
            Part(name=f"yoke{name}", shape=yoke, material=self.yoke_material, centre_m=(0, side * yoke_centre, 0)),
        )

    @property
    def _wing_centre_m(self) -> float:
        return self.body_m / 2 + self.yoke_length_m + self.wing_length_m / 2

    def _face(self) -> RectangleFeature:
        return RectangleFeature(
            name="face", centre_m=(self.body_m / 2, 0, 0), length_m=self.body_m, width_m=self.body_m, free_standing=False
        )

    def _wing(self) -> RectangleFeature:
        front = (self.wing_thickness_m / 2, self._wing_centre_m, 0)
        return RectangleFeature(
            name="wing", centre_m=front, length_m=self.wing_length_m, width_m=self.wing_width_m, free_standing=True
        )

    def _span(self) -> RectangleFeature:
        half = self._wing_centre_m + self.wing_length_m / 2
        inner = self.body_m / 2 + self.yoke_length_m
        return RectangleFeature(
            name="span",
            centre_m=(self.wing_thickness_m / 2, 0, 0),
            length_m=2 * half,
            width_m=self.wing_width_m,
            gap=(0.5 - inner / (2 * half), 0.5 + inner / (2 * half)),
            free_standing=True,
        )
