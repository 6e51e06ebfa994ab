"""What stands in for a session where the camera films a display: the picture is drawn dot by dot, then seen through the lens."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from renderer.display_drawing import Drawing
from renderer.display_sight import Sight
from renderer.photometry import Photometry, photometry
from renderer.quality import Preset
from renderer.runner import Layers
from renderer.session import View
from renderer.variant import Backend, activate
from renderer.visibility import visible_fraction
from scenes.arrays import Floats
from scenes.camera import Camera
from scenes.display import Display
from scenes.exr import Window
from scenes.intrinsics import Intrinsics
from scenes.scenario import Scenario

_NOT_THERE = ("direct_specular", "indirect", "indirect_raw")  # a screen's light is all of one kind


class DisplaySession:
    """One display before one camera; answers as ``renderer.session.Session`` does.

    Layers of geometry and masks are those of the dot that a pixel's centre sees, so they lie where the picture shows them.
    """

    def __init__(self, scenario: Scenario, display: Display, camera: Camera, preset: Preset, size: tuple[int, int]) -> None:
        """``size``: of the window about the whole picture, width and height; each pixel gets ``preset``'s rays of direct light."""
        self.backend: Backend = activate()
        self.photometry: Photometry = photometry(camera, display.spectrum)
        in_light = photometry(camera, scenario.lights[scenario.light_names[0]].spectrum)
        self._drawing = Drawing(scenario, display, camera, in_light, scalar=self.backend.is_scalar)
        beside = ((size[0] - camera.width_px) // 2, (size[1] - camera.height_px) // 2)
        self._sight = Sight.of(display, camera.intrinsics, Window(-beside[0], -beside[1], *size), preset.direct_samples)
        self._display = display

    def geometry(self, view: View) -> Layers:
        """Window arrays (h, w): ``z_m``, ``normal.x/y/z`` (camera axes) and ``part_id`` of the virtual target."""
        dots = self._drawing.geometry(view.shutter.target_from_cam)
        return {name: self._sight.at_centre(layer) for name, layer in dots.items()}

    def radiance(self, view: View) -> Layers:
        """Window arrays (h, w): the screen's radiance as ``direct_diffuse``, W m⁻² sr⁻¹ in the band; no other light.

        ``coverage``, ``facing``, ``unshadowed``: shares of each pixel's area, of the virtual target as it was drawn.
        """
        drawn = self._drawing.picture(view.shutter.target_from_cam, view.lights[0].direction_target)
        radiance = self._display.radiance(self._display.levels(drawn.pop("drawn"))).astype(np.float32)
        layers = {"direct_diffuse": self._sight.mean(radiance)}
        layers |= {name: np.zeros_like(layers["direct_diffuse"]) for name in _NOT_THERE}
        return layers | {name: self._sight.mean(layer) for name, layer in drawn.items()}

    def visible_fraction(self, cam_from_target: RigidTransform, points_target: Floats, intrinsics: Intrinsics) -> float:
        """Share of the virtual target's silhouette that is on the screen and in the picture, as if nothing else cut it off."""
        lenses = (intrinsics, self._drawing.camera.intrinsics)
        return float(np.min([visible_fraction(self._drawing.scene, cam_from_target, points_target, lens) for lens in lenses]))
