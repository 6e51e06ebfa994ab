"""The sun as a light that exists only in formulas: a cone of directions, sampled uniformly by solid angle.

It never hides anything, never enters the id mask, is not seen by the camera directly, and moves for free.
"""

import math
from typing import Any

from scenes.arrays import Floats


def sun_constants(direction_target: Floats, turn_rad: Floats, half_angle_rad: float, irradiance_w_m2: float) -> dict[str, Any]:
    """The sun as plain numbers for the kernel. ``turn_rad``: how far its direction turns within an exposure, target frame.

    ``versine`` = 1 − cos α = 2 sin²(α/2) stands for the half-angle α: it is small (1e-5 at 1 au, 1e-8 at 30 au), and the
    cosine itself has only a few float32 steps, then none, left below one.
    """
    versine = 2 * math.sin(half_angle_rad / 2) ** 2
    return {"direction": direction_target, "turn": turn_rad, "versine": versine, "irradiance": irradiance_w_m2}


def sample_sun(mi: Any, dr: Any, sun: dict[str, Any], u: Any) -> Any:
    """A direction to the sun's disk (unit, target frame), uniform in solid angle, from two uniform numbers ``u``."""
    versine = u.x * sun["versine"]
    sin_theta = dr.safe_sqrt(versine * (2 - versine))
    sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
    frame = mi.Frame3f(sun["direction"])
    return frame.to_world(mi.Vector3f(sin_theta * cos_phi, sin_theta * sin_phi, 1 - versine))


def sun_weight(sun: dict[str, Any]) -> Any:
    """Radiance over sampling density of ``sample_sun``: L·Ω = E · 2 / (1 + cos α).

    A uniform disk of half-angle α and normal irradiance E has L = E / (π sin² α) and fills Ω = 2π (1 − cos α).
    """
    return sun["irradiance"] * 2 / (2 - sun["versine"])


def sees_sun(dr: Any, sun: dict[str, Any], direction: Any) -> Any:
    """Whether a ray along the unit vector ``direction`` that meets nothing would end on the disk: chord² < 2 (1 − cos α)."""
    return dr.squared_norm(direction - sun["direction"]) < 2 * sun["versine"]


def sun_density(dr: Any, sun: dict[str, Any]) -> Any:
    """Probability density of ``sample_sun`` per steradian, 1 / Ω."""
    return 1 / (2 * dr.pi * sun["versine"])
