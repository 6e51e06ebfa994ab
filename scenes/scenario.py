"""A scenario is what a file says; a scene is one instant of it with no randomness left."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import AfterValidator, Discriminator, Field, StringConstraints, Tag, model_validator
from scipy.spatial.transform import RigidTransform

from scenes.arrays import Floats
from scenes.camera import Camera
from scenes.config import load
from scenes.display import Display
from scenes.errors import unknown
from scenes.lidar import Lidar
from scenes.light import Light
from scenes.lighting import SceneLight, scene_light
from scenes.motion import Motion
from scenes.orbit_motion import TumbleInOrbit
from scenes.orbit_trajectory import bound
from scenes.reframe import reframed
from scenes.rig import StereoRig
from scenes.spec import Positive, Spec, is_empty, kind_of
from scenes.target import Target
from scenes.trajectory import Trajectory
from scenes.wings import CubeWithWings

Name = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_-]{0,40}$")]
Quality = Literal["reference", "standard", "fast", "draft"]

# Key paths whose value may be the name of a library entry or a file.
REFERENCES = {
    "target": "targets",
    "cameras.*": "cameras",
    "rigs.*": "rigs",
    "rigs.*.camera": "cameras",
    "lidars.*": "lidars",
    "lights.*": "lights",
    "display": "displays",
}
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
        AfterValidator(lambda target: target.assembled() if isinstance(target, CubeWithWings) else reframed(target)),
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
    cameras: dict[Name, Camera] = Field(default_factory=dict)
    rigs: dict[Name, StereoRig] = Field(default_factory=dict)
    # Left out of the resolved text where there is none: data sets of scenarios without a LIDAR keep their digests.
    lidars: dict[Name, Lidar] = Field(default_factory=dict, exclude_if=is_empty)
    lights: Annotated[dict[Name, Light], Field(max_length=8)] = Field(default_factory=dict)
    key_light: Name | None = None
    motion: Motion
    display: Display | None = Field(default=None, exclude_if=is_empty)

    @model_validator(mode="after")
    def _has_something_to_see_with(self) -> "Scenario":
        if not self.cameras and not self.rigs and not self.lidars:
            raise ValueError("a scenario needs at least one entry under cameras, rigs or lidars")
        for name in self.rigs:
            for sensor in self.rigs[name].sensors(name):
                if sensor in self.cameras:
                    raise ValueError(f"rigs.{name} has a camera {sensor!r}, and so has cameras")
        for name in self.lidars:
            if name in self.sensors:
                raise ValueError(f"lidars.{name}: a camera is called {name!r} too")
        return self

    @model_validator(mode="after")
    def _has_a_key_light(self) -> "Scenario":
        if not self.lights and self.sensors:
            raise ValueError("a scenario with a camera needs at least one entry under lights")
        if self.key_light is None and len(self.lights) > 1:
            raise ValueError(f"key_light must name the one of {', '.join(sorted(self.lights))} whose shadows the masks describe")
        if self.key_light is not None and self.key_light not in self.lights:
            raise ValueError(f"key_light: {unknown('light', self.key_light, self.lights)}")
        return self

    @model_validator(mode="after")
    def _free_bodies_have_mass(self) -> "Scenario":
        if isinstance(self.motion, TumbleInOrbit) and self.target.mass is None:
            raise ValueError("motion: a tumble in orbit needs target.mass (principal_kg_m2, centre_of_mass_m), and there is none")
        return self

    @model_validator(mode="after")
    def _one_camera_films_a_display(self) -> "Scenario":
        sensors = [*self.sensors, *self.lidars]
        if self.display is not None and (self.rigs or len(sensors) > 1 or self.lidars):
            raise ValueError(f"display: one camera films it, and nothing else, but there are {', '.join(sensors)}")
        if self.display is not None and len(self.lights) > 1:
            raise ValueError(f"display: its picture is drawn in one light, but there are {', '.join(self.lights)}")
        return self

    @property
    def sensors(self) -> dict[str, Camera]:
        """Every camera by the name of its pictures: single ones, and those of the rigs as ``<rig>-left``, ``<rig>-right``."""
        return {**self.cameras, **{sensor: camera for name in sorted(self.rigs) for sensor, camera in self._of_rig(name).items()}}

    @property
    def trajectory(self) -> Trajectory:
        """The motion as something that gives ``chaser_from_target`` at any time, bound to the target where it needs to be."""
        if isinstance(self.motion, TumbleInOrbit):
            assert self.target.mass is not None  # see _free_bodies_have_mass
            return bound(self.motion, self.target.mass)
        return self.motion

    @property
    def light_names(self) -> tuple[str, ...]:
        """The key light, then the others by name. What is said of shadows is said of the first. None with LIDARs alone."""
        if not self.lights:
            return ()
        key = self.key_light or next(iter(self.lights))
        return (key, *sorted(self.lights.keys() - {key}))

    @property
    def radiance_spectrum(self) -> Floats:
        """In which spectrum (``BAND_NM``, any scale) the radiance of pictures is counted: the key light's, or a display's white."""
        return self.lights[self.light_names[0]].spectrum if self.display is None else self.display.spectrum

    def partner(self, sensor: str) -> str | None:
        """The other camera of the rig that ``sensor`` belongs to, None for a single camera."""
        pairs = [tuple(self._of_rig(name)) for name in self.rigs]
        return next((one if sensor == other else other for one, other in pairs if sensor in (one, other)), None)

    def field_of(self, sensor: str) -> str:
        """Where a person finds a camera in the scenario: ``cameras.nav``, or ``rigs.stereo.camera`` for both of a rig's."""
        rig = next((name for name in self.rigs if sensor in self._of_rig(name)), None)
        return f"cameras.{sensor}" if rig is None else f"rigs.{rig}.camera"

    def _of_rig(self, name: str) -> dict[str, Camera]:
        return self.rigs[name].sensors(name)


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """One instant: ``chaser_from_target`` at mid-exposure, the motion around it, the lights (the key light first).

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
    pose = scenario.trajectory.chaser_from_target(time_s, frame, seed)
    lights = tuple(scene_light(name, scenario.lights[name], pose, seed, frame) for name in scenario.light_names)
    return Scene(
        frame=frame,
        time_s=time_s,
        chaser_from_target=pose,
        pose_at=lambda instant_s: scenario.trajectory.chaser_from_target(instant_s, frame, seed),
        omega_target_rad_s=scenario.trajectory.omega_target_rad_s(time_s, seed),
        lights=lights,
    )
