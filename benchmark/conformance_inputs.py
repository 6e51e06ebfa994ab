"""Inputs of a method, changed in one way: copied, emptied, or a model in other axes."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from scipy.spatial.transform import RigidTransform

from scenes.recording import Image, ModelCloud, Observation, Scan


def changed(
    observation: Observation, pixels: Callable[[np.ndarray], np.ndarray], returns: Callable[[np.ndarray], np.ndarray] = np.copy
) -> Observation:
    """The observation with the pixels of its pictures, and the places and strengths of its scans' returns, changed."""
    images = {name: Image(pixels(image.pixels)) for name, image in observation.images.items()}
    scans = {
        name: Scan(returns(scan.points_lidar), returns(scan.intensity), scan.time_s.copy())
        for name, scan in observation.scans.items()
    }
    return replace(observation, images=MappingProxyType(images), scans=MappingProxyType(scans))


def without_returns(values: np.ndarray) -> np.ndarray:
    """What a scan holds where no beam came back."""
    return np.full_like(values, np.nan)


def moved_cloud(model: ModelCloud, relabelling: RigidTransform) -> ModelCloud:
    """A writable copy of a model in other axes."""
    points, normals = model.points_target.copy(), model.normals_target.copy()  # SciPy cannot turn a read-only array
    return ModelCloud(np.array(relabelling.apply(points)), np.array(relabelling.rotation.apply(normals)))


def arrays(one: Observation, other: Observation) -> Iterator[tuple[str, str, np.ndarray, np.ndarray]]:
    """What a method could write into, side by side: what it is, whose it is, and both values."""
    for name in one.images:
        yield "picture", name, one.images[name].pixels, other.images[name].pixels
    for name in one.scans:
        for part in ("points_lidar", "intensity", "time_s"):
            yield "scan", name, getattr(one.scans[name], part), getattr(other.scans[name], part)
