"""Orbits about the Earth in inertial axes (J2000), and the axes LVLH that go round with one: x radial, z along its normal."""

from dataclasses import dataclass

import numpy as np

from scenes.arrays import Floats, frozen
from scenes.constants import EARTH_EQUATOR_M, EARTH_J2, EARTH_MU_M3_S2

_ROUNDING = np.array([[5e-9], [1e-11]])  # a few last digits of a position in m and of a velocity in m/s


@dataclass(frozen=True, slots=True, eq=False)
class Lvlh:
    """The local frame of an orbit at one instant.

    ``inertial_from_lvlh`` (3, 3); ``omega_lvlh_rad_s`` (3,): its inertial angular velocity in its own axes;
    ``radius_m`` and its rate.
    """

    inertial_from_lvlh: Floats
    omega_lvlh_rad_s: Floats
    radius_m: float
    radius_rate_m_s: float


def gravity_m_s2(positions_m: Floats, *, j2: bool) -> Floats:
    """Acceleration (..., 3) of point masses at ``positions_m`` (..., 3), inertial axes, metres from the Earth's centre.

    With ``j2`` that of the oblate Earth, a = −μ r/r³ [1 + ³⁄₂ J₂ (R/r)² (k − 5 z²/r²)], k = 1, 1, 3 for x, y, z (Vallado,
    Fundamentals of Astrodynamics, section 8.7.1). The Earth's axis is the inertial z.
    """
    square = np.einsum("...i,...i->...", positions_m, positions_m)[..., None]
    central = -EARTH_MU_M3_S2 * positions_m / (square * np.sqrt(square))
    if not j2:
        return np.asarray(central)
    flat = 1.5 * EARTH_J2 * EARTH_EQUATOR_M**2 / square
    return np.asarray(central * (1.0 + flat * (np.array([1.0, 1.0, 3.0]) - 5.0 * positions_m[..., 2:] ** 2 / square)))


def eccentricity(position_m: Floats, velocity_m_s: Floats) -> float:
    """Eccentricity of the two-body orbit through a state, as the length of Laplace's vector."""
    angular_momentum = np.cross(position_m, velocity_m_s)
    laplace = np.cross(velocity_m_s, angular_momentum) / EARTH_MU_M3_S2 - position_m / np.linalg.norm(position_m)
    return float(np.linalg.norm(laplace))


def semi_major_axis_m(position_m: Floats, velocity_m_s: Floats) -> float:
    """Semi-major axis by the vis-viva equation; negative on a hyperbola."""
    return float(1.0 / (2.0 / np.linalg.norm(position_m) - velocity_m_s @ velocity_m_s / EARTH_MU_M3_S2))


def mean_motion_rad_s(position_m: Floats, velocity_m_s: Floats) -> float:
    """n = √(μ/a³) of an ellipse."""
    return float(np.sqrt(EARTH_MU_M3_S2 / semi_major_axis_m(position_m, velocity_m_s) ** 3))


def lvlh(position_m: Floats, velocity_m_s: Floats, *, j2: bool) -> Lvlh:
    """The local frame of the orbit through an inertial state.

    It turns by h/r² about its z, and with ``j2`` by r aₙ/h about its x, aₙ the acceleration along the orbit's normal.
    """
    radius = float(np.linalg.norm(position_m))
    angular_momentum = cross(position_m, velocity_m_s)
    moment = float(np.linalg.norm(angular_momentum))
    x, z = position_m / radius, angular_momentum / moment
    along_normal = float(gravity_m_s2(position_m, j2=True) @ z) if j2 else 0.0
    return Lvlh(
        inertial_from_lvlh=frozen(np.stack([x, cross(z, x), z], axis=1)),
        omega_lvlh_rad_s=frozen([radius * along_normal / moment, 0.0, moment / radius**2]),
        radius_m=radius,
        radius_rate_m_s=float(x @ velocity_m_s),
    )


def relative_state(frame: Lvlh, displacement_m: Floats, velocity_m_s: Floats) -> tuple[Floats, Floats]:
    """Position and velocity (3,) in LVLH of a displacement and its inertial rate: v = ṙ as seen from the turning frame."""
    position = frame.inertial_from_lvlh.T @ displacement_m
    velocity = frame.inertial_from_lvlh.T @ velocity_m_s - cross(frame.omega_lvlh_rad_s, position)
    return frozen(position), frozen(velocity)


def chaser_orbit(target: Floats, position_lvlh_m: Floats, velocity_lvlh_m_s: Floats, *, j2: bool) -> Floats:
    """The chaser's inertial position and velocity, (2, 3), from those of the ``target``, (2, 3), and its relative state.

    The relative state, target minus chaser, is given in the *chaser's* LVLH, which is what is sought: a fixed point, started at
    the target's own frame. The map contracts by about distance/radius. Raises ``ValueError`` where it does not come to rest.
    """
    found = target
    for _ in range(60):
        frame = lvlh(found[0], found[1], j2=j2)
        turning = velocity_lvlh_m_s + cross(frame.omega_lvlh_rad_s, position_lvlh_m)
        displaced = np.stack([position_lvlh_m, turning]) @ frame.inertial_from_lvlh.T
        last, found = found, target - displaced
        if np.allclose(found, last, rtol=0.0, atol=_ROUNDING):
            return frozen(found)
    raise ValueError(f"no chaser's orbit has the target at {position_lvlh_m.tolist()} m in its own LVLH axes")


def cross(a: Floats, b: Floats) -> Floats:
    """a × b of two vectors (3,); numpy's own takes ten times as long."""
    ax, ay, az = a.tolist()
    bx, by, bz = b.tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
