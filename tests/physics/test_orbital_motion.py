"""Two craft in orbit, one tumbling: against an independent integration, conservation laws, and the paper's relative equations."""

from itertools import pairwise

import numpy as np
import pytest
from oracles.orbits import MU, OMEGA, POSITION, PRINCIPAL, VELOCITY, free_turning, kepler, song, trajectory
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from scenes.errors import UsageError
from scenes.inertia import MassProperties
from scenes.orbit import chaser_orbit, eccentricity, lvlh, mean_motion_rad_s, relative_state, semi_major_axis_m

TIMES_S = np.linspace(0.0, 1000.0, 51)
MM = 1e-3


@pytest.fixture(scope="module")
def paper():
    return trajectory()


@pytest.fixture(scope="module")
def instants(paper):
    return [paper.instant(time_s, 0) for time_s in TIMES_S]


def relative(course, times_s=TIMES_S) -> np.ndarray:
    """(n, 6): position and velocity in the chaser's LVLH."""
    names = ("rel_x_m", "rel_y_m", "rel_z_m", "rel_vx_m_s", "rel_vy_m_s", "rel_vz_m_s")
    return np.array([[row[name] for name in names] for row in (course.truth_columns(time_s, 0) for time_s in times_s)])


def test_the_target_turns_as_the_independent_integration_says(instants):
    axes, omega = free_turning(TIMES_S)
    assert np.abs([now.omega_body_rad_s for now in instants] - omega).max() < 1e-12
    assert np.abs([now.inertial_from_body for now in instants] - axes).max() < 1e-10


def test_both_craft_fall_as_the_independent_integration_says(instants):
    chaser = song().chaser_orbit()
    expected = kepler(POSITION, VELOCITY, TIMES_S)[:, :3] - kepler(*chaser, TIMES_S)[:, :3]
    found = np.array([now.positions_m[0] - now.positions_m[1] for now in instants])
    assert np.abs(found - expected).max() < 1e-6


def test_energy_and_angular_momentum_are_kept(instants):
    momenta = np.array([now.inertial_from_body @ (PRINCIPAL * now.omega_body_rad_s) for now in instants])
    energies = np.array([PRINCIPAL @ now.omega_body_rad_s**2 / 2 for now in instants])
    assert np.abs(energies / energies[0] - 1).max() < 1e-12
    assert np.abs(np.linalg.norm(momenta, axis=1) / np.linalg.norm(momenta[0]) - 1).max() < 1e-12
    assert np.abs(momenta - momenta[0]).max() / np.linalg.norm(momenta[0]) < 1e-11  # nor does it turn
    orbits = [(now.positions_m[1], now.velocities_m_s[1]) for now in instants]
    assert np.ptp([semi_major_axis_m(*orbit) for orbit in orbits]) < 1e-6
    assert np.ptp([np.linalg.norm(np.cross(*orbit)) for orbit in orbits]) / np.linalg.norm(np.cross(*orbits[0])) < 1e-12


def test_the_papers_tumble(paper):
    """A lamina that goes about its stable axis: the range of each rate, and 498 s of nutation."""
    rates = np.array([paper.instant(float(time_s), 0).omega_body_rad_s for time_s in range(1000)])
    assert np.abs(rates[:, 0]).max() == pytest.approx(0.0224, abs=5e-5)
    assert [rates[:, 2].min(), rates[:, 2].max()] == pytest.approx([-0.0161, -0.0096], abs=1e-4)
    rising = [time_s for time_s, (a, b) in enumerate(pairwise(rates[:, 1])) if a < 0 <= b]
    assert np.diff(rising) == pytest.approx([498.0], abs=1.0)


def test_the_papers_orbits():
    assert semi_major_axis_m(POSITION, VELOCITY) == pytest.approx(6_998_376.46, abs=0.01)
    assert eccentricity(POSITION, VELOCITY) == pytest.approx(1.0507e-5, abs=1e-9)
    assert mean_motion_rad_s(POSITION, VELOCITY) == pytest.approx(1.078383e-3, abs=1e-9)
    chaser = song().chaser_orbit()
    assert chaser[0] == pytest.approx([6_998_419.9995, 1.0471, -59.9906], abs=1e-4)
    assert lvlh(*chaser, j2=False).omega_lvlh_rad_s[2] == pytest.approx(1.07837e-3, abs=2e-8)


