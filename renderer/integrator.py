"""The light layers of one wavefront of camera rays.

``direct_layers`` follows light → surface → camera and keeps diffuse and specular lobes apart; ``indirect_layer`` follows what
has met two or more surfaces (Kajiya 1986; next-event estimation and the power heuristic as in Veach 1997, chapter 9).
direct + indirect equals a plain path tracer in expectation. Every function works on a whole wavefront (LLVM, CUDA) and on a
single ray (scalar variants) alike; ``mask ^ True`` negates both a mask and a Python bool. Each ray draws its random numbers
whatever it meets, so both come to the same picture.
"""

from typing import Any

import drjit as dr

from renderer.emitters import Kind, Sample, light_along, power, sample_light

# Depth 6 in Mitsuba's count: the camera ray, then at most five scattering events; what lies beyond carries < 0.7 % of the
# energy even among metals (measured).
MAX_SCATTERINGS = 5
_SHADOW_EPSILON = 1e-3  # of the way: a shadow ray ends before the light that it goes to


def direct_layers(
    mi: Any,
    scene: Any,
    ray: Any,
    light: dict[str, Any],
    on_light: Any,
    in_lobe: Any,
    turn: tuple[Any, int],
    narrow: Any,
    *,
    kind: Kind,
) -> dict[str, Any]:
    """Direct light of each ray: ``diffuse`` and ``specular`` radiance, and how much of the light its point can see.

    ``hit``, ``facing`` (the surface is turned to the sampled point of the light), ``open`` (facing and nothing in between) are
    0 or 1. ``on_light``: two uniform numbers that choose the point of the light. ``in_lobe``: two that choose a direction of the
    surface's own lobe; None where no part of the target needs it. ``narrow``: which parts do, see ``is_narrow``. ``turn``: see
    ``sample_light``.
    """
    si = scene.ray_intersect(ray, mi.RayFlags.All, True)  # neighbouring lanes are neighbouring pixels
    hit = si.is_valid()
    if _is_off(hit):
        return dict.fromkeys(("diffuse", "specular", "hit", "facing", "open"), 0.0)
    to = sample_light(mi, dr, kind, light, si.p, on_light, turn)
    bsdf = si.bsdf(ray)
    facing = hit & (dr.dot(si.n, to.direction) > 0) & (dr.dot(si.n, ray.d) < 0)
    is_open = facing & (scene.ray_test(_towards(si, to), True, facing) ^ True)
    wo = si.to_local(to.direction)
    diffuse, specular = _lobes(mi, bsdf, si, wo, is_open)
    if in_lobe is not None:
        lobes = hit & is_narrow(mi, si, narrow)
        specular = specular * dr.select(lobes, power(to.density, bsdf.pdf(_mirror_like(mi), si, wo, is_open & lobes)), 1.0)
    layers = {"diffuse": diffuse * to.weight, "specular": specular * to.weight}
    if in_lobe is not None:
        layers["specular"] += _glint(mi, scene, bsdf, si, light, in_lobe, lobes, kind, turn[1])
    return layers | {"hit": _number(mi, hit), "facing": _number(mi, facing), "open": _number(mi, is_open)}


@dr.syntax
def indirect_layer(
    mi: Any, scene: Any, ray: Any, light: dict[str, Any], rng: Any, *, kind: Kind, max_scatterings: int
) -> Any:
    """Radiance of light that was scattered by at least two surfaces before it reached the camera."""
    ray = mi.Ray3f(ray)
    si = scene.ray_intersect(ray, mi.RayFlags.All, True)
    active = si.is_valid()
    throughput = mi.Float(1.0)
    radiance = mi.Float(0.0)
    scatterings = mi.UInt32(1)
    while dr.hint(active & (scatterings < max_scatterings), exclude=[kind]):
        bsdf = si.bsdf(ray)
        u = mi.Point2f(rng.next_float32(), rng.next_float32())
        sample, value = bsdf.sample(mi.BSDFContext(), si, rng.next_float32(), u, active)
        throughput *= _first(value)
        active &= throughput > 0
        ray = si.spawn_ray(si.to_world(sample.wo))
        si = scene.ray_intersect(ray, active)
        active &= si.is_valid()
        radiance += throughput * _lit(mi, scene, si, ray, light, rng, active, kind)
        scatterings += 1
    return radiance


