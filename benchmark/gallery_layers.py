"""Layers of a cut-out as small pictures with their scales: radiance, what the light did, depth, normals."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from numpy.typing import NDArray

from benchmark.gallery_window import Window
from benchmark.report_pictures import bgr, data_uri, fitted
from benchmark.report_ring_pictures import LIGHT_STATES
from scenes.arrays import Bools, Floats

WIDEST_PX = 360
SKY = "#0b0c0e"
_LOSSLESS, _GOOD = 101, 60  # WebP qualities
_DECADES = 4.0  # of radiance below the brightest that are told apart
_STOPS = 7  # of a scale's colours
_RADIANCE = ("direct_diffuse", "direct_specular", "indirect")
_NORMAL = ("normal.x", "normal.y", "normal.z")
_TOWARDS = (("#ff8080", "turned right"), ("#80ff80", "turned up"), ("#8080ff", "facing the camera"))


@dataclass(frozen=True, slots=True, eq=False)
class Layer:
    """A picture as a data URI. ``scale``: colours from ``low`` to ``high``; ``swatches``: (colour, meaning)."""

    key: str
    title: str
    uri: str
    scale: tuple[str, ...] = ()
    low: str = ""
    high: str = ""
    swatches: tuple[tuple[str, str], ...] = ()


def layers(truth: Mapping[str, NDArray[Any]], window: Window) -> Iterator[Layer]:
    """The layers of a window of which ``truth``, a frame's truth layers (height, width), knows something."""
    cut = {name: window.cut(layer) for name, layer in truth.items()}
    if all(name in cut for name in _RADIANCE):
        yield from _radiance(np.sum([cut[name] for name in _RADIANCE], axis=0, dtype=np.float64))
    if "mask" in cut:
        states = tuple((colour, name) for name, _, colour in LIGHT_STATES)
        yield Layer("light", "Light", data_uri(light_states(_thinned(cut["mask"])), _LOSSLESS), swatches=states)
    if "z_m" in cut and (cut["z_m"] > 0).any():
        yield _depth(_thinned(cut["z_m"]))
    if all(name in cut for name in _NORMAL):
        normals = np.stack([_thinned(cut[name]) for name in _NORMAL], axis=-1)
        yield Layer("normals", "Normals", data_uri(normal_colours(normals), _GOOD), swatches=_TOWARDS)


def light_states(mask: NDArray[Any]) -> NDArray[np.uint8]:
    """(height, width, 3) blue-green-red: the mask's bits in the colours of ``LIGHT_STATES``, a later one over an earlier one."""
    picture = np.full((*mask.shape, 3), bgr(SKY), dtype=np.uint8)
    for _, bit, colour in LIGHT_STATES:
        picture[(mask.astype(np.uint32) & bit) > 0] = bgr(colour)
    return picture


def normal_colours(normals_cam: Floats) -> NDArray[np.uint8]:
    """(height, width, 3) blue-green-red of unit normals in camera axes: ½ + ½ of what points right, up and to the camera."""
    there = np.abs(normals_cam).max(axis=-1, keepdims=True) > 0
    share = 0.5 + 0.5 * normals_cam[..., ::-1] * np.array([-1.0, -1.0, 1.0])  # y down and z forward point away
    return np.asarray(np.where(there, np.round(255 * np.clip(share, 0, 1)), bgr(SKY)), dtype=np.uint8)


def coloured(values: Floats, low: float, high: float, there: Bools, colours: str) -> NDArray[np.uint8]:
    """(..., 3) blue-green-red of ``values`` between ``low`` and ``high`` in a colour map, the sky where there is nothing."""
    share = np.clip((values - low) / max(high - low, 1e-12), 0, 1)
    painted = np.round(255 * mpl.colormaps[colours](share)[..., 2::-1])
    return np.asarray(np.where(there[..., None], painted, bgr(SKY)), dtype=np.uint8)


def stops(colours: str) -> tuple[str, ...]:
    """A colour map as a few CSS colours."""
    sampled = np.round(255 * mpl.colormaps[colours](np.linspace(0, 1, _STOPS))[:, :3]).astype(int)
    return tuple(f"#{red:02x}{green:02x}{blue:02x}" for red, green, blue in sampled.tolist())


def _radiance(radiance: Floats) -> Iterator[Layer]:
    """Logarithmic from the brightest of almost all pixels down; nothing where all is dark."""
    top = float(np.percentile(radiance[radiance > 0], 99.9)) if (radiance > 0).any() else 0.0
    if top <= 0:
        return
    small = fitted(radiance, WIDEST_PX)
    decades = np.log10(np.maximum(small, top * 10**-_DECADES) / top)
    picture = coloured(decades, -_DECADES, 0.0, small > 0, "inferno")
    low, high = (np.format_float_positional(value, 2, fractional=False, trim="-") for value in (top * 10**-_DECADES, top))
    yield Layer("radiance", "Radiance", data_uri(picture, _GOOD), stops("inferno"), low, f"{high} W m⁻² sr⁻¹, logarithmic")


def _depth(z_m: NDArray[Any]) -> Layer:
    there = z_m > 0
    near, far = np.percentile(z_m[there], [0.5, 99.5])
    picture = coloured(z_m.astype(np.float64), near, far, there, "viridis_r")
    digits = 2 if far - near < 10 else 1
    return Layer("depth", "Depth", data_uri(picture, _GOOD), stops("viridis_r"), f"{near:.{digits}f} m", f"{far:.{digits}f} m")


def _thinned(values: NDArray[Any]) -> NDArray[Any]:
    """The pixels nearest to those of a small picture: means would be states, depths and normals that are not there."""
    height, width = values.shape
    small = (height, width) if width <= WIDEST_PX else (max(1, round(height * WIDEST_PX / width)), WIDEST_PX)
    rows, columns = (((np.arange(few) + 0.5) * (many / few)).astype(int) for few, many in zip(small, (height, width)))
    return values[np.ix_(rows, columns)]


def picture_uri(pixels: NDArray[np.uint8], quality: int = _GOOD) -> str:
    """A grey picture, made as small as the layers are."""
    return data_uri(fitted(pixels, WIDEST_PX), quality)
