"""The mathematics of Song et al. 2017 without noise: every equation that a filter lives on, and the misprints as controls."""

from dataclasses import replace

import numpy as np
import pytest
from oracles import tumbling
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from estimators.lidar_filter import paper_filter_equations as paper
from estimators.lidar_filter import tumble_filter_state as at
from estimators.lidar_filter.chaser import ChaserOrbit, chaser_at, inertial_from_lvlh
from estimators.lidar_filter.paper_filter_parameters import PaperFilterParameters, Repairs
from estimators.lidar_filter.paper_filter_solution import errors_map, inertia_target
from estimators.lidar_filter.relative_orbit import OrbitRates, relative_jacobian
from estimators.lidar_filter.rigid_body import (
    angular_acceleration,
    angular_jacobians,
    angular_quadratic,
    body_acceleration,
    body_jacobians,
    cross_matrix,
    quadratic,
    quadratic_form,
    turned,
)
from estimators.lidar_filter.tumble_filter_parameters import NoiseParameters, TumbleParameters
from estimators.lidar_filter.tumble_filter_prediction import error_matrix, predicted
from estimators.lidar_filter.tumble_filter_state import TumbleState
from estimators.lidar_filter.tumble_filter_update import rotation_vectors, sensitivity
from scenes.inertia import BASIS, components_of, inertia_of
from scenes.recording import ChaserState

MENDED, PRINTED = Repairs(), PaperFilterParameters(printed=True).mended
STEP = 1e-30
RNG = np.random.default_rng(8)


def slope(function, at_point):
    """Jacobian of a function of a real vector by complex steps: exact to rounding."""
    columns = [np.imag(function(at_point + 1j * STEP * axis)) / STEP for axis in np.eye(len(at_point))]
    return np.stack(columns, axis=-1)


def relative_error(found, true):
    return np.abs(found - true).max() / np.abs(true).max()


def eq_3(q, p):
    """r = q ⊗ p, scalars last."""
    v, matrix = q[:3], np.zeros((4, 4), dtype=np.result_type(q, p))
    matrix[:3, :3] = q[3] * np.eye(3) + cross_matrix(v)
    matrix[:3, 3], matrix[3, :3], matrix[3, 3] = v, -v, q[3]
    return matrix @ p


def eq_4(p, q):
    """r = p ∘ q, scalars last."""
    v, matrix = p[:3], np.zeros((4, 4), dtype=np.result_type(q, p))
    matrix[:3, :3] = p[3] * np.eye(3) - cross_matrix(v)
    matrix[:3, 3], matrix[3, :3], matrix[3, 3] = v, -v, p[3]
    return matrix @ q


def R_of(q):
    """R(q) after eq. (7)."""
    v = q[:3]
    return (q[3] ** 2 - v @ v) * np.eye(3) + 2 * np.outer(v, v) + 2 * q[3] * cross_matrix(v)


def eq_2(r, v, orbit):
    """Acceleration in the chaser's orbital frame; p_c is the semi-latus rectum."""
    rate, radius, radius_rate, semi_latus = orbit
    share, growth = radius / semi_latus, radius_rate / radius
    x = r[0] * rate**2 * (1 + 2 * share) + 2 * rate * (v[1] - r[1] * growth)
    y = -2 * rate * (v[0] - r[0] * growth) + r[1] * rate**2 * (1 - share)
    return np.array([x, y, -r[2] * rate**2 * share])


def conjugate(q):
    return q * [-1, -1, -1, 1]


def delta(half_turn):
    """[a, √(1 − a·a)], for complex a too."""
    return np.array([*half_turn, np.sqrt(1 - half_turn @ half_turn)])


