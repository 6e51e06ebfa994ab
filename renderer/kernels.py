"""What runs on the device: one lane per pixel of the window, looping over that pixel's samples.

Summing within a lane keeps memory independent of the sample count and the result independent of threads. Each function is
recorded once and replayed for every frame (``dr.freeze``); in scalar variants the same code runs pixel by pixel.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from renderer.emitters import Kind
from renderer.integrator import direct_layers, indirect_layer
from renderer.sampling import net, net_start
from renderer.sensor import camera_ray

_NUDGE_PX = (1.1e-3, 0.7e-3)


@dataclass(frozen=True, slots=True)
class KernelPlan:
    """What a recorded kernel bakes in: the window's size, the samples, and which features the scene needs."""

    width_px: int
    height_px: int
    direct_samples: int
    indirect_samples: int
    max_scatterings: int
    distorted: bool
    moving: bool
    with_glints: bool
    stratified: bool
    kind: Kind
    has_partner: bool


@dr.syntax
def direct_kernel(mi: Any, scene: Any, frame: dict[str, Any], pixel_index: Any, plan: KernelPlan) -> dict[str, Any]:
    """Sums over the samples of each pixel of the layers of ``direct_layers``."""
    rng = _generator(mi, frame["direct_seed"], pixel_index)
    first_stratum = _first_stratum(mi, rng, plan.direct_samples, plan)
    places, on_light, in_lobe = net_start(mi, rng), net_start(mi, rng), net_start(mi, rng)
    narrow = frame.get("narrow")
    diffuse, specular = mi.Float(0), mi.Float(0)
    hit, facing, unblocked = mi.Float(0), mi.Float(0), mi.Float(0)
    sample = mi.UInt32(0)
    while dr.hint(sample < plan.direct_samples, exclude=[plan]):
        ray, light = _sampled(mi, frame, pixel_index, sample, rng, places, plan.direct_samples, first_stratum, plan)
        lobe = net(mi, dr, in_lobe, sample) if plan.with_glints else None
        place, turn = net(mi, dr, on_light, sample), (sample, plan.direct_samples)
        layers = direct_layers(mi, scene, ray, light, place, lobe, turn, narrow, kind=plan.kind)
        diffuse += layers["diffuse"]
        specular += layers["specular"]
        hit += layers["hit"]
        facing += layers["facing"]
        unblocked += layers["open"]
        sample += 1
    return {"diffuse": diffuse, "specular": specular, "hit": hit, "facing": facing, "open": unblocked}


@dr.syntax
def indirect_kernel(mi: Any, scene: Any, frame: dict[str, Any], pixel_index: Any, plan: KernelPlan) -> dict[str, Any]:
    """Sum over the samples of each pixel of ``indirect_layer``."""
    rng = _generator(mi, frame["indirect_seed"], pixel_index)
    first_stratum = _first_stratum(mi, rng, plan.indirect_samples, plan)
    places = net_start(mi, rng)
    indirect = mi.Float(0)
    sample = mi.UInt32(0)
    while dr.hint(sample < plan.indirect_samples, exclude=[plan]):
        ray, light = _sampled(mi, frame, pixel_index, sample, rng, places, plan.indirect_samples, first_stratum, plan)
        indirect += indirect_layer(mi, scene, ray, light, rng, kind=plan.kind, max_scatterings=plan.max_scatterings)
        sample += 1
    return {"indirect": indirect}


