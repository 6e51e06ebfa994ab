"""Scans that owe nothing to the renderer: Open3D casts the beams, and noise, mixed returns and grazing losses are laid on top.

The satellite of ten metres has a body, two wings, a dish, a nozzle and a boom: no two sides of it look the same.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.arrays import Floats
from scenes.recording import ModelCloud, Scan

GRAZING_RAD, GRAZING_WIDTH_RAD = np.deg2rad(75.0), np.deg2rad(3.0)
MIXED = 0.3  # share of a beam's divergence about an edge within which returns are mixed


def _box(size: tuple[float, float, float], centre: tuple[float, float, float]) -> Any:
    import open3d as o3d

    box = o3d.geometry.TriangleMesh.create_box(*size)
    box.translate(np.subtract(centre, np.array(size) / 2))
    return box


@cache
def satellite() -> Any:
    """The mesh, target frame, metres; the origin lies in the body."""
    import open3d as o3d

    mesh = _box((1.6, 1.4, 2.0), (0.1, 0.05, 0.0))
    mesh += _box((0.06, 3.4, 1.6), (0.2, 2.75, 0.2))
    mesh += _box((0.06, 3.4, 1.6), (0.2, -2.75, 0.2))
    dish = o3d.geometry.TriangleMesh.create_cone(radius=0.8, height=0.4, resolution=24)
    dish.rotate(Rotation.from_euler("x", 180, degrees=True).as_matrix(), (0, 0, 0))
    mesh += dish.translate((0.15, 0.1, 1.75))
    nozzle = o3d.geometry.TriangleMesh.create_cone(radius=0.45, height=0.7, resolution=24)
    mesh += nozzle.translate((0.0, 0.0, -1.7))
    mesh += _box((2.2, 0.16, 0.16), (2.0, 0.4, -0.6))
    mesh += _box((0.5, 0.3, 0.4), (-0.95, -0.3, 0.4))
    mesh.compute_triangle_normals()
    return mesh


@cache
def _casting() -> Any:
    import open3d as o3d

    scene = o3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(o3d.t.geometry.TriangleMesh.from_legacy(satellite()))
    return scene


def cast(origins_target: Floats, directions_target: Floats) -> tuple[Floats, Floats]:
    """Distance (n,), infinite where nothing is, and the surfaces' normals (n, 3) of rays in the target frame."""
    rays = np.hstack([np.broadcast_to(origins_target, directions_target.shape), directions_target]).astype(np.float32)
    hits = _casting().cast_rays(rays, nthreads=1)
    return hits["t_hit"].numpy().astype(np.float64), hits["primitive_normals"].numpy().astype(np.float64)


@cache
def model_cloud(points: int = 6000, seed: int = 0) -> ModelCloud:
    """Points evenly strewn over what can be seen from outside, with outward normals."""
    rng = np.random.default_rng(seed)
    mesh = satellite()
    corners = np.asarray(mesh.vertices)[np.asarray(mesh.triangles)]
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(crosses, axis=1)
    which = rng.choice(len(areas), 2 * points, p=areas / areas.sum())
    a, b = rng.random((2, len(which), 1))
    a, b = np.where(a + b > 1, 1 - a, a), np.where(a + b > 1, 1 - b, b)
    on = corners[which, 0] + a * (corners[which, 1] - corners[which, 0]) + b * (corners[which, 2] - corners[which, 0])
    normals = crosses[which] / areas[which][:, None]
    visible = _is_visible(on, normals, rng)
    return ModelCloud(on[visible][:points], normals[visible][:points])


def _is_visible(points: Floats, normals: Floats, rng: np.random.Generator, tries: int = 64) -> Any:
    """Whether at least two of ``tries`` random directions of each point's outer half space are free."""
    free = np.zeros(len(points), dtype=int)
    for _ in range(tries):
        away = rng.normal(size=points.shape)
        away *= np.sign(np.sum(away * normals, axis=1, keepdims=True))
        away /= np.linalg.norm(away, axis=1, keepdims=True)
        free += ~np.isfinite(cast(points + 1e-3 * normals, away)[0])
    return free >= 2


