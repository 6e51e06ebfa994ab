"""Lights that exist only in formulas: a disk at infinity, or flat patches nearby.

They never hide anything, never enter the id mask, are not seen by the camera directly, and move for free. What holds of a
recorded kernel is a ``Kind``; what changes from frame to frame are the constants.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from renderer.rotation import turned
from scenes.emitter import DistantDisk, Emitter, Patches
from scenes.spectrum import band_irradiance


@dataclass(frozen=True, slots=True)
class Kind:
    """What a kernel bakes in: ``patches`` = 0 for a disk at infinity, else their number; ``is_round``: their shape."""

    patches: int = 0
    is_round: bool = False

    def share(self, index: int, samples: int) -> float:
        """Which share of ``samples`` patch ``index`` gets when they take turns; where there are too few for that, an equal one."""
        if samples < self.patches:
            return 1 / self.patches
        first, end = (-(-one * samples // self.patches) for one in (index, index + 1))
        return (end - first) / samples

    @classmethod
    def of(cls, emitter: Emitter) -> "Kind":
        """The kind of a light of one instant."""
        return cls() if isinstance(emitter, DistantDisk) else cls(len(emitter.centres_target), emitter.is_round)


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """A point of the light as seen from a surface: unit ``direction`` to it, ``weight`` = radiance over sampling density.

    ``density``: of that sampling, per steradian. ``point``: where the light was met; None at infinity.
    """

    direction: Any
    weight: Any
    density: Any
    point: Any


def emitter_constants(emitter: Emitter, turn_rad: Any, drift_m: Any, power: float) -> dict[str, Any]:
    """A light as plain numbers for the kernel, its in-band power multiplied by ``power``.

    ``turn_rad``, ``drift_m``: how it turns about and moves past the target within an exposure, see ``renderer.sensor.Shutter``.
    ``versine`` = 1 − cos α = 2 sin²(α/2) stands for a disk's half-angle α: it is small (1e-5 at 1 au, 1e-8 at 30 au), and the
    cosine itself has only a few float32 steps, then none, left below one.
    """
    moving = {"turn": np.asarray(turn_rad), "drift": np.asarray(drift_m)}
    if isinstance(emitter, DistantDisk):
        versine = 2 * math.sin(emitter.half_angle_rad / 2) ** 2
        irradiance = power * band_irradiance(emitter.irradiance_w_m2_nm)
        return moving | {"direction": emitter.direction_target, "versine": versine, "irradiance": irradiance}
    low, high = math.cos(emitter.outer_rad), math.cos(emitter.inner_rad)
    return moving | {
        "radiance": power * band_irradiance(emitter.radiance_w_m2_sr_nm),
        "cos_outer": low,
        "beam_edge": max(high - low, 1e-6),
        **{str(index): _patch(emitter, index) for index in range(len(emitter.centres_target))},
    }


def apparent_radius_rad(emitter: Emitter) -> float:
    """Half the angle under which the target's origin sees the light, for patches that of the largest one."""
    if isinstance(emitter, DistantDisk):
        return emitter.half_angle_rad
    distance_m = np.linalg.norm(emitter.centres_target, axis=1)
    return float(np.arctan(np.sqrt(emitter.areas_m2 / np.pi) / np.maximum(distance_m, 1e-6)).max())


def _patch(patches: Patches, index: int) -> dict[str, Any]:
    return {
        "centre": patches.centres_target[index],
        "u": patches.u_target[index],
        "v": patches.v_target[index],
        "normal": patches.normals_target[index],
        "area": float(patches.areas_m2[index]),
    }


def sample_light(
    mi: Any, dr: Any, kind: Kind, light: dict[str, Any], origin: Any, u: Any, turn: tuple[Any, int] | None = None
) -> Sample:
    """A direction from ``origin`` to the light from two uniform numbers ``u``: uniform in solid angle or area.

    ``turn`` = (number of the sample, how many there are): patches then take turns, so that how often each is looked at is no
    matter of chance; without it one is drawn. With ``tau`` in ``light`` it stands where it does at that instant of the exposure.
    """
    if not kind.patches:
        found = _sample_disk(mi, dr, light, u)
        return replace(found, direction=_now(mi, dr, light, found.direction))
    found = _sample_patches(mi, dr, kind, light, _at_middle(mi, dr, light, origin), u, turn)
    if "tau" not in light:
        return found
    point = mi.Point3f(_now(mi, dr, light, found.point + light["drift"] * light["tau"]))
    return replace(found, direction=_now(mi, dr, light, found.direction), point=point)


def light_along(
    mi: Any, dr: Any, kind: Kind, light: dict[str, Any], origin: Any, direction: Any, samples: int, pdf: Any
) -> tuple[Any, Any]:
    """What a ray from ``origin`` along the unit vector ``direction``, found with density ``pdf``, meets if nothing is in between.

    Radiance times the ray's share by the power heuristic against ``sample_light`` in turns of ``samples`` (0 beside the light),
    and the distance to the farthest of what it meets: patches do not hide each other, there as here.
    """
    direction = turned(mi, dr, direction, -light["turn"] * light["tau"]) if "tau" in light else direction
    if not kind.patches:
        density = disk_density(dr, light)
        weighed = disk_weight(light) * density * power(pdf, density)
        return dr.select(sees_disk(dr, light, direction), weighed, 0.0), mi.Float(dr.inf)
    origin = _at_middle(mi, dr, light, origin)
    radiance, distance = mi.Float(0), mi.Float(0)
    for index in range(kind.patches):
        met, cosine, away = _meets(mi, dr, kind, light[str(index)], origin, direction)
        density = kind.share(index, samples) * away * away / (dr.maximum(cosine, 1e-6) * light[str(index)]["area"])
        radiance += dr.select(met, light["radiance"] * _beam(dr, light, cosine) * power(pdf, density), 0.0)
        distance = dr.select(met, dr.maximum(distance, away), distance)
    return radiance, distance