@pytest.fixture(params=range(4))
def case(request):
    """One random set of every quantity."""
    rng = np.random.default_rng(request.param)
    q_PA, q_PB = Rotation.random(2, rng=rng).as_quat()
    J = tumbling.J_TARGET + 0.1 * inertia_of(rng.normal(size=5))
    return {
        "q_PA": q_PA,
        "q_PB": q_PB,
        "omega": rng.normal(size=3) * 0.03,
        "p": rng.uniform(1, 3, 2),
        "J": 3 * J / np.trace(J),
        "rho": rng.normal(size=3),
        "r": rng.normal(size=3) * 60,
        "v": rng.normal(size=3) * 0.1,
        "orbit": OrbitRates(1.1e-3, 7.1e6, 55.0, 6.8e6),
        "R_HC": Rotation.random(rng=rng).as_matrix(),
        "R_AC": Rotation.random(rng=rng).as_matrix(),
    }


def test_the_two_products_of_the_paper_are_one_and_it_is_hamiltons():
    for p, q in Rotation.random(400, rng=RNG).as_quat().reshape(200, 2, 4):
        assert np.abs(eq_4(p, q) - eq_3(q, p)).max() < 1e-15
        assert np.abs(eq_3(q, p) - (Rotation.from_quat(q) * Rotation.from_quat(p)).as_quat()).max() < 2e-15  # it normalises
        assert np.abs(R_of(q) - Rotation.from_quat(q).as_matrix()).max() < 2e-15
        assert np.abs(R_of(eq_3(q, p)) - R_of(q) @ R_of(p)).max() < 2e-15
        assert np.abs(eq_3(q, p) - eq_3(p, q)).max() > 1e-3  # the order matters


def test_a_vector_between_q_and_its_conjugate_is_turned_back(case):
    q, w = case["q_PB"], np.array([*case["omega"], 0.0])
    found = eq_4(eq_4(q, w), conjugate(q))
    assert found[:3] == pytest.approx(R_of(q).T @ case["omega"], abs=1e-16)


def test_the_accelerations_derivatives(case):
    omega, p, J = case["omega"], case["p"], case["J"]
    by_omega, by_p = body_jacobians(omega, p)
    assert relative_error(by_omega, slope(lambda w: body_acceleration(w, p), omega)) < 1e-12
    assert relative_error(by_p, slope(lambda x: body_acceleration(omega, x), p)) < 1e-12
    inverse, j = np.linalg.inv(J), components_of(J)
    by_omega, by_j = angular_jacobians(omega, J, inverse)
    assert relative_error(by_omega, slope(lambda w: angular_acceleration(w, J, inverse), omega)) < 1e-12

    def of_inertia(components):
        matrix = np.eye(3) + np.einsum("i,ijk->jk", components, BASIS)
        return angular_acceleration(omega, matrix, np.linalg.inv(matrix))

    assert relative_error(by_j, slope(of_inertia, j)) < 1e-10


def test_what_is_quadratic_in_the_errors_of_rate_and_inertia(case):
    """Against second differences, which for steps of 1e-3 are good to 1e-6."""
    omega, J = case["omega"], case["J"]
    inverse, j = np.linalg.inv(J), components_of(J)
    errors = np.concatenate([0.01 * RNG.normal(size=(8, 3)), 0.3 * RNG.normal(size=(8, 5))], axis=1)
    slope_omega, slope_j = angular_jacobians(omega, J, inverse)
    B = angular_quadratic(omega, J, inverse, slope_omega, slope_j)
    found = np.einsum("na,iab,nb->ni", errors, B, errors)

    def acceleration(share):
        matrices = inertia_of(j + share * errors[:, 3:])
        return angular_acceleration(omega + share * errors[:, :3], matrices, np.linalg.inv(matrices))

    expected = (acceleration(1e-3) + acceleration(-1e-3) - 2 * acceleration(0)) / 2e-6
    assert relative_error(found, expected) < 1e-5
    form = quadratic_form(J, inverse)
    assert quadratic(form, omega) == pytest.approx(angular_acceleration(omega, J, inverse), abs=1e-16)
    two = [np.stack([one, one]) for one in (omega, J, inverse, slope_omega, slope_j)]
    assert angular_quadratic(*two)[1] == pytest.approx(B, abs=1e-12)