@dataclass(frozen=True)
class ToyLidar:
    """A flash LIDAR of ``beams`` × ``beams`` over ``field_deg``; ``sigma_m`` is the noise along the beam."""

    beams: int = 128
    field_deg: float = 10.0
    sigma_m: float = 0.05

    def directions(self) -> Floats:
        """Unit vectors (rows, columns, 3), LIDAR axes."""
        half = np.tan(np.deg2rad(self.field_deg) / 2)
        at = half * (2 * (np.arange(self.beams) + 0.5) / self.beams - 1)
        x, y = np.meshgrid(at, at)
        rays = np.stack([x, y, np.ones_like(x)], axis=-1)
        return np.asarray(rays / np.linalg.norm(rays, axis=-1, keepdims=True))

    def scan(self, lidar_from_target: RigidTransform, rng: np.random.Generator) -> Scan:
        """One scan without motion: noise along the beam, mixed returns at edges, losses where the beam grazes."""
        directions = self.directions().reshape(-1, 3)
        ranges, normals = _seen(lidar_from_target, directions)
        aside, _ = _seen(lidar_from_target, self._beside(directions, rng))
        both = np.isfinite(ranges) & np.isfinite(aside)
        mixed = both & (np.abs(np.where(both, aside, 0.0) - np.where(both, ranges, 0.0)) > 0.1)
        share = rng.random(len(ranges))
        ranges = np.where(mixed, share * ranges + (1 - share) * np.where(mixed, aside, 0.0), ranges)
        target_from_lidar = lidar_from_target.rotation.inv()
        incidence = np.arccos(np.clip(np.abs(np.sum(target_from_lidar.apply(directions) * normals, axis=1)), 0, 1))
        kept = rng.random(len(ranges)) < 1 / (1 + np.exp((incidence - GRAZING_RAD) / (GRAZING_WIDTH_RAD / 3)))
        ranges = np.where(np.isfinite(ranges) & kept, ranges + self.sigma_m * rng.normal(size=len(ranges)), np.nan)
        points = (directions * ranges[:, None]).reshape(self.beams, self.beams, 3).astype(np.float32)
        intensity = np.where(np.isnan(points[..., 0]), np.nan, 1.0).astype(np.float32)
        return Scan(points, intensity, np.zeros(points.shape[:2], np.float32))

    def _beside(self, directions: Floats, rng: np.random.Generator) -> Floats:
        """A second ray of each beam, elsewhere in its footprint."""
        pitch = np.deg2rad(self.field_deg) / self.beams
        other = directions + MIXED * pitch * rng.normal(size=directions.shape)
        return np.asarray(other / np.linalg.norm(other, axis=1, keepdims=True))


def _seen(lidar_from_target: RigidTransform, directions_lidar: Floats) -> tuple[Floats, Floats]:
    inverse = lidar_from_target.inv()
    return cast(inverse.translation, inverse.rotation.apply(directions_lidar))


def at_range(rotation: Rotation, range_m: float = 64.0) -> RigidTransform:
    """lidar_from_target with the target's origin straight ahead."""
    return RigidTransform.from_components([0.0, 0.0, range_m], rotation)


@dataclass(frozen=True)
class ToyTumble:
    """A free rigid body that a LIDAR at rest looks at: poses at 1 Hz from Euler's equations; its centre of mass drifts by."""

    seconds: int = 600
    step_s: float = 1.0
    omega_rad_s: tuple[float, float, float] = (0.02, 0.01, -0.015)
    principal: tuple[float, float, float] = (0.5, 1.0, 1.4)
    axes: tuple[float, float, float] = (0.3, -0.5, 0.8)  # rotation vector, target_from_body
    centre_of_mass_target: tuple[float, float, float] = (0.3, -0.2, 0.15)
    start: tuple[float, float, float, float] = (0.1826, 0.3651, 0.5477, 0.7303)  # x, y, z, w of lidar_from_body

    def poses(self) -> list[RigidTransform]:
        """lidar_from_target at 0, step_s, … by DOP853."""
        from scipy.integrate import solve_ivp

        moments = np.array(self.principal)

        def rates(_: float, state: Floats) -> Floats:
            (x, y, z, w), omega = state[:4], state[4:]
            a, b, c = omega
            turning = [w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a, -x * a - y * b - z * c]
            return np.concatenate([np.array(turning) / 2, -np.cross(omega, moments * omega) / moments])

        times = np.arange(0, self.seconds + 1e-9, self.step_s)
        state = np.concatenate([self.start, self.omega_rad_s])
        found = solve_ivp(rates, (0, times[-1]), state, method="DOP853", t_eval=times, rtol=1e-10, atol=1e-12)
        turns = Rotation.from_quat(found.y[:4].T) * Rotation.from_rotvec(self.axes).inv()
        path = np.array([0.0, 0.0, 64.0]) + times[:, None] * np.array([0.002, -0.001, 0.003])
        return [RigidTransform.from_components(p - turn.apply(self.centre_of_mass_target), turn) for p, turn in zip(path, turns)]
