"""What runs on the device: one lane per pixel of the window, looping over that pixel's samples.

Summing within a lane keeps memory independent of the sample count and the result independent of threads. Each function is
recorded once and replayed for every frame (``dr.freeze``); in scalar variants the same code runs pixel by pixel.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from renderer.integrator import direct_layers, indirect_layer
from renderer.sensor import camera_ray, stratified


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


@dr.syntax
def direct_kernel(mi: Any, scene: Any, frame: dict[str, Any], pixel_index: Any, plan: KernelPlan) -> dict[str, Any]:
    """Sums over the samples of each pixel of the layers of ``direct_layers``."""
    rng = _generator(mi, frame["direct_seed"], pixel_index)
    first_stratum = _first_stratum(mi, rng, plan.direct_samples, plan)
    diffuse, specular = mi.Float(0), mi.Float(0)
    hit, facing, unblocked = mi.Float(0), mi.Float(0), mi.Float(0)
    sample = mi.UInt32(0)
    while dr.hint(sample < plan.direct_samples, exclude=[plan]):
        ray = _sample_ray(mi, frame, pixel_index, sample, rng, plan.direct_samples, first_stratum, plan)
        layers = direct_layers(mi, scene, ray, frame["sun"], rng, with_glints=plan.with_glints)
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
    indirect = mi.Float(0)
    sample = mi.UInt32(0)
    while dr.hint(sample < plan.indirect_samples, exclude=[plan]):
        ray = _sample_ray(mi, frame, pixel_index, sample, rng, plan.indirect_samples, first_stratum, plan)
        indirect += indirect_layer(mi, scene, ray, frame["sun"], rng, max_scatterings=plan.max_scatterings)
        sample += 1
    return {"indirect": indirect}


def geometry_kernel(mi: Any, scene: Any, frame: dict[str, Any], pixel_index: Any, plan: KernelPlan) -> dict[str, Any]:
    """Through each pixel's centre at mid-exposure: z-depth (0 = nothing), normal in camera axes, shape index."""
    ray, cos_axis = camera_ray(mi, dr, frame, _pixel(mi, frame, pixel_index, plan), mi.Float(0), distorted=plan.distorted)
    si = scene.ray_intersect(ray)
    hit = si.is_valid()
    normal = frame["rotation"].T @ mi.Vector3f(si.n)
    normal = dr.select(hit, normal, mi.Vector3f(0))
    return {
        "z_m": dr.select(hit, si.t * cos_axis, 0.0),
        "normal.x": normal.x,
        "normal.y": normal.y,
        "normal.z": normal.z,
        "shape": si.shape,
        "hit": hit,
    }


def _pixel(mi: Any, frame: dict[str, Any], pixel_index: Any, plan: KernelPlan) -> Any:
    column, row = pixel_index % plan.width_px, pixel_index // plan.width_px
    return mi.Point2f(mi.Float(column) + frame["window_x"], mi.Float(row) + frame["window_y"])


def _first_stratum(mi: Any, rng: Any, samples: int, plan: KernelPlan) -> Any:
    """Which slice of the exposure a pixel's first sample gets: at random, or places and instants would pair up for good."""
    return mi.UInt32(rng.next_float32() * samples) if plan.moving else mi.UInt32(0)


def _sample_ray(
    mi: Any, frame: dict[str, Any], pixel_index: Any, sample: Any, rng: Any, samples: int, first_stratum: Any, plan: KernelPlan
) -> Any:
    """A ray of one sample, spread over the pixel's area (box filter) and over the time that the shutter is open."""
    jitter = mi.Point2f(rng.next_float32(), rng.next_float32())
    place = stratified(mi, sample, samples, jitter) if plan.stratified else jitter
    pixel = _pixel(mi, frame, pixel_index, plan) + mi.Vector2f(place.x - 0.5, place.y - 0.5)
    tau = mi.Float(0)
    if plan.moving:
        stratum = (sample * 37 + first_stratum) % samples  # 37: coprime to every sample count in use
        tau = (mi.Float(stratum) + rng.next_float32()) / samples - 0.5
    ray, _ = camera_ray(mi, dr, frame, pixel, tau, distorted=plan.distorted)
    return ray


def _generator(mi: Any, seed: Any, pixel_index: Any) -> Any:
    """An independent PCG32 stream per pixel, seeded through the Tiny Encryption Algorithm (Zafar et al. 2010)."""
    state, sequence = mi.sample_tea_32(pixel_index, seed)
    return mi.PCG32(initstate=mi.UInt64(state), initseq=mi.UInt64(sequence))
