"""A scene that is loaded once; between frames only the camera, the window and the sun move."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from renderer.denoise import denoise_indirect
from renderer.emitters import Kind, apparent_radius_rad, emitter_constants
from renderer.footprint import footprint
from renderer.kernels import KernelPlan, direct_kernel, geometry_kernel, indirect_kernel
from renderer.materials import is_near_mirror
from renderer.meshes import load, part_ids
from renderer.photometry import Photometry, photometry
from renderer.quality import Preset
from renderer.runner import Layers, Mask, Runner
from renderer.sensor import Shutter, lens_constants
from renderer.variant import Backend, activate
from renderer.visibility import visible_fraction
from scenes.arrays import Floats
from scenes.camera import Camera
from scenes.exr import Window
from scenes.intrinsics import Intrinsics
from scenes.lighting import SceneLight
from scenes.provenance import stream
from scenes.scenario import Scenario, realize
from scenes.solids import bounding_points
from scenes.target import Target


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """What one picture depends on besides the scene: the moving camera, its window, the lights, the random stream.

    ``lights``: the key light first. ``power``: of each light, its mean while the shutter is open over its mean over all time.
    ``partner_target``: where the other camera of the rig stands, target frame; None for a single camera.
    """

    shutter: Shutter
    window: Window
    lights: tuple[SceneLight, ...]
    seed: int
    frame: int
    camera_name: str
    power: tuple[float, ...] = ()
    partner_target: Floats | None = None


class Session:
    """One target before one camera: loads, compiles on the first frame, then replays the recorded kernels.

    Materials and responsivity are folded with each light's own spectrum, so every light is a pass of its own. Radiance is
    counted in the key light's spectrum: that of another light is scaled so that it makes the same photo-electrons.
    """

    def __init__(
        self, scenario: Scenario, camera: Camera, preset: Preset, size: tuple[int, int], *, moving: bool, has_partner: bool = False
    ) -> None:
        """``size``: of the window, width and height; ``moving``: blur; ``has_partner``: a rig's camera."""
        self.backend: Backend = activate()
        target = scenario.target
        plan = KernelPlan(
            *size,
            direct_samples=preset.direct_samples,
            indirect_samples=preset.indirect_samples,
            max_scatterings=preset.max_scatterings,
            distorted=camera.intrinsics.is_distorted,
            moving=moving,
            with_glints=False,
            stratified=preset.stratified,
            kind=Kind(),
            has_partner=has_partner,
        )
        self._lens = lens_constants(camera.intrinsics)
        self._preset, self._plan, self._intrinsics = preset, plan, camera.intrinsics
        self._part_corners = np.split(bounding_points(target), len(target.parts))
        lights = realize(scenario, scenario.seed, 0).lights
        self._passes = [_pass(target, camera, light, scenario, plan, scalar=self.backend.is_scalar) for light in lights]
        self.photometry: Photometry = self._passes[0].photometry
        self._scene = self._passes[0].scene
        self._part_of_shape = part_ids(self._scene, len(target.parts), scalar=self.backend.is_scalar)

    @property
    def plans(self) -> tuple[KernelPlan, ...]:
        """What the recorded kernels of each light bake in, the key light's first."""
        return tuple(one.run.plan for one in self._passes)

    def geometry(self, view: View) -> Layers:
        """Window arrays (h, w) at pixel centres: ``z_m``, ``normal.x/y/z`` (camera axes), ``part_id`` (0 = background).

        Before a rig also ``hidden`` (bool): what the other camera cannot see because of the target itself.
        """
        raw = self._passes[0].run(geometry_kernel, self._constants(view, 0), self._worthwhile(view))
        part_id = np.where(raw.pop("hit"), self._part_of_shape[raw.pop("shape")], 0).astype(np.uint32)
        hidden = {"hidden": raw.pop("hidden")} if "hidden" in raw else {}
        return {name: layer.astype(np.float32) for name, layer in raw.items()} | {"part_id": part_id} | hidden

    def radiance(self, view: View) -> Layers:
        """Window arrays (h, w) of the light layers, W m⁻² sr⁻¹ in band, and the fractions of each pixel's area.

        ``direct_diffuse``, ``direct_specular``, ``indirect``, ``indirect_raw``: of all lights together. ``coverage`` (target),
        ``facing`` (turned to the key light), ``unshadowed`` (turned to it with nothing in between), and for any further light
        ``unshadowed.<name>``, each of the pixel's whole area.
        """
        layers = self._lit_by(view, 0)
        for index, light in enumerate(view.lights[1:], start=1):
            more = self._lit_by(view, index)
            scale = np.float32(self._passes[index].photometry.electrons_per_radiance / self.photometry.electrons_per_radiance)
            for name in ("direct_diffuse", "direct_specular", "indirect_raw", "indirect"):
                layers[name] = layers[name] + scale * more[name]
            layers[f"unshadowed.{light.name}"] = more["unshadowed"]
        return layers

    def _lit_by(self, view: View, index: int) -> Layers:
        """The layers of one light."""
        constants, worthwhile, run = self._constants(view, index), self._worthwhile(view), self._passes[index].run
        sums = run(direct_kernel, constants, worthwhile)
        n = np.float32(self._plan.direct_samples)
        names = {"diffuse": "direct_diffuse", "specular": "direct_specular", "hit": "coverage", "open": "unshadowed"}
        layers = {names.get(name, name): (total / n).astype(np.float32) for name, total in sums.items()}
        raw = np.zeros_like(layers["coverage"])
        if self._plan.indirect_samples:
            total = run(indirect_kernel, constants, worthwhile)["indirect"]
            raw = np.asarray(total / np.float32(self._plan.indirect_samples), dtype=np.float32)
        smooth = denoise_indirect(raw, layers["coverage"]) if self._preset.denoise_indirect else raw
        return layers | {"indirect_raw": raw, "indirect": smooth}

    def visible_fraction(self, cam_from_target: RigidTransform, points_target: Floats, intrinsics: Intrinsics) -> float:
        """See ``renderer.visibility``."""
        return visible_fraction(self._scene, cam_from_target, points_target, intrinsics)

    def _worthwhile(self, view: View) -> Mask:
        """The pixels that a ray-by-ray variant has to look at; a wavefront looks at all."""
        if not self.backend.is_scalar:
            return np.ones((view.window.height_px, view.window.width_px), dtype=np.bool_)
        return footprint(self._part_corners, view.shutter.target_from_cam.inv(), self._intrinsics, view.window)

    def _constants(self, view: View, index: int) -> dict[str, Any]:
        """Everything that changes from frame to frame, as plain numbers."""
        light, shutter = view.lights[index], view.shutter
        # A light that stands still before the chaser turns about the target as the camera does.
        still = light.fixed_to == "target"
        turn, drift = (np.zeros(3), np.zeros(3)) if still else (shutter.turn_rad, shutter.drift_m)
        prefix = "" if index == 0 else f"{light.name}."
        return {
            **self._lens,
            **shutter.constants,
            "window_x": float(view.window.x_px),
            "window_y": float(view.window.y_px),
            "direct_seed": _seed32(view, f"{prefix}direct"),
            "indirect_seed": _seed32(view, f"{prefix}indirect"),
            "light": emitter_constants(light.emitter, turn, drift, view.power[index] if view.power else 1.0),
            **({} if view.partner_target is None else {"partner": view.partner_target}),
            **self._passes[index].narrow,
        }


@dataclass(frozen=True, slots=True, eq=False)
class _Pass:
    """What renders one light: spectra folded with it, a scene with materials to match, its recorded kernels.

    ``narrow``: by the kernels' number of a shape, whether its lobe is narrow against the light and has to be sampled to find it.
    """

    photometry: Photometry
    scene: Any
    run: Runner
    narrow: dict[str, Any]


def _pass(target: Target, camera: Camera, light: SceneLight, scenario: Scenario, plan: KernelPlan, *, scalar: bool) -> _Pass:
    folded = photometry(camera, scenario.lights[light.name].spectrum)
    scene = load(target, folded)
    narrow = np.array([False, *(is_near_mirror(part.material, apparent_radius_rad(light.emitter)) for part in target.parts)])
    own = replace(plan, kind=Kind.of(light.emitter), with_glints=bool(narrow.any()))
    by_shape = {} if scalar or not narrow.any() else {"narrow": narrow[part_ids(scene, len(target.parts), scalar=False)]}
    return _Pass(folded, scene, Runner(scene, own, scalar=scalar), by_shape)


def _seed32(view: View, layer: str) -> int:
    return int(stream(view.seed, view.frame, f"{view.camera_name}.{layer}").integers(2**32))
