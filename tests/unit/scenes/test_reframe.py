"""A target drawn in other axes: the same body, its numbers in the target frame."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.quaternion import quaternion_notes
from scenes.reframe import reframed
from scenes.scenario import Scenario, load_scenario
from scenes.solids import solids
from scenes.target import Target

RHO = (1.0, 0.6, -0.4)  # Song et al. 2017, section 5.1
Q_PB_WXYZ = (0.76, 0.11, 0.55, -0.33)
FEATURES = (
    {"name": "panel", "centre_m": (0.0, 2.0, 0.1), "length_m": 2.0, "width_m": 1.0},
    {"type": "circle", "name": "ring", "centre_m": (0.2, 0.0, 0.5), "radius_m": 0.4},
    {"type": "marker", "name": "dot", "shape": "disc", "size_m": 0.1, "normal": (1.0, 0.0, 0.0), "x_axis": (0.0, 1.0, 0.0)},
)


def drawn(**changes) -> Target:
    material = {"type": "paint", "source": "ours", "reflectance": 0.5}
    boxes = [
        {"name": "body", "shape": {"type": "box", "size_m": (1.0, 2.0, 3.0)}, "material": material, "centre_m": (0.1, 0.2, 0.3)},
        {
            "name": "dish",
            "shape": {"type": "dish", "radius_m": 0.4, "focal_length_m": 0.3},
            "material": material,
            "centre_m": (1.0, 0.0, 0.0),
            "rotation_vector_deg": (10.0, 70.0, -30.0),
        },
    ]
    mass = {"principal_kg_m2": (500.0, 1000.0, 1500.0)}
    return Target.model_validate({"parts": boxes, "features": FEATURES, "mass": mass} | changes)


def framed(**changes) -> Target:
    frame = {"origin_m": RHO, "origin_in": "target", "quaternion_wxyz": Q_PB_WXYZ}
    return drawn(reference_frame=frame | changes)


def parts_from_target(rho_parts) -> RigidTransform:
    return RigidTransform.from_components(rho_parts, Rotation.from_quat(Q_PB_WXYZ, scalar_first=True))


@pytest.mark.parametrize("origin_in", ["target", "parts"])
def test_the_body_stays_as_it_is(origin_in: str):
    """Solids, taken back by the transform written out, lie where they were drawn; both readings of rho."""
    turn = Rotation.from_quat(Q_PB_WXYZ, scalar_first=True)
    back = parts_from_target(turn.apply(RHO) if origin_in == "target" else RHO)
    for before, after in zip(solids(drawn()), solids(reframed(framed(origin_in=origin_in)))):
        np.testing.assert_allclose(back.apply(after.vertices_target), before.vertices_target, atol=1e-14)
        assert np.array_equal(before.faces, after.faces)


def test_the_centre_of_mass_lies_at_minus_rho_where_rho_is_read_in_the_target_frame():
    """The paper's eq. (25) adds R(q_PC) rho to the centre of mass: in {P} its origin is rho away."""
    mass = reframed(framed()).mass
    assert mass.centre_of_mass_m == pytest.approx(tuple(-x for x in RHO), abs=1e-15)
    body_from_target = Rotation.from_quat(mass.quaternion_wxyz, scalar_first=True).inv()
    assert (body_from_target * Rotation.from_quat(Q_PB_WXYZ, scalar_first=True).inv()).magnitude() < 1e-15
    in_parts = reframed(framed(origin_in="parts")).mass.centre_of_mass_m
    assert in_parts == pytest.approx(-Rotation.from_quat(Q_PB_WXYZ, scalar_first=True).inv().apply(RHO), abs=1e-15)


def test_inertia_goes_with_the_body():
    turn = Rotation.from_quat(Q_PB_WXYZ, scalar_first=True).as_matrix()
    assert reframed(framed()).mass.inertia_target == pytest.approx(turn.T @ np.diag([500.0, 1000.0, 1500.0]) @ turn, rel=1e-12)


def test_features_go_with_the_parts():
    turn = Rotation.from_quat(Q_PB_WXYZ, scalar_first=True)
    back = parts_from_target(turn.apply(RHO))
    before, after = drawn().features, reframed(framed()).features
    np.testing.assert_allclose(back.apply(after[0].corners_target), before[0].corners_target, atol=1e-14)
    for one, other in zip(before[1:], after[1:]):
        moved = (back * other.target_from_feature).as_matrix()
        np.testing.assert_allclose(moved, one.target_from_feature.as_matrix(), atol=1e-14)


def test_it_is_done_once():
    done = reframed(framed())
    assert done.reference_frame.applied
    assert reframed(done) is done
    assert reframed(Target.model_validate(done.model_dump())) == done
    assert reframed(drawn()) == drawn()  # without a frame nothing happens


def test_a_scenario_loads_it_in_the_target_frame_and_its_resolved_text_loads_as_the_same():
    base = load_scenario("zhai2014-in-plane").model_dump()
    case = Scenario.model_validate(base | {"target": framed().model_dump()})
    assert case.target == reframed(framed())
    assert Scenario.model_validate(case.model_dump()) == case
    assert Scenario.model_validate_json(case.model_dump_json()) == case
    assert quaternion_notes(case) == ["target.reference_frame.quaternion_wxyz: the quaternion has length 1.00055, it is normalised"]


def test_a_target_without_them_is_written_as_before():
    plain = Target.model_validate(drawn().model_dump() | {"mass": None})
    assert not {"mass", "reference_frame"} & plain.model_dump().keys()
    assert "applied" not in framed().model_dump()["reference_frame"]
