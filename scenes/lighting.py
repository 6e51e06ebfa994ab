"""A light as it stands at one instant, made from what a scenario says of it."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.spatial.transform import RigidTransform

from scenes.arrays import Floats, frozen, unit
from scenes.draw import Direction, direction, scalar
from scenes.emitter import DistantDisk, Emitter, Patches
from scenes.errors import UsageError
from scenes.incandescence import Ripple
from scenes.lamp import HalogenLamp, LightPanels
from scenes.light import Earthshine, Light, Sun
from scenes.provenance import stream

_NEAREST_M = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class SceneLight:
    """A light of one instant.

    ``direction_chaser``, ``direction_target``: unit vector from the target's origin to the light (to the middle of it).
    ``position_chaser``: where it stands, metres; None for one at infinity. ``fixed_to``: in which of the two frames it stays
    while the shutter is open. ``irradiance_w_m2_nm`` on ``BAND_NM``: at the target's origin, on a surface that faces it, at
    mean power. ``ripple``: how its power swings about that mean.
    """

    name: str
    fixed_to: Literal["chaser", "target"]
    direction_chaser: Floats
    direction_target: Floats
    emitter: Emitter
    irradiance_w_m2_nm: Floats
    position_chaser: Floats | None = None
    ripple: Ripple | None = None

    def power_factor(self, time_s: float, exposure_s: float) -> float:
        """Its mean power over an exposure about ``time_s``, relative to its mean over all time."""
        return 1.0 if self.ripple is None else self.ripple.mean(time_s, exposure_s)


def scene_light(name: str, light: Light, chaser_from_target: RigidTransform, seed: int, frame: int) -> SceneLight:
    """``light`` before a target at ``chaser_from_target``, its draws made from the streams of (seed, frame)."""
    match light:
        case Sun():
            return _sun(name, light, chaser_from_target, seed, frame)
        case Earthshine():
            towards = _direction(name, light.direction, seed, frame)
            return _distant(name, light.frame, towards, light.half_angle_rad, light.spectrum, chaser_from_target)
        case HalogenLamp():
            return _lamp(name, light, chaser_from_target, seed, frame)
        case LightPanels():
            return _panels(name, light, chaser_from_target, seed, frame)


def _sun(name: str, sun: Sun, chaser_from_target: RigidTransform, seed: int, frame: int) -> SceneLight:
    towards = _direction(name, sun.direction, seed, frame)
    distance_au = scalar(sun.distance_au, stream(seed, frame, f"lights.{name}.distance_au"))
    half_angle_rad = float(np.arcsin(np.sin(np.radians(sun.half_angle_deg)) / distance_au))
    return _distant(name, sun.frame, towards, half_angle_rad, sun.spectrum / distance_au**2, chaser_from_target)


def _direction(name: str, field: Direction, seed: int, frame: int) -> Floats:
    return direction(field, stream(seed, frame, f"lights.{name}.direction"))


def _distant(
    name: str,
    frame: Literal["chaser", "target"],
    towards: Floats,
    half_angle_rad: float,
    irradiance_w_m2_nm: Floats,
    chaser_from_target: RigidTransform,
) -> SceneLight:
    attitude = chaser_from_target.rotation
    in_chaser = towards if frame == "chaser" else attitude.apply(towards)
    in_target = frozen(attitude.inv().apply(in_chaser))
    disk = DistantDisk(in_target, half_angle_rad, frozen(irradiance_w_m2_nm))
    return SceneLight(name, frame, frozen(in_chaser), in_target, disk, disk.irradiance_w_m2_nm)


def _lamp(name: str, lamp: HalogenLamp, chaser_from_target: RigidTransform, seed: int, frame: int) -> SceneLight:
    target_from_frame = chaser_from_target.inv() if lamp.frame == "chaser" else RigidTransform.identity()
    position = target_from_frame.apply(lamp.position_m)
    aim = np.zeros(3) if lamp.aim_m is None else target_from_frame.apply(lamp.aim_m)
    if np.linalg.norm(aim - position) < _NEAREST_M:
        raise UsageError(f"lights.{name}.position_m: in frame {frame} the lamp stands where it is aimed at, so it points nowhere")
    u, v = _across(aim - position, lamp.radius_m)
    power_w = scalar(lamp.power_w, stream(seed, frame, f"lights.{name}.power_w"))
    patch = Patches(position[None], u[None], v[None], True, frozen(lamp.spectrum * power_w), *lamp.angles_rad)
    return _near(name, lamp.frame, patch, chaser_from_target, lamp.ripple)


def _panels(name: str, light: LightPanels, chaser_from_target: RigidTransform, seed: int, frame: int) -> SceneLight:
    target_from_frame = chaser_from_target.inv() if light.frame == "chaser" else RigidTransform.identity()
    axes = np.array([panel.half_axes for panel in light.panels])
    centres = target_from_frame.apply(np.array([panel.centre_m for panel in light.panels]))
    u, v = (target_from_frame.rotation.apply(axes[:, one]) for one in (0, 1))
    flux_w = scalar(light.flux_w, stream(seed, frame, f"lights.{name}.flux_w"))
    patches = Patches(centres, u, v, False, frozen(light.spectrum * flux_w))
    return _near(name, light.frame, patches, chaser_from_target, None)


def _near(
    name: str, frame: Literal["chaser", "target"], patches: Patches, chaser_from_target: RigidTransform, ripple: Ripple | None
) -> SceneLight:
    """A light at a finite distance, which must not be zero."""
    middle = patches.centre_target
    towards = frozen(unit(middle)) if np.linalg.norm(middle) > _NEAREST_M else frozen([0.0, 0.0, 1.0])
    return SceneLight(
        name=name,
        fixed_to=frame,
        direction_chaser=frozen(chaser_from_target.rotation.apply(np.array(towards))),
        direction_target=towards,
        emitter=patches,
        irradiance_w_m2_nm=frozen(patches.irradiance_w_m2_nm(np.zeros(3))),
        position_chaser=frozen(chaser_from_target.apply(middle)),
        ripple=ripple,
    )


def _across(axis: Floats, radius_m: float) -> tuple[Floats, Floats]:
    """Two vectors of length ``radius_m`` perpendicular to each other and to ``axis``, right-handed about it."""
    normal = unit(axis)
    aside = unit(np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))]))
    return aside * radius_m, np.cross(normal, aside) * radius_m