def test_both_forms_of_the_acceleration_are_one(case):
    axes, omega, p = R_of(case["q_PB"]), case["omega"], case["p"]
    J = inertia_target(p, axes)
    assert np.trace(J) == pytest.approx(3)
    found = axes @ angular_acceleration(axes.T @ omega, J, np.linalg.inv(J))
    assert found == pytest.approx(body_acceleration(omega, p), abs=1e-16)


def test_the_relative_motions_matrix_is_its_derivative(case):
    orbit = case["orbit"]
    state = np.concatenate([case["r"], case["v"]])
    found = slope(lambda x: np.concatenate([x[3:], eq_2(x[:3], x[3:], orbit)]), state)
    assert relative_error(relative_jacobian(orbit), found) < 1e-14


def test_the_recommended_filters_error_equation(case):
    """d/dt of E = exp(θ) = R̂ᵀR is E [ω]× − [ω̂]× E."""
    omega, J = case["omega"], case["J"]
    j = components_of(J)

    def rates(error):
        E = np.eye(3) + cross_matrix(error[at.ATTITUDE])  # to first order, which is all that the derivative sees
        turn = E @ cross_matrix(omega + error[at.OMEGA]) - cross_matrix(omega) @ E
        matrix = np.eye(3) + np.einsum("i,ijk->jk", j + error[at.INERTIA], BASIS)
        path = [error[at.VELOCITY], eq_2(error[at.POSITION], error[at.VELOCITY], case["orbit"])]
        acceleration = angular_acceleration(omega + error[at.OMEGA], matrix, np.linalg.inv(matrix))
        return np.concatenate([np.array([turn[2, 1], turn[0, 2], turn[1, 0]]), acceleration, np.zeros(5), *path, np.zeros(3)])

    F = error_matrix(omega, J, np.linalg.inv(J), relative_jacobian(case["orbit"]))
    assert relative_error(F, slope(rates, np.zeros(20))) < 1e-10


def test_the_recommended_filters_measurement(case):
    R, R_HC, rho, r = R_of(case["q_PA"]), case["R_HC"], case["rho"], case["r"]

    def pose(error):
        E = np.eye(3) + cross_matrix(error[at.ATTITUDE])
        turn = error[at.ATTITUDE] + error[at.DRIFT_ATTITUDE]
        place = R @ E @ (rho + error[at.OFFSET]) + R_HC @ (r + error[at.POSITION]) + error[at.DRIFT_POSITION]
        return np.concatenate([turn, place])

    assert relative_error(sensitivity(R, R_HC, rho), slope(pose, np.zeros(26))) < 1e-10


def paper_rates(case):
    """d/dt of the paper's errors: eq. (14) with (9), (18), (2), as a function of the errors."""
    q_PB, omega, p = case["q_PB"], case["omega"], case["p"]
    estimate = np.array([*(R_of(q_PB).T @ omega), 0.0])

    def rates(error):
        a, b = delta(error[paper.ATTITUDE]), delta(error[paper.BODY])
        turn = np.array([*(R_of(eq_3(q_PB, b)).T @ (omega + error[paper.OMEGA])), 0.0])
        half = (eq_4(turn, a) - eq_4(a, estimate)) / 2
        acceleration = body_acceleration(omega + error[paper.OMEGA], p + error[paper.RATIOS])
        path = [error[paper.VELOCITY], eq_2(error[paper.POSITION], error[paper.VELOCITY], case["orbit"])]
        return np.concatenate([half[:3], acceleration, np.zeros(2), *path, np.zeros(6)])

    return rates


