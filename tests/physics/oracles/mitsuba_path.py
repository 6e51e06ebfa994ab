"""Mitsuba's own path tracer and its own sensor and light, to hold our integrator, sensor and sun against."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oracles.studio import Studio
from renderer.materials import bsdf
from renderer.photometry import photometry
from renderer.session import View
from scenes.solids import solids
from scenes.spectrum import band_irradiance

Emitter = Callable[[Any, View], dict[str, Any]]  # (mitsuba, view) → what stands for the light


class MitsubaPath:
    """The scene of a studio as Mitsuba's documentation would have it: perspective camera, directional light, ``path``."""

    def __init__(self, studio: Studio, view: View, emitter: Emitter | None = None) -> None:
        """The studio's undistorted camera stands still; the light is a directional one of the sun's irradiance, or ``emitter``."""
        import mitsuba as mi

        self._mi = mi
        fold = photometry(studio.camera, studio.spectrum).effective
        parts = zip(studio.scenario.target.parts, solids(studio.scenario.target))
        shapes = {f"part{i}": _mesh(mi, solid, bsdf(part.material, fold)) for i, (part, solid) in enumerate(parts)}
        light = (emitter or _directional)(mi, view)
        scene = {"type": "scene", "sensor": _sensor(mi, studio, view), "light": light, **shapes}
        self._scene = mi.load_dict(scene, parallel=False, optimize=False)
        self._shape = (view.window.height_px, view.window.width_px)

    def radiance(self, max_depth: int, samples: int, seeds: range) -> Iterator[NDArray[np.float64]]:
        """Independent pictures (h, w) of the window: ``max_depth`` 2 is direct light, 6 what our presets follow."""
        mi = self._mi
        integrator = mi.load_dict({"type": "path", "max_depth": max_depth, "rr_depth": 1000})
        for seed in seeds:
            picture = mi.render(self._scene, integrator=integrator, spp=samples, seed=seed)
            yield np.array(picture).reshape(self._shape).astype(np.float64)


def _directional(mi: Any, view: View) -> dict[str, Any]:
    irradiance = band_irradiance(view.lights[0].irradiance_w_m2_nm)
    return {
        "type": "directional",
        "direction": (-view.lights[0].direction_target).tolist(),
        "irradiance": {"type": "uniform", "value": irradiance},
    }


def _sensor(mi: Any, studio: Studio, view: View) -> dict[str, Any]:
    camera, lens, window = studio.camera, studio.camera.intrinsics, view.window
    assert not lens.is_distorted
    pose = np.eye(4)
    pose[:3, :3] = view.shutter.target_from_cam.rotation.as_matrix() @ np.diag([-1.0, -1.0, 1.0])
    pose[:3, 3] = view.shutter.target_from_cam.translation
    film = {
        "type": "hdrfilm",
        "width": camera.width_px,
        "height": camera.height_px,
        "crop_offset_x": window.x_px,
        "crop_offset_y": window.y_px,
        "crop_width": window.width_px,
        "crop_height": window.height_px,
        "rfilter": {"type": "box"},
        "pixel_format": "luminance",
        "component_format": "float32",
    }
    return {
        "type": "perspective",
        "fov": float(np.degrees(2 * np.arctan(camera.width_px / 2 / lens.fx_px))),
        "fov_axis": "x",
        "to_world": mi.ScalarTransform4f(pose),
        "near_clip": 0.1,
        "far_clip": 1000.0,
        "film": film,
        "sampler": {"type": "independent"},
    }


def _mesh(mi: Any, solid: Any, material: dict[str, Any]) -> Any:
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(material)
    mesh = mi.Mesh(solid.name, len(solid.vertices_target), len(solid.faces), props=properties)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = np.asarray(solid.vertices_target, np.float32).ravel()
    parameters["faces"] = np.asarray(solid.faces, np.uint32).ravel()
    parameters.update()
    return mesh
