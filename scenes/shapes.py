"""Shapes as data; ``scenes.solids`` turns them into triangles. Sizes in metres, centred at the shape's own origin.

Every shape is a closed body. Facets are flat: a crease is a crease, and a round body is as round as its ``segments``.
"""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from scenes.spec import NonNegative, Positive, Spec

PositiveVector3 = tuple[Positive, Positive, Positive]
Segments = Annotated[int, Field(ge=3, le=4096)]
_MOST_TRIANGLES = 2_000_000


class Box(Spec):
    """A box with edges ``size_m`` along x, y, z. A thin panel is a box with one small edge."""

    type: Literal["box"]
    size_m: PositiveVector3


class CrinkledBox(Spec):
    """A box wrapped in crinkled foil: faces of flat facets that lie around the planes of a box with edges ``size_m``.

    Two scales of relief, both drawn from ``seed``: ``relief_m`` from lowest to highest over cells of about ``cell_m`` (how the
    blanket bulges), ``fine_relief_m`` over facets of about ``facet_m`` (how the foil crinkles). The mean of a face is its plane.
    """

    type: Literal["crinkled-box"]
    size_m: PositiveVector3
    relief_m: NonNegative = 0.012
    cell_m: Positive = 0.1
    fine_relief_m: NonNegative = 0.003
    facet_m: Positive = 0.025
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0

    @model_validator(mode="after")
    def _does_not_fold_over(self) -> "CrinkledBox":
        if self.facet_m > min(self.size_m) or self.facet_m > self.cell_m:
            raise ValueError(f"facet_m {self.facet_m:g} must not exceed cell_m {self.cell_m:g} nor an edge of size_m {self.size_m}")
        relief_m = self.relief_m + self.fine_relief_m
        if relief_m > self.facet_m:
            raise ValueError(
                f"relief_m + fine_relief_m is {relief_m:g}: more than facet_m {self.facet_m:g}, the foil would fold over"
            )
        x, y, z = self.size_m
        triangles = 4 * (x * y + y * z + z * x) / self.facet_m**2
        if triangles > _MOST_TRIANGLES:
            raise ValueError(f"facet_m {self.facet_m:g} makes {triangles:.2g} triangles, at most {_MOST_TRIANGLES:.0e} are made")
        return self


class Cylinder(Spec):
    """A closed cylinder about z."""

    type: Literal["cylinder"]
    radius_m: Positive
    height_m: Positive
    segments: Segments = 64


class Tube(Spec):
    """A ring about z: a cylinder with a bore. Its origin is on the axis at half its height."""

    type: Literal["tube"]
    inner_radius_m: Positive
    outer_radius_m: Positive
    height_m: Positive
    segments: Segments = 512

    @model_validator(mode="after")
    def _has_a_wall(self) -> "Tube":
        if self.inner_radius_m >= self.outer_radius_m:
            raise ValueError(f"inner_radius_m {self.inner_radius_m:g} must be smaller than outer_radius_m {self.outer_radius_m:g}")
        return self


class Cone(Spec):
    """The wall of a frustum about z, open at both ends: a conical nozzle. Its origin is on the axis at half its height.

    ``base_radius_m`` (at −z) and ``top_radius_m`` (at +z) are outer radii, ``wall_m`` is the wall's thickness across z.
    """

    type: Literal["cone"]
    base_radius_m: Positive
    top_radius_m: Positive
    height_m: Positive
    wall_m: Positive = 0.002
    segments: Segments = 256

    @model_validator(mode="after")
    def _has_a_bore(self) -> "Cone":
        narrowest_m = min(self.base_radius_m, self.top_radius_m)
        if self.wall_m >= narrowest_m:
            raise ValueError(f"wall_m {self.wall_m:g} must be smaller than the narrow end's radius {narrowest_m:g}")
        return self


class Dish(Spec):
    """A paraboloid shell about z, hollow towards +z: z = r² / (4 ``focal_length_m``) out to ``radius_m``.

    Its origin is the vertex of the hollow side; the back lies ``wall_m`` lower everywhere.
    """

    type: Literal["dish"]
    radius_m: Positive
    focal_length_m: Positive
    wall_m: Positive = 0.002
    segments: Segments = 128


class Lathe(Spec):
    """A body of revolution about z. ``profile_m``: corners (r, z) of its half section, either way round, closed by itself."""

    type: Literal["lathe"]
    profile_m: Annotated[tuple[tuple[NonNegative, float], ...], Field(min_length=3, max_length=1024)]
    segments: Segments = 256

    @model_validator(mode="after")
    def _encloses_an_area(self) -> "Lathe":
        following = (*self.profile_m[1:], self.profile_m[0])
        if any(a == b for a, b in zip(self.profile_m, following)):
            raise ValueError("profile_m names a corner twice in a row (it closes by itself)")
        if sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(self.profile_m, following)) == 0:
            raise ValueError("profile_m encloses no area")
        return self


class Sphere(Spec):
    """A sphere as a refined icosahedron."""

    type: Literal["sphere"]
    radius_m: Positive
    subdivisions: Annotated[int, Field(ge=0, le=7)] = 4


class Rubble(Spec):
    """A lump of rock: an ellipsoid with axes ``size_m``, its surface moved along the radii as ``seed`` draws it.

    ``relief``: rms of the logarithm of the radius, over lumps of all sizes down to a ``2**octaves``-th of the body.
    """

    type: Literal["rubble"]
    size_m: PositiveVector3
    relief: Annotated[float, Field(ge=0, le=0.5)] = 0.1
    octaves: Annotated[int, Field(ge=1, le=6)] = 4
    subdivisions: Annotated[int, Field(ge=2, le=7)] = 5
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0


class MeshFile(Spec):
    """A mesh from a file beside the scenario (STL, OBJ, PLY, GLB...); ``scale`` takes the file's unit to metres."""

    type: Literal["mesh"]
    path: str
    scale: Positive = 1.0


Revolved = Tube | Cone | Dish | Lathe
Shape = Annotated[
    Box | CrinkledBox | Cylinder | Tube | Cone | Dish | Lathe | Sphere | Rubble | MeshFile, Field(discriminator="type")
]
