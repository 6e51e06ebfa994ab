"""Targets that fall freely: closed bodies of the stated size, no two poses look alike, mass properties that belong to them."""

import numpy as np
import pytest
import trimesh
from scipy.spatial import KDTree
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.config import list_library
from scenes.inertia import infeasibility, principal_axes, relabellings
from scenes.mesh_mass import uniform_mass
from scenes.quaternion import quaternion_notes
from scenes.scenario import load_scenario
from scenes.solids import Solid, solids
from scenes.target import Target

NAMES = ("tumbling-satellite", "upper-stage", "rubble")
# Of the upper stage; tank and bottles are shells.
PART_KG = {
    "tank": 900, "skirt-aft": 180, "skirt-forward": 120, "band": 5, "belt": 20, "adapter": 60, "adapter-ring": 25,
    "electronics-1": 160, "electronics-2": 90, "vent": 5, "tunnel": 90, "feed-line": 40, "thrust-frame": 110, "chamber": 130,
    "nozzle": 120, "bottle-1": 95, "bottle-2": 95, "bottle-3": 45, "retro-rocket": 110,
}  # fmt: skip


def target_of(name: str) -> Target:
    return load_scenario("zhai2014-in-plane", [f"target={name}"]).target


def mesh_of(solid: Solid) -> trimesh.Trimesh:
    return trimesh.Trimesh(solid.vertices_target, solid.faces, process=False)


def surface(target: Target, count: int = 20_000) -> np.ndarray:
    """Points (n, 3) strewn evenly over all parts, body axes."""
    mesh = trimesh.util.concatenate([mesh_of(solid) for solid in solids(target)])
    points, _ = trimesh.sample.sample_surface(mesh, count, seed=1)
    return target.mass.target_from_body.inv().apply(np.array(points))


@pytest.mark.parametrize("name", NAMES)
def test_every_part_is_a_closed_body(name: str):
    for solid in solids(target_of(name)):
        assert mesh_of(solid).is_watertight, solid.name
        assert mesh_of(solid).volume > 0, solid.name


@pytest.mark.parametrize("name", NAMES)
def test_no_part_floats(name: str):
    """From any part one reaches every other by boxes that overlap."""
    boxes = [(body.vertices_target.min(axis=0), body.vertices_target.max(axis=0)) for body in solids(target_of(name))]
    touching = np.array([[(low < other[1]).all() and (other[0] < high).all() for other in boxes] for low, high in boxes])
    assert np.linalg.matrix_power(touching.astype(float), len(boxes)).all()


@pytest.mark.parametrize(("name", "size_m"), [("tumbling-satellite", 9.8), ("upper-stage", 8.2), ("rubble", 6.0)])
def test_the_longest_extent_is_as_described(name: str, size_m: float):
    target = target_of(name)
    points = np.concatenate([solid.vertices_target for solid in solids(target)])
    along = target.mass.target_from_body.inv().apply(points)[:, 0]  # each is longest along its axis of least inertia
    assert np.ptp(along) == pytest.approx(size_m, abs=0.25)
    assert np.argmin(target.mass.principal_kg_m2) == 0


@pytest.mark.parametrize("name", NAMES)
def test_a_turn_that_keeps_the_axes_does_not_keep_the_body(name: str):
    """A filter could not tell such a turn by its motion; a scan can: a good part of the surface lies elsewhere."""
    points = surface(target_of(name))
    tree = KDTree(points)
    for turn in relabellings()[1:]:
        apart = tree.query(points @ turn.T)[0]
        assert np.mean(apart > 0.1) > 0.4, turn
    assert np.mean(tree.query(points)[0] > 0.1) == 0.0


@pytest.mark.parametrize("name", NAMES)
def test_the_mass_is_one_that_a_body_can_have(name: str):
    mass = target_of(name).mass
    assert infeasibility(mass.principal_kg_m2) == ""
    assert np.ptp(mass.principal_kg_m2) > 0.25 * max(mass.principal_kg_m2)


def test_the_satellite_has_the_papers_numbers():
    """Song et al. 2017, section 5.1; (25): the centre of mass lies at −rho of {P}; v_B = R(q) v_P."""
    target = target_of("tumbling-satellite")
    assert target.mass.principal_kg_m2 == (500.0, 1000.0, 1500.0)
    assert target.mass.centre_of_mass_m == pytest.approx((-1.0, -0.6, 0.4), abs=1e-15)
    printed = Rotation.from_quat([0.11, 0.55, -0.33, 0.76])  # x, y, z, w
    assert (target.mass.target_from_body.rotation * printed).magnitude() < 1e-15
    notes = quaternion_notes(target)
    assert notes == ["reference_frame.quaternion_wxyz: the quaternion has length 1.00055, it is normalised"]


def test_the_satellite_is_drawn_in_principal_axes():
    """The panels lie along the body's x, on either side of the centre of mass."""
    target = target_of("tumbling-satellite")
    to_body = target.mass.target_from_body.inv()
    centre = {solid.name: to_body.apply(mesh_of(solid).center_mass) for solid in solids(target)}
    assert centre["panel+x"] == pytest.approx([3.38, 0, 0.45], abs=1e-12)
    assert centre["panel-x"] == pytest.approx([-3.18, 0.3, 0], abs=1e-12)
    assert centre["body"] == pytest.approx([0, 0, 0], abs=5e-3)  # its foil is crinkled
    assert centre["nozzle"][2] < -1.2


