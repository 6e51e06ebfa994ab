"""A cut-out of a picture, and where its pixels lie in an SVG: there (0, 0) is the corner of the first pixel, not its centre."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.arrays import Floats
from scenes.intrinsics import Intrinsics

_MARGIN, _SMALLEST_PX = 0.35, 96  # of the size on either side; across at least
_WIDEST, _TALLEST = 2.4, 1.0  # width over height at most, and at least: as cards lie beside each other


@dataclass(frozen=True, slots=True)
class Window:
    """Columns ``left`` … ``right`` − 1 and rows ``top`` … ``bottom`` − 1 of a picture."""

    left: int
    top: int
    right: int
    bottom: int

    @property
    def width(self) -> int:
        """Columns."""
        return self.right - self.left

    @property
    def height(self) -> int:
        """Rows."""
        return self.bottom - self.top

    def cut(self, pixels: NDArray[Any]) -> NDArray[Any]:
        """This part of (height, width, ...) pixels."""
        return pixels[self.top : self.bottom, self.left : self.right]

    def svg(self, pixels: Floats) -> Floats:
        """(n, 2) in an SVG whose view box is this window, of (n, 2) pixels of the picture, integers being centres."""
        return np.asarray(pixels - np.array([self.left, self.top]) + 0.5)


def around(points_px: Floats, lens: Intrinsics) -> Window:
    """The window about (n, 2) pixels with a margin, within the picture; the whole picture where none of them lies in it."""
    size = np.array([lens.width_px, lens.height_px])
    there = points_px[np.isfinite(points_px).all(axis=1)]
    if not len(there) or (there.max(axis=0) < 0).any() or (there.min(axis=0) > size - 1).any():
        return Window(0, 0, lens.width_px, lens.height_px)
    low, high = np.clip(there.min(axis=0), 0, size - 1), np.clip(there.max(axis=0), 0, size - 1)
    half = np.maximum((high - low) * (0.5 + _MARGIN), _SMALLEST_PX / 2)
    half = np.maximum(half, [half[1] * _TALLEST, half[0] / _WIDEST])
    first = np.clip(np.floor((low + high) / 2 - half), 0, size - 2).astype(int)
    last = np.clip(np.ceil((low + high) / 2 + half) + 1, first + 2, size).astype(int)
    return Window(int(first[0]), int(first[1]), int(last[0]), int(last[1]))
