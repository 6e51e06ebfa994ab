"""A light of one instant as geometry: what a renderer samples. Everything is in the target's frame at mid-exposure."""

import math
from dataclasses import dataclass

import numpy as np

from scenes.arrays import Floats


@dataclass(frozen=True, slots=True, eq=False)
class DistantDisk:
    """A uniform disk at infinity: unit ``direction_target`` to its centre, and how large it looks.

    ``irradiance_w_m2_nm`` on ``BAND_NM``: on a surface that faces the disk.
    """

    direction_target: Floats
    half_angle_rad: float
    irradiance_w_m2_nm: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Patches:
    """Flat one-sided areas near the target, all of one kind.

    ``centres_target`` (n, 3); ``u_target``, ``v_target`` (n, 3): half axes of the ellipse (``is_round``) or rectangle, the
    light leaving on the side of u × v. ``radiance_w_m2_sr_nm`` on ``BAND_NM`` holds within ``inner_rad`` of that normal and
    falls smoothly to zero at ``outer_rad`` (cubic in the cosine).
    """

    centres_target: Floats
    u_target: Floats
    v_target: Floats
    is_round: bool
    radiance_w_m2_sr_nm: Floats
    inner_rad: float = math.pi / 2
    outer_rad: float = math.pi / 2

    @property
    def normals_target(self) -> Floats:
        """Unit vectors (n, 3) along which the light leaves."""
        normals = np.cross(self.u_target, self.v_target)
        return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))

    @property
    def areas_m2(self) -> Floats:
        """Area of each patch (n,)."""
        box = 4 * np.linalg.norm(np.cross(self.u_target, self.v_target), axis=1)
        return np.asarray(box * (math.pi / 4 if self.is_round else 1.0))

    @property
    def centre_target(self) -> Floats:
        """The middle of all patches (3,)."""
        return np.asarray(self.centres_target.mean(axis=0))

    def irradiance_w_m2_nm(self, point_target: Floats) -> Floats:
        """Spectral irradiance at a point, on a surface that faces each patch, patches taken as points (far away)."""
        towards = np.asarray(point_target) - self.centres_target
        square = np.maximum(np.sum(towards**2, axis=1), 1e-12)  # within a micrometre it is not far away anyway
        cosine = np.sum(self.normals_target * towards, axis=1) / np.sqrt(square)
        beam = beam_profile(cosine, self.inner_rad, self.outer_rad)
        return np.asarray(self.radiance_w_m2_sr_nm * float(np.sum(self.areas_m2 * np.maximum(cosine, 0) * beam / square)))


Emitter = DistantDisk | Patches


def beam_profile(cosine: Floats, inner_rad: float, outer_rad: float) -> Floats:
    """Relative radiance at an angle whose ``cosine`` is given: 1 inside ``inner_rad``, 0 outside ``outer_rad``, smooth between."""
    low, high = math.cos(outer_rad), math.cos(inner_rad)
    step = np.clip((cosine - low) / max(high - low, 1e-9), 0.0, 1.0)
    return np.asarray(step * step * (3 - 2 * step))


def beam_solid_angle_sr(inner_rad: float, outer_rad: float) -> float:
    """∫ profile · cos θ dΩ over the hemisphere: flux of a flat area = radiance · area · this (π for a Lambertian one)."""
    lowest = math.cos(outer_rad)
    cosine = np.linspace(lowest if lowest > 0.99 else 0.0, 1.0, 20_001)  # a narrow beam needs the grid for itself
    return float(2 * math.pi * np.trapezoid(beam_profile(cosine, inner_rad, outer_rad) * cosine, cosine))
