"""One camera takes one picture of a scene: radiance, exposure, detection, and the truth of what it sees."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from renderer.detection import FixedPattern, detect, exposure_time_s, fixed_pattern
from renderer.display import DisplaySession
from renderer.masks import fractions, light_mask
from renderer.optics import blurred
from renderer.partner import outside_of_partner
from renderer.quality import PRESETS, Preset
from renderer.runner import Layers
from renderer.sensor import Shutter, exposure_instants_s, longest_exposure_s
from renderer.session import Session, View
from renderer.window import inside, place_window, survey, target_extent, whole_picture
from scenes.arrays import Floats
from scenes.camera import Camera
from scenes.detector import AutoExposure
from scenes.exr import Window
from scenes.pose_columns import pose_columns
from scenes.provenance import stream
from scenes.scenario import Scenario, Scene
from scenes.solids import bounding_points


@dataclass(frozen=True, slots=True, eq=False)
class Photograph:
    """A picture in DN (height, width), its truth layers in ``window`` (h, w each), its row of the truth table, its exposure."""

    pixels: NDArray[Any]
    window: Window
    layers: dict[str, NDArray[Any]]
    truth: dict[str, float]
    exposure_s: float


class Photographer:
    """One camera of a scenario, ready to take any of its frames."""

    def __init__(self, scenario: Scenario, name: str, preset: Preset | None = None) -> None:
        """Loads the target, finds the window that holds it in all frames, draws the detector's fixed pattern.

        ``preset`` replaces that of the scenario's quality.
        """
        self._scenario, self._name = scenario, name
        self._camera: Camera = scenario.sensors[name]
        self._points = bounding_points(scenario.target)
        self._cam_from_chaser = self._camera.mount.chaser_from_cam.inv()
        self._pattern: FixedPattern = fixed_pattern(self._camera, name, scenario.seed)
        self._survey = survey(scenario, self._camera) if scenario.display is None else whole_picture(self._camera)
        partner = scenario.partner(name)
        self._partner: Camera | None = None if partner is None else scenario.sensors[partner]
        self.session = self._session(preset or PRESETS[scenario.quality])

    def _session(self, preset: Preset) -> Session | DisplaySession:
        scenario, size = self._scenario, self._survey.size
        if scenario.display is not None:
            return DisplaySession(scenario, scenario.display, self._camera, preset, size)
        paired = self._partner is not None
        return Session(scenario, self._camera, preset, size, moving=self._survey.moves, has_partner=paired)

    def take(self, scene: Scene) -> Photograph:
        """Expose, detect, annotate."""
        rule = self._camera.exposure
        view = self._view(scene, 0.0 if isinstance(rule, AutoExposure) else rule.time_s)
        window = inside(view.window, self._camera)
        geometry = self._geometry(view, window)
        light, rate = self._exposed(view, window)
        exposure_s = exposure_time_s(self._camera, rate, _on_target(geometry, light))
        if isinstance(rule, AutoExposure) and (self._survey.moves or any(one.ripple for one in scene.lights)):
            # Blur and ripple belong to the exposure that was chosen.
            light, rate = self._exposed(view := self._view(scene, exposure_s), window)
        electrons = rate * np.float32(exposure_s)
        rng = stream(self._scenario.seed, scene.frame, f"{self._name}.detector")
        pixels = detect(electrons, window, self._camera, exposure_s, self._pattern, rng)
        full = electrons >= self._camera.detector.full_well_e
        saturated = full | (pixels[window.slices] >= self._camera.detector.white_dn)
        mask = light_mask(light, geometry["part_id"], saturated)
        kept = {name: layer for name, layer in light.items() if name != "facing"}
        truth = self._truth(scene, view) | fractions(mask) | {"exposure_s": exposure_s}
        return Photograph(pixels, window, {**kept, **geometry, "mask": mask}, truth, exposure_s)

    def mean_electrons(self, scene: Scene, framed: Scene, exposure_s: float, sampling_seed: int) -> NDArray[np.float32]:
        """(h, w) mean photo-electrons of ``scene`` in the window of the frame ``framed``, sampled by the stream of a seed."""
        window = self._view(framed, 0.0).window
        view = replace(self._view(scene, exposure_s), window=window, seed=sampling_seed)
        return self._exposed(view, inside(window, self._camera))[1] * np.float32(exposure_s)

    def image_motion_px(self, cam_from_target: RigidTransform) -> Floats:
        """(6,) pixels that the fastest of the target's outermost points moves, per rad of a turn and per metre of a shift."""
        points, centre = cam_from_target.apply(self._points), cam_from_target.translation
        here, tiny = self._camera.intrinsics.project(points), 1e-6
        turned = [points + tiny * np.cross(axis, points - centre) for axis in np.eye(3)]
        ends = [self._camera.intrinsics.project(one) for one in (*turned, *(points + tiny * axis for axis in np.eye(3)))]
        return np.array([np.nanmax(np.linalg.norm(end - here, axis=1)) / tiny for end in ends])

    def _geometry(self, view: View, window: Window) -> Layers:
        """The geometry layers in ``window``, before a rig with what the other camera does not see."""
        geometry = _cut(self.session.geometry(view), view.window, window)
        if self._partner is not None:
            lens, other = self._camera.intrinsics, self._partner
            other_from_cam = other.mount.chaser_from_cam.inv() * self._camera.mount.chaser_from_cam
            beside = outside_of_partner(geometry["z_m"], window, lens, other_from_cam, other.intrinsics)
            hidden = (geometry.pop("hidden") | beside) & (geometry["part_id"] > 0)
            geometry["hidden_from_partner"] = hidden.astype(np.uint32)
        return geometry

    def _exposed(self, view: View, window: Window) -> tuple[Layers, NDArray[np.float32]]:
        """Light layers and mean electrons/s in ``window``; what stands beside the picture is blurred in before it is cut off."""
        light = self.session.radiance(view)
        total = light["direct_diffuse"] + light["direct_specular"] + light["indirect"]
        rate = blurred(total * np.float32(self.session.photometry.electrons_per_radiance), self._camera.detector.psf_sigma_px)
        return _cut(light, view.window, window), _cut({"rate": rate}, view.window, window)["rate"]

    def _view(self, scene: Scene, exposure_s: float) -> View:
        """The window goes by the longest exposure, so that it does not move with the one that is chosen."""
        swept = [pose.apply(self._points) for pose in self._poses(scene, longest_exposure_s(self._camera))]
        window = place_window(target_extent(self._camera, np.concatenate(swept)), self._survey.size, self._camera)
        shutter = Shutter.between(*(pose.inv() for pose in self._poses(scene, exposure_s)))
        power = tuple(light.power_factor(scene.time_s, exposure_s) if exposure_s > 0 else 1.0 for light in scene.lights)
        return View(
            shutter, window, scene.lights, self._scenario.seed, scene.frame, self._name, power, self._partner_target(scene)
        )

    def _partner_target(self, scene: Scene) -> Floats | None:
        """Where the rig's other camera stands at mid-exposure, target frame."""
        if self._partner is None:
            return None
        return np.asarray(scene.chaser_from_target.inv().apply(self._partner.mount.chaser_from_cam.translation))

    def _poses(self, scene: Scene, exposure_s: float) -> list[RigidTransform]:
        """``cam_from_target`` at the opening, the middle and the closing of the shutter."""
        instants = exposure_instants_s(scene.time_s, exposure_s)
        return [self._cam_from_chaser * scene.pose_at(instant_s) for instant_s in instants]

    def _truth(self, scene: Scene, view: View) -> dict[str, float]:
        """The pose columns and what else follows from geometry, sensor axes."""
        cam_from_target = view.shutter.target_from_cam.inv()
        cam_from_chaser = self._cam_from_chaser.rotation
        light_cam = cam_from_chaser.apply(np.array(scene.lights[0].direction_chaser))  # SciPy wants a writable array
        position = cam_from_target.translation
        range_m = float(np.linalg.norm(position))
        phase = np.arccos(np.clip(-light_cam @ position / range_m, -1, 1)) if range_m > 0 else np.nan
        omega = dict(zip(("omega_x_rad_s", "omega_y_rad_s", "omega_z_rad_s"), scene.omega_target_rad_s))
        light = dict(zip(("light_x", "light_y", "light_z"), (float(value) for value in light_cam)))
        visible = self._visible_fraction(cam_from_target)
        measures = {"range_m": range_m, "phase_angle_deg": float(np.degrees(phase)), "visible_fraction": visible}
        return pose_columns(cam_from_target) | measures | light | omega

    def _visible_fraction(self, cam_from_target: RigidTransform) -> float:
        return self.session.visible_fraction(cam_from_target, self._points, self._camera.intrinsics)


def _cut(layers: Layers, rendered: Window, kept: Window) -> Layers:
    """Window arrays of ``rendered`` cut down to ``kept``."""
    rows, columns = Window(kept.x_px - rendered.x_px, kept.y_px - rendered.y_px, kept.width_px, kept.height_px).slices
    return {name: np.ascontiguousarray(layer[rows, columns]) for name, layer in layers.items()}


def _on_target(geometry: Layers, light: Layers) -> NDArray[np.bool_]:
    """Pixels whose centre lies on the target; of a target smaller than that, those that hold any of it."""
    centres = geometry["part_id"] > 0
    return np.asarray(centres if centres.any() else light["coverage"] > 0)
