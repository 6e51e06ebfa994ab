"""A target as a Mitsuba scene: one mesh a part, in the target's frame, which never moves."""

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from renderer.materials import bsdf
from scenes.solids import Solid, solids
from scenes.spectrum import Quantity
from scenes.target import Target


class Folded(Protocol):
    """What gives the one number that stands for a spectrum: a camera under a light, or a laser's wavelength."""

    def effective(self, quantity: Quantity) -> float:
        """The number."""


def load(target: Target, fold: Folded) -> Any:
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


def part_ids(scene: Any, parts: int, *, scalar: bool) -> NDArray[np.uint32]:
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
