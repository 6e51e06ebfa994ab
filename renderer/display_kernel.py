"""What runs on the device for a display's picture: one lane per dot, looping over the dot's samples."""

from typing import Any

import drjit as dr

from renderer.display_places import even_place
from renderer.kernels import KernelPlan
from renderer.sensor import camera_ray

_NUDGE = (1.1e-3, 0.7e-3)  # of a dot: a ray that meets an edge between two triangles exactly can slip through


@dr.syntax
def drawing_kernel(mi: Any, scene: Any, frame: dict[str, Any], dot_index: Any, plan: KernelPlan) -> dict[str, Any]:
    """Sums over the samples of each dot of the window: what is ``drawn`` there, and 0 or 1 for ``hit``, ``facing``, ``open``."""
    column, row = dot_index % plan.width_px, dot_index // plan.width_px
    corner = mi.Point2f(mi.Float(column) + frame["window_x"], mi.Float(row) + frame["window_y"])
    drawn, hit, facing, unblocked = mi.Float(0), mi.Float(0), mi.Float(0), mi.Float(0)
    sample = mi.UInt32(0)
    while dr.hint(sample < plan.direct_samples, exclude=[plan]):
        across, down = even_place(sample, plan.direct_samples)
        place = corner + mi.Vector2f(across - (0.5 - _NUDGE[0]), down - (0.5 - _NUDGE[1]))
        ray, _ = camera_ray(mi, dr, frame, place, mi.Float(0), distorted=False)
        seen = _seen(mi, scene, ray, frame)
        drawn += seen["drawn"]
        hit += seen["hit"]
        facing += seen["facing"]
        unblocked += seen["open"]
        sample += 1
    return {"drawn": drawn, "hit": hit, "facing": facing, "open": unblocked}


def _seen(mi: Any, scene: Any, ray: Any, frame: dict[str, Any]) -> dict[str, Any]:
    """What one sample of a dot sees; ``open``: turned to the light, and not in a shadow that is drawn."""
    si = scene.ray_intersect(ray)
    hit = si.is_valid()
    if isinstance(hit, bool) and not hit:  # a scalar variant's ray that met nothing has no surface to ask
        return {"drawn": frame["background"], "hit": 0.0, "facing": 0.0, "open": 0.0}
    cosine = dr.dot(si.n, frame["light"])
    facing = hit & (cosine > 0) & (dr.dot(si.n, ray.d) < 0)
    shaded = scene.ray_test(si.spawn_ray(frame["light"]), facing) & (frame["shadows"] > 0)
    is_open = facing & (shaded ^ True)
    grey = si.bsdf(ray).eval_diffuse_reflectance(si, hit)[0]
    shade = grey * (frame["ambient"] + (1 - frame["ambient"]) * dr.select(is_open, cosine, 0.0))
    zero, one = mi.Float(0), mi.Float(1)
    return {
        "drawn": dr.select(hit, shade, frame["background"]),
        "hit": dr.select(hit, one, zero),
        "facing": dr.select(facing, one, zero),
        "open": dr.select(is_open, one, zero),
    }
