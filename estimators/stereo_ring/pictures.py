"""A part of a picture, smoothed once and then sampled anywhere between its pixels."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from scenes.arrays import Floats

Float32s = NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class Smoothed:
    """``values`` (h, w) float32, DN after a Gaussian; ``corner_px`` (2,): where its first pixel lies in the whole picture."""

    values: Float32s
    corner_px: Floats

    def at(self, points_px: Floats) -> Float32s:
        """Bilinear values (..., n) at points (..., n, 2) of the whole picture; beyond this part that of its border."""
        flat = np.asarray(points_px - self.corner_px, dtype=np.float32)
        rows = flat.reshape(-1, flat.shape[-2], 2)  # remap wants two dimensions
        found = cv2.remap(self.values, rows[..., 0], rows[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(found, dtype=np.float32).reshape(flat.shape[:-1])


def smoothed(pixels: NDArray[np.generic], centre_px: Floats | None, half_px: float, sigma_px: float) -> Smoothed:
    """The square of half-width ``half_px`` about ``centre_px`` (2,), or all if that is None.

    ``sigma_px``: of the Gaussian before sampling; 0 for none.
    """
    height, width = pixels.shape
    low, high = np.zeros(2, dtype=int), np.array([width, height])
    if centre_px is not None:
        low = np.clip(np.floor(centre_px - half_px).astype(int), 0, np.array([width, height]) - 1)
        high = np.clip(np.ceil(centre_px + half_px).astype(int) + 1, low + 1, np.array([width, height]))
    part = np.ascontiguousarray(pixels[low[1] : high[1], low[0] : high[0]], dtype=np.float32)
    if sigma_px == 0:
        return Smoothed(part, low.astype(np.float64))
    size = 2 * int(np.ceil(3 * sigma_px)) + 1
    return Smoothed(np.asarray(cv2.GaussianBlur(part, (size, size), sigma_px), dtype=np.float32), low.astype(np.float64))
