"""Casts a LIDAR's sub-rays at a target that never moves, each from where the LIDAR is when its beam is fired."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from renderer.laser_line import LaserLine
from renderer.meshes import load, part_ids
from renderer.rotation import turned
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
        self._part_of_shape = part_ids(self._scene, len(target.parts), scalar=self.is_scalar)
        self._shape, self._with_sun = rays_lidar.shape[:2], with_sun
        self._lanes = _Lanes(rays_lidar, times)
        self._sphere = _sphere(target)
        self._replayed: Any = None

    def cast(self, poses: ScanPoses, sun_target: Floats | None = None) -> Echoes:
        """One scan. ``sun_target``: unit vector to the sun, target frame."""
        sun = np.zeros(3) if sun_target is None else np.array(sun_target)
        flat = self._one_by_one(poses, sun) if self.is_scalar else self._wavefront(poses, sun)
        found = {name: values.reshape(self._shape) for name, values in flat.items()}
        part = self._part_of_shape[found.pop("shape")]
        return Echoes(part=np.where(found["range_m"] > 0, part, 0).astype(np.uint32), **found)

    def _wavefront(self, poses: ScanPoses, sun: Floats) -> dict[str, NDArray[Any]]:
        import drjit as dr
        import mitsuba as mi

        if self._replayed is None:
            self._replayed = _recorded(moving=poses.times.moving, with_sun=self._with_sun)
        frame = _frame(mi, poses, sun)
        dr.make_opaque(frame)
        result = self._replayed(self._scene, frame, self._lanes.on_device(mi, dr))
        return {name: np.array(values) for name, values in result.items()}

    def _one_by_one(self, poses: ScanPoses, sun: Floats) -> dict[str, NDArray[Any]]:
        """Only the rays that meet the sphere around the target."""
        import mitsuba as mi

        origins, directions = self._lanes.in_target_frame(poses)
        worthwhile = np.flatnonzero(_meets(origins, directions, *self._sphere))
        shapes = self._scene.shapes()
        names = ("range_m", "cosine", "retro") + (("sunlit",) if self._with_sun else ())
        full: dict[str, NDArray[Any]] = {name: np.zeros(len(directions), np.float32) for name in names}
        full["shape"] = np.zeros(len(directions), np.int64)
        for lane in worthwhile:
            ray = mi.Ray3f(mi.Point3f(origins[lane].tolist()), mi.Vector3f(directions[lane].tolist()))
            met = _met(mi, self._scene, ray, mi.Vector3f(sun.tolist()), with_sun=self._with_sun)
            shape = met.pop("shape")
            full["shape"][lane] = shapes.index(shape) if met["range_m"] > 0 else 0
            for name, value in met.items():
                full[name][lane] = value
        return full


class _Lanes:
    """The sub-rays as the kernel takes them, one lane each, a beam's side by side."""

    def __init__(self, rays_lidar: Floats, times: BeamTimes) -> None:
        self._rays = np.ascontiguousarray(rays_lidar.reshape(-1, 3), np.float32)
        self._sub_rays, self._times = rays_lidar.shape[1], times
        self._device: dict[str, Any] | None = None

    def on_device(self, mi: Any, dr: Any) -> dict[str, Any]:
        """Sent once."""
        if self._device is None:
            self._device = {"direction": mi.Vector3f(np.ascontiguousarray(self._rays.T))}
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


def _recorded(*, moving: bool, with_sun: bool) -> Any:
    """The kernel as a function that Dr.Jit records on its first calls and replays afterwards."""
    import drjit as dr
    import mitsuba as mi

    @dr.freeze
    def replayed(scene: Any, frame: dict[str, Any], lanes: dict[str, Any]) -> dict[str, Any]:
        met = _met(mi, scene, _ray(mi, dr, frame, lanes, moving=moving), frame["sun"], with_sun=with_sun)
        return met | {"shape": dr.reinterpret_array(mi.UInt32, met["shape"])}

    return replayed


def _frame(mi: Any, poses: ScanPoses, sun: Floats) -> dict[str, Any]:
    """What changes from scan to scan, on the device; tables of knots are flat, a row after the other."""
    frame = {"sun": mi.Vector3f(sun.tolist())}
    if not poses.times.moving:
        origin = -poses.turns[0] @ poses.position_m[0]
        return frame | {"turn": mi.Matrix3f(poses.turns[0].tolist()), "origin": mi.Vector3f(origin.tolist())}
    tables = {"turns": poses.turns[:-1], "turn_rad": poses.turn_rad}
    tables |= {"position": poses.position_m[:-1], "step": np.diff(poses.position_m, axis=0)}
    return frame | {name: mi.Float(table.astype(np.float32).ravel()) for name, table in tables.items()}


def _ray(mi: Any, dr: Any, frame: dict[str, Any], lanes: dict[str, Any], *, moving: bool) -> Any:
    """Each lane's ray in the target's frame."""
    if not moving:
        return mi.Ray3f(mi.Point3f(frame["origin"]), frame["turn"] @ lanes["direction"])
    interval, fraction = lanes["interval"], lanes["fraction"]
    turn_rad = dr.gather(mi.Vector3f, frame["turn_rad"], interval) * fraction
    position = dr.gather(mi.Vector3f, frame["position"], interval) + fraction * dr.gather(mi.Vector3f, frame["step"], interval)
    rows = [dr.gather(mi.Vector3f, frame["turns"], 3 * interval + row) for row in range(3)]
    origin, direction = (turned(mi, dr, vector, turn_rad) for vector in (-position, lanes["direction"]))
    across = [mi.Vector3f(*(dr.dot(row, vector) for row in rows)) for vector in (origin, direction)]
    return mi.Ray3f(mi.Point3f(across[0]), dr.normalize(across[1]))


def _met(mi: Any, scene: Any, ray: Any, sun: Any, *, with_sun: bool) -> dict[str, Any]:
    """The first surface on a ray, and what it sends back along it."""
    import drjit as dr

    si = scene.ray_intersect_preliminary(ray, coherent=True).compute_surface_interaction(ray)
    hit, context = si.is_valid(), mi.BSDFContext()
    surface = si.bsdf() if hit is not False else None
    retro = surface.eval(context, si, si.wi, hit)[0] if surface is not None else 0.0
    met = {"range_m": dr.select(hit, si.t, 0.0), "cosine": dr.select(hit, -dr.dot(si.n, ray.d), 0.0), "shape": si.shape}
    met["retro"] = dr.select(hit, retro, 0.0)
    if with_sun:
        facing = hit & (dr.dot(si.n, sun) > 0)
        lit = facing & ~scene.ray_test(si.spawn_ray(sun), facing) if surface is not None else False
        met["sunlit"] = dr.select(lit, surface.eval(context, si, si.to_local(sun), lit)[0], 0.0) if surface is not None else 0.0
    return met


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
