"""Casts a LIDAR's sub-rays at a target that never moves, each from where the LIDAR is when its beam is fired."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from renderer.beam_kernel import device_frame, met, recorded
from renderer.laser_line import LaserLine
from renderer.meshes import load, part_ids
from renderer.scan_poses import BeamTimes, ScanPoses
from renderer.variant import activate
from scenes.arrays import Floats
from scenes.solids import bounding_points
from scenes.target import Target

_KEPT = 1.001  # of the radius of the sphere around the target, for rounding


@dataclass(frozen=True, slots=True, eq=False)
class Echoes:
    """What the sub-rays meet, (beams, sub-rays) each.

    ``range_m``: to the first surface, 0 where there is none. ``part``: its 1-based number. ``cosine``: of the incidence, below 0
    where a ray meets an inside. ``retro``: BSDF back along the ray times the cosine, sr⁻¹. ``sunlit``: the same from the sun to
    the LIDAR, 0 in shadow; None where sunlight does not count.
    """

    range_m: NDArray[np.float32]
    part: NDArray[np.uint32]
    cosine: NDArray[np.float32]
    retro: NDArray[np.float32]
    sunlit: NDArray[np.float32] | None = None

    def rows(self, beams: NDArray[np.int64]) -> "Echoes":
        """Only these beams."""
        sunlit = None if self.sunlit is None else self.sunlit[beams]
        return Echoes(self.range_m[beams], self.part[beams], self.cosine[beams], self.retro[beams], sunlit)


class BeamCaster:
    """One target and one bundle of sub-rays, loaded once; only the poses change from scan to scan."""

    def __init__(self, target: Target, line: LaserLine, rays_lidar: Floats, times: BeamTimes, *, with_sun: bool) -> None:
        """``rays_lidar`` (beams, sub-rays, 3): unit vectors. ``with_sun``: also say what the sun lights."""
        self.is_scalar = activate().is_scalar
        self._scene = load(target, line)
        part_of_shape = part_ids(self._scene, len(target.parts), scalar=self.is_scalar)
        self._shape, self._with_sun = rays_lidar.shape[:2], with_sun
        self._lanes = _Lanes(rays_lidar, times, part_of_shape)
        self._sphere = _sphere(target)
        self._replayed: Any = None

    def cast(self, poses: ScanPoses, sun_target: Floats | None = None) -> Echoes:
        """One scan. ``sun_target``: unit vector to the sun, target frame."""
        sun = np.zeros(3) if sun_target is None else np.array(sun_target)
        flat = self._one_by_one(poses, sun) if self.is_scalar else self._wavefront(poses, sun)
        return Echoes(**{name: values.reshape(self._shape) for name, values in flat.items()})

    def _wavefront(self, poses: ScanPoses, sun: Floats) -> dict[str, NDArray[Any]]:
        import drjit as dr
        import mitsuba as mi

        if self._replayed is None:
            self._replayed = recorded(moving=poses.times.moving, with_sun=self._with_sun)
        frame = device_frame(mi, poses, sun)
        dr.make_opaque(frame)
        result = self._replayed(self._scene, frame, self._lanes.on_device(mi, dr))
        return {name: np.asarray(values) for name, values in result.items()}  # no copy: they keep the device's memory alive

    def _one_by_one(self, poses: ScanPoses, sun: Floats) -> dict[str, NDArray[Any]]:
        """Only the rays that meet the sphere around the target."""
        import mitsuba as mi

        origins, directions = self._lanes.in_target_frame(poses)
        worthwhile = np.flatnonzero(_meets(origins, directions, *self._sphere))
        shapes = self._scene.shapes()
        names = ("range_m", "cosine", "retro") + (("sunlit",) if self._with_sun else ())
        full: dict[str, NDArray[Any]] = {name: np.zeros(len(directions), np.float32) for name in names}
        full["part"] = np.zeros(len(directions), np.uint32)
        for lane in worthwhile:
            ray = mi.Ray3f(mi.Point3f(origins[lane].tolist()), mi.Vector3f(directions[lane].tolist()))
            found = met(mi, self._scene, ray, mi.Vector3f(sun.tolist()), with_sun=self._with_sun)
            shape = found.pop("shape")
            full["part"][lane] = shapes.index(shape) + 1 if found["range_m"] > 0 else 0
            for name, value in found.items():
                full[name][lane] = value
        return full


class _Lanes:
    """The sub-rays as the kernel takes them, one lane each, a beam's side by side."""

    def __init__(self, rays_lidar: Floats, times: BeamTimes, part_of_shape: NDArray[np.uint32]) -> None:
        self._part_of_shape = part_of_shape
        self._rays = np.ascontiguousarray(rays_lidar.reshape(-1, 3), np.float32)
        self._sub_rays, self._times = rays_lidar.shape[1], times
        self._device: dict[str, Any] | None = None

    def on_device(self, mi: Any, dr: Any) -> dict[str, Any]:
        """Sent once."""
        if self._device is None:
            self._device = {"direction": mi.Vector3f(np.ascontiguousarray(self._rays.T)), "parts": mi.UInt32(self._part_of_shape)}
            if self._times.moving:
                self._device["interval"] = mi.UInt32(np.repeat(self._times.interval, self._sub_rays).astype(np.uint32))
                self._device["fraction"] = mi.Float(np.repeat(self._times.fraction, self._sub_rays).astype(np.float32))
            dr.make_opaque(self._device)
        return self._device

    def in_target_frame(self, poses: ScanPoses) -> tuple[Floats, Floats]:
        """Origins and directions (rays, 3) on the host."""
        beams = np.repeat(np.arange(len(self._times.interval)), self._sub_rays)
        origins = poses.target_points(beams, np.zeros(self._rays.shape))
        return origins, poses.target_points(beams, self._rays.astype(np.float64)) - origins


def _sphere(target: Target) -> tuple[Floats, float]:
    """Centre (3,), target frame, and radius of a sphere around the target."""
    points = bounding_points(target)
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    return centre, float(np.linalg.norm(points - centre, axis=1).max()) * _KEPT


def _meets(origins: Floats, directions: Floats, centre: Floats, radius_m: float) -> NDArray[np.bool_]:
    """Whether rays (n, 3) come within a sphere."""
    towards = centre - origins
    along = np.einsum("ni,ni->n", towards, directions)
    apart2 = np.einsum("ni,ni->n", towards, towards) - np.maximum(along, 0) ** 2
    return np.asarray(apart2 <= radius_m**2)
