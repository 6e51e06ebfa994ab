"""Shapes become closed triangle bodies with outward normals, placed where the part says."""

import numpy as np
import pytest
import trimesh
from pydantic import TypeAdapter, ValidationError
from scipy.spatial.transform import Rotation

from scenes.shapes import Shape
from scenes.solids import Solid, bounding_points, solids
from scenes.target import Part, Target

PAINT = {"type": "paint", "source": "test", "reflectance": 0.5}
SHAPES = {
    "box": ({"type": "box", "size_m": (1.0, 2.0, 3.0)}, 6.0, 22.0),
    "panel": ({"type": "box", "size_m": (0.001, 2.0, 3.0)}, 0.006, 12.01),
    "cylinder": ({"type": "cylinder", "radius_m": 0.5, "height_m": 2.0, "segments": 512}, np.pi / 2, 2.5 * np.pi),
    "sphere": ({"type": "sphere", "radius_m": 2.0, "subdivisions": 5}, 32 / 3 * np.pi, 16 * np.pi),
    "tube": ({"type": "tube", "inner_radius_m": 1.0, "outer_radius_m": 2.0, "height_m": 0.5}, 1.5 * np.pi, 9 * np.pi),
    # A wall of 0.1 across z on a frustum of outer radii 1 and 2, height 3; slanted areas are pi (r1 + r2) sqrt(h^2 + dr^2).
    "cone": (
        {"type": "cone", "base_radius_m": 1.0, "top_radius_m": 2.0, "height_m": 3.0, "wall_m": 0.1, "segments": 512},
        np.pi * (7.0 - (0.9**2 + 0.9 * 1.9 + 1.9**2)),
        np.pi * ((3.0 + 2.8) * np.sqrt(10.0) + (1.0 - 0.81) + (4.0 - 3.61)),
    ),
    # Two paraboloids z = r^2 / 2 out to r = 1, each of area 2 pi (2 sqrt 2 - 1) / 3, and a rim of 0.1.
    "dish": (
        {"type": "dish", "radius_m": 1.0, "focal_length_m": 0.5, "wall_m": 0.1, "segments": 512},
        0.1 * np.pi,
        4 * np.pi * (2 * np.sqrt(2.0) - 1) / 3 + 0.2 * np.pi,
    ),
    # A cone of radius 2 and height 3 as a profile that runs clockwise.
    "lathe": (
        {"type": "lathe", "profile_m": ((0, 0), (0, 3), (2, 0)), "segments": 512},
        4 * np.pi,
        np.pi * (4 + 2 * np.sqrt(13.0)),
    ),
}
# Height of the middle of mass above the shape's own origin, by integration; 0 for all others.
MIDDLE_M = {"cone": 0.15 / 0.87, "dish": 0.2, "lathe": 0.75}


def _part(shape: dict, name: str = "part", **placement) -> Part:
    return Part.model_validate({"name": name, "shape": shape, "material": PAINT} | placement)


def _solid(shape: dict, **placement) -> Solid:
    return solids(Target(parts=(_part(shape, **placement),)))[0]


@pytest.mark.parametrize("name", SHAPES)
def test_shapes_are_closed_and_turned_outwards(name: str):
    shape, volume, area = SHAPES[name]
    solid = _solid(shape, centre_m=(3.0, -1.0, 7.0), rotation_vector_deg=(20.0, 50.0, -70.0))
    mesh = trimesh.Trimesh(solid.vertices_target, solid.faces, process=False)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(volume, rel=2e-3)  # positive: by the right-hand rule normals point outwards
    assert mesh.area == pytest.approx(area, rel=2e-3)
    axis = Rotation.from_rotvec((20.0, 50.0, -70.0), degrees=True).apply([0.0, 0.0, 1.0])
    assert mesh.center_mass == pytest.approx(np.array([3.0, -1.0, 7.0]) + MIDDLE_M.get(name, 0.0) * axis, abs=2e-4)


def test_placement_turns_then_moves():
    solid = _solid({"type": "box", "size_m": (2.0, 0.2, 0.2)}, centre_m=(10.0, 0.0, 0.0), rotation_vector_deg=(0.0, 0.0, 90.0))
    low, high = solid.vertices_target.min(axis=0), solid.vertices_target.max(axis=0)
    assert low == pytest.approx([9.9, -1.0, -0.1])
    assert high == pytest.approx([10.1, 1.0, 0.1])


def test_bounding_points_enclose_every_vertex():
    parts = [
        _part(shape, name, centre_m=(index, 0.0, 2.0 * index), rotation_vector_deg=(30, 10 * index, 5))
        for index, (name, (shape, *_)) in enumerate(SHAPES.items())
    ]
    target = Target(parts=tuple(parts))
    points = bounding_points(target)
    assert points.shape == (8 * len(SHAPES), 3)
    for solid, corners in zip(solids(target), points.reshape(-1, 8, 3)):
        assert (solid.vertices_target >= corners.min(axis=0) - 1e-12).all()
        assert (solid.vertices_target <= corners.max(axis=0) + 1e-12).all()
        assert len(np.unique(corners, axis=0)) == 8


def test_arrays_cannot_be_changed():
    solid = _solid({"type": "box", "size_m": (1.0, 1.0, 1.0)})
    for array in (solid.vertices_target, solid.faces):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_a_mesh_file_is_scaled_to_metres(tmp_path):
    path = tmp_path / "dish.stl"
    trimesh.creation.box(extents=(100.0, 200.0, 300.0)).export(path)
    solid = _solid({"type": "mesh", "path": str(path), "scale": 0.01})
    assert np.ptp(solid.vertices_target, axis=0) == pytest.approx([1.0, 2.0, 3.0])


@pytest.mark.parametrize(
    "tree",
    [
        {"type": "box", "size_m": (1.0, 0.0, 1.0)},
        {"type": "box", "size_m": (1.0, -1.0, 1.0)},
        {"type": "box", "size_m": (1.0, 1.0)},
        {"type": "box", "size_m": (1.0, 1.0, float("nan"))},
        {"type": "cylinder", "radius_m": 1.0, "height_m": 1.0, "segments": 2},
        {"type": "sphere", "radius_m": 0.0},
        {"type": "sphere", "radius_m": 1.0, "subdivisions": 8},
        {"type": "mesh", "path": "x.stl", "scale": 0.0},
        {"type": "cone", "radius_m": 1.0},
        {"type": "cone", "base_radius_m": 0.1, "top_radius_m": 1.0, "height_m": 1.0, "wall_m": 0.1},
        {"type": "tube", "inner_radius_m": 0.6, "outer_radius_m": 0.6, "height_m": 0.1},
        {"type": "dish", "radius_m": 1.0, "focal_length_m": 0.0},
        {"type": "lathe", "profile_m": ((0, 0), (1, 0))},
        {"type": "lathe", "profile_m": ((0, 0), (1, 1), (2, 2))},
        {"type": "lathe", "profile_m": ((0, 0), (1, 0), (0, 1), (0, 0))},
        {"type": "lathe", "profile_m": ((-0.1, 0), (1, 0), (0, 1))},
        {"type": "box", "size_m": (1.0, 1.0, 1.0), "colour": "red"},
    ],
)
def test_impossible_shapes_are_refused(tree: dict):
    with pytest.raises(ValidationError):
        TypeAdapter(Shape).validate_python(tree)


def test_two_parts_of_one_name_are_refused():
    part = _part({"type": "box", "size_m": (1.0, 1.0, 1.0)}, "box")
    with pytest.raises(ValidationError, match="two parts are called 'box'"):
        Target(parts=(part, part))
    with pytest.raises(ValidationError):
        Target(parts=())
