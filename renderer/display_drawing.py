"""The picture on a display: the target as plain computer graphics draw it, one value a dot.

Every part has one grey, lit by one distant light and an ambient share; no highlights, no light from part to part. What a dot
shows is the mean over samples at the same places in every dot, one of them in its middle where there is no anti-aliasing.
"""

from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from renderer.display_kernel import drawing_kernel
from renderer.emitters import Kind
from renderer.footprint import footprint
from renderer.kernels import KernelPlan, geometry_kernel
from renderer.meshes import load, part_ids
from renderer.photometry import Photometry
from renderer.runner import Layers, Mask, Runner
from renderer.sensor import Shutter, lens_constants
from renderer.window import place_window, survey, target_extent
from scenes.arrays import Floats
from scenes.camera import Camera
from scenes.detector import FixedExposure
from scenes.display import Display
from scenes.exr import Window
from scenes.material import Coated, Material, Paint
from scenes.scenario import Scenario
from scenes.solids import bounding_points
from scenes.target import Target

_INSTANT = FixedExposure(time_s=1e-9)  # what is shown while the camera's shutter is open belongs to one instant


def virtual_camera(display: Display, camera: Camera) -> Camera:
    """The camera whose pixels are the display's dots: a pinhole in ``camera``'s place."""
    changes = {
        "width_px": display.dots[0],
        "height_px": display.dots[1],
        "pixel_pitch_m": display.pitch_m,
        "focal_length_m": display.true_distance_m,
        "principal_point_px": None,
        "distortion": (0.0,) * 5,
        "exposure": _INSTANT,
        "detector": camera.detector.model_copy(update={"psf_sigma_px": 0.0}),
    }
    return camera.model_copy(update=changes)


def in_grey(target: Target, folded: Photometry) -> Target:
    """``target`` in matt paints, as grey as its materials reflect for the camera in the light: of a coated one, its base."""

    def painted(material: Material) -> Paint:
        colour = material.base_reflectance if isinstance(material, Coated) else material.reflectance
        return Paint(type="paint", source=material.source, reflectance=folded.effective(colour))

    parts = (part.model_copy(update={"material": painted(part.material)}) for part in target.parts)
    return target.model_copy(update={"parts": tuple(parts)})


class Drawing:
    """One scenario's target before the virtual camera, loaded once; drawn from any pose."""

    def __init__(self, scenario: Scenario, display: Display, camera: Camera, folded: Photometry, *, scalar: bool) -> None:
        """``folded``: the real camera under the scenario's light, which decides how grey a material is."""
        self._display, self._scalar = display, scalar
        self.camera = virtual_camera(display, camera)
        self._points = bounding_points(scenario.target)
        self._corners = np.split(self._points, len(scenario.target.parts))
        size = survey(scenario, self.camera).size
        self.scene = load(in_grey(scenario.target, folded), folded)
        self._run = Runner(self.scene, _plan(size, display.anti_aliasing), scalar=scalar)
        self._part_of_shape = part_ids(self.scene, len(scenario.target.parts), scalar=scalar)
        self._size = size

    def picture(self, target_from_cam: RigidTransform, light_target: Floats) -> Layers:
        """Layers of all dots (rows, columns), float32: what is ``drawn``, 0 to 1, and shares of the dot's area.

        These are what the target fills (``coverage``), what of that is turned to the light (``facing``), and lit (``unshadowed``).
        ``light_target``: unit vector to the light, target frame.
        """
        window = self._window(target_from_cam)
        constants, worthwhile = self._constants(target_from_cam, window), self._worthwhile(target_from_cam, window)
        light = {
            "light": light_target,
            "ambient": self._display.ambient,
            "background": self._display.background,
            "shadows": float(self._display.cast_shadows),
        }
        sums = self._run(drawing_kernel, constants | light, worthwhile)
        names = {"drawn": "drawn", "hit": "coverage", "facing": "facing", "open": "unshadowed"}
        n = np.float32(self._display.anti_aliasing)
        found = {names[name]: (total / n).astype(np.float32) for name, total in sums.items()}
        return {name: self._full(layer, window, self._display.background * (name == "drawn")) for name, layer in found.items()}

    def geometry(self, target_from_cam: RigidTransform) -> Layers:
        """Layers of all dots (rows, columns), at their middles: ``z_m``, ``normal.x/y/z`` (camera axes), ``part_id`` (0: none)."""
        window = self._window(target_from_cam)
        constants, worthwhile = self._constants(target_from_cam, window), self._worthwhile(target_from_cam, window)
        raw = self._run(geometry_kernel, constants, worthwhile)
        part_id = np.where(raw.pop("hit"), self._part_of_shape[raw.pop("shape")], 0).astype(np.uint32)
        layers = {name: layer.astype(np.float32) for name, layer in raw.items()} | {"part_id": part_id}
        return {name: self._full(layer, window, 0) for name, layer in layers.items()}

    def _window(self, target_from_cam: RigidTransform) -> Window:
        """The dots around the target."""
        points_cam = target_from_cam.inv().apply(self._points)
        return place_window(target_extent(self.camera, points_cam), self._size, self.camera)

    def _constants(self, target_from_cam: RigidTransform, window: Window) -> dict[str, Any]:
        still = Shutter(target_from_cam, np.zeros(3), np.zeros(3))
        place = {"window_x": float(window.x_px), "window_y": float(window.y_px)}
        return {**lens_constants(self.camera.intrinsics), **still.constants, **place}

    def _worthwhile(self, target_from_cam: RigidTransform, window: Window) -> Mask:
        """The dots that a ray-by-ray variant has to look at; a wavefront looks at all."""
        if not self._scalar:
            return np.ones((window.height_px, window.width_px), dtype=np.bool_)
        return footprint(self._corners, target_from_cam.inv(), self.camera.intrinsics, window)

    def _full(self, layer: Any, window: Window, elsewhere: float) -> Any:
        """A layer of ``window`` within all dots."""
        columns, rows = self._display.dots
        full = np.full((rows, columns), elsewhere, dtype=layer.dtype)
        full[window.slices] = layer
        return full


def _plan(size: tuple[int, int], samples: int) -> KernelPlan:
    return KernelPlan(
        *size,
        direct_samples=samples,
        indirect_samples=0,
        max_scatterings=1,
        distorted=False,
        moving=False,
        with_glints=False,
        stratified=False,
        kind=Kind(),
        has_partner=False,
    )
