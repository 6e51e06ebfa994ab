"""A tumble in orbit as a person writes it: what is refused, what a scenario makes of it."""

import numpy as np
import pytest
from pydantic import ValidationError

from scenes.orbit_motion import TumbleInOrbit
from scenes.recording import ChaserState
from scenes.scenario import Scenario, load_scenario, realize

MASS = {"principal_kg_m2": (500.0, 1000.0, 1500.0)}
TUMBLE = {
    "type": "tumble-in-orbit",
    "target_position_m": (6_998_450.0, 0.0, 0.0),
    "target_velocity_m_s": (0.0, 7545.7, 131.7),
    "relative": {"type": "ellipse", "amplitude_m": 30.0},
    "inertial_from_body_wxyz": (0.7303, 0.1826, 0.3651, 0.5477),
    "omega_body_rad_s": (0.02, 0.01, -0.015),
}


def _scenario(motion, mass=MASS) -> Scenario:
    base = load_scenario("zhai2014-in-plane").model_dump()
    return Scenario.model_validate(base | {"motion": motion, "target": base["target"] | ({"mass": mass} if mass else {})})


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"target_position_m": (6_300_000.0, 0, 0)}, "lies 6300 km from the Earth's centre: inside of the Earth"),
        (
            {"target_velocity_m_s": (0.0, 11_000.0, 0.0)},
            r"target_velocity_m_s is 11000 m/s: the target leaves the Earth \(e = 1\.1",
        ),
        ({"target_velocity_m_s": (0.0, 7_000.0, 0.0)}, "lets the target fall to 5283 km from the Earth's centre: into the Earth"),
        ({"target_velocity_m_s": (0.0, 0.0, 0.0)}, "lets the target fall to 0 km from the Earth's centre: into the Earth"),
        (
            {"omega_body_rad_s": (0.0, 3.0, -4.0)},
            "step_s 0.1: omega_body_rad_s turns the target by 0.5 rad in a step, at most 0.1 .* step_s of 0.02 or less will do",
        ),
        ({"noise_hold_s": 0.25}, "noise_hold_s 0.25 must be a whole multiple of step_s 0.1"),
        ({"noise_hold_s": 0.05}, "noise_hold_s 0.05 must be a whole multiple of step_s 0.1"),
        ({"relative": {"type": "state", "position_m": (0, 0, 0)}}, "puts the chaser into the target's centre of mass"),
        ({"relative": {"type": "state", "position_m": (3e7, 1e7, 2e7)}}, "no chaser's orbit has the target at"),
        ({"inertial_from_body_wxyz": (0.7, 0.1826, 0.3651, 0.5477)}, "has length 0.978.*, must be 1 within 0.001"),
        ({"roll_reference": (0.0, 0.0, 0.0)}, "a zero vector has no direction"),
        ({"step_s": 0.0}, "greater than 0"),
    ],
)
def test_bad_numbers_are_refused(change, sentence: str):
    assert TumbleInOrbit.model_validate(TUMBLE)
    with pytest.raises(ValidationError, match=sentence):
        TumbleInOrbit.model_validate(TUMBLE | change)


def test_a_target_without_mass_does_not_fall():
    with pytest.raises(ValidationError, match=r"a tumble in orbit needs target\.mass \(principal_kg_m2, centre_of_mass_m\)"):
        _scenario(TUMBLE, mass=None)
    spin = {"type": "spin", "position_m": (0.0, 0.0, 50.0)}
    assert _scenario(spin, mass=None).target.mass is None


def test_a_scenario_is_bound_to_its_targets_mass_once():
    case = _scenario(TUMBLE)
    assert case.trajectory is case.trajectory
    assert case.trajectory is Scenario.model_validate(case.model_dump()).trajectory
    heavier = _scenario(TUMBLE, MASS | {"principal_kg_m2": (600.0, 1000.0, 1500.0)})
    assert heavier.trajectory is not case.trajectory


def test_a_frame_has_the_pose_and_rate_of_its_seed():
    case = _scenario(TUMBLE | {"target_angular_acceleration_psd_rad2_s3": 1e-6, "step_s": 1.0})
    one, other = (realize(case, seed, 5) for seed in (1, 2))
    assert one.omega_target_rad_s == case.trajectory.omega_target_rad_s(5.0, 1)
    assert one.omega_target_rad_s != other.omega_target_rad_s
    later = (one.chaser_from_target.rotation.inv() * one.pose_at(one.time_s + 1e-3).rotation).as_rotvec()
    assert later == pytest.approx(1e-3 * np.array(one.omega_target_rad_s), abs=1e-7)


def test_the_chasers_state_is_told_where_there_is_an_orbit():
    state = _scenario(TUMBLE).trajectory.chaser_state(3.0, 0)
    assert isinstance(state, ChaserState)
    assert state.time_s == 3.0
    still = load_scenario("zhai2014-in-plane").trajectory
    assert still.chaser_state(3.0, 0) is None
    assert still.truth_columns(3.0, 0) == {}


def test_the_state_at_start_may_be_given():
    given = TumbleInOrbit.model_validate(
        TUMBLE | {"relative": {"type": "state", "position_m": (1.0, -40.0, 2.0), "velocity_m_s": (0, 0.1, 0)}}
    )
    row = _scenario(given.model_dump()).trajectory.truth_columns(0.0, 0)
    assert [row[f"rel_{axis}_m"] for axis in "xyz"] == pytest.approx([1.0, -40.0, 2.0], abs=1e-8)
    assert [row[f"rel_v{axis}_m_s"] for axis in "xyz"] == pytest.approx([0.0, 0.1, 0.0], abs=1e-11)


def test_the_papers_ellipse_is_its_formula():
    quarter = TumbleInOrbit.model_validate(TUMBLE | {"relative": {"type": "ellipse", "amplitude_m": 30.0, "phase_deg": 90.0}})
    position, velocity = quarter.relative.at_start(quarter.target_orbit)
    assert position == pytest.approx([0.0, -60.0, 0.0], abs=1e-12)
    assert velocity == pytest.approx([-0.032351, 0.0, -0.064703], abs=1e-6)
