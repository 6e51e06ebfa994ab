"""What a run's seed changes of a motion: drawn once a run, the same for every light, within its bounds, nothing if left out."""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy import stats

from scenes.motion import NutationApproach, Spin
from scenes.motion_scatter import NutationScatter, Scatter
from scenes.scenario import load_scenario

SCATTER = {"tilt_deg": 8.0, "roll_deg": 30.0, "position_m": (0.1, 0.2, 0.5)}
SPIN = {"type": "spin", "position_m": (0.0, 0.1, 9.0), "rotation_vector_deg": (170.0, 5.0, 0.0)}
SPIN |= {"omega_target_deg_s": (0.3, 0.0, 2.0)}
NUTATION = {"type": "nutation-approach", "position_m": (0.0, 0.0, 9.0), "nutation_deg": 5.0, "period_s": 110.0, "spin_deg_s": 2.0}


def test_without_scatter_a_seed_changes_nothing_and_the_text_does_not_name_it():
    for motion in (Spin.model_validate(SPIN), NutationApproach.model_validate(NUTATION)):
        first, second = (motion.chaser_from_target(3.0, 3, seed).as_matrix() for seed in (0, 1))
        assert np.array_equal(first, second)
        assert "scatter" not in motion.model_dump(mode="json")


def test_a_start_is_tilted_rolled_and_moved_within_its_bounds_and_evenly():
    motion = Spin.model_validate(SPIN | {"scatter": SCATTER})
    plain = Spin.model_validate(SPIN)
    moved, tilts, rolls = [], [], []
    for seed in range(400):
        apart = plain.chaser_from_target(0.0, 0, seed).inv() * motion.chaser_from_target(0.0, 0, seed)
        moved.append(motion.chaser_from_target(0.0, 0, seed).translation - plain.chaser_from_target(0.0, 0, seed).translation)
        about, tilt, again = apart.rotation.as_euler("ZXZ")
        tilts.append(tilt)
        rolls.append((about + again + np.pi) % (2 * np.pi) - np.pi)
    assert (np.abs(moved).max(axis=0) <= [0.1, 0.2, 0.5]).all()
    assert (np.abs(moved).max(axis=0) > [0.095, 0.19, 0.475]).all()
    heights = (1 - np.cos(tilts)) / (1 - np.cos(np.radians(8.0)))  # uniform on a cap
    assert stats.kstest(heights, "uniform").pvalue > 0.01
    assert stats.kstest(np.degrees(rolls) / 60 + 0.5, "uniform").pvalue > 0.01


def test_one_seed_is_one_trajectory_in_any_frame_and_another_is_another():
    motion = NutationApproach.model_validate(NUTATION | {"scatter": SCATTER | {"phase_deg": 180.0}})
    here, later, other = (motion.chaser_from_target(4.0, frame, seed).as_matrix() for frame, seed in ((0, 1), (7, 1), (0, 2)))
    assert np.array_equal(here, later)
    assert np.abs(here - other).max() > 0.01


@pytest.mark.parametrize("seed", [0, 5])
def test_angular_velocity_is_still_the_derivative_of_the_attitude(seed: int):
    for kind, tree in ((Spin, SPIN), (NutationApproach, NUTATION)):
        more = {"phase_deg": 180.0} if kind is NutationApproach else {}
        motion = kind.model_validate(tree | {"scatter": SCATTER | more})
        before, after = (motion.chaser_from_target(6.0 + step, 0, seed).rotation for step in (-5e-4, 5e-4))
        assert (before.inv() * after).as_rotvec() / 1e-3 == pytest.approx(motion.omega_target_rad_s(6.0, seed), abs=1e-8)


def test_a_field_more_changes_no_other():
    wide, narrow = Scatter(tilt_deg=8.0, roll_deg=30.0), Scatter(tilt_deg=8.0)
    (first, second) = (one.turn(3).apply([0.0, 0.0, 1.0]) for one in (wide, narrow))
    assert first == pytest.approx(second, abs=1e-15)
    assert NutationScatter(tilt_deg=8.0, phase_deg=90.0).turn(3).as_quat() == pytest.approx(narrow.turn(3).as_quat())


@pytest.mark.parametrize("wrong", [{"tilt_deg": -1.0}, {"roll_deg": 181.0}, {"position_m": (0.0, -0.1, 0.0)}, {"phase_deg": 3.0}])
def test_impossible_scatter_is_refused(wrong: dict):
    with pytest.raises(ValidationError):
        Scatter.model_validate(wrong)


def test_the_standard_scenarios_share_one_trajectory_for_each_seed_and_it_is_a_free_bodys():
    lights = ("sun", "halogen", "grazing", "glint", "earthshine")
    scenarios = [load_scenario(f"standard-{light}") for light in lights]
    for seed in range(3):
        poses = [one.trajectory.chaser_from_target(5.0, 5, seed).as_matrix() for one in scenarios]
        assert all(np.array_equal(poses[0], pose) for pose in poses)
    motion, mass = scenarios[0].motion, scenarios[0].target.mass
    assert isinstance(motion, NutationApproach)
    assert mass is not None
    assert mass.centre_of_mass_m == pytest.approx((0, 0, 0))
    across, _, about = mass.principal_kg_m2
    free = 360 / motion.period_s * (1 + np.cos(np.radians(motion.nutation_deg)) * (across / about - 1))
    assert motion.spin_deg_s == pytest.approx(free, rel=1e-3)