def _lit(mi: Any, scene: Any, si: Any, ray: Any, light: dict[str, Any], rng: Any, active: Any, kind: Kind) -> Any:
    """Radiance that the surface at ``si`` sends back along ``ray`` in the light, by next-event estimation alone."""
    u = mi.Point2f(rng.next_float32(), rng.next_float32())
    if _is_off(active):
        return 0.0
    to = sample_light(mi, dr, kind, light, si.p, u)
    facing = active & (dr.dot(si.n, to.direction) > 0)
    is_open = facing & (scene.ray_test(_towards(si, to), facing) ^ True)
    value = si.bsdf(ray).eval(mi.BSDFContext(), si, si.to_local(to.direction), is_open)
    return dr.select(is_open, _first(value) * to.weight, 0.0)


def is_narrow(mi: Any, si: Any, narrow: Any) -> Any:
    """Whether the surface's lobe is narrow against the light: ``narrow`` (0 or 1 by the shape's number, None: all are)."""
    if narrow is None:
        return True
    shape: Any = dr.reinterpret_array(mi.UInt32, si.shape)
    return dr.gather(mi.UInt32, narrow, shape, si.is_valid()) == 1


def _glint(
    mi: Any, scene: Any, bsdf: Any, si: Any, light: dict[str, Any], in_lobe: Any, active: Any, kind: Kind, samples: int
) -> Any:
    """Specular direct light found by sampling the mirror-like lobe: the other half of the power heuristic."""
    sample, value = bsdf.sample(_mirror_like(mi), si, 0.5, in_lobe, active)  # there is but one lobe to choose from
    direction = si.to_world(sample.wo)
    radiance, distance = light_along(mi, dr, kind, light, si.p, direction, samples, sample.pdf)
    lucky = active & (radiance > 0) & (dr.dot(si.n, direction) > 0) & (sample.pdf > 0)
    if _is_off(lucky):
        return 0.0
    ray = si.spawn_ray(direction)
    ray.maxt = dr.minimum(ray.maxt, distance * (1 - _SHADOW_EPSILON))
    lucky = lucky & (scene.ray_test(ray, lucky) ^ True)
    return dr.select(lucky, _first(value) * radiance, 0.0)


def _towards(si: Any, to: Sample) -> Any:
    """The shadow ray from a surface to the point of the light that was sampled."""
    return si.spawn_ray(to.direction) if to.point is None else si.spawn_ray_to(to.point)


def _lobes(mi: Any, bsdf: Any, si: Any, wo: Any, active: Any) -> tuple[Any, Any]:
    """The diffuse and the mirror-like lobe, each times the cosine (a metal has no diffuse lobe, a paint no other: 0)."""
    matt = mi.BSDFContext()
    matt.type_mask = mi.BSDFFlags.DiffuseReflection
    diffuse = dr.select(active, _first(bsdf.eval(matt, si, wo, active)), 0.0)
    specular = dr.select(active, _first(bsdf.eval(_mirror_like(mi), si, wo, active)), 0.0)
    return diffuse, specular


def _mirror_like(mi: Any) -> Any:
    context = mi.BSDFContext()
    context.type_mask = mi.BSDFFlags.GlossyReflection
    return context


def _first(spectrum: Any) -> Any:
    """The only channel there is: all channels carry the same band."""
    return spectrum[0]


def _is_off(active: Any) -> bool:
    """Whether this is a scalar variant's single ray that met nothing: its shape is a null pointer (wavefronts mask theirs)."""
    return isinstance(active, bool) and not active


def _number(mi: Any, mask: Any) -> Any:
    return dr.select(mask, mi.Float(1.0), mi.Float(0.0))
