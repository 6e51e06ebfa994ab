"""Truth for filters of a tumbling target, by means of its own: rotation matrices and two-body orbits under SciPy's DOP853.

The set-up of Song et al. 2017, § 5.1, with its mean motion in the place of the printed 0.0011 rad/s. White disturbances are
piecewise constant, one value a step, and integrated by a classical Runge-Kutta step for many seeds at once.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.recording import ChaserState

GM = 3.986004418e14
MOMENTS = np.array([500.0, 1000.0, 1500.0])
RATIOS = MOMENTS[1:] / MOMENTS[0]
BODY_FROM_TARGET = Rotation.from_quat([0.11, 0.55, -0.33, 0.76])
OFFSET = np.array([1.0, 0.6, -0.4])  # ρ, target axes
INERTIAL_FROM_BODY = Rotation.from_quat([1.0, 2.0, 3.0, 4.0])
OMEGA_BODY = np.array([0.02, 0.01, -0.015])
CHASER_M, CHASER_M_S = np.array([6998450.0, 0, 0]), np.array([0, 7545.7, 131.7])
RELATIVE_M, RELATIVE_M_S = np.array([30.0, 0, 60.0]), np.array([0, -0.0647, 0])
MOUNT = RigidTransform.from_translation([0, 0, 2.0])
AXES = BODY_FROM_TARGET.as_matrix()
J_TARGET = 3 * AXES.T @ np.diag(MOMENTS) @ AXES / MOMENTS.sum()


def lvlh_axes(position, velocity):
    """inertial_from_lvlh (..., 3, 3) and the frame's inertial rate about its z."""
    x = position / np.linalg.norm(position, axis=-1, keepdims=True)
    momentum = np.cross(position, velocity)
    z = momentum / np.linalg.norm(momentum, axis=-1, keepdims=True)
    rate = np.linalg.norm(momentum, axis=-1) / np.sum(position**2, axis=-1)
    return np.stack([x, np.cross(z, x), z], axis=-1), rate


def relative(chaser, target):
    """r and v (..., 3) in the chaser's orbital frame from inertial states (..., 6)."""
    axes, rate = lvlh_axes(chaser[..., :3], chaser[..., 3:])
    r = np.einsum("...ji,...j->...i", axes, target[..., :3] - chaser[..., :3])
    v = np.einsum("...ji,...j->...i", axes, target[..., 3:] - chaser[..., 3:])
    return r, v - rate[..., None] * np.stack([-r[..., 1], r[..., 0], 0 * r[..., 0]], axis=-1)


def first_states(position=CHASER_M, velocity=CHASER_M_S, r=RELATIVE_M, v=RELATIVE_M_S):
    """Inertial states (6,) of chaser and target."""
    axes, rate = lvlh_axes(position, velocity)
    target = [position + axes @ r, velocity + axes @ (v + np.cross([0, 0, rate], r))]
    return np.concatenate([position, velocity]), np.concatenate(target)


def two_body(state):
    """d/dt of inertial states (..., 6)."""
    pull = -GM * state[..., :3] / np.linalg.norm(state[..., :3], axis=-1, keepdims=True) ** 3
    return np.concatenate([state[..., 3:], pull], axis=-1)


def rigid(state, moments=MOMENTS):
    """d/dt of inertial_from_body, row by row, and ω in principal axes (..., 12)."""
    x, y, z = np.moveaxis(state[..., 9:], -1, 0)
    R = state[..., :9].reshape((*state.shape[:-1], 3, 3))
    columns = [R[..., 1] * z[..., None] - R[..., 2] * y[..., None], R[..., 2] * x[..., None] - R[..., 0] * z[..., None]]
    turn = np.stack([*columns, R[..., 0] * y[..., None] - R[..., 1] * x[..., None]], axis=-1)
    a, b, c = moments
    omega = np.stack([(b - c) / a * y * z, (c - a) / b * z * x, (a - b) / c * x * y], axis=-1)
    return np.concatenate([turn.reshape((*state.shape[:-1], 9)), omega], axis=-1)


def integrated(rate, start, times_s):
    """States (times, n) by DOP853 at its tightest."""
    done = solve_ivp(lambda _, y: rate(y), (times_s[0], times_s[-1]), start, "DOP853", times_s, rtol=3e-14, atol=1e-15)
    assert done.success
    return done.y.T


