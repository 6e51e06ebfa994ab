"""The small satellite of the library: its features lie on its parts, its markers can be found and told apart."""

from itertools import combinations

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from scenes.arrays import Floats
from scenes.features import CircleFeature, MarkerFeature, RectangleFeature
from scenes.scenario import load_scenario
from scenes.solids import Solid, solids
from scenes.target import Target

F_PX, NEAR_M, FAR_M = 1773.62, 3.45, 10.0  # the rig's focal length and the ends of its range


@pytest.fixture(scope="module")
def target() -> Target:
    return load_scenario("zhai2014-in-plane", ["target=small-satellite"]).target


@pytest.fixture(scope="module")
def bodies(target: Target) -> dict[str, Solid]:
    return {solid.name: solid for solid in solids(target)}


@pytest.fixture(scope="module")
def markers(target: Target) -> list[MarkerFeature]:
    return [feature for feature in target.features if isinstance(feature, MarkerFeature)]


def _box(solid: Solid) -> tuple[Floats, Floats]:
    return solid.vertices_target.min(axis=0), solid.vertices_target.max(axis=0)


def _outline(solid: Solid) -> Floats:
    """(n, 2): its corners or the points of its circle, in the plane of the ring."""
    return solid.vertices_target[:, :2]


def _clearance(outline: Floats) -> float:
    """How far points stay from both edges of the ring and from the inside of the frame, metres."""
    rho = np.hypot(*outline.T)
    from_ring = np.where(rho < 0.58, 0.56 - rho, rho - 0.60)
    return float(np.minimum(from_ring, 0.69 - np.abs(outline).max(axis=1)).min())


def test_every_part_is_a_closed_body(bodies: dict[str, Solid]):
    for name, solid in bodies.items():
        mesh = trimesh.Trimesh(solid.vertices_target, solid.faces, process=False)
        assert mesh.is_watertight, name
        assert mesh.volume > 0, name
    assert 60_000 < sum(len(solid.faces) for solid in bodies.values()) < 100_000


def test_no_part_floats(bodies: dict[str, Solid]):
    """From the body one reaches every part by boxes that overlap."""
    boxes = {name: _box(solid) for name, solid in bodies.items()}
    reached = {"body"}
    for _ in boxes:
        touching = {
            one
            for one, (low, high) in boxes.items()
            if any((low <= boxes[other][1] + 1e-9).all() and (boxes[other][0] <= high + 1e-9).all() for other in reached)
        }
        reached |= touching
    assert reached == set(boxes)


def test_the_ring_is_where_its_features_say(target: Target, bodies: dict[str, Solid]):
    outer, inner = (feature for feature in target.features if isinstance(feature, CircleFeature))
    assert (outer.name, inner.name) == ("ring", "ring-inner")
    assert np.array_equal(outer.target_from_feature.as_matrix(), np.eye(4))
    vertices = bodies["ring"].vertices_target
    top = vertices[np.abs(vertices[:, 2]) < 1e-9]
    assert vertices[:, 2].max() == pytest.approx(0.0, abs=1e-12)
    for circle, radius_m in ((outer, np.hypot(*top.T[:2]).max()), (inner, np.hypot(*top.T[:2]).min())):
        assert circle.radius_m == pytest.approx(radius_m)
        edge = top[np.isclose(np.hypot(*top.T[:2]), radius_m)]
        gap = np.linalg.norm(circle.points_target(64)[:, None] - edge[None], axis=-1).min(axis=1)
        assert gap.max() < 0.5 * 2 * np.pi * radius_m / 512 + 1e-6  # half a facet's edge: the sagitta is 12 um
    assert vertices[:, 2].min() < -0.1 - 0.0075  # it stands in the foil, not above it


def test_the_nozzles_rim_is_another_circle_in_another_plane(bodies: dict[str, Solid]):
    low, high = _box(bodies["nozzle"])
    assert high[0] == pytest.approx(0.13)
    assert abs(high[2]) > 0.04
    assert low[2] < -0.1 - 0.0075


