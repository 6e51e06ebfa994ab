"""A camera before a screen: which dots each of its pixels sees, by rays through the lens onto the screen's plane.

Camera and screen stand still, and dots shine alike in all directions, so the rays are traced once: what a pixel receives is then
a fixed share of each dot, whatever the dots show.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from renderer.display_places import even_place
from scenes.arrays import Floats
from scenes.display import Display
from scenes.exr import Window
from scenes.intrinsics import Intrinsics

_SAMPLES_AT_ONCE = 1 << 17  # what fits a processor's cache
_NEWTON_STEPS = 2
_HALF_PX = np.array([[0.5, 0.0], [0.0, 0.5]])


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """``shares`` (pixels of the window, dots), both row by row: which share of a pixel's area sees each dot shine.

    ``centre`` (h, w): the dot that the pixel's centre sees, or whose grid, counted row by row; −1 beside the screen.
    """

    shares: Any
    centre: NDArray[np.int64]

    @classmethod
    def of(cls, display: Display, lens: Intrinsics, window: Window, samples: int) -> "Sight":
        """Traces ``samples`` rays a pixel, a power of two, spread evenly over its area."""
        pixels = _pixels(window)
        centre = _dots_of(display, *display.places_from_sight(*lens.normalised_from_pixels(pixels).T), 1.0)
        at_once = max(1, _SAMPLES_AT_ONCE // samples)
        blocks = [_shares(display, lens, pixels[i : i + at_once], samples) for i in range(0, len(pixels), at_once)]
        return cls(sparse.vstack(blocks, format="csr"), centre.reshape(window.height_px, window.width_px))

    def mean(self, layer: NDArray[np.float32]) -> NDArray[np.float32]:
        """The mean over each pixel's area (h, w) of a ``layer`` of dots (rows, columns); grid and surroundings count as zero."""
        return np.asarray(self.shares @ layer.ravel(), dtype=np.float32).reshape(self.centre.shape)

    def at_centre(self, layer: NDArray[Any]) -> NDArray[Any]:
        """What the dot at each pixel's centre has of ``layer`` (rows, columns); 0 beside the screen."""
        found = layer.ravel()[np.maximum(self.centre, 0)]
        return np.where(self.centre >= 0, found, np.zeros((), dtype=layer.dtype))


def _shares(display: Display, lens: Intrinsics, pixels: Floats, samples: int) -> Any:
    """Rows of ``Sight.shares`` for ``pixels`` (n, 2)."""
    places = display.places_from_sight(*_ideal(lens, pixels, samples))
    dot = _dots_of(display, *places, display.fill_factor).ravel()
    # A meter reads the mean over dot and grid, so where a dot shines it does by as much more as the grid takes away.
    weight = np.where(dot >= 0, np.float32(1 / (samples * display.fill_factor)), np.float32(0))
    starts = np.arange(0, dot.size + 1, samples)
    shape = (len(pixels), display.dots[0] * display.dots[1])
    shares = sparse.csr_array((weight, np.maximum(dot, 0).astype(np.int32), starts.astype(np.int32)), shape=shape)
    shares.sum_duplicates()
    shares.eliminate_zeros()
    return shares


def _ideal(lens: Intrinsics, pixels: Floats, samples: int) -> tuple[Floats, Floats]:
    """Ideal normalised points x and y (n, samples) of the samples of ``pixels`` (n, 2), distortion removed.

    From the pixel's centre along the slope of the lens there: exact for one without distortion. For others steps of Newton's
    method follow, with the same slope: they leave less than 1e-6 px even where pixels are so large as 0.6°.
    """
    across, down = (place - 0.5 for place in even_place(np.arange(samples), samples))
    centre = lens.normalised_from_pixels(pixels)
    # by how much x and y grow over a pixel to the right, and over one down
    slopes = [lens.normalised_from_pixels(pixels + step) - lens.normalised_from_pixels(pixels - step) for step in _HALF_PX]
    x, y = (centre[:, i, None] + slopes[0][:, i, None] * across + slopes[1][:, i, None] * down for i in (0, 1))
    for _ in range(_NEWTON_STEPS if lens.is_distorted else 0):
        reached = lens.pixels_from_normalised(np.stack([x, y], axis=-1))
        miss_u, miss_v = pixels[:, :1] + across - reached[..., 0], pixels[:, 1:] + down - reached[..., 1]
        x, y = (at + slopes[0][:, i, None] * miss_u + slopes[1][:, i, None] * miss_v for i, at in enumerate((x, y)))
    return x, y


def _dots_of(display: Display, column: Floats, row: Floats, fill_factor: float) -> NDArray[np.int64]:
    """The dot, counted row by row, whose shining square holds each place; −1 on the grid and beside the screen."""
    columns, rows = display.dots
    nearest_column, nearest_row = np.floor(column + 0.5), np.floor(row + 0.5)
    inside = (nearest_column >= 0) & (nearest_column < columns) & (nearest_row >= 0) & (nearest_row < rows)  # NaN is not
    if fill_factor < 1:
        half = np.sqrt(fill_factor) / 2
        inside &= (np.abs(column - nearest_column) <= half) & (np.abs(row - nearest_row) <= half)
    return np.where(inside, nearest_row * columns + nearest_column, -1.0).astype(np.int64)


def _pixels(window: Window) -> Floats:
    """Centres (n, 2) of a window's pixels, row by row."""
    rows, columns = np.mgrid[0 : window.height_px, 0 : window.width_px].astype(np.float64)
    return np.stack([columns + window.x_px, rows + window.y_px], axis=-1).reshape(-1, 2)