@dataclass(frozen=True)
class Truth:
    """States at ``times_s`` (K,); arrays (K, ...) or with seeds (K, M, ...). The chaser is the same for all seeds."""

    times_s: np.ndarray
    chasers: list[ChaserState]
    inertial_from_target: np.ndarray
    omega: np.ndarray
    r: np.ndarray
    v: np.ndarray

    def pose(self, k):
        """lidar_from_target: rotations (..., 3, 3) and origins (..., 3) at times_s[k]."""
        state = self.chasers[k]
        lidar_from_inertial = state.inertial_from_chaser.inv().as_matrix()
        axes, _ = lvlh_axes(state.position_inertial_m, state.velocity_inertial_m_s)
        rotation = lidar_from_inertial @ self.inertial_from_target[k]
        return rotation, rotation @ OFFSET + self.r[k] @ (lidar_from_inertial @ axes).T - MOUNT.translation


def pointing(direction):
    """inertial_from_chaser (..., 3, 3) with z along ``direction`` (..., 3) and y near −J2000 z."""
    z = direction / np.linalg.norm(direction, axis=-1, keepdims=True)
    x = np.cross(np.broadcast_to([0, 0, -1.0], z.shape), z)
    x = x / np.linalg.norm(x, axis=-1, keepdims=True)
    return np.stack([x, np.cross(z, x), z], axis=-1)


def chaser_states(times_s, chaser, target):
    """The chaser, which keeps the LIDAR on the target; its turn rate from differences over 20 ms."""
    states = []
    for t, c, aim in zip(times_s, chaser, target[:, :3] - chaser[:, :3], strict=True):
        drift = target[len(states), 3:] - c[3:]
        ends = Rotation.from_matrix(pointing(np.stack([aim - 0.01 * drift, aim + 0.01 * drift])))
        omega = (ends[0].inv() * ends[1]).as_rotvec() / 0.02
        states.append(ChaserState(float(t), Rotation.from_matrix(pointing(aim)), c[:3], c[3:], omega))
    return states


@cache
def quiet(duration_s=1000, step_s=1.0):
    """Nothing disturbs: two-body orbits and a free top."""
    times = np.arange(0, duration_s + step_s / 2, step_s)
    chaser, target = (integrated(two_body, start, times) for start in first_states())
    body = integrated(rigid, np.concatenate([INERTIAL_FROM_BODY.as_matrix().ravel(), OMEGA_BODY]), times)
    return of_states(times, chaser, target, target, body)


def of_states(times, chaser, aimed_at, target, body):
    """A ``Truth`` from inertial states and the top's (K, ..., 12)."""
    shape = (*target.shape[:-1], 3, 3)
    chaser_all = chaser.reshape(len(times), *[1] * (target.ndim - 2), 6)
    r, v = relative(chaser_all, target)
    return Truth(times, chaser_states(times, chaser, aimed_at), body[..., :9].reshape(shape) @ AXES, body[..., 9:] @ AXES, r, v)


@cache
def disturbed(seeds, duration_s=1000, rotation_rad2_s3=1e-7, translation_m2_s3=1e-7, step_s=0.5):
    """White angular and linear accelerations of these densities on each target, ``seeds`` of them; every second is kept."""
    rng = np.random.default_rng(11)
    body = np.tile(np.concatenate([INERTIAL_FROM_BODY.as_matrix().ravel(), OMEGA_BODY]), (seeds, 1))
    start, target = first_states()
    target, sigma = np.tile(target, (seeds, 1)), np.sqrt(np.array([rotation_rad2_s3, translation_m2_s3]) / step_s)
    bodies, targets = [body], [target]
    for step in range(1, round(duration_s / step_s) + 1):
        push = rng.standard_normal((2, seeds, 3)) * sigma[:, None, None]
        body = stepped(lambda s, a=push[0]: rigid(s) + np.concatenate([np.zeros((seeds, 9)), a], axis=1), body, step_s)
        target = stepped(lambda s, a=push[1]: two_body(s) + np.concatenate([np.zeros((seeds, 3)), a], axis=1), target, step_s)
        if step % round(1 / step_s) == 0:
            bodies.append(body)
            targets.append(target)
    calm = quiet(duration_s)
    chaser = np.array([np.concatenate([c.position_inertial_m, c.velocity_inertial_m_s]) for c in calm.chasers])
    assert np.allclose(chaser[0], start)
    return of_states(calm.times_s, chaser, np.mean(targets, axis=1), np.array(targets), np.array(bodies))


def stepped(rate, state, h):
    """The classical fourth-order step."""
    a = rate(state)
    b = rate(state + h / 2 * a)
    c = rate(state + h / 2 * b)
    d = rate(state + h * c)
    return state + h / 6 * (a + 2 * b + 2 * c + d)
