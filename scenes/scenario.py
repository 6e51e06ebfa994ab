"""A scenario is what a file says; a scene is one instant of it with no randomness left."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, Discriminator, Field, StringConstraints, Tag
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.arrays import Floats, frozen
from scenes.camera import Camera
from scenes.config import load
from scenes.draw import direction, scalar
from scenes.light import Light
from scenes.motion import Motion
from scenes.provenance import stream
from scenes.spec import Positive, Spec, kind_of
from scenes.target import Target
from scenes.wings import CubeWithWings

Name = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_-]{0,40}$")]
Quality = Literal["reference", "standard", "fast", "draft"]

# Key paths whose value may be the name of a library entry or a file.
REFERENCES = {"target": "targets", "cameras.*": "cameras", "lights.*": "lights"}
MATERIAL_REFERENCES = {
    "target.parts.*.material": "materials",
    "target.body_material": "materials",
    "target.wing_material": "materials",
    "target.yoke_material": "materials",
}


# A target is a list of parts, or a description with few numbers that becomes one before anything else sees it.
if TYPE_CHECKING:
    AnyTarget = Target
else:
    AnyTarget = Annotated[
        Annotated[Target, Tag("assembly")] | Annotated[CubeWithWings, Tag("cube-with-wings")],
        Discriminator(kind_of("assembly")),
        AfterValidator(lambda target: target.assembled() if isinstance(target, CubeWithWings) else target),
    ]


class Scenario(Spec):
    """Everything that a data set follows from, together with the backend and the software versions."""

    description: str = ""
    source: str = ""
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    frame_count: Annotated[int, Field(ge=1, le=10_000_000)]
    rate_hz: Positive = 1.0
    quality: Quality = "standard"
    target: AnyTarget
    cameras: Annotated[dict[Name, Camera], Field(min_length=1)]
    lights: Annotated[dict[Name, Light], Field(min_length=1, max_length=1)]
    motion: Motion


@dataclass(frozen=True, slots=True, eq=False)
class SceneLight:
    """A light of one instant: unit vector to it in both frames, disk half-angle, irradiance on ``BAND_NM`` at the target.

    ``fixed_to`` says in which of the two frames the direction stays while the shutter is open.
    """

    name: str
    fixed_to: Literal["chaser", "target"]
    direction_chaser: Floats
    direction_target: Floats
    half_angle_rad: float
    spectral_irradiance_w_m2_nm: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """One instant: ``chaser_from_target`` at mid-exposure, the motion around it, the lights.

    ``pose_at(time_s)`` gives ``chaser_from_target`` at any time near the frame's own (for shutter opening and closing).
    """

    frame: int
    time_s: float
    chaser_from_target: RigidTransform
    pose_at: Callable[[float], RigidTransform]
    omega_target_rad_s: tuple[float, float, float]
    lights: tuple[SceneLight, ...]


def load_scenario(name_or_path: str, overrides: Sequence[str] = ()) -> Scenario:
    """The scenario of a library name or a TOML file, with ``key.path=value`` overrides. Raises ``ConfigError``."""
    return load("scenario", name_or_path, Scenario, overrides, references=REFERENCES | MATERIAL_REFERENCES)


def realize(scenario: Scenario, seed: int, frame: int) -> Scene:
    """One instant of ``scenario``: every draw made from the streams of (seed, frame)."""
    time_s = frame / scenario.rate_hz
    pose = scenario.motion.chaser_from_target(time_s, frame, seed)
    lights = tuple(_light(name, light, pose.rotation, seed, frame) for name, light in scenario.lights.items())
    return Scene(
        frame=frame,
        time_s=time_s,
        chaser_from_target=pose,
        pose_at=lambda instant_s: scenario.motion.chaser_from_target(instant_s, frame, seed),
        omega_target_rad_s=scenario.motion.omega_target_rad_s(),
        lights=lights,
    )


def _light(name: str, light: Light, chaser_from_target: Rotation, seed: int, frame: int) -> SceneLight:
    towards = direction(light.direction, stream(seed, frame, f"lights.{name}.direction"))
    distance_au = scalar(light.distance_au, stream(seed, frame, f"lights.{name}.distance_au"))
    in_chaser = towards if light.frame == "chaser" else chaser_from_target.apply(towards)
    return SceneLight(
        name=name,
        fixed_to=light.frame,
        direction_chaser=frozen(in_chaser),
        direction_target=frozen(chaser_from_target.inv().apply(in_chaser)),
        half_angle_rad=float(np.arcsin(np.sin(np.radians(light.half_angle_deg)) / distance_au)),
        spectral_irradiance_w_m2_nm=frozen(light.spectral_irradiance_w_m2_nm / distance_au**2),
    )
