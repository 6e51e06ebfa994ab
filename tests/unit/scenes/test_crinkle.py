"""Crinkled foil: a closed body about the planes of its box, as rough as it says, the same for the same seed."""

import numpy as np
import pytest
import trimesh
from pydantic import ValidationError

from scenes.crinkle import crinkled_box
from scenes.shapes import CrinkledBox

SIZE_M = (1.56, 1.56, 1.2)


def _box(**changes) -> CrinkledBox:
    return CrinkledBox.model_validate({"type": "crinkled-box", "size_m": SIZE_M} | changes)


def _mesh(shape: CrinkledBox) -> trimesh.Trimesh:
    return trimesh.Trimesh(*crinkled_box(shape), process=False)


def _front(shape: CrinkledBox) -> np.ndarray:
    """Heights (n,) of the vertices inside the +z face above its plane."""
    vertices, _ = crinkled_box(shape)
    x, y, z = np.array(shape.size_m) / 2
    inside = (np.abs(vertices[:, 0]) < x - 0.02) & (np.abs(vertices[:, 1]) < y - 0.02) & (vertices[:, 2] > z - 0.05)
    return vertices[inside, 2] - z


@pytest.mark.parametrize("size_m", [SIZE_M, (0.3, 0.2, 0.1), (1.5, 0.03, 0.7), (0.025, 0.025, 0.025)])
@pytest.mark.parametrize("seed", [0, 1, 2**40])
def test_it_is_closed_and_turned_outwards(size_m, seed: int):
    mesh = _mesh(_box(size_m=size_m, seed=seed))
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.euler_number == 2  # one sphere-like skin
    assert len(mesh.vertices) == len(np.unique(mesh.faces))
    assert mesh.volume == pytest.approx(np.prod(size_m), abs=mesh.area * 0.0075 / 2)
    assert mesh.area_faces.min() > 1e-5  # no slivers: a quarter of a facet of 25 mm has 8e-5 m2


def test_no_facet_folds_over():
    """Every facet looks out of its own face, and the relief tilts it by as much as foil is tilted."""
    shape = _box()
    mesh = _mesh(shape)
    outward = np.abs(mesh.triangles_center) / (np.array(SIZE_M) / 2)
    axis = outward.argmax(axis=1)
    rows = np.arange(len(axis))
    cosine = mesh.face_normals[rows, axis] * np.sign(mesh.triangles_center[rows, axis])
    at_rim = np.sort(outward, axis=1)[:, 1] > 0.96  # there the argmax may name the other face
    tilt_deg = np.degrees(np.arccos(np.clip(cosine[~at_rim], -1, 1)))
    assert tilt_deg.max() < 45.0
    assert 4.0 < np.median(tilt_deg) < 10.0
    assert (np.abs(mesh.face_normals).max(axis=1) > 0.6).all()


def test_the_default_body_has_about_fifty_thousand_triangles():
    assert 35_000 < len(crinkled_box(_box())[1]) < 55_000
    assert 35_000 < len(crinkled_box(_box(size_m=(1.56, 1.56, 1.56)))[1]) < 55_000


def test_relief_lies_about_the_plane_within_its_bounds():
    heights = _front(_box())
    assert len(heights) > 3000
    assert abs(heights.mean()) < 6 * 0.012 / np.sqrt(12 * 15 * 15)  # some 15 x 15 cells, each uniform
    assert np.abs(heights).max() <= (0.012 + 0.003) / 2
    assert np.ptp(heights) > 0.012


def test_each_scale_has_its_own_height():
    """A uniform height of range h has a standard deviation of h / sqrt(12); between cells it is interpolated, so lower."""
    fine, coarse = _front(_box(relief_m=0.0)), _front(_box(fine_relief_m=0.0))
    assert fine.std() == pytest.approx(0.003 / np.sqrt(12), rel=0.05)
    assert 0.4 * 0.012 / np.sqrt(12) < coarse.std() < 0.9 * 0.012 / np.sqrt(12)
    assert _front(_box()).std() == pytest.approx(np.hypot(fine.std(), coarse.std()), rel=0.05)
    assert np.ptp(_front(_box(relief_m=0.0, fine_relief_m=0.0))) < 1e-15


def test_finer_facets_are_more():
    coarse, fine = (len(crinkled_box(_box(facet_m=facet_m))[1]) for facet_m in (0.06, 0.03))
    assert fine / coarse == pytest.approx(4.0, rel=0.1)


def test_the_seed_makes_the_foil():
    first, again, other = _box(seed=7), _box(seed=7), _box(seed=8)
    crinkled_box.cache_clear()
    vertices, faces = (array.copy() for array in crinkled_box(first))
    crinkled_box.cache_clear()
    assert np.array_equal(vertices, crinkled_box(again)[0])
    assert np.array_equal(faces, crinkled_box(again)[1])
    assert not np.array_equal(vertices, crinkled_box(other)[0])


def test_opposite_faces_differ():
    vertices, _ = crinkled_box(_box())
    heights = [np.sort(side * vertices[side * vertices[:, 2] > 0.58, 2])[:100] for side in (-1, 1)]
    assert not np.allclose(*heights)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"facet_m": 0.2}, "must not exceed cell_m 0.1"),
        ({"size_m": (1.0, 1.0, 0.02)}, "nor an edge of size_m"),
        ({"relief_m": 0.024}, "would fold over"),
        ({"facet_m": 1e-3, "relief_m": 1e-4, "fine_relief_m": 1e-4}, "at most 2e"),
        ({"seed": -1}, "greater than or equal to 0"),
    ],
)
def test_impossible_foil_is_refused(changes: dict, says: str):
    with pytest.raises(ValidationError, match=says):
        _box(**changes)
