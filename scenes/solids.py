"""Triangles of a target's parts, in the target's frame."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.arrays import Floats, frozen
from scenes.assets import load_mesh
from scenes.crinkle import crinkled_box
from scenes.lathe import revolved
from scenes.rubble import rubble
from scenes.shapes import Box, CrinkledBox, Cylinder, MeshFile, Revolved, Rubble, Shape, Sphere
from scenes.target import Part, Target


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A part's triangles: ``vertices_target`` (n, 3) metres, ``faces`` (m, 3) with outward normals by the right-hand rule."""

    name: str
    vertices_target: Floats
    faces: NDArray[np.int64]


def solids(target: Target) -> tuple[Solid, ...]:
    """One solid per part, in the parts' order."""
    return tuple(_solid(part) for part in target.parts)


def bounding_points(target: Target) -> Floats:
    """The corners of each part's own bounding box, (8 · parts, 3), target frame: they enclose the target."""
    corners = [_box_corners(solid.vertices_target) for solid in solids(target)]
    return frozen(np.concatenate(corners))


def _solid(part: Part) -> Solid:
    vertices, faces = _triangles(part.shape)
    return Solid(part.name, frozen(part.target_from_shape.apply(vertices)), frozen(faces, np.int64))


def _triangles(shape: Shape) -> tuple[Any, Any]:
    if isinstance(shape, MeshFile):
        mesh_file = load_mesh(Path(shape.path), shape.scale)
        return mesh_file.vertices_m, mesh_file.faces
    if isinstance(shape, CrinkledBox):
        return crinkled_box(shape)
    if isinstance(shape, Revolved):
        return revolved(shape)
    if isinstance(shape, Rubble):
        return rubble(shape)
    mesh = _from_trimesh(shape)
    return mesh.vertices, mesh.faces


def _from_trimesh(shape: Box | Cylinder | Sphere) -> Any:
    from trimesh import creation

    if isinstance(shape, Box):
        return creation.box(extents=shape.size_m)
    if isinstance(shape, Cylinder):
        return creation.cylinder(radius=shape.radius_m, height=shape.height_m, sections=shape.segments)
    return creation.icosphere(subdivisions=shape.subdivisions, radius=shape.radius_m)


def _box_corners(points: Floats) -> Floats:
    low, high = points.min(axis=0), points.max(axis=0)
    choice = np.array(np.meshgrid(*[[0, 1]] * 3)).reshape(3, -1).T
    return np.asarray(np.where(choice, high, low))