def test_the_papers_system_matrix_mended_and_printed(case):
    """(15), (16), (18), F_t; (17) is the derivative by b and not by p; F_r as printed has the wrong sign before ∂/∂δω."""
    true = slope(paper_rates(case), np.zeros(20))
    motion = relative_jacobian(case["orbit"])
    F = paper.system_matrix(R_of(case["q_PB"]), case["omega"], case["p"], motion, MENDED)
    assert relative_error(F, true) < 1e-10
    assert np.abs(true[paper.ATTITUDE, paper.BODY]).max() > 1e-3
    assert np.abs(true[paper.ATTITUDE, paper.RATIOS]).max() == 0
    printed = paper.system_matrix(R_of(case["q_PB"]), case["omega"], case["p"], motion, PRINTED)
    assert printed[paper.ATTITUDE, paper.OMEGA] == pytest.approx(-true[paper.ATTITUDE, paper.OMEGA], abs=1e-12)
    unlike = np.argwhere(np.abs(printed - true) > 1e-10)
    assert {tuple(place) for place in unlike} <= {(i, j) for i in range(3) for j in range(3, 6)}


def test_the_papers_measurement_matrix_mended_and_printed(case):
    """(25), (26): H_1 as printed is half of what it should be, as δq_v is half an angle."""
    q_PA, R_AC, R_HC, rho, r = case["q_PA"], case["R_AC"], case["R_HC"], case["rho"], case["r"]

    def measured(error):
        q = eq_3(q_PA, delta(error[paper.ATTITUDE]))
        return np.concatenate([R_AC @ R_of(q) @ (rho + error[paper.OFFSET]) + R_HC @ (r + error[paper.POSITION]), q[:3]])

    true, R_PC = slope(measured, np.zeros(20)), R_AC @ R_of(q_PA)
    H = paper.measurement_matrix(q_PA, R_PC, R_HC, rho, MENDED)
    assert relative_error(H, true) < 1e-10
    printed = paper.measurement_matrix(q_PA, R_PC, R_HC, rho, PRINTED)
    assert relative_error(printed[:3, :3], true[:3, :3]) == pytest.approx(0.5, abs=1e-10)
    assert relative_error(printed[:, 3:], true[:, 3:]) < 1e-10
    assert np.linalg.det(H[3:, :3]) == pytest.approx(q_PA[3], abs=1e-12)  # so it is blind half a turn away


def test_the_papers_errors_in_the_targets_axes(case):
    q_PB, omega, p = case["q_PB"], case["omega"], case["p"]

    def ours(error):
        R = R_of(eq_3(q_PB, delta(error[paper.BODY])))
        moments = np.array([1.0, *(p + error[paper.RATIOS])])
        J = 3 * R.T @ np.diag(moments) @ R / moments.sum()
        turn, j = R.T @ (omega + error[paper.OMEGA]), np.einsum("iab,ab->i", BASIS, J)
        rest = (error[paper.POSITION], error[paper.VELOCITY], error[paper.OFFSET])
        return np.concatenate([2 * error[paper.ATTITUDE], turn, j, *rest])

    identity, zero = Rotation.identity(), np.zeros(3)
    state = paper.PaperState(0.0, identity, identity, omega, p, zero, zero, Rotation.from_quat(q_PB), zero, np.eye(20))
    assert relative_error(errors_map(state), slope(ours, np.zeros(20))) < 1e-10


def test_the_papers_noise_takes_each_density_to_its_own_place():
    Phi = np.eye(20)
    parameters = PaperFilterParameters(rotation_noise_rad2_s3=1e-9, translation_noise_m2_s3=1e-6)
    diagonal = np.diag(paper.process_noise(Phi, parameters, 2.0))
    assert diagonal[paper.OMEGA] == pytest.approx(2e-9)
    assert diagonal[paper.VELOCITY] == pytest.approx(2e-6)
    assert diagonal.sum() == pytest.approx(3 * 2e-9 + 3 * 2e-6)
    printed = np.diag(paper.process_noise(Phi, parameters.model_copy(update={"printed": True}), 2.0))
    assert printed[paper.OMEGA] == pytest.approx(2e-6)


