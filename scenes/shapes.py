"""Shapes as data; ``scenes.solids`` turns them into triangles. Sizes in metres, centred at the shape's own origin."""

from typing import Annotated, Literal

from pydantic import Field

from scenes.spec import Positive, Spec

PositiveVector3 = tuple[Positive, Positive, Positive]


class Box(Spec):
    """A box with edges ``size_m`` along x, y, z. A thin panel is a box with one small edge."""

    type: Literal["box"]
    size_m: PositiveVector3


class Cylinder(Spec):
    """A closed cylinder about z."""

    type: Literal["cylinder"]
    radius_m: Positive
    height_m: Positive
    segments: Annotated[int, Field(ge=3, le=4096)] = 64


class Sphere(Spec):
    """A sphere as a refined icosahedron."""

    type: Literal["sphere"]
    radius_m: Positive
    subdivisions: Annotated[int, Field(ge=0, le=7)] = 4


class MeshFile(Spec):
    """A mesh from a file beside the scenario (STL, OBJ, PLY, GLB...); ``scale`` takes the file's unit to metres."""

    type: Literal["mesh"]
    path: str
    scale: Positive = 1.0


Shape = Annotated[Box | Cylinder | Sphere | MeshFile, Field(discriminator="type")]
