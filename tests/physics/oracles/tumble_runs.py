"""Many seeds of the recommended filter at once, on registrations that are truth plus Gaussian errors."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from estimators.lidar_filter.chaser import ChaserOrbit
from estimators.lidar_filter.measurement import PoseMeasurement
from estimators.lidar_filter.tumble_filter import begun, stated
from estimators.lidar_filter.tumble_filter_parameters import TumbleParameters
from estimators.lidar_filter.tumble_filter_prediction import predicted
from estimators.lidar_filter.tumble_filter_update import View, updated
from oracles import tumbling
from scenes.inertia import components_of, labelled_nearest

PAPER = (0.02, 1.0)  # rad each axis and m: R of Song et al. 2017
FINE = (0.005, 0.05)
GATE = 22.46  # χ²₆ at 0.999


def rms(values):
    """Root of the mean of squares."""
    return float(np.sqrt(np.mean(np.square(values))))


@dataclass(frozen=True)
class Run:
    """What the filters did: errors and their claimed 1σ (K, M, 20), NEES (K, M), NIS (K, M), J (K, M, 3, 3)."""

    error: np.ndarray
    sigma: np.ndarray
    nees: np.ndarray
    nis: np.ndarray
    J: np.ndarray

    def three_sigma(self, of, since=800):
        """3 × RMS over components and seeds, from a time in s."""
        return 3 * rms(self.error[since:, :, of])

    def claimed(self, of, since=800):
        """The same of the filters' own σ."""
        return 3 * rms(self.sigma[since:, :, of])

    def inertia_error(self):
        """‖ΔJ‖ / trace (K, M)."""
        return np.linalg.norm(self.J - tumbling.J_TARGET, axis=(-2, -1)) / 3

    def derived(self, every=10, since=800):
        """Errors of p (n, M, 2) and of target_from_body, in rad (n, M, 3), labelled nearest to the truth."""
        truth = tumbling.BODY_FROM_TARGET.inv()
        ratios, turns = [], []
        for J in self.J[since::every]:
            found = [labelled_nearest(tumbling.MOMENTS, truth, one) for one in J]
            ratios.append([[p1, p2] - tumbling.RATIOS for p1, p2, _ in found])
            turns.append([(truth.inv() * turn).as_rotvec() for _, _, turn in found])
        return np.array(ratios), np.array(turns)


def measured(truth, seeds, sigma=PAPER, seed=1, outliers=0.0, drift=(0.0, 0.0, 1.0)):
    """Rotations and origins of ``seeds`` registrations at every time; a share of gross ``outliers``; a Gauss-Markov ``drift``."""
    rng = np.random.default_rng(seed)
    spread = np.repeat(sigma, 3)
    kept = np.exp(-1 / drift[2])
    lasting = rng.standard_normal((seeds, 6)) * np.repeat(drift[:2], 3)
    for k in range(len(truth.times_s)):
        rotation, origin = truth.pose(k)
        error = rng.standard_normal((seeds, 6)) * spread + lasting
        gross = rng.standard_normal((seeds, 6)) * np.repeat([0.5, 5.0], 3)
        error = np.where((rng.random((seeds, 1)) < outliers) & (k > 0), gross, error)
        lasting = kept * lasting + np.sqrt(1 - kept**2) * rng.standard_normal((seeds, 6)) * np.repeat(drift[:2], 3)
        rotation = np.broadcast_to(rotation, (seeds, 3, 3))
        yield Rotation.from_matrix(rotation) * Rotation.from_rotvec(error[:, :3]), origin + error[:, 3:]


def errors(truth, k, state):
    """Truth minus estimate as the filter counts it, (M, 20)."""
    turn = state.inertial_from_target.inv() * Rotation.from_matrix(truth.inertial_from_target[k])
    true = [truth.omega[k], components_of(tumbling.J_TARGET), truth.r[k], truth.v[k], tumbling.OFFSET]
    found = [state.omega_rad_s, state.inertia, state.position_m, state.velocity_m_s, state.offset_m]
    return np.concatenate([turn.as_rotvec(), *(a - b for a, b in zip(true, found, strict=True))], axis=1)


def run(truth, seeds, parameters=None, sigma=PAPER, start=None, gate=np.inf, **more):
    """Filters all seeds; ``start``: 1σ (20,) of errors that a first state is drawn with (None: begun from a measurement)."""
    parameters = parameters or TumbleParameters()
    stating = np.diag(np.repeat(sigma, 3)) ** 2
    R, _ = stated(stating, parameters)
    log, state = {"error": [], "sigma": [], "nees": [], "nis": [], "J": []}, None
    for k, (rotation, origin) in enumerate(measured(truth, seeds, sigma, **more)):
        chaser = truth.chasers[k]
        view = View.of(chaser, np.eye(3), -tumbling.MOUNT.translation)
        if state is None:
            pose = RigidTransform.from_components(origin, rotation)
            state = begun(PoseMeasurement(chaser.time_s, pose, stating), view, parameters)
            state = state if start is None else drawn(truth, state, start, parameters)
        else:
            state = predicted(state, chaser.time_s, ChaserOrbit.of(chaser), parameters)
        state, nis = updated(state, view, rotation.as_matrix(), origin, R, gate if k else np.inf, parameters.least_moment)
        error = errors(truth, k, state)
        P = state.covariance[:, :20, :20]
        log["error"].append(error)
        log["sigma"].append(np.sqrt(np.diagonal(P, axis1=1, axis2=2)))
        log["nees"].append(np.sum(error * np.linalg.solve(P, error[..., None])[..., 0], axis=1))
        log["nis"].append(nis)
        log["J"].append(state.J)
    return Run(**{name: np.array(values) for name, values in log.items()})


def drawn(truth, state, sigma, parameters):
    """The true state with Gaussian errors of these 1σ, and the covariance that says so."""
    seeds = len(state.omega_rad_s)
    exact = replace(
        state,
        inertial_from_target=Rotation.from_matrix(np.broadcast_to(truth.inertial_from_target[0], (seeds, 3, 3))),
        omega_rad_s=np.broadcast_to(truth.omega[0], (seeds, 3)),
        inertia=np.broadcast_to(components_of(tumbling.J_TARGET), (seeds, 5)),
        position_m=np.broadcast_to(truth.r[0], (seeds, 3)),
        velocity_m_s=np.broadcast_to(truth.v[0], (seeds, 3)),
        offset_m=np.broadcast_to(tumbling.OFFSET, (seeds, 3)),
    )
    error = np.zeros((seeds, 26))
    error[:, :20] = np.random.default_rng(5).standard_normal((seeds, 20)) * sigma
    covariance = np.broadcast_to(np.diag(np.concatenate([np.square(sigma), np.zeros(6)])), (seeds, 26, 26))
    return exact.corrected(error, covariance, parameters.least_moment)