def along(start, times_s, circular=False):
    """Eq. (2) integrated on a two-body chaser's own orbit from the first relative state, (times, 6)."""
    chaser, target = start
    path = np.concatenate(tumbling.relative(chaser, target))

    def rate(state):
        now = state[:6]
        identity, zero = Rotation.identity(), np.zeros(3)
        orbit = ChaserOrbit.of(ChaserState(0.0, identity, now[:3], now[3:], zero)).rates_at(0.0)
        orbit = orbit._replace(semi_latus_m=orbit.radius_m) if circular else orbit
        return np.concatenate([tumbling.two_body(now), relative_jacobian(orbit) @ state[6:]])

    return tumbling.integrated(rate, np.concatenate([chaser, path]), times_s)[:, 6:]


def test_eq_2_against_two_body_orbits_for_1000_s():
    times = np.linspace(0, 1000, 21)
    start = tumbling.first_states()
    chaser, target = (tumbling.integrated(tumbling.two_body, one, times) for one in start)
    r, v = tumbling.relative(chaser, target)
    found = along(start, times)
    assert np.linalg.norm(found[:, :3] - r, axis=1).max() < 1e-3
    assert np.linalg.norm(found[:, 3:] - v, axis=1).max() < 2e-6
    assert np.linalg.norm(r[-1] - r[0]) > 30  # it did move


@pytest.mark.parametrize(("eccentricity", "off_m"), [(0.1, 6e-3), (0.3, 15e-3)])
def test_eq_2_on_elliptic_orbits(eccentricity, off_m):
    """What is left is the linearisation; with a radius in the place of p_c it is tens of metres."""
    speed = np.sqrt(tumbling.GM * (1 + eccentricity) / 7e6)
    start = tumbling.first_states(np.array([7e6, 0, 0]), np.array([0, speed, 0]))
    times = np.linspace(0, 2 * np.pi * np.sqrt((7e6 / (1 - eccentricity)) ** 3 / tumbling.GM), 30)
    chaser, target = (tumbling.integrated(tumbling.two_body, one, times) for one in start)
    r, _ = tumbling.relative(chaser, target)
    span = np.linalg.norm(r, axis=1).max() / 67
    assert np.linalg.norm(along(start, times)[:, :3] - r, axis=1).max() < off_m * span**2
    assert np.linalg.norm(along(start, times, circular=True)[:, :3] - r, axis=1).max() > 10


def top(h, duration_s, J=None):
    """ω in target axes and inertial_from_target after ``duration_s`` by the filter's own steps."""
    J = tumbling.J_TARGET if J is None else J
    inverse, axes = np.linalg.inv(J), tumbling.AXES
    omega, attitude = axes.T @ tumbling.OMEGA_BODY, tumbling.INERTIAL_FROM_BODY * tumbling.BODY_FROM_TARGET
    history = []
    for _ in range(round(duration_s / h)):
        omega, turn = turned(lambda w: angular_acceleration(w, J, inverse), omega, h)
        attitude = attitude * Rotation.from_rotvec(turn)
        history.append(omega)
    return np.array(history), attitude


def test_the_filters_top_against_dop853_for_1000_s():
    truth = tumbling.quiet()
    history, attitude = top(0.125, 1000.0)
    assert np.abs(history[7::8] - truth.omega[1:]).max() < 1e-12
    assert np.abs(attitude.as_matrix() - truth.inertial_from_target[-1]).max() < 1e-10
    J = tumbling.J_TARGET
    energy = np.einsum("ki,ij,kj->k", history, J, history)
    momentum = np.linalg.norm(history @ J, axis=1)
    assert np.abs(energy / energy[0] - 1).max() < 1e-12
    assert np.abs(momentum / momentum[0] - 1).max() < 1e-12
    inertial = attitude.as_matrix() @ J @ history[-1]
    first = truth.inertial_from_target[0] @ J @ truth.omega[0]
    assert np.abs(inertial - first).max() < 1e-12


