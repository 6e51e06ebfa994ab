"""A scene that is loaded once; between frames only the camera, the window and the sun move."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from renderer.denoise import denoise_indirect
from renderer.footprint import footprint
from renderer.kernels import KernelPlan, direct_kernel, geometry_kernel, indirect_kernel
from renderer.materials import bsdf, is_near_mirror
from renderer.photometry import Photometry, photometry
from renderer.quality import Preset
from renderer.sensor import Shutter, lens_constants
from renderer.sunlight import sun_constants
from renderer.variant import Backend, activate
from renderer.visibility import visible_fraction
from scenes.arrays import Floats
from scenes.camera import Camera
from scenes.exr import Window
from scenes.intrinsics import Intrinsics
from scenes.provenance import stream
from scenes.scenario import SceneLight
from scenes.solids import Solid, bounding_points, solids
from scenes.spectrum import band_irradiance
from scenes.target import Target

Layers = dict[str, NDArray[Any]]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """What one picture depends on besides the scene: the moving camera, its window, the light, the random stream."""

    shutter: Shutter
    window: Window
    light: SceneLight
    seed: int
    frame: int
    camera_name: str


class Session:
    """One target before one camera: loads, compiles on the first frame, then replays the recorded kernels."""

    def __init__(
        self, target: Target, camera: Camera, spectrum: Floats, preset: Preset, size: tuple[int, int], *, moving: bool
    ) -> None:
        """``spectrum``: irradiance on ``BAND_NM`` that folds the materials; ``size``: of the window; ``moving``: blur."""
        self.backend: Backend = activate()
        self.photometry: Photometry = photometry(camera, spectrum)
        self._lens = lens_constants(camera.intrinsics)
        self._preset = preset
        self._plan = KernelPlan(
            *size,
            direct_samples=preset.direct_samples,
            indirect_samples=preset.indirect_samples,
            max_scatterings=preset.max_scatterings,
            distorted=camera.intrinsics.is_distorted,
            moving=moving,
            with_glints=any(is_near_mirror(part.material) for part in target.parts),
            stratified=preset.stratified,
        )
        self._intrinsics = camera.intrinsics
        self._part_corners = np.split(bounding_points(target), len(target.parts))
        self._scene = _load(target, self.photometry)
        self._part_of_shape = _part_ids(self._scene, len(target.parts), scalar=self.backend.is_scalar)
        self._run = _Runner(self._scene, self._plan, scalar=self.backend.is_scalar)

    def geometry(self, view: View) -> Layers:
        """Window arrays (h, w) at pixel centres: ``z_m``, ``normal.x/y/z`` (camera axes), ``part_id`` (0 = background)."""
        raw = self._run(geometry_kernel, self._constants(view), self._worthwhile(view))
        part_id = np.where(raw.pop("hit"), self._part_of_shape[raw.pop("shape")], 0).astype(np.uint32)
        return {name: layer.astype(np.float32) for name, layer in raw.items()} | {"part_id": part_id}

    def radiance(self, view: View) -> Layers:
        """Window arrays (h, w) of the light layers, W m⁻² sr⁻¹ in band, and the fractions of each pixel's area.

        ``direct_diffuse``, ``direct_specular``, ``indirect``, ``indirect_raw``; ``coverage`` (target), ``facing`` (turned to
        the sun), ``unshadowed`` (turned to the sun with nothing in between), each of the pixel's whole area.
        """
        constants, worthwhile = self._constants(view), self._worthwhile(view)
        sums = self._run(direct_kernel, constants, worthwhile)
        n = np.float32(self._plan.direct_samples)
        names = {"diffuse": "direct_diffuse", "specular": "direct_specular", "hit": "coverage", "open": "unshadowed"}
        layers = {names.get(name, name): (total / n).astype(np.float32) for name, total in sums.items()}
        raw = self._indirect(constants, worthwhile, layers["coverage"])
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

    def _indirect(self, constants: dict[str, Any], worthwhile: Mask, coverage: NDArray[np.float32]) -> NDArray[np.float32]:
        samples = self._plan.indirect_samples
        if samples == 0:
            return np.zeros_like(coverage)
        total = self._run(indirect_kernel, constants, worthwhile)["indirect"]
        return np.asarray(total / np.float32(samples), dtype=np.float32)

    def _constants(self, view: View) -> dict[str, Any]:
        """Everything that changes from frame to frame, as plain numbers."""
        light = view.light
        return {
            **self._lens,
            **view.shutter.constants,
            "window_x": float(view.window.x_px),
            "window_y": float(view.window.y_px),
            "direct_seed": _seed32(view, "direct"),
            "indirect_seed": _seed32(view, "indirect"),
            "sun": sun_constants(
                light.direction_target,
                # A sun that stands still before the chaser turns about the target as the camera does.
                view.shutter.turn_rad if light.fixed_to == "chaser" else np.zeros(3),
                light.half_angle_rad,
                band_irradiance(light.spectral_irradiance_w_m2_nm),
            ),
        }


class _Runner:
    """Runs a kernel over the window: recorded once and replayed (JIT variants), or pixel by pixel (scalar variants)."""

    def __init__(self, scene: Any, plan: KernelPlan, *, scalar: bool) -> None:
        self._scene, self._plan, self._scalar = scene, plan, scalar
        self._frozen: dict[str, Any] = {}

    def __call__(self, kernel: Any, constants: dict[str, Any], worthwhile: Mask) -> Layers:
        """Window arrays (h, w) by name; pixels that are not ``worthwhile`` may be left at zero."""
        flat = self._one_by_one(kernel, constants, worthwhile) if self._scalar else self._wavefront(kernel, constants)
        return {name: values.reshape(self._plan.height_px, self._plan.width_px) for name, values in flat.items()}

    def _wavefront(self, kernel: Any, constants: dict[str, Any]) -> Layers:
        import drjit as dr
        import mitsuba as mi

        if kernel.__name__ not in self._frozen:
            self._frozen[kernel.__name__] = _recorded(kernel, self._plan)
        frame = _device_constants(mi, constants)
        dr.make_opaque(frame)
        pixels = dr.arange(mi.UInt32, self._plan.width_px * self._plan.height_px)
        dr.eval(pixels)
        result = self._frozen[kernel.__name__](self._scene, frame, pixels)
        return {name: np.array(values) for name, values in result.items()}

    def _one_by_one(self, kernel: Any, constants: dict[str, Any], worthwhile: Mask) -> Layers:
        import mitsuba as mi

        frame, pixels = _device_constants(mi, constants), np.flatnonzero(worthwhile)
        rows = [kernel(mi, self._scene, frame, int(pixel), self._plan) for pixel in pixels]
        shapes = self._scene.shapes()
        for row in rows:
            if "shape" in row:
                row["shape"] = shapes.index(row["shape"]) if row["hit"] else 0
        return {name: _strewn(pixels, [row[name] for row in rows], worthwhile.size) for name in rows[0]}


def _strewn(places: NDArray[np.int64], values: list[Any], size: int) -> NDArray[Any]:
    """``values`` at their ``places`` in an array of zeros."""
    found = np.array(values)
    full = np.zeros(size, dtype=found.dtype)
    full[places] = found
    return full


def _recorded(kernel: Any, plan: KernelPlan) -> Any:
    """``kernel`` as a function that Dr.Jit records on its first calls and replays afterwards."""
    import drjit as dr
    import mitsuba as mi

    @dr.freeze
    def replayed(scene: Any, frame: dict[str, Any], pixels: Any) -> dict[str, Any]:
        result: dict[str, Any] = kernel(mi, scene, frame, pixels, plan)
        return result | ({"shape": dr.reinterpret_array(mi.UInt32, result["shape"])} if "shape" in result else {})

    return replayed


def _device_constants(mi: Any, constants: dict[str, Any]) -> dict[str, Any]:
    """Plain numbers → the variant's types: numbers, 3-vectors and 3 × 3 matrices; seeds stay whole."""
    return {name: _device_value(mi, value) for name, value in constants.items()}


