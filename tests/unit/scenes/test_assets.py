"""Meshes: what is read is what stands in the file, in metres; what is broken is one sentence."""

import struct

import numpy as np
import pytest
import trimesh

from scenes.assets import asset_digest, load_mesh, map_mesh_paths, mesh_paths, portable, with_assets_in
from scenes.errors import AssetError

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"


def write(path, data):
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return path


@pytest.fixture
def ball():
    return trimesh.creation.icosphere(2, radius=2.0)


@pytest.mark.parametrize(
    ("name", "kind", "digits"),
    [
        ("a.stl", "stl", 7),
        ("b.stl", "stl_ascii", 6),
        ("c.obj", "obj", 6),
        ("d.ply", "ply", 7),
        ("e.glb", "glb", 7),
        ("F.PLY", "ply", 7),
    ],
)
def test_every_format_gives_the_same_surface(ball, tmp_path, name, kind, digits):
    """Area and volume of a closed polyhedron from its triangles (divergence theorem), against the mesh that was written."""
    ball.export(tmp_path / name, file_type=kind)
    mesh = load_mesh(tmp_path / name)
    a, b, c = (mesh.vertices_m[mesh.faces[:, corner]] for corner in range(3))
    assert len(mesh.faces) == 320
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 == pytest.approx(ball.area, rel=10.0**-digits)
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(ball.volume, rel=10.0**-digits)


def test_scale_takes_the_unit_of_the_file_to_metres(ball, tmp_path):
    ball.export(tmp_path / "a.ply")
    one, thousandth = load_mesh(tmp_path / "a.ply"), load_mesh(tmp_path / "a.ply", 1e-3)
    np.testing.assert_array_equal(thousandth.vertices_m, one.vertices_m * 1e-3)
    assert not one.vertices_m.flags.writeable
    assert not thousandth.faces.flags.writeable


def test_a_file_is_read_once_and_again_when_it_has_changed(ball, tmp_path):
    file = tmp_path / "a.stl"
    ball.export(file)
    first = load_mesh(file)
    assert load_mesh(file) is first
    trimesh.creation.box().export(file)
    assert len(load_mesh(file).faces) == 12


def test_quads_are_split_and_triangles_without_area_left_out(tmp_path):
    quad = write(tmp_path / "quad.obj", TRIANGLE + "v 1 1 0\nf 1 2 4 3\nf 1 1 2\n")
    mesh = load_mesh(quad)
    assert len(mesh.faces) == 2
    a, b, c = (mesh.vertices_m[mesh.faces[:, corner]] for corner in range(3))
    np.testing.assert_allclose(np.cross(b - a, c - a).sum(axis=0), [0, 0, 2.0])


def volume_m3(mesh):
    a, b, c = (mesh.vertices_m[mesh.faces[:, corner]] for corner in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


@pytest.mark.parametrize("name", ["a.stl", "a.obj", "a.ply", "a.glb"])
def test_a_body_that_is_inside_out_is_turned_and_its_neighbour_is_not(ball, tmp_path, name):
    """Two bodies of 2 m: one inside out, one right, in a file; STL shares no vertices at all."""
    right, wrong = ball.copy(), ball.copy().apply_translation([10.0, 0.0, 0.0])
    wrong.invert()
    trimesh.util.concatenate([right, wrong]).export(tmp_path / name)
    mesh = load_mesh(tmp_path / name)
    middles = mesh.vertices_m[mesh.faces].mean(axis=1)
    a, b, c = (mesh.vertices_m[mesh.faces[:, corner]] for corner in range(3))
    outwards = middles - np.where(middles[:, :1] > 5.0, [[10.0, 0.0, 0.0]], [[0.0, 0.0, 0.0]])
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), outwards) > 0).all()
    assert volume_m3(mesh) == pytest.approx(2 * ball.volume, rel=1e-5)


def test_a_small_body_far_from_the_origin_is_turned(tmp_path):
    box = trimesh.creation.box((1e-3, 1e-3, 1e-3))
    box.invert()
    box.vertices = box.vertices + 1e5
    box.export(tmp_path / "a.obj")
    mesh = load_mesh(tmp_path / "a.obj")
    a, b, c = (mesh.vertices_m[mesh.faces[:, corner]] - 1e5 for corner in range(3))
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(1e-9, rel=1e-3)


def test_a_triangle_without_area_does_not_keep_a_body_inside_out(tmp_path):
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    inside_out = write(tmp_path / "a.obj", corners + "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\nf 1 1 2\n")
    assert volume_m3(load_mesh(inside_out)) == pytest.approx(1 / 6)


