"""Orbits, tumbles and masses that cannot be: refused at load, the field named, both values said."""

import pytest

from scenes.errors import ConfigError
from scenes.scenario import load_scenario

BAD = {
    "a mass that no body has": (
        ["target.mass.principal_kg_m2=[500.0, 1500.0, 2250.0]"],
        "target.mass: principal_kg_m2: no body has the principal moments of inertia 500, 1500, 2250: the largest, 2250, exceeds "
        "the others' sum, 2000",
    ),
    "the paper's guess of 150 %": (["target.mass.principal_kg_m2=[1.0, 3.0, 4.5]"], "the largest, 4.5, exceeds the others' sum, 4"),
    "a moment of nothing": (["target.mass.principal_kg_m2=[0.0, 1.0, 1.0]"], "each must be positive"),
    "a quaternion of another length": (
        ["motion.inertial_from_body_wxyz=[0.73, 0.2, 0.37, 0.55]"],
        "motion.inertial_from_body_wxyz: the quaternion [0.73, 0.2, 0.37, 0.55] has length 1.00613, must be 1 within 0.001",
    ),
    "a frame's quaternion of another length": (
        ["target.reference_frame.quaternion_wxyz=[0.7, 0.11, 0.55, -0.33]"],
        "target.reference_frame.quaternion_wxyz: the quaternion",
    ),
    "a quaternion of three": (["motion.inertial_from_body_wxyz=[1.0, 0.0, 0.0]"], "motion.inertial_from_body_wxyz"),
    "a target without mass": (["target=small-satellite"], "motion: a tumble in orbit needs target.mass"),
    "an orbit within the Earth": (["motion.target_position_m=[6e6, 0, 0]"], "motion: target_position_m lies 6000 km from"),
    "a body that leaves": (["motion.target_velocity_m_s=[0, 12000.0, 0]"], "motion: target_velocity_m_s is 12000 m/s: the target"),
    "a body that falls": (["motion.target_velocity_m_s=[0, 5000.0, 0]"], "motion: target_velocity_m_s lets the target fall to"),
    "noise between steps": (["motion.noise_hold_s=0.15"], "motion: noise_hold_s 0.15 must be a whole multiple of step_s 0.1"),
    "a density below zero": (["motion.chaser_acceleration_psd_m2_s3=-1.0"], "motion.chaser_acceleration_psd_m2_s3: got -1.0"),
    "craft in one place": (["motion.relative={ type = 'state', position_m = [0, 0, 0] }"], "motion: relative.position_m puts"),
    "a rate by another name": (["motion.relative.rate=theta"], "must be one of mean-motion, printed"),
    "a path of no kind": (["motion.relative={ type = 'circle' }"], "must be one of state, ellipse"),
    "a roll about nothing": (["motion.roll_reference=[0, 0, 0]"], "a zero vector has no direction"),
    "an offset in no frame": (["target.reference_frame.origin_in=body"], "must be one of target, parts"),
    "a lump that folds": (["target=rubble", "target.parts.0.shape.relief=0.9"], "target.parts.0.shape.relief: got 0.9"),
}


@pytest.mark.parametrize(("overrides", "says"), BAD.values(), ids=BAD)
def test_it_is_refused_at_load_with_its_field(overrides: list[str], says: str):
    with pytest.raises(ConfigError) as refused:
        load_scenario("song2017", overrides)
    assert says in str(refused.value)
    assert "\n" not in refused.value.faults[0]


@pytest.mark.parametrize("name", ["upper-stage", "rubble"])
def test_the_other_falling_targets_take_its_place(name: str):
    case = load_scenario("song2017", [f"target={name}"])
    seen = case.trajectory.chaser_from_target(0.0, 0, 0).apply(case.target.mass.centre_of_mass_m)
    assert seen == pytest.approx([0.0, 0.0, 67.08], abs=0.01)