@pytest.mark.parametrize("j2", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_the_chasers_orbit_has_the_target_where_it_was_asked_for(seed: int, j2: bool):
    """The fixed point's residual, to the last digits of a position in orbit: inclined orbits, up to 20 km apart."""
    rng = np.random.default_rng(seed)
    position, velocity = rng.normal(size=3) * 10.0 ** rng.uniform(1, 4.3), rng.normal(size=3)
    turn = Rotation.random(rng=rng).as_matrix()
    target = np.stack([turn @ POSITION, turn @ VELOCITY])
    chaser = chaser_orbit(target, position, velocity, j2=j2)
    found = relative_state(lvlh(*chaser, j2=j2), *(target - chaser))
    np.testing.assert_allclose(found[0], position, atol=1e-8)
    np.testing.assert_allclose(found[1], velocity, atol=1e-10)
    at_the_target = relative_state(lvlh(*target, j2=j2), *(target - chaser))
    assert np.abs(at_the_target[0] - position).max() > 1e-5  # whose frame it is matters


def eq_2(state, rate, radius, radius_rate, semi_latus_rectum):
    """Song et al. 2017, eq. (2): p_c is the semi-latus rectum, all orbit quantities are the chaser's."""
    x, y, z, vx, vy, vz = state
    ratio = radius / semi_latus_rectum
    ax = x * rate**2 * (1 + 2 * ratio) + 2 * rate * (vy - y * radius_rate / radius)
    ay = -2 * rate * (vx - x * radius_rate / radius) + y * rate**2 * (1 - ratio)
    return [vx, vy, vz, ax, ay, -z * rate**2 * ratio]


def along_eq_2(start, position, velocity, times_s, widening=1.0):
    """Relative states by eq. (2) along the chaser's two-body orbit. ``widening``: of p_c, for the control."""
    moment = np.linalg.norm(np.cross(position, velocity))

    def rates(_, both):
        p, v = both[:3], both[3:6]
        radius = np.linalg.norm(p)
        relative_rates = eq_2(both[6:], moment / radius**2, radius, p @ v / radius, widening * moment**2 / MU)
        return np.concatenate([v, -MU * p / radius**3, relative_rates])

    start = np.concatenate([position, velocity, start])
    done = solve_ivp(rates, (0, times_s[-1]), start, "DOP853", times_s, rtol=1e-12, atol=1e-9)
    return done.y[6:].T


def test_eq_2_follows_two_bodies_within_a_millimetre(paper):
    truth, chaser = relative(paper), song().chaser_orbit()
    predicted = along_eq_2(truth[0], *chaser, TIMES_S)
    assert np.abs(predicted - truth)[:, :3].max() < 1 * MM
    assert np.abs(predicted - truth)[:, 3:].max() < 2e-6
    wrong = along_eq_2(truth[0], *chaser, TIMES_S, widening=1.001)
    assert np.abs(wrong - truth)[:, :3].max() > 10 * MM


@pytest.mark.parametrize(("e", "most_mm"), [(0.0, 5), (0.1, 10), (0.3, 20)])
def test_eq_2_holds_on_an_ellipse(e: float, most_mm: float):
    """One revolution from perigee; what is left is linearisation, (67 m)² over the radius, not the ellipse."""
    radius = 7.0e6
    position, velocity = np.array([radius, 0, 0]), np.array([0, np.sqrt(MU * (1 + e) / radius), 0])
    start = {"type": "state", "position_m": (30.0, 0.0, 60.0), "velocity_m_s": (0.0, -0.066, 0.0)}
    at = {"target_position_m": position.tolist(), "target_velocity_m_s": velocity.tolist(), "relative": start, "step_s": 1.0}
    times_s = np.linspace(0, 2 * np.pi / mean_motion_rad_s(position, velocity), 20)
    course = trajectory(**at, roll_reference=(0.0, 1.0, 1.0))
    truth = relative(course, times_s)
    predicted = along_eq_2(truth[0], *song(**at).chaser_orbit(), times_s)
    linear_mm = np.abs(truth[:, :3]).max() ** 2 / radius / MM
    assert np.abs(predicted - truth)[:, :3].max() < max(most_mm, 20 * linear_mm) * MM


@pytest.mark.parametrize("j2", [False, True])
def test_relative_velocity_is_the_rate_of_relative_position(j2: bool):
    """Also where the orbit's plane turns: a polar orbit about a flat Earth."""
    polar = Rotation.from_rotvec([80.0, 0.0, 0.0], degrees=True).apply(VELOCITY)
    course = trajectory(target_velocity_m_s=polar.tolist(), roll_reference=(1.0, 0.3, 0.2), j2=j2)
    for time_s in (0.0, 411.0, 730.0):
        before, now, after = relative(course, [time_s - 1.0, time_s, time_s + 1.0])
        assert (after - before)[:3] / 2.0 == pytest.approx(now[3:], abs=3e-8)


def test_flatness_shifts_the_relative_position_by_15_cm(paper):
    off = relative(trajectory(j2=True), [0.0, 1000.0])[:, :3] - relative(paper, [0.0, 1000.0])[:, :3]
    assert np.linalg.norm(off, axis=1) == pytest.approx([0.0, 0.15], abs=0.005)


def test_flatness_turns_the_nodes_as_theory_says():
    """Secular drift of the node, −³⁄₂ n J₂ (R/p)² cos i (Vallado, eq. (9-37)), over one revolution at 50 deg."""
    inclination = np.radians(50.0)
    speed = np.sqrt(MU / 7.0e6)
    velocity = [0.0, speed * np.cos(inclination), speed * np.sin(inclination)]
    course = trajectory(
        target_position_m=(7.0e6, 0.0, 0.0), target_velocity_m_s=velocity, j2=True, roll_reference=(1, 0.2, 0.1), step_s=1.0
    )
    n = speed / 7.0e6
    moments = []
    for time_s in np.linspace(0, 2 * np.pi / n, 25)[[0, -1]]:
        now = course.instant(float(time_s), 0)
        moments.append(np.cross(now.positions_m[0], now.velocities_m_s[0]))
    nodes = [np.arctan2(moment[0], -moment[1]) for moment in moments]
    expected = -1.5 * n * 1.08262668e-3 * (6_378_137.0 / 7.0e6) ** 2 * np.cos(inclination) * 2 * np.pi / n
    assert nodes[1] - nodes[0] == pytest.approx(expected, rel=5e-3)


def test_gravity_gradient_keeps_jacobis_integral_on_a_circular_orbit():
    """½ ω·Iω − n·Iω + ³⁄₂ n² x·Ix, with x radial and n along the normal (Hughes, Spacecraft Attitude Dynamics, section 9.3)."""
    radius = 7.0e6
    n = np.sqrt(MU / radius**3)
    course = trajectory(
        gravity_gradient=True, target_position_m=(radius, 0, 0), target_velocity_m_s=(0, n * radius, 0), roll_reference=(0, 1, 1)
    )

    def integrals(time_s: float):
        now = course.instant(time_s, 0)
        radial, normal = now.inertial_from_body.T @ now.positions_m[0] / radius, now.inertial_from_body.T @ [0, 0, 1.0]
        energy = PRINCIPAL @ now.omega_body_rad_s**2 / 2
        return energy - n * normal @ (PRINCIPAL * now.omega_body_rad_s) + 1.5 * n**2 * PRINCIPAL @ radial**2, energy

    jacobi, energy = np.array([integrals(time_s) for time_s in TIMES_S]).T
    assert np.ptp(jacobi) / jacobi[0] < 1e-9
    assert np.ptp(energy) / energy[0] > 1e-3  # the control: the torque does work


def test_the_gradients_torque_is_as_large_as_the_paper_leaves_out():
    """At most ³⁄₂ n² of the difference of moments over the least: 1.7e-6 rad/s² for this body."""
    free, pulled = trajectory().instant(1.0, 0), trajectory(gravity_gradient=True).instant(1.0, 0)
    rate = np.abs(pulled.omega_body_rad_s - free.omega_body_rad_s).max()
    assert 1e-8 < rate < 1.8e-6


@pytest.mark.parametrize(("rate", "drift_m"), [("mean-motion", 0.0), ("printed", 3.9)])
def test_the_printed_rate_drifts_and_the_mean_motion_does_not(rate: str, drift_m: float):
    """Per 1000 s, from one whole revolution: 2 % more speed than the closed path has."""
    course = trajectory(relative={"type": "ellipse", "amplitude_m": 30.0, "rate": rate}, step_s=0.5)
    period_s = 2 * np.pi / mean_motion_rad_s(POSITION, VELOCITY)
    start, end = relative(course, [0.0, period_s])
    assert (end - start)[1] / period_s * 1000 == pytest.approx(drift_m, abs=0.01)
    assert start[:3] == pytest.approx([30.0, 0.0, 60.0], abs=1e-8)
    assert start[4] == pytest.approx({"mean-motion": -0.06470, "printed": -0.06600}[rate], abs=1e-5)


def test_the_boresight_meets_the_centre_of_mass_and_the_picture_stays_upright(paper):
    mass = MassProperties(
        principal_kg_m2=tuple(PRINCIPAL), centre_of_mass_m=(-1.0, -0.6, 0.4), quaternion_wxyz=(0.76, -0.11, -0.55, 0.33)
    )
    other = trajectory(mass=mass)
    for time_s in TIMES_S:
        now = paper.instant(time_s, 0)
        x, y, z = other.chaser_from_target(time_s, 0, 0).apply(mass.centre_of_mass_m)
        assert (x, y) == pytest.approx((0.0, 0.0), abs=5e-9)
        assert z == pytest.approx(np.linalg.norm(now.positions_m[0] - now.positions_m[1]), abs=5e-9)
        right, down = now.inertial_from_chaser[:, 0], now.inertial_from_chaser[:, 1]
        assert right[2] == pytest.approx(0.0, abs=1e-15)
        assert down[2] < 0
        assert np.linalg.det(now.inertial_from_chaser) == pytest.approx(1.0)


@pytest.mark.parametrize("reference", [(0.0, 0.0, 1.0), (0.3, 1.0, -0.5)])
def test_angular_velocities_are_the_rates_of_the_attitudes(reference):
    turned = MassProperties(principal_kg_m2=tuple(PRINCIPAL), centre_of_mass_m=(1, 2, 3), quaternion_wxyz=(0.5, 0.5, 0.5, 0.5))
    course, half_s = trajectory(mass=turned, roll_reference=reference), 0.02
    for time_s in (0.0, 333.3, 900.02):
        before, after = (course.chaser_state(time_s + step_s, 0).inertial_from_chaser for step_s in (-half_s, half_s))
        found = (before.inv() * after).as_rotvec() / (2 * half_s)
        assert found == pytest.approx(course.chaser_state(time_s, 0).omega_chaser_rad_s, abs=1e-9)
        before, after = (course.chaser_from_target(time_s + step_s, 0, 0).rotation for step_s in (-half_s, half_s))
        found = (before.inv() * after).as_rotvec() / (2 * half_s)
        assert found == pytest.approx(course.omega_target_rad_s(time_s), abs=2e-9)


def test_the_tables_row_is_the_chasers_own_state_and_the_pose(paper):
    row, state = paper.truth_columns(412.3, 0), paper.chaser_state(412.3, 0)
    assert [row[f"chaser_{axis}_m"] for axis in "xyz"] == state.position_inertial_m.tolist()
    assert [row[f"chaser_v{axis}_m_s"] for axis in "xyz"] == state.velocity_inertial_m_s.tolist()
    attitudes = [Rotation.from_quat([row[f"{who}_q{axis}"] for axis in "wxyz"], scalar_first=True) for who in ("body", "chaser")]
    assert row["chaser_qw"] >= 0
    assert row["body_qw"] >= 0
    assert (attitudes[1] * state.inertial_from_chaser.inv()).magnitude() < 1e-15
    pose = paper.chaser_from_target(412.3, 0, 0)
    assert (attitudes[1].inv() * attitudes[0] * pose.rotation.inv()).magnitude() < 1e-14
    frame = lvlh(state.position_inertial_m, state.velocity_inertial_m_s, j2=False)
    sight = frame.inertial_from_lvlh @ [row["rel_x_m"], row["rel_y_m"], row["rel_z_m"]]
    assert attitudes[1].inv().apply(sight) == pytest.approx(pose.translation, abs=1e-8)
    moment = np.linalg.norm(np.cross(state.position_inertial_m, state.velocity_inertial_m_s))
    assert row["lvlh_rate_rad_s"] == pytest.approx(moment / row["orbit_radius_m"] ** 2, rel=1e-14)
    assert [row[f"omega_body_{axis}_rad_s"] for axis in "xyz"] == paper.instant(412.3, 0).omega_body_rad_s.tolist()


def test_a_line_of_sight_along_the_roll_reference_is_refused():
    """The orbit is inclined by 1 deg, so the inertial z lies 1 deg from its normal, on the side of its motion."""
    start = {"type": "state", "position_m": (0.3, 60 * np.sin(np.radians(1.0)), 60 * np.cos(np.radians(1.0)))}
    with pytest.raises(UsageError, match=r"motion\.roll_reference: at 0 s the line of sight comes within .* deg of the direction"):
        trajectory(relative=start).chaser_from_target(0.0, 0, 0)
    across = trajectory(relative=start, roll_reference=(1.0, 0.0, 0.0)).instant(0.0, 0).inertial_from_chaser
    assert across[:, 2] == pytest.approx([0.0, 0.0, 1.0], abs=0.01)


def test_the_start_is_the_papers(paper):
    now = paper.instant(0.0, 0)
    assert now.omega_body_rad_s.tolist() == OMEGA.tolist()
    assert Rotation.from_matrix(now.inertial_from_body).as_quat() == pytest.approx(np.arange(1, 5) / np.sqrt(30), abs=5e-5)
