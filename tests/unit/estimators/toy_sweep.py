"""Sweeps of the toy target, and what an estimator makes of them."""

from dataclasses import dataclass, replace

import numpy as np
import toy_renderer as toy
from scipy.spatial.transform import Rotation

from estimators.api import Estimate, Estimator, Outcome
from estimators.mono_rectangle.angles import zyx_from_cam_rotation
from scenes.arrays import frozen
from scenes.intrinsics import Intrinsics
from scenes.recording import CornerPrior, Image, Knowledge, Observation, Rectangle, SensorModel

RATE_DEG_S = 0.1
INTRINSICS = Intrinsics(toy.CAMERA[3], toy.CAMERA[4], toy.CAMERA[0], toy.CAMERA[0], toy.CAMERA[1], toy.CAMERA[2])


@dataclass(frozen=True)
class Sweep:
    """Pictures of a case with their true angles."""

    case: int
    theta_deg: np.ndarray
    observations: tuple[Observation, ...]

    @classmethod
    def drawn(cls, case, first_deg, last_deg, frames):
        return cls.redrawn(case, first_deg, last_deg, frames, seeds=(case,))[0]

    @classmethod
    def redrawn(cls, case, first_deg, last_deg, frames, seeds):
        """The same sweep with several noises."""
        theta = np.linspace(first_deg, last_deg, frames)
        times = (theta - first_deg) / RATE_DEG_S
        signals = [toy.signal_dn(toy.pose(case, np.deg2rad(angle))) for angle in theta]
        return [
            cls(case, theta, tuple(observation(i, times[i], toy.expose(s, [seed, i])) for i, s in enumerate(signals)))
            for seed in seeds
        ]

    def truth(self, frame):
        return toy.pose(self.case, np.deg2rad(self.theta_deg[frame]))

    def knowledge(self, feature, seed=0, sigma_px=3.0, first=0, **changes):
        return replace(knowledge(self.truth(first), feature, seed, sigma_px), **changes)

    def run(self, estimator, feature, **kwargs):
        return Answers.of(estimator, self, self.knowledge(feature, **kwargs))


@dataclass(frozen=True)
class Answers:
    """One estimate a frame; ``error_deg`` of the swept angle and ``geodesic_deg``, NaN where there is no answer."""

    estimates: tuple[Estimate, ...]
    error_deg: np.ndarray
    geodesic_deg: np.ndarray
    theta_deg: np.ndarray

    @classmethod
    def of(cls, estimator: Estimator, sweep: Sweep, told: Knowledge, first: int = 0):
        estimator.start(told)
        estimates = tuple(estimator.step(observation) for observation in sweep.observations[first:])
        pairs = [(e, sweep.truth(first + i), sweep.theta_deg[first + i]) for i, e in enumerate(estimates)]
        errors = [swept_deg(e.sensor_from_target, sweep.case) - t if e.sensor_from_target else np.nan for e, _, t in pairs]
        apart = [np.rad2deg((e.sensor_from_target.inv() * r).magnitude()) if e.sensor_from_target else np.nan for e, r, _ in pairs]
        return cls(estimates, np.array(errors), np.array(apart), sweep.theta_deg[first:])

    @property
    def ok(self):
        return np.array([e.outcome is Outcome.OK for e in self.estimates])

    @property
    def sigma_deg(self):
        return np.nanstd(self.error_deg)

    @property
    def max_deg(self):
        return np.nanmax(np.abs(self.error_deg))

    def failed_between(self, low_deg, high_deg):
        """Whether every frame between the two angles is a failure with a reason."""
        inside = [e for e, t in zip(self.estimates, self.theta_deg, strict=True) if low_deg <= t <= high_deg]
        return bool(inside) and all(e.outcome is not Outcome.OK and e.reason for e in inside)


def swept_deg(cam_from_target, case):
    return float(np.rad2deg(zyx_from_cam_rotation(cam_from_target)[1 if case == 1 else 0]))


def observation(frame, time_s, pixels):
    return Observation(frame, float(time_s), {"cam": Image(frozen(pixels, pixels.dtype))})


def knowledge(cam_from_target, feature, seed=0, sigma_px=3.0, intrinsics=INTRINSICS):
    _, _, _, gap, free = toy.FEATURES[feature]
    clicked = toy.corners_px(cam_from_target, feature) + np.random.default_rng(seed).normal(0, sigma_px, (4, 2))
    return Knowledge(
        {"cam": SensorModel(intrinsics, toy.BLACK_DN, 255.0)},
        Rectangle(feature, Rotation.identity(), gap, free),
        CornerPrior("cam", frozen(clicked), sigma_px),
    )
