"""Renders frames of a finished data set once more and compares them bit by bit."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from renderer.generate import FrameMaker, manifest_of
from renderer.variant import probe
from scenes.dataset import Dataset
from scenes.dataset_manifest import differences
from scenes.exr import Window
from scenes.scenario import Scenario


def cannot_compare(dataset: Dataset) -> str:
    """Why this machine's frames may differ from the data set's in bits (another backend or version), or an empty text."""
    scenario = Scenario.model_validate(dataset.scenario)
    return "; ".join(differences(dataset.manifest, manifest_of(scenario, dataset.manifest.selected, probe())))


def rerender(dataset: Dataset, frames: Iterable[int]) -> Iterator[tuple[int, list[str]]]:
    """Each frame with its faults: what the renderer makes now and what lies in the folder, where they differ."""
    maker = FrameMaker(Scenario.model_validate(dataset.scenario))
    for frame in frames:
        record, stored = maker.record(frame), dataset.observation(frame)
        faults = [
            f"frame {frame:06d}, {name}: {np.count_nonzero(pixels != stored.images[name].pixels)} pixels differ when rendered again"
            for name, pixels in record.images.items()
            if not np.array_equal(pixels, stored.images[name].pixels)
        ]
        for name, layers in record.layers.items():
            faults += _layer_faults(frame, name, layers, record.windows[name], dataset.layers(frame, name))
        yield frame, faults


def _layer_faults(
    frame: int, camera: str, layers: Mapping[str, NDArray[Any]], window: Window, stored: Mapping[str, NDArray[Any]]
) -> list[str]:
    return [
        f"frame {frame:06d}, {camera}: layer {name!r} differs when rendered again"
        for name, layer in layers.items()
        if not np.array_equal(stored[name][window.slices], layer)
    ]