def _device_value(mi: Any, value: Any) -> Any:
    if isinstance(value, dict):
        return _device_constants(mi, value)
    if isinstance(value, int):
        return mi.UInt32(value)
    if isinstance(value, float):
        return mi.Float(value)
    array = np.asarray(value, dtype=np.float64)
    return mi.Matrix3f(array.tolist()) if array.ndim == 2 else mi.Vector3f(array.tolist())


def _seed32(view: View, layer: str) -> int:
    return int(stream(view.seed, view.frame, f"{view.camera_name}.{layer}").integers(2**32))


def _load(target: Target, fold: Photometry) -> Any:
    """The Mitsuba scene: one mesh a part, in order; parts keep their identity (no merging, no parallel loading)."""
    import mitsuba as mi

    parts = zip(target.parts, solids(target))
    meshes = {f"part{i:04d}": _mesh(mi, solid, bsdf(part.material, fold.effective)) for i, (part, solid) in enumerate(parts)}
    return mi.load_dict({"type": "scene", **meshes}, parallel=False, optimize=False)


def _mesh(mi: Any, solid: Solid, bsdf_dict: dict[str, Any]) -> Any:
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(bsdf_dict)
    mesh = mi.Mesh(solid.name, len(solid.vertices_target), len(solid.faces), props=properties)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = np.ascontiguousarray(solid.vertices_target, np.float32).ravel()
    parameters["faces"] = np.ascontiguousarray(solid.faces, np.uint32).ravel()
    parameters.update()
    return mesh


def _part_ids(scene: Any, parts: int, *, scalar: bool) -> NDArray[np.uint32]:
    """Part number (1-based, in the target's order) by what the kernel reports as shape."""
    numbers = np.arange(1, parts + 1, dtype=np.uint32)
    if scalar:
        return numbers
    import drjit as dr
    import mitsuba as mi

    registry = np.array(dr.reinterpret_array(mi.UInt32, scene.shapes_dr()))
    table = np.zeros(int(registry.max()) + 1, dtype=np.uint32)
    table[registry] = numbers
    return table
