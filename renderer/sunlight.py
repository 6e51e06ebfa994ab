"""The sun as a light that exists only in formulas: a cone of directions, sampled uniformly by solid angle.

It never hides anything, never enters the id mask, is not seen by the camera directly, and moves for free.
"""

from typing import Any


def sample_sun(mi: Any, dr: Any, sun: dict[str, Any], u: Any) -> Any:
    """A direction to the sun's disk (unit, target frame), uniform in solid angle, from two uniform numbers ``u``."""
    cos_theta = 1 - u.x * (1 - sun["cos_half_angle"])
    sin_theta = dr.safe_sqrt(1 - cos_theta * cos_theta)
    sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
    frame = mi.Frame3f(sun["direction"])
    return frame.to_world(mi.Vector3f(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta))


def sun_weight(sun: dict[str, Any]) -> Any:
    """Radiance over sampling density of ``sample_sun``: L·Ω = E · 2 / (1 + cos α).

    A uniform disk of half-angle α and normal irradiance E has L = E / (π sin² α) and fills Ω = 2π (1 − cos α).
    """
    return sun["irradiance"] * 2 / (1 + sun["cos_half_angle"])


def sees_sun(dr: Any, sun: dict[str, Any], direction: Any) -> Any:
    """Whether a ray along ``direction`` that meets nothing would end on the disk."""
    return dr.dot(direction, sun["direction"]) > sun["cos_half_angle"]


def sun_density(dr: Any, sun: dict[str, Any]) -> Any:
    """Probability density of ``sample_sun`` per steradian, 1 / Ω."""
    return 1 / (2 * dr.pi * (1 - sun["cos_half_angle"]))