def test_an_open_surface_stays_as_it_is(ball, tmp_path):
    """An inverted ball with one triangle missing encloses nothing; its 319 triangles keep their winding."""
    ball.invert()
    ball.update_faces(np.arange(len(ball.faces)) > 0)
    ball.export(tmp_path / "a.ply")
    np.testing.assert_array_equal(load_mesh(tmp_path / "a.ply").faces, ball.faces)


def ply_with_bad_index():
    header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    return header + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n"


BROKEN = {
    "missing.stl": (None, "cannot read the mesh: No such file or directory"),
    "empty.stl": (b"", "truncated or no STL: a binary STL of 0 triangles has 84 bytes, it has 0"),
    "cut.stl": (bytes(80) + struct.pack("<I", 3) + bytes(149), "a binary STL of 3 triangles has 234 bytes, it has 233"),
    "words.stl": ("hello" * 50, "truncated or no STL"),
    "cut-text.stl": ("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0", "empty or broken"),
    "cut.ply": (ply_with_bad_index()[:150], "the file is broken"),
    "index.ply": (ply_with_bad_index(), "the mesh"),
    "index.obj": (TRIANGLE + "f 1 2 9\n", "the file is broken"),
    "points.obj": (TRIANGLE, "empty or broken"),
    "nan.obj": (TRIANGLE.replace("1 0 0", "1 nan 0") + "f 1 2 3\n", r"vertex 1 of the mesh is \[1.0, nan, 0.0\], not three finite"),
    "inf.obj": (TRIANGLE.replace("1 0 0", "inf 0 0") + "f 1 2 3\n", r"vertex 1 of the mesh is \[inf, 0.0, 0.0\]"),
    "line.obj": (TRIANGLE.replace("0 1 0", "2 0 0") + "f 1 2 3\n", "none of the mesh's 1 triangles has an area"),
    "zero.stl": (bytes(80) + struct.pack("<I", 2) + bytes(100), "none of the mesh's 2 triangles has an area"),
    "words.glb": ("hello" * 50, "the file is broken"),
    "part.step": ("ISO-10303-21;", r"'.step' is no mesh format we read"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_what_is_broken_is_one_sentence(tmp_path, name):
    data, text = BROKEN[name]
    file = tmp_path / name if data is None else write(tmp_path / name, data)
    with pytest.raises(AssetError, match=text) as caught:
        load_mesh(file)
    assert str(caught.value).startswith(f"{file}: ")
    assert "\n" not in str(caught.value)
    assert caught.value.exit_status == 2


def test_a_directory_and_a_path_that_is_none(tmp_path):
    with pytest.raises(AssetError, match="a directory or a device"):
        load_mesh(tmp_path)
    with pytest.raises(AssetError, match="it is no path"):
        load_mesh(tmp_path / "a\x00.stl")


@pytest.mark.parametrize("fraction", [0.1, 0.5, 0.9, 0.999])
@pytest.mark.parametrize("kind", ["stl", "ply", "glb"])
def test_a_truncated_file_never_gives_a_part_of_its_mesh(ball, tmp_path, kind, fraction):
    ball.export(tmp_path / f"a.{kind}")
    data = (tmp_path / f"a.{kind}").read_bytes()
    cut = write(tmp_path / f"b.{kind}", data[: int(len(data) * fraction)])
    with pytest.raises(AssetError):
        load_mesh(cut)


def test_a_mesh_reaches_for_no_other_file(tmp_path):
    """Materials, textures and buffers beside a mesh could lie anywhere; none is opened."""
    (tmp_path / "secret.mtl").mkdir()  # opening it would raise
    mesh = write(tmp_path / "a.obj", "mtllib secret.mtl\nusemtl x\n" + TRIANGLE + "f 1 2 3\n")
    assert len(load_mesh(mesh).faces) == 1


def test_portable_scenarios_depend_on_content_alone(tmp_path):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        write(tmp_path / folder / f"{folder}.OBJ", TRIANGLE + "f 1 2 3\n")

    def scenario(folder):
        part = {"shape": {"type": "mesh", "path": str(tmp_path / folder / f"{folder}.OBJ"), "scale": 2.0}}
        return {"parts": [part, {"shape": {"type": "box", "path": "untouched"}}]}

    (one, files), (other, _) = portable(scenario("a")), portable(scenario("b"))
    assert one == other
    name = f"assets/{asset_digest(tmp_path / 'a/a.OBJ')}.obj"
    assert files == {name: tmp_path / "a/a.OBJ"}
    assert mesh_paths(one) == [name]
    assert one["parts"][1]["shape"]["path"] == "untouched"
    assert mesh_paths(with_assets_in(one, tmp_path)) == [str(tmp_path / name)]
    assert map_mesh_paths(one, lambda path: path) == one