def test_the_filters_top_is_of_fourth_order():
    fine, _ = top(0.25, 200.0)
    ends = [top(h, 200.0) for h in (8.0, 4.0)]
    off = [np.abs(history[-1] - fine[-1]).max() for history, _ in ends]
    assert off[0] / off[1] == pytest.approx(16, rel=0.25)
    exact = tumbling.quiet().inertial_from_target[200]
    turns = [(attitude.inv() * Rotation.from_matrix(exact)).magnitude() for _, attitude in ends]
    assert turns[0] / turns[1] == pytest.approx(16, rel=0.35)


def state_of(case, P):
    zero, none = np.zeros(6), np.zeros((6, 6))
    j = components_of(case["J"])
    return TumbleState(0.0, Rotation.identity(), case["omega"], j, case["r"], case["v"], case["rho"], zero, none, P)


def test_the_predicted_covariance_is_van_loans(case):
    """Φ and Q over a second against the exponential of the block matrix (Van Loan 1978); Q as printed is not that."""
    parameters = TumbleParameters(noise=NoiseParameters(rotation_rad2_s3=1e-7, translation_m2_s3=1e-5, second_order=0))
    orbit = ChaserOrbit(0.5, 0.0, 1.0, 0.0)
    omega = 1e-9 * case["omega"]  # so that F is constant
    root = RNG.normal(size=(20, 20)) * 1e-3
    P = np.zeros((26, 26))
    P[:20, :20] = root @ root.T
    after = predicted(replace(state_of(case, P), omega_rad_s=omega), 1.0, orbit, parameters)
    F = error_matrix(omega, case["J"], np.linalg.inv(case["J"]), relative_jacobian(orbit.rates_at(0)))
    G = np.zeros((20, 20))
    G[range(3, 6), range(3, 6)], G[range(14, 17), range(14, 17)] = 1e-7, 1e-5
    block = expm(np.block([[-F, G], [np.zeros((20, 20)), F.T]]))
    Phi = block[20:, 20:].T
    exact = Phi @ P[:20, :20] @ Phi.T + Phi @ block[:20, 20:]
    assert relative_error(after.covariance[:20, :20], exact) < 1e-12
    noise = predicted(replace(state_of(case, 0 * P), omega_rad_s=omega), 1.0, orbit, parameters).covariance[:20, :20]
    assert np.abs(noise - Phi @ block[:20, 20:]).max() < 1e-16
    assert np.abs(paper.process_noise(Phi, PaperFilterParameters(), 1.0)[:3, :3]).max() > 2e-7 / 3  # 1e-7, where 1e-7/3 is right


def transition_error(longest_step_s):
    """Largest difference of any Φ_i Φ_iᵀ over 1 s from finite differences of the mean itself."""
    truth = tumbling.quiet()
    parameters = TumbleParameters(
        noise=NoiseParameters(rotation_rad2_s3=0, translation_m2_s3=0, second_order=0),
        longest_step_s=longest_step_s,
        longest_turn_rad=10,
    )
    orbit = ChaserOrbit.of(truth.chasers[0])
    j, zero = components_of(tumbling.J_TARGET), np.zeros((6, 6))
    attitude = Rotation.from_matrix(truth.inertial_from_target[0])
    motion = truth.omega[0], j, truth.r[0], truth.v[0], tumbling.OFFSET
    state = TumbleState(0.0, attitude, *motion, zero[0], zero, np.zeros((26, 26)))
    mean, worst = predicted(state, 1.0, orbit, parameters), 0.0
    for index, size in zip(range(20), [1e-5] * 3 + [1e-6] * 3 + [1e-5] * 5 + [1.0] * 9, strict=True):
        error = np.zeros(26)
        error[index] = size
        ends = [predicted(state.corrected(sign * error, state.covariance, 0.05), 1.0, orbit, parameters) for sign in (1, -1)]
        turns = [(mean.inertial_from_target.inv() * end.inertial_from_target).as_rotvec() for end in ends]
        others = [np.concatenate([e.omega_rad_s, e.inertia, e.position_m, e.velocity_m_s, e.offset_m]) for e in ends]
        found = np.concatenate([turns[0] - turns[1], others[0] - others[1]]) / (2 * size)
        P = np.zeros((26, 26))
        P[index, index] = 1.0
        spread = predicted(replace(state, covariance=P), 1.0, orbit, parameters).covariance[:20, :20]
        worst = max(worst, float(np.abs(np.outer(found, found) - spread).max()))
    return worst


