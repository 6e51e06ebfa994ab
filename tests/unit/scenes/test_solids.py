"""Shapes become closed triangle bodies with outward normals, placed where the part says."""

import numpy as np
import pytest
import trimesh
from pydantic import TypeAdapter, ValidationError

from scenes.shapes import Shape
from scenes.solids import Solid, bounding_points, solids
from scenes.target import Part, Target

PAINT = {"type": "paint", "source": "test", "reflectance": 0.5}
SHAPES = {
    "box": ({"type": "box", "size_m": (1.0, 2.0, 3.0)}, 6.0, 22.0),
    "panel": ({"type": "box", "size_m": (0.001, 2.0, 3.0)}, 0.006, 12.01),
    "cylinder": ({"type": "cylinder", "radius_m": 0.5, "height_m": 2.0, "segments": 512}, np.pi / 2, 2.5 * np.pi),
    "sphere": ({"type": "sphere", "radius_m": 2.0, "subdivisions": 5}, 32 / 3 * np.pi, 16 * np.pi),
}


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
    assert mesh.center_mass == pytest.approx([3.0, -1.0, 7.0], abs=1e-9)


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
    assert points.shape == (32, 3)
    for solid, corners in zip(solids(target), points.reshape(4, 8, 3)):
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
