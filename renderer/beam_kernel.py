"""What runs on the device for each sub-ray: its ray in the target's frame, what it meets, what comes back."""

from typing import Any

import numpy as np

from renderer.rotation import turned
from renderer.scan_poses import ScanPoses
from scenes.arrays import Floats

_BESIDE = (1.1e-6, -0.7e-6, 0.9e-6)  # rad: aside of an edge, 0.1 mm at 60 m


def recorded(*, moving: bool, with_sun: bool) -> Any:
    """The kernel as a function that Dr.Jit records on its first calls and replays afterwards."""
    import drjit as dr
    import mitsuba as mi

    @dr.freeze
    def replayed(scene: Any, frame: dict[str, Any], lanes: dict[str, Any]) -> dict[str, Any]:
        found = met(mi, scene, _ray(mi, dr, frame, lanes, moving=moving), frame["sun"], with_sun=with_sun)
        hit, shape = found["range_m"] > 0, mi.UInt32(dr.reinterpret_array(mi.UInt32, found.pop("shape")))
        return found | {"part": dr.gather(mi.UInt32, lanes["parts"], shape, hit)}

    return replayed


def device_frame(mi: Any, poses: ScanPoses, sun: Floats) -> dict[str, Any]:
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


def met(mi: Any, scene: Any, ray: Any, sun: Any, *, with_sun: bool) -> dict[str, Any]:
    """The first surface on a ray, and what it sends back along it; plain numbers where rays are traced one by one."""
    import drjit as dr

    si = _first_surface(mi, dr, scene, ray)
    hit, context = si.is_valid(), mi.BSDFContext()
    found = {"range_m": dr.select(hit, si.t, 0.0), "cosine": dr.select(hit, -dr.dot(si.n, ray.d), 0.0), "shape": si.shape}
    if hit is False:
        return found | {"retro": 0.0} | ({"sunlit": 0.0} if with_sun else {})
    surface = si.bsdf()
    found["retro"] = dr.select(hit, surface.eval(context, si, si.wi, hit)[0], 0.0)
    if with_sun:
        facing = hit & (dr.dot(si.n, sun) > 0)
        lit = facing & (scene.ray_test(si.spawn_ray(sun), facing) ^ True)
        found["sunlit"] = dr.select(lit, surface.eval(context, si, si.to_local(sun), lit)[0], 0.0)
    return found


def _first_surface(mi: Any, dr: Any, scene: Any, ray: Any) -> Any:
    """The first surface on a ray, from outside.

    A ray that meets an edge between two triangles exactly can slip through, into the void or onto an inside; one a little beside
    it cannot.
    """
    si = scene.ray_intersect_preliminary(ray, coherent=True).compute_surface_interaction(ray)
    missed = (si.is_valid() & (dr.dot(si.n, ray.d) < 0)) ^ True
    beside = mi.Ray3f(ray.o, dr.normalize(ray.d + mi.Vector3f(*_BESIDE)))
    again = scene.ray_intersect(beside, mi.RayFlags.All, True, missed)
    better = missed & again.is_valid() & (dr.dot(again.n, ray.d) < 0)
    return (again if better else si) if isinstance(better, bool) else dr.select(better, again, si)