def test_the_transition_matrix_while_the_target_turns():
    """F is taken at mid-step: of second order, and good enough at the longest step."""
    whole, half = transition_error(1.0), transition_error(0.5)
    assert whole < 3e-5
    assert whole / half == pytest.approx(4, rel=0.2)


def test_the_chaser_between_its_states():
    truth = tumbling.quiet()
    for dt, off_m in ((0.05, 1e-8), (-0.05, 1e-8)):
        times = np.array([100.0, 100.0 + dt])
        first = truth.chasers[100]
        exact = tumbling.integrated(
            tumbling.two_body, np.concatenate([first.position_inertial_m, first.velocity_inertial_m_s]), times
        )
        found = chaser_at(first, times[1])
        assert np.abs(found.position_inertial_m - exact[1, :3]).max() < off_m
        assert np.abs(found.velocity_inertial_m_s - exact[1, 3:]).max() < 1e-9
    onward = chaser_at(truth.chasers[100], 101.0)
    turn = (onward.inertial_from_chaser.inv() * truth.chasers[101].inertial_from_chaser).magnitude()
    assert turn < 3e-6  # over 1 s at 1e-3 rad/s; the rate itself changes
    axes, rate = tumbling.lvlh_axes(truth.chasers[101].position_inertial_m, truth.chasers[101].velocity_inertial_m_s)
    assert np.abs(inertial_from_lvlh(onward) - axes).max() < 1e-14
    ahead, there = ChaserOrbit.of(truth.chasers[100]).rates_at(110.0), ChaserOrbit.of(truth.chasers[110]).rates_at(110.0)
    assert ahead.anomaly_rate_rad_s == pytest.approx(there.anomaly_rate_rad_s, rel=1e-10)
    assert ahead == pytest.approx(there, rel=1e-4)
    assert ChaserOrbit.of(truth.chasers[101]).rates_at(101.0).anomaly_rate_rad_s == pytest.approx(rate, rel=1e-12)


def test_relative_attitude_in_inertial_space_is_eqs_8_and_9():
    """q_PA by Runge-Kutta steps of the printed equations, against R_AI(t) R_IA(0) R_PA(0) exp(turn), for constant rates."""
    omega_A, omega_P, q = np.array([1e-3, -2e-3, 3e-4]), np.array([0.02, 0.01, -0.015]), Rotation.random(rng=RNG).as_quat()

    def rate(value):
        relative = np.array([*(omega_P - R_of(value).T @ omega_A), 0.0])  # eq. (9), both in target axes
        return eq_4(relative, value) / 2  # eq. (8)

    found = q
    for _ in range(400):
        found = tumbling.stepped(rate, found, 0.125)
    back, turn = Rotation.from_rotvec(-50 * omega_A), Rotation.from_rotvec(50 * omega_P)
    expected = (back * Rotation.from_quat(q) * turn).as_quat()
    assert np.abs(found - expected * np.sign(expected @ found)).max() < 1e-11


def test_rotation_vectors_of_matrices_are_scipys():
    turns = Rotation.from_rotvec(Rotation.random(500, rng=RNG).as_rotvec() * np.geomspace(1e-9, 1, 500)[:, None])
    for some in (turns[:400], turns):  # the others turn by up to half a circle, which is SciPy's own
        assert np.abs(rotation_vectors(some.as_matrix()) - some.as_rotvec()).max() < 1e-13
    assert (rotation_vectors(np.eye(3)) == 0).all()
    assert rotation_vectors(np.diag([1.0, -1.0, -1.0])) == pytest.approx([np.pi, 0, 0])
