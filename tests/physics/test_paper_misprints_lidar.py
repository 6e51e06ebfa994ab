"""What comes of following the print of Song et al. 2017 where nothing else shows it: the papers' page names these tests."""

import numpy as np
import pytest
from oracles import tumbling
from scipy.spatial.transform import Rotation

from estimators.lidar_filter.relative_orbit import OrbitRates, relative_jacobian
from estimators.lidar_filter.rigid_body import cross_matrix


def test_the_inertia_ratio_is_no_semi_latus_rectum():
    """θ̇² (1 + 2 r_c / p) with p1 = 2 in the place of p_c."""
    orbit = OrbitRates(1.078e-3, 6.9984e6, 0.0, 6.9984e6)
    right, printed = (relative_jacobian(one)[3, 0] for one in (orbit, orbit._replace(semi_latus_m=2.0)))
    assert right == pytest.approx(3 * 1.078e-3**2)
    assert printed / right == pytest.approx(2.3e6, rel=0.02)


def test_thrust_of_the_servicer_has_a_minus():
    """1 mm/s² along its radius for 100 s, by the two-body problem: half a t² to the other side."""
    chaser, target = tumbling.first_states()
    thrust = 1e-3 * chaser[:3] / np.linalg.norm(chaser[:3])

    def pushed(state: np.ndarray) -> np.ndarray:
        return tumbling.two_body(state) + np.concatenate([np.zeros(3), thrust])

    times = np.array([0.0, 100.0])
    free, pushed_off = (tumbling.integrated(rate, chaser, times)[-1] for rate in (tumbling.two_body, pushed))
    other = tumbling.integrated(tumbling.two_body, target, times)[-1]
    shift = tumbling.relative(pushed_off, other)[0] - tumbling.relative(free, other)[0]
    assert shift[0] == pytest.approx(-5.0, abs=0.1)


def turned(q: np.ndarray) -> np.ndarray:
    """R(q) after eq. (7), also of complex q (x, y, z, w)."""
    v = q[:3]
    return (q[3] ** 2 - v @ v) * np.eye(3) + 2 * np.outer(v, v) + 2 * q[3] * cross_matrix(v)


def delta(half: np.ndarray) -> np.ndarray:
    return np.array([*half, np.sqrt(1 - half @ half)])


def attitude_rate(a: np.ndarray, b: np.ndarray, body_rate: np.ndarray, estimated: np.ndarray, R: np.ndarray) -> np.ndarray:
    """Eq. (14) with (9): ½ [δq_0 (ω − ω̂) + δq_v × (ω + ω̂)], ω = R(δq_PB)ᵀ R(q̂_PB)ᵀ ω_B."""
    omega, guess = turned(delta(b)).T @ R.T @ body_rate, R.T @ estimated
    return (delta(a)[3] * (omega - guess) + cross_matrix(a) @ (omega + guess)) / 2


def test_the_terms_in_delta_are_of_first_order():
    """(17) as printed against the exact derivative by δq_v,P→B, at errors of 0 and near 0.03."""
    worst = {}
    for size in (0.0, 0.03):
        errors = []
        for seed in range(20):
            rng = np.random.default_rng(seed)
            R, estimated = Rotation.random(rng=rng).as_matrix(), rng.normal(0, 0.02, 3)
            a, b, d = (size * one / np.linalg.norm(one) for one in rng.normal(size=(3, 3)))
            d = d * np.linalg.norm(estimated)
            printed = (np.eye(3) + cross_matrix(a)) @ cross_matrix(R.T @ (d + estimated))
            steps = [np.imag(attitude_rate(a, b + 1e-30j * axis, estimated + d, estimated, R)) / 1e-30 for axis in np.eye(3)]
            exact = np.stack(steps, axis=1)
            errors.append(np.abs(printed - exact).max() / np.abs(exact).max())
        worst[size] = max(errors)
    assert worst[0.0] < 1e-14
    assert worst[0.03] == pytest.approx(0.06, abs=0.02)


def test_the_blocks_of_f_do_not_fit():
    def rows(F_p: np.ndarray, right: np.ndarray) -> list[list[np.ndarray]]:
        return [
            [np.ones((8, 8)), np.zeros((8, 6)), F_p, right],
            [np.zeros((6, 8)), np.ones((6, 6)), np.zeros((6, 3)), np.zeros((6, 3))],
            [np.zeros((6, 8)), np.zeros((6, 6)), np.zeros((6, 3)), np.zeros((6, 3))],
        ]

    with pytest.raises(ValueError, match="dimension"):
        np.block(rows(np.ones((3, 3)), np.zeros((3, 3))))
    whole = np.block(rows(np.concatenate([np.ones((3, 3)), np.zeros((5, 3))]), np.zeros((8, 3))))
    assert whole.shape == (20, 20)


def test_rho_in_the_principal_axes_is_another_place():
    rho = np.array([1.0, 0.6, -0.4])
    body_from_target = Rotation.from_quat([0.11, 0.55, -0.33, 0.76])
    apart = np.linalg.norm(rho - body_from_target.inv().apply(rho))
    assert apart == pytest.approx(1.12, abs=0.01)


def test_noise_of_each_step_would_be_more_than_the_motion():
    """A random walk of 20 000 steps of 0.05 s, against |ω| = 0.027 rad/s; read as a density it is 0.01."""
    walk = np.random.default_rng(6).normal(0, np.sqrt(1e-7), (2000, 20_000)).sum(axis=1).std()
    assert walk == pytest.approx(0.045, abs=0.002)
    assert walk > np.linalg.norm([0.02, 0.01, -0.015])
    assert np.sqrt(1e-7 * 1000) == pytest.approx(0.01)
