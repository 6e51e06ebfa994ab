"""How a chaser holds its boresight on the target: attitude and angular velocity in closed form."""

import math

import numpy as np

from scenes.arrays import Floats, frozen
from scenes.errors import UsageError
from scenes.orbit import cross

LEAST_ANGLE_DEG = 1.0  # between line of sight and roll reference; the roll rate grows as the inverse of its sine
_LEAST_RANGE_M = 1e-3


def pointed(sight_m: Floats, sight_rate_m_s: Floats, reference: Floats) -> tuple[Floats, Floats]:
    """inertial_from_chaser (3, 3) and the chaser's inertial angular velocity (3,) in its own axes, rad/s.

    z lies along ``sight_m`` (3,), from chaser to target in inertial axes, and the unit vector ``reference`` points upwards in
    the picture: x = z × reference / |z × reference|, y = z × x (down). ``sight_rate_m_s``: the inertial rate of the sight.
    Raises ``UsageError`` where sight and reference are too nearly parallel to fix the roll, or the craft are in one place.
    """
    distance = math.sqrt(float(sight_m @ sight_m))
    if distance < _LEAST_RANGE_M:
        raise UsageError(f"the chaser meets the target's centre of mass ({distance:.2g} m): there is no line of sight")
    z = sight_m / distance
    z_rate = (sight_rate_m_s - z * (z @ sight_rate_m_s)) / distance
    across = cross(z, reference)
    sine = math.sqrt(float(across @ across))
    if sine < math.sin(math.radians(LEAST_ANGLE_DEG)):
        raise UsageError(
            f"the line of sight comes within {math.degrees(math.asin(min(sine, 1.0))):.2g} deg of the direction "
            f"{[round(float(one), 4) for one in reference]} that fixes the chaser's roll, at least {LEAST_ANGLE_DEG:g} deg "
            "are needed; name another direction"
        )
    x = across / sine
    y = cross(z, x)
    # ż = ω × z gives ω along x and y; ẋ = ω × x gives ω along z
    omega = (-(z_rate @ y), z_rate @ x, cross(z_rate, reference) @ y / sine)
    return frozen(np.stack([x, y, z], axis=1)), frozen(omega)
