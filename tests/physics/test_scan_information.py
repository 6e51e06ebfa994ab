"""The bound from one LIDAR scan of the standard satellite: against ranges cast anew from other poses, and a fit that reaches it."""

from typing import Any

import numpy as np
import open3d as o3d
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.information.fisher import information, nees, pose_error
from benchmark.information.scans import ScanBound, ScanInformation, jacobian
from benchmark.model_cloud import ray_scene, triangles_of
from scenes.beam_fate import BeamFate
from scenes.config import load
from scenes.lidar import Lidar
from scenes.scenario import load_scenario
from scenes.target import Target

_POSE = RigidTransform.from_components([0.4, -0.3, 40.0], Rotation.from_euler("xyz", [155, 25, 20], degrees=True))
_SIGMA_M, _GATE = 0.02, 3.5
_NEARER_M = 35.0  # rays start so far out, so that single precision resolves micrometres
_MOTION_M = 2e-3  # of the outermost points in half a difference


def _moved(pose: RigidTransform, xi: np.ndarray) -> RigidTransform:
    return RigidTransform.from_components(pose.translation + xi[3:], Rotation.from_rotvec(xi[:3]) * pose.rotation)


class _Scanner:
    """128 x 128 beams over 7°, cast at a target in any pose."""

    def __init__(self, target: Target) -> None:
        triangles = triangles_of(target)
        self._surface = ray_scene(triangles)
        across = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        self.normals = across / np.linalg.norm(across, axis=1, keepdims=True)
        side = np.tan(np.radians(3.5)) * (2 * np.arange(128) + 1 - 128) / 128
        u, v = np.meshgrid(side, side)
        sight = np.stack([u.ravel(), v.ravel(), np.ones(u.size)], axis=1)
        self.sight = sight / np.linalg.norm(sight, axis=1, keepdims=True)

    def cast(self, pose: RigidTransform, beams: Any = slice(None)) -> tuple[np.ndarray, np.ndarray]:
        """Ranges (n,), infinite beside the target, and the triangles that are met."""
        along = pose.inv().rotation.apply(self.sight[beams])
        rays = np.hstack([pose.inv().translation + _NEARER_M * along, along]).astype(np.float32)
        found = self._surface.cast_rays(o3d.core.Tensor.from_numpy(rays))
        return _NEARER_M + found["t_hit"].numpy().astype(np.float64), found["primitive_ids"].numpy()


@pytest.fixture(scope="module")
def target() -> Target:
    return load_scenario("standard-lidar").target


@pytest.fixture(scope="module")
def scanner(target: Target) -> _Scanner:
    return _Scanner(target)


def _bound(target: Target, hits: np.ndarray, normals: np.ndarray) -> ScanBound:
    """What the package makes of a scan's truth where whole spots met ``hits``; ``normals`` tell the incidence alone."""
    ranges = np.linalg.norm(hits, axis=1)
    cosine = np.abs(np.einsum("ni,ni->n", normals, hits)) / ranges
    truth = {
        "reason": np.full(len(hits), BeamFate.RETURN), "energy_fraction": np.ones(len(hits)), "deskewed_m": hits, "range_m": ranges,
        "incidence_rad": np.arccos(np.minimum(cosine, 1.0)),
    }  # fmt: skip
    lidar = load("lidar", "song2017-lidar", Lidar, [f"ranging.sigma_m={_SIGMA_M}"])
    return ScanInformation(target, lidar).bound(truth, _POSE)


def test_the_scans_information_is_that_of_ranges_cast_from_poses_close_by(target: Target, scanner: _Scanner) -> None:
    """Beams that stay on their triangle in all twelve poses; standard deviations agree within 0.5 %."""
    ranges, met = scanner.cast(_POSE)
    half = _MOTION_M / np.array([2.5, 2.5, 2.5, 1.0, 1.0, 1.0])
    cast = [scanner.cast(_moved(_POSE, sign * half[axis] * np.eye(6)[axis])) for axis in range(6) for sign in (1, -1)]
    every = np.stack([one for one, _ in cast])
    whole = np.isfinite(ranges) & np.isfinite(every).all(axis=0)
    same = whole & np.all([triangles == met for _, triangles in cast], axis=0)

    def ratio(beams: np.ndarray) -> np.ndarray:
        rows = (every[0::2, beams] - every[1::2, beams]) / (2 * half[:, None])
        differences = information(np.full(rows.shape[1], _SIGMA_M**-2), rows, rows)
        found = _bound(target, ranges[beams, None] * scanner.sight[beams], _POSE.rotation.apply(scanner.normals[met[beams]]))
        assert found.beams > 0.999 * beams.sum() > 2000  # a point on an edge may be given the other side's normal
        return np.asarray(np.sqrt(np.diag(np.linalg.inv(differences))) / found.bound.sigma)

    np.testing.assert_allclose(ratio(same), 1.0, atol=0.005)
    assert (ratio(whole) < 0.9).any()  # where beams jump from one surface to another, differences promise too much


@pytest.mark.slow
def test_a_gated_fit_to_noisy_scans_reaches_the_bound(target: Target, scanner: _Scanner) -> None:
    """300 scans, each range held against the model cast anew; the standard error of a spread is 4 %."""
    ranges, met = scanner.cast(_POSE)
    beams = np.flatnonzero(np.isfinite(ranges))
    found = _bound(target, ranges[beams, None] * scanner.sight[beams], _POSE.rotation.apply(scanner.normals[met[beams]]))
    rng, errors = np.random.default_rng(11), []
    for _ in range(300):
        measured = ranges[beams] + rng.normal(scale=_SIGMA_M, size=len(beams))
        pose = _fitted(scanner, measured, beams, _moved(_POSE, rng.normal(size=6) * found.bound.sigma))
        errors.append(pose_error(_POSE.rotation, _POSE.translation, pose.rotation, pose.translation)[0])
    np.testing.assert_allclose(np.std(errors, axis=0) / found.bound.sigma, 1.0, atol=0.1)
    informations = np.broadcast_to(found.bound.information, (len(errors), 6, 6))
    assert nees(np.array(errors), informations).mean() / 6 == pytest.approx(1.0, abs=0.1)


def _fitted(scanner: _Scanner, measured: np.ndarray, beams: np.ndarray, pose: RigidTransform) -> RigidTransform:
    """Point to plane in three rounds; what is further off than the gate met another surface."""
    for _ in range(3):
        ranges, met = scanner.cast(pose, beams)
        off = measured - ranges
        kept = np.abs(off) < _GATE * _SIGMA_M
        hits, normals = ranges[kept, None] * scanner.sight[beams[kept]], pose.rotation.apply(scanner.normals[met[kept]])
        rows = jacobian(hits, normals, pose.translation)
        pose = _moved(pose, np.linalg.solve(rows.T @ rows, rows.T @ off[kept]))
    return pose
