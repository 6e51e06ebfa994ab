"""Disturbed courses: their statistics, their independence from step, order and each other, and the same bits every time."""

import numpy as np
import pytest
from oracles.orbits import POSITION, VELOCITY, song, trajectory
from scipy import stats

from scenes.orbit_trajectory import TumbleTrajectory

SEEDS = range(150)
SPHERE = (700.0, 700.0, 700.0)  # torque-free rotation does nothing to it
ACCELERATION, TURNING = 1e-6, 1e-7  # densities, m²/s³ and rad²/s³: the paper's numbers
NOISE = {
    "target_acceleration_psd_m2_s3": ACCELERATION,
    "chaser_acceleration_psd_m2_s3": ACCELERATION,
    "target_angular_acceleration_psd_rad2_s3": TURNING,
}


def disturbed(**changes) -> TumbleTrajectory:
    return trajectory(SPHERE, **({"step_s": 1.0} | NOISE | changes))


def deviations(course: TumbleTrajectory, time_s: float, seeds=SEEDS) -> dict[str, np.ndarray]:
    """From the free course, (seeds, 3) each; positions and velocities in inertial axes, ω in body axes."""
    free = trajectory(SPHERE, step_s=1.0).instant(time_s, 0)
    found = [course.instant(time_s, seed) for seed in seeds]
    return {
        "target_m_s": np.array([now.velocities_m_s[0] - free.velocities_m_s[0] for now in found]),
        "chaser_m_s": np.array([now.velocities_m_s[1] - free.velocities_m_s[1] for now in found]),
        "target_m": np.array([now.positions_m[0] - free.positions_m[0] for now in found]),
        "omega_rad_s": np.array([now.omega_body_rad_s - free.omega_body_rad_s for now in found]),
    }


def agrees(samples: np.ndarray, variance: float) -> bool:
    """Whether zero-mean normal samples have this variance: their χ² inside its 99.9 % interval."""
    low, high = stats.chi2.interval(0.999, samples.size)
    return bool(low < (samples**2).sum() / variance < high)


@pytest.mark.parametrize("hold_s", [1.0, 5.0])
@pytest.mark.parametrize("time_s", [20.0, 60.0])
def test_the_variance_of_a_velocity_grows_by_the_density(time_s: float, hold_s: float):
    """q t, whatever the hold; of the position q t³/3, plus the hold's share q t h²/12 (sum over the held pieces)."""
    found = deviations(disturbed(noise_hold_s=hold_s), time_s)
    assert agrees(found["target_m_s"], ACCELERATION * time_s)
    assert agrees(found["chaser_m_s"], ACCELERATION * time_s)
    assert agrees(found["omega_rad_s"], TURNING * time_s)
    assert agrees(found["target_m"], ACCELERATION * time_s * (time_s**2 / 3 - hold_s**2 / 12))
    assert not agrees(found["target_m_s"], 1.5 * ACCELERATION * time_s)


def test_the_disturbances_are_independent():
    """Of each other, of the axes and of the next interval."""
    early, late = (deviations(disturbed(), time_s) for time_s in (20.0, 40.0))
    columns = np.column_stack(
        [early["target_m_s"], early["chaser_m_s"], early["omega_rad_s"], late["target_m_s"] - early["target_m_s"]]
    )
    correlation = np.corrcoef(columns.T) - np.eye(12)
    assert np.abs(correlation).max() < 4.2 / np.sqrt(len(SEEDS))  # 66 pairs, each about N(0, 1/n)


def test_one_density_changes_no_other_disturbance():
    alone = disturbed(target_acceleration_psd_m2_s3=0.0).instant(30.0, 3)
    both = disturbed().instant(30.0, 3)
    assert np.array_equal(alone.positions_m[1], both.positions_m[1])
    assert np.array_equal(alone.omega_body_rad_s, both.omega_body_rad_s)
    assert not np.array_equal(alone.positions_m[0], both.positions_m[0])


def test_the_step_does_not_change_the_disturbances():
    coarse, fine = (disturbed(step_s=step_s).instant(47.3, 1) for step_s in (1.0, 0.125))
    assert np.abs(coarse.positions_m - fine.positions_m).max() < 2e-8
    assert np.abs(coarse.omega_body_rad_s - fine.omega_body_rad_s).max() < 1e-15
    assert np.abs(coarse.positions_m - disturbed().instant(47.3, 2).positions_m).max() > 1e-3


@pytest.mark.parametrize("noise", [{}, NOISE])
def test_any_order_gives_the_same_bits(noise):
    """Forwards, backwards, alone, before time 0, at and between grid points."""
    times_s = [-3.21, -0.05, 0.0, 0.025, 0.1, 7.0, 7.1, 99.95, 30.000001]
    forwards, backwards = trajectory(**noise), trajectory(**noise)
    first = {time_s: forwards.instant(time_s, 9) for time_s in sorted(times_s)}
    for time_s in sorted(times_s, reverse=True):
        for course in (backwards, forwards, trajectory(**noise)):
            now = course.instant(time_s, 9)
            for name in ("positions_m", "velocities_m_s", "inertial_from_body", "omega_body_rad_s", "inertial_from_chaser"):
                assert np.array_equal(getattr(now, name), getattr(first[time_s], name)), (time_s, name)


def test_a_course_has_no_steps_in_it():
    """Across grid points, and across time 0, positions go on at their velocity; the seed says which course it is."""
    course = trajectory(**NOISE)
    for time_s in (-1.0, 0.0, 5.0, 511.9999, 512.0):
        before, after = course.instant(time_s - 1e-4, 4), course.instant(time_s + 1e-4, 4)
        drift = after.positions_m - before.positions_m - 1e-4 * (after.velocities_m_s + before.velocities_m_s)
        assert np.abs(drift).max() < 5e-9
        assert np.abs(after.omega_body_rad_s - before.omega_body_rad_s).max() < 1e-6
    assert not np.array_equal(course.instant(1.0, 4).positions_m, course.instant(1.0, 5).positions_m)


def test_more_seeds_than_are_kept_come_back_the_same():
    course = trajectory(**NOISE)
    first = [course.instant(2.0, seed).positions_m for seed in range(12)]
    assert all(np.array_equal(course.instant(2.0, seed).positions_m, first[seed]) for seed in range(12))


def test_without_disturbances_the_seed_does_not_matter():
    assert np.array_equal(trajectory().instant(12.0, 0).positions_m, trajectory().instant(12.0, 1).positions_m)
    assert song().target_orbit.tolist() == [POSITION.tolist(), VELOCITY.tolist()]