def power(chosen: Any, other: Any) -> Any:
    """Power heuristic with exponent two (Veach 1997, eq. 9.14)."""
    return chosen * chosen / (chosen * chosen + other * other)


def _now(mi: Any, dr: Any, light: dict[str, Any], direction: Any) -> Any:
    """A direction at mid-exposure turned to where it points at ``tau``."""
    return turned(mi, dr, direction, light["turn"] * light["tau"]) if "tau" in light else direction


def _at_middle(mi: Any, dr: Any, light: dict[str, Any], point: Any) -> Any:
    """The place that a point of the target would have at mid-exposure, were it seen from there as the light sees it at ``tau``.

    Moving one point costs less than moving every patch.
    """
    if "tau" not in light:
        return point
    return mi.Point3f(turned(mi, dr, point, -light["turn"] * light["tau"]) - light["drift"] * light["tau"])


def _sample_disk(mi: Any, dr: Any, disk: dict[str, Any], u: Any) -> Sample:
    versine = u.x * disk["versine"]
    sin_theta = dr.safe_sqrt(versine * (2 - versine))
    sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
    frame = mi.Frame3f(disk["direction"])
    direction = frame.to_world(mi.Vector3f(sin_theta * cos_phi, sin_theta * sin_phi, 1 - versine))
    return Sample(direction, disk_weight(disk), disk_density(dr, disk), None)


def disk_weight(disk: dict[str, Any]) -> Any:
    """Radiance over sampling density of a disk at infinity: L·Ω = E · 2 / (1 + cos α).

    A uniform disk of half-angle α and normal irradiance E has L = E / (π sin² α) and fills Ω = 2π (1 − cos α).
    """
    return disk["irradiance"] * 2 / (2 - disk["versine"])


def sees_disk(dr: Any, disk: dict[str, Any], direction: Any) -> Any:
    """Whether a ray along the unit vector ``direction`` that meets nothing would end on the disk: chord² < 2 (1 − cos α)."""
    return dr.squared_norm(direction - disk["direction"]) < 2 * disk["versine"]


def disk_density(dr: Any, disk: dict[str, Any]) -> Any:
    """Probability density of the disk's sampling per steradian, 1 / Ω."""
    return 1 / (2 * dr.pi * disk["versine"])


def _sample_patches(
    mi: Any, dr: Any, kind: Kind, light: dict[str, Any], origin: Any, u: Any, turn: tuple[Any, int] | None
) -> Sample:
    """One of the patches, then a point uniform on it: density = share · d² / (A cos θ) per steradian (Veach 1997, eq. 8.2)."""
    samples = turn[1] if turn is not None else 0
    if turn is not None and samples >= kind.patches:
        chosen, across = turn[0] * kind.patches // samples, u.x
    else:
        chosen = mi.UInt32(dr.minimum(u.x * kind.patches, kind.patches - 0.5))
        across = u.x * kind.patches - mi.Float(chosen)
    place = _on_patch(mi, dr, kind, mi.Point2f(across, u.y))
    point, normal, area = mi.Point3f(0), mi.Vector3f(0), mi.Float(0)  # area: over the patch's share of the samples
    for index in range(kind.patches):
        patch, here = light[str(index)], chosen == index
        point = dr.select(here, mi.Point3f(patch["centre"] + patch["u"] * place.x + patch["v"] * place.y), point)
        normal = dr.select(here, mi.Vector3f(patch["normal"]), normal)
        area = dr.select(here, mi.Float(patch["area"] / kind.share(index, samples)), area)
    towards = mi.Vector3f(point - origin)
    square = dr.maximum(dr.squared_norm(towards), 1e-12)
    direction = towards * dr.rsqrt(square)
    cosine = -dr.dot(direction, normal)
    lit = dr.maximum(cosine, 0.0)
    weight = light["radiance"] * _beam(dr, light, cosine) * lit * area / square
    return Sample(direction, weight, square / (dr.maximum(lit, 1e-6) * area), point)


def _on_patch(mi: Any, dr: Any, kind: Kind, u: Any) -> Any:
    """A place (−1..1)² on a patch, in units of its half axes, uniform in area."""
    if not kind.is_round:
        return mi.Point2f(2 * u.x - 1, 2 * u.y - 1)
    sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
    radius = dr.safe_sqrt(u.x)
    return mi.Point2f(radius * cos_phi, radius * sin_phi)


def _meets(mi: Any, dr: Any, kind: Kind, patch: dict[str, Any], origin: Any, direction: Any) -> tuple[Any, Any, Any]:
    """Whether a ray meets the shining side of a patch, the cosine there and the distance."""
    cosine = -dr.dot(direction, patch["normal"])
    away = -dr.dot(mi.Vector3f(patch["centre"] - origin), patch["normal"]) / dr.select(cosine > 1e-6, cosine, 1.0)
    across = mi.Vector3f(origin + direction * away - patch["centre"])
    a = dr.dot(across, patch["u"]) / dr.squared_norm(patch["u"])
    b = dr.dot(across, patch["v"]) / dr.squared_norm(patch["v"])
    within = a * a + b * b < 1 if kind.is_round else (abs(a) < 1) & (abs(b) < 1)
    return (cosine > 1e-6) & (away > 0) & within, cosine, away


def _beam(dr: Any, light: dict[str, Any], cosine: Any) -> Any:
    """The beam's relative radiance, see ``scenes.emitter.beam_profile``."""
    step = dr.clip((cosine - light["cos_outer"]) / light["beam_edge"], 0.0, 1.0)
    return step * step * (3 - 2 * step)