def test_the_stages_mass_properties_follow_from_its_parts():
    target = target_of("upper-stage")
    bodies = {solid.name: mesh_of(solid) for solid in solids(target)}
    assert bodies.keys() == PART_KG.keys()
    assert sum(PART_KG.values()) == 2400
    moments = [_shell(mesh, PART_KG[name]) if _is_shell(name) else _solid(mesh, PART_KG[name]) for name, mesh in bodies.items()]
    kg, first, second = (sum(parts) for parts in zip(*moments))
    centre = first / kg
    inertia = _inertia(second - kg * np.outer(centre, centre))
    assert target.mass.centre_of_mass_m == pytest.approx(centre, abs=1e-3)
    assert target.mass.principal_kg_m2 == pytest.approx(principal_axes(inertia)[0], rel=1e-3)
    assert np.abs(target.mass.inertia_target - inertia).max() < 10.0


def _is_shell(name: str) -> bool:
    return name == "tank" or name.startswith("bottle")


def _solid(mesh: trimesh.Trimesh, kg: float):
    """Mass, first and second moments about the origin of a uniform solid."""
    inertia = mesh.moment_inertia * kg / mesh.volume
    second = np.trace(inertia) / 2 * np.eye(3) - inertia + kg * np.outer(mesh.center_mass, mesh.center_mass)
    return kg, kg * mesh.center_mass, second


def _shell(mesh: trimesh.Trimesh, kg: float):
    """The same of an evenly heavy surface; ∫ p pᵀ over a triangle is A/12 (Σ vᵢvᵢᵀ + (Σ vᵢ)(Σ vᵢ)ᵀ)."""
    areal, corners = kg * mesh.area_faces / mesh.area, mesh.triangles
    second = np.einsum("t,tci,tcj->ij", areal / 12, corners, corners)
    second += np.einsum("t,ti,tj->ij", areal / 12, corners.sum(axis=1), corners.sum(axis=1))
    return kg, areal @ corners.mean(axis=1), second


def _inertia(second: np.ndarray) -> np.ndarray:
    return np.trace(second) * np.eye(3) - second


def test_the_rocks_mass_properties_are_those_of_its_mesh():
    target = target_of("rubble")
    found = uniform_mass(solids(target), 2000.0)
    assert target.mass.principal_kg_m2 == pytest.approx(found.principal_kg_m2, rel=1e-5)
    assert target.mass.centre_of_mass_m == pytest.approx(found.centre_of_mass_m, abs=1e-5)
    np.testing.assert_allclose(target.mass.inertia_target, found.inertia_target, atol=2.0)
    other = target.model_copy(update={"parts": (target.parts[0].model_copy(update={"shape": _reseeded(target)}),)})
    assert uniform_mass(solids(other), 2000.0).principal_kg_m2 != pytest.approx(found.principal_kg_m2, rel=1e-3)


def _reseeded(target: Target):
    return target.parts[0].shape.model_copy(update={"seed": 2})


def test_uniform_mass_of_boxes_by_hand():
    """A bar of 6 × 2 × 1 m out of two halves, turned and moved: m/12 (b² + c²) about its middle."""
    halves = [
        {"name": name, "shape": {"type": "box", "size_m": (3.0, 2.0, 1.0)}, "centre_m": (x, 0, 0), "material": PAINT}
        for name, x in (("one", -1.5), ("other", 1.5))
    ]
    place = RigidTransform.from_components([1.0, 2.0, 3.0], Rotation.from_rotvec([0.3, 0.2, -0.4]))
    bodies = [Solid(one.name, place.apply(one.vertices_target), one.faces) for one in solids(Target(parts=halves))]
    mass = uniform_mass(bodies, 100.0)
    assert mass.principal_kg_m2 == pytest.approx((100 * (4 + 1), 100 * (36 + 1), 100 * (36 + 4)))
    assert mass.centre_of_mass_m == pytest.approx((1.0, 2.0, 3.0))
    axes = np.abs((place.rotation.inv() * mass.target_from_body.rotation).as_matrix())
    np.testing.assert_allclose(axes, np.eye(3), atol=1e-9)


PAINT = {"type": "paint", "source": "test", "reflectance": 0.5}


@pytest.mark.parametrize("relief", [0.0, 0.14])
def test_rubble_is_an_ellipsoid_with_relief(relief: float):
    shape = {"type": "rubble", "size_m": (6.0, 4.0, 3.0), "relief": relief, "subdivisions": 5, "seed": 7}
    lump = solids(Target(parts=[{"name": "lump", "shape": shape, "material": PAINT}]))[0]
    radii = np.linalg.norm(lump.vertices_target / [3.0, 2.0, 1.5], axis=1)
    assert np.std(np.log(radii)) == pytest.approx(relief, abs=1e-12)
    if not relief:
        assert mesh_of(lump).volume == pytest.approx(4 / 3 * np.pi * 9.0, rel=2e-3)
    again = solids(Target(parts=[{"name": "lump", "shape": shape, "material": PAINT}]))[0]
    assert np.array_equal(lump.vertices_target, again.vertices_target)


def test_every_choice_of_the_papers_scenario_differs_in_what_it_says():
    names = sorted(name for name in list_library("scenario") if name.startswith("song2017"))
    cases = {name: load_scenario(name) for name in names}
    base = cases.pop("song2017")
    assert base.frame_count / base.rate_hz == 1000.0
    assert base.lidars["lidar"].mount.position_m == (0.0, 0.0, 2.0)
    assert base.lidars["lidar"].delay_s == 0.05
    changed = {
        name: {key for key in ("motion", "lidars", "target") if getattr(case, key) != getattr(base, key)}
        for name, case in cases.items()
    }
    assert changed == {
        "song2017-disturbed": {"motion"},
        "song2017-offset-in-body": {"target"},
        "song2017-perturbed": {"motion"},
        "song2017-printed-rate": {"motion"},
        "song2017-variance": {"lidars"},
    }
    assert cases["song2017-variance"].lidars["lidar"].ranging.sigma_m ** 2 == pytest.approx(0.05)