def geometry_kernel(mi: Any, scene: Any, frame: dict[str, Any], pixel_index: Any, plan: KernelPlan) -> dict[str, Any]:
    """Through each pixel's centre at mid-exposure: z-depth (0 = nothing), normal in camera axes, shape index.

    With a partner (the other camera of a rig) also ``hidden``: that what is seen here cannot be seen from there.
    """
    centre = _pixel(mi, frame, pixel_index, plan)
    ray, cos_axis = camera_ray(mi, dr, frame, centre, mi.Float(0), distorted=plan.distorted)
    si = scene.ray_intersect(ray)
    front = si.is_valid() & (dr.dot(si.n, ray.d) < 0)
    # A ray that meets an edge between two triangles exactly can slip through, into the void or onto an inside;
    # one a thousandth of a pixel beside it cannot.
    beside, _ = camera_ray(mi, dr, frame, centre + mi.Vector2f(*_NUDGE_PX), mi.Float(0), distorted=plan.distorted)
    again = scene.ray_intersect(beside, front ^ True)
    first = front | (again.is_valid() ^ True)
    hit = si.is_valid() | again.is_valid()
    normal = frame["rotation"].T @ mi.Vector3f(_either(first, si.n, again.n))
    normal = dr.select(hit, normal, mi.Vector3f(0))
    hidden = _hidden(mi, scene, frame, si, again, first, hit) if plan.has_partner else None
    return ({} if hidden is None else {"hidden": hidden}) | {
        "z_m": dr.select(hit, _either(first, si.t, again.t) * cos_axis, 0.0),
        "normal.x": normal.x,
        "normal.y": normal.y,
        "normal.z": normal.z,
        "shape": _either(first, si.shape, again.shape),
        "hit": hit,
    }


def _hidden(mi: Any, scene: Any, frame: dict[str, Any], si: Any, again: Any, first: Any, hit: Any) -> Any:
    """Whether the partner cannot see the point: it looks at the surface's back, or something stands in between."""
    partner = mi.Point3f(frame["partner"])
    if isinstance(hit, bool):
        seen = si if first else again
        return hit and bool(_turned_away(dr, seen, partner) or scene.ray_test(seen.spawn_ray_to(partner)))
    blocked = scene.ray_test(si.spawn_ray_to(partner), hit & first) | scene.ray_test(again.spawn_ray_to(partner), hit & ~first)
    return hit & (blocked | dr.select(first, _turned_away(dr, si, partner), _turned_away(dr, again, partner)))


def _turned_away(dr: Any, si: Any, place: Any) -> Any:
    return dr.dot(si.n, place - si.p) <= 0


def _either(mask: Any, one: Any, other: Any) -> Any:
    """``one`` where ``mask`` holds, else ``other``; also for what is no number in scalar variants."""
    return (one if mask else other) if isinstance(mask, bool) else dr.select(mask, one, other)


def _pixel(mi: Any, frame: dict[str, Any], pixel_index: Any, plan: KernelPlan) -> Any:
    column, row = pixel_index % plan.width_px, pixel_index // plan.width_px
    return mi.Point2f(mi.Float(column) + frame["window_x"], mi.Float(row) + frame["window_y"])


def _first_stratum(mi: Any, rng: Any, samples: int, plan: KernelPlan) -> Any:
    """Which slice of the exposure a pixel's first sample gets: at random, or places and instants would pair up for good."""
    return mi.UInt32(rng.next_float32() * samples) if plan.moving else mi.UInt32(0)


def _sampled(
    mi: Any,
    frame: dict[str, Any],
    pixel_index: Any,
    sample: Any,
    rng: Any,
    places: Any,
    samples: int,
    first_stratum: Any,
    plan: KernelPlan,
) -> tuple[Any, dict[str, Any]]:
    """A ray of one sample, spread over the pixel's area (box filter) and the exposure, and the light at the ray's instant."""
    place = net(mi, dr, places, sample) if plan.stratified else mi.Point2f(rng.next_float32(), rng.next_float32())
    pixel = _pixel(mi, frame, pixel_index, plan) + mi.Vector2f(place.x - 0.5, place.y - 0.5)
    tau, light = mi.Float(0), frame["light"]
    if plan.moving:
        stratum = (sample * 37 + first_stratum) % samples  # 37: coprime to every sample count in use
        tau = (mi.Float(stratum) + rng.next_float32()) / samples - 0.5
        light = light | {"tau": tau}
    ray, _ = camera_ray(mi, dr, frame, pixel, tau, distorted=plan.distorted)
    return ray, light


def _generator(mi: Any, seed: Any, pixel_index: Any) -> Any:
    """An independent PCG32 stream per pixel, seeded through the Tiny Encryption Algorithm (Zafar et al. 2010)."""
    state, sequence = mi.sample_tea_32(pixel_index, seed)
    return mi.PCG32(initstate=mi.UInt64(state), initseq=mi.UInt64(sequence))