def test_the_frames_corners_are_those_of_its_bars(target: Target, bodies: dict[str, Solid]):
    frame = next(feature for feature in target.features if isinstance(feature, RectangleFeature))
    bars = np.concatenate([solid.vertices_target for name, solid in bodies.items() if name.startswith("frame")])
    for corner in frame.corners_target:
        assert np.linalg.norm(bars - corner, axis=1).min() < 1e-9
    assert frame.target_from_feature.apply([1.0, 0.0, 0.0]) == pytest.approx([0.0, 0.0, 1.0])  # outwards
    assert bars[:, 2].max() == pytest.approx(frame.centre_m[2])


def test_each_marker_is_the_top_of_its_part(target: Target, bodies: dict[str, Solid], markers: list[MarkerFeature]):
    material = {part.name: part.material.description for part in target.parts}
    for marker in markers:
        low, high = _box(bodies[marker.name])
        assert (low + high)[:2] / 2 == pytest.approx(marker.centre_m[:2], abs=1e-9)
        assert high[2] == pytest.approx(marker.centre_m[2], abs=1e-9)
        assert (high - low)[:2] == pytest.approx([marker.size_m] * 2)
        assert (len(bodies[marker.name].faces) == 12) == (marker.shape == "square")
        assert material[marker.name].startswith("White" if marker.bright else "Black")


def test_bright_markers_have_a_dark_border(target: Target, bodies: dict[str, Solid], markers: list[MarkerFeature]):
    bright = [marker for marker in markers if marker.bright]
    assert len(bright) == 2
    for marker in bright:
        plate = bodies[f"{marker.name}-plate"]
        assert next(part for part in target.parts if part.name == plate.name).material.description.startswith("Black")
        border = np.abs(_outline(plate) - marker.centre_m[:2]).max() - marker.size_m / 2
        assert border * F_PX / FAR_M > 5.0  # pixels
        assert _clearance(_outline(plate)) > 0.05


def test_markers_stand_above_the_foil(bodies: dict[str, Solid], markers: list[MarkerFeature]):
    foil = bodies["body"].vertices_target[:, 2].max()
    assert foil <= -0.1 + 0.0075
    for name in [name for name in bodies if name.startswith("marker") and not name.endswith("post")]:
        assert bodies[name].vertices_target[:, 2].min() > foil
    for marker in markers:
        assert 0.005 < marker.centre_m[2] + 0.1 < 0.020


def test_markers_are_neither_too_small_nor_too_large_to_be_seen(markers: list[MarkerFeature]):
    for marker in markers:
        area_m2 = marker.size_m**2 * (np.pi / 4 if marker.shape == "disc" else 1.0)
        assert area_m2 * (F_PX / FAR_M) ** 2 * np.cos(np.radians(20)) > 200
        assert area_m2 * (F_PX / NEAR_M) ** 2 < 3000


def test_markers_keep_clear_of_edges_and_of_each_other(bodies: dict[str, Solid], markers: list[MarkerFeature]):
    for marker in markers:
        assert _clearance(_outline(bodies[marker.name])) > 0.06
    wholes = [bodies.get(f"{marker.name}-plate", bodies[marker.name]) for marker in markers]
    for one, other in combinations(wholes, 2):
        apart = np.linalg.norm(_outline(one)[:, None] - _outline(other)[None], axis=-1).min()
        assert apart > 0.06


def test_the_first_marker_gives_the_x_axis_and_no_turn_maps_the_others_onto_themselves(markers: list[MarkerFeature]):
    centres = np.array([marker.centre_m for marker in markers])
    rho = np.hypot(*centres.T[:2])
    assert centres[0, 1] == 0.0
    assert rho.argmin() == 0
    assert np.sort(rho)[1] - rho[0] > 0.04
    for yaw_deg in range(10, 351):
        turned = Rotation.from_euler("z", yaw_deg, degrees=True).apply(centres)
        met = np.linalg.norm(turned[:, None] - centres[None], axis=-1).min(axis=1) < 0.06
        assert met.sum() <= 2, yaw_deg  # of six: no three of them fit another turn
