"""Runs a kernel over a window: recorded once and replayed for every frame, or pixel by pixel where rays are traced one by one."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from renderer.kernels import KernelPlan

Layers = dict[str, NDArray[Any]]
Mask = NDArray[np.bool_]


class Runner:
    """The kernels of one Mitsuba scene."""

    def __init__(self, scene: Any, plan: KernelPlan, *, scalar: bool) -> None:
        """``scalar``: whether the variant traces rays one by one."""
        self._scene, self.plan, self._scalar = scene, plan, scalar
        self._frozen: dict[str, Any] = {}

    def __call__(self, kernel: Any, constants: dict[str, Any], worthwhile: Mask) -> Layers:
        """Window arrays (h, w) by name; pixels that are not ``worthwhile`` may be left at zero."""
        flat = self._one_by_one(kernel, constants, worthwhile) if self._scalar else self._wavefront(kernel, constants)
        return {name: values.reshape(self.plan.height_px, self.plan.width_px) for name, values in flat.items()}

    def _wavefront(self, kernel: Any, constants: dict[str, Any]) -> Layers:
        import drjit as dr
        import mitsuba as mi

        if kernel.__name__ not in self._frozen:
            self._frozen[kernel.__name__] = _recorded(kernel, self.plan)
        frame = _device_constants(mi, constants)
        dr.make_opaque(frame)
        pixels = dr.arange(mi.UInt32, self.plan.width_px * self.plan.height_px)
        dr.eval(pixels)
        result = self._frozen[kernel.__name__](self._scene, frame, pixels)
        return {name: np.array(values) for name, values in result.items()}

    def _one_by_one(self, kernel: Any, constants: dict[str, Any], worthwhile: Mask) -> Layers:
        import mitsuba as mi

        frame, pixels = _device_constants(mi, constants), np.flatnonzero(worthwhile)
        pixels = pixels if pixels.size else np.zeros(1, dtype=np.int64)  # one tells the layers' names and types
        rows = [kernel(mi, self._scene, frame, int(pixel), self.plan) for pixel in pixels]
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
    if isinstance(value, np.ndarray) and value.dtype == np.bool_:
        return mi.UInt32(value.astype(np.uint32))
    array = np.asarray(value, dtype=np.float64)
    return mi.Matrix3f(array.tolist()) if array.ndim == 2 else mi.Vector3f(array.tolist())
