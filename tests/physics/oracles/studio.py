"""Small scenes for measurements: simple targets, cameras without vices, and a session that can be asked for any view."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from renderer.optics import blurred
from renderer.photometry import photometry
from renderer.quality import PRESETS, Preset
from renderer.runner import Layers
from renderer.sensor import Shutter
from renderer.session import Session, View
from renderer.window import place_window, survey, target_extent
from scenes.camera import Camera
from scenes.exr import Window
from scenes.scenario import Scenario, Scene, realize
from scenes.solids import bounding_points

LAMBERT = {"type": "paint", "source": "test", "reflectance": 0.5}
FACING_CAMERA = (0.0, 0.0, 0.0)


def camera(width: int = 96, height: int = 64, f_px: float = 500.0, exposure_s: float = 1e-3, **changes: Any) -> dict[str, Any]:
    """A camera whose detector adds nothing, unless ``changes`` (``detector_*`` keys go to the detector) say so."""
    detector = {"quantum_efficiency": 0.5, "full_well_e": 1e9, "gain_dn_per_e": 0.01, "bits": 16, "shot_noise": False}
    detector |= {name.removeprefix("detector_"): value for name, value in changes.items() if name.startswith("detector_")}
    own = {name: value for name, value in changes.items() if not name.startswith("detector_")}
    body = {"width_px": width, "height_px": height, "pixel_pitch_m": 5e-6, "focal_length_m": f_px * 5e-6, "f_number": 4.0}
    return body | {"exposure": {"type": "fixed", "time_s": exposure_s}, "detector": detector} | own


def box(size: tuple[float, float, float], material: Any = LAMBERT, name: str = "box", **placement: Any) -> dict[str, Any]:
    """One part: a box with edges ``size`` in metres."""
    return {"name": name, "shape": {"type": "box", "size_m": size}, "material": material} | placement


def still(
    distance_m: float = 10.0, rotation_vector_deg: tuple[float, float, float] = FACING_CAMERA, **changes: Any
) -> dict[str, Any]:
    """The target's origin on the boresight, its axes parallel to the camera's unless rotated."""
    return {"type": "spin", "position_m": (0, 0, distance_m), "rotation_vector_deg": rotation_vector_deg} | changes


def scenario(parts: list[dict[str, Any]], cam: dict[str, Any], motion: dict[str, Any] | None = None, **changes: Any) -> Scenario:
    """One camera called ``cam``, one sun called ``sun`` (from behind the camera unless ``sun`` says otherwise), or ``lights``."""
    sun = {"type": "sun", "direction": (0.0, 0.0, -1.0)} | changes.pop("sun", {})
    tree = {"frame_count": 1, "target": {"parts": parts}, "cameras": {"cam": cam}, "lights": {"sun": sun}}
    return Scenario.model_validate(tree | {"motion": motion or still()} | changes)


class Studio:
    """A session for one scenario and camera, with windows, samples and seeds at the test's will."""

    def __init__(
        self, scenario: Scenario, preset: Preset | None = None, *, size: tuple[int, int] | None = None, moving: bool = False
    ) -> None:
        """``size`` of the window, which sits in the picture's middle; left out, the whole picture is rendered."""
        self.scenario = scenario
        self.name, self.camera = next(iter(scenario.sensors.items()))
        width, height = size or (self.camera.width_px, self.camera.height_px)
        corner = ((self.camera.width_px - width) // 2, (self.camera.height_px - height) // 2)
        self.window = Window(*corner, width, height)
        self.spectrum = scenario.lights[scenario.light_names[0]].spectrum
        self.session = Session(scenario, self.camera, preset or PRESETS[scenario.quality], (width, height), moving=moving)

    @classmethod
    def following(cls, scenario: Scenario, preset: Preset | None = None) -> "Studio":
        """With the window's size as the product chooses it."""
        return cls(scenario, preset, size=survey(scenario, next(iter(scenario.sensors.values()))).size)

    def scene(self, frame: int = 0) -> Scene:
        """One instant of the scenario."""
        return realize(self.scenario, self.scenario.seed, frame)

    def cam_from_target(self, frame: int = 0) -> RigidTransform:
        """The true pose at mid-exposure."""
        return self.camera.mount.chaser_from_cam.inv() * self.scene(frame).chaser_from_target

    def view(self, frame: int = 0, *, seed: int = 0, exposure_s: float = 0.0, window: Window | None = None) -> View:
        """What the session renders: ``exposure_s`` matters to moving scenes only."""
        scene = self.scene(frame)
        cam_from_chaser = self.camera.mount.chaser_from_cam.inv()
        instants = (-exposure_s / 2, 0.0, exposure_s / 2)
        shutter = Shutter.between(*((cam_from_chaser * scene.pose_at(scene.time_s + at)).inv() for at in instants))
        return View(shutter, window or self._placed(frame), scene.lights, seed, frame, self.name)

    def _placed(self, frame: int) -> Window:
        size = (self.window.width_px, self.window.height_px)
        points_cam = self.cam_from_target(frame).apply(bounding_points(self.scenario.target))
        return place_window(target_extent(self.camera, points_cam), size, self.camera)

    def repeats(self, view: View, seeds: range) -> Iterator[Layers]:
        """Radiance layers of the same view from independent random streams."""
        for seed in seeds:
            yield self.session.radiance(replace(view, seed=seed))

    @property
    def electrons_per_radiance(self) -> float:
        """Electrons per W m⁻² sr⁻¹ within the camera's own exposure."""
        return photometry(self.camera, self.spectrum).electrons_per_radiance * exposure_s(self.camera)

    def picture(self, layers: Layers, window: Window) -> NDArray[np.float64]:
        """The whole picture (height, width) in noise-free electrons, through the lens."""
        electrons = blurred(total(layers).astype(np.float32), self.camera.detector.psf_sigma_px) * self.electrons_per_radiance
        full = np.zeros((self.camera.height_px, self.camera.width_px))
        full[window.slices] = electrons
        return full


def exposure_s(cam: Camera) -> float:
    """The fixed exposure time."""
    assert cam.exposure.type == "fixed"
    return cam.exposure.time_s


def total(layers: Layers) -> NDArray[np.float64]:
    """All light of a picture, float64."""
    return direct(layers) + layers["indirect"]


def direct(layers: Layers) -> NDArray[np.float64]:
    """Light of one scattering, float64."""
    return layers["direct_diffuse"].astype(np.float64) + layers["direct_specular"]


def inside(mask: NDArray[np.bool_], by_px: int = 1) -> NDArray[np.bool_]:
    """Pixels further than ``by_px`` from where ``mask`` changes."""
    from scipy.ndimage import binary_erosion

    return np.asarray(binary_erosion(mask, iterations=by_px))
